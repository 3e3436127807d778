"""Two outlines where their bodies are: their overlap, and the shortest way apart."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from .jit import kernel
from .overlap import OVERFLOW, TANGLED, Relative, Work, overlap_kernel, relative
from .pool import Pool


class Pose(NamedTuple):
    """Where a body's origin is, and cosine and sine of its angle."""

    x: float
    y: float
    c: float
    s: float


@kernel
def seen_from(head: Any, pose: Pose, other: Any, other_pose: Pose) -> Relative:
    """An outline (its head, its body's pose) as the first one sees it."""
    return relative(
        pose.x, pose.y, pose.c, pose.s, other_pose.x, other_pose.y, other_pose.c, other_pose.s,
        head.x, head.y, other.x, other.y,
    )  # fmt: skip


@kernel(inline="always")
def overlap_of_outlines(pool: Pool, ia: int, a: Pose, ib: int, b: Pose, work: Work) -> tuple[int, Relative]:
    """(number of regions, in `work`; B relative to A) of two placed outlines.

    A tangle is undone by shifts of 1e-13 of the size: a tangle is rounding.
    """
    rel = seen_from(pool.heads[ia], a, pool.heads[ib], b)
    n = overlap_kernel(pool, ia, pool, ib, rel, work)
    if n == TANGLED:
        size = 1e-13 * (pool.heads[ia].radius + pool.heads[ib].radius)
        for i in range(1, 9):
            shifted = Relative(rel.c, rel.s, rel.tx + i * size, rel.ty + i * i * size)
            n = overlap_kernel(pool, ia, pool, ib, shifted, work)
            if n != TANGLED:
                break
        n = max(n, OVERFLOW)
    return n, rel


@kernel
def push_out(pool: Pool, ia: int, ib: int, rel: Relative) -> tuple[float, float]:
    """Direction A to B of the shortest way apart over the edge normals of both outer rings, in A's frame.

    Exact for convex outlines (separating axes); for concave ones a sensible guess. Only for regions that are born
    without a direction: one outline inside the other, or two bars crossed.
    """
    best = np.inf
    best_x = 0.0
    best_y = 1.0
    ha = pool.heads[ia]
    hb = pool.heads[ib]
    a0, a1 = pool.rings[ha.ring, 0], pool.rings[ha.ring, 1]
    b0, b1 = pool.rings[hb.ring, 0], pool.rings[hb.ring, 1]
    for of_a in (True, False):
        e0, e1, v0, v1 = (a0, a1, b0, b1) if of_a else (b0, b1, a0, a1)
        # both in the frame of the edges' outline
        c, s = (rel.c, rel.s) if of_a else (rel.c, -rel.s)
        tx = rel.tx if of_a else -(rel.c * rel.tx + rel.s * rel.ty)
        ty = rel.ty if of_a else -(rel.c * rel.ty - rel.s * rel.tx)
        for e in range(e0, e1):
            k = pool.following[e]
            dx = pool.points[k, 0] - pool.points[e, 0]
            dy = pool.points[k, 1] - pool.points[e, 1]
            length = math.sqrt(dx * dx + dy * dy)
            mx = dy / length
            my = -dx / length
            mx_v = c * mx + s * my  # the normal in the vertices' frame
            my_v = -s * mx + c * my
            deepest = -np.inf
            edge = mx * (pool.points[e, 0] - tx) + my * (pool.points[e, 1] - ty)
            for v in range(v0, v1):
                deepest = max(deepest, edge - (mx_v * pool.points[v, 0] + my_v * pool.points[v, 1]))
            if 0.0 < deepest < best:
                best = deepest
                if of_a:
                    best_x, best_y = mx, my
                else:  # B's outward normal points from B to A
                    best_x, best_y = -(rel.c * mx - rel.s * my), -(rel.s * mx + rel.c * my)
    return best_x, best_y
