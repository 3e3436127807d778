"""What goes with a shape beside it: whether a point of its boundary lies within a neighbour.

Neighbours are the shapes of one body, and of bodies that nothing moves and that go alike: a level's, a platform's.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from ..compile.jit import kernel
from ..geometry.locate import inside_outline
from ..geometry.place import Pose
from ..geometry.pool import Pool
from ..geometry.work import Relative, Work
from .tables import FIXED, Law, Tables
from .tree import STILL, next_beside, next_met


class TwoShapes(NamedTuple):
    """Two shapes whose outlines overlap, or are looked at where they would."""

    pool: Pool
    tables: Tables
    work: Work
    law: Law
    pair: Any
    ia: int  # the outlines that they show each other
    ib: int
    a: Any  # their bodies
    b: Any


class Outward(NamedTuple):
    """Which way out of its shape a point of the boundary looks (world axes, length 1); (0, 0): no matter."""

    x: float
    y: float


@kernel
def _behind_line(
    pool: Pool, shape: Any, wall: Any, x: float, y: float, far_x: float, far_y: float, out: Outward
) -> bool:
    """Whether a point lies behind a segment without thickness, or on it, seen from (far_x, far_y).

    As far past its ends as it lies behind, where the segment goes on before what the point is of: between two segments
    of a valley nothing is exposed, of a ridge all of both.
    """
    head = pool.heads[shape.outline]
    p = head.point
    ax = pool.points[p, 0] + head.x
    ay = pool.points[p, 1] + head.y
    ux = pool.points[p + 1, 0] + head.x - ax
    uy = pool.points[p + 1, 1] + head.y - ay
    dx = wall.c * (x - wall.ox) + wall.s * (y - wall.oy) - ax
    dy = wall.c * (y - wall.oy) - wall.s * (x - wall.ox) - ay
    along = dx * ux + dy * uy
    behind = abs(dx * uy - dy * ux)
    before = (wall.c * ux - wall.s * uy) * out.x + (wall.s * ux + wall.c * uy) * out.y
    first = -behind if before >= 0.0 else 0.0
    last = ux * ux + uy * uy + (behind if before <= 0.0 else 0.0)
    if not first <= along <= last:
        return False
    ex = wall.c * (far_x - wall.ox) + wall.s * (far_y - wall.oy) - ax
    ey = wall.c * (far_y - wall.oy) - wall.s * (far_x - wall.ox) - ay
    return bool((dy * ux - dx * uy) * (ey * ux - ex * uy) <= 0.0)


@kernel(forceinline=True)
def has_neighbours(body: Any) -> bool:
    """Whether another shape may go with one of the body's: one of its own, or where nothing moves it another's."""
    return bool(body.kind == FIXED or not body.mobile or body.held - body.entered > 1)


@kernel(forceinline=True)
def _go_alike(one: Any, other: Any) -> bool:
    """Whether two bodies that nothing moves stay where they are to one another."""
    if one.kind == FIXED and other.kind == FIXED:
        return True
    if one.mobile or other.mobile or one.w != 0.0 or other.w != 0.0:
        return False
    return bool(one.vx == other.vx and one.vy == other.vy)


@kernel(forceinline=True)
def _covers(
    two: TwoShapes, t: int, own: int, other: int, body: Any, x: float, y: float, out: Outward, tie: float
) -> bool:
    """Whether a point of shape `own` of the body lies within shape t, which goes with it; `other` is there as well.

    Of two boundaries that are one (the caps of two segments at the joint) the later shape's lies within the first's:
    each looks `tie` larger to those after it and smaller to those before (length).
    """
    pool, tables, work = two.pool, two.tables, two.work
    shape = tables.shapes[t]
    wall = tables.bodies[shape.body]
    if shape.sensor or not (shape.body == tables.shapes[own].body or _go_alike(body, wall)):
        return False
    if shape.mirror >= 0:
        there = tables.shapes[other]
        far_x = 0.5 * (there.left + there.right)
        far_y = 0.5 * (there.bottom + there.top)
        return _behind_line(pool, shape, wall, x, y, far_x, far_y, out)
    if t < own:
        tie = -tie
    x += tie * out.x
    y += tie * out.y
    head = pool.heads[shape.outline]
    lx = wall.c * (x - wall.ox) + wall.s * (y - wall.oy) - head.x
    ly = wall.c * (y - wall.oy) - wall.s * (x - wall.ox) - head.y
    return bool(inside_outline(pool, shape.outline, Relative(1.0, 0.0, 0.0, 0.0), lx, ly, True, work))


@kernel
def lies_within(
    two: TwoShapes, own: int, other: int, body: Any, x: float, y: float, room: float, out: Outward, tie: float
) -> bool:
    """Whether a point, less deep than `room` in shape `own` of the body, lies within another that goes with it."""
    nodes = two.tables.nodes
    shape = two.tables.shapes[own]
    top, at = next_beside(nodes, shape.leaf, -1, x - room, y - room, x + room, y + room)
    while at >= 0:
        if _covers(two, nodes[at].owner, own, other, body, x, y, out, tie):
            return True
        top, at = next_beside(nodes, top, at, x - room, y - room, x + room, y + room)
    if shape.tree == STILL or (body.mobile and body.kind != FIXED):
        return False
    root = two.tables.roots[STILL]
    at = next_met(nodes, root, -1, x - room, y - room, x + room, y + room)
    while at >= 0:
        if _covers(two, nodes[at].owner, own, other, body, x, y, out, tie):
            return True
        at = next_met(nodes, root, at, x - room, y - room, x + room, y + room)
    return False


class Look(NamedTuple):
    """What is asked whether neighbours of a shape hide it."""

    two: TwoShapes
    own: int  # the shape
    other: int  # and the one that it meets
    body: Any  # its body
    head: Any  # of A's outline, in whose coordinates the work is
    pose: Pose  # where A's outline is
    at: Pose  # where its own is
    room: float  # so deep in it the points lie at most (length)


@kernel
def within_neighbours(look: Look, x: float, y: float, out_x: float, out_y: float, tie: float) -> bool:
    """Whether a point of the work lies within a neighbour.

    out_x, out_y: which way out of its shape it looks, in the work's axes (length 1); 0: no matter. tie: boundaries no
    farther apart are one (length).
    """
    lx = x + look.head.x
    ly = y + look.head.y
    x = look.pose.x + look.pose.c * lx - look.pose.s * ly
    y = look.pose.y + look.pose.s * lx + look.pose.c * ly
    ox = look.pose.c * out_x - look.pose.s * out_y
    oy = look.pose.s * out_x + look.pose.c * out_y
    body = look.body
    if body.kind != FIXED:  # where it is on the body now
        lx = look.at.c * (x - look.at.x) + look.at.s * (y - look.at.y)
        ly = look.at.c * (y - look.at.y) - look.at.s * (x - look.at.x)
        x = body.ox + body.c * lx - body.s * ly
        y = body.oy + body.s * lx + body.c * ly
    out = Outward(ox, oy)
    return bool(lies_within(look.two, look.own, look.other, body, x, y, look.room, out, tie))
