"""From a pair of shapes to its contact regions: overlap, and which region of the substep before each one is.

A region is matched with the nearest of its pair's regions of the substep before; it keeps its impulses, its friction
spring and its direction while it lives. One that is new may be an impact: then its place is that of first touch,
found by going back along the bodies' motion (`touch`), so that neither the point nor the direction depends on how
deep a step has carried one body into the other, and nothing is jumped over.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..compile.jit import kernel
from ..geometry.arc import distance2
from ..geometry.overlap import A_EDGE, OVERFLOW, Work
from ..geometry.place import Pose, overlap_of_outlines, push_out, seen_from
from ..geometry.pool import Pool
from ..geometry.work import Relative
from .birth import arrives, bounces_again, crushed, end_comes_down, enter, expect, jumped_in, size_of
from .constants import HIT
from .exposed import exposed_patch
from .motion import (
    afford,
    centre_of,
    earlier,
    jumped,
    overlap_before,
    pose_of,
    time_of_impact,
    unseen_for,
)
from .neighbours import TwoShapes
from .patch import centred, faceless
from .region import closing, fill, steer, to_the_surfaces
from .sides import length_on_first_edge, shown_sides
from .stiffness import choose_stiffness, stiffness_of
from .tables import (
    FREE_REGION,
    FREE_REGIONS,
    IMPACT,
    LAW_ENERGY,
    MORE_REGIONS,
    MORE_WORK,
    NEARING,
    PLACED,
    REST,
    STRUCK,
    SUBSTEP,
    USED_REGIONS,
    Law,
    Tables,
    free_regions,
)

#: Places at which a pair is looked at for one more that is to come.
MOST_SEATS = 60


@kernel(forceinline=True)
def _match(regions: np.ndarray, head: int, x: float, y: float, stamp: int) -> int:
    """The region of the list nearest to (x, y) that is not yet taken in this substep; -1: none."""
    best = -1
    least = np.inf
    r = head
    while r >= 0:
        if regions[r].stamp != stamp:
            d = distance2(regions[r].x, regions[r].y, x, y)
            if d < least:
                least = d
                best = r
        r = regions[r].next
    return best


@kernel(forceinline=True)
def _unhook(regions: np.ndarray, head: int, r: int) -> int:
    """Take region r out of a list; its head then."""
    if head == r:
        return int(regions[r].next)
    q = head
    while regions[q].next != r:
        q = regions[q].next
    regions[q].next = regions[r].next
    return head


@kernel(forceinline=True)
def _take_region(regions: np.ndarray, counters: np.ndarray, p: int, kept: int, h: float) -> int:
    """A region of pair p from the free list, before region `kept`: nothing is remembered of it."""
    r = counters[FREE_REGION]
    region = regions[r]
    counters[FREE_REGION] = region.next
    counters[FREE_REGIONS] -= 1
    counters[USED_REGIONS] = max(counters[USED_REGIONS], r + 1)
    region.next = kept
    region.pair = p
    region.stamp = counters[SUBSTEP]
    region.past = 0
    region.placed = 0
    region.born = 1
    region.later = 0.0
    region.l1 = 0.0
    region.l2 = 0.0
    region.lt = 0.0
    region.step = h
    region.spring = 0.0
    region.tangent_stiffness = 0.0
    region.back = 0.0
    return int(r)


@kernel
def _go_on(law: Law, pair: Any, region: Any, a: Any, b: Any, h: float) -> None:
    """What a region is that was there a substep ago."""
    nearing = region.mode == NEARING
    region.later = 0.0
    if region.mode == STRUCK and region.first_speed > 0.0:  # a bounce says nothing of a load
        region.l1 = 0.0
        region.l2 = 0.0
        region.lt = 0.0
    if region.mode >= STRUCK:
        region.mode = REST
    if region.mode == REST and (
        bounces_again(law, pair, region, a, b, h) or end_comes_down(law, pair, region, a, b, h)
    ):
        region.mode = STRUCK
    elif nearing and arrives(region, a, b, h):
        region.born = 1  # hit at a speed of which its present overlap says nothing


@kernel
def _face(pool: Pool, sa: Any, sb: Any, a: Any, b: Any) -> float:
    """The chord on which one of the two would lie on the other (length)."""
    face = np.inf
    if a.mobile:
        face = min(face, pool.heads[sa.outline].face)
    if b.mobile:
        face = min(face, pool.heads[sb.outline].face)
    return face


@kernel(forceinline=True)
def _under_a_line(pool: Pool, work: Work, sa: Any, sb: Any, ia: int, ib: int, rel: Relative, k: int) -> bool:
    """Whether loop k of the work reaches under a segment's line without crossing it."""
    if sa.mirror >= 0 and length_on_first_edge(pool, ia, rel, A_EDGE, work, k) == 0.0:
        return True
    return bool(sb.mirror >= 0 and length_on_first_edge(pool, ib, rel, 1 - A_EDGE, work, k) == 0.0)


@kernel
def meet(pool: Pool, tables: Tables, work: Work, law: Law, p: int, h: float) -> bool:
    """Bring pair p's regions up to where its bodies are: their places, and which of them are new.

    False: there is no room for that (MORE_REGIONS, MORE_WORK), and nothing is changed.
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
    unseen = unseen_for(pair, h) if fresh else h
    looks = jumped(tables, pair, a, b, unseen) if fresh else 1
    if looks > 1:
        n, back = overlap_before(pool, work, ia, ib, a, b, unseen, afford(counters, looks))
        if back > 0.0:
            pose_a = earlier(a, back)
            pose_b = earlier(b, back)
    else:
        n, _ = overlap_of_outlines(pool, ia, pose_a, ib, pose_b, work)
    if n == OVERFLOW:
        counters[MORE_WORK] = 1
        return False
    if n == 0:
        if not fresh:
            free_regions(regions, counters, pair.head)
            pair.head = -1
        return True
    if n > counters[FREE_REGIONS]:
        counters[MORE_REGIONS] = n - counters[FREE_REGIONS]
        return False
    rel = seen_from(pool.heads[ia], pose_a, pool.heads[ib], pose_b)
    ax, ay = centre_of(a, pose_a)
    bx, by = centre_of(b, pose_b)
    two = TwoShapes(pool, tables, work, law, pair, ia, ib, a, b)
    old = pair.head
    kept = -1
    for k in range(n):
        if _under_a_line(pool, work, sa, sb, ia, ib, rel, k):
            continue
        patch = exposed_patch(two, k, pose_a, pose_b)
        if patch.area == 0.0:
            pair.covered = 1
            continue
        r = _match(regions, old, patch.x, patch.y, stamp)
        wx = patch.nx
        wy = patch.ny
        past = 0
        if r >= 0:
            # Past the middle of a body the chord shrinks to nothing and comes out the other way: a region then keeps
            # the way it came in, while it lives (theory 1). A wide chord that turns by more than 90 degrees is not
            # that: the sliver of a corner has found another edge, and that is another contact.
            region = regions[r]
            against = not patch.blind and wx * region.nx + wy * region.ny < 0.0
            if patch.blind or (against and (region.past or region.chord * region.chord < region.area)):
                wx = region.nx
                wy = region.ny
                past = 1
            elif against:
                r = -1
        born = r < 0
        if born:
            r = _take_region(regions, counters, p, kept, h)
            if patch.blind:
                nx, ny = push_out(pool, ia, ib, rel)
                wx = pose_a.c * nx - pose_a.s * ny
                wy = pose_a.s * nx + pose_a.c * ny
        else:
            old = _unhook(regions, old, r)
            regions[r].next = kept
            regions[r].stamp = stamp
            regions[r].born = 0
        kept = r
        region = regions[r]
        region.past = past
        if patch.blind or past:
            patch = faceless(patch, wx, wy, past == 1)
        elif law.law == LAW_ENERGY:  # the gradient's line of action: through the chord's middle
            patch = centred(patch)
        before = region.depth
        fill(region, patch, ax, ay, bx, by)
        if not born:
            if region.mode == REST and region.stiffness * region.area <= 1.1 * region.force:
                region.placed = 0  # it bears its load
            deeper = region.placed == 0 and region.depth > 2.0 * before
            if crushed(law, region, a, b) or (deeper and jumped_in(law, region, before, a, b, h)):
                region.placed = PLACED
            _go_on(law, pair, region, a, b, h)
    free_regions(regions, counters, old)
    pair.head = kept
    if pair.rate == 0.0 and kept >= 0:
        choose_stiffness(law, pair, _face(pool, sa, sb, a, b), a, b, h)
    r = kept
    while r >= 0:  # after the loops have been read: looking back takes the work
        region = regions[r]
        if region.born:
            enter(two, region, back, h)
        steer(pair, region, a, b)
        region.stiffness = stiffness_of(law, pair, region)
        r = region.next
    return True


@kernel(forceinline=True)
def has_seats(pool: Pool, tables: Tables, pair: Any) -> bool:
    """Whether the two may touch in several places without turning: one is not convex."""
    a = tables.shapes[pair.a].outline
    b = tables.shapes[pair.b].outline
    return not (pool.heads[a].convex and pool.heads[b].convex)


@kernel
def _there(pool: Pool, work: Work, regions: np.ndarray, head: int, n: int, ia: int, pose: Pose) -> int:
    """Which of the work's n loops are regions of the list: each one's nearest, as bits."""
    found = 0
    r = head
    while r >= 0:
        best = 0
        least = np.inf
        for k in range(n):
            lx = work.loops[k].x + pool.heads[ia].x
            ly = work.loops[k].y + pool.heads[ia].y
            x = pose.x + pose.c * lx - pose.s * ly - regions[r].x
            y = pose.y + pose.s * lx + pose.c * ly - regions[r].y
            if x * x + y * y < least:
                least = x * x + y * y
                best = k
        found |= 1 << best
        r = regions[r].next
    return found


@kernel
def meet_ahead(pool: Pool, tables: Tables, work: Work, law: Law, p: int, h: float, first: bool) -> bool:
    """A region for a pair that does not overlap, but would after the next drift of h at its present velocities.

    Also for what of a pair that touches will overlap elsewhere, since it turns far in a step, or since one of the two
    is not convex (a disc in a groove touches both its walls): at the list's head.
    False: there is no room for it. The pair then has a region that is NEARING, if there is to be one, or, if it is to
    bounce within this drift, STRUCK: that only at the first look, so that all bounces of a substep are those of the
    velocities at which bodies come (energy is kept by their being solved together). Others are found when they have
    happened.
    """
    pair = tables.pairs[p]
    regions = tables.regions
    counters = tables.counters
    sa = tables.shapes[pair.a]
    sb = tables.shapes[pair.b]
    a = tables.bodies[sa.body]
    b = tables.bodies[sb.body]
    looks = jumped(tables, pair, a, b, h)
    old = pair.head
    deepest = 0.0
    seat = old >= 0 and looks == 1
    if old >= 0 and not seat:  # it touches: what else of it comes down, turning fast
        deepest = HIT * min(size_of(a), size_of(b))
        r = old
        awaited = 0
        while r >= 0:
            if regions[r].mode == NEARING:
                awaited += 1
            else:
                deepest = max(deepest, 2.0 * regions[r].depth)
            if regions[r].mode == IMPACT or awaited == 2:
                return True
            r = regions[r].next
    ia, ib = shown_sides(pool, tables, pair, pose_of(a), pose_of(b))
    n, ahead = time_of_impact(pool, work, ia, ib, a, b, h, afford(counters, looks), deepest)
    if n == 0:
        return True
    if n == OVERFLOW:
        counters[MORE_WORK] = 1
        return False
    if seat and n > MOST_SEATS:
        return True
    if n > counters[FREE_REGIONS]:
        counters[MORE_REGIONS] = n - counters[FREE_REGIONS]
        return False
    pose_a = earlier(a, -ahead)
    pose_b = earlier(b, -ahead)
    rel = seen_from(pool.heads[ia], pose_a, pool.heads[ib], pose_b)
    two = TwoShapes(pool, tables, work, law, pair, ia, ib, a, b)
    kept = -1
    ax, ay = centre_of(a, pose_a)
    bx, by = centre_of(b, pose_b)
    there = _there(pool, work, regions, old, n, ia, pose_a) if seat else 0
    for k in range(n):
        if seat and there >> k & 1:
            continue
        if _under_a_line(pool, work, sa, sb, ia, ib, rel, k):
            continue
        patch = exposed_patch(two, k, pose_a, pose_b)
        if patch.blind or patch.reach <= deepest:
            continue
        region = regions[counters[FREE_REGION]]
        fill(region, patch, ax, ay, bx, by)
        to_the_surfaces(work, region, k, pose_a)
        if closing(region, a, b, 0.0) > 0.0:
            kept = _take_region(regions, counters, p, kept, h)
    if kept < 0:
        return True
    if pair.rate == 0.0:
        choose_stiffness(law, pair, _face(pool, sa, sb, a, b), a, b, h)
    r = kept
    while r >= 0:  # after the loops have been read: looking for the touch takes the work
        region = regions[r]
        after = region.next
        if expect(two, region, ahead, h, first and old < 0):
            steer(pair, region, a, b)
            region.next = pair.head
            pair.head = r
        else:
            region.next = -1
            free_regions(regions, counters, r)
        r = after
    return True
