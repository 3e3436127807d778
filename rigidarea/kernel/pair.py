"""Two shapes in one step: overlap, match its regions with those of the step before, force of each.

Pure numbers, called alike from the machine-code hook, from its Python twin and from compiled loops. What outlives a
step is in `Tables`: a record a shape, a pair, a region. A region is matched with the nearest of its pair's regions
of the step before; it keeps its friction spring, its restitution and its direction while it lives.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from .direction import chord_direction, nodal_direction
from .force import region_force
from .jit import kernel
from .overlap import A_EDGE, OVERFLOW, Work
from .place import Pose, overlap_of_outlines, push_out
from .pool import Pool
from .region import CHORD, LAW_ENERGY, Law, Motion, Pull
from .sides import length_on_first_edge, shown_sides
from .tables import FREE_REGION, FREE_REGIONS, Tables, free_regions

#: A body is in a crowd for so many steps after a movable one has touched it: contacts of a pile come and go.
CROWDED_STEPS = 16

DONE, GROW_WORK, GROW_REGIONS, NOT_FINITE = 0, 1, 2, 3


class Surface(NamedTuple):
    """The pair's product of friction, of elasticity, and its surface velocity (B's minus A's)."""

    friction: float
    elasticity: float
    vx: float
    vy: float


NO_PULL = Pull(0.0, 0.0, 0.0, 0.0)


@kernel
def _match(regions: np.ndarray, head: int, x: float, y: float, stamp: int) -> int:
    """The region of the list nearest to (x, y) that is not yet taken in this step; -1: none."""
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
def _extent(
    work: Work, start: int, stop: int, x: float, y: float, pose: Pose, wx: float, wy: float
) -> tuple[float, float]:
    """(extent of a loop along the world direction (wx, wy), how much of it beyond the loop's point (x, y))."""
    nx = pose.c * wx + pose.s * wy
    ny = pose.c * wy - pose.s * wx
    low = np.inf
    high = -np.inf
    for i in range(start, stop):
        h = nx * work.polygon[i, 0] + ny * work.polygon[i, 1]
        low = min(low, h)
        high = max(high, h)
    return high - low, high - (nx * x + ny * y)


@kernel
def overlap_of_pair(
    pool: Pool, tables: Tables, work: Work, pair: Any, sa: int, sb: int, a: Pose, b: Pose
) -> tuple[int, int]:
    """(number of regions, outline of A) of a pair as its contact sees it; the regions are in `work`."""
    ia = tables.shapes[sa].outline if pair.side_a >= 0 else tables.shapes[sa].mirror
    ib = tables.shapes[sb].outline if pair.side_b >= 0 else tables.shapes[sb].mirror
    return overlap_of_outlines(pool, ia, a, ib, b, work)[0], ia


@kernel(inline="always")
def pair_pull(
    pool: Pool, tables: Tables, work: Work, law: Law, p: int, sa: int, sb: int, pose_a: Pose, pose_b: Pose,
    a: Motion, b: Motion, surface: Surface, dt: float, stamp: int,
) -> tuple[int, Pull]:  # fmt: skip
    """All regions of pair p in this step: (status, force and moments). Nothing is changed unless the status is DONE."""
    pair = tables.pairs[p]
    regions = tables.regions
    counters = tables.counters
    ia = tables.shapes[sa].outline
    ib = tables.shapes[sb].outline
    mirror_a = tables.shapes[sa].mirror
    mirror_b = tables.shapes[sb].mirror
    if mirror_a >= 0 or mirror_b >= 0:
        ia, ib = shown_sides(pool, tables, work, pair, sa, sb, pose_a, pose_b, a, b, dt)
    n, rel = overlap_of_outlines(pool, ia, pose_a, ib, pose_b, work)
    if n == OVERFLOW:
        return GROW_WORK, NO_PULL
    if n > counters[FREE_REGIONS]:
        return GROW_REGIONS, NO_PULL

    loops = work.loops
    head_a = pool.heads[ia]
    curved = head_a.round or pool.heads[ib].round
    body_a = tables.bodies[tables.shapes[sa].body]
    body_b = tables.bodies[tables.shapes[sb].body]
    pair_moves = a.inverse_mass > 0.0 and b.inverse_mass > 0.0
    alone = not pair_moves and (body_a if a.inverse_mass > 0.0 else body_b).crowded == 0
    crowd = max(
        body_a.old_rate if a.inverse_mass > 0.0 else 0.0,
        body_b.old_rate if b.inverse_mass > 0.0 else 0.0,
    )
    old = pair.head
    fresh = old < 0
    kept = -1
    fx = 0.0
    fy = 0.0
    moment_a = 0.0
    moment_b = 0.0
    finite = True
    for k in range(n):
        loop = loops[k]
        area = loop.area
        if mirror_a >= 0 or mirror_b >= 0:
            on_line = np.inf
            if mirror_a >= 0:
                on_line = min(on_line, length_on_first_edge(pool, ia, rel, A_EDGE, work, k))
            if mirror_b >= 0:
                on_line = min(on_line, length_on_first_edge(pool, ib, rel, 1 - A_EDGE, work, k))
            if on_line == 0.0:
                continue  # reaches under the line without crossing it
            area = min(area, 2.0 * on_line * on_line)  # only the line's end pokes in
        lx = loop.x + head_a.x
        ly = loop.y + head_a.y
        x = pose_a.x + pose_a.c * lx - pose_a.s * ly
        y = pose_a.y + pose_a.s * lx + pose_a.c * ly
        r = _match(regions, old, x, y, stamp)
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

        if law.direction == CHORD:
            nx, ny = chord_direction(loop.chord_x, loop.chord_y, loop.area)
        else:
            nx, ny = nodal_direction(work.polygon, work.label, loop.start, loop.stop, law.exponent)
            if nx == 0.0 and ny == 0.0:
                nx, ny = chord_direction(loop.chord_x, loop.chord_y, loop.area)
        chord = math.sqrt(loop.chord_x * loop.chord_x + loop.chord_y * loop.chord_y)
        blind = nx == 0.0 and ny == 0.0
        if blind:
            chord = math.sqrt(area)
            if born:
                nx, ny = push_out(pool, ia, ib, rel)
        wx = pose_a.c * nx - pose_a.s * ny
        wy = pose_a.s * nx + pose_a.c * ny
        past = 0
        if not born:
            # Past the middle of a body the chord shrinks to nothing and comes out the other way: a region then keeps
            # the way it came in, while it lives (design 2.1). A wide chord that turns by more than 90 degrees is not
            # that: the sliver of a corner has found another edge, and that is another contact.
            back = not blind and wx * region.nx + wy * region.ny < 0.0
            if blind or (back and (region.past or region.chord * region.chord < region.area)):
                wx = region.nx
                wy = region.ny
                past = 1
            elif back:
                born = True
        region.past = past
        if law.law == LAW_ENERGY and not (blind or past):
            # the gradient's line of action: its moment about the centroid is -lever
            x -= wy * loop.lever / chord
            y += wx * loop.lever / chord
        region.crowd = crowd
        region.curved = 1 if curved else 0
        region.alone = 1 if alone else 0
        region.straight = 0.0 if curved else min(loop.straight, chord)
        if born:
            region.inside = fresh and law.followed < np.inf
            region.depth, region.beyond = _extent(work, loop.start, loop.stop, loop.x, loop.y, pose_a, wx, wy)
        region.area = area
        region.x = x
        region.y = y
        region.nx = wx
        region.ny = wy
        region.chord = chord
        pull = region_force(
            region, law, a, b, surface.friction, surface.elasticity, surface.vx, surface.vy, dt, born
        )
        finite = finite and math.isfinite(region.speed + region.slip)
        a = Motion(
            a.x, a.y, a.vx, a.vy, a.w, a.inverse_mass, a.inverse_moment,
            a.ax - pull.fx * a.inverse_mass, a.ay - pull.fy * a.inverse_mass, a.aw + pull.moment_a * a.inverse_moment,
        )  # fmt: skip
        b = Motion(
            b.x, b.y, b.vx, b.vy, b.w, b.inverse_mass, b.inverse_moment,
            b.ax + pull.fx * b.inverse_mass, b.ay + pull.fy * b.inverse_mass, b.aw + pull.moment_b * b.inverse_moment,
        )  # fmt: skip
        body_a.met_rate += region.rate2
        body_b.met_rate += region.rate2
        if pair_moves:
            body_a.crowded = CROWDED_STEPS
            body_b.crowded = CROWDED_STEPS
        fx += pull.fx
        fy += pull.fy
        moment_a += pull.moment_a
        moment_b += pull.moment_b
    free_regions(regions, counters, old)
    pair.head = kept
    if not (finite and math.isfinite(fx + fy + moment_a + moment_b)):
        return NOT_FINITE, NO_PULL
    return DONE, Pull(fx, fy, moment_a, moment_b)
