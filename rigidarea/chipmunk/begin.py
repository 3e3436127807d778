"""A frame begins: everything as it is taken down, before anything has changed a velocity.

Positions are held (`hold`): the solve moves bodies itself. Chipmunk calls it for every body, before all else in its
step; the first call begins the frame.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..compile.jit import callback, kernel
from ..compile.raw_memory import array_at, caller
from ..contact.broad import forget_the_gone, shapes_collide
from ..contact.join import roomy
from ..contact.space_record import load_pool, load_tables, load_work
from ..contact.tables import BODIES, BOXED, KNOWN, MORE_JOINTS, MOVERS, TOLD, Tables
from ..contact.verdict import lasts
from .awake import put_to_rest, watch_bodies
from .joints import joints_of, partners_known, take_joints
from .phases import WATCHING, lap, start
from .record import (
    GROW,
    REGISTER,
    ask,
    floats,
    look_at_partners,
    members,
    read_motion,
    read_place,
    space_of,
    state_of,
    timestamp,
    user_data,
    words,
)
from .structs import function

shape_counter = function("cpSpaceGetShapeIDCounter", "uintp(uintp)")
_call_count = caller("int32(uintp)")


@kernel(forceinline=True)
def _shapes_there(s: Any, space: int) -> int:
    """How many shapes the space has: its static and its dynamic index count theirs (struct cpSpatialIndex)."""
    n = 0
    for index in words(space + s.space_constraints - 16, 2):
        n += _call_count(words(words(index, 1)[0], 2)[1], index)
    return n


@kernel(forceinline=True)
def changed(s: Any, space: int) -> bool:
    """Whether shapes or callbacks have come or gone since Python last looked."""
    handlers = array_at(words(space + s.space_handlers, 1)[0], (1,), np.int32)[0]
    return bool(
        shape_counter(space) != s.shape_counter
        or _shapes_there(s, space) != s.shape_count
        or handlers != s.handler_count
    )


@kernel
def look_at_jointed(s: Any, tables: Tables) -> None:
    """What joints hold and is not awake: a static body, or one of the user's that is in no space, moved by hand."""
    for joint in joints_of(s):
        for i in (joint.a, joint.b):
            if i >= 0 and not tables.bodies[i].awake:
                body = tables.bodies[i]
                x, y, angle, vx, vy, w = body.x, body.y, body.angle, body.vx, body.vy, body.w
                read_place(s, body.address, body)
                put_to_rest(s, body)
                moved = x != body.x or y != body.y or angle != body.angle
                if moved or vx != body.vx or vy != body.vy or w != body.w:
                    body.disturbed = s.frame
                if (
                    space_of(body.address) == 0
                ):  # in no space: nobody moves it, but joints change its velocity
                    read_motion(s, body.address, body)


@kernel(forceinline=True)
def listened(s: Any) -> bool:
    """Whether callbacks of the user's may be asked about any shape."""
    return bool(s.heard_all != 0 or s.heard_alone_n > 0 or s.heard_pairs_n > 0)


@kernel
def _last(s: Any, tables: Tables, dt: float) -> None:
    """What touches still, but for a hair: Chipmunk does not take it for separated in this step."""
    for k in range(tables.counters[BOXED]):
        pair = tables.pairs[tables.near[k].pair]
        if pair.a < 0:
            continue
        one, other = tables.shapes[pair.a], tables.shapes[pair.b]
        if not (one.sensor or other.sensor or shapes_collide(tables, one, other)):  # parted in play
            continue
        if lasts(load_pool(s), tables, load_work(s), pair, s.frame, dt):
            pair.lasting = s.frame
            if pair.arbiter != 0:  # a copy has none yet
                array_at(pair.arbiter + s.arbiter_stamp, (1,), np.uint32)[0] = np.uint32(s.frame)


@kernel
def begin(s: Any, space: int, dt: float) -> bool:
    """The first thing in a frame: everything as it is. Whether it could be taken down."""
    start(s)
    s.frame = np.int64(timestamp(space))
    g = floats(space + s.space_gravity, 2)
    s.gravity = math.sqrt(g[0] * g[0] + g[1] * g[1])
    s.failed = 0
    s.fragile = 0
    if s.stiffness + s.penetration != s.rested_with:
        s.rested_with = s.stiffness + s.penetration
        for i in range(load_tables(s).counters[BODIES]):
            load_tables(s).bodies[i].rests = 0
    hook = words(s.global_handler + s.handler_pre_solve, 1)
    heard = words(s.global_handler + s.handler_pre_solve - 8, 4)  # begin, pre_solve, post_solve, separate
    fresh = changed(s, space) or (
        heard[0] != s.global_begin or heard[2] != s.global_post_solve or heard[3] != s.global_separate
    )
    if hook[0] != s.pre_solve_at:  # the user has set one of theirs, or taken it away: ours comes after it
        s.user_pre_solve = np.uint64(0) if hook[0] == s.no_pre_solve else hook[0]
        hook[0] = s.pre_solve_at
        fresh = True
    load_tables(s).counters[TOLD] = 0
    if (fresh or s.pending) and not ask(s, REGISTER):
        return False
    forget_the_gone(load_tables(s))
    if not watch_bodies(s, load_tables(s), space, dt):  # somebody came on a way of which pymunk has not told
        s.pending = 2
        if not ask(s, REGISTER) or not watch_bodies(s, load_tables(s), space, dt):
            return False
    load_tables(s).counters[KNOWN] = 0
    look_at_partners(s, load_tables(s))
    s.asleep = len(members(space, s.space_sleeping)) > 0
    if not s.explicit:
        n = len(members(space, s.space_constraints))
        if n > s.joints_n:
            load_tables(s).counters[MORE_JOINTS] = n - s.joints_n
            if not ask(s, GROW):
                return False
        if not partners_known(s, members(space, s.space_constraints)):
            s.pending = 3
            if not ask(s, REGISTER):
                return False
        tables = load_tables(s)
        take_joints(s, tables, members(space, s.space_constraints))
        look_at_jointed(s, tables)
    if listened(s):  # joints have been told who does not collide
        _last(s, load_tables(s), dt)
    # last: a joint that is not taken acts on bodies after a frame that could not begin
    good = roomy(load_tables(s), load_tables(s).counters[MOVERS], dt) or ask(s, GROW)
    lap(s, WATCHING)
    return bool(good)


@callback("void(uintp, float64)")
def hold(body: int, dt: float) -> None:
    """Chipmunk's position function of every body: it stays where it is. The first call begins the frame."""
    space = space_of(body)
    if space == 0 or user_data(space) == 0:
        return
    s = state_of(space)
    if s.frame != np.int64(timestamp(space)):
        begin(s, space, dt)
