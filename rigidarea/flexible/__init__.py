"""The flexible mode: a lumped finite-element submodule beside the rigid contacts (needs scipy).

From an outline's rings to a moving body: ``elastic_body`` meshes (``mesh``), builds elements (``element``), reduces
(``modes``) and lays a contact boundary on it (``boundary``). ``Simulation`` (``integrate``, ``step``) moves bodies by
generalised-alpha, with contact by overlap area (``region``: Alg. 1 and 2, ``nodal``: Alg. 3) or segment to segment
(``segment``). ``statics.solve`` finds the equilibrium of two elastic bodies pressed together. ``Mechanism``
(``build``) puts such a system together by name; ``recover`` gives displacements and stresses of a recorded instant,
``pictures`` draws them. ``Assembly`` (``assembly``, ``inspace``) has flexible bodies in an attached pymunk space.
"""

from rigidarea.flexible.assembly import Assembly
from rigidarea.flexible.body import LEVELS, elastic_body
from rigidarea.flexible.build import Mechanism
from rigidarea.flexible.element import Material
from rigidarea.flexible.integrate import Body, Record, Simulation
from rigidarea.flexible.recover import recover
from rigidarea.flexible.statics import solve

__all__ = [
    "LEVELS",
    "Assembly",
    "Body",
    "Material",
    "Mechanism",
    "Record",
    "Simulation",
    "elastic_body",
    "recover",
    "solve",
]
