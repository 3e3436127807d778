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
from ..geometry.locate import inside_outline, nearest_edge
from ..geometry.place import Pose, seen_from
from ..geometry.pool import Pool
from ..geometry.work import A_EDGE, Relative, Work
from .constants import SMOOTH
from .motion import centre_of
from .patch import Patch, patch_of, reach_along
from .region import least_extent
from .tables import CHORD, FIXED, Law, Tables
from .tree import STILL, next_beside, next_met

#: A neighbour's boundary is looked for this far beyond an edge, of the smaller one's smallest extent: what lies flush.
FLUSH = 3e-3
#: Of a loop's edges the ones from here on share a bit.
MOST_EDGES = 62
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
def _along_centres(two: TwoShapes, patch: Patch, pose: Pose, other: Pose) -> Patch:
    """A patch of two bodies, one put into the midst of the other: away from its centre, as all their patches there."""
    ax, ay = centre_of(two.a, pose)
    bx, by = centre_of(two.b, other)
    apart = math.hypot(bx - ax, by - ay)
    if apart == 0.0:
        return patch
    return _turned(patch, patch.area, patch.x, patch.y, (bx - ax) / apart, (by - ay) / apart, patch.reach)


@kernel
def exposed_patch(two: TwoShapes, k: int, pose: Pose, other: Pose) -> Patch:
    """Loop k of the work as `patch_of` sees it, its direction that of what is exposed of a shape's edges.

    It is blind and of no area where a body is only within edges of which nothing is exposed.
    pose, other: where the outlines of A and B are.
    """
    patch = patch_of(two.pool, two.work, two.law, k, two.ia, two.ib, pose)
    if patch.blind or two.law.direction != CHORD:
        return patch
    first = 1 if two.a.mobile and not two.b.mobile else 0  # what nothing moves
    both = two.a.mobile and two.b.mobile
    best, turned = patch, False
    for i in range(2):
        of_b = first != i
        if _has_neighbours(two.b if of_b else two.a):
            found, hidden, lost = _exposed(two, k, pose, other, patch, of_b)
            if lost and both:
                return _along_centres(two, patch, pose, other)
            if hidden and not turned:
                best, turned = found, True
            if turned and not both:
                break
    return best


class _Look(NamedTuple):
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
def _within_neighbours(look: _Look, x: float, y: float) -> bool:
    """Whether a point of the work lies within a neighbour."""
    lx = x + look.head.x
    ly = y + look.head.y
    x = look.pose.x + look.pose.c * lx - look.pose.s * ly
    y = look.pose.y + look.pose.s * lx + look.pose.c * ly
    body = look.body
    if body.kind != FIXED:  # where it is on the body now
        lx = look.at.c * (x - look.at.x) + look.at.s * (y - look.at.y)
        ly = look.at.c * (y - look.at.y) - look.at.s * (x - look.at.x)
        x = body.ox + body.c * lx - body.s * ly
        y = body.oy + body.s * lx + body.c * ly
    return bool(_hidden(look.two, look.own, look.other, body, x, y, look.room))


@kernel
def _ends_within(
    look: _Look, theirs: _Look, loop: Any, side: int, hidden: int, of_b: bool, step: float
) -> bool:
    """Whether the other's one face of a loop, where it leaves by a hidden edge, ends in the neighbour behind that.

    Then the two meet with a corner of the other's, of which this loop shows one side alone; else with that face, and it
    is the corner of what the hidden edge is within. What goes on straight, in a neighbour of the other's, is no corner.
    step: so far beyond its end that is looked for (length).
    """
    two = look.two
    work = two.work
    count = loop.stop - loop.start
    m = 0
    while work.label[loop.start + m] == side:
        m += 1
    i = loop.start + m
    j = loop.start + (m + 1) % count
    rel = Relative(1.0, 0.0, 0.0, 0.0)
    if not of_b:
        rel = seen_from(two.pool.heads[two.ia], look.pose, two.pool.heads[two.ib], theirs.at)
    mx = 0.5 * (work.polygon[i, 0] + work.polygon[j, 0])
    my = 0.5 * (work.polygon[i, 1] + work.polygon[j, 1])
    px, py, qx, qy = nearest_edge(two.pool, two.ia if of_b else two.ib, rel, mx, my)
    dx = qx - px
    dy = qy - py
    length = math.sqrt(dx * dx + dy * dy)
    if length == 0.0:
        return False
    dx *= step / length
    dy *= step / length
    for way in (-1, 1):
        if hidden >> (m + way) % count & 1:
            x, y = (qx, qy) if way > 0 else (px, py)
            if _within_neighbours(look, x, y):
                # a trifle in: what is flush lies within the neighbour
                if not _within_neighbours(theirs, x + way * dx - FLUSH * dy, y + way * dy + FLUSH * dx):
                    return True
    return False


@kernel
def _goes_on(look: _Look, loop: Any, side: int, hidden: int, step: float) -> tuple[bool, bool]:
    """What an exposed edge of the loop is where it ends at a hidden one: a corner of the whole; straight on.

    A corner has nothing of the neighbours just beyond it, a trifle in. The foot of a ramp is neither: they are there a
    trifle out as well.
    step: so far beyond its end that is looked for (length).
    """
    work = look.two.work
    count = loop.stop - loop.start
    straight = False
    for n in range(count):
        m = (n + 1) % count
        i = loop.start + n
        j = loop.start + m
        if work.label[i] != side or work.label[j] != side or (hidden >> n ^ hidden >> m) & 1 == 0:
            continue
        exposed, way = (j, -1.0) if hidden >> n & 1 else (i, 1.0)
        if loop.arcs > 0 and work.bows[exposed, 2] != 0.0:
            continue
        far = loop.start + (exposed - loop.start + 1) % count
        dx = work.polygon[far, 0] - work.polygon[exposed, 0]
        dy = work.polygon[far, 1] - work.polygon[exposed, 1]
        length = math.sqrt(dx * dx + dy * dy)
        if length == 0.0:
            continue
        dx *= step / length
        dy *= step / length
        x = work.polygon[j, 0] + way * dx
        y = work.polygon[j, 1] + way * dy
        if not _within_neighbours(look, x - FLUSH * dy, y + FLUSH * dx):
            return True, False
        straight = not _within_neighbours(look, x + FLUSH * dy, y - FLUSH * dx)
    return False, straight


@kernel
def _exposed(
    two: TwoShapes, k: int, pose: Pose, other: Pose, patch: Patch, of_b: bool
) -> tuple[Patch, bool, bool]:
    """The patch by what is exposed of one shape's edges; whether any of them is hidden; whether they show no way."""
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
    if edges < 2 and caps == 0 and two.pair.head >= 0:  # one edge is hidden only if it is not met from out
        return patch, False, False
    head = pool.heads[two.ia]
    beyond = FLUSH * least_extent(two.a, two.b)
    look = _Look(two, own, mover, body, head, pose, at, patch.reach + 2.0 * beyond)
    nearer = 0.25 * patch.reach  # what is no deeper than that leaves the neighbour again
    nx = 0.0
    ny = 0.0
    hidden = 0  # edges that are, as bits
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
        within = _within_neighbours(look, mx + flush * dy, my - flush * dx)
        if not within and flush * length > nearer:
            flush = nearer / length
            within = _within_neighbours(look, mx + flush * dy, my - flush * dx)
        if within:
            hidden |= 1 << min(i - loop.start, MOST_EDGES)
        else:
            nx += dy
            ny -= dx
    if hidden == 0:
        return patch, False, False
    length = math.sqrt(nx * nx + ny * ny)
    corner = straight = False
    if length > 0.0 and (faces == 1 or length <= beyond):
        corner, straight = _goes_on(look, loop, side, hidden, min(beyond, nearer))
    if length == 0.0 or (straight and length <= beyond):  # a neighbour bears what lies on a sliver
        there = two.tables.shapes[mover]
        x = 0.5 * (there.left + there.right)
        y = 0.5 * (there.bottom + there.top)
        if not _hidden(two, own, mover, body, x, y, look.room):  # it is not put into the midst of them
            # all of it within neighbours, which say where the body can go
            return _turned(patch, 0.0, patch.x, patch.y, patch.nx, patch.ny, patch.reach), True, False
    if length == 0.0:
        return patch, False, True
    if side != A_EDGE:  # from A to B is into B
        length = -length
    nx /= length
    ny /= length
    if faces == 1:  # along which the chord lies
        across = loop.chord_x * nx + loop.chord_y * ny
        flat = across * across <= SMOOTH * patch.chord * patch.chord  # a piece of it lies as the whole does
        theirs = _Look(
            two, mover, own, two.a if of_b else two.b, head, pose, pose if of_b else other, look.room
        )
        if flat or corner or not _ends_within(look, theirs, loop, side, hidden, of_b, beyond):
            return patch, True, False  # it says better where to go
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
    return _turned(patch, patch.area, px, py, wx, wy, reach), True, False
