"""Direction and nodal loads of any region: several arcs a body, arcs that fold back, any pressure exponent.

Cut along the force at every vertex, a region falls into slabs, in each of which every boundary piece that runs
through it is straight. With the signs of their widths, the pieces of A there sum to what A has at the bottom, less
what it has on top; those of B to as much (a closed curve). That net width carries the slab's pressure

    p(x) = (α + β (x − x_c)) d(x)^q,      d(x) = thickness of the region at x (Alg. 3, see ``nodal``),

in equal parts on those pieces that face the right way, so that no other node is loaded. Three-point Gauss: exact for
q = 1 and 2.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rigidarea.compile.jit import kernel
from rigidarea.flexible.boundary import Boundary, Work
from rigidarea.flexible.boundary_places import add_load
from rigidarea.flexible.scratch import Scratch

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

WALL = 1e-9  # width over that of the region below which a piece stands along the force
# Three-point Gauss on [0, 1]
GAUSS_X = (0.5 - 0.5 * 0.6**0.5, 0.5, 0.5 + 0.5 * 0.6**0.5)
GAUSS_W = (5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0)


@kernel
def cuts(x: Array, n_a: int, n_b: int, cut: Array) -> int:
    """The vertices' positions along the chord, sorted; their number."""
    i = j = 0
    for k in range(n_a + n_b + 2):  # the rows merged, then what folds back put in its place
        if j > n_b or (i <= n_a and x[0, i] <= x[1, j]):
            v, i = x[0, i], i + 1
        else:
            v, j = x[1, j], j + 1
        m = k
        while m > 0 and cut[m - 1] > v:
            cut[m] = cut[m - 1]
            m -= 1
        cut[m] = v
    return n_a + n_b + 2


@kernel
def slab(
    x: Array, y: Array, t: Array, n_a: int, n_b: int, lo: float, hi: float
) -> tuple[float, float, float, int, int, int]:
    """Thickness at both ends of a slab, slope of its middle line, net pieces, pieces of A and of B that carry."""
    d0 = d1 = slope_a = slope_b = 0.0
    net = right_a = right_b = 0
    for side in range(2):
        for k in range(n_a if side == 0 else n_b):
            x0, x1 = x[side, k], x[side, k + 1]
            if min(x0, x1) > lo or max(x0, x1) < hi or t[side, k, 0] == t[side, k, 1]:
                continue
            slope = (y[side, k + 1] - y[side, k]) / (x1 - x0)
            y0 = y[side, k] + slope * (lo - x0)
            y1 = y[side, k] + slope * (hi - x0)
            sign = 1 if x1 > x0 else -1
            if side == 0:
                d0, d1, net = d0 - sign * y0, d1 - sign * y1, net + sign
                if sign > 0:
                    slope_a, right_a = slope_a + slope, right_a + 1
            else:
                d0, d1 = d0 + sign * y0, d1 + sign * y1
                if sign > 0:
                    slope_b, right_b = slope_b + slope, right_b + 1
    middle = 0.5 * (slope_a / max(right_a, 1) + slope_b / max(right_b, 1))
    return max(d0, 0.0), max(d1, 0.0), middle, net, right_a, right_b


@kernel
def lean(x: Array, y: Array, t: Array, n_a: int, n_b: int, q: float, cut: Array) -> float:
    """Slope of the region's middle line over the chord, weighted by d^q: see ``nodal``."""
    total = weight = 0.0
    n = cuts(x, n_a, n_b, cut)
    wall = WALL * (cut[n - 1] - cut[0])  # a piece along the force has no slope to speak of
    for m in range(n - 1):
        lo, hi = cut[m], cut[m + 1]
        if hi > lo + wall:
            d0, d1, middle, net, _right_a, _right_b = slab(x, y, t, n_a, n_b, lo, hi)
            if net > 0:
                w = net * (0.5 * (d0 + d1)) ** q * (hi - lo)
                total += w * middle
                weight += w
    return total / weight if weight > 0.0 else 0.0


@kernel
def _moments(
    x: Array, y: Array, t: Array, n_a: int, n_b: int, q: float, xc: float, cut: Array, n: int
) -> tuple[float, float, float, float, float]:
    """∫ d^q (x − x_c)^i dx for i = 0, 1, 2 over the net width, and between which x − x_c that lies."""
    s0 = s1 = s2 = 0.0
    first, last = np.inf, -np.inf
    for m in range(n - 1):
        lo, hi = cut[m], cut[m + 1]
        if hi > lo:
            d0, d1, _middle, net, _right_a, _right_b = slab(x, y, t, n_a, n_b, lo, hi)
            if net > 0:
                first, last = min(first, lo - xc), hi - xc
                for g in range(3):
                    p = net * GAUSS_W[g] * (hi - lo) * (d0 + (d1 - d0) * GAUSS_X[g]) ** q
                    z = lo + GAUSS_X[g] * (hi - lo) - xc
                    s0, s1, s2 = s0 + p, s1 + p * z, s2 + p * z * z
    return s0, s1, s2, first, last


@kernel
def distribute(
    a: Boundary, wa: Work, b: Boundary, wb: Work, nx: float, ny: float, s: Scratch, n_a: int, n_b: int, force: float,
    xc: float, q: float,
) -> tuple[float, float, float]:  # fmt: skip
    """Adds the loads of one region to both bodies' points; (nx, ny) is the direction of the force on B.

    Returns α, β and the exponent.

    ∫ p dx = ``force`` and ∫ p (x − x_c) dx = 0 fix α and β. Where p would pull, q = 1 takes the place of q. With one
    arc a body that never pulls, being α = k, β = 0; with several it does where their net width lies too far to one
    side of the centroid, and balance goes before repulsion.
    """
    x, y, t, edge, cut = s.x, s.y, s.t, s.edge, s.cut
    n = cuts(x, n_a, n_b, cut)
    alpha = beta = 0.0
    for _ in range(2):
        s0, s1, s2, first, last = _moments(x, y, t, n_a, n_b, q, xc, cut, n)
        det = s0 * s2 - s1 * s1
        if s0 <= 0.0 or det <= 0.0:
            return 0.0, 0.0, 1.0
        alpha, beta = force * s2 / det, -force * s1 / det
        if q == 1.0 or min(alpha + beta * first, alpha + beta * last) >= 0.0:
            break
        q = 1.0
    for m in range(n - 1):
        lo, hi = cut[m], cut[m + 1]
        if hi <= lo:
            continue
        d0, d1, _middle, net, right_a, right_b = slab(x, y, t, n_a, n_b, lo, hi)
        if net <= 0:
            continue
        for side in range(2):
            body, w = (a, wa) if side == 0 else (b, wb)
            sign = -1.0 if side == 0 else 1.0
            part = net / right_a if side == 0 else net / right_b
            count = n_a if side == 0 else n_b
            for k in range(count):
                x0, x1 = x[side, k], x[side, k + 1]
                if x0 > lo or x1 < hi or t[side, k, 0] == t[side, k, 1]:
                    continue
                low = high = 0.0
                for g in range(3):
                    z = lo + GAUSS_X[g] * (hi - lo)
                    p = (alpha + beta * (z - xc)) * (d0 + (d1 - d0) * GAUSS_X[g]) ** q
                    f = sign * part * GAUSS_W[g] * (hi - lo) * p
                    share = t[side, k, 0] + (t[side, k, 1] - t[side, k, 0]) * (z - x0) / (x1 - x0)
                    low, high = low + f * (1.0 - share), high + f * share
                i = edge[side, k]
                add_load(w.point_load, w.point_flag, w.touched, i, low * nx, low * ny)
                add_load(w.point_load, w.point_flag, w.touched, body.following[i], high * nx, high * ny)
                # a node inside, Eq. 12 (none on a wall along the force)
                if k + 1 == count or t[side, k + 1, 0] == t[side, k + 1, 1] or x[side, k + 2] < x1 or x1 > hi:
                    continue
                if x[side, k + 2] - x0 > WALL * (cut[n - 1] - cut[0]):
                    node = edge[0, k + 1] if side == 0 else i
                    w.pressure[node] = (alpha + beta * (x1 - xc)) * d1**q
    return alpha, beta, q
