"""Where two boundaries cross, and in what order along each.

Both hierarchies are walked together; where two leaves meet, edge pairs are tested with the exact predicate. So the
set of crossings is exact, for B shifted by an infinitesimal (see `predicates`); so is the order of two crossings that
could be confused, those of the two legs of a corner. On every ring crossings then alternate between entering the
other outline and leaving it.
"""

from __future__ import annotations

import numpy as np

from ..compile.jit import kernel
from .curved import cross_curved_leaves
from .pool import LEAF, Pool
from .predicates import order_exact, side
from .work import A_EDGE, OVERFLOW, Relative, Work, noise_of, placed

#: Of two outlines with arcs and so few pairs of edges all are tried: two rounded boxes have 64.
FEW = 128


@kernel(forceinline=True)
def boxes_meet(qa: np.ndarray, na: int, qb: np.ndarray, nb: int, rel: Relative, pad: float) -> bool:
    """Separating axes of two hierarchy boxes, B's wider by `pad` all round: the two of A's frame, the two of B's."""
    ac = abs(rel.c)
    as_ = abs(rel.s)
    bhx = qb[nb, 2] + pad
    bhy = qb[nb, 3] + pad
    ahx = qa[na, 2]
    ahy = qa[na, 3]
    bx = qb[nb, 0]
    by = qb[nb, 1]
    dx = rel.c * bx - rel.s * by + rel.tx - qa[na, 0]
    dy = rel.s * bx + rel.c * by + rel.ty - qa[na, 1]
    return (
        abs(dx) <= ahx + ac * bhx + as_ * bhy
        and abs(dy) <= ahy + as_ * bhx + ac * bhy
        and abs(rel.c * dx + rel.s * dy) <= bhx + ac * ahx + as_ * ahy
        and abs(rel.c * dy - rel.s * dx) <= bhy + as_ * ahx + ac * ahy
    )


@kernel(forceinline=True)
def go_down(
    qa: np.ndarray, box_a: int, na: int, leaf_a: bool, qb: np.ndarray, box_b: int, nb: int, leaf_b: bool,
    stack: np.ndarray, depth: int,
) -> int:  # fmt: skip
    """Put the pairs of nodes below (na, nb) on the stack, of the larger box's children; its depth then."""
    size_a = qa[box_a, 2] + qa[box_a, 3]
    size_b = qb[box_b, 2] + qb[box_b, 3]
    if leaf_b or (not leaf_a and size_a >= size_b):
        stack[depth, 0] = 2 * na
        stack[depth, 1] = nb
        stack[depth + 1, 0] = 2 * na + 1
        stack[depth + 1, 1] = nb
    else:
        stack[depth, 0] = na
        stack[depth, 1] = 2 * nb
        stack[depth + 1, 0] = na
        stack[depth + 1, 1] = 2 * nb + 1
    return depth + 2


@kernel
def cross_leaves(
    qa: np.ndarray, next_a: np.ndarray, a0: int, a1: int, qb: np.ndarray, next_b: np.ndarray, b0: int, b1: int,
    rel: Relative, cross: np.ndarray, param: np.ndarray, spot: np.ndarray, n: int,
) -> int:  # fmt: skip
    """Append the crossings of edges a0..a1 of A with edges b0..b1 of B; their number then, or OVERFLOW."""
    for j in range(b0, b1):
        cx, cy = placed(qb, j, rel)
        dx, dy = placed(qb, next_b[j], rel)
        low_x = min(cx, dx)
        high_x = max(cx, dx)
        low_y = min(cy, dy)
        high_y = max(cy, dy)
        for i in range(a0, a1):
            ax = qa[i, 0]
            ay = qa[i, 1]
            k = next_a[i]
            bx = qa[k, 0]
            by = qa[k, 1]
            if max(ax, bx) < low_x or min(ax, bx) > high_x or max(ay, by) < low_y or min(ay, by) > high_y:
                continue
            sc = side(ax, ay, bx, by, cx, cy, True)
            sd = side(ax, ay, bx, by, dx, dy, True)
            if (sc > 0.0) == (sd > 0.0):
                continue
            sa = side(cx, cy, dx, dy, ax, ay, False)
            sb = side(cx, cy, dx, dy, bx, by, False)
            if (sa > 0.0) == (sb > 0.0):
                continue
            if n == len(cross):
                return OVERFLOW
            cross[n, 0] = i
            cross[n, 1] = j
            cross[n, 2] = 1 if sb > 0.0 else -1
            # The point on the shorter edge (less room for rounding), the other parameter from the point: edges that
            # are parallel within rounding cross anywhere along their common stretch, but not outside of it.
            ux = bx - ax
            uy = by - ay
            vx = dx - cx
            vy = dy - cy
            uu = ux * ux + uy * uy
            vv = vx * vx + vy * vy
            if vv < uu:
                u = sc / (sc - sd)
                x = cx + u * vx
                y = cy + u * vy
                t = ((x - ax) * ux + (y - ay) * uy) / uu
            else:
                t = sa / (sa - sb)
                x = ax + t * ux
                y = ay + t * uy
                u = ((x - cx) * vx + (y - cy) * vy) / vv
            param[n, 0] = t
            param[n, 1] = u
            spot[n, 0] = x
            spot[n, 1] = y
            n += 1
    return n


@kernel
def crossings(pa: Pool, ia: int, pb: Pool, ib: int, rel: Relative, work: Work) -> int:
    """All crossings of the two boundaries, by a walk down both hierarchies at once."""
    ha = pa.heads[ia]
    hb = pb.heads[ib]
    pad = noise_of(ha.radius, hb.radius, rel)
    if (ha.arcs or hb.arcs) and ha.count * hb.count <= FEW:
        return cross_curved_leaves(
            pa.points, pa.following, pa.arcs, ha.point, ha.point + ha.count, pa.boxes, ha.box + 1,
            pb.points, pb.following, pb.arcs, hb.point, hb.point + hb.count, rel, pad,
            work.cross, work.param, work.spot, 0,
        )  # fmt: skip
    stack = work.stack
    stack[0, 0] = 1
    stack[0, 1] = 1
    depth = 1
    n = 0
    while depth > 0:
        depth -= 1
        na = stack[depth, 0]
        nb = stack[depth, 1]
        if not boxes_meet(pa.boxes, ha.box + na, pb.boxes, hb.box + nb, rel, pad):
            continue
        leaf_a = na >= ha.leaves
        leaf_b = nb >= hb.leaves
        if leaf_a and leaf_b:
            a0 = (na - ha.leaves) * LEAF
            b0 = (nb - hb.leaves) * LEAF
            a1 = ha.point + min(a0 + LEAF, ha.count)
            b1 = hb.point + min(b0 + LEAF, hb.count)
            if ha.arcs or hb.arcs:
                n = cross_curved_leaves(
                    pa.points, pa.following, pa.arcs, ha.point + a0, a1, pa.boxes, ha.box + na,
                    pb.points, pb.following, pb.arcs, hb.point + b0, b1, rel, pad,
                    work.cross, work.param, work.spot, n,
                )  # fmt: skip
            else:
                n = cross_leaves(
                    pa.points, pa.following, ha.point + a0, a1, pb.points, pb.following, hb.point + b0, b1,
                    rel, work.cross, work.param, work.spot, n,
                )  # fmt: skip
            if n < 0:
                return n
            continue
        depth = go_down(pa.boxes, ha.box + na, na, leaf_a, pb.boxes, hb.box + nb, nb, leaf_b, stack, depth)
    return n


@kernel
def _first_of_strangers(
    q: np.ndarray, other: np.ndarray, following: np.ndarray, rel: Relative, edge: int, end: int,
    k: int, m: int, cross: np.ndarray, param: np.ndarray, spot: np.ndarray, along: int,
) -> bool:  # fmt: skip
    """`_before` for crossing edges without a common corner: by the rounded parameters, unless they are too close."""
    gap = abs(spot[k, 0] - spot[m, 0]) + abs(spot[k, 1] - spot[m, 1])
    size = abs(spot[k, 0]) + abs(spot[k, 1]) + abs(q[end, 0] - q[edge, 0]) + abs(q[end, 1] - q[edge, 1])
    if gap > 1e-11 * size:
        return param[k, along] < param[m, along]
    f = cross[k, 1 - along]
    g = cross[m, 1 - along]
    if along == A_EDGE:
        ax, ay = q[edge, 0], q[edge, 1]
        bx, by = q[end, 0], q[end, 1]
        cx, cy = placed(other, f, rel)
        dx, dy = placed(other, following[f], rel)
        ex, ey = placed(other, g, rel)
        fx, fy = placed(other, following[g], rel)
    else:
        ax, ay = placed(q, edge, rel)
        bx, by = placed(q, end, rel)
        cx, cy = other[f, 0], other[f, 1]
        dx, dy = other[following[f], 0], other[following[f], 1]
        ex, ey = other[g, 0], other[g, 1]
        fx, fy = other[following[g], 0], other[following[g], 1]
    order = order_exact(ax, ay, bx, by, cx, cy, dx, dy, ex, ey, fx, fy)
    if order == 0.0:
        return param[k, along] < param[m, along]
    return order < 0.0


@kernel
def _before(
    q: np.ndarray, other: np.ndarray, following: np.ndarray, rel: Relative, edge: int, end: int,
    k: int, m: int, cross: np.ndarray, param: np.ndarray, spot: np.ndarray, along: int,
) -> bool:  # fmt: skip
    """Whether crossing k comes before crossing m on the edge `edge` -> `end` of q that both lie on.

    Two crossing edges that share a corner v may poke through by any little, also by the infinitesimal of the
    tie-break alone: u - v - w crosses to v and back, and the turn at v says which leg comes first; exactly.
    """
    f = cross[k, 1 - along]
    g = cross[m, 1 - along]
    first = following[f] == g
    if not first and following[g] != f:
        return _first_of_strangers(q, other, following, rel, edge, end, k, m, cross, param, spot, along)
    u, v = (f, g) if first else (g, f)
    w = following[v]
    if along == A_EDGE:
        ux, uy = placed(other, u, rel)
        vx, vy = placed(other, v, rel)
        wx, wy = placed(other, w, rel)
        left = side(q[edge, 0], q[edge, 1], q[end, 0], q[end, 1], vx, vy, True) > 0.0
    else:
        ux, uy = other[u, 0], other[u, 1]
        vx, vy = other[v, 0], other[v, 1]
        wx, wy = other[w, 0], other[w, 1]
        ax, ay = placed(q, edge, rel)
        bx, by = placed(q, end, rel)
        left = side(ax, ay, bx, by, vx, vy, False) > 0.0
    # v to the left of the edge: the leg to u is met first if u -> w turns counter-clockwise about v
    return ((side(vx, vy, ux, uy, wx, wy, True) > 0.0) == left) == first


@kernel
def link(
    q: np.ndarray, following: np.ndarray, ring_of: np.ndarray, other: np.ndarray, other_following: np.ndarray,
    rel: Relative, n: int, cross: np.ndarray, param: np.ndarray, spot: np.ndarray, order: np.ndarray, along: int,
) -> bool:  # fmt: skip
    """order[2 + along, k]: the crossing after k along its ring of A (0) or B (1). False if they do not alternate.

    ~k where the ring's first point is passed on the way. For polygons, whose order is exact; else see `sequence.py`.
    """
    for i in range(n):  # insertion sort: n is small, and crossings come nearly in order
        edge = cross[i, along]
        j = i
        while j > 0:
            m = order[along, j - 1]
            e = cross[m, along]
            if e < edge:
                break
            if e == edge and not _before(
                q, other, other_following, rel, edge, following[edge], i, m, cross, param, spot, along
            ):
                break
            order[along, j] = m
            j -= 1
        order[along, j] = i
    low = 0
    while low < n:
        ring = ring_of[cross[order[along, low], along]]
        high = low
        last = low
        while last + 1 < n and ring_of[cross[order[along, last + 1], along]] == ring:
            last += 1
        for high in range(low, last + 1):
            k = order[along, high]
            m = order[along, high + 1 if high < last else low]
            if cross[k, 2] == cross[m, 2]:
                return False
            order[2 + along, k] = m if high < last else ~m  # ~: past the start of the ring
        low = last + 1
    return True
