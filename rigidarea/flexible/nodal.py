"""Nodal pressures and forces of a contact region (the paper's Alg. 3), balanced to rounding.

The paper gives every node a force α d^q A_trib along its own normal and finds the one scalar α by least squares
(Eq. 22, 24), so neither force nor moment balances exactly, and the two bodies' pressures differ (its Fig. 12). Here
the pressure is a field on the chord, the same for both bodies:

    p(x) = (α + β (x − x_c)) d(x)^q,      d(x) = thickness of the region along the contact direction at x,

and each edge hands it to its two nodes by its shape functions (consistent loads; an edge cut by a crossing point
also loads the node outside). Shape functions keep resultant and first moment, so with α, β from

    ∫ p dx = k A,      ∫ p (x − x_c) dx = 0

(the scalar forms of Eq. 17 and 18) the nodal forces of each body sum to the global force and have no moment about the
line through the centroid, both to rounding, and equal and opposite for the two bodies. For q = 1 the solution is
α = k, β = 0 with no equation to solve: the resultant of the local law p = k d *is* k A at the centroid. d is the
penetration along the common direction instead of Eq. 9's along each node's normal; the two agree where the
perimeters are parallel to the chord. Forces are repulsive wherever α + β (x − x_c) is positive; where a
strongly one-sided region with q ≠ 1 would make it negative, the q = 1 field is used, which never pulls.

``literal`` keeps the paper's own version, for the cases that verify it.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rigidarea.flexible.boundary import Boundary, Work, add_load, candidates
from rigidarea.flexible.condense import resultant
from rigidarea.flexible.region import CROSSING, MANY, REGION, arcs, area_and_centroid, find_regions
from rigidarea.kernel.jit import kernel

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

# Three-point Gauss on [0, 1]: exact for q = 2 with linear shape functions
GAUSS_X = (0.5 - 0.5 * 0.6**0.5, 0.5, 0.5 + 0.5 * 0.6**0.5)
GAUSS_W = (5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0)


@kernel
def _straighten(x: Array, side: int, n: int, chord: float) -> bool:
    """Makes x grow along an arc; overhanging parts get no width, so no load. True if there were any."""
    bent = False
    top = 0.0
    for k in range(1, n + 1):
        if x[side, k] < top - 1e-12 * chord or x[side, k] > chord * (1.0 + 1e-12):
            bent = True
        top = min(max(x[side, k], top), chord)
        x[side, k] = top
    return bent


@kernel
def _moments(x: Array, y: Array, n_a: int, n_b: int, q: float, xc: float) -> tuple[float, float, float]:
    """∫ d^q (x − x_c)^i dx for i = 0, 1, 2 over the merged pieces of both arcs."""
    s0 = s1 = s2 = 0.0
    i = j = 0
    lo = 0.0
    while i < n_a and j < n_b:
        hi = min(x[0, i + 1], x[1, j + 1])
        if hi > lo:
            ga = (y[0, i + 1] - y[0, i]) / (x[0, i + 1] - x[0, i])
            gb = (y[1, j + 1] - y[1, j]) / (x[1, j + 1] - x[1, j])
            d0 = y[1, j] + gb * (lo - x[1, j]) - y[0, i] - ga * (lo - x[0, i])
            slope = gb - ga
            for g in range(3):
                e = GAUSS_X[g] * (hi - lo)
                p = GAUSS_W[g] * (hi - lo) * max(d0 + slope * e, 0.0) ** q
                z = lo + e - xc
                s0 += p
                s1 += p * z
                s2 += p * z * z
            lo = hi
        if x[0, i + 1] <= lo:
            i += 1
        else:
            j += 1
    return s0, s1, s2


@kernel(inline="always")
def distribute(
    a: Boundary, wa: Work, b: Boundary, wb: Work, nx: float, ny: float, x: Array, y: Array, edge: Ints, t: Array,
    n_a: int, n_b: int, force: float, area: float, xc: float, chord: float, q: float,
) -> None:  # fmt: skip
    """Adds the nodal loads of one region to both bodies; ``force`` is k A, (nx, ny) the direction of the force on B.

    Arcs as ``region.arcs`` leaves them (x is straightened in place).
    """
    # Both arcs, not "or": each must be straightened.
    bent_a = _straighten(x, 0, n_a, chord)
    bent_b = _straighten(x, 1, n_b, chord)
    linear = q == 1.0 and not (bent_a or bent_b)
    if linear:
        alpha, beta = force / area, 0.0
    else:
        s0, s1, s2 = _moments(x, y, n_a, n_b, q, xc)
        det = s0 * s2 - s1 * s1
        if s0 <= 0.0 or det <= 0.0:
            return
        alpha, beta = force * s2 / det, -force * s1 / det
        if min(alpha - beta * xc, alpha + beta * (chord - xc)) < 0.0:
            q = 1.0
            s0, s1, s2 = _moments(x, y, n_a, n_b, q, xc)
            alpha, beta = force / s0, 0.0
    i = j = 0
    lo = 0.0
    next_a, next_b = a.next, b.next
    load_a, flag_a, touched_a = wa.point_load, wa.point_flag, wa.touched
    load_b, flag_b, touched_b = wb.point_load, wb.point_flag, wb.touched
    a_low = a_high = b_low = b_high = 0.0
    while i < n_a and j < n_b:
        hi = min(x[0, i + 1], x[1, j + 1])
        if hi > lo:
            width_a = 1.0 / (x[0, i + 1] - x[0, i])
            width_b = 1.0 / (x[1, j + 1] - x[1, j])
            ga = (y[0, i + 1] - y[0, i]) * width_a
            gb = (y[1, j + 1] - y[1, j]) * width_b
            d0 = y[1, j] + gb * (lo - x[1, j]) - y[0, i] - ga * (lo - x[0, i])
            slope = gb - ga
            sa = (t[0, i, 1] - t[0, i, 0]) * width_a
            sb = (t[1, j, 1] - t[1, j, 0]) * width_b
            if linear:  # p and the shape functions are linear: their product in closed form
                w = (hi - lo) / 6.0
                p0, p1 = alpha * d0 * w, alpha * (d0 + slope * (hi - lo)) * w
                total = 3.0 * (p0 + p1)
                t0, t1 = t[0, i, 0] + sa * (lo - x[0, i]), t[0, i, 0] + sa * (hi - x[0, i])
                f = p0 * (2.0 * t0 + t1) + p1 * (t0 + 2.0 * t1)
                a_high += f
                a_low += total - f
                t0, t1 = t[1, j, 0] + sb * (lo - x[1, j]), t[1, j, 0] + sb * (hi - x[1, j])
                f = p0 * (2.0 * t0 + t1) + p1 * (t0 + 2.0 * t1)
                b_high += f
                b_low += total - f
                lo = hi
            else:
                for g in range(3):
                    e = GAUSS_X[g] * (hi - lo)
                    z = lo + e
                    d = max(d0 + slope * e, 0.0)
                    p = (alpha + beta * (z - xc)) * (d if q == 1.0 else d**q) * GAUSS_W[g] * (hi - lo)
                    ta = t[0, i, 0] + sa * (z - x[0, i])
                    tb = t[1, j, 0] + sb * (z - x[1, j])
                    a_low += p * (1.0 - ta)
                    a_high += p * ta
                    b_low += p * (1.0 - tb)
                    b_high += p * tb
                lo = hi
        if x[0, i + 1] <= lo:
            add_load(load_a, flag_a, touched_a, edge[0, i], -a_low * nx, -a_low * ny)
            add_load(load_a, flag_a, touched_a, next_a[edge[0, i]], -a_high * nx, -a_high * ny)
            a_low = a_high = 0.0
            i += 1
            # the vertex between two pieces is a node inside: its pressure, Eq. 12 (none on a wall along the force)
            if i < n_a and x[0, i + 1] - x[0, i - 1] > 1e-9 * chord:
                v = _height(x, y, 1, j, x[0, i]) - y[0, i]
                wa.pressure[edge[0, i]] = (alpha + beta * (x[0, i] - xc)) * max(v, 0.0) ** q
        else:
            add_load(load_b, flag_b, touched_b, edge[1, j], b_low * nx, b_low * ny)
            add_load(load_b, flag_b, touched_b, next_b[edge[1, j]], b_high * nx, b_high * ny)
            b_low = b_high = 0.0
            j += 1
            if j < n_b and x[1, j + 1] - x[1, j - 1] > 1e-9 * chord:
                v = y[1, j] - _height(x, y, 0, i, x[1, j])
                wb.pressure[edge[1, j - 1]] = (alpha + beta * (x[1, j] - xc)) * max(v, 0.0) ** q
    if i < n_a:
        add_load(load_a, flag_a, touched_a, edge[0, i], -a_low * nx, -a_low * ny)
        add_load(load_a, flag_a, touched_a, next_a[edge[0, i]], -a_high * nx, -a_high * ny)
    if j < n_b:
        add_load(load_b, flag_b, touched_b, edge[1, j], b_low * nx, b_low * ny)
        add_load(load_b, flag_b, touched_b, next_b[edge[1, j]], b_high * nx, b_high * ny)


@kernel
def quadrature(
    a: Boundary, b: Boundary, x: Array, y: Array, edge: Ints, t: Array, n_a: int, n_b: int, chord: float,
    point: Ints, value: Array,
) -> int:  # fmt: skip
    """Gauss points of the merged arcs, for statics with a consistent tangent: their number.

    point (g, 4): low and high point on A, low and high on B. value (g, 5): weight (length), share of A's high point,
    of B's, thickness d, and x along the chord.
    """
    _straighten(x, 0, n_a, chord)
    _straighten(x, 1, n_b, chord)
    i = j = count = 0
    lo = 0.0
    while i < n_a and j < n_b:
        hi = min(x[0, i + 1], x[1, j + 1])
        if hi > lo:
            wa, wb = x[0, i + 1] - x[0, i], x[1, j + 1] - x[1, j]
            for g in range(3):
                z = lo + GAUSS_X[g] * (hi - lo)
                ra, rb = (z - x[0, i]) / wa, (z - x[1, j]) / wb
                point[count, 0], point[count, 1] = edge[0, i], a.next[edge[0, i]]
                point[count, 2], point[count, 3] = edge[1, j], b.next[edge[1, j]]
                value[count, 0] = GAUSS_W[g] * (hi - lo)
                value[count, 1] = t[0, i, 0] + ra * (t[0, i, 1] - t[0, i, 0])
                value[count, 2] = t[1, j, 0] + rb * (t[1, j, 1] - t[1, j, 0])
                value[count, 3] = (y[1, j] + rb * (y[1, j + 1] - y[1, j])) - (
                    y[0, i] + ra * (y[0, i + 1] - y[0, i])
                )
                value[count, 4] = z
                count += 1
            lo = hi
        if x[0, i + 1] <= lo:
            i += 1
        else:
            j += 1
    return count


@kernel
def _height(x: Array, y: Array, side: int, k: int, at: float) -> float:
    width = x[side, k + 1] - x[side, k]
    return (
        y[side, k] if width <= 0.0 else y[side, k] + (y[side, k + 1] - y[side, k]) * (at - x[side, k]) / width
    )


class Scratch(NamedTuple):
    """Work arrays of one pair: candidate leaves, crossings, regions, and one region's arcs."""

    stack: Ints
    pairs: Ints
    crossings: NDArray[np.void]
    regions: NDArray[np.void]
    x: Array
    y: Array
    edge: Ints
    t: Array


def scratch(points: int) -> Scratch:
    """Arrays for boundaries of up to ``points`` points."""
    return Scratch(
        np.zeros((256, 2), np.int64), np.zeros((16384, 2), np.int64), np.zeros(512, CROSSING), np.zeros(1024, REGION),
        np.zeros((2, points + 3)), np.zeros((2, points + 3)), np.zeros((2, points + 3), np.int64),
        np.zeros((2, points + 3, 2)),
    )  # fmt: skip


@kernel
def _turn(r: Any, x: Array, y: Array, n_a: int, n_b: int, q: float, xc: float, yc: float) -> float:
    """Direction of the force by Eq. 13-15, and the arcs in axes across and along it; returns x of the centroid there.

    An edge's normal times its length is its chord turned by a quarter, so with heights b (arc of A) and t (arc of
    B) over the chord the weighted mean normals are (∫ d^q b' dx, −∫ d^q dx) and (−∫ d^q t' dx, ∫ d^q dx), d = t −
    b: the force leans from the chord's normal by the slope of the middle line. On a flank, whose curvature changes
    along it, the chord alone would be off by a degree at a depth of a twentieth of the module.
    """
    lean = weight = 0.0
    i = j = 0
    lo = 0.0
    chord = r["chord"]
    while i < n_a and j < n_b:
        xa, xb = x[0, i + 1], x[1, j + 1]
        hi = min(xa, xb, chord)
        if hi > lo and xa - x[0, i] > 1e-9 * chord and xb - x[1, j] > 1e-9 * chord:
            ga = (y[0, i + 1] - y[0, i]) / (xa - x[0, i])
            gb = (y[1, j + 1] - y[1, j]) / (xb - x[1, j])
            d0 = y[1, j] + gb * (lo - x[1, j]) - y[0, i] - ga * (lo - x[0, i])
            d1 = d0 + (gb - ga) * (hi - lo)
            w = (0.5 * (d0 + d1) if q == 1.0 else max(0.5 * (d0 + d1), 0.0) ** q) * (hi - lo)
            lean += 0.5 * w * (ga + gb)
            weight += w
            lo = hi
        if xa <= xb:
            i += 1
        else:
            j += 1
    if weight <= 0.0:
        return xc
    lean = min(max(lean / weight, -1.0), 1.0)  # beyond 45° the arcs are no graphs over the chord
    c = 1.0 / np.sqrt(1.0 + lean * lean)
    s = lean * c
    for k in range(n_a + 1):
        x[0, k], y[0, k] = c * x[0, k] + s * y[0, k], -s * x[0, k] + c * y[0, k]
    for k in range(n_b + 1):
        x[1, k], y[1, k] = c * x[1, k] + s * y[1, k], -s * x[1, k] + c * y[1, k]
    nx, ny = r["nx"], r["ny"]
    r["nx"], r["ny"] = c * nx - s * ny, c * ny + s * nx
    return c * xc + s * yc


@kernel
def search(a: Boundary, pose_a: Array, b: Boundary, pose_b: Array, margin: float, s: Scratch) -> int:
    """Candidate leaf pairs into ``s.pairs``; their number, or MANY."""
    return candidates(a, pose_a, b, pose_b, margin, s.stack, s.pairs)


@kernel
def contact(
    a: Boundary, wa: Work, pose_a: Array, qa: Array, b: Boundary, wb: Work, pose_b: Array, qb: Array,
    n_pairs: int, stamp: int, k: float, q: float, spread: bool, s: Scratch,
) -> int:  # fmt: skip
    """Alg. 1–3 for one pair of bodies: fills ``s.regions`` and, if ``spread``, adds the loads of their points.

    k: stiffness, pressure (a force per area in 2-D). q: the pressure exponent. Returns the number of regions or an
    error code of ``region``. The force on B is region.force · (nx, ny) at (x, y), on A its opposite.
    """
    n = find_regions(a, wa, pose_a, qa, b, wb, pose_b, qb, s.pairs, n_pairs, stamp, s.crossings, s.regions)
    for i in range(n):
        r = s.regions[i]
        n_a, n_b = arcs(a, wa, pose_a, qa, b, wb, pose_b, qb, r, stamp, s.x, s.y, s.edge, s.t)
        if n_a == MANY:
            return MANY
        area, xc, yc = area_and_centroid(s.x, s.y, n_a, n_b)
        r["area"], r["force"], r["give"] = area, k * area, 1.0  # Eq. 5
        ux, uy = -r["ny"], r["nx"]
        r["x"], r["y"] = r["enter_x"] + ux * xc - uy * yc, r["enter_y"] + uy * xc + ux * yc
        if area <= 0.0:
            continue
        xc = _turn(r, s.x, s.y, n_a, n_b, q, xc, yc)
        if spread:
            resultant(a, wa, pose_a, b, wb, pose_b, r, s.edge, n_a, n_b, k * r["chord"])
            distribute(
                a,
                wa,
                b,
                wb,
                r["nx"],
                r["ny"],
                s.x,
                s.y,
                s.edge,
                s.t,
                n_a,
                n_b,
                r["force"],
                area,
                xc,
                s.x[0, n_a],
                q,
            )
    return n


def literal(arc: Array, other: Array, q: float) -> tuple[Array, Array, Array, Array]:
    """Eq. 8–11 for one body: the nodes of ``arc`` inside the other body, its two end points the crossings.

    arc (n + 2, 2): crossing, nodes inside, crossing, in the order of the body's perimeter; other (m, 2): the other
    body's arc between the same crossings. A node whose normal misses that arc (one on a side wall; the paper leaves
    this case open) gets distance 0, so no force. Returns normals (n, 2) towards the other perimeter, distances (n,),
    tributary lengths (n,), and the weights A_trib d^q (n,) of Eq. 13.
    """
    tangent = arc[2:] - arc[:-2]
    normal = np.column_stack([-tangent[:, 1], tangent[:, 0]]) / np.hypot(*tangent.T)[:, None]  # Eq. 8
    step = np.hypot(*np.diff(arc, axis=0).T)
    tributary = 0.5 * (step[1:] + step[:-1])  # Eq. 11
    p = arc[1:-1]
    r, s = other[:-1], np.diff(other, axis=0)
    cross = normal[:, None, 0] * s[None, :, 1] - normal[:, None, 1] * s[None, :, 0]
    rel = r[None] - p[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        along = (rel[..., 0] * s[None, :, 1] - rel[..., 1] * s[None, :, 0]) / cross
        on = (rel[..., 0] * normal[:, None, 1] - rel[..., 1] * normal[:, None, 0]) / cross
    along = np.where((on >= -1e-12) & (on <= 1 + 1e-12), along, np.inf)
    pick = np.abs(along).argmin(1)
    distance = along[np.arange(len(p)), pick]  # Eq. 9; its sign turns the normal to the other perimeter
    distance = np.where(np.isfinite(distance), distance, 0.0)
    normal = normal * np.where(distance < 0, -1.0, 1.0)[:, None]
    distance = np.abs(distance)
    return normal, distance, tributary, tributary * distance**q


def literal_alpha(normal: Array, weight: Array, nodes: Array, centroid: Array, force: Array) -> float:
    """α of Eq. 22: least squares over force and moment about the centroid, ``force`` (2,) the global force."""
    f = weight[:, None] * normal
    arm = nodes - centroid
    b = np.array([f[:, 0].sum(), f[:, 1].sum(), (arm[:, 0] * f[:, 1] - arm[:, 1] * f[:, 0]).sum()])
    return float(b[:2] @ force / (b @ b))
