"""Reduction of a finite-element body: free-free modes, RBE3 hub, residual flexibility; kept on disk by content.

Interface degrees of freedom: x and y of the contact rings' nodes, then a hub's (x, y, rotation) as the weighted
mean of its nodes (RBE3: the hub's motion is a mean, so it adds no stiffness). Displacements there are

    u = Φ q + C f,

Φ mass-orthonormal free-free modes about the centre of mass and C the static flexibility they leave out: with no
mode kept, C is the whole inertia-relief flexibility and the body is *compliant*; with modes, *modal*. Cf. R. R.
Craig and A. J. Kurdila, Fundamentals of Structural Dynamics, 2nd ed., chapter 17 (residual flexibility, inertia
relief). A clamped body (a ground) has the flexibility and modes of its clamped mesh.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spl
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from rigidarea.flexible.blocks import WIDE, Pieces, no_pieces, spans, whole
from rigidarea.flexible.element import Material, geometric_stiffness, lumped_mass, stiffness, stress
from rigidarea.flexible.factor import factorise, forward, substitute, trace
from rigidarea.flexible.mesh import CORNER, Array, Mesh, turns
from rigidarea.flexible.reduction_store import arrays

Ints = NDArray[np.int64]

SOFT = 8  # modes of a compliant body that spin stiffens: a beam's tip at half its first frequency yields as with 24, to
# 0.1 % (tests/flexible/test_spin.py)
WHOLE = 3000  # rows of a flexibility that is multiplied out at once: 72 MB


@dataclass(frozen=True)
class Reduced:
    """A reduced body; i interface rows (2 f + 3), m modes; SI or any consistent units.

    centre (2,): centre of mass in the mesh's coordinates. frequency (m,): rad/time. modes (i, m). flexibility (i,
    i), length/force. coupling (m, m): G_jk = Σ mᵢ φᵢⱼᵀ J φᵢₖ. stretch (m,): h_k = Σ mᵢ xᵢᵀ φᵢₖ. swell (i,): what
    moves by the centrifugal forces of unit angular velocity that the modes leave out (length × time²). geometric (3,
    m, m):
    stiffness of the stress by those forces, and by a unit force on the hub along x and y; (0, m, m) for a clamped body
    and without modes. slowest: the first elastic angular frequency, 0 for a rigid body. soft (i, r), soft_stretch (r,),
    tension (3, r, r): modes, stretch and geometric stiffness of the first r = SOFT modes over their frequencies, of a
    compliant body that is not clamped (``tension``); else r = 0. pieces: what the flexibility of an interface of more
    than WHOLE rows is made of; ``flexibility`` is then (0, 0).
    """

    mass: float
    inertia: float
    centre: Array
    frequency: Array
    modes: Array
    flexibility: Array
    coupling: Array
    stretch: Array
    swell: Array
    geometric: Array
    slowest: float
    soft: Array
    soft_stretch: Array
    tension: Array
    pieces: Pieces

    @property
    def how_it_yields(self) -> Array | Pieces:
        """The flexibility, or its pieces."""
        return self.pieces if len(self.pieces.path) else self.flexibility


def reduce(
    mesh: Mesh,
    material: Material,
    contact_rings: Sequence[int] = (0,),
    hub: int | None = None,
    clamped: int | None = None,
    modes: int = 0,
    flexible: bool = True,
    cache: Path | str | None = None,
    smooth: bool = True,
    sides: int = 1,
) -> Reduced:
    """Reduce a body. Rings are numbered as in ``mesh.rings``; ``hub`` and ``clamped`` name a ring.

    sides: contacts load every so many of a ring's nodes, and those between them with them (``carriers``). modes:
    free-free modes kept (0: compliant). flexible: with False only the rigid-body data. cache: a directory; a
    file there that cannot be read is built again, with a warning. smooth: see ``element.stiffness``. Raises ValueError
    for a hub or a clamped ring that does not exist, or more modes than the mesh has.
    """
    for name, ring in (("hub", hub), ("clamped", clamped)):
        if ring is not None and not (0 <= ring < len(mesh.rings) and len(mesh.rings[ring]) > 0):
            raise ValueError(f"{name} ring {ring} has no nodes; the mesh has rings 0 … {len(mesh.rings) - 1}")
    if modes > 2 * len(mesh.points) - 3:
        raise ValueError(f"modes must be at most {2 * len(mesh.points) - 3} for this mesh, got {modes}")
    names = [f.name for f in fields(Reduced) if f.name != "pieces"]

    def build() -> dict[str, NDArray]:
        body = _reduce(mesh, material, contact_rings, hub, clamped, modes, flexible, smooth, sides)
        return {name: np.asarray(getattr(body, name)) for name in names} | body.pieces._asdict()

    settings = ("reduce", material, tuple(contact_rings), hub, clamped, modes, flexible, smooth, sides)
    found = arrays(
        cache, settings, (mesh.points, mesh.triangles, *mesh.rings), [*names, *Pieces._fields], build
    )
    pieces = Pieces(*(found.pop(name) for name in Pieces._fields))
    mass, inertia, slowest = (float(found.pop(name)) for name in ("mass", "inertia", "slowest"))
    return Reduced(mass, inertia, slowest=slowest, pieces=pieces, **found)


def rigid_modes(points: Array, mass: Array) -> tuple[Array, Array, float]:
    """Mass-orthonormal rigid-body modes (2 n, 3), centre of mass (2,), moment of inertia about it."""
    total = mass.sum()
    centre = mass @ points / total
    x = points - centre
    inertia = float(mass @ (x**2).sum(1))
    r = np.zeros((len(points), 2, 3))
    r[:, 0, 0] = r[:, 1, 1] = total**-0.5
    r[:, 0, 2], r[:, 1, 2] = -x[:, 1] * inertia**-0.5, x[:, 0] * inertia**-0.5
    return r.reshape(-1, 3), centre, inertia


def hub_rows(points: Array, nodes: Ints) -> Array:
    """RBE3 weights (2 n, 3): hub displacement (x, y, rotation) = rowsᵀ u, equal weights; forces go back by the
    same."""
    w = np.zeros((len(points), 2, 3))
    x = points[nodes] - points[nodes].mean(0)
    w[nodes, 0, 0] = w[nodes, 1, 1] = 1.0 / len(nodes)
    spread = (x**2).sum()
    w[nodes, 0, 2], w[nodes, 1, 2] = -x[:, 1] / spread, x[:, 0] / spread
    return w.reshape(-1, 3)


def carriers(mesh: Mesh, contact_rings: Sequence[int], sides: int) -> sp.csc_array:
    """Forces (2 n) on all nodes of unit loads on every ``sides``-th of the rings' nodes: (2 n, 2 f).

    A load is spread as linear shape functions of the loaded nodes' spacing would have it, over all of the mesh's nodes
    there, and they are moved by the same mean. A load on single nodes, with others between them, would be one
    that the mesh's stresses see node by node. Round a corner nothing is spread, and less towards it: on either side as
    far, so that a load's mean place is its node.
    """
    rows, columns, values, first = [], [], [], 0
    offset = np.arange(1 - sides, sides)
    for k in contact_rings:
        ring = mesh.rings[k]
        corner = np.abs(turns(mesh.points[ring])) > CORNER
        at = np.arange(0, len(ring), sides)
        width = np.full(len(at), float(sides))
        for d in range(1, sides):
            near = corner[(at - (sides - 1 - d)) % len(ring)] | corner[(at + (sides - 1 - d)) % len(ring)]
            width[near] = sides - d
        share = np.maximum(0.0, 1.0 - np.abs(offset) / width[:, None]) / width[:, None]
        rows.append(ring[(at[:, None] + offset) % len(ring)].ravel())
        columns.append(np.repeat(first + np.arange(len(at)), len(offset)))
        values.append(share.ravel())
        first += len(at)
    i, j, v = (np.concatenate(x) for x in (rows, columns, values))
    one = sp.csc_array((v, (i, j)), shape=(len(mesh.points), first))
    return sp.kron(one, sp.eye_array(2), format="csc")


class Flexibility:
    """The static response of a body, u = C f, from one sparse factorisation, its rigid motion relieved.

    Free in space, C = (I − R Rᵀ M) K⁺ (I − M R Rᵀ) with R the rigid modes (2 n, 3): loads lose their resultant to
    the body's own inertia, displacements their rigid part, and K⁺ may stand on any three supports that hold the
    body, as they carry nothing. With degrees of freedom ``held``, R is empty (2 n, 0) and C = K⁻¹. Modes are the
    eigenvectors of C M, with eigenvalues 1/ω², so the same factors give them and what they leave out.
    """

    def __init__(self, k: sp.csc_array, mass: Array, rigid: Array, held: Ints) -> None:
        self.root = np.repeat(mass, 2) ** 0.5
        self._rigid, self._momentum = rigid, self.root[:, None] ** 2 * rigid
        self._free = np.setdiff1d(np.arange(k.shape[0]), held)
        self._factors = factorise(k[self._free][:, self._free].tocsc())

    def __call__(self, loads: Array) -> Array:
        """Displacements (2 n, c) under ``loads`` (2 n, c).

        Thin products and substitution are not left to BLAS, whose threads take a hundred times longer to share out
        so little work on a busy machine; SuperLU's ``solve`` calls it as well, for one column after another.
        """
        loads = loads - np.einsum("ir,rc->ic", self._momentum, np.einsum("ir,ic->rc", self._rigid, loads))
        u = self._supported(loads)
        return u - np.einsum("ir,rc->ic", self._rigid, np.einsum("ir,ic->rc", self._momentum, u))

    def _supported(self, loads: Array) -> Array:
        """K⁺ times ``loads`` (2 n, c)."""
        f = self._factors
        x = np.empty((len(self._free), loads.shape[1]))
        x[f.place] = loads[self._free]
        substitute(f.start, f.row, f.value, f.diagonal, x)
        u = np.zeros(loads.shape)
        u[self._free] = x[f.place]
        return u

    def between(self, rows: sp.csc_array, phi: Array, omega: Array) -> Pieces:
        """rowsᵀ C rows (i, i), less the modes ``phi`` (2 n, m) of frequencies ``omega``, as ``blocks`` has it.

        rows (2 n, i): loads on nodes, the last three a hub's. With W = K⁺ M R and S = Rᵀ M W, C = K⁺ − W Rᵀ − R Wᵀ +
        R S Rᵀ: so that the loads that are solved for stay those of single nodes.
        """
        f = self._factors
        w = self._supported(self._momentum)
        s = np.einsum("ir,ic->rc", self._momentum, w)
        at, moved, modes = (np.asarray(rows.T @ x) for x in (self._rigid, w, phi))
        loads = rows[self._free].tocoo()
        place, parts, paths = f.place[loads.row], [], []
        for low, high in spans(rows.shape[1]):
            mine = np.flatnonzero((loads.col >= low) & (loads.col < high))
            on = np.zeros(len(self._free), bool)
            on[place[mine]] = True
            trace(f.start, f.row, on)
            parts.append((place[mine], loads.col[mine] - low, loads.data[mine]))
            paths.append(np.flatnonzero(on))
        start = np.cumsum([0, *map(len, paths)])
        value, where = np.zeros((start[-1], WIDE)), np.zeros(len(self._free), np.int64)
        for (row, column, load), path, first in zip(parts, paths, start[:-1], strict=True):
            x = value[first : first + len(path)]
            where[path] = np.arange(len(path))
            x[where[row], column] = load
            forward(f.start, f.row, f.value, path, where, x)
            x /= f.diagonal[path, None] ** 0.5
        return Pieces(
            start, np.concatenate(paths), value, np.hstack([at @ s - moved, -at, -modes / omega**2]),
            np.hstack([at, moved, modes]),
        )  # fmt: skip

    def modes(self, count: int) -> tuple[Array, Array]:
        """The first ``count`` elastic modes (2 n, count), mass-orthonormal, and their angular frequencies (count,).

        Largest eigenvalues of √M C √M, where rigid modes have none. Signs are fixed (largest entry positive), the
        start vector is seeded: same input, same bits.
        """
        n = len(self.root)
        if 2 * count > n:  # most of them: Lanczos cannot give all
            dense = self.root[:, None] * self(np.diag(self.root))
            value, vectors = np.linalg.eigh(0.5 * (dense + dense.T))
        else:
            response = spl.LinearOperator(
                (n, n), lambda x: self.root * self((self.root * x.ravel())[:, None])[:, 0], dtype=float
            )
            start = np.random.default_rng(0).standard_normal(n)
            with threadpool_limits(1, "blas"):  # on vectors this thin threads only wait for each other
                value, vectors = spl.eigsh(response, k=count, which="LM", v0=start)
        first = np.argsort(value)[::-1][:count]
        phi = vectors[:, first] / self.root[:, None]
        return phi * np.sign(phi[np.abs(phi).argmax(0), np.arange(count)]), value[first] ** -0.5


def elastic(mesh: Mesh, material: Material, clamped: int | None = None, smooth: bool = True) -> Flexibility:
    """A mesh's static response, free in space or with the nodes of ring ``clamped`` held."""
    mass, k = lumped_mass(mesh, material), stiffness(mesh, material, smooth)
    if clamped is not None:
        held = (2 * mesh.rings[clamped][:, None] + np.arange(2)).ravel()
        return Flexibility(k, mass, np.zeros((k.shape[0], 0)), held)
    # three supports: a point, and a turn about it
    i = int(np.argmin(mesh.points[:, 0]))
    away = mesh.points - mesh.points[i]
    j = int(np.argmax((away**2).sum(1)))
    held = np.array([2 * i, 2 * i + 1, 2 * j + (1 if abs(away[j, 0]) > abs(away[j, 1]) else 0)])
    return Flexibility(k, mass, rigid_modes(mesh.points, mass)[0], held)


def _reduce(
    mesh: Mesh, material: Material, contact_rings: Sequence[int], hub: int | None, clamped: int | None, modes: int,
    flexible: bool, smooth: bool, sides: int,
) -> Reduced:  # fmt: skip
    mass = lumped_mass(mesh, material)
    _, centre, inertia = rigid_modes(mesh.points, mass)
    boundary = carriers(mesh, contact_rings, sides)
    n, f = boundary.shape
    if not flexible:
        return Reduced(float(mass.sum()), inertia, centre, np.zeros(0), np.zeros((f + 3, 0)), np.zeros((0, 0)),
                       np.zeros((0, 0)), np.zeros(0), np.zeros(0), np.zeros((0, 0, 0)), 0.0, np.zeros((f + 3, 0)),
                       np.zeros(0), np.zeros((0, 0, 0)), no_pieces())  # fmt: skip
    # interface displacements = rowsᵀ u, loads on the nodes = rows f
    hubs = hub_rows(mesh.points, mesh.rings[hub]) if hub is not None else np.zeros((n, 3))
    rows = sp.hstack([boundary, sp.csc_array(hubs)]).tocsc()
    response = elastic(mesh, material, clamped, smooth)
    first_modes, first_omega = response.modes(modes or min(SOFT if clamped is None else 1, n - 3))
    slowest = first_omega[0]
    phi, omega = first_modes[:, :modes], first_omega[:modes]
    at = np.asarray(rows.T @ phi)
    m2 = np.repeat(mass, 2)
    turned = np.stack([-phi[1::2], phi[0::2]], 1).reshape(phi.shape)  # J φ
    spin = m2 * (mesh.points - centre).ravel()
    stretch = spin @ phi
    swell, geometric = np.zeros(0), np.zeros((0, modes, modes))
    soft, soft_stretch, tension = np.zeros((f + 3, 0)), np.zeros(0), np.zeros((0, 0, 0))
    if clamped is None:
        tense = response(np.column_stack([spin, hubs[:, :2]]))
        swell = rows.T @ tense[:, 0] - (at / omega**2) @ stretch
        stiffer = np.array(
            [
                first_modes.T
                @ (geometric_stiffness(mesh, material, stress(mesh, material, u, smooth)) @ first_modes)
                for u in tense.T
            ]
        )
        if modes:
            geometric = stiffer
        else:
            soft = np.asarray(rows.T @ (first_modes / first_omega))
            soft_stretch = spin @ first_modes / first_omega
            stiffer[0] -= np.eye(len(first_omega))
            tension = stiffer / np.outer(first_omega, first_omega)
    pieces, c = response.between(rows, phi, omega), np.zeros((0, 0))
    if f + 3 <= WHOLE:
        pieces, c = no_pieces(), whole(pieces)
    return Reduced(
        float(mass.sum()), inertia, centre, omega, at, c, phi.T @ (m2[:, None] * turned), stretch, swell, geometric,
        float(slowest), soft, soft_stretch, tension, pieces,
    )  # fmt: skip
