"""Exact orientation test with a tie-break: the one geometric decision of the overlap kernel.

Every yes-or-no of the kernel (does this edge cross that one, is this point inside) is the sign of

    side(a, b, p) = (a - p) x (b - p)        > 0: p lies to the left of a -> b

The sign is exact for the coordinates given: a floating-point filter first, expansion arithmetic where the filter
cannot tell (J. R. Shewchuk, Adaptive precision floating-point arithmetic and fast robust geometric predicates,
Discrete Comput Geom 18, 1997, doi:10.1007/PL00009321). A true zero is decided as if outline B were shifted by
(d, d^2), d -> 0+ (simulation of simplicity: Edelsbrunner & Muecke, ACM Trans Graph 9, 1990,
doi:10.1145/77635.77639). One shift of one whole outline removes every degenerate case at once: vertex on edge,
vertex on vertex, shared edges, and it leaves area and centroid as they are, because both are continuous.
"""

from __future__ import annotations

import numpy as np

from ..compile.jit import kernel
from ..compile.raw_memory import floats

#: Relative error bound of the filter, (3 + 16 u) u with u = 2^-53 (Shewchuk's ccwerrboundA).
FILTER = (3.0 + 16.0 * 2.0**-53) * 2.0**-53
#: Magnitude given to a sign that only exact arithmetic or the tie-break could find: nothing beside a real distance.
TINY = 1e-290

_SPLITTER = 134217729.0  # 2^27 + 1, Dekker's split


@kernel
def _two_product(a: float, b: float) -> tuple[float, float]:
    """a b = high + low, exactly (barring overflow)."""
    high = a * b
    t = _SPLITTER * a
    a1 = t - (t - a)
    a2 = a - a1
    t = _SPLITTER * b
    b1 = t - (t - b)
    b2 = b - b1
    return high, a2 * b2 - (((high - a1 * b1) - a2 * b1) - a1 * b2)


@kernel
def _grow(e: np.ndarray, n: int, b: float) -> int:
    """Add b to the non-overlapping expansion e[:n], exactly; returns its new length."""
    q = b
    for i in range(n):
        s = q + e[i]
        t = s - q
        e[i] = (q - (s - t)) + (e[i] - t)
        q = s
    e[n] = q
    return n + 1


@kernel
def _side_expansion(ax: float, ay: float, bx: float, by: float, px: float, py: float, e: np.ndarray) -> int:
    """side(a, b, p) as an exact expansion in e (12 floats); its length."""
    n = 0
    for u, v in ((ax, by), (-ay, bx), (bx, py), (-by, px), (px, ay), (-py, ax)):
        high, low = _two_product(u, v)
        n = _grow(e, n, low)
        n = _grow(e, n, high)
    return n


@kernel
def _sign(e: np.ndarray, n: int) -> float:
    for i in range(n - 1, -1, -1):
        if e[i] != 0.0:
            return 1.0 if e[i] > 0.0 else -1.0
    return 0.0


@kernel
def side_exact(ax: float, ay: float, bx: float, by: float, px: float, py: float) -> float:
    """Sign (-1, 0, 1) of side(a, b, p), exactly."""
    e = floats(12)
    return _sign(e, _side_expansion(ax, ay, bx, by, px, py, e))


@kernel
def order_exact(
    ax: float, ay: float, bx: float, by: float,
    cx: float, cy: float, dx: float, dy: float, ex: float, ey: float, fx: float, fy: float,
) -> float:  # fmt: skip
    """Which of two edges c -> d, e -> f crosses the edge a -> b first: -1 c -> d, 1 e -> f, 0 both in one point.

    Exactly; both must cross. The crossing lies at 1 / (1 - side(b) / side(a)) of a -> b, sides of the crossing edge:
    c -> d is first if side_cd(b) side_ef(a) and side_ef(b) side_cd(a) compare so, for like signs of side(a).
    """
    first_a = floats(12)
    first_b = floats(12)
    second_a = floats(12)
    second_b = floats(12)
    total = floats(640)  # 4 products of 12 x 12 terms would be 576
    n = 0
    fa = _side_expansion(cx, cy, dx, dy, ax, ay, first_a)
    fb = _side_expansion(cx, cy, dx, dy, bx, by, first_b)
    sa = _side_expansion(ex, ey, fx, fy, ax, ay, second_a)
    sb = _side_expansion(ex, ey, fx, fy, bx, by, second_b)
    for i in range(fb):
        for j in range(sa):
            high, low = _two_product(first_b[i], second_a[j])
            n = _grow(total, n, low)
            n = _grow(total, n, high)
    for i in range(sb):
        for j in range(fa):
            high, low = _two_product(-second_b[i], first_a[j])
            n = _grow(total, n, low)
            n = _grow(total, n, high)
    like = 1.0 if (_sign(first_b, fb) > 0.0) == (_sign(second_b, sb) > 0.0) else -1.0
    return like * _sign(total, n)


@kernel
def _undecided(ax: float, ay: float, bx: float, by: float, px: float, py: float, point_of_b: bool) -> float:
    sign = side_exact(ax, ay, bx, by, px, py)
    if (
        sign == 0.0
    ):  # B shifted by (d, d^2): d side / dp = (ay - by, bx - ax); an edge of B moves the other way
        slope = ay - by if ay != by else bx - ax
        sign = 1.0 if (slope > 0.0) == point_of_b else -1.0
    return sign * TINY


@kernel(forceinline=True)
def side(ax: float, ay: float, bx: float, by: float, px: float, py: float, point_of_b: bool) -> float:
    """Twice the signed area of a, b, p, with an exact and never zero sign (length^2).

    `point_of_b`: p belongs to outline B and a, b to A; False the other way round.
    """
    left = (ax - px) * (by - py)
    right = (ay - py) * (bx - px)
    det = left - right
    if abs(det) > FILTER * (abs(left) + abs(right)):
        return det
    return _undecided(ax, ay, bx, by, px, py, point_of_b)
