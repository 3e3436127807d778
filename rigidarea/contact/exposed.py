"""Of a boundary only that counts which can be reached: the rest lies within neighbours that go with it.

The foot of a ramp lies on a floor, the side of a tile at the next tile's. A body that has sunk into the floor by what
carries it has that edge of the ramp within it as well, and the chord, from the ramp's slope to its underside, would
stand across. What is exposed says where the body can go: the direction is the mean normal of the exposed part of the
boundary, which for a boundary that is exposed as a whole is the chord's (the integral of normals round a region is 0).

Neighbours are the shapes of one body, and of bodies that nothing moves and that go alike: a level's, a platform's.
"""

from __future__ import annotations

import math
from typing import Any

from ..compile.jit import kernel
from ..geometry.locate import nearest_edge
from ..geometry.place import Pose, seen_from
from ..geometry.work import A_EDGE, Relative
from .constants import SMOOTH
from .motion import centre_of
from .neighbours import Look, Outward, TwoShapes, has_neighbours, lies_within, within_neighbours
from .patch import Patch, patch_of, reach_along
from .region import least_extent
from .tables import CHORD

#: A neighbour's boundary is looked for this far beyond an edge, of the smaller one's smallest extent: what lies flush.
FLUSH = 3e-3
#: Two arcs of neighbours that are no farther apart than this part of that are one, and the later one's lies within.
TIE = 1e-4
#: Of a loop's edges the ones from here on share a bit.
MOST_EDGES = 62
#: A direction that turns by less than the angle with this cosine leaves a straight face what it is.
SAME_FACE = 0.9


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
        if has_neighbours(two.b if of_b else two.a):
            found, hidden, lost = _exposed(two, k, pose, other, patch, of_b)
            if lost and both:
                return _along_centres(two, patch, pose, other)
            if hidden and not turned:
                best, turned = found, True
            if turned and not both:
                break
    return best


@kernel
def _ends_within(
    look: Look, theirs: Look, loop: Any, side: int, hidden: int, of_b: bool, step: float
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
            if within_neighbours(look, x, y, 0.0, 0.0, 0.0):
                # a trifle in: what is flush lies within the neighbour
                x += way * dx - FLUSH * dy
                y += way * dy + FLUSH * dx
                if not within_neighbours(theirs, x, y, 0.0, 0.0, 0.0):
                    return True
    return False


@kernel
def _goes_on(look: Look, loop: Any, side: int, hidden: int, step: float) -> tuple[bool, bool]:
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
        if not within_neighbours(look, x - FLUSH * dy, y + FLUSH * dx, 0.0, 0.0, 0.0):
            return True, False
        straight = not within_neighbours(look, x + FLUSH * dy, y - FLUSH * dx, 0.0, 0.0, 0.0)
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
    look = Look(two, own, mover, body, head, pose, at, patch.reach + 2.0 * beyond)
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
        out_x = dy / length
        out_y = -dx / length
        flush = beyond
        tie = 0.0
        mx = 0.5 * (work.polygon[j, 0] + work.polygon[i, 0])
        my = 0.5 * (work.polygon[j, 1] + work.polygon[i, 1])
        if loop.arcs > 0 and work.bows[i, 2] != 0.0:  # the arc's middle, which is less than half a turn
            ux = mx - work.bows[i, 0]
            uy = my - work.bows[i, 1]
            far = 1.0 / math.sqrt(ux * ux + uy * uy)
            mx = work.bows[i, 0] + abs(work.bows[i, 2]) * far * ux
            my = work.bows[i, 1] + abs(work.bows[i, 2]) * far * uy
            far = math.copysign(far, work.bows[i, 2])
            out_x = far * ux
            out_y = far * uy
            tie = TIE * beyond
            flush = 0.0  # it leaves the neighbour's side along a tangent: what lies flush is within it
        within = within_neighbours(look, mx + flush * out_x, my + flush * out_y, out_x, out_y, tie)
        if not within and flush > nearer:
            flush = nearer
            within = within_neighbours(look, mx + flush * out_x, my + flush * out_y, out_x, out_y, tie)
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
        # it is not put into the midst of them
        if not lies_within(two, own, mover, body, x, y, look.room, Outward(0.0, 0.0), 0.0):
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
        theirs = Look(
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
