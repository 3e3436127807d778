"""Two shapes in one step: overlap, match its regions with those of the step before, force of each.

Pure numbers, called alike from the machine-code hook, from its Python twin and from compiled loops. What outlives a
step is in `Tables`: a record a shape, a pair, a region. A region is matched with the nearest of its pair's regions
of the step before; it keeps its friction spring, its restitution and its direction while it lives.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from .force import (
    CHORD,
    LAW_ENERGY,
    Law,
    Motion,
    Pull,
    chord_direction,
    nodal_direction,
    region_force,
)
from .jit import kernel
from .memory import record
from .overlap import A_EDGE, OVERFLOW, TANGLED, Relative, Work, overlap_kernel, relative
from .pool import Pool

SHAPE = record(
    [
        ("address", "u8"),  # of the shape; 0: none
        ("outline", "i4"),  # number in the pool
        ("mirror", "i4"),  # the outline's other side, for a segment without thickness; -1: none
        ("inverse_mass", "f8"),  # of its body, as last seen; 0 for a sensor
        ("inverse_moment", "f8"),
        ("body", "i4"),  # row of its body
    ],
)

BODY = record(
    [
        ("stamp", "i8"),  # space step in which a contact last met it
        ("force_x", "f8"),  # what was in its accumulators after that
        ("force_y", "f8"),
        ("torque", "f8"),
        ("met_x", "f8"),  # force of all its contacts met in that step
        ("met_y", "f8"),
        ("met_turn", "f8"),
        ("old_x", "f8"),  # force, in the step before, of those not met yet
        ("old_y", "f8"),
        ("old_turn", "f8"),
        ("met_rate", "f8"),  # sum of rate2 of all its regions in that step
        ("old_rate", "f8"),  # in the step before
        ("crowded", "i4"),  # steps for which it still counts as touched by a body that can move
    ]
)

PAIR = record(
    [
        ("shape_a", "i8"),  # Chipmunk's shape ids, for finding the Python objects again
        ("shape_b", "i8"),
        ("head", "i4"),  # first region; -1: none
        ("side_a", "i4"),  # of a two-sided outline: 0 undecided, 1 itself, -1 its mirror
        ("side_b", "i4"),
        ("next", "i4"),  # in the free list
        ("stamp", "i8"),  # space step of the pull
        ("fx", "f8"),  # force on B (force)
        ("fy", "f8"),
        ("moment_a", "f8"),  # on each about its centre (force length)
        ("moment_b", "f8"),
    ],
)

#: Counters: free regions' list head, how many are free, free pairs' list head, how many; queries, tangled queries.
FREE_REGION, FREE_REGIONS, FREE_PAIR, FREE_PAIRS, QUERIES, TANGLES = range(6)
COUNTERS = 6

#: A body is in a crowd for so many steps after a movable one has touched it: contacts of a pile come and go.
CROWDED_STEPS = 16

DONE, GROW_WORK, GROW_REGIONS, NOT_FINITE = 0, 1, 2, 3


class Tables(NamedTuple):
    """What outlives a step."""

    shapes: np.ndarray  # (n,) SHAPE
    bodies: np.ndarray  # (n,) BODY
    pairs: np.ndarray  # (n,) PAIR
    regions: np.ndarray  # (n,) REGION
    counters: np.ndarray  # (COUNTERS,) int64


class Pose(NamedTuple):
    """Where a body's origin is, and cosine and sine of its angle."""

    x: float
    y: float
    c: float
    s: float


class Surface(NamedTuple):
    """The pair's product of friction, of elasticity, and its surface velocity (B's minus A's)."""

    friction: float
    elasticity: float
    vx: float
    vy: float


NO_PULL = Pull(0.0, 0.0, 0.0, 0.0)


@kernel
def new_pair(tables: Tables, shape_a: int, shape_b: int) -> int:
    """Take a pair from the free list; -1: there is none."""
    counters = tables.counters
    p = counters[FREE_PAIR]
    if p >= 0:
        pair = tables.pairs[p]
        counters[FREE_PAIR] = pair.next
        counters[FREE_PAIRS] -= 1
        pair.shape_a = shape_a
        pair.shape_b = shape_b
        pair.head = -1
        pair.side_a = 0
        pair.side_b = 0
        pair.next = -1
        pair.stamp = -1
    return p


@kernel
def meet_body(body: Any, stamp: int) -> None:
    """A step's first look at a body: what its contacts did is now what they did in the step before."""
    last = body.stamp == stamp - 1
    body.old_x = body.met_x if last else 0.0
    body.old_y = body.met_y if last else 0.0
    body.old_turn = body.met_turn if last else 0.0
    body.met_x = 0.0
    body.met_y = 0.0
    body.met_turn = 0.0
    body.old_rate = body.met_rate if last else 0.0
    body.met_rate = 0.0
    body.crowded = max(0, body.crowded - 1) if last else 0
    body.stamp = stamp


@kernel(inline="always")
def expected(
    m: Motion, body: Any, gx: float, gy: float, fx: float, fy: float, turn: float
) -> Motion:  # fmt: skip
    """The body's motion with what everything but one pair will do to it in this step.

    From gravity, the force (fx, fy, turn) that the step's earlier contacts and the user have put on it, and what the
    contacts not met yet did in the step before.
    """
    return Motion(
        m.x, m.y, m.vx, m.vy, m.w, m.inverse_mass, m.inverse_moment,
        gx + (fx + body.old_x) * m.inverse_mass,
        gy + (fy + body.old_y) * m.inverse_mass,
        (turn + body.old_turn) * m.inverse_moment,
    )  # fmt: skip


@kernel
def take_out(body: Any, fx: float, fy: float, turn: float) -> None:
    """A pair that pushed the body in the step before is met: it has a new force now."""
    body.old_x -= fx
    body.old_y -= fy
    body.old_turn -= turn


@kernel
def remember_pull(pair: Any, pull: Pull, stamp: int) -> None:
    """For the next step's `take_out`."""
    pair.stamp = stamp
    pair.fx = pull.fx
    pair.fy = pull.fy
    pair.moment_a = pull.moment_a
    pair.moment_b = pull.moment_b


@kernel
def put_in(body: Any, fx: float, fy: float, turn: float) -> None:
    """What a pair that was met pushes the body with."""
    body.met_x += fx
    body.met_y += fy
    body.met_turn += turn


@kernel
def _free_regions(regions: np.ndarray, counters: np.ndarray, r: int) -> None:
    """Put the list that starts at region r onto the free list."""
    while r >= 0:
        after = regions[r].next
        regions[r].stamp = -1
        regions[r].next = counters[FREE_REGION]
        counters[FREE_REGION] = r
        counters[FREE_REGIONS] += 1
        r = after


@kernel
def end_pair(tables: Tables, p: int) -> None:
    """The two shapes have separated: forget the pair and its regions."""
    pair = tables.pairs[p]
    _free_regions(tables.regions, tables.counters, pair.head)
    pair.head = -1
    pair.shape_a = -1
    pair.shape_b = -1
    pair.next = tables.counters[FREE_PAIR]
    tables.counters[FREE_PAIR] = p
    tables.counters[FREE_PAIRS] += 1


@kernel
def seen_from(head: Any, pose: Pose, other: Any, other_pose: Pose) -> Relative:
    """An outline (its head, its body's pose) as the first one sees it."""
    return relative(
        pose.x, pose.y, pose.c, pose.s, other_pose.x, other_pose.y, other_pose.c, other_pose.s,
        head.x, head.y, other.x, other.y,
    )  # fmt: skip


@kernel(inline="always")
def overlap_of_outlines(pool: Pool, ia: int, a: Pose, ib: int, b: Pose, work: Work) -> tuple[int, Relative]:
    """(number of regions, in `work`; B relative to A) of two placed outlines.

    A tangle is undone by shifts of 1e-13 of the size: a tangle is rounding.
    """
    rel = seen_from(pool.heads[ia], a, pool.heads[ib], b)
    n = overlap_kernel(pool, ia, pool, ib, rel, work)
    if n == TANGLED:
        size = 1e-13 * (pool.heads[ia].radius + pool.heads[ib].radius)
        for i in range(1, 9):
            shifted = Relative(rel.c, rel.s, rel.tx + i * size, rel.ty + i * i * size)
            n = overlap_kernel(pool, ia, pool, ib, shifted, work)
            if n != TANGLED:
                break
        n = max(n, OVERFLOW)
    return n, rel


@kernel
def push_out(pool: Pool, ia: int, ib: int, rel: Relative) -> tuple[float, float]:
    """Direction A to B of the shortest way apart over the edge normals of both outer rings, in A's frame.

    Exact for convex outlines (separating axes); for concave ones a sensible guess. Only for regions that are born
    without a direction: one outline inside the other, or two bars crossed.
    """
    best = np.inf
    best_x = 0.0
    best_y = 1.0
    ha = pool.heads[ia]
    hb = pool.heads[ib]
    a0, a1 = pool.rings[ha.ring, 0], pool.rings[ha.ring, 1]
    b0, b1 = pool.rings[hb.ring, 0], pool.rings[hb.ring, 1]
    for of_a in (True, False):
        e0, e1, v0, v1 = (a0, a1, b0, b1) if of_a else (b0, b1, a0, a1)
        # both in the frame of the edges' outline
        c, s = (rel.c, rel.s) if of_a else (rel.c, -rel.s)
        tx = rel.tx if of_a else -(rel.c * rel.tx + rel.s * rel.ty)
        ty = rel.ty if of_a else -(rel.c * rel.ty - rel.s * rel.tx)
        for e in range(e0, e1):
            k = pool.following[e]
            dx = pool.points[k, 0] - pool.points[e, 0]
            dy = pool.points[k, 1] - pool.points[e, 1]
            length = math.sqrt(dx * dx + dy * dy)
            mx = dy / length
            my = -dx / length
            mx_v = c * mx + s * my  # the normal in the vertices' frame
            my_v = -s * mx + c * my
            deepest = -np.inf
            edge = mx * (pool.points[e, 0] - tx) + my * (pool.points[e, 1] - ty)
            for v in range(v0, v1):
                deepest = max(deepest, edge - (mx_v * pool.points[v, 0] + my_v * pool.points[v, 1]))
            if 0.0 < deepest < best:
                best = deepest
                if of_a:
                    best_x, best_y = mx, my
                else:  # B's outward normal points from B to A
                    best_x, best_y = -(rel.c * mx - rel.s * my), -(rel.s * mx + rel.c * my)
    return best_x, best_y


@kernel
def _length_on_first_edge(pool: Pool, i: int, rel: Relative, mine: int, work: Work, n: int) -> float:
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
def _came_from(
    pool: Pool, i: int, mirror: int, pose: Pose, me: Motion, other: int, other_pose: Pose, it: Motion, dt: float,
    work: Work,
) -> int:  # fmt: skip
    """Which solid side a two-sided segment shows to a body that it now touches first: 1 itself, -1 its mirror.

    Outline i lies to the right of the segment, its mirror to the left. Twice the body's mean height over the line,
    positive to the left, is h = (area in the mirror - area in i) / length; a step earlier it was
    2 dt (its speed to the left) less. Where it was then is where it came from: the solid is on the far side.
    """
    n, rel = overlap_of_outlines(pool, i, pose, other, other_pose, work)
    right = 0.0
    length = 0.0
    x = 0.0
    y = 0.0
    for k in range(n):
        right += work.loops[k].area
        length += _length_on_first_edge(pool, i, rel, A_EDGE, work, k)
    n, _ = overlap_of_outlines(pool, mirror, pose, other, other_pose, work)
    left = 0.0
    for k in range(n):
        left += work.loops[k].area
    if length == 0.0:
        return 1 if left >= right else -1
    p = pool.heads[i].point
    ax, ay = pool.points[p, 0], pool.points[p, 1]
    dx = pool.points[p + 1, 0] - ax
    dy = pool.points[p + 1, 1] - ay
    full = math.hypot(dx, dy)
    lx = (pose.c * -dy - pose.s * dx) / full  # left of the segment, world
    ly = (pose.s * -dy + pose.c * dx) / full
    mx = pool.heads[i].x + ax + 0.5 * dx
    my = pool.heads[i].y + ay + 0.5 * dy
    x = pose.x + pose.c * mx - pose.s * my
    y = pose.y + pose.s * mx + pose.c * my
    vx = (it.vx - it.w * (y - it.y)) - (me.vx - me.w * (y - me.y))
    vy = (it.vy + it.w * (x - it.x)) - (me.vy + me.w * (x - me.x))
    height = (left - right) / length - 2.0 * dt * (vx * lx + vy * ly)
    return 1 if height >= 0.0 else -1


@kernel
def _sides(
    pool: Pool, tables: Tables, work: Work, pair: Any, sa: int, sb: int, pose_a: Pose, pose_b: Pose,
    a: Motion, b: Motion, dt: float,
) -> tuple[int, int]:  # fmt: skip
    """The outlines that shape sa and shape sb show each other in this contact."""
    ia = tables.shapes[sa].outline
    ib = tables.shapes[sb].outline
    mirror_a = tables.shapes[sa].mirror
    mirror_b = tables.shapes[sb].mirror
    if mirror_a >= 0:
        if pair.side_a == 0:
            pair.side_a = _came_from(pool, ia, mirror_a, pose_a, a, ib, pose_b, b, dt, work)
        if pair.side_a < 0:
            ia = mirror_a
    if mirror_b >= 0:
        if pair.side_b == 0:
            pair.side_b = _came_from(pool, ib, mirror_b, pose_b, b, ia, pose_a, a, dt, work)
        if pair.side_b < 0:
            ib = mirror_b
    return ia, ib


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
        ia, ib = _sides(pool, tables, work, pair, sa, sb, pose_a, pose_b, a, b, dt)
    n, rel = overlap_of_outlines(pool, ia, pose_a, ib, pose_b, work)
    if n == OVERFLOW:
        return GROW_WORK, NO_PULL
    if n > counters[FREE_REGIONS]:
        return GROW_REGIONS, NO_PULL
    counters[QUERIES] += 1

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
                on_line = min(on_line, _length_on_first_edge(pool, ia, rel, A_EDGE, work, k))
            if mirror_b >= 0:
                on_line = min(on_line, _length_on_first_edge(pool, ib, rel, 1 - A_EDGE, work, k))
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
    _free_regions(regions, counters, old)
    pair.head = kept
    if not (finite and math.isfinite(fx + fy + moment_a + moment_b)):
        return NOT_FINITE, NO_PULL
    return DONE, Pull(fx, fy, moment_a, moment_b)
