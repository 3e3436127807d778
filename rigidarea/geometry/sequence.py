"""In what order boundaries with arcs cross: from one crossing to the next along each ring.

Where a crossing lies is rounded, by noise over the sine of the angle at which the two edges cross. Between the
crossings of an edge with two others lies a corner that is further from it than rounding (`arc`), so their order is
right all the same; that of the two crossings of one pair follows from one root, if that is not lost in rounding. What
is left are crossings as good as in one point: a tangent that cuts by rounding, the two legs of a cusp, rings that touch
each other. Theirs is told by where the ring comes from: whether its first corner lies inside the other outline is
certain, as no corner is near the other boundary, and from there on a boundary that is outside can only enter, and
inside only leave. Which of two entries is taken first changes slivers as thin as rounding.

So each ring's stretches inside the other outline are right but for slivers, and as both boundaries have the same
crossings, the stretches close: area and centroid are sums over them, however they are paired to loops.
"""

from __future__ import annotations

import numpy as np

from ..compile.jit import kernel
from .locate import inside_outline
from .pool import Pool
from .work import A_EDGE, Relative, Work, placed


@kernel(forceinline=True)
def link_two(
    ring_a: np.ndarray, ring_b: np.ndarray, cross: np.ndarray, param: np.ndarray, spot: np.ndarray,
    order: np.ndarray, near: float,
) -> bool:  # fmt: skip
    """`link_curved` along both outlines for the two crossings that most pairs have; False: ask that."""
    if (
        cross[0, 2] == cross[1, 2]
        or ring_a[cross[0, 0]] != ring_a[cross[1, 0]]
        or ring_b[cross[0, 1]] != ring_b[cross[1, 1]]
        or abs(spot[0, 0] - spot[1, 0]) + abs(spot[0, 1] - spot[1, 1]) <= near
    ):
        return False
    for along in range(2):
        e = cross[0, along]
        f = cross[1, along]
        first = 0 if e < f or (e == f and param[0, along] <= param[1, along]) else 1
        order[2 + along, first] = 1 - first
        order[2 + along, 1 - first] = ~first
    return True


@kernel
def _sort(cross: np.ndarray, param: np.ndarray, order: np.ndarray, n: int, along: int) -> None:
    """order[along]: the crossings by edge, and by where they are on it."""
    for i in range(n):  # insertion sort: n is small, and crossings come nearly in order
        j = i
        while j > 0:
            m = order[along, j - 1]
            if cross[m, along] < cross[i, along] or (
                cross[m, along] == cross[i, along] and param[m, along] <= param[i, along]
            ):
                break
            order[along, j] = m
            j -= 1
        order[along, j] = i


@kernel
def alternate(
    cross: np.ndarray, spot: np.ndarray, order: np.ndarray, along: int, wanted: int, near: float
) -> bool:
    """Put a ring's crossings, order (n,), so that each leads out of the other outline or into it in turn.

    wanted: the sign of the first. Only crossings on one edge that are as good as in one point, each nearer than `near`
    (length) to the next, change places. False if that is not enough.
    """
    n = len(order)
    for h in range(n):
        g = h
        while cross[order[g], 2] != wanted:
            if g + 1 == n:
                return False
            k = order[g]
            m = order[g + 1]
            if (
                cross[k, along] != cross[m, along]
                or abs(spot[k, 0] - spot[m, 0]) + abs(spot[k, 1] - spot[m, 1]) > near
            ):
                return False
            g += 1
        m = order[g]
        for f in range(g, h, -1):
            order[f] = order[f - 1]
        order[h] = m
        wanted = -wanted
    return n % 2 == 0


@kernel
def link_curved(
    pool: Pool, other: Pool, o: int, rel: Relative, n: int, along: int, work: Work, near: float
) -> bool:
    """order[2 + along, k]: the crossing after k along its ring of A (0) or B (1), see `crossings.link`.

    pool: of the outline whose rings they are; other, o: the other one. False: they are not to be brought in order.
    """
    cross = work.cross
    spot = work.spot
    order = work.order
    _sort(cross, work.param, order, n, along)
    low = 0
    while low < n:
        ring = pool.ring_of[cross[order[along, low], along]]
        last = low
        doubtful = False
        while last + 1 < n and pool.ring_of[cross[order[along, last + 1], along]] == ring:
            k = order[along, last]
            m = order[along, last + 1]
            doubtful = doubtful or (
                cross[k, along] == cross[m, along]
                and abs(spot[k, 0] - spot[m, 0]) + abs(spot[k, 1] - spot[m, 1]) <= near
            )
            last += 1
        wanted = cross[order[along, low], 2]
        if doubtful:
            place = Relative(1.0, 0.0, 0.0, 0.0) if along == A_EDGE else rel
            x, y = placed(pool.points, pool.rings[ring, 0], place)
            inside = inside_outline(other, o, rel, x, y, along != A_EDGE, work)
            wanted = 1 if inside != (along == A_EDGE) else -1  # where A enters B, B leaves A
        if not alternate(cross, spot, order[along, low : last + 1], along, wanted, near):
            return False
        for high in range(low, last + 1):
            k = order[along, high]
            m = order[along, high + 1 if high < last else low]
            order[2 + along, k] = m if high < last else ~m  # ~: past the start of the ring
        low = last + 1
    return True
