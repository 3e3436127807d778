"""Which near pairs have rows in a substep: those that overlap, and those that would after its drift.

Whoever is looked at ahead leaves what parts it: it is looked at anew once the sweeps have used that up.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..compile.jit import kernel
from ..geometry.pool import Pool
from ..geometry.work import Work
from .bend import bend
from .broad import swing
from .constants import LOOK
from .joint import make_joint_row
from .meet import has_seats, meet, meet_ahead
from .motion import closing_along_axis, earlier, find_what_parts, gap_along_axis, jumped, little, pose_of
from .row import make_row
from .stiffness import allowed_depth
from .tables import (
    BOXED,
    CONCAVE,
    FIRST,
    FREE_PAIRS,
    FREE_REGIONS,
    JOINTS,
    LAST,
    LIVE,
    LYING,
    MORE_PAIRS,
    MORE_REGIONS,
    MOVERS,
    ROWS,
    SUBSTEP,
    Law,
    Tables,
)
from .verdict import allowed

#: Rows to spare, of pairs and of regions, beside a pair for each shape that moves, a region for every other one and for
#: each pair that has none and may come to touch in the frame; regions for each concave shape too.
SPARE = 24


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
    turn = abs(a.w) * (sa.half_x + sa.half_y) + abs(b.w) * (sb.half_x + sb.half_y)
    turn = abs(h) * (turn + swing(sa, a) + swing(sb, b))
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
def any_pair_touches(tables: Tables) -> bool:
    """Whether a pair of the turn overlapped when it was last looked at."""
    for i in range(tables.counters[FIRST], tables.counters[LAST]):
        if tables.pairs[tables.near[i].pair].head >= 0:
            return True
    return False


@kernel
def no_pair_comes_near(tables: Tables, time: float) -> bool:
    """Whether no two boxes of the turn's near pairs meet, so long before now or after it."""
    for i in range(tables.counters[FIRST], tables.counters[LAST]):
        pair = tables.pairs[tables.near[i].pair]
        sa = tables.shapes[pair.a]
        sb = tables.shapes[pair.b]
        a = tables.bodies[tables.near[i].a]
        b = tables.bodies[tables.near[i].b]
        speed = abs(a.vx - b.vx) + abs(a.vy - b.vy) + abs(a.gain_x - b.gain_x) + abs(a.gain_y - b.gain_y)
        speed += (abs(a.w) + abs(a.gain_w)) * (a.reach + abs(a.cog_x) + abs(a.cog_y))
        speed += (abs(b.w) + abs(b.gain_w)) * (b.reach + abs(b.cog_x) + abs(b.cog_y))
        apart = max(sa.left - sb.right, sb.left - sa.right, sa.bottom - sb.top, sb.bottom - sa.top)
        if apart <= time * speed:
            return False
    return True


@kernel
def _stay_apart(pool: Pool, tables: Tables, pair: Any, a: Any, b: Any, h: float) -> bool:
    """Whether what parted a pair when it was last looked at parts it now; not of one that may have jumped."""
    if pair.axis_x == 0.0 and pair.axis_y == 0.0:
        return False
    if jumped(tables, pair, a, b, h) > 1:
        return False
    pair.gap = gap_along_axis(pool, tables, pair, pose_of(a), pose_of(b))
    pair.parted = tables.counters[SUBSTEP]
    if pair.gap <= 0.0:
        return False
    pair.side_a = 0  # a segment without thickness shows what is off it the side on which that comes
    pair.side_b = 0
    return True


@kernel
def _part(pool: Pool, tables: Tables, pair: Any, a: Any, b: Any) -> None:
    """Look for what parts a pair that does not overlap."""
    find_what_parts(pool, tables, pair, a, b)
    pair.parted = tables.counters[SUBSTEP]


@kernel
def _stays_apart(pool: Pool, tables: Tables, pair: Any, a: Any, b: Any, h: float, part: float) -> float:
    """How far apart a pair is in h at least (length); nothing, or less, where it may overlap then.

    part: of the kicks, what is taken off.
    """
    if pair.parted != tables.counters[SUBSTEP] or pair.gap <= 0.0:
        return _boxes_apart(tables, pair, -h)
    apart = float(pair.gap - h * closing_along_axis(pool, tables, pair, a, b, part))
    return apart if apart > 0.0 else _boxes_apart(tables, pair, -h)


@kernel
def _apart_then(pool: Pool, tables: Tables, pair: Any, a: Any, b: Any, h: float) -> float:
    """How far apart along its axis a pair is that goes on for h as it does (length); less, where it may turn far."""
    least = little(tables, pair, a, b, h)
    if least <= 0.0 or (pair.axis_x == 0.0 and pair.axis_y == 0.0):
        return 0.0
    return float(min(least, gap_along_axis(pool, tables, pair, earlier(a, -h), earlier(b, -h))))


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
            counters[MORE_REGIONS] = 1
            return False
        row = tables.rows[counters[ROWS]]
        counters[ROWS] += 1
        row.region = r
        row.a = first
        row.b = second
        make_row(row, region, law, tables.bodies[first], tables.bodies[second], pair, h)
        r = region.next
    return True


@kernel
def has_room(tables: Tables, time: float) -> bool:
    """Whether there is room for what `time` may bring beyond what there is; if not, for how much more.

    Asked before a frame changes anything: hardly ever does one have to be run again from further on.
    """
    return bool(_has_room(tables, tables.counters[MOVERS], 0, time))


@kernel
def roomy(tables: Tables, shapes: int, time: float) -> bool:
    """Whether there is more room than a frame of `time` in which so many shapes move asks for (`has_room`); if not, how
    much.

    Asked when a frame begins: where it had to be run again, it would find other boxes than one that had room.
    """
    return bool(_has_room(tables, shapes, SPARE // 2 + shapes // 8, time))


@kernel
def _has_room(tables: Tables, shapes: int, more: int, time: float) -> bool:
    """Whether there is room for so many more pairs and regions than so many shapes may want within `time`."""
    counters = tables.counters
    pairs = shapes + SPARE + more - counters[FREE_PAIRS]
    regions = shapes // 2 + SPARE * (1 + counters[CONCAVE]) + more - counters[FREE_REGIONS]
    for i in range(counters[BOXED]):
        pair = tables.pairs[tables.near[i].pair]
        regions += pair.a >= 0 and pair.head < 0 and may_touch(tables, pair, -time)
    counters[MORE_PAIRS] = max(0, pairs)
    counters[MORE_REGIONS] = max(0, regions)
    return bool(pairs <= 0 and regions <= 0)


@kernel
def _add_joints(tables: Tables, h: float) -> None:
    """Rows for the turn's joints."""
    counters = tables.counters
    for k in range(counters[JOINTS]):
        number = tables.joints[k].order
        joint = tables.joints[number]
        if joint.mine:
            row = tables.rows[counters[ROWS]]
            row.region = number
            row.a = joint.a
            row.b = joint.b
            a = tables.bodies[joint.a]
            b = tables.bodies[joint.b]
            if make_joint_row(row, joint, a, b, h):
                bend(row, joint, a, b, h)
                counters[ROWS] += 1


@kernel
def gather(pool: Pool, tables: Tables, work: Work, law: Law, frame: int, h: float, jointed: bool) -> bool:
    """Regions and rows of all near pairs, and rows of joints; False: there is no room for them.

    Where there are joints, first what bears on what does not move, then the joints, then the other contacts: each
    finds what carries its bodies (`conjugate`).
    """
    counters = tables.counters
    first = counters[FIRST]
    size = counters[LAST] - first
    if jointed and size == 0:
        _add_joints(tables, h)
    for n in range(2 * size if jointed else size):
        i = first + (n - size if n >= size else n)
        p = tables.near[i].pair
        pair = tables.pairs[p]
        a = tables.bodies[tables.near[i].a]
        b = tables.bodies[tables.near[i].b]
        if jointed and n == size:
            _add_joints(tables, h)
        if a.stamp != frame and b.stamp != frame:
            continue
        if a.inverse_mass == 0.0 and b.inverse_mass == 0.0:
            continue
        if jointed and (n >= size) != (a.inverse_mass > 0.0 and b.inverse_mass > 0.0):
            continue
        pair.covered = 0
        if pair.head < 0 and (not may_touch(tables, pair, h) or _stay_apart(pool, tables, pair, a, b, h)):
            continue
        if not allowed(tables, pair, frame):
            if pair.stamp != frame:
                pair.waited = h if pair.waiting != frame else pair.waited + h
                pair.waiting = frame
            continue
        if not meet(pool, tables, work, law, p, h):
            return False
        if pair.head < 0:
            if not pair.covered:
                _part(pool, tables, pair, a, b)
            continue
        pair.seats = has_seats(pool, tables, pair)
        if not _add_rows(tables, law, p, h, -1):
            return False
    return True


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


@kernel(forceinline=True)
def _lie(a: Any, b: Any) -> bool:
    """Whether both lay on something a substep ago: that bears their kicks."""
    return (not a.mobile or a.pushed >= LYING) and (not b.mobile or b.pushed >= LYING)


@kernel
def _look_ahead(
    pool: Pool, tables: Tables, law: Law, near: Any, a: Any, b: Any, h: float, first: bool
) -> bool:
    """Whether a pair must be asked if it overlaps in h. If not, by how much more the two may stray until it must."""
    pair = tables.pairs[near.pair]
    if a.inverse_mass == 0.0 and b.inverse_mass == 0.0:
        near.room = np.inf
        return False
    strayed = a.strayed + b.strayed
    seats = first and pair.seats
    near.room = 0.0
    known = 0.0
    if pair.head >= 0 or pair.covered:
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
    borne = first and _lie(a, b) and pair.gap > allowed_depth(law, a, b)
    apart = _stays_apart(pool, tables, pair, a, b, h, 1.0 if borne else 0.0)
    if apart <= 0.0 and pair.head < 0:
        apart = _apart_then(pool, tables, pair, a, b, h)
    near.room = apart - strayed
    return bool(apart <= 0.0)


@kernel
def join(pool: Pool, tables: Tables, work: Work, law: Law, frame: int, h: float, first: bool) -> int:
    """Rows for pairs that the velocities, as solved so far, would bring to overlap in the next drift.

    So what stands at touch is held from the start, and a blow goes on from body to body within the substep. Returns
    how many rows joined; -1: there is no room for them.
    """
    counters = tables.counters
    before = counters[ROWS]
    _stray(tables, h)
    for i in range(counters[FIRST], counters[LAST]):
        near = tables.near[i]
        a = tables.bodies[near.a]
        b = tables.bodies[near.b]
        if not first and a.strayed + b.strayed < near.room:
            continue
        pair = tables.pairs[near.pair]
        if not _look_ahead(pool, tables, law, near, a, b, h, first) or not allowed(tables, pair, frame):
            continue
        old = pair.head
        if not meet_ahead(pool, tables, work, law, near.pair, h, first):
            return -1
        if not _add_rows(tables, law, near.pair, h, old):
            return -1
    return int(counters[ROWS] - before)
