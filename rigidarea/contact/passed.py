"""What nothing moves is passed by nobody: what is on its other side when a frame ends goes back.

Contacts are met where bodies first touch (`motion`), once a substep for each pair. What turns by radians in a substep
may come down with another corner before the next, in a corner of a room a second wall may be met behind the first, and
a blow may send somebody on who has been met already. That is seen by the way of a body's middle: where it has entered
what does not move, or is beyond a segment that nothing moves (a kinematic body's too), the body goes back to where the
frame has found it, and its speed into what it has entered is returned.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..compile.jit import kernel
from ..geometry.arc import on_arc
from ..geometry.place import Pose, place
from ..geometry.pool import LEAF, Pool
from .broad import box_of
from .constants import LOOK
from .motion import pose_of, seen_whole
from .sides import over
from .tables import DRIFTS, FIXED, MOVERS, NEAR, ROWS, Tables, free_regions
from .verdict import refused


@kernel
def _pose_before(body: Any) -> Pose:
    """Where a body's outlines were when the frame began."""
    if body.kind != DRIFTS:
        return pose_of(body)
    c = math.cos(body.old_a)
    s = math.sin(body.old_a)
    return Pose(
        body.old_x - (c * body.cog_x - s * body.cog_y), body.old_y - (s * body.cog_x + c * body.cog_y), c, s
    )


@kernel
def _edge_entered(
    pool: Pool, e: int, x: float, y: float, dx: float, dy: float, last: float
) -> tuple[float, float, float]:
    """Where on the way (dx, dy) from (x, y) edge e is crossed inwards, before `last`: part of the way, and the normal,
    outwards. No normal: nowhere.
    """
    k = pool.following[e]
    px, py = pool.points[e, 0], pool.points[e, 1]
    qx, qy = pool.points[k, 0], pool.points[k, 1]
    r = pool.arcs[e, 2]
    if r == 0.0:
        ex = qx - px
        ey = qy - py
        inwards = ex * dy - ey * dx
        if inwards <= 0.0:
            return last, 0.0, 0.0
        t = ((px - x) * -ey + (py - y) * ex) / inwards
        u = ((px - x) * -dy + (py - y) * dx) / inwards
        if not (0.0 <= t < last and 0.0 <= u <= 1.0):
            return last, 0.0, 0.0
        length = math.sqrt(ex * ex + ey * ey)
        return t, ey / length, -ex / length
    cx = x - pool.arcs[e, 0]
    cy = y - pool.arcs[e, 1]
    dd = dx * dx + dy * dy
    half = cx * dx + cy * dy
    root = half * half - dd * (cx * cx + cy * cy - r * r)
    if dd == 0.0 or root <= 0.0:
        return last, 0.0, 0.0
    # into a circle at the first root, out of a hollow one into the solid at the second
    t = (-half - math.copysign(math.sqrt(root), r)) / dd
    hx = cx + t * dx
    hy = cy + t * dy
    if not 0.0 <= t < last or not (
        k == e or on_arc(px, py, qx, qy, r, hx + pool.arcs[e, 0], hy + pool.arcs[e, 1])
    ):
        return last, 0.0, 0.0
    return t, hx / r, hy / r


@kernel
def _entered(pool: Pool, outline: int, x0: float, y0: float, x1: float, y1: float) -> tuple[float, float]:
    """The outward normal where the way from (x0, y0) to (x1, y1) first enters an outline; (0, 0): it does not."""
    head = pool.heads[outline]
    dx = x1 - x0
    dy = y1 - y0
    nx = 0.0
    ny = 0.0
    last = 1.0
    node = 1
    while node > 0:
        box = pool.boxes[head.box + node]
        meets = abs(0.5 * (x0 + x1) - box[0]) <= box[2] + 0.5 * abs(dx) and abs(
            0.5 * (y0 + y1) - box[1]
        ) <= box[3] + 0.5 * abs(dy)
        if meets and node < head.leaves:
            node *= 2
            continue
        if meets:
            start = (node - head.leaves) * LEAF
            for e in range(head.point + start, head.point + min(start + LEAF, head.count)):
                t, ex, ey = _edge_entered(pool, e, x0, y0, dx, dy, last)
                if ex != 0.0 or ey != 0.0:
                    last = t
                    nx = ex
                    ny = ey
        while node & 1:  # on to whatever is right of it, or of the one above
            node >>= 1
        node += node > 0
    return nx, ny


@kernel(forceinline=True)
def _middle(pool: Pool, shape: Any) -> tuple[float, float]:
    """The middle of a shape's bounding box, of a segment its own (body frame, length)."""
    one = pool.heads[shape.outline]
    if shape.mirror < 0:
        return one.x, one.y
    other = pool.heads[shape.mirror]
    return 0.5 * (one.x + other.x), 0.5 * (one.y + other.y)


@kernel(forceinline=True)
def _seen_from(head: Any, pose: Pose, mx: float, my: float, other: Pose) -> tuple[float, float]:
    """A point of another body, seen from the middle of an outline (length)."""
    x = other.x + other.c * mx - other.s * my - pose.x
    y = other.y + other.s * mx + other.c * my - pose.y
    return pose.c * x + pose.s * y - head.x, pose.c * y - pose.s * x - head.y


@kernel(forceinline=True)
def _holds(wall: Any, body: Any) -> bool:
    """Whether nothing moves the one, and we move the other, which gives way."""
    return bool(wall.inverse_mass == 0.0 and body.inverse_mass > 0.0 and body.kind == DRIFTS)


@kernel
def _may_have_passed(pool: Pool, tables: Tables, pair: Any, shape: Any) -> bool:
    """Whether a pair may have gone unseen, and a shape's middle says where it is.

    Of a concave one it need not lie in it; and what hangs in a joint is where that keeps it: put back, it would be
    shot by it.
    """
    held = tables.bodies[shape.body].calm < 0
    return bool(pool.heads[shape.outline].convex and not held) and not seen_whole(tables, pair)


@kernel
def _send_back(tables: Tables, pair: Any, frame: int, wall: Any, body: Any, nx: float, ny: float) -> None:
    """A body where the frame found it, as the wall sees it, its speed into the wall, along -(nx, ny), returned."""
    vx = body.vx - wall.vx + wall.w * (body.y - wall.y)
    vy = body.vy - wall.vy - wall.w * (body.x - wall.x)
    speed = vx * nx + vy * ny
    if speed < 0.0:
        elasticity = pair.elasticity  # as the user may have set it
        if pair.stamp != frame:
            elasticity = tables.shapes[pair.a].elasticity * tables.shapes[pair.b].elasticity
        body.vx -= (1.0 + elasticity) * speed * nx
        body.vy -= (1.0 + elasticity) * speed * ny
    body.x = body.old_x
    body.y = body.old_y
    body.angle = body.old_a
    if wall.kind == DRIFTS:
        turned = wall.angle - wall.old_a
        c = math.cos(turned)
        s = math.sin(turned)
        dx = body.old_x - wall.old_x
        dy = body.old_y - wall.old_y
        body.x = wall.x + c * dx - s * dy
        body.y = wall.y + s * dx + c * dy
        body.angle += turned
    body.since = 0.0
    place(body)


@kernel
def _solid(
    pool: Pool, tables: Tables, pair: Any, frame: int, thick: Any, wall: Any, shape: Any, body: Any
) -> bool:
    """Whether a body was put back that has entered a wall with its middle."""
    if wall.kind != FIXED or not _holds(wall, body) or not _may_have_passed(pool, tables, pair, shape):
        return False
    head = pool.heads[thick.outline]
    mx, my = _middle(pool, shape)
    now = pose_of(wall)
    x0, y0 = _seen_from(head, _pose_before(wall), mx, my, _pose_before(body))
    x1, y1 = _seen_from(head, now, mx, my, pose_of(body))
    nx, ny = _entered(pool, thick.outline, x0, y0, x1, y1)
    if nx == 0.0 and ny == 0.0:
        return False
    _send_back(tables, pair, frame, wall, body, now.c * nx - now.s * ny, now.s * nx + now.c * ny)
    return True


@kernel
def _line(
    pool: Pool,
    tables: Tables,
    pair: Any,
    frame: int,
    kept: int,
    shown: int,
    line: Any,
    wall: Any,
    shape: Any,
    body: Any,
) -> tuple[int, bool]:
    """Put a body back that has passed the line of a wall, both as they are after a frame: on which side it is now, and
    whether it was put back.
    """
    now = pose_of(wall)
    came, first, length = over(pool, line.outline, _pose_before(wall), shape.outline, _pose_before(body))
    went, last, _ = over(pool, line.outline, now, shape.outline, pose_of(body))
    radius = pool.heads[shape.outline].radius
    side = kept
    if side * came <= -radius:  # put there by hand
        side = 0
    if side == 0:
        if abs(came) >= radius or (shown == 0 and 0.0 <= first <= length):
            side = 1 if came > 0.0 else -1
        else:  # where it has been over the line's end, the side that it was shown
            side = -shown
    if side == 0:
        return 0, False
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
    far = through or (shape.mirror < 0 and _may_have_passed(pool, tables, pair, shape))
    if not far or not _holds(wall, body):
        return side, False
    head = pool.heads[line.outline]
    dx = (pool.points[head.point + 1, 0] - pool.points[head.point, 0]) / length
    dy = (pool.points[head.point + 1, 1] - pool.points[head.point, 1]) / length
    _send_back(
        tables, pair, frame, wall, body, -side * (now.c * dy + now.s * dx), side * (now.c * dx - now.s * dy)
    )
    return side, True


@kernel
def left_its_margin(tables: Tables) -> tuple[bool, bool]:
    """Whether two may have gone farther in the frame than is seen (not `seen_whole`), and whether somebody is near a
    segment without thickness, whose side is kept.
    """
    most = 0.0
    least = np.inf
    lines = False
    if tables.counters[NEAR] == 0 and tables.counters[ROWS] == 0:  # nothing has sent anybody off its way
        return False, False
    for k in range(tables.counters[MOVERS]):
        shape = tables.shapes[tables.movers[k]]
        body = tables.bodies[shape.body]
        if shape.sensor or (body.same and body.steps == 0):
            continue
        least = min(least, shape.extent)
        if body.kind == DRIFTS:
            way = abs(body.x - body.old_x) + abs(body.y - body.old_y)
            most = max(most, way + abs(body.angle - body.old_a) * (shape.half_x + shape.half_y))
    for i in range(tables.counters[NEAR]):
        lines |= tables.near[i].lined == 1
        least = min(least, tables.near[i].extent)
    return 2.0 * most > LOOK * least, lines


@kernel
def any_body_left_its_margin(pool: Pool, tables: Tables) -> bool:
    """Whether a blow has sent a shape out of its box, farther than it is seen: there it may have passed anybody."""
    for k in range(tables.counters[MOVERS]):
        shape = tables.shapes[tables.movers[k]]
        body = tables.bodies[shape.body]
        if body.kind != DRIFTS:
            continue
        if abs(body.x - body.old_x) + abs(body.y - body.old_y) <= LOOK * shape.extent:
            continue
        low_x, low_y, high_x, high_y = box_of(pool, shape, body)
        if low_x < shape.low_x or low_y < shape.low_y or high_x > shape.high_x or high_y > shape.high_y:
            return True
    return False


@kernel
def _look(pool: Pool, tables: Tables, frame: int, far: bool) -> bool:
    """Whether anybody was put back. `far`: whether somebody has gone far."""
    back = False
    for i in range(tables.counters[NEAR]):
        pair = tables.pairs[tables.near[i].pair]
        sa = tables.shapes[pair.a]
        sb = tables.shapes[pair.b]
        lines = sa.mirror >= 0 or sb.mirror >= 0
        if not (far or lines):
            continue
        a = tables.bodies[sa.body]
        b = tables.bodies[sb.body]
        if a.inverse_mass > 0.0 and b.inverse_mass > 0.0 and not lines:
            continue
        if refused(tables, pair, frame):
            pair.now_a = 0
            pair.now_b = 0
            continue
        if sa.mirror >= 0:
            pair.now_a, put = _line(pool, tables, pair, frame, pair.kept_a, pair.side_a, sa, a, sb, b)
            back |= put
        else:
            back |= _solid(pool, tables, pair, frame, sa, a, sb, b)
        if sb.mirror >= 0:
            pair.now_b, put = _line(pool, tables, pair, frame, pair.kept_b, pair.side_b, sb, b, sa, a)
            back |= put
        else:
            back |= _solid(pool, tables, pair, frame, sb, b, sa, a)
    return back


@kernel
def recover_from_tunnelling(pool: Pool, tables: Tables, frame: int, far: bool) -> None:
    """After a frame: what has passed what it collides with and nothing moves is where it was before, and goes back."""
    back = _look(pool, tables, frame, far)
    if back:  # what one wall has put back has not passed another
        _look(pool, tables, frame, far)
    for i in range(tables.counters[NEAR]):
        pair = tables.pairs[tables.near[i].pair]
        pair.kept_a = pair.now_a
        pair.kept_b = pair.now_b
        if back and pair.head >= 0:  # nor does it touch whom it has met on that way
            a = tables.bodies[tables.shapes[pair.a].body]
            b = tables.bodies[tables.shapes[pair.b].body]
            if (a.kind == DRIFTS and a.since == 0.0) or (b.kind == DRIFTS and b.since == 0.0):
                free_regions(tables.regions, tables.counters, pair.head)
                pair.head = -1
