"""How far two boundaries are apart: what says for how long nothing can touch."""

from __future__ import annotations

import math

import numpy as np

from ..compile.jit import kernel
from .arc import on_arc, to_edge2
from .pool import LEAF, Pool
from .work import Relative, Work, placed


@kernel
def _leaves2(
    qa: np.ndarray, next_a: np.ndarray, a0: int, a1: int, qb: np.ndarray, next_b: np.ndarray, b0: int, b1: int,
    rel: Relative, best: float,
) -> float:  # fmt: skip
    """Squared distance of edges a0..a1 of A from edges b0..b1 of B, that do not cross; at most `best`."""
    for j in range(b0, b1):
        cx, cy = placed(qb, j, rel)
        dx, dy = placed(qb, next_b[j], rel)
        for i in range(a0, a1):
            ax = qa[i, 0]
            ay = qa[i, 1]
            bx = qa[next_a[i], 0]
            by = qa[next_a[i], 1]
            best = min(best, to_edge2(cx, cy, ax, ay, bx, by), to_edge2(ax, ay, cx, cy, dx, dy))
            best = min(best, to_edge2(dx, dy, ax, ay, bx, by), to_edge2(bx, by, cx, cy, dx, dy))
    return best


@kernel
def _beyond(
    x: float, y: float, px: float, py: float, qx: float, qy: float, cx: float, cy: float, r: float
) -> float:
    """How far outside an arc's circle a point lies (length).

    Of a flat arc by its ends and radius, as its centre rounds like its radius: X along the chord from its middle, Y
    away from the centre, the squared distance from that is X^2 + (Y + apothem)^2.
    """
    a = abs(r)
    d = math.sqrt((x - cx) ** 2 + (y - cy) ** 2)
    ux = qx - px
    uy = qy - py
    chord2 = ux * ux + uy * uy
    if chord2 > r * r:
        return d - a
    mx = x - 0.5 * (px + qx)
    my = y - 0.5 * (py + qy)
    twice_apothem = math.sqrt(4.0 * r * r - chord2)
    high = (uy * mx - ux * my) / math.sqrt(chord2)
    high = high if r > 0.0 else -high
    return (mx * mx + my * my - 0.25 * chord2 + high * twice_apothem) / (d + a)


@kernel
def _to_arc2(
    x: float, y: float, px: float, py: float, qx: float, qy: float, cx: float, cy: float, r: float
) -> float:
    """Squared distance of a point from an arc."""
    dx = x - cx
    dy = y - cy
    d = math.sqrt(dx * dx + dy * dy)
    if d == 0.0:
        return r * r
    f = abs(r) / d
    if on_arc(px, py, qx, qy, r, cx + f * dx, cy + f * dy):
        return _beyond(x, y, px, py, qx, qy, cx, cy, r) ** 2
    return min((x - px) ** 2 + (y - py) ** 2, (x - qx) ** 2 + (y - qy) ** 2)


@kernel
def _edge_to_arc2(
    ax: float, ay: float, bx: float, by: float,
    px: float, py: float, qx: float, qy: float, cx: float, cy: float, r: float,
) -> float:  # fmt: skip
    """Squared distance of an edge from an arc that does not cross it."""
    best = min(to_edge2(px, py, ax, ay, bx, by), to_edge2(qx, qy, ax, ay, bx, by))
    best = min(best, _to_arc2(ax, ay, px, py, qx, qy, cx, cy, r), _to_arc2(bx, by, px, py, qx, qy, cx, cy, r))
    ux = bx - ax
    uy = by - ay
    t = (ux * (cx - ax) + uy * (cy - ay)) / (ux * ux + uy * uy)
    if 0.0 < t < 1.0:  # where they face each other
        best = min(best, _to_arc2(ax + t * ux, ay + t * uy, px, py, qx, qy, cx, cy, r))
    return best


@kernel
def _arc_to_arc2(
    ax: float, ay: float, bx: float, by: float, ex: float, ey: float, r: float,
    px: float, py: float, qx: float, qy: float, cx: float, cy: float, u: float,
) -> float:  # fmt: skip
    """Squared distance of two arcs that do not cross."""
    best = min(_to_arc2(px, py, ax, ay, bx, by, ex, ey, r), _to_arc2(qx, qy, ax, ay, bx, by, ex, ey, r))
    best = min(best, _to_arc2(ax, ay, px, py, qx, qy, cx, cy, u), _to_arc2(bx, by, px, py, qx, qy, cx, cy, u))
    dx = cx - ex
    dy = cy - ey
    d = math.sqrt(dx * dx + dy * dy)
    if d > 0.0:
        for f in (abs(r) / d, -abs(r) / d):  # where they face each other, on the line of centres
            x = ex + f * dx
            y = ey + f * dy
            if on_arc(ax, ay, bx, by, r, x, y):
                off = _beyond(x, y, ax, ay, bx, by, ex, ey, r) / math.copysign(d, f)
                x -= off * dx
                y -= off * dy
                best = min(best, _to_arc2(x, y, px, py, qx, qy, cx, cy, u))
    return best


@kernel
def _curved_leaves2(
    pa: Pool, a0: int, a1: int, pb: Pool, b0: int, b1: int, rel: Relative, best: float
) -> float:
    """`_leaves2` where edges may be arcs."""
    for j in range(b0, b1):
        px, py = placed(pb.points, j, rel)
        qx, qy = placed(pb.points, pb.following[j], rel)
        cx, cy = placed(pb.arcs, j, rel)
        u = pb.arcs[j, 2]
        for i in range(a0, a1):
            k = pa.following[i]
            ax = pa.points[i, 0]
            ay = pa.points[i, 1]
            bx = pa.points[k, 0]
            by = pa.points[k, 1]
            ex = pa.arcs[i, 0]
            ey = pa.arcs[i, 1]
            r = pa.arcs[i, 2]
            if r == 0.0 and u == 0.0:
                best = min(best, to_edge2(px, py, ax, ay, bx, by), to_edge2(ax, ay, px, py, qx, qy))
                best = min(best, to_edge2(qx, qy, ax, ay, bx, by), to_edge2(bx, by, px, py, qx, qy))
            elif r == 0.0:
                best = min(best, _edge_to_arc2(ax, ay, bx, by, px, py, qx, qy, cx, cy, u))
            elif u == 0.0:
                best = min(best, _edge_to_arc2(px, py, qx, qy, ax, ay, bx, by, ex, ey, r))
            else:
                best = min(best, _arc_to_arc2(ax, ay, bx, by, ex, ey, r, px, py, qx, qy, cx, cy, u))
    return best


@kernel(forceinline=True)
def _boxes2(qa: np.ndarray, na: int, qb: np.ndarray, nb: int, rel: Relative) -> float:
    """Squared distance of two hierarchy boxes, or less. (An empty box has half widths of -1e300.)"""
    if qa[na, 2] < 0.0 or qb[nb, 2] < 0.0:
        return np.inf
    c = abs(rel.c)
    s = abs(rel.s)
    dx = abs(rel.c * qb[nb, 0] - rel.s * qb[nb, 1] + rel.tx - qa[na, 0])
    dy = abs(rel.s * qb[nb, 0] + rel.c * qb[nb, 1] + rel.ty - qa[na, 1])
    dx = max(0.0, dx - qa[na, 2] - c * qb[nb, 2] - s * qb[nb, 3])
    dy = max(0.0, dy - qa[na, 3] - s * qb[nb, 2] - c * qb[nb, 3])
    return dx * dx + dy * dy


@kernel
def clearance(pa: Pool, ia: int, pb: Pool, ib: int, rel: Relative, most: float, work: Work) -> float:
    """Distance of two boundaries that do not cross (length); `most` if it is more."""
    ha = pa.heads[ia]
    hb = pb.heads[ib]
    best = most * most
    stack = work.stack
    stack[0, 0] = 1
    stack[0, 1] = 1
    depth = 1
    while depth > 0:
        depth -= 1
        na = stack[depth, 0]
        nb = stack[depth, 1]
        if _boxes2(pa.boxes, ha.box + na, pb.boxes, hb.box + nb, rel) >= best:
            continue
        leaf_a = na >= ha.leaves
        leaf_b = nb >= hb.leaves
        if leaf_a and leaf_b:
            a0 = (na - ha.leaves) * LEAF
            b0 = (nb - hb.leaves) * LEAF
            a1 = ha.point + min(a0 + LEAF, ha.count)
            b1 = hb.point + min(b0 + LEAF, hb.count)
            if ha.arcs or hb.arcs:
                best = _curved_leaves2(pa, ha.point + a0, a1, pb, hb.point + b0, b1, rel, best)
            else:
                best = _leaves2(
                    pa.points,
                    pa.following,
                    ha.point + a0,
                    a1,
                    pb.points,
                    pb.following,
                    hb.point + b0,
                    b1,
                    rel,
                    best,
                )
            continue
        # go down in the larger box, its nearer half first
        size_a = pa.boxes[ha.box + na, 2] + pa.boxes[ha.box + na, 3]
        size_b = pb.boxes[hb.box + nb, 2] + pb.boxes[hb.box + nb, 3]
        in_a = leaf_b or (not leaf_a and size_a >= size_b)
        near_a = 2 * na if in_a else na
        near_b = nb if in_a else 2 * nb
        far_a = near_a + 1 if in_a else na
        far_b = nb if in_a else near_b + 1
        if _boxes2(pa.boxes, ha.box + near_a, pb.boxes, hb.box + near_b, rel) > _boxes2(
            pa.boxes, ha.box + far_a, pb.boxes, hb.box + far_b, rel
        ):
            near_a, far_a = far_a, near_a
            near_b, far_b = far_b, near_b
        stack[depth, 0] = far_a
        stack[depth, 1] = far_b
        stack[depth + 1, 0] = near_a
        stack[depth + 1, 1] = near_b
        depth += 2
    return math.sqrt(best)
