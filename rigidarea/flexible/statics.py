"""Static contact of two elastic bodies: full finite-element statics on the boundary, Newton with a consistent
tangent.

Local law p = k d (Alg. 3 with q = 1, whose resultant is k A at the centroid); displacements u = C f from the bodies'
condensed flexibility. The unknown is one number per Gauss point of the overlap, its thickness d: with N the
shape functions of both bodies' boundary points along the contact direction and w the weights,

    f = Nᵀ (w k d),      d = g + s δ − N C Nᵀ (w k d),

g the thickness of the undeformed overlap and δ a rigid approach. Newton's matrix I + N C Nᵀ w k is that of a
symmetric positive operator, so the iteration needs no damping; the geometry is then evaluated again until regions,
normals and loads agree.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rigidarea.flexible import nodal
from rigidarea.flexible.boundary import Boundary, complete, workspace
from rigidarea.flexible.boundary_regions import arcs, find_regions

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Solution:
    """Static contact state. Forces on B; ``points`` rows are Gauss points of all regions.

    force: Σ k A along ``direction``. moment: of the force on B about B's origin. loads: (a, b) node loads (f, 2) in
    each body frame. position (g, 2) world. pressure (g,), weight (g,) length. regions: number. iterations:
    evaluations.
    """

    force: Array
    moment: float
    loads: tuple[Array, Array]
    position: Array
    pressure: Array
    weight: Array
    regions: int
    iterations: int


def solve(
    a: Boundary,
    pose_a: Array | tuple[float, float, float],
    b: Boundary,
    pose_b: Array | tuple[float, float, float],
    k: float,
    along: Array | tuple[float, float] | None = None,
    tolerance: float = 1e-9,
    limit: int = 60,
) -> Solution:
    """Equilibrium of two compliant bodies at fixed frames, poses (x, y, angle).

    along: a unit vector (world): only displacements along it move the perimeters, as in linear contact theory (Hertz
    neglects the tangential ones, which are of the order of the strain). tolerance: relative change of the loads.
    Raises RuntimeError, with the residual, if ``limit`` evaluations do not suffice.
    """
    a, b = complete(a), complete(b)
    wa, wb = workspace(a), workspace(b)
    s = nodal.scratch(len(a.points) + len(b.points))
    pa, pb = (np.array([p[0], p[1], np.cos(p[2]), np.sin(p[2])]) for p in (pose_a, pose_b))
    none = np.zeros(0)
    size = 3 * (len(a.points) + len(b.points) + 8)
    point, value = np.zeros((size, 4), np.int64), np.zeros((size, 5))
    load_a, load_b = np.zeros(a.modes.shape[0]), np.zeros(b.modes.shape[0])
    change = np.inf
    best = np.inf
    relax = 1.0
    # Undeformed first: there the overlap is widest, so every point that can touch is seen
    for stamp in range(1, limit + 1):
        for bd, w, load in ((a, wa, load_a), (b, wb, load_b)):
            if len(bd.flexibility):
                u = (bd.flexibility @ load)[:-3].reshape(-1, 2)
                if along is not None:
                    pose = pa if bd is a else pb
                    e = np.array(
                        [pose[2] * along[0] + pose[3] * along[1], -pose[3] * along[0] + pose[2] * along[1]]
                    )
                    u = np.outer(u @ e, e)
                w.displacement[:] = u
                w.displacement_stamp[:] = stamp
        n_pairs = nodal.search(a, pa, b, pb, 0.0 if stamp == 1 else 2.0 * _reach(wa, wb), s)
        n = find_regions(a, wa, pa, none, b, wb, pb, none, n_pairs, stamp, s)
        if n < 0:
            raise RuntimeError(
                f"static contact: regions cannot be found (code {n}) after {stamp} evaluations"
            )
        if (s.regions["arcs"][:n] > 1).any():
            raise RuntimeError("static contact: expected one arc of each body a region, got several")
        rows = []
        for r in s.regions[:n]:
            n_a, n_b = arcs(r, s)
            g = nodal.quadrature(a, b, s.x, s.y, s.edge, s.t, n_a, n_b, float(r["chord"]), point, value)
            normal = np.tile([r["nx"], r["ny"]], (g, 1))
            at = np.array([r["enter_x"], r["enter_y"]]) + value[:g, 4:5] * [-r["ny"], r["nx"]]
            rows.append((point[:g].copy(), value[:g].copy(), normal, at))
        if not rows and load_b.any():  # pushed apart: half the loads
            load_a *= 0.5
            load_b *= 0.5
            continue
        if not rows:
            return Solution(np.zeros(2), 0.0, (load_a[:-3].reshape(-1, 2) * 0, load_b[:-3].reshape(-1, 2) * 0),
                            np.zeros((0, 2)), np.zeros(0), np.zeros(0), 0, stamp)  # fmt: skip
        pt, val, normal, at = (np.concatenate(c) for c in zip(*rows, strict=True))
        n_mat_a = _shape(a, pa, pt[:, :2], val[:, 1], normal)
        n_mat_b = _shape(b, pb, pt[:, 2:], val[:, 2], normal)
        weight = val[:, 0] * k
        flex = np.zeros((len(pt), len(pt)))
        displaced = np.zeros(len(pt))
        for bd, w, nm, load, sign in ((a, wa, n_mat_a, load_a, 1.0), (b, wb, n_mat_b, load_b, -1.0)):
            if len(bd.flexibility):
                used = np.flatnonzero(np.abs(nm).sum(0))
                flex += nm[:, used] @ bd.flexibility[np.ix_(used, used)] @ nm[:, used].T
                full = np.zeros(len(load))
                full[:-3] = w.displacement.ravel()
                displaced += sign * (nm @ full)
        # thickness with the present displacements taken out, then the linear system for the new one
        gap = val[:, 3] - displaced
        d = _positive(flex, weight, gap)
        new_a, new_b = -n_mat_a.T @ (weight * d), n_mat_b.T @ (weight * d)
        scale = np.abs(new_b).sum()
        change = np.abs(new_b - load_b).sum() / scale if scale > 0 else np.inf
        if change > 0.5 * best and stamp > 8:
            relax = max(0.5 * relax, 0.1)  # regions that flip between two states: go half the way
        best = min(best, change)
        load_a += relax * (new_a - load_a)
        load_b += relax * (new_b - load_b)
        if change < tolerance:
            f = (weight * d)[:, None] * normal
            arm = at - pb[:2]
            moment = float((arm[:, 0] * f[:, 1] - arm[:, 1] * f[:, 0]).sum())
            return Solution(f.sum(0), moment, (load_a[:-3].reshape(-1, 2), load_b[:-3].reshape(-1, 2)),
                            at, k * d, val[:, 0], n, stamp)  # fmt: skip
    raise RuntimeError(
        f"static contact did not converge in {limit} evaluations: relative change {change:.2g}"
    )


def _reach(wa, wb) -> float:  # type: ignore[no-untyped-def]
    return float(np.abs(wa.displacement).max() + np.abs(wb.displacement).max())


def _positive(flex: Array, weight: Array, gap: Array) -> Array:
    """d ≥ 0 with d + flex (weight d) = gap where d > 0: an active-set loop over Newton's linear systems."""
    active = np.ones(len(gap), bool)
    d = np.zeros(len(gap))
    for _ in range(50):
        i = np.flatnonzero(active)
        d[:] = 0.0
        d[i] = np.linalg.solve(np.eye(len(i)) + flex[np.ix_(i, i)] * weight[i], gap[i])
        would = gap - flex @ (weight * d)
        new = np.where(active, d > 0.0, would > 0.0)
        if (new == active).all():
            break
        active = new
    return np.maximum(d, 0.0)


def _shape(bd: Boundary, pose: Array, points: NDArray[np.int64], share: Array, normal: Array) -> Array:
    """Rows N with N u = n · (displacement of the boundary at a Gauss point), u the interface vector (body frame)."""
    out = np.zeros((len(points), bd.modes.shape[0]))
    local = np.column_stack([pose[2] * normal[:, 0] + pose[3] * normal[:, 1],
                             -pose[3] * normal[:, 0] + pose[2] * normal[:, 1]])  # fmt: skip
    rows = np.arange(len(points))
    for column, w in ((0, 1.0 - share), (1, share)):
        i = points[:, column]
        for node, v in ((bd.low[i], w * (1.0 - bd.share[i])), (bd.high[i], w * bd.share[i])):
            for axis in range(2):
                np.add.at(out, (rows, 2 * node + axis), v * local[:, axis])
    return out


def hub_fixed(b: Boundary, hub: Array | tuple[float, float]) -> Boundary:
    """The boundary with the flexibility of a body whose hub is held: displacements relative to the hub.

    The hub's reaction balances every load, so no inertia relief is left: with T the boundary's rigid motion about
    the hub, C = C_bb − C_bh Tᵀ − T C_hb + T C_hh Tᵀ. ``hub`` (2,): its centre in the body frame; the FE nodes are
    taken from the contact points that lie on them.
    """
    b = complete(b)
    own = np.flatnonzero(b.share == 0.0)
    points = np.zeros(((len(b.modes) - 3) // 2, 2))
    points[b.low[own]] = b.points[own]
    x = points - np.asarray(hub)
    t = np.zeros((2 * len(x), 3))
    t[0::2, 0] = t[1::2, 1] = 1.0
    t[0::2, 2], t[1::2, 2] = -x[:, 1], x[:, 0]
    c, n = b.flexibility, 2 * len(x)
    mixed = c[:n, n:] @ t.T
    out = np.zeros_like(c)
    out[:n, :n] = c[:n, :n] - mixed - mixed.T + t @ c[n:, n:] @ t.T
    return b._replace(flexibility=out)
