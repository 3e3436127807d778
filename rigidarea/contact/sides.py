"""Segments without thickness: faces of a solid on whichever side the other body did not come from."""

from __future__ import annotations

import math
from typing import Any

from ..compile.jit import kernel
from ..geometry.locate import way_into
from ..geometry.overlap import A_EDGE, Relative, Work
from ..geometry.place import Pose
from ..geometry.pool import Pool
from .constants import PUT, SMOOTH
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
def over(pool: Pool, i: int, pose: Pose, other: int, other_pose: Pose) -> tuple[float, float, float]:
    """Where another outline's middle is, seen from a segment: height to its left, way along it, its length (length)."""
    head = pool.heads[i]
    p = head.point
    ax, ay = pool.points[p, 0], pool.points[p, 1]
    dx = pool.points[p + 1, 0] - ax
    dy = pool.points[p + 1, 1] - ay
    it = pool.heads[other]
    x = other_pose.x + other_pose.c * it.x - other_pose.s * it.y - pose.x
    y = other_pose.y + other_pose.s * it.x + other_pose.c * it.y - pose.y
    lx = pose.c * x + pose.s * y - head.x - ax
    ly = pose.c * y - pose.s * x - head.y - ay
    length = math.sqrt(dx * dx + dy * dy)
    return (dx * ly - dy * lx) / length, (dx * lx + dy * ly) / length, length


@kernel
def _nearest_height(
    pool: Pool, i: int, pose: Pose, other: int, other_pose: Pose, last: bool, slack: float
) -> float:
    """To which side of a segment another outline is from its first end, or its last: left positive (length^2).

    0: it is about straight on, or a corner of it is no farther than what a solve may leave, `slack` (length).
    """
    head = pool.heads[i]
    p = head.point
    dx = pool.points[p + 1, 0] - pool.points[p, 0]
    dy = pool.points[p + 1, 1] - pool.points[p, 1]
    lx = pool.points[p + last, 0] + head.x
    ly = pool.points[p + last, 1] + head.y
    x = pose.x + pose.c * lx - pose.s * ly - other_pose.x
    y = pose.y + pose.s * lx + pose.c * ly - other_pose.y
    it = pool.heads[other]
    ux, uy, corner = way_into(
        pool,
        other,
        other_pose.c * x + other_pose.s * y - it.x,
        other_pose.c * y - other_pose.s * x - it.y,
    )
    wx = other_pose.c * ux - other_pose.s * uy
    wy = other_pose.s * ux + other_pose.c * uy
    across = dx * (pose.c * wy - pose.s * wx) - dy * (pose.c * wx + pose.s * wy)
    if corner <= slack:
        return 0.0
    straight_on = across * across <= SMOOTH * (dx * dx + dy * dy) * (wx * wx + wy * wy)
    return 0.0 if straight_on else float(across)


@kernel
def faces(
    pool: Pool, i: int, pose: Pose, it: Any, other_pose: Pose, before: int, kept: int, way: float
) -> int:
    """Which solid side a two-sided segment shows to another shape: 1 outline i, -1 its mirror.

    The solid lies to the left of outline i's first edge, the segment, and the other outline's middle decides: the
    solid is on the far side of it. Where that is past an end, it says nothing (of a plank that lies across a peak it is
    below the slope); what is nearest to the end does. `before`: what it showed when it was last looked at, 0: nothing.
    It shows that for as long as the other one is over the segment and may reach through it: what tumbles has its middle
    on either side.
    `kept`: on which side of it the other one has stayed when the last frame ended (`passed`), 0: not known. What
    bounces off one wall of a corner has its middle over neither, and may have gone a substep's `way` (length) too far.
    """
    other = it.outline
    height, along, length = over(pool, i, pose, other, other_pose)
    radius = pool.heads[other].radius
    if kept != 0 and abs(height) < radius + way:
        return -kept
    over_it = 0.0 <= along <= length
    if before != 0 and abs(height) < radius and over_it:
        return before
    if not over_it and abs(height) < radius and not pool.heads[other].disc:
        nearest = _nearest_height(pool, i, pose, other, other_pose, along > 0.0, PUT * it.extent)
        height = nearest if nearest != 0.0 else height
    return 1 if height <= 0.0 else -1


@kernel(forceinline=True)
def _way(a: Any, pose_a: Pose, b: Any, pose_b: Pose) -> float:
    """How far two bodies are from where they were, together (length)."""
    way = math.sqrt((a.ox - pose_a.x) ** 2 + (a.oy - pose_a.y) ** 2)
    return way + math.sqrt((b.ox - pose_b.x) ** 2 + (b.oy - pose_b.y) ** 2)


@kernel
def shown_sides(pool: Pool, tables: Tables, pair: Any, pose_a: Pose, pose_b: Pose) -> tuple[int, int]:
    """The outlines that the two shapes show each other; decided as long as nothing touches.

    pose_a, pose_b: where the bodies were before they came to touch.
    """
    sa = tables.shapes[pair.a]
    sb = tables.shapes[pair.b]
    ia = sa.outline
    ib = sb.outline
    a = tables.bodies[sa.body]
    b = tables.bodies[sb.body]
    if sa.mirror >= 0:
        if pair.head < 0 or pair.side_a == 0:
            way = _way(a, pose_a, b, pose_b)
            pair.side_a = faces(pool, ia, pose_a, sb, pose_b, pair.side_a, pair.kept_a, way)
        if pair.side_a < 0:
            ia = sa.mirror
    if sb.mirror >= 0:
        if pair.head < 0 or pair.side_b == 0:
            way = _way(a, pose_a, b, pose_b)
            pair.side_b = faces(pool, sb.outline, pose_b, sa, pose_a, pair.side_b, pair.kept_b, way)
        if pair.side_b < 0:
            ib = sb.mirror
    return ia, ib
