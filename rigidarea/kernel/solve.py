"""A substep of all bodies and contacts: drift, kick, overlap, rows, sweeps, settle.

Positions and velocities leapfrog: contacts are met where the bodies are in the middle of the substep, which is where
the first half of the substep's drift has taken them; second order in time (Hairer, Lubich, Wanner, Acta Numerica 12
(2003), doi:10.1017/S0962492902000144). Two half drifts between two substeps are one whole drift.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .apart import find_axis, gap_along
from .broad import search, somebody_left
from .constants import HIT, LEFT, LOOK, MOVED, STRAIGHT_WAY
from .jit import kernel
from .meet import DONE, GROW_REGIONS, earlier, has_seats, jumped, little, meet, meet_ahead, pose_of
from .place import place, seen_from, shift
from .pool import Pool
from .row import make_row, push, settle, visit
from .tables import (
    ANEW,
    BODIES,
    BOUNCES,
    DRIFTS,
    FIRST,
    FIXED,
    LAST,
    LIVE,
    MET,
    NEAR,
    ROWS,
    STRUCK,
    SUBSTEP,
    TURN,
    TURNED,
    Law,
    Tables,
)
from .verdict import allowed
from .work import Work

#: What a kernel may ask for before it can go on.
GROW_PAIRS = 3


@kernel
def drift(tables: Tables, frame: int, time: float) -> None:
    """Move every body that we move, at its present velocity."""
    for k in range(tables.counters[LIVE]):
        body = tables.bodies[tables.live[k]]
        if body.stamp == frame and body.kind == DRIFTS:
            body.x += time * body.vx
            body.y += time * body.vy
            body.since += time
            if body.w == 0.0:
                shift(body)
            else:
                body.angle += time * body.w
                place(body)


@kernel
def kick(tables: Tables, frame: int) -> None:
    """What everything but contacts and joints adds in a substep."""
    for k in range(tables.counters[LIVE]):
        body = tables.bodies[tables.live[k]]
        if body.stamp == frame:
            body.vx += body.kick_x
            body.vy += body.kick_y
            body.w += body.kick_w
            body.came_vx = body.vx
            body.came_vy = body.vy
            body.came_w = body.w


@kernel
def find_near(pool: Pool, tables: Tables, frame: int, h: float, time: float, gx: float, gy: float) -> int:
    """Search pairs again if somebody has left the boxes of the last search. DONE or GROW_PAIRS."""
    left = somebody_left(pool, tables, frame, h)
    if not (left or tables.counters[ANEW]):
        return DONE
    if search(pool, tables, max(time, 2.0 * h), frame) < 0:
        return GROW_PAIRS
    tables.counters[ANEW] = 0
    arrange(tables, gx, gy)
    return DONE


@kernel(forceinline=True)
def up(gx: float, gy: float) -> tuple[float, float]:
    """The unit vector against gravity."""
    size = math.hypot(gx, gy)
    return (-gx / size, -gy / size) if size > 0.0 else (0.0, 1.0)


@kernel
def arrange(tables: Tables, gx: float, gy: float) -> None:
    """Sort the near pairs from the bottom to the top: by places alone, so that nothing depends on who came first.

    Where a frame is made of turns (`islands`), turn by turn.
    """
    ux, uy = up(gx, gy)
    near = tables.near
    n = tables.counters[NEAR]
    for i in range(n):
        one = near[i]
        pair = tables.pairs[one.pair]
        a = tables.bodies[tables.shapes[pair.a].body]
        b = tables.bodies[tables.shapes[pair.b].body]
        x = 0.0
        y = 0.0
        if a.mobile:
            x += a.x
            y += a.y
        if b.mobile:
            x += b.x
            y += b.y
        share = 0.5 if a.mobile and b.mobile else 1.0
        one.order = share * (ux * x + uy * y)
        one.beside = share * abs(ux * y - uy * x)
        one.turn = turn_of(a, b) if tables.counters[TURNED] else 0
        if one.turn < 0:
            tables.counters[MET] = 1
    gap = 1
    while gap < n:
        gap = 3 * gap + 1
    while gap > 0:  # Shell's sort, in place
        for i in range(gap, n):
            _set(near[n], near[i])
            j = i
            while j >= gap and _after(near[j - gap], near[n]):
                _set(near[j], near[j - gap])
                j -= gap
            _set(near[j], near[n])
        gap //= 3
    line_up(tables, gx, gy)
    bound(tables)


@kernel
def line_up(tables: Tables, gx: float, gy: float) -> None:
    """Sort the live bodies in the same way: sums over them then do not depend on who came first either."""
    ux, uy = up(gx, gy)
    live = tables.live
    n = tables.counters[LIVE]
    gap = 1
    while gap < n:
        gap = 3 * gap + 1
    while gap > 0:
        for i in range(gap, n):
            k = live[i]
            j = i
            while j >= gap and _above(tables.bodies[live[j - gap]], tables.bodies[k], ux, uy):
                live[j] = live[j - gap]
                j -= gap
            live[j] = k
        gap //= 3


@kernel(forceinline=True)
def _above(one: Any, other: Any, ux: float, uy: float) -> bool:
    here = ux * one.x + uy * one.y
    there = ux * other.x + uy * other.y
    if here != there:
        return bool(here > there)
    return bool(abs(ux * one.y - uy * one.x) > abs(ux * other.y - uy * other.x))


@kernel
def turn_of(a: Any, b: Any) -> int:
    """The turn to which a pair of bodies belongs; -1: to two."""
    if a.kind == FIXED or b.kind == FIXED or a.steps == b.steps:
        return int(max(a.steps, b.steps))
    return -1


@kernel
def bound(tables: Tables) -> None:
    """Where in `near` the pairs of the present turn are."""
    counters = tables.counters
    turn = counters[TURN]
    first = 0
    while first < counters[NEAR] and tables.near[first].turn < turn:
        first += 1
    last = first
    while last < counters[NEAR] and tables.near[last].turn == turn:
        last += 1
    counters[FIRST] = first
    counters[LAST] = last


@kernel(forceinline=True)
def _set(one: Any, other: Any) -> None:
    one.pair = other.pair
    one.turn = other.turn
    one.order = other.order
    one.beside = other.beside


@kernel(forceinline=True)
def _after(one: Any, other: Any) -> bool:
    if one.turn != other.turn:
        return bool(one.turn > other.turn)
    if one.order != other.order:
        return bool(one.order > other.order)
    return bool(one.beside > other.beside)


@kernel(forceinline=True)
def _boxes_apart(tables: Tables, pair: Any, h: float) -> float:
    """How far the boxes of two shapes stay apart on the way that they have come in the last h (negative: that they go).

    Nothing, or less, where they meet (length).
    """
    sa = tables.shapes[pair.a]
    sb = tables.shapes[pair.b]
    a = tables.bodies[sa.body]
    b = tables.bodies[sb.body]
    dx = h * (a.vx - b.vx)
    dy = h * (a.vy - b.vy)
    turn = abs(h) * (abs(a.w) * (sa.half_x + sa.half_y) + abs(b.w) * (sb.half_x + sb.half_y))
    return max(
        (sa.left - max(0.0, dx)) - (sb.right + turn),
        (sb.left - turn) - (sa.right - min(0.0, dx)),
        (sa.bottom - max(0.0, dy)) - (sb.top + turn),
        (sb.bottom - turn) - (sa.top - min(0.0, dy)),
    )


@kernel
def may_touch(tables: Tables, pair: Any, h: float) -> bool:
    """Whether the boxes of two shapes meet, on the way that they have come in the last h (negative: that they go)."""
    return _boxes_apart(tables, pair, h) <= 0.0


@kernel
def _stay_apart(pool: Pool, tables: Tables, pair: Any, a: Any, b: Any, h: float) -> bool:
    """Whether what parted a pair in the substep before parts it now, and did on the way."""
    if pair.axis_x == 0.0 and pair.axis_y == 0.0:
        return False
    stamp = tables.counters[SUBSTEP]
    if jumped(tables, pair, a, b, h) > 1 and (
        pair.parted != stamp - 1 or h * max(abs(a.w), abs(b.w)) > STRAIGHT_WAY
    ):
        return False
    ia = tables.shapes[pair.a].outline
    ib = tables.shapes[pair.b].outline
    rel = seen_from(pool.heads[ia], pose_of(a), pool.heads[ib], pose_of(b))
    pair.gap = gap_along(pool, ia, ib, rel, pair.axis_x, pair.axis_y)
    pair.parted = stamp
    return bool(pair.gap > 0.0)


@kernel
def _part(pool: Pool, tables: Tables, pair: Any, a: Any, b: Any) -> None:
    """Look for what parts a pair that does not overlap."""
    sa = tables.shapes[pair.a]
    sb = tables.shapes[pair.b]
    if sa.mirror < 0 and sb.mirror < 0:
        rel = seen_from(pool.heads[sa.outline], pose_of(a), pool.heads[sb.outline], pose_of(b))
        find_axis(pool, sa.outline, sb.outline, rel, pair)
        pair.parted = tables.counters[SUBSTEP]


@kernel
def _stays_apart(pool: Pool, tables: Tables, pair: Any, a: Any, b: Any, h: float) -> float:
    """How far apart a pair is in h at least (length); nothing, or less, where it may overlap then."""
    if pair.parted != tables.counters[SUBSTEP] or pair.gap <= 0.0:
        return _boxes_apart(tables, pair, -h)
    nx = a.c * pair.axis_x - a.s * pair.axis_y
    ny = a.s * pair.axis_x + a.c * pair.axis_y
    closing = (a.vx - b.vx) * nx + (a.vy - b.vy) * ny
    closing += abs(a.w) * _farthest(pool, tables.shapes[pair.a], a)
    closing += abs(b.w) * _farthest(pool, tables.shapes[pair.b], b)
    apart = pair.gap - h * closing
    return apart if apart > 0.0 else _boxes_apart(tables, pair, -h)


@kernel
def _apart_then(pool: Pool, tables: Tables, pair: Any, a: Any, b: Any, h: float) -> float:
    """How far apart along its axis a pair is that goes on for h as it does (length); less, where it may turn far."""
    least = little(tables, pair, a, b, h)
    if least <= 0.0 or (pair.axis_x == 0.0 and pair.axis_y == 0.0):
        return 0.0
    ia = tables.shapes[pair.a].outline
    ib = tables.shapes[pair.b].outline
    rel = seen_from(pool.heads[ia], earlier(a, -h), pool.heads[ib], earlier(b, -h))
    return float(min(least, gap_along(pool, ia, ib, rel, pair.axis_x, pair.axis_y)))


@kernel
def _farthest(pool: Pool, shape: Any, body: Any) -> float:
    """At most so far from the body's centre a point of its outline is turned about (length); a disc turns under it."""
    head = pool.heads[shape.outline]
    dx = head.x - body.cog_x
    dy = head.y - body.cog_y
    own = 0.0 if head.disc else head.radius
    return float(math.sqrt(dx * dx + dy * dy) + own)


@kernel
def _add_rows(tables: Tables, law: Law, p: int, h: float, until: int) -> bool:
    """Rows for the regions of pair p, up to region `until` (-1: for all); False: no room for them."""
    counters = tables.counters
    pair = tables.pairs[p]
    first = tables.shapes[pair.a].body
    second = tables.shapes[pair.b].body
    r = pair.head
    while r != until:
        region = tables.regions[r]
        if counters[ROWS] == len(tables.rows):
            return False
        row = tables.rows[counters[ROWS]]
        counters[ROWS] += 1
        row.region = r
        row.a = first
        row.b = second
        make_row(row, region, law, tables.bodies[first], tables.bodies[second], pair, h)
        counters[BOUNCES] += region.mode == STRUCK
        r = region.next
    return True


@kernel
def gather(
    pool: Pool, tables: Tables, work: Work, law: Law, frame: int, h: float, start: int
) -> tuple[int, int]:
    """Regions and rows of all near pairs from tables.near[start] on: (DONE or GROW_..., where it stopped)."""
    counters = tables.counters
    for i in range(max(start, counters[FIRST]), counters[LAST]):
        p = tables.near[i].pair
        pair = tables.pairs[p]
        sa = tables.shapes[pair.a]
        sb = tables.shapes[pair.b]
        a = tables.bodies[sa.body]
        b = tables.bodies[sb.body]
        if a.stamp != frame and b.stamp != frame:
            continue
        if a.inverse_mass == 0.0 and b.inverse_mass == 0.0:
            continue
        if pair.head < 0 and (not may_touch(tables, pair, h) or _stay_apart(pool, tables, pair, a, b, h)):
            continue
        if not allowed(tables, pair, frame):
            if pair.stamp != frame:
                pair.waited = h if pair.waiting != frame else pair.waited + h
                pair.waiting = frame
            continue
        status = meet(pool, tables, work, law, p, h)
        if status != DONE:
            return status, i
        if pair.head < 0:
            _part(pool, tables, pair, a, b)
            continue
        pair.seats = has_seats(pool, tables, pair)
        if not _add_rows(tables, law, p, h, -1):
            return GROW_REGIONS, i
    return DONE, counters[LAST]


@kernel
def _stray(tables: Tables, h: float) -> None:
    """Note how far a point of each live body may go in the next h, and how far off its way the sweeps have sent it."""
    for k in range(tables.counters[LIVE]):
        body = tables.bodies[tables.live[k]]
        arm = body.reach + abs(body.cog_x) + abs(body.cog_y)
        body.way = h * (abs(body.vx) + abs(body.vy) + abs(body.kick_x) + abs(body.kick_y) + abs(body.w) * arm)
        body.strayed = h * (
            abs(body.vx - body.came_vx) + abs(body.vy - body.came_vy) + abs(body.w - body.came_w) * arm
        )


@kernel
def _look_ahead(pool: Pool, tables: Tables, near: Any, a: Any, b: Any, h: float, seats: bool) -> bool:
    """Whether a pair must be asked if it overlaps in h. If not, by how much more the two may stray until it must."""
    pair = tables.pairs[near.pair]
    if a.inverse_mass == 0.0 and b.inverse_mass == 0.0:
        near.room = np.inf
        return False
    strayed = a.strayed + b.strayed
    near.room = 0.0
    known = 0.0
    if pair.head >= 0:
        known = 0.0 if seats else LOOK * min(a.extent, b.extent)
    elif pair.parted == tables.counters[SUBSTEP]:
        known = pair.gap
    if a.way + b.way < known:
        near.room = known - (a.way + b.way) - strayed
        return False
    if pair.head >= 0 and not seats:
        way = little(tables, pair, a, b, h)
        if way >= 0.0 or jumped(tables, pair, a, b, h) == 1:
            near.room = way - strayed
            return False  # it has met already, and turns too little to come down elsewhere
    apart = _stays_apart(pool, tables, pair, a, b, h)
    if apart <= 0.0 and pair.head < 0:
        apart = _apart_then(pool, tables, pair, a, b, h)
    near.room = apart - strayed
    return bool(apart <= 0.0)


@kernel
def join(
    pool: Pool, tables: Tables, work: Work, law: Law, frame: int, h: float, start: int, first: bool
) -> tuple[int, int, int]:
    """Rows for pairs that the velocities, as solved so far, would bring to overlap in the next drift.

    So what stands at touch is held from the start, and a blow goes on from body to body within the substep. Returns
    (DONE or GROW_..., where it stopped, how many rows joined).
    """
    counters = tables.counters
    before = counters[ROWS]
    _stray(tables, h)
    for i in range(max(start, counters[FIRST]), counters[LAST]):
        near = tables.near[i]
        if first:
            near.a = tables.shapes[tables.pairs[near.pair].a].body
            near.b = tables.shapes[tables.pairs[near.pair].b].body
        a = tables.bodies[near.a]
        b = tables.bodies[near.b]
        if not first and a.strayed + b.strayed < near.room:
            continue
        pair = tables.pairs[near.pair]
        if not _look_ahead(pool, tables, near, a, b, h, first and pair.seats) or not allowed(
            tables, pair, frame
        ):
            continue
        old = pair.head
        status = meet_ahead(pool, tables, work, law, near.pair, h, first)
        if status != DONE:
            return status, i, counters[ROWS] - before
        if not _add_rows(tables, law, near.pair, h, old):
            return GROW_REGIONS, i, counters[ROWS] - before
    return DONE, counters[LAST], counters[ROWS] - before


@kernel
def warm_start(tables: Tables) -> None:
    """Begin with the impulses of the substep before."""
    for i in range(tables.counters[ROWS]):
        row = tables.rows[i]
        push(row, tables.bodies[row.a], tables.bodies[row.b], row.l1, row.l2, row.lt)


@kernel(forceinline=True)
def usable(body: Any, h: float) -> float:
    """Which part of what a body begins a substep with moves it by no more than HIT of itself, the kick counted in.

    What balances kicks, and itself, is usable; what has borne against something that has come off since would shoot
    the body.
    """
    way = abs(body.vx - body.came_vx + body.kick_x) + abs(body.vy - body.came_vy + body.kick_y)
    way += abs(body.w - body.came_w + body.kick_w) * body.extent
    most = HIT * body.extent
    return float(most / (h * way)) if body.mobile and h * way > most > 0.0 else 1.0


@kernel
def lessen(tables: Tables, h: float) -> None:
    """Of what rows begin with, only what is usable."""
    for i in range(tables.counters[ROWS]):
        row = tables.rows[i]
        a = tables.bodies[row.a]
        b = tables.bodies[row.b]
        part = min(usable(a, h), usable(b, h))
        if part < 1.0:
            d1, d2, dt = (part - 1.0) * row.l1, (part - 1.0) * row.l2, (part - 1.0) * row.lt
            row.l1 += d1
            row.l2 += d2
            row.lt += dt
            push(row, a, b, d1, d2, dt)


@kernel
def sweep(tables: Tables, up: bool) -> float:
    """Visit every row once, from the bottom to the top or back (Gauss-Seidel, symmetric over two sweeps).

    Returns the largest change of a contact's speed (length/time).
    """
    n = tables.counters[ROWS]
    most = 0.0
    for i in range(n):
        row = tables.rows[i if up else n - 1 - i]
        most = max(most, visit(row, tables.bodies[row.a], tables.bodies[row.b]))
    return most


@kernel
def common(tables: Tables) -> tuple[float, float, float]:
    """Mass of all that contacts may move, and its centre's velocity: what is the same for all is nobody's speed."""
    mass = 0.0
    x = 0.0
    y = 0.0
    for k in range(tables.counters[LIVE]):
        body = tables.bodies[tables.live[k]]
        if body.inverse_mass > 0.0:
            mass += 1.0 / body.inverse_mass
            x += body.vx / body.inverse_mass
            y += body.vy / body.inverse_mass
    return (mass, x / mass, y / mass) if mass > 0.0 else (0.0, 0.0, 0.0)


@kernel
def kinetic(tables: Tables, x: float, y: float) -> float:
    """Kinetic energy of all that contacts may move, for one who goes at (x, y)."""
    total = 0.0
    for k in range(tables.counters[LIVE]):
        body = tables.bodies[tables.live[k]]
        if body.inverse_mass > 0.0:
            total += 0.5 * ((body.vx - x) ** 2 + (body.vy - y) ** 2) / body.inverse_mass
        if body.inverse_moment > 0.0:
            total += 0.5 * body.w * body.w / body.inverse_moment
    return total


@kernel
def pace(law: Law, mass: float, energy: float, h: float) -> float:
    """The change of speed in a sweep that is small beside what pushes gives in a substep, and the bodies' speed."""
    return LEFT * law.gravity * h + MOVED * math.sqrt(2.0 * energy / mass) if mass > 0.0 else 0.0


@kernel
def held_back(tables: Tables, h: float) -> float:
    """At least what the rows' springs hold, and could give back (energy)."""
    total = 0.0
    for i in range(tables.counters[ROWS]):
        row = tables.rows[i]
        total += (row.f1 + row.f2) / h * tables.regions[row.region].depth
    return total


@kernel
def finish(tables: Tables, law: Law, frame: int, h: float, last: bool) -> None:
    """What the rows leave behind: in their regions, and in the places of bodies that were struck."""
    for i in range(tables.counters[ROWS]):
        row = tables.rows[i]
        region = tables.regions[row.region]
        a = tables.bodies[row.a]
        b = tables.bodies[row.b]
        settle(row, region, law, tables.pairs[region.pair], a, b, h, last)
    for k in range(tables.counters[LIVE]):
        body = tables.bodies[tables.live[k]]
        body.pushed = 0
        if body.stamp == frame and (body.shift_x != 0.0 or body.shift_y != 0.0 or body.shift_a != 0.0):
            if body.kind == DRIFTS:
                body.x += body.shift_x
                body.y += body.shift_y
                body.angle += body.shift_a
                # What has been shifted by one impulse meets the next with another arm. (Not a disc without friction:
                # there the direction goes with the arm, and spin would be energy from nowhere.)
                vx = body.vx - body.came_vx
                vy = body.vy - body.came_vy
                turned = abs(body.w - body.came_w) * body.extent
                if body.inverse_mass > 0.0 and turned > 1e-9 * (abs(vx) + abs(vy)):
                    turn = body.shift_x * vy - body.shift_y * vx
                    most = (abs(vx) + abs(vy)) / body.extent  # blow upon blow: no place for second orders
                    body.w -= min(most, max(-most, turn * body.inverse_moment / body.inverse_mass))
                place(body)
            body.shift_x = 0.0
            body.shift_y = 0.0
            body.shift_a = 0.0
    for i in range(tables.counters[ROWS]):
        row = tables.rows[i]
        if row.l1 + row.l2 > 0.0:
            tables.bodies[row.a].pushed = 1
            tables.bodies[row.b].pushed = 1


@kernel
def respond_explicitly(tables: Tables) -> None:
    """The explicit law: every row answers to the same velocities, none to what another has done."""
    counters = tables.counters
    for i in range(counters[ROWS]):
        row = tables.rows[i]
        a = tables.bodies[row.a]
        b = tables.bodies[row.b]
        keep = (a.vx, a.vy, a.w, b.vx, b.vy, b.w)
        push(row, a, b, row.l1, row.l2, row.lt)
        visit(row, a, b)
        a.vx, a.vy, a.w, b.vx, b.vy, b.w = keep
    warm_start(tables)


@kernel
def finite(tables: Tables, frame: int) -> int:
    """The first body whose state is not finite; -1: all are."""
    for i in range(tables.counters[BODIES]):
        body = tables.bodies[i]
        if body.stamp == frame:
            total = body.x + body.y + body.angle + body.vx + body.vy + body.w
            if not math.isfinite(total):
                return i
    return -1
