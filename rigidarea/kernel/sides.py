"""Segments without thickness: faces of a solid on whichever side the other body did not come from."""

from __future__ import annotations

import math
from typing import Any

from .jit import kernel
from .overlap import A_EDGE, Relative, Work
from .place import Pose, overlap_of_outlines
from .pool import Pool
from .region import Motion
from .tables import Tables


@kernel
def length_on_first_edge(pool: Pool, i: int, rel: Relative, mine: int, work: Work, n: int) -> float:
    """Length of region n's boundary that lies on edge 0 of outline i (A, or B placed by rel)."""
    p = pool.heads[i].point
    ax, ay = pool.points[p, 0], pool.points[p, 1]
    bx, by = pool.points[p + 1, 0], pool.points[p + 1, 1]
    if mine != A_EDGE:
        ax, ay = rel.c * ax - rel.s * ay + rel.tx, rel.s * ax + rel.c * ay + rel.ty
        bx, by = rel.c * bx - rel.s * by + rel.tx, rel.s * bx + rel.c * by + rel.ty
    length = math.hypot(bx - ax, by - ay)
    ex = (bx - ax) / length
    ey = (by - ay) / length
    total = 0.0
    j = work.loops[n].stop - 1
    for k in range(work.loops[n].start, work.loops[n].stop):
        if work.label[j] == mine:
            ux = work.polygon[j, 0] - ax
            uy = work.polygon[j, 1] - ay
            vx = work.polygon[k, 0] - ax
            vy = work.polygon[k, 1] - ay
            if abs(ex * uy - ey * ux) + abs(ex * vy - ey * vx) <= 1e-9 * length:
                total += abs(ex * (vx - ux) + ey * (vy - uy))
        j = k
    return total


@kernel
def _came_from(
    pool: Pool, i: int, mirror: int, pose: Pose, me: Motion, other: int, other_pose: Pose, it: Motion, dt: float,
    work: Work,
) -> int:  # fmt: skip
    """Which solid side a two-sided segment shows to a body that it now touches first: 1 itself, -1 its mirror.

    Outline i lies to the right of the segment, its mirror to the left. Twice the body's mean height over the line,
    positive to the left, is h = (area in the mirror - area in i) / length; a step earlier it was
    2 dt (its speed to the left) less. Where it was then is where it came from: the solid is on the far side.
    """
    n, rel = overlap_of_outlines(pool, i, pose, other, other_pose, work)
    right = 0.0
    length = 0.0
    x = 0.0
    y = 0.0
    for k in range(n):
        right += work.loops[k].area
        length += length_on_first_edge(pool, i, rel, A_EDGE, work, k)
    n, _ = overlap_of_outlines(pool, mirror, pose, other, other_pose, work)
    left = 0.0
    for k in range(n):
        left += work.loops[k].area
    if length == 0.0:
        return 1 if left >= right else -1
    p = pool.heads[i].point
    ax, ay = pool.points[p, 0], pool.points[p, 1]
    dx = pool.points[p + 1, 0] - ax
    dy = pool.points[p + 1, 1] - ay
    full = math.hypot(dx, dy)
    lx = (pose.c * -dy - pose.s * dx) / full  # left of the segment, world
    ly = (pose.s * -dy + pose.c * dx) / full
    mx = pool.heads[i].x + ax + 0.5 * dx
    my = pool.heads[i].y + ay + 0.5 * dy
    x = pose.x + pose.c * mx - pose.s * my
    y = pose.y + pose.s * mx + pose.c * my
    vx = (it.vx - it.w * (y - it.y)) - (me.vx - me.w * (y - me.y))
    vy = (it.vy + it.w * (x - it.x)) - (me.vy + me.w * (x - me.x))
    height = (left - right) / length - 2.0 * dt * (vx * lx + vy * ly)
    return 1 if height >= 0.0 else -1


@kernel
def shown_sides(
    pool: Pool, tables: Tables, work: Work, pair: Any, sa: int, sb: int, pose_a: Pose, pose_b: Pose,
    a: Motion, b: Motion, dt: float,
) -> tuple[int, int]:  # fmt: skip
    """The outlines that shape sa and shape sb show each other in this contact."""
    ia = tables.shapes[sa].outline
    ib = tables.shapes[sb].outline
    mirror_a = tables.shapes[sa].mirror
    mirror_b = tables.shapes[sb].mirror
    if mirror_a >= 0:
        if pair.side_a == 0:
            pair.side_a = _came_from(pool, ia, mirror_a, pose_a, a, ib, pose_b, b, dt, work)
        if pair.side_a < 0:
            ia = mirror_a
    if mirror_b >= 0:
        if pair.side_b == 0:
            pair.side_b = _came_from(pool, ib, mirror_b, pose_b, b, ia, pose_a, a, dt, work)
        if pair.side_b < 0:
            ib = mirror_b
    return ia, ib
