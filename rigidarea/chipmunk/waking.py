"""Before a step: who sleeps and will be hit in it is woken. Called by `AreaContact`, in machine code or interpreted."""

from __future__ import annotations

import math

from ..compile.jit import callback
from ..contact.broad import forget_the_gone
from ..contact.join import may_touch
from ..contact.motion import meets_within, start_looks
from ..contact.space_record import load_pool, load_tables, load_work, row_of_body
from ..contact.tables import FIXED, MORE_WORK, NEAR, TURN
from .phases import start
from .record import members, notice, state_of, user_data
from .structs import function
from .substep import near_pairs

_activate = function("cpBodyActivate", "void(uintp)")

#: What sleeps wakes for somebody who comes by more than this in a frame, of its own smallest extent. Whoever is slower
#: comes to overlap it a little, for which Chipmunk wakes it.
WAKING = 0.01


@callback("int32(uintp, float64)")
def rouse(space: int, dt: float) -> int:
    """Before a step of Chipmunk's: wake what is asleep and will be hit within the frame. 0: the tables are too small.

    Chipmunk wakes what somebody overlaps at the frame's start. What is met within the frame would be a wall, on which
    a blow is spent before anybody sees an overlap. (Within its step Chipmunk cannot wake anybody before it has paired
    bodies and arbiters, and then the frame has begun.)
    """
    if user_data(space) == 0:
        return 1
    s = state_of(space)
    if s.asleep == 0 or s.explicit or len(members(space, s.space_bodies)) == 0:
        return 1
    start(s)
    tables = load_tables(s)
    forget_the_gone(tables)
    for address in members(space, s.space_bodies):
        i = row_of_body(s, address)
        if i < 0 or tables.bodies[i].stamp != s.frame:
            return 1  # somebody new: the frame will look at everybody first
        body = tables.bodies[i]
        notice(s, address, body)
        if not math.isfinite(body.x + body.y + body.angle + body.vx + body.vy + body.w):
            return 1
    tables.counters[TURN] = 0  # everybody
    start_looks(tables.counters)
    ahead = dt + dt / s.substeps  # the last substep looks beyond the frame
    s.begun = 0
    if not near_pairs(s, space, ahead, ahead):
        return 0
    for i in range(tables.counters[NEAR]):
        pair = tables.pairs[tables.near[i].pair]
        a = tables.bodies[tables.shapes[pair.a].body]
        b = tables.bodies[tables.shapes[pair.b].body]
        if (a.kind == FIXED) == (b.kind == FIXED) or not may_touch(tables, pair, -ahead):
            continue
        sleeper = a if a.kind == FIXED else b
        comer = b if a.kind == FIXED else a
        way = dt * (abs(comer.vx) + abs(comer.vy) + abs(comer.w) * sleeper.extent)
        if not sleeper.mobile or way <= WAKING * sleeper.extent:
            continue
        met = meets_within(load_pool(s), tables, load_work(s), pair, ahead)
        if met < 0:
            tables.counters[MORE_WORK] = 1
            return 0
        if met > 0:
            _activate(sleeper.address)
    return 1
