"""The whole deformed body again, from what a run keeps of it: displacement and stress at any recorded time.

The reduced state is modes q, loads f on boundary nodes, the hub's load and the spin. All nodes then move by

    u = Φ q + C f + ω² s,

(and, in a compliant body, what spin changes of C: ``tension``)
with all rows of Φ and C where the stepper has those of the interface: one sparse factorisation of the body's own
stiffness, made when first asked for, gives C f as the static response less what the modes have of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spl
from numpy.typing import NDArray

from rigidarea.flexible.element import Material, lumped_mass, strain_displacement, stress, von_mises
from rigidarea.flexible.mesh import Array, Mesh
from rigidarea.flexible.modes import Flexibility, Reduced, carriers, elastic, hub_rows, rigid_modes
from rigidarea.flexible.tension import matrix
from rigidarea.geometry.gate import whole


@dataclass(frozen=True)
class Shape:
    """What a body's reduction was made of; ``displacement`` and ``stress`` undo it.

    contact_rings, hub, clamped: ring numbers as in ``modes.reduce``, and sides; reduced: its result.
    """

    mesh: Mesh
    material: Material
    contact_rings: tuple[int, ...]
    hub: int | None
    clamped: int | None
    reduced: Reduced
    sides: int = 1

    @cached_property
    def _response(self) -> Flexibility:
        return elastic(self.mesh, self.material, self.clamped)

    @cached_property
    def _modes(self) -> Array:
        """All rows of the modes (2 n, m), from their frequencies: with the signs that the reduction has."""
        m = len(self.reduced.frequency)
        return self._response.modes(m)[0] if m else np.zeros((2 * len(self.mesh.points), 0))

    @cached_property
    def _soft(self) -> Array:
        """All rows of the modes that spin stiffens, over their frequencies (2 n, r)."""
        r = len(self.reduced.soft_stretch)
        if r == 0:
            return np.zeros((2 * len(self.mesh.points), 0))
        phi, omega = self._response.modes(r)
        return phi / omega

    @property
    def loaded(self) -> list[NDArray[np.int64]]:
        """The nodes that contacts load, ring after ring: FE boundary node i of the stepper is the i-th of all."""
        return [self.mesh.rings[i][:: self.sides] for i in self.contact_rings]

    def sag(self, gravity: tuple[float, float]) -> Array:
        """Displacements (n, 2) by the body's own weight, ``gravity`` in the body frame, of a clamped body."""
        mass = lumped_mass(self.mesh, self.material)
        return self._response((mass[:, None] * np.array(gravity)).reshape(-1, 1))[:, 0].reshape(-1, 2)

    def displacement(
        self,
        modal: Array,
        loads: Array,
        hub: Array | tuple[float, float, float] = (0.0, 0.0, 0.0),
        spin: float = 0.0,
    ) -> Array:
        """Displacements (n, 2) of all nodes in the body frame.

        modal (m,); loads (l, 3): FE boundary node, and force on it in the body frame; hub: force and moment on the
        hub, body frame; spin: angular velocity of the frame. Raises ValueError for shapes that do not fit.
        """
        m, points = len(self.reduced.frequency), self.mesh.points
        modal, loads = np.asarray(modal, float), np.asarray(loads, float).reshape(-1, 3)
        if modal.shape != (m,):
            raise ValueError(f"modal must have shape ({m},), got {modal.shape}")
        f = np.zeros((sum(map(len, self.loaded)), 2))
        if len(loads) and not (0 <= loads[:, 0].min() and loads[:, 0].max() < len(f)):
            raise ValueError(f"loads must name nodes 0 … {len(f) - 1}, got {loads[:, 0].max():g}")
        np.add.at(f, loads[:, 0].astype(int), loads[:, 1:])
        full = carriers(self.mesh, self.contact_rings, self.sides) @ f.reshape(-1)
        if self.hub is not None:
            full = full + hub_rows(points, self.mesh.rings[self.hub]) @ np.asarray(hub, float)
        if spin and self.clamped is None:
            mass = np.repeat(lumped_mass(self.mesh, self.material), 2)
            full = full + spin**2 * mass * (points - self.reduced.centre).reshape(-1)
        u = self._response(full[:, None])[:, 0]
        phi = self._modes
        u = u - phi @ (phi.T @ full / self.reduced.frequency**2) + phi @ modal
        r = len(self.reduced.soft_stretch)
        out = np.zeros((r, 2 * r))
        if r and matrix(self.reduced.tension, float(spin) ** 2, float(hub[0]), float(hub[1]), out):
            u = u + self._soft @ (out[:, r:] @ (self._soft.T @ full))
        return u.reshape(-1, 2)

    @cached_property
    def _laplacian(self) -> tuple[Array, Any, Any]:
        """Gradients (m, 3, 2) of the nodes' shape functions, factors of the Laplacian, and the node held there."""
        b, area = strain_displacement(self.mesh)
        gradient = np.stack([b[:, 0, 0::2], b[:, 1, 1::2]], 2)
        tri, n = self.mesh.triangles, len(self.mesh.points)
        part = np.einsum("eia,eja,e->eij", gradient, gradient, area)
        k = sp.coo_array(
            (part.ravel(), (np.repeat(tri, 3, 1).ravel(), np.tile(tri, (1, 3)).ravel())), (n, n)
        ).tocsc()
        held = np.zeros(1, np.int64) if self.clamped is None else self.mesh.rings[self.clamped]
        free = np.setdiff1d(np.arange(n), held)
        return gradient, free, spl.splu(k[free][:, free].tocsc())

    def turned(self, u: Array) -> Array:
        """Displacements (n, 2) with what parts that turn bring nearer to each other, of linear ones ``u`` (n, 2).

        A beam that bends is shorter; linear displacements leave its length along the axis. With ω and ε the turn and
        the strain of u, the gradient of the shape is R(ω) (I + ε) as nearly as a shape can have it (J. Huang et al.,
        Interactive shape interpolation through controllable dynamic deformation, IEEE TVCG 17, 2011,
        doi:10.1109/TVCG.2010.109). Of second order in u; without momentum and moment of momentum, as the modes.
        """
        gradient, free, factors = self._laplacian
        tri, points = self.mesh.triangles, self.mesh.points
        slope = np.einsum("eic,eia->eca", u[tri], gradient)
        turn = 0.5 * (slope[:, 1, 0] - slope[:, 0, 1])
        c, s = np.cos(turn), np.sin(turn)
        strained = np.eye(2) + 0.5 * (slope + slope.transpose(0, 2, 1))
        rotation = np.stack([np.stack([c, -s], 1), np.stack([s, c], 1)], 1)
        more = rotation @ strained - np.eye(2) - slope
        load = np.einsum("eia,eca,e->eic", gradient, more, self.mesh.areas())
        right = np.column_stack(
            [np.bincount(tri.ravel(), load[:, :, k].ravel(), len(points)) for k in range(2)]
        )
        second = np.zeros(u.shape)
        second[free] = factors.solve(right[free])
        if self.clamped is None:
            mass = lumped_mass(self.mesh, self.material)
            rigid = rigid_modes(points, mass)[0]
            second -= (rigid @ (rigid.T @ (np.repeat(mass, 2) * second.reshape(-1)))).reshape(-1, 2)
        return u + second

    def stress(self, u: Array) -> Array:
        """Stress (m, 3) = (σ_xx, σ_yy, τ_xy) of each triangle, body frame, under displacements ``u`` (n, 2)."""
        return stress(self.mesh, self.material, u)

    def von_mises(self, u: Array) -> Array:
        """Von Mises stress (m,) of each triangle."""
        return von_mises(self.material, self.stress(u))


@dataclass(frozen=True)
class State:
    """One body at one recorded time: nodes' displacement (n, 2, ``Shape.turned``) and triangles' stress (m, 3) in the
    body frame, and the frame (x, y, angle)."""

    shape: Shape
    frame: Array
    displacement: Array
    stress: Array

    def placed(self, magnification: float = 1.0) -> Array:
        """World positions (n, 2) of the nodes, displacements magnified."""
        local = self.shape.mesh.points - self.shape.reduced.centre + magnification * self.displacement
        c, s = np.cos(self.frame[2]), np.sin(self.frame[2])
        return local @ np.array([[c, s], [-s, c]]) + self.frame[:2]


def recover(sim: Any, record: Any, row: int, body: int) -> State:
    """Body ``body`` of a ``Simulation`` at row ``row`` of a record that kept shapes (``run(..., shapes=True)``).

    A negative row is counted from the end. Raises ValueError for a record without shapes, a row or body that there is
    not, and a body that has no mesh (rigid, or made by hand).
    """
    if record.shapes is None:
        raise ValueError("expected a record with shapes, got one without: run(..., shapes=True) keeps them")
    whole(row, "row", -len(record.t), len(record.t) - 1)
    shape = sim.bodies[whole(body, "body", 0, len(sim.bodies) - 1)].shape
    if shape is None:
        raise ValueError(f"body {body} has no mesh to recover: expected one made by elastic_body, not rigid")
    kept, first = record.shapes, sim.system.first
    loads = kept.loads[row]
    mine = loads[loads[:, 0] == body, 1:]
    modal = kept.modal[row, first[body] : first[body + 1]]
    spin = float(record.v[row, body, 2])
    u = shape.displacement(modal, mine, kept.hub[row, body], spin)
    if sim.sag[body] is not None:
        u = u + sim.sag[body]
    return State(shape, record.x[row, body], shape.turned(u), shape.stress(u))
