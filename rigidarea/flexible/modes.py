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
from numba import njit
from numpy.typing import NDArray

from rigidarea.flexible.cache import arrays
from rigidarea.flexible.element import Material, lumped_mass, stiffness
from rigidarea.flexible.mesh import Mesh

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

BLOCK = 128  # right-hand sides solved at once: bounds memory to BLOCK columns


@dataclass(frozen=True)
class Reduced:
    """A reduced body; i interface rows (2 f + 3), m modes; SI or any consistent units.

    centre (2,): centre of mass in the mesh's coordinates. frequency (m,): rad/time. modes (i, m). flexibility (i,
    i), length/force. coupling (m, m): G_jk = Σ mᵢ φᵢⱼᵀ J φᵢₖ. stretch (m,): h_k = Σ mᵢ xᵢᵀ φᵢₖ (design 2.8).
    """

    mass: float
    inertia: float
    centre: Array
    frequency: Array
    modes: Array
    flexibility: Array
    coupling: Array
    stretch: Array


def reduce(
    mesh: Mesh,
    material: Material,
    contact_rings: Sequence[int] = (0,),
    hub: int | None = None,
    clamped: int | None = None,
    modes: int = 0,
    flexible: bool = True,
    cache: Path | str | None = None,
) -> Reduced:
    """Reduce a body. Rings are numbered as in ``mesh.rings``; ``hub`` and ``clamped`` name a ring.

    modes: free-free modes kept (0: compliant). flexible: with False only the rigid-body data. cache: a directory; a
    file there that cannot be read is built again, with a warning. Raises ValueError for a hub or a clamped ring
    that does not exist, or more modes than the mesh has.
    """
    for name, ring in (("hub", hub), ("clamped", clamped)):
        if ring is not None and not (0 <= ring < len(mesh.rings) and len(mesh.rings[ring]) > 0):
            raise ValueError(f"{name} ring {ring} has no nodes; the mesh has rings 0 … {len(mesh.rings) - 1}")
    if modes > 2 * len(mesh.points) - 3:
        raise ValueError(f"modes must be at most {2 * len(mesh.points) - 3} for this mesh, got {modes}")
    names = [f.name for f in fields(Reduced)]

    def build() -> dict[str, NDArray]:
        body = _reduce(mesh, material, contact_rings, hub, clamped, modes, flexible)
        return {name: np.asarray(getattr(body, name)) for name in names}

    settings = ("reduce", material, tuple(contact_rings), hub, clamped, modes, flexible)
    found = arrays(cache, settings, (mesh.points, mesh.triangles, *mesh.rings), names, build)
    return Reduced(float(found.pop("mass")), float(found.pop("inertia")), **found)


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


def free_modes(k: sp.csc_array, mass: Array, rigid: Array, count: int) -> tuple[Array, Array]:
    """The first ``count`` elastic modes (2 n, count), mass-orthonormal, and their angular frequencies.

    ``rigid`` (2 n, r) are the modes to leave out (r = 0 for a clamped body). Signs are fixed (largest entry
    positive), the start vector is seeded: same input, same bits.
    """
    root = np.repeat(mass, 2) ** 0.5
    scaled = (sp.diags_array(1 / root) @ k @ sp.diags_array(1 / root)).tocsc()
    # A shift below zero keeps the factorisation regular; relative to the stiffest diagonal it is far below any mode
    shift = -1e-9 * scaled.diagonal().max()
    start = np.random.default_rng(0).standard_normal(len(root))
    extra = rigid.shape[1]
    if 2 * (count + extra) > len(root):  # most of them: Lanczos cannot give all
        vectors = np.linalg.eigh(scaled.toarray())[1][:, : count + extra]
    else:
        _, vectors = spl.eigsh(scaled, k=count + extra, sigma=shift, v0=start)
    phi = vectors / root[:, None]
    if extra:  # rigid part out, exactly
        phi -= rigid @ (rigid.T @ (phi * (root**2)[:, None]))
    # Rayleigh–Ritz on what is left puts the rigid remainder (norm ~ 0) aside and orders the rest
    gram = phi.T @ (phi * (root**2)[:, None])
    size, basis = np.linalg.eigh(gram)
    phi = phi @ (basis[:, extra:] / size[extra:] ** 0.5)
    square, turn = np.linalg.eigh(phi.T @ (k @ phi))
    phi = phi @ turn
    phi *= np.sign(phi[np.abs(phi).argmax(0), np.arange(count)])
    return phi, square**0.5


@njit(cache=True)
def _substitute(
    lp: Ints, li: Ints, lx: Array, up: Ints, ui: Ints, ux: Array, x: Array
) -> None:  # compressed columns of L and U, right-hand sides as the columns of x
    n, m = x.shape
    for j in range(n):
        for p in range(lp[j], lp[j + 1]):
            if li[p] > j:
                for k in range(m):
                    x[li[p], k] -= lx[p] * x[j, k]
    for j in range(n - 1, -1, -1):
        for p in range(up[j], up[j + 1]):
            if ui[p] == j:
                for k in range(m):
                    x[j, k] /= ux[p]
        for p in range(up[j], up[j + 1]):
            if ui[p] < j:
                for k in range(m):
                    x[ui[p], k] -= ux[p] * x[j, k]


class _Solver:
    """Sparse factors, applied to many right-hand sides row by row of all of them.

    SuperLU's own ``solve`` takes one column after another through threaded BLAS calls of a few entries each: ten
    times slower here, and more so on a busy machine.
    """

    def __init__(self, matrix: sp.csc_array) -> None:
        factors = spl.splu(
            matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        )
        self._row, self._column = factors.perm_r, factors.perm_c
        lower, upper = factors.L.tocsc(), factors.U.tocsc()
        self._factors = tuple(
            part
            for f in (lower, upper)
            for part in (f.indptr.astype(np.int64), f.indices.astype(np.int64), f.data)
        )

    def solve(self, rhs: Array) -> Array:
        """x (n, m) of A x = rhs."""
        x = np.empty(rhs.shape)
        x[self._row] = rhs
        _substitute(*self._factors, x)
        return x[self._column]


def _reduce(
    mesh: Mesh, material: Material, contact_rings: Sequence[int], hub: int | None, clamped: int | None, modes: int,
    flexible: bool,
) -> Reduced:  # fmt: skip
    mass = lumped_mass(mesh, material)
    rigid, centre, inertia = rigid_modes(mesh.points, mass)
    nodes = np.concatenate([mesh.rings[i] for i in contact_rings])
    n = 2 * len(mesh.points)
    f = 2 * len(nodes)
    pick = np.zeros(f, np.int64)
    pick[0::2], pick[1::2] = 2 * nodes, 2 * nodes + 1
    hubs = hub_rows(mesh.points, mesh.rings[hub]) if hub is not None else np.zeros((n, 3))

    def interface(full: Array) -> Array:
        return np.vstack([full[pick], hubs.T @ full])

    x = mesh.points - centre
    total = float(mass.sum())
    none = np.zeros((f + 3, 0)), np.zeros((0, 0))
    if not flexible:
        return Reduced(total, inertia, centre, np.zeros(0), *none, np.zeros((0, 0)), np.zeros(0))
    k = stiffness(mesh, material)
    if clamped is not None:
        held = np.concatenate([2 * mesh.rings[clamped], 2 * mesh.rings[clamped] + 1])
        rigid = np.zeros((n, 0))
    else:  # three supports, statically determinate: they carry nothing, as every load is self-equilibrated
        i = int(np.argmin(mesh.points[:, 0]))
        away = mesh.points - mesh.points[i]
        j = int(np.argmax((away**2).sum(1)))
        held = np.array([2 * i, 2 * i + 1, 2 * j + (1 if abs(away[j, 0]) > abs(away[j, 1]) else 0)])
    free = np.setdiff1d(np.arange(n), held)
    omega, phi = np.zeros(0), np.zeros((n, 0))
    if modes:
        if clamped is None:
            phi, omega = free_modes(k, mass, rigid, modes)
        else:
            kf = k[free][:, free].tocsc()
            phi = np.zeros((n, modes))
            root = np.repeat(mass, 2)[free] ** 0.5
            scaled = (sp.diags_array(1 / root) @ kf @ sp.diags_array(1 / root)).tocsc()
            start = np.random.default_rng(0).standard_normal(len(root))
            square, vectors = spl.eigsh(scaled, k=modes, sigma=0.0, v0=start)
            phi[free], omega = vectors / root[:, None], square**0.5
    solver = _Solver(k[free][:, free].tocsc())
    where = np.full(n, -1)
    where[free] = np.arange(len(free))
    m_rigid = np.repeat(mass, 2)[:, None] * rigid
    s = np.empty((f + 3, f + 3))
    for first in range(0, f, BLOCK):
        cols = where[pick[first : first + BLOCK]]
        rhs = np.zeros((len(free), len(cols)))
        rhs[cols[cols >= 0], np.flatnonzero(cols >= 0)] = 1.0
        full = np.zeros((n, len(cols)))
        full[free] = solver.solve(rhs)
        s[:, first : first + len(cols)] = interface(full)
    rhs = np.zeros((n, 3 + rigid.shape[1]))
    rhs[free] = solver.solve(np.ascontiguousarray(np.hstack([hubs, m_rigid])[free]))
    s[:, f:] = interface(rhs[:, :3])
    # C = (I − R Rᵀ M) K⁺ (I − M R Rᵀ): loads lose their resultant, displacements their rigid part
    t, r = interface(rhs[:, 3:]), interface(rigid)
    c = s - t @ r.T - r @ t.T + r @ (m_rigid.T @ rhs[:, 3:]) @ r.T
    rows = interface(phi)
    c -= (rows / omega**2) @ rows.T
    turned = np.stack([-phi[1::2], phi[0::2]], 1).reshape(phi.shape)  # J φ
    return Reduced(
        total, inertia, centre, omega, rows, 0.5 * (c + c.T),
        phi.T @ (np.repeat(mass, 2)[:, None] * turned), (np.repeat(mass, 2) * x.ravel()) @ phi,
    )  # fmt: skip
