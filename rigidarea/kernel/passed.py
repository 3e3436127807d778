"""Segments without thickness, on bodies that nothing moves: what has gone through one goes back.

Contacts are met where bodies first touch (`motion`), once a substep for each pair. What turns by radians in a substep
may come down with another corner before the next, and be through. That is seen by where its middle is: it goes back to
where the frame has found it, and its speed across the line is returned.
"""

from __future__ import annotations

import math
from typing import Any

from .jit import kernel
from .motion import pose_of
from .place import Pose, place
from .pool import Pool
from .sides import over
from .tables import DRIFTS, NEAR, Tables
from .verdict import refused


@kernel
def _pose_before(body: Any) -> Pose:
    """Where a body's outlines were when the frame began."""
    c = math.cos(body.old_a)
    s = math.sin(body.old_a)
    return Pose(
        body.old_x - (c * body.cog_x - s * body.cog_y), body.old_y - (s * body.cog_x + c * body.cog_y), c, s
    )


@kernel
def _hold(
    pool: Pool, pair: Any, kept: int, shown: int, line: Any, wall: Any, shape: Any, body: Any
) -> tuple[int, bool]:
    """Put a body back that has passed the line of a wall, both as they are after a frame: on which side it is now, and
    whether it was put back.
    """
    before = _pose_before(wall) if wall.kind == DRIFTS else pose_of(wall)
    now = pose_of(wall)
    came, first, length = over(pool, line.outline, before, shape.outline, _pose_before(body))
    went, last, _ = over(pool, line.outline, now, shape.outline, pose_of(body))
    radius = pool.heads[shape.outline].radius
    side = kept
    if side * came <= -radius:  # put there by hand
        side = 0
    if side == 0:  # where it has been over the line's end, the side that it was shown
        side = -shown if shown != 0 and abs(came) < radius else (1 if came > 0.0 else -1)
    if side * went > 0.0:
        return side, False
    through = abs(went) >= radius
    where = first
    if side * came > 0.0:
        where += came / (came - went) * (last - first)
    if not 0.0 <= where <= length:
        if through:
            return -side, False
        return side if pair.head >= 0 else 0, False
    if not through or body.kind != DRIFTS or wall.inverse_mass > 0.0:
        return side, False
    head = pool.heads[line.outline]
    dx = (pool.points[head.point + 1, 0] - pool.points[head.point, 0]) / length
    dy = (pool.points[head.point + 1, 1] - pool.points[head.point, 1]) / length
    nx = -side * (now.c * dy + now.s * dx)
    ny = side * (now.c * dx - now.s * dy)
    speed = (body.vx - wall.vx) * nx + (body.vy - wall.vy) * ny
    if speed < 0.0:
        body.vx -= (1.0 + pair.elasticity) * speed * nx
        body.vy -= (1.0 + pair.elasticity) * speed * ny
    body.x = body.old_x
    body.y = body.old_y
    body.angle = body.old_a
    place(body)
    return side, True


@kernel
def _look(pool: Pool, tables: Tables, frame: int) -> bool:
    """Whether anybody was put back."""
    back = False
    for i in range(tables.counters[NEAR]):
        pair = tables.pairs[tables.near[i].pair]
        sa = tables.shapes[pair.a]
        sb = tables.shapes[pair.b]
        if sa.mirror < 0 and sb.mirror < 0:
            continue
        if refused(tables, pair, frame):
            pair.now_a = 0
            pair.now_b = 0
            continue
        a = tables.bodies[sa.body]
        b = tables.bodies[sb.body]
        if sa.mirror >= 0:
            pair.now_a, put = _hold(pool, pair, pair.kept_a, pair.side_a, sa, a, sb, b)
            back |= put
        if sb.mirror >= 0:
            pair.now_b, put = _hold(pool, pair, pair.kept_b, pair.side_b, sb, b, sa, a)
            back |= put
    return back


@kernel
def return_what_passed(pool: Pool, tables: Tables, frame: int) -> None:
    """After a frame: what has passed a segment that it collides with is where it was before, and goes back."""
    if _look(pool, tables, frame):  # what one wall has put back has not passed another
        _look(pool, tables, frame)
    for i in range(tables.counters[NEAR]):
        pair = tables.pairs[tables.near[i].pair]
        pair.kept_a = pair.now_a
        pair.kept_b = pair.now_b
