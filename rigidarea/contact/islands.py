"""Which bodies go through a frame together, and in how many substeps.

An island is what may touch within the frame, or is jointed, directly or through others that move; what does not move
parts islands. Two islands share nothing within a frame, so that each may take substeps of its own number: what is fast
or delicate makes nobody else pay. Islands of one number go together, in one *turn*; the kernels see a turn's bodies
(`tables.live`) and pairs (from counters[FIRST] to counters[LAST] of `tables.near`) alone.

A blow within the frame may carry a body further than its own motion: where that could be into another turn, by all the
kinetic energy of its island, the two islands are one (`connect_in_reach`).
"""

from __future__ import annotations

import math
from typing import Any

from ..compile.jit import kernel
from ..geometry.clearance import clearance
from ..geometry.place import seen_from
from ..geometry.pool import Pool
from ..geometry.work import Work
from .at_rest import has_come_to_rest, keeps_its_place
from .broad import shapes_collide
from .constants import CALM, FEATURE, MOST_SUBSTEPS
from .motion import earlier, find_what_parts, gap_along_axis, kick_of, pose_of
from .order import arrange, bound, enlist, turn_of
from .sides import shown_sides
from .tables import (
    AWAKE,
    FIRST,
    FIXED,
    LAST,
    LIVE,
    MOVERS,
    NEAR,
    TOOTHED,
    TURN,
    TURNED,
    UNSORTED,
    Law,
    Tables,
)
from .tree import MOVING, next_met

#: More substeps than any turn has.
FINEST = 1 << 30


@kernel
def _past_teeth(pool: Pool, tables: Tables, work: Work, pair: Any, dt: float) -> int:
    """Substeps of a frame of dt in each of which two outlines pass each other by a FEATURE of a slot's width at most.

    1 where they come no nearer than that within the frame.
    """
    sa = tables.shapes[pair.a]
    sb = tables.shapes[pair.b]
    mouth = min(pool.heads[sa.outline].mouth, pool.heads[sb.outline].mouth)
    left = max(sa.left, sb.left)
    right = min(sa.right, sb.right)
    bottom = max(sa.bottom, sb.bottom)
    top = min(sa.top, sb.top)
    if mouth == math.inf or left > right or bottom > top:
        return 1
    a = tables.bodies[sa.body]
    b = tables.bodies[sb.body]
    # At (x, y) one goes past the other at (dx - w y, dy + w x): fastest at a corner of what the two boxes share.
    w = b.w - a.w
    dx = b.vx - a.vx + b.w * b.y - a.w * a.y
    dy = b.vy - a.vy - b.w * b.x + a.w * a.x
    way = dt * math.hypot(
        max(abs(dx - w * bottom), abs(dx - w * top)), max(abs(dy + w * left), abs(dy + w * right))
    )
    room = FEATURE * mouth
    n = int(min(way / room, float(MOST_SUBSTEPS - 1))) + 1
    if n == 1 or pair.head >= 0:
        return n
    ia, ib = shown_sides(pool, tables, pair, pose_of(a), pose_of(b))
    part_gone = 0.0
    for _ in range(n):  # conservative advancement (Mirtich 1996): on by what nothing can have covered
        rel = seen_from(
            pool.heads[ia], earlier(a, -part_gone * dt), pool.heads[ib], earlier(b, -part_gone * dt)
        )
        gap = clearance(pool, ia, pool, ib, rel, room + way, work)
        if gap <= room:
            return n
        part_gone += (gap - room) / way
        if part_gone >= 1.0:
            return 1
    return n


@kernel
def demand(
    pool: Pool, tables: Tables, work: Work, law: Law, dt: float, n: int, free: bool
) -> tuple[int, int]:
    """How many substeps each body wants in a frame of dt; the most and the least that any does.

    n, or what it has been asked for (`asked`). Where that is free also: one, if it hardly moves, now and a frame ago;
    none, if nothing changes; and as many as no outline needs to pass a tooth of a concave one unseen. Convex bodies are
    met wherever they come (`meet`); teeth, slots and hooks move under a contact that is there already.
    """
    most = 1 if free else n
    least = FINEST
    for k in range(tables.counters[AWAKE]):
        body = tables.bodies[tables.awake[k]]
        before = body.was_calm == 1
        body.rests = body.has_rested + dt if free and keeps_its_place(law, body, dt) else 0.0
        slow = CALM * kick_of(law, body.extent, dt)
        # what turns back moves no more than what lies, for a moment
        fast = max(body.gained, abs(body.vx) + abs(body.vy) + abs(body.w) * body.extent)
        body.calm = fast <= (3.0 * slow if before else slow) and body.disturbed != law.frame
        body.wants = max(1 if free and before and body.calm else n, body.asked)
        if has_come_to_rest(body, dt):
            body.wants = 0
        most = max(most, body.wants)
        least = min(least, body.wants)
    if not free or tables.counters[TOOTHED] == 0:
        return most, min(most, least)
    for i in range(tables.counters[NEAR]):
        pair = tables.pairs[tables.near[i].pair]
        wants = _past_teeth(pool, tables, work, pair, dt)
        if wants > 1:
            for one in (tables.near[i].a, tables.near[i].b):
                body = tables.bodies[one]
                body.wants = max(body.wants, wants)
            most = max(most, wants)
    return most, min(most, least)


@kernel
def all_in_one_group(tables: Tables) -> None:
    """All bodies and pairs in one turn."""
    counters = tables.counters
    counters[TURN] = 0
    if counters[TURNED]:
        counters[TURNED] = 0
        counters[UNSORTED] = 1
    counters[FIRST] = 0
    counters[LAST] = counters[NEAR]
    for k in range(counters[AWAKE]):
        body = tables.bodies[tables.awake[k]]
        body.steps = max(1, body.steps)
    enlist(tables)


@kernel
def mark_bodies_with_neighbours(tables: Tables) -> None:
    """Note in `steps` who is near somebody."""
    for k in range(tables.counters[AWAKE]):
        tables.bodies[tables.awake[k]].steps = 0
    for k in range(tables.counters[NEAR]):
        tables.bodies[tables.near[k].a].steps = 1
        tables.bodies[tables.near[k].b].steps = 1


@kernel
def spare(tables: Tables, i: int, n: int) -> None:
    """A jointed body (-1: none) that has no neighbours takes one substep, not n, unless it is asked for more.

    After `mark_bodies_with_neighbours`.
    """
    if i >= 0:
        body = tables.bodies[i]
        if body.kind != FIXED and body.steps == 0 and 0 < body.wants <= n:
            body.wants = max(1, body.asked)


@kernel
def root_of(tables: Tables, i: int) -> int:
    """The body that stands for the island of body i (union-find with halving: Tarjan & van Leeuwen 1984)."""
    bodies = tables.bodies
    while bodies[i].island != i:
        bodies[i].island = bodies[bodies[i].island].island
        i = bodies[i].island
    return i


@kernel
def unite(tables: Tables, i: int, j: int) -> None:
    """The islands of bodies i and j are one."""
    i = root_of(tables, i)
    j = root_of(tables, j)
    tables.bodies[max(i, j)].island = min(i, j)


@kernel
def connect(tables: Tables, i: int, j: int) -> None:
    """The islands of bodies i and j are one; nothing where one of the two does not move (or is none: -1)."""
    if i < 0 or j < 0 or tables.bodies[i].kind == FIXED or tables.bodies[j].kind == FIXED:
        return
    unite(tables, i, j)


@kernel
def _meet(pool: Pool, tables: Tables, near: Any, dt: float) -> bool:
    """Whether the two of a near pair, both of which move, touch, or might within their `way` in a frame of dt.

    By their boxes; of one that is at rest, by what parts them: it would else be solved with whatever rolls by.
    """
    a = tables.bodies[near.a]
    b = tables.bodies[near.b]
    if a.kind == FIXED or b.kind == FIXED:
        return False
    pair = tables.pairs[near.pair]
    if pair.head >= 0:
        return True
    one = tables.shapes[pair.a]
    other = tables.shapes[pair.b]
    apart_x = max(one.left - other.right, other.left - one.right)
    apart_y = max(one.bottom - other.top, other.bottom - one.top)
    way = a.way + b.way
    mover = b if a.wants == 0 else a
    if max(apart_x, apart_y) > way or (a.wants == 0) == (b.wants == 0) or not mover.mobile:
        return bool(max(apart_x, apart_y) <= way)
    find_what_parts(pool, tables, pair, a, b)
    if pair.gap > way:
        return False
    if pair.gap <= 0.0 or mover.calm <= 0 or mover.wants > 1:
        return True
    # something bears what is calm: it goes on as it does
    return gap_along_axis(pool, tables, pair, earlier(a, -2.0 * dt), earlier(b, -2.0 * dt)) <= 0.0


@kernel
def part(pool: Pool, tables: Tables, dt: float) -> None:
    """Every body for itself, then what touches, or comes to by its own motion within a frame of dt, is one."""
    for k in range(tables.counters[AWAKE]):
        body = tables.bodies[tables.awake[k]]
        body.island = tables.awake[k]
        body.steps = body.wants
        body.way = 0.0
        if body.wants == 0:  # what bears it keeps it
            continue
        arm = body.reach + abs(body.cog_x) + abs(body.cog_y)
        speed = abs(body.vx) + abs(body.vy) + abs(body.gain_x) + abs(body.gain_y)
        body.way = dt * (speed + (abs(body.w) + abs(body.gain_w)) * arm)
    for k in range(tables.counters[NEAR]):
        if _meet(pool, tables, tables.near[k], dt):
            connect(tables, tables.near[k].a, tables.near[k].b)


@kernel
def number(tables: Tables) -> bool:
    """Each island takes as many substeps as the body of it that wants most; whether two take different numbers.

    After `part` and `connect`.
    """
    counters = tables.counters
    bodies = tables.bodies
    awake = tables.awake
    for k in range(counters[AWAKE]):
        root = root_of(tables, awake[k])
        bodies[root].steps = max(bodies[root].steps, bodies[awake[k]].steps)
    differ = False
    for k in range(counters[AWAKE]):
        body = bodies[awake[k]]
        body.steps = bodies[root_of(tables, awake[k])].steps
        differ |= body.steps != bodies[awake[0]].steps
    return differ


@kernel(forceinline=True)
def _may_be_sent(a: Any, b: Any) -> bool:
    """Whether two bodies are of two turns, and a blow may send one of them to the other: not where all are calm."""
    return bool(a.steps != b.steps and max(a.steps, b.steps) > 1)


@kernel
def connect_in_reach(pool: Pool, tables: Tables, dt: float) -> bool:
    """Islands of which one may send a body as far as another of another number within a frame of dt are one; whether
    there were such.

    Contacts that do not bounce by more than they came with leave no body of an island more than its whole kinetic
    energy. Springs, motors and kinematic bodies may: who is met by those is met in the frame after, or by
    `recover_from_tunnelling`.
    """
    counters = tables.counters
    for k in range(counters[AWAKE]):
        tables.islands[tables.awake[k]].energy = 0.0
    for k in range(counters[AWAKE]):
        body = tables.bodies[tables.awake[k]]
        if body.steps == 0:
            continue
        energy = 0.0
        if body.inverse_mass > 0.0:
            speed = math.sqrt(body.vx * body.vx + body.vy * body.vy)
            speed += math.sqrt(body.gain_x * body.gain_x + body.gain_y * body.gain_y)
            energy += 0.5 * speed * speed / body.inverse_mass
        if body.inverse_moment > 0.0:
            spin = abs(body.w) + abs(body.gain_w)
            energy += 0.5 * spin * spin / body.inverse_moment
        tables.islands[root_of(tables, tables.awake[k])].energy += energy
    for k in range(counters[AWAKE]):  # as it is now, whichever islands come to be one
        body = tables.bodies[tables.awake[k]]
        if body.steps == 0:
            continue
        arm = body.reach + abs(body.cog_x) + abs(body.cog_y)
        energy = tables.islands[root_of(tables, tables.awake[k])].energy
        body.way = dt * math.sqrt(2.0 * energy * (body.inverse_mass + arm * arm * body.inverse_moment))
    found = False
    for k in range(counters[NEAR]):
        near = tables.near[k]
        if _may_be_sent(tables.bodies[near.a], tables.bodies[near.b]) and _meet(pool, tables, near, dt):
            connect(tables, near.a, near.b)
            found = True
    for k in range(counters[MOVERS]):
        shape = tables.shapes[tables.movers[k]]
        body = tables.bodies[shape.body]
        if body.steps == 0:
            continue
        low_x = shape.left - body.way
        low_y = shape.bottom - body.way
        high_x = shape.right + body.way
        high_y = shape.top + body.way
        if (
            body.kind == FIXED
            or shape.sensor
            or (
                low_x >= shape.low_x
                and low_y >= shape.low_y
                and high_x <= shape.high_x
                and high_y <= shape.high_y
            )
        ):
            continue
        at = -1
        while True:
            at = next_met(tables.nodes, tables.roots[MOVING], at, low_x, low_y, high_x, high_y)
            if at < 0:
                break
            other = tables.shapes[tables.nodes[at].owner]
            it = tables.bodies[other.body]
            if it.awake and _may_be_sent(body, it) and shapes_collide(tables, shape, other):
                connect(tables, shape.body, other.body)
                found = True
    return found


@kernel
def sort_by_turns(tables: Tables, gx: float, gy: float) -> None:
    """Leave the near pairs turn by turn (after `number`)."""
    counters = tables.counters
    moved = counters[TURNED] == 0 or counters[UNSORTED] == 1
    for k in range(counters[NEAR]):
        if moved:
            break
        near = tables.near[k]
        moved = near.turn != turn_of(tables.bodies[near.a], tables.bodies[near.b])
    counters[TURNED] = 1
    if moved:
        arrange(tables, gx, gy)


@kernel
def next_turn(tables: Tables, last: int) -> int:
    """The largest number of substeps below `last` that an island takes; 0: there is none.

    Its bodies and pairs are live then. What does not move belongs to every turn.
    """
    counters = tables.counters
    turn = 0
    for k in range(counters[AWAKE]):
        steps = tables.bodies[tables.awake[k]].steps
        if steps < last:
            turn = max(turn, steps)
    counters[TURN] = turn
    if turn > 0:
        bound(tables)
        enlist(tables)
    return turn


@kernel
def share_kicks(tables: Tables, n: int) -> None:
    """Of what a frame adds to the velocities of those that are live, a substep's share."""
    for k in range(tables.counters[LIVE]):
        body = tables.bodies[tables.live[k]]
        body.kick_x = body.gain_x / n
        body.kick_y = body.gain_y / n
        body.kick_w = body.gain_w / n
