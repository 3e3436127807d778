"""A pair that touches, as Chipmunk tells of it: after the user's own callbacks, with what they have made of it.

Noted are the friction, elasticity and surface velocity that they have left it, by how much they have turned its normal,
and whether they let it collide.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..compile.jit import callback, kernel
from ..compile.raw_memory import array_at, caller
from ..contact.broad import list_pair
from ..contact.space_record import EXTREME, load_tables
from ..contact.tables import COUNTED, FREE_PAIRS, MORE_PAIRS, TOLD, find_pair, new_pair
from .begin import begin
from .record import GROW, NORMAL, ask, floats, row_of_shape, state_of, time_step, timestamp, user_data, words
from .shown import show, shown_of

_call_hook = caller("void(uintp, uintp, uintp)")

#: A normal has been set if it is turned by more than this (rad): Chipmunk's own search ends within 1e-9 of another one.
SET = 1e-6


@kernel(forceinline=True)
def _surface_velocity(
    ax: float, ay: float, bx: float, by: float, nx: float, ny: float, given_x: float, given_y: float
) -> tuple[float, float]:
    """Surface velocity of the pair, B's minus A's: the shapes', unless a callback of the user set another.

    Chipmunk has projected the shapes' onto its own tangent, which for a stand-in is not the contact's: where
    `given` is that projection, what the shapes say is used instead.
    """
    x = bx - ax
    y = by - ay
    along = x * nx + y * ny
    if abs(given_x - (x - nx * along)) + abs(given_y - (y - ny * along)) > 1e-12 * (abs(x) + abs(y)):
        return given_x, given_y
    return x, y


@kernel
def _note_normal(s: Any, pair: Any, arbiter: int) -> None:
    """By how much callbacks of the user's have turned the arbiter's normal, if any has been called before the solve."""
    pair.steer_c = 1.0
    pair.steer_s = 0.0
    called = s.user_pre_solve == s.pythons_pre_solve
    t = shown_of(s)
    for handler in words(arbiter + s.arbiter_handlers, 4):
        if handler != 0:
            function = words(handler + s.handler_pre_solve, 1)[0]
            called |= function == s.pythons_pre_solve or function == t.first_at
    if not called:
        return
    n = floats(arbiter + s.arbiter_normal, 2)
    if t.arbiter == arbiter:
        sign = 1.0 if words(arbiter + s.arbiter_shape_a, 1)[0] == t.shape_a else -1.0
        s.asked_x = sign * t.nx
        s.asked_y = sign * t.ny
    else:
        s.asked_arbiter = arbiter
        if not ask(s, NORMAL):
            return
    c = s.asked_x * n[0] + s.asked_y * n[1]
    d = s.asked_x * n[1] - s.asked_y * n[0]
    length = math.hypot(c, d)
    if length > 0.0 and (abs(d) > SET * length or c < 0.0):
        pair.steer_c = c / length
        pair.steer_s = d / length


@callback("void(uintp, uintp, uintp)")
def pre_solve(arbiter: int, space: int, data: int) -> None:
    """One touching pair: note it, with what the user's callbacks have made of it."""
    if user_data(space) == 0:
        return
    s = state_of(space)
    now = np.int64(timestamp(space))
    show(s, space, arbiter)
    if s.user_pre_solve != 0:
        _call_hook(s.user_pre_solve, arbiter, space, data)
    if s.frame != now:
        begin(s, space, time_step(space))
    if s.failed:
        return
    both = words(arbiter + s.arbiter_shape_a, 2)
    a = row_of_shape(s, both[0])
    b = row_of_shape(s, both[1])
    if a < 0 or b < 0:
        return
    tables = load_tables(s)
    solid = not (
        array_at(both[0] + s.shape_sensor, (1,), np.uint8)[0]
        or array_at(both[1] + s.shape_sensor, (1,), np.uint8)[0]
    )
    if not (tables.bodies[tables.shapes[a].body].mobile or tables.bodies[tables.shapes[b].body].mobile):
        return
    p = find_pair(tables, a, b)
    if p < 0:
        if not solid:
            return
        if tables.counters[FREE_PAIRS] == 0:
            tables.counters[MORE_PAIRS] = 1
            if not ask(s, GROW):
                return
            tables = load_tables(s)
        p = new_pair(tables, a, b)
    pair = tables.pairs[p]
    list_pair(tables, p)
    if pair.stamp != now:
        tables.told[tables.counters[TOLD]] = p
        tables.counters[TOLD] += 1
    fresh = pair.stamp < 0  # nobody has set anything of it yet
    pair.stamp = now
    if pair.waiting >= tables.counters[COUNTED]:  # frames between have failed
        pair.waiting = now - 1
    pair.arbiter = arbiter
    friction, elasticity, verdict = pair.friction, pair.elasticity, pair.verdict
    surface_x, surface_y, c, d = pair.surface_x, pair.surface_y, pair.steer_c, pair.steer_s
    pair.swapped = 0 if pair.a == a else 1
    pair.verdict = 1 if solid and array_at(arbiter + s.arbiter_process, (1,), np.uint8)[0] else 0
    pair.jx = 0.0
    pair.jy = 0.0
    pair.friction = floats(arbiter + s.arbiter_friction, 1)[0]
    pair.elasticity = floats(arbiter + s.arbiter_elasticity, 1)[0]
    n = floats(arbiter + s.arbiter_normal, 2)
    given = floats(arbiter + s.arbiter_surface, 2)
    sa = tables.shapes[a]
    sb = tables.shapes[b]
    x, y = _surface_velocity(
        sa.surface_x, sa.surface_y, sb.surface_x, sb.surface_y, n[0], n[1], given[0], given[1]
    )
    sign = -1.0 if pair.swapped else 1.0
    pair.surface_x = sign * x
    pair.surface_y = sign * y
    s.fragile |= pair.friction + pair.elasticity + abs(x) + abs(y) + pair.rate > EXTREME
    _note_normal(s, pair, arbiter)
    same = friction == pair.friction and elasticity == pair.elasticity
    same = same and surface_x == pair.surface_x and surface_y == pair.surface_y
    same = same and c == pair.steer_c and d == pair.steer_s
    if verdict != pair.verdict or not (same or fresh):
        for i in (sa.body, sb.body):
            if tables.bodies[i].mobile:
                tables.bodies[i].disturbed = now
