"""Of a boundary only that counts which can be reached: the rest lies within neighbours that go with it.

The foot of a ramp lies on a floor, the side of a tile at the next tile's. A body that has sunk into the floor by what
carries it has that edge of the ramp within it as well, and the chord, from the ramp's slope to its underside, would
stand across. What is exposed says where the body can go: the direction is the mean normal of the exposed part of the
boundary, which for a boundary that is exposed as a whole is the chord's (the integral of normals round a region is 0).

Neighbours are the shapes of one body, and of bodies that nothing moves and that go alike: a level's, a platform's.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from ..compile.jit import kernel
from ..geometry.locate import inside_outline
from ..geometry.place import Pose
from ..geometry.pool import Pool
from ..geometry.work import A_EDGE, Relative, Work
from .constants import SMOOTH
from .patch import Patch, patch_of, reach_along
from .tables import CHORD, FIXED, Law, Tables
from .target_speeds import least_extent
from .tree import STILL, next_beside, next_met

#: A neighbour's boundary is looked for this far beyond an edge, of the smaller one's smallest extent: what lies flush.
FLUSH = 2e-4
#: A direction that turns by less than the angle with this cosine leaves a straight face what it is.
SAME_FACE = 0.9


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


@kernel
def _behind_line(pool: Pool, shape: Any, wall: Any, x: float, y: float, far_x: float, far_y: float) -> bool:
    """Whether a point lies behind a segment without thickness, or on it, seen from (far_x, far_y).

    As far past its ends as it lies behind: between two segments of a chain nothing is exposed.
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
    if not -behind <= along <= ux * ux + uy * uy + behind:
        return False
    ex = wall.c * (far_x - wall.ox) + wall.s * (far_y - wall.oy) - ax
    ey = wall.c * (far_y - wall.oy) - wall.s * (far_x - wall.ox) - ay
    return bool((dy * ux - dx * uy) * (ey * ux - ex * uy) <= 0.0)


@kernel(forceinline=True)
def _has_neighbours(body: Any) -> bool:
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
def _covers(two: TwoShapes, t: int, own: int, other: int, body: Any, x: float, y: float) -> bool:
    """Whether a point of shape `own` of the body lies within shape t, which goes with it; `other` is there as well."""
    pool, tables, work = two.pool, two.tables, two.work
    shape = tables.shapes[t]
    wall = tables.bodies[shape.body]
    if shape.sensor or not (shape.body == tables.shapes[own].body or _go_alike(body, wall)):
        return False
    if shape.mirror >= 0:
        there = tables.shapes[other]
        far_x = 0.5 * (there.left + there.right)
        far_y = 0.5 * (there.bottom + there.top)
        return _behind_line(pool, shape, wall, x, y, far_x, far_y)
    head = pool.heads[shape.outline]
    lx = wall.c * (x - wall.ox) + wall.s * (y - wall.oy) - head.x
    ly = wall.c * (y - wall.oy) - wall.s * (x - wall.ox) - head.y
    return bool(inside_outline(pool, shape.outline, Relative(1.0, 0.0, 0.0, 0.0), lx, ly, True, work))


@kernel
def _hidden(two: TwoShapes, own: int, other: int, body: Any, x: float, y: float, room: float) -> bool:
    """Whether a point, less deep than `room` in shape `own` of the body, lies within another that goes with it."""
    nodes = two.tables.nodes
    shape = two.tables.shapes[own]
    top, at = next_beside(nodes, shape.leaf, -1, x - room, y - room, x + room, y + room)
    while at >= 0:
        if _covers(two, nodes[at].owner, own, other, body, x, y):
            return True
        top, at = next_beside(nodes, top, at, x - room, y - room, x + room, y + room)
    if shape.tree == STILL or (body.mobile and body.kind != FIXED):
        return False
    root = two.tables.roots[STILL]
    at = next_met(nodes, root, -1, x - room, y - room, x + room, y + room)
    while at >= 0:
        if _covers(two, nodes[at].owner, own, other, body, x, y):
            return True
        at = next_met(nodes, root, at, x - room, y - room, x + room, y + room)
    return False


@kernel
def _turned(patch: Patch, area: float, x: float, y: float, nx: float, ny: float, reach: float) -> Patch:
    """A patch along another direction: what turns far has lost its face."""
    face = nx * patch.nx + ny * patch.ny > SAME_FACE
    return Patch(
        area,
        x,
        y,
        nx,
        ny,
        patch.chord,
        patch.middle if face else 0.0,
        patch.straight if face else 0.0,
        0.0,
        0.0,
        patch.depth if face else reach,
        reach,
        area == 0.0,
        patch.radial,
    )


@kernel
def exposed_patch(two: TwoShapes, k: int, pose: Pose, other: Pose) -> Patch:
    """Loop k of the work as `patch_of` sees it, its direction that of what is exposed of a shape's edges.

    It is blind and of no area where a body is only within a round end of which nothing is exposed.
    pose, other: where the outlines of A and B are.
    """
    patch = patch_of(two.pool, two.work, two.law, k, two.ia, two.ib, pose)
    if patch.blind or two.law.direction != CHORD:
        return patch
    first = 1 if two.a.mobile and not two.b.mobile else 0  # what nothing moves
    for i in range(2):
        of_b = first != i
        if _has_neighbours(two.b if of_b else two.a):
            found, hidden = _exposed(two, k, pose, other, patch, of_b)
            if hidden:
                return found
    return patch


@kernel
def _exposed(two: TwoShapes, k: int, pose: Pose, other: Pose, patch: Patch, of_b: bool) -> tuple[Patch, bool]:
    """The patch by what is exposed of one shape's edges; and whether any of them is hidden."""
    pool, work = two.pool, two.work
    own, mover, body, side = two.pair.a, two.pair.b, two.a, A_EDGE
    at = pose
    if of_b:
        own, mover, body, side = two.pair.b, two.pair.a, two.b, 1 - A_EDGE
        at = other
    loop = work.loops[k]
    edges = 0
    caps = 0
    faces = 0  # of the other's
    for i in range(loop.start, loop.stop):
        curved = loop.arcs > 0 and work.bows[i, 2] != 0.0
        if work.label[i] == side:
            edges += 1
            caps += curved
        else:
            faces += 2 if curved else 1
    if edges < 2 and caps == 0:
        return patch, False
    head = pool.heads[two.ia]
    beyond = FLUSH * least_extent(two.a, two.b)
    room = patch.reach + 2.0 * beyond
    nx = 0.0
    ny = 0.0
    hidden = False
    for i in range(loop.start, loop.stop):
        j = i + 1 if i + 1 < loop.stop else loop.start
        dx = work.polygon[j, 0] - work.polygon[i, 0]
        dy = work.polygon[j, 1] - work.polygon[i, 1]
        length = math.sqrt(dx * dx + dy * dy)
        if work.label[i] != side or length == 0.0:
            continue
        flush = beyond / length
        mx = 0.5 * (work.polygon[j, 0] + work.polygon[i, 0])
        my = 0.5 * (work.polygon[j, 1] + work.polygon[i, 1])
        if loop.arcs > 0 and work.bows[i, 2] != 0.0:  # the arc's middle, which is less than half a turn
            ux = mx - work.bows[i, 0]
            uy = my - work.bows[i, 1]
            out = abs(work.bows[i, 2]) / math.sqrt(ux * ux + uy * uy)
            mx = work.bows[i, 0] + out * ux
            my = work.bows[i, 1] + out * uy
            flush = 0.0  # it leaves the neighbour's side along a tangent: what lies flush is within it
        lx = mx + flush * dy + head.x
        ly = my - flush * dx + head.y
        x = pose.x + pose.c * lx - pose.s * ly
        y = pose.y + pose.s * lx + pose.c * ly
        if body.kind != FIXED:  # where it is on the body now
            lx = at.c * (x - at.x) + at.s * (y - at.y)
            ly = at.c * (y - at.y) - at.s * (x - at.x)
            x = body.ox + body.c * lx - body.s * ly
            y = body.oy + body.s * lx + body.c * ly
        if _hidden(two, own, mover, body, x, y, room):
            hidden = True
        else:
            nx += dy
            ny -= dx
    length = math.sqrt(nx * nx + ny * ny)
    if (
        length == 0.0 and hidden and caps > 0
    ):  # all of it within a neighbour, which says where the body can go
        return _turned(patch, 0.0, patch.x, patch.y, patch.nx, patch.ny, patch.reach), True
    if not hidden or length == 0.0:
        return patch, False
    if side != A_EDGE:  # from A to B is into B
        length = -length
    nx /= length
    ny /= length
    across = loop.chord_x * nx + loop.chord_y * ny  # the chord lies along the other's one face
    if faces == 1 and across * across <= SMOOTH * patch.chord * patch.chord:
        return patch, True  # which says better where to go: a piece of it lies on it as the whole does
    wx = pose.c * nx - pose.s * ny
    wy = pose.s * nx + pose.c * ny
    reach = reach_along(work, loop.start, loop.stop, loop.arcs > 0, nx, ny)
    px = patch.x
    py = patch.y
    if patch.radial:  # a disc's force goes through its centre
        for i in range(loop.start, loop.stop):
            if work.label[i] != side and work.bows[i, 2] != 0.0:
                lx = work.bows[i, 0] + head.x
                ly = work.bows[i, 1] + head.y
                cx = pose.x + pose.c * lx - pose.s * ly
                cy = pose.y + pose.s * lx + pose.c * ly
                along = (px - cx) * wx + (py - cy) * wy
                px = cx + along * wx
                py = cy + along * wy
                break
    return _turned(patch, patch.area, px, py, wx, wy, reach), True
