"""How far two boundaries are apart: what says for how long nothing can touch."""

from __future__ import annotations

import math

import numpy as np

from .jit import kernel
from .pool import LEAF, Pool
from .work import Relative, Work, placed


@kernel(inline="always")
def _to_edge2(px: float, py: float, ax: float, ay: float, bx: float, by: float) -> float:
    """Squared distance of a point from an edge."""
    ux = bx - ax
    uy = by - ay
    vx = px - ax
    vy = py - ay
    t = min(1.0, max(0.0, (ux * vx + uy * vy) / (ux * ux + uy * uy)))
    dx = vx - t * ux
    dy = vy - t * uy
    return dx * dx + dy * dy


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
            best = min(best, _to_edge2(cx, cy, ax, ay, bx, by), _to_edge2(ax, ay, cx, cy, dx, dy))
            best = min(best, _to_edge2(dx, dy, ax, ay, bx, by), _to_edge2(bx, by, cx, cy, dx, dy))
    return best


@kernel(inline="always")
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
            best = _leaves2(
                pa.points, pa.following, ha.point + a0, ha.point + min(a0 + LEAF, ha.count),
                pb.points, pb.following, hb.point + b0, hb.point + min(b0 + LEAF, hb.count),
                rel, best,
            )  # fmt: skip
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


@kernel
def time_to_cover(distance: float, speed: float, acceleration: float) -> float:
    """Time in which a body at `speed` at the most, gaining `acceleration` at the most, covers `distance`."""
    if distance <= 0.0:
        return 0.0
    if acceleration == 0.0:
        return distance / speed if speed > 0.0 else np.inf
    # the positive root of speed t + acceleration t^2 / 2 = distance, without cancellation
    return 2.0 * distance / (speed + math.sqrt(speed * speed + 2.0 * acceleration * distance))
