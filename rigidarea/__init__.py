"""Rigid-body contact by overlap area for pymunk.

import pymunk, rigidarea as ra
contact = ra.attach(space)  # of a pymunk.Space
space.step(1 / 60)  # as ever
"""

from . import shapes
from .contact import REGIONS, AreaContact, SimulationError, attach, attached
from .outline import Outline
from .overlap import OVERLAP, OVERLAPS, covers, overlap, overlaps
from .plan import Plan, plan
from .queries import point_query, segment_query

__version__ = "0.1.0"

__all__ = [
    "OVERLAP",
    "OVERLAPS",
    "REGIONS",
    "AreaContact",
    "Outline",
    "Plan",
    "SimulationError",
    "attach",
    "attached",
    "covers",
    "overlap",
    "overlaps",
    "plan",
    "point_query",
    "segment_query",
    "shapes",
]
