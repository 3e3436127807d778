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
perimeters are parallel to the chord.

This module has the usual region, whose two arcs are graphs over the chord, with q = 1: one walk along both arcs, in
closed form. ``slabs`` has the rest: other q, arcs that fold back, several arcs a body. ``literal`` has the paper's
own version, for the cases that verify it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rigidarea.compile.jit import entry, kernel
from rigidarea.flexible.boundary import Boundary, Work
from rigidarea.flexible.boundary_places import add_load
from rigidarea.flexible.boundary_regions import arcs, find_regions
from rigidarea.flexible.boundary_search import search as search
from rigidarea.flexible.condense import couple, couple_slabs, room
from rigidarea.flexible.paper_loads import literal as literal
from rigidarea.flexible.paper_loads import literal_alpha as literal_alpha
from rigidarea.flexible.quadrature import quadrature as quadrature
from rigidarea.flexible.scratch import FULL, Scratch
from rigidarea.flexible.scratch import scratch as scratch
from rigidarea.flexible.slabs import distribute as distribute_slabs
from rigidarea.flexible.slabs import lean as lean_slabs

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

WALL = 1e-9  # width over that of the region below which a piece stands along the force: no slope, no pressure


@kernel(forceinline=True)
def _straight(x: Array, n: int, chord: float) -> bool:
    """Whether an arc is a graph over the chord; what rounding folds back, or beyond the ends, is put straight."""
    slack = 1e-12 * chord
    graph = True
    last = 0.0
    for k in range(1, n + 1):
        graph &= (x[k] >= last - slack) & (x[k] <= chord + slack)
        last = min(max(x[k], last), chord)
        x[k] = last if graph else x[k]
    return graph


@kernel(forceinline=True)
def _slope(x: Array, y: Array, k: int, wall: float = 0.0) -> float:
    """Slope of piece k; a piece no wider than ``wall`` stands along the force and has none."""
    width = x[k + 1] - x[k]
    return (y[k + 1] - y[k]) / width if width > wall else 0.0


@kernel(forceinline=True)
def _rate(x: Array, t: Array, k: int) -> float:
    """How the parameter on the edge grows along piece k."""
    width = x[k + 1] - x[k]
    return (t[k, 1] - t[k, 0]) / width if width > 0.0 else 0.0


@kernel(forceinline=True)
def _lean(xa: Array, ya: Array, xb: Array, yb: Array, n_a: int, n_b: int) -> float:
    """∫ d (slope of A + slope of B)/2 dx over two graphs: see ``_turn``."""
    wall = WALL * xa[n_a]
    lean = lo = d0 = 0.0
    i = j = 0
    ga, gb = _slope(xa, ya, 0, wall), _slope(xb, yb, 0, wall)
    while True:
        if xa[i + 1] <= xb[j + 1]:
            hi = xa[i + 1]
            d1 = yb[j] + gb * (hi - xb[j]) - ya[i + 1]
            lean += (d0 + d1) * (hi - lo) * (ga + gb)
            i += 1
            if i == n_a:
                break
            ga = _slope(xa, ya, i, wall)
        else:
            hi = xb[j + 1]
            d1 = yb[j + 1] - ya[i] - ga * (hi - xa[i])
            lean += (d0 + d1) * (hi - lo) * (ga + gb)
            j += 1
            if j == n_b:
                break
            gb = _slope(xb, yb, j, wall)
        lo, d0 = hi, d1
    return 0.25 * lean


@kernel(forceinline=True)
def _turn(x: Array, y: Array, n_a: int, n_b: int, lean: float) -> tuple[float, float]:
    """Turns the arcs into axes across and along the force; returns cosine and sine.

    An edge's normal times its length is its chord turned by a quarter, so with heights b (arc of A) and t (arc of
    B) over the chord the weighted mean normals of Eq. 13 are (∫ d^q b' dx, −∫ d^q dx) and (−∫ d^q t' dx, ∫ d^q dx),
    d = t − b, and by Eq. 15 the force leans from the chord's normal by the slope of the middle line. On a flank,
    whose curvature changes along it, the chord alone would be off by a degree at a depth of a twentieth of the
    module.
    """
    lean = min(max(lean, -1.0), 1.0)  # beyond 45° the arcs are no graphs over the chord
    c = 1.0 / np.sqrt(1.0 + lean * lean)
    s = lean * c
    for side in range(2):
        for k in range((n_a if side == 0 else n_b) + 1):
            x[side, k], y[side, k] = c * x[side, k] + s * y[side, k], -s * x[side, k] + c * y[side, k]
    return c, s


@kernel(forceinline=True)
def _distribute(
    a: Boundary, wa: Work, b: Boundary, wb: Work, nx: float, ny: float, xa: Array, ya: Array, xb: Array, yb: Array,
    edge_a: Ints, edge_b: Ints, ta: Array, tb: Array, n_a: int, n_b: int, k: float,
) -> None:  # fmt: skip
    """Adds the loads of one region, p = k d, to both bodies' points; (nx, ny) is the direction of the force on B.

    Arcs as ``region.arcs`` leaves them, both graphs over the chord. Between two vertices p and the shape functions
    are linear, so their product has a closed form.
    """
    load_a, flag_a, touched_a, pressure_a = wa.point_load, wa.point_flag, wa.touched, wa.pressure
    load_b, flag_b, touched_b, pressure_b = wb.point_load, wb.point_flag, wb.touched, wb.pressure
    wall = WALL * xa[n_a]
    next_a, next_b = a.following, b.following
    lo = d0 = a_low = a_high = b_low = b_high = carry_a = carry_b = 0.0
    i = j = 0
    ga, gb = _slope(xa, ya, 0), _slope(xb, yb, 0)
    sa, sb = _rate(xa, ta, 0), _rate(xb, tb, 0)
    ta0, tb0 = ta[0, 0], tb[0, 0]
    while True:
        on_a = xa[i + 1] <= xb[j + 1]
        if on_a:
            hi = xa[i + 1]
            d1 = yb[j] + gb * (hi - xb[j]) - ya[i + 1]
            ta1, tb1 = ta[i, 1], tb[j, 0] + sb * (hi - xb[j])
        else:
            hi = xb[j + 1]
            d1 = yb[j + 1] - ya[i] - ga * (hi - xa[i])
            ta1, tb1 = ta[i, 0] + sa * (hi - xa[i]), tb[j, 1]
        w = k * (hi - lo) / 6.0
        p0, p1 = w * d0, w * d1
        total = 3.0 * (p0 + p1)
        f = p0 * (2.0 * ta0 + ta1) + p1 * (ta0 + 2.0 * ta1)
        a_low, a_high = a_low + (total - f), a_high + f
        f = p0 * (2.0 * tb0 + tb1) + p1 * (tb0 + 2.0 * tb1)
        b_low, b_high = b_low + (total - f), b_high + f
        if on_a:
            f = carry_a + a_low
            add_load(load_a, flag_a, touched_a, edge_a[i], -f * nx, -f * ny)
            carry_a, a_low, a_high = a_high, 0.0, 0.0
            i += 1
            if i == n_a:
                break
            ga, sa, ta1 = _slope(xa, ya, i), _rate(xa, ta, i), ta[i, 0]
            if xa[i + 1] - xa[i - 1] > wall:
                pressure_a[edge_a[i]] = k * max(d1, 0.0)  # Eq. 12, at a node inside
        else:
            f = carry_b + b_high
            add_load(load_b, flag_b, touched_b, next_b[edge_b[j]], f * nx, f * ny)
            carry_b, b_low, b_high = b_low, 0.0, 0.0
            j += 1
            if j == n_b:
                break
            gb, sb, tb1 = _slope(xb, yb, j), _rate(xb, tb, j), tb[j, 0]
            if xb[j + 1] - xb[j - 1] > wall:
                pressure_b[edge_b[j - 1]] = k * max(d1, 0.0)
        lo, d0, ta0, tb0 = hi, d1, ta1, tb1
    if i < n_a:
        f = carry_a + a_low
        add_load(load_a, flag_a, touched_a, edge_a[i], -f * nx, -f * ny)
        carry_a, i = a_high, i + 1
    add_load(load_a, flag_a, touched_a, next_a[edge_a[i - 1]], -carry_a * nx, -carry_a * ny)
    if j < n_b:
        f = carry_b + b_high
        add_load(load_b, flag_b, touched_b, next_b[edge_b[j]], f * nx, f * ny)
        carry_b, j = b_low, j + 1
    add_load(load_b, flag_b, touched_b, edge_b[j - 1], carry_b * nx, carry_b * ny)


@entry
def contact(
    a: Boundary, wa: Work, pose_a: Array, qa: Array, b: Boundary, wb: Work, pose_b: Array, qb: Array,
    n_pairs: int, stamp: int, k: float, q: float, spread: bool, s: Scratch,
) -> int:  # fmt: skip
    """Alg. 1–3 for one pair of bodies: fills ``s.regions`` and, if ``spread``, adds the loads of their points.

    k: stiffness, pressure (a force per area in 2-D). q: the pressure exponent. Where ``s`` has room for loads they
    are also written there, as unknowns (``condense``). Returns the number of regions or an error code of ``scratch``.
    The force on B is region.force · (nx, ny) at (x, y), on A its opposite.
    """
    n = find_regions(a, wa, pose_a, qa, b, wb, pose_b, qb, n_pairs, stamp, s)
    x, y = s.x, s.y
    s.load.made[3] = -1  # no flat of another pair's
    for i in range(n):
        r = s.regions[i]
        n_a, n_b = arcs(r, s)
        area = r["area"]
        ux, uy = -r["ny"], r["nx"]
        r["force"], r["serial"] = k * area, 0  # Eq. 5
        graphs = r["arcs"] == 1 and q == 1.0
        graphs = graphs and _straight(x[0], n_a, r["chord"]) and _straight(x[1], n_b, r["chord"])
        if graphs:
            lean = _lean(x[0], y[0], x[1], y[1], n_a, n_b) / area
        else:
            lean = lean_slabs(x, y, s.t, n_a, n_b, q, s.cut)
        c, sn = _turn(x, y, n_a, n_b, lean)
        r["nx"], r["ny"] = c * uy + sn * ux, sn * uy - c * ux
        if not spread:
            continue
        nx, ny = r["nx"], r["ny"]
        answers = len(s.load.force) > 0
        if answers and not room(s, n_a, n_b):
            return FULL
        xc = ny * (r["enter_x"] - r["x"]) - nx * (r["enter_y"] - r["y"])  # along the turned axis
        if graphs and _straight(x[0], n_a, x[0, n_a]) and _straight(x[1], n_b, x[0, n_a]):
            _distribute(
                a,
                wa,
                b,
                wb,
                nx,
                ny,
                x[0],
                y[0],
                x[1],
                y[1],
                s.edge[0],
                s.edge[1],
                s.t[0],
                s.t[1],
                n_a,
                n_b,
                k,
            )
            if answers:
                couple(a, wa, pose_a, b, wb, pose_b, r, s, n_a, n_b, k)
        else:
            alpha, beta, power = distribute_slabs(a, wa, b, wb, nx, ny, s, n_a, n_b, r["force"], xc, q)
            if answers:
                couple_slabs(a, wa, pose_a, b, wb, pose_b, r, s, n_a, n_b, k, alpha, beta, xc, power)
        r["serial"] = s.load.made[1]
    return n
