"""From a pair of shapes to its contact regions: overlap, and which region of the substep before each one is.

A region is matched with the nearest of its pair's regions of the substep before; it keeps its impulses, its friction
spring and its direction while it lives. One that is new may be an impact: then its place is that of first touch,
found by going back along the bodies' motion (`touch`), so that neither the point nor the direction depends on how
deep a step has carried one body into the other, and nothing is jumped over.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from .constants import HIT, LOOK, MOST_ARRIVED, MOST_LOOKS, PUT, PUT_FOLLOWED, REST_KICKS
from .direction import chord_direction, nodal_direction
from .extent import extent
from .jit import kernel
from .overlap import A_EDGE, OVERFLOW, Work
from .place import Pose, overlap_of_outlines, push_out, seen_from
from .pool import Pool
from .sides import length_on_first_edge, shown_sides
from .stiffness import choose_stiffness, depth_for
from .tables import (
    CHORD,
    DRIFTS,
    FREE_REGION,
    FREE_REGIONS,
    IMPACT,
    LAW_AREA,
    LAW_ENERGY,
    NEARING,
    PLACED,
    REST,
    SPENT,
    STRUCK,
    SUBSTEP,
    Law,
    Tables,
    free_regions,
)
from .turning import curvature_of_disc, curvatures

DONE, GROW_WORK, GROW_REGIONS = 0, 1, 2


class Patch(NamedTuple):
    """One loop of an overlap as a contact sees it, world axes."""

    area: float
    x: float
    y: float
    nx: float
    ny: float
    chord: float
    middle: float
    straight: float
    curve_a: float
    curve_b: float
    depth: float
    reach: float  # its extent along the direction
    blind: bool  # the chord is nothing: no direction of its own


@kernel(forceinline=True)
def pose_of(body: Any) -> Pose:
    """Where a body's outlines are."""
    return Pose(body.ox, body.oy, body.c, body.s)


@kernel
def earlier(body: Any, time: float) -> Pose:
    """Where they were `time` ago, at the velocity at which it has come; negative: will be, at its present velocity.

    What the user has put there, or sent off from there, has been there before.
    """
    if body.kind != DRIFTS:
        return pose_of(body)
    time = min(time, body.since)
    came = 1.0 if time > 0.0 else 0.0
    angle = time * (body.w - came * body.kick_w)
    cd = math.cos(angle)
    sd = math.sin(angle)
    c = body.c * cd + body.s * sd
    s = body.s * cd - body.c * sd
    x = body.x - time * (body.vx - came * body.kick_x)
    y = body.y - time * (body.vy - came * body.kick_y)
    return Pose(x - (c * body.cog_x - s * body.cog_y), y - (s * body.cog_x + c * body.cog_y), c, s)


@kernel
def _reach_along(work: Work, start: int, stop: int, arcs: bool, nx: float, ny: float) -> float:
    """Extent of a loop along (nx, ny), in its own frame (length)."""
    low, high = extent(work.polygon, work.bows, start, stop, arcs, nx, ny)
    return high - low


@kernel
def _depth(work: Work, start: int, stop: int, arcs: bool, nx: float, ny: float, reach: float) -> float:
    """How far a loop's outlines have gone into each other: its least width, of those across n and its longest edges.

    Along n (`reach`) alone a thin long strip would seem deep, its chord running from corner to opposite corner.
    """
    least = reach
    for own in range(2):
        longest = 0.0
        bx = 0.0
        by = 0.0
        j = stop - 1
        for i in range(start, stop):
            if work.label[j] == own:
                dx = work.polygon[i, 0] - work.polygon[j, 0]
                dy = work.polygon[i, 1] - work.polygon[j, 1]
                length = dx * dx + dy * dy
                if length > longest:
                    longest = length
                    bx = dx
                    by = dy
            j = i
        if longest > 0.0:
            length = math.sqrt(longest)
            least = min(least, _reach_along(work, start, stop, arcs, -by / length, bx / length))
    return least


@kernel
def _patch(pool: Pool, work: Work, law: Law, k: int, ia: int, ib: int, pose: Pose) -> Patch:
    """Loop k of the work, of outlines ia at `pose` and ib."""
    loop = work.loops[k]
    head = pool.heads[ia]
    lx = loop.x + head.x
    ly = loop.y + head.y
    x = pose.x + pose.c * lx - pose.s * ly
    y = pose.y + pose.s * lx + pose.c * ly
    if law.direction == CHORD:
        nx, ny = chord_direction(loop.chord_x, loop.chord_y, loop.area)
    else:
        nx, ny = nodal_direction(work.polygon, work.label, loop.start, loop.stop, law.exponent)
        if nx == 0.0 and ny == 0.0:
            nx, ny = chord_direction(loop.chord_x, loop.chord_y, loop.area)
    blind = nx == 0.0 and ny == 0.0
    chord = math.sqrt(loop.chord_x * loop.chord_x + loop.chord_y * loop.chord_y)
    middle = 0.0
    if blind:
        chord = math.sqrt(loop.area)
    else:
        middle = loop.lever / chord
    wx = pose.c * nx - pose.s * ny
    wy = pose.s * nx + pose.c * ny
    straight = min(loop.straight, chord)
    depth = chord
    reach = chord
    curve_a = 0.0
    curve_b = 0.0
    if not blind:
        reach = _reach_along(work, loop.start, loop.stop, loop.arcs > 0, nx, ny)
        if straight > 0.0 or loop.arcs == 0 or chord == 0.0:
            depth = _depth(work, loop.start, loop.stop, loop.arcs > 0, nx, ny, reach)
        else:
            depth = min(reach, 2.0 * loop.area / chord)  # of a crescent its chord's normal says too much
            both = 12.0 * loop.area / (chord * chord * chord)
            if head.disc:
                curve_a = curvature_of_disc(head.radius, chord)
                curve_b = both - curve_a
            elif pool.heads[ib].disc:
                curve_b = curvature_of_disc(pool.heads[ib].radius, chord)
                curve_a = both - curve_b
            else:
                curve_a, curve_b = curvatures(
                    work.polygon, work.label, work.bows, loop.start, loop.stop, loop.area, chord
                )
    return Patch(loop.area, x, y, wx, wy, chord, middle, straight, curve_a, curve_b, depth, reach, blind)


@kernel
def _reach(work: Work, n: int) -> float:
    """Largest depth of the work's n loops, along their chords' normals (length)."""
    most = 0.0
    for k in range(n):
        loop = work.loops[k]
        nx, ny = chord_direction(loop.chord_x, loop.chord_y, loop.area)
        if nx != 0.0 or ny != 0.0:
            most = max(most, _reach_along(work, loop.start, loop.stop, loop.arcs > 0, nx, ny))
    return most


@kernel(forceinline=True)
def _match(regions: np.ndarray, head: int, x: float, y: float, stamp: int) -> int:
    """The region of the list nearest to (x, y) that is not yet taken in this substep; -1: none."""
    best = -1
    least = np.inf
    r = head
    while r >= 0:
        if regions[r].stamp != stamp:
            d = (regions[r].x - x) ** 2 + (regions[r].y - y) ** 2
            if d < least:
                least = d
                best = r
        r = regions[r].next
    return best


@kernel
def _fill(region: Any, patch: Patch, ax: float, ay: float, bx: float, by: float) -> None:
    """The region's place and arms: about the centres (ax, ay) and (bx, by)."""
    region.area = patch.area
    region.x = patch.x
    region.y = patch.y
    region.nx = patch.nx
    region.ny = patch.ny
    region.chord = patch.chord
    region.middle = patch.middle
    region.straight = patch.straight
    region.curve_a = patch.curve_a
    region.curve_b = patch.curve_b
    region.depth = patch.depth
    region.arm_a = (patch.x - ax) * patch.ny - (patch.y - ay) * patch.nx
    region.arm_b = (patch.x - bx) * patch.ny - (patch.y - by) * patch.nx
    region.lean_a = (patch.x - ax) * patch.nx + (patch.y - ay) * patch.ny
    region.lean_b = (patch.x - bx) * patch.nx + (patch.y - by) * patch.ny


@kernel(forceinline=True)
def _centre(body: Any, pose: Pose) -> tuple[float, float]:
    """A body's centre of gravity, its outlines at `pose`."""
    return (
        pose.x + pose.c * body.cog_x - pose.s * body.cog_y,
        pose.y + pose.s * body.cog_x + pose.c * body.cog_y,
    )


@kernel(forceinline=True)
def closing(r: Any, a: Any, b: Any, full: float) -> float:
    """Closing speed at the region (length/time), with the part `full` of the substep's kick taken off."""
    return (
        (a.vx - b.vx - full * (a.kick_x - b.kick_x)) * r.nx
        + (a.vy - b.vy - full * (a.kick_y - b.kick_y)) * r.ny
        + (a.w - full * a.kick_w) * r.arm_a
        - (b.w - full * b.kick_w) * r.arm_b
    )


@kernel(forceinline=True)
def inverse_mass(r: Any, a: Any, b: Any) -> float:
    """1/m_eff of the two bodies along the region's direction (design 2.3)."""
    return (
        a.inverse_mass
        + b.inverse_mass
        + r.arm_a * r.arm_a * a.inverse_moment
        + r.arm_b * r.arm_b * b.inverse_moment
    )


@kernel(forceinline=True)
def region_stiffness(law: Law, k: float, chord: float) -> float:
    """dF/ddelta of a region (design 2.3)."""
    if law.law == LAW_AREA:
        return k * chord
    return k * chord * chord / law.length


@kernel
def jumped(tables: Tables, pair: Any, a: Any, b: Any, h: float) -> int:
    """Into how many looks the last substep's motion must be cut so that the pair cannot pass unseen; 1: none."""
    sa = tables.shapes[pair.a]
    sb = tables.shapes[pair.b]
    dx = (a.vx - a.kick_x) - (b.vx - b.kick_x)
    dy = (a.vy - a.kick_y) - (b.vy - b.kick_y)
    way = math.sqrt(dx * dx + dy * dy)
    turn = abs(a.w) * (sa.half_x + sa.half_y) + abs(b.w) * (sb.half_x + sb.half_y)
    least = LOOK * min(sa.extent, sb.extent)
    n = h * (way + turn) / least
    if n <= 1.0:
        return 1
    return int(min(n, MOST_LOOKS)) + 1


@kernel(forceinline=True)
def _since(a: Any, b: Any) -> float:
    """How long one of the two has moved by itself (time)."""
    return max(a.since if a.kind == DRIFTS else 0.0, b.since if b.kind == DRIFTS else 0.0)


@kernel(forceinline=True)
def _unseen(pair: Any, h: float) -> float:
    """For how long nobody has looked at a pair without a region: a substep, and what it waited for Chipmunk (time)."""
    return h + (pair.waited if pair.waiting == pair.stamp - 1 else 0.0)


@kernel
def overlap_before(
    pool: Pool, work: Work, ia: int, ib: int, a: Any, b: Any, h: float, looks: int
) -> tuple[int, float]:
    """(regions, how long ago) at the first of `looks` places on the way of the last h where the two overlap.

    As they are now if they did so already where the user has put them.
    """
    way = min(h, _since(a, b))
    if way < h:
        n, _ = overlap_of_outlines(pool, ia, earlier(a, way), ib, earlier(b, way), work)
        if n != 0:
            n, _ = overlap_of_outlines(pool, ia, pose_of(a), ib, pose_of(b), work)
            return n, 0.0
    for i in range(looks):
        back = way * (looks - 1 - i) / looks
        n, _ = overlap_of_outlines(pool, ia, earlier(a, back), ib, earlier(b, back), work)
        if n != 0:
            return n, back
    return 0, 0.0


@kernel
def meets_within(pool: Pool, tables: Tables, work: Work, pair: Any, h: float) -> int:
    """Whether the two overlap somewhere on the way of the next h, at their present velocities: regions, 0, OVERFLOW."""
    sa = tables.shapes[pair.a]
    sb = tables.shapes[pair.b]
    a = tables.bodies[sa.body]
    b = tables.bodies[sb.body]
    ia = sa.outline
    ib = sb.outline
    if sa.mirror >= 0 or sb.mirror >= 0:
        ia, ib = shown_sides(pool, tables, pair, pose_of(a), pose_of(b))
    looks = jumped(tables, pair, a, b, h)
    for i in range(looks):
        ahead = -h * (i + 1) / looks
        n, _ = overlap_of_outlines(pool, ia, earlier(a, ahead), ib, earlier(b, ahead), work)
        if n != 0:
            return n
    return 0


@kernel
def _touch(
    pool: Pool,
    work: Work,
    law: Law,
    region: Any,
    ia: int,
    ib: int,
    a: Any,
    b: Any,
    back: float,
    h: float,
    unseen: float,
) -> bool:
    """Put a new region where the two have touched first; False: it has not come there by moving.

    Found at depth d, `back` ago, with the closing speed u there and what else pushes giving it g in a time: it was
    u0 at touch, u0^2 = u^2 - 2 g d, tau = 2 d / (u + u0) earlier still. A thousandth of the depth is left, so that
    there is a region to see its direction by. Leaves in `region.back` how long ago the bodies were where its arms are:
    what is done there and then, and carried on from there, keeps all momenta. All that holds of what is to come as
    well (`back` negative).
    """
    come = back > 0.0
    region.back = back
    for _ in range(3):
        d = region.depth
        u = closing(region, a, b, 0.5)
        gain = 2.0 * (u - closing(region, a, b, 1.0)) / h
        u -= gain * back
        root = u * u - 2.0 * gain * d
        if u <= 0.0 or root < 0.0:
            return come
        tau = 2.0 * d / (u + math.sqrt(root))
        if tau + back > min(MOST_ARRIVED * unseen, _since(a, b)):
            return come
        come = True
        best = -1
        then = back
        for share in (0.999, 0.9, 0.5):
            then = back + share * tau
            pose = earlier(a, then)
            other = earlier(b, then)
            n, _ = overlap_of_outlines(pool, ia, pose, ib, other, work)
            least = np.inf
            for k in range(n):
                patch = _patch(pool, work, law, k, ia, ib, pose)
                far = (patch.x - region.x) ** 2 + (patch.y - region.y) ** 2
                if not patch.blind and patch.nx * region.nx + patch.ny * region.ny > 0.0 and far < least:
                    least = far
                    best = k
            if best >= 0:
                break
        if best < 0:
            return come
        patch = _patch(pool, work, law, best, ia, ib, pose)
        ax, ay = _centre(a, pose)
        bx, by = _centre(b, other)
        _fill(region, patch, ax, ay, bx, by)
        region.back = then
        back = then
        if patch.depth < 0.01 * d:
            return come
    return come


@kernel(forceinline=True)
def _slow(law: Law, gain: float, rate2: float, h: float) -> float:
    """First touch slower than this is rest (length/time): what pushes gives that much in a few steps."""
    if law.rest_speed >= 0.0:
        return law.rest_speed
    return REST_KICKS * abs(gain) * max(h, 1.0 / math.sqrt(rate2))


@kernel(forceinline=True)
def _size(body: Any) -> float:
    """The smallest extent of a body that moves (length)."""
    return body.extent if body.mobile else np.inf


@kernel
def _hit(law: Law, r: Any, a: Any, b: Any, h: float) -> bool:
    """Whether a region at rest closes so fast that its bodies go deeper in a step than they are now."""
    u = closing(r, a, b, 1.0)
    if law.followed == math.inf or u * h <= max(r.depth, HIT * min(_size(a), _size(b))):
        return False
    pushed = max(
        law.gravity, abs(closing(r, a, b, 0.0) - u) / h
    )  # in a stack both fall alike: gravity counts
    return bool(u > REST_KICKS * pushed * h)


@kernel(forceinline=True)
def _arrives(r: Any, a: Any, b: Any, h: float) -> bool:
    """Whether what has been let come just to touch is there, and closes as fast as before: now it is to be stopped."""
    return bool(closing(r, a, b, 1.0) * h > 2.0 * max(r.depth, r.rest_depth))


@kernel
def _jumped_in(law: Law, r: Any, before: float, a: Any, b: Any, h: float) -> bool:
    """Whether an overlap has become deeper than its bodies' motion can have made it, by far.

    By how far: where the step does not follow the contact, by what a solve may have left, which takes its load.
    """
    speed = abs(closing(r, a, b, 0.0)) + abs(closing(r, a, b, 1.0))
    inside = r.depth - before - MOST_ARRIVED * h * speed
    least = min(_size(a), _size(b))
    if inside <= PUT_FOLLOWED * least:
        return False
    phase2 = region_stiffness(law, r.stiffness, r.chord) * inverse_mass(r, a, b) * h * h
    return bool(phase2 <= law.followed or inside > PUT * least)


@kernel
def _enter(
    pool: Pool,
    work: Work,
    law: Law,
    pair: Any,
    region: Any,
    face: float,
    ia: int,
    ib: int,
    a: Any,
    b: Any,
    back: float,
    h: float,
) -> None:
    """What a new region is: an impact that the steps follow, one shorter than the step, or rest."""
    k = pair.stiffness
    region.stiffness = k
    stiffness = region_stiffness(law, k, max(region.chord, face))
    inverse = inverse_mass(region, a, b)
    phase2 = stiffness * inverse * h * h
    push = 2.0 * (closing(region, a, b, 0.5) - closing(region, a, b, 1.0)) / (h * inverse)
    region.rest_depth = depth_for(law, region, k, push)
    unseen = _unseen(pair, h)
    placed = law.followed != math.inf and back == 0.0 and _jumped_in(law, region, 0.0, a, b, unseen)
    if phase2 <= law.followed and back == 0.0:
        region.mode = REST if placed else IMPACT
    else:
        touched = _touch(pool, work, law, region, ia, ib, a, b, back, h, unseen)
        region.mode = STRUCK if touched else REST
    region.placed = PLACED if placed and region.mode == REST else 0
    u = closing(region, a, b, 0.5)
    gain = 2.0 * (u - closing(region, a, b, 1.0)) / h
    u -= gain * region.back
    slow = _slow(law, gain, stiffness * inverse, h)
    if region.mode == REST and not placed and phase2 > law.followed and min(1.0, pair.elasticity) * u > slow:
        region.mode = STRUCK  # a bounce off somebody else has put it there: it bounces here and now
    region.first_speed = max(u, 0.0)
    region.opened = 0
    if u <= slow:
        if region.mode == IMPACT:
            region.mode = REST
        region.first_speed = 0.0
    elif region.mode == STRUCK and pair.elasticity == 0.0:
        region.first_speed = 0.0


@kernel
def _await(
    pool: Pool,
    work: Work,
    law: Law,
    pair: Any,
    region: Any,
    face: float,
    ia: int,
    ib: int,
    a: Any,
    b: Any,
    ahead: float,
    h: float,
) -> bool:
    """What a region that will be there in `ahead` is: NEARING, or a bounce within this drift; False: neither."""
    region.stiffness = pair.stiffness
    stiffness = region_stiffness(law, pair.stiffness, max(region.chord, face))
    inverse = inverse_mass(region, a, b)
    if stiffness * inverse * h * h <= law.followed:
        return False  # the steps follow it
    u = closing(region, a, b, 0.0)
    gain = max(0.0, u - closing(region, a, b, 1.0)) / h
    if min(1.0, pair.elasticity) * u > 0.0 and u > _slow(law, gain, stiffness * inverse, h):
        region.mode = STRUCK
        region.rest_depth = 0.0
        region.first_speed = u
        # positions are those of the middle of the substep: the drift yet to come is the half of it
        return _touch(pool, work, law, region, ia, ib, a, b, -ahead, h, h) and region.back >= -0.5 * h
    region.mode = NEARING
    region.first_speed = 0.0
    # in a stack both fall alike, and it will carry something all the same
    lying = law.gravity / (inverse * region_stiffness(law, pair.stiffness, face))
    rest = max(lying, depth_for(law, region, pair.stiffness, gain / inverse))
    region.rest_depth = min(region.depth, rest)
    region.back = ahead
    return True


@kernel
def _face(pool: Pool, sa: Any, sb: Any, a: Any, b: Any) -> float:
    """The chord on which one of the two would lie on the other (length)."""
    face = np.inf
    if a.mobile:
        face = min(face, pool.heads[sa.outline].face)
    if b.mobile:
        face = min(face, pool.heads[sb.outline].face)
    return face


@kernel
def meet(pool: Pool, tables: Tables, work: Work, law: Law, p: int, h: float) -> int:
    """Bring pair p's regions up to where its bodies are: their places, and which of them are new. DONE, or GROW_...

    Nothing is changed unless the answer is DONE.
    """
    pair = tables.pairs[p]
    regions = tables.regions
    counters = tables.counters
    stamp = counters[SUBSTEP]
    sa = tables.shapes[pair.a]
    sb = tables.shapes[pair.b]
    a = tables.bodies[sa.body]
    b = tables.bodies[sb.body]
    pose_a = pose_of(a)
    pose_b = pose_of(b)
    ia = sa.outline
    ib = sb.outline
    if sa.mirror >= 0 or sb.mirror >= 0:
        ia, ib = shown_sides(pool, tables, pair, earlier(a, h), earlier(b, h))
    fresh = pair.head < 0
    back = 0.0
    unseen = _unseen(pair, h) if fresh else h
    looks = jumped(tables, pair, a, b, unseen) if fresh else 1
    if looks > 1:
        n, back = overlap_before(pool, work, ia, ib, a, b, unseen, looks)
        if back > 0.0:
            pose_a = earlier(a, back)
            pose_b = earlier(b, back)
    else:
        n, _ = overlap_of_outlines(pool, ia, pose_a, ib, pose_b, work)
    if n == OVERFLOW:
        return GROW_WORK
    if n == 0:
        if not fresh:
            free_regions(regions, counters, pair.head)
            pair.head = -1
        return DONE
    if n > counters[FREE_REGIONS]:
        return GROW_REGIONS
    rel = seen_from(pool.heads[ia], pose_a, pool.heads[ib], pose_b)
    old = pair.head
    kept = -1
    for k in range(n):
        area_cap = np.inf
        if sa.mirror >= 0 or sb.mirror >= 0:
            on_line = np.inf
            if sa.mirror >= 0:
                on_line = min(on_line, length_on_first_edge(pool, ia, rel, A_EDGE, work, k))
            if sb.mirror >= 0:
                on_line = min(on_line, length_on_first_edge(pool, ib, rel, 1 - A_EDGE, work, k))
            if on_line == 0.0:
                continue  # reaches under the line without crossing it
            area_cap = 2.0 * on_line * on_line  # only the line's end pokes in
        patch = _patch(pool, work, law, k, ia, ib, pose_a)
        r = _match(regions, old, patch.x, patch.y, stamp)
        born = r < 0
        if born:
            r = counters[FREE_REGION]
            counters[FREE_REGION] = regions[r].next
            counters[FREE_REGIONS] -= 1
        else:  # unhook
            if old == r:
                old = regions[r].next
            else:
                q = old
                while regions[q].next != r:
                    q = regions[q].next
                regions[q].next = regions[r].next
        region = regions[r]
        region.next = kept
        kept = r
        region.pair = p
        region.stamp = stamp
        wx = patch.nx
        wy = patch.ny
        if patch.blind and born:
            nx, ny = push_out(pool, ia, ib, rel)
            wx = pose_a.c * nx - pose_a.s * ny
            wy = pose_a.s * nx + pose_a.c * ny
        past = 0
        if not born:
            # Past the middle of a body the chord shrinks to nothing and comes out the other way: a region then keeps
            # the way it came in, while it lives (design 2.1). A wide chord that turns by more than 90 degrees is not
            # that: the sliver of a corner has found another edge, and that is another contact.
            against = not patch.blind and wx * region.nx + wy * region.ny < 0.0
            if patch.blind or (against and (region.past or region.chord * region.chord < region.area)):
                wx = region.nx
                wy = region.ny
                past = 1
            elif against:
                born = True
        region.past = past
        x = patch.x
        y = patch.y
        middle = patch.middle
        straight = patch.straight
        if patch.blind or past:
            middle = 0.0
            straight = 0.0
        elif law.law == LAW_ENERGY:  # the gradient's line of action: through the chord's middle
            x -= wy * middle
            y += wx * middle
            middle = 0.0
        patch = Patch(
            min(patch.area, area_cap),
            x,
            y,
            wx,
            wy,
            patch.chord,
            middle,
            straight,
            0.0 if past else patch.curve_a,
            0.0 if past else patch.curve_b,
            patch.depth,
            patch.reach,
            patch.blind,
        )
        region.born = 1 if born else 0
        if born:
            region.placed = 0
        else:
            before = region.depth
            if region.placed == PLACED and patch.depth <= 10.0 * region.rest_depth:
                region.placed = 0
            carried = region.mode == REST and region.stiffness * patch.area <= 1.1 * region.force
            if region.placed == SPENT and carried:
                region.placed = 0
            if region.placed == 0 and patch.depth > 2.0 * before:
                region.depth = patch.depth
                if _jumped_in(law, region, before, a, b, h):
                    region.placed = PLACED
        if back > 0.0:
            ax, ay = _centre(a, pose_a)
            bx, by = _centre(b, pose_b)
            _fill(region, patch, ax, ay, bx, by)
        else:
            _fill(region, patch, a.x, a.y, b.x, b.y)
        if born:
            region.l1 = 0.0
            region.l2 = 0.0
            region.lt = 0.0
            region.step = h
            region.spring = 0.0
            region.tangent_stiffness = 0.0
            region.back = 0.0
        elif (region.mode != IMPACT and _hit(law, region, a, b, h)) or (
            region.mode == NEARING and _arrives(region, a, b, h)
        ):
            region.born = 1  # hit at a speed of which its present overlap says nothing
        elif region.mode >= STRUCK:
            if region.mode == STRUCK and region.first_speed > 0.0:  # a bounce says nothing of a load
                region.l1 = 0.0
                region.l2 = 0.0
                region.lt = 0.0
            region.mode = REST
    free_regions(regions, counters, old)
    pair.head = kept
    face = _face(pool, sa, sb, a, b)
    if pair.stiffness == 0.0 and kept >= 0:
        choose_stiffness(law, pair, face, a, b, h)
    r = kept
    while r >= 0:  # after the loops have been read: looking back takes the work
        region = regions[r]
        if region.born:
            _enter(pool, work, law, pair, region, face, ia, ib, a, b, back, h)
        region.stiffness = pair.stiffness
        r = region.next
    return DONE


@kernel
def meet_ahead(pool: Pool, tables: Tables, work: Work, law: Law, p: int, h: float, first: bool) -> int:
    """A region for a pair that does not overlap, but would after the next drift of h at its present velocities.

    Also for what of a pair that touches will overlap elsewhere, since it turns far in a step: at the list's head.
    DONE, or GROW_...; the pair then has a region that is NEARING, if there is to be one, or, if it is to bounce within
    this drift, STRUCK: that only at the first look, so that all bounces of a substep are those of the velocities at
    which bodies come (energy is kept by their being solved together). Others are found when they have happened.
    """
    pair = tables.pairs[p]
    regions = tables.regions
    counters = tables.counters
    sa = tables.shapes[pair.a]
    sb = tables.shapes[pair.b]
    a = tables.bodies[sa.body]
    b = tables.bodies[sb.body]
    ia = sa.outline
    ib = sb.outline
    if sa.mirror >= 0 or sb.mirror >= 0:
        ia, ib = shown_sides(pool, tables, pair, pose_of(a), pose_of(b))
    looks = jumped(tables, pair, a, b, h)
    old = pair.head
    deepest = 0.0
    if old >= 0:  # it touches: what else of it comes down, turning fast
        if looks == 1:
            return DONE
        deepest = HIT * min(_size(a), _size(b))
        r = old
        awaited = 0
        while r >= 0:
            if regions[r].mode == NEARING:
                awaited += 1
            else:
                deepest = max(deepest, 2.0 * regions[r].depth)
            if regions[r].mode == IMPACT or awaited == 2:
                return DONE
            r = regions[r].next
    n = 0
    ahead = h
    for i in range(looks):
        ahead = h * (i + 1) / looks
        pose_a = earlier(a, -ahead)
        pose_b = earlier(b, -ahead)
        n, rel = overlap_of_outlines(pool, ia, pose_a, ib, pose_b, work)
        if n < 0 or (n > 0 and (old < 0 or _reach(work, n) > deepest)):
            break
    if n == 0:
        return DONE
    if n == OVERFLOW:
        return GROW_WORK
    if n > counters[FREE_REGIONS]:
        return GROW_REGIONS
    kept = -1
    ax, ay = _centre(a, pose_a)
    bx, by = _centre(b, pose_b)
    for k in range(n):
        if sa.mirror >= 0 and length_on_first_edge(pool, ia, rel, A_EDGE, work, k) == 0.0:
            continue
        if sb.mirror >= 0 and length_on_first_edge(pool, ib, rel, 1 - A_EDGE, work, k) == 0.0:
            continue
        patch = _patch(pool, work, law, k, ia, ib, pose_a)
        if patch.blind or patch.reach <= deepest:
            continue
        r = counters[FREE_REGION]
        region = regions[r]
        _fill(region, patch, ax, ay, bx, by)
        if patch.reach > 3.0 * patch.depth:  # a plank on end, through and through: its width says nothing
            region.depth = patch.reach
        u = closing(region, a, b, 0.0)
        if u <= 0.0:
            continue
        counters[FREE_REGION] = region.next
        counters[FREE_REGIONS] -= 1
        region.next = kept
        kept = r
        region.pair = p
        region.stamp = counters[SUBSTEP]
        region.past = 0
        region.placed = 0
        region.born = 1
        region.opened = 0
        region.l1 = 0.0
        region.l2 = 0.0
        region.lt = 0.0
        region.step = h
        region.spring = 0.0
        region.tangent_stiffness = 0.0
    if kept < 0:
        return DONE
    face = _face(pool, sa, sb, a, b)
    if pair.stiffness == 0.0:
        choose_stiffness(law, pair, face, a, b, h)
    r = kept
    while r >= 0:  # after the loops have been read: looking for the touch takes the work
        region = regions[r]
        after = region.next
        if _await(pool, work, law, pair, region, face, ia, ib, a, b, ahead, h) and (
            region.mode == NEARING or (first and old < 0)
        ):
            region.next = pair.head
            pair.head = r
        else:
            region.next = -1
            free_regions(regions, counters, r)
        r = after
    return DONE
