"""A step of Chipmunk's, as far as it is only watched: where bodies are, which pairs touch, what the user says of them.

Everything here is called by Chipmunk, in machine code (or interpreted, with NUMBA_DISABLE_JIT=1: the same lines).
Positions are held (`hold`): the solve moves bodies itself. `begin` takes down where they are and how they move before
anything has changed a velocity. `pre_solve` runs after the user's own callbacks and notes the pair, with the
friction, elasticity and surface velocity that they have left it, and whether they let it collide.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..compile.jit import callback, kernel
from ..compile.raw_memory import array_at, caller
from ..contact.broad import ask_about, forget_the_gone, list_pair, measure, put_in_tree
from ..contact.join import roomy
from ..contact.space_record import EXTREME, STATE, load_pool, load_tables, load_work, row_of_body
from ..contact.tables import (
    AWAKE,
    BOXED,
    COUNTED,
    DRIFTS,
    FIXED,
    FREE_PAIRS,
    LED,
    MORE_JOINTS,
    MORE_PAIRS,
    MOVERS,
    TOLD,
    UNSORTED,
    Tables,
    find_pair,
    new_pair,
)
from ..contact.tree import MOVING
from ..contact.verdict import lasts
from ..geometry.place import place, shift
from .joints import joints_of, partners_known, take_joints
from .phases import WATCHING, lap, start
from .shown import show, shown_of
from .structs import function

#: What machine code asks Python for: all of it before a frame has changed anything, or when it has ended.
REGISTER, GROW, BROKEN, NORMAL = range(4)

user_data = function("cpSpaceGetUserData", "uintp(uintp)")
timestamp = function("cpSpaceGetTimestamp", "uint32(uintp)")
shape_counter = function("cpSpaceGetShapeIDCounter", "uintp(uintp)")
time_step = function("cpSpaceGetCurrentTimeStep", "float64(uintp)")
space_of = function("cpBodyGetSpace", "uintp(uintp)")
body_type = function("cpBodyGetType", "int32(uintp)")
_call_ask = caller("void(uintp)")
_call_hook = caller("void(uintp, uintp, uintp)")
_call_count = caller("int32(uintp)")

#: A normal has been set if it is turned by more than this (rad): Chipmunk's own search ends within 1e-9 of another one.
SET = 1e-6


@kernel(inline="always")
def floats(address: int, n: int) -> np.ndarray:
    """n floats of Chipmunk's memory."""
    return array_at(address, (n,), np.float64)


@kernel(inline="always")
def words(address: int, n: int) -> np.ndarray:
    """n pointers of Chipmunk's memory."""
    return array_at(address, (n,), np.uint64)


@kernel(inline="always")
def state_of(space: int) -> Any:
    """The state record of an attached space."""
    return array_at(user_data(space), (1,), STATE)[0]


@kernel
def ask(s: Any, request: int) -> bool:
    """Ask Python for something; whether it could. If not, what it raised is raised after the step."""
    s.failed = 1  # until Python says that it has done all of it, whatever interrupts it
    _call_ask(s.ask_at, np.uint64(request))
    return bool(s.failed == 0)


@kernel(inline="always")
def members(space: int, offset: int) -> np.ndarray:
    """The pointers in one of the space's arrays, {int num, max; void **arr}."""
    at = words(space + offset, 1)[0]
    return words(words(at, 2)[1], array_at(at, (2,), np.int32)[0])


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


@kernel(forceinline=True)
def read_place(s: Any, address: int, body: Any) -> None:
    """Where a body is."""
    p = floats(address + s.body_position, 2)
    cog = floats(address + s.body_cog, 2)
    angle = floats(address + s.body_angle, 1)[0]
    turned = angle != body.angle or (body.c == 0.0 and body.s == 0.0)
    body.x = p[0]
    body.y = p[1]
    body.angle = angle
    body.cog_x = cog[0]
    body.cog_y = cog[1]
    if turned:
        place(body)
    else:
        shift(body)


@kernel(forceinline=True)
def _read_velocity(s: Any, address: int, body: Any) -> None:
    v = floats(address + s.body_velocity, 2)
    body.vx = v[0]
    body.vy = v[1]
    body.w = floats(address + s.body_spin, 1)[0]


@kernel(forceinline=True)
def read_motion(s: Any, address: int, body: Any) -> None:
    """How it moves, and how it lets itself be moved."""
    _read_velocity(s, address, body)
    body.inverse_mass = floats(address + s.body_inverse_mass, 1)[0]
    body.inverse_moment = floats(address + s.body_inverse_moment, 1)[0]


@kernel(forceinline=True)
def write_place(s: Any, body: Any) -> None:
    """Put a body where the solve has taken it."""
    p = floats(body.address + s.body_position, 2)
    p[0] = body.x
    p[1] = body.y
    floats(body.address + s.body_angle, 1)[0] = body.angle
    t = floats(body.address + s.body_transform, 6)
    t[0] = body.c
    t[1] = body.s
    t[2] = -body.s
    t[3] = body.c
    t[4] = body.ox
    t[5] = body.oy


@kernel(forceinline=True)
def write_motion(s: Any, body: Any) -> None:
    """Give it its velocity."""
    v = floats(body.address + s.body_velocity, 2)
    v[0] = body.vx
    v[1] = body.vy
    floats(body.address + s.body_spin, 1)[0] = body.w


@kernel(forceinline=True)
def notice(s: Any, address: int, body: Any) -> None:
    """A body that is awake, as it is now, and whether it has been set so by the user."""
    x, y, angle = body.x, body.y, body.angle
    vx, vy, w = body.vx, body.vy, body.w
    read_place(s, address, body)
    read_motion(s, address, body)
    set_place = x != body.x or y != body.y or angle != body.angle
    if body.stamp >= 0 and (set_place or vx != body.vx or vy != body.vy or w != body.w):
        body.since = 0.0


@kernel(forceinline=True)
def row_of_shape(s: Any, shape: int) -> int:
    """The row of Chipmunk's shape at that address; -1: not known."""
    ident = np.int64(words(shape + s.shape_hashid, 1)[0])
    if ident >= s.slots_n:
        return -1
    return int(array_at(s.slots_at, (s.slots_n,), np.int32)[ident])


@kernel
def _heard(s: Any, kind: int) -> int:
    """Whether callbacks of the user's may be asked about a collision type: see SHAPE."""
    heard = np.int64(s.heard_all)
    for other in words(s.heard_alone_at, s.heard_alone_n):
        if other == kind:
            heard |= 1
    for other in words(s.heard_pairs_at, s.heard_pairs_n):
        if other == kind:
            heard |= 2
    return int(heard)


@kernel
def _read_shape(s: Any, shape: Any) -> bool:
    """What the user may set of a shape, as it is now. Whether it may collide with others than before."""
    shape.seen = s.frame
    material = floats(shape.address + s.shape_elasticity, 2)
    shape.elasticity = material[0]
    shape.friction = material[1]
    surface = floats(shape.address + s.shape_surface_velocity, 2)
    shape.surface_x = surface[0]
    shape.surface_y = surface[1]
    kind = words(shape.address + s.shape_type, 1)[0]
    if kind != shape.type or shape.epoch != s.heard_epoch:
        shape.type = kind
        shape.epoch = s.heard_epoch
        shape.heard = _heard(s, kind)
    sensor = array_at(shape.address + s.shape_sensor, (1,), np.uint8)[0]
    group = words(shape.address + s.shape_filter, 1)[0]
    masks = array_at(shape.address + s.shape_filter + 8, (2,), np.uint32)
    if (
        sensor == shape.sensor
        and group == shape.group
        and masks[0] == shape.categories
        and masks[1] == shape.mask
    ):
        return False
    shape.sensor = sensor
    shape.group = group
    shape.categories = masks[0]
    shape.mask = masks[1]
    return True


@kernel
def _list_shapes(s: Any, tables: Tables, body: Any, anew: bool) -> bool:
    """List the shapes of a body that is awake among the movers; anew: it was not, or is mobile now.

    Whether all are known.
    """
    counters = tables.counters
    address = words(body.address + s.body_shapes, 1)[0]
    while address != 0:
        i = row_of_shape(s, address)
        if i < 0:
            return False
        shape = tables.shapes[i]
        tables.movers[counters[MOVERS]] = i
        counters[MOVERS] += 1
        sensor = shape.sensor
        changed = _read_shape(s, shape)
        if changed or anew:
            ask_about(tables, i)
            counters[UNSORTED] = 1
            body.unmeasured |= sensor != shape.sensor
        if shape.leaf >= 0 and shape.tree != MOVING:
            put_in_tree(tables, i, MOVING)
        address = words(address + s.shape_next, 1)[0]
    if body.unmeasured:  # it is as thin as its thinnest shape that is no sensor
        body.unmeasured = 0
        body.extent = 0.0
        body.reach = 0.0
        address = words(body.address + s.body_shapes, 1)[0]
        while address != 0:
            measure(load_pool(s), tables.shapes[row_of_shape(s, address)], body)
            address = words(address + s.shape_next, 1)[0]
    return True


@kernel
def look_at_partners(s: Any, tables: Tables) -> None:
    """What the user may set of shapes that do not move, of those that somebody who is awake is near."""
    for n in range(tables.counters[BOXED]):
        pair = tables.pairs[tables.near[n].pair]
        if pair.a < 0:
            continue
        for i in (pair.a, pair.b):
            shape = tables.shapes[i]
            if shape.seen != s.frame:
                if _read_shape(s, shape):
                    tables.counters[UNSORTED] = 1
                body = tables.bodies[shape.body]
                _read_velocity(s, body.address, body)


@kernel
def _look_at_jointed(s: Any, tables: Tables) -> None:
    """What joints hold and is not awake: a static body, or one of the user's that is in no space, moved by hand."""
    for joint in joints_of(s):
        for i in (joint.a, joint.b):
            if i >= 0 and not tables.bodies[i].awake:
                body = tables.bodies[i]
                read_place(s, body.address, body)
                put_to_rest(s, body)
                if (
                    space_of(body.address) == 0
                ):  # in no space: nobody moves it, but joints change its velocity
                    read_motion(s, body.address, body)


@kernel
def add_to_awake(tables: Tables, i: int, body: Any) -> None:
    """A body that was not awake is."""
    body.awake = 1
    body.unmeasured = 1
    tables.awake[tables.counters[AWAKE]] = i
    tables.counters[AWAKE] += 1


@kernel
def _watch(s: Any, tables: Tables, space: int, dt: float) -> bool:
    """All bodies that are awake, as they are now, and those that no more are. Whether all that there are are known."""
    counters = tables.counters
    moved = True  # Chipmunk has moved what it has listed before the first that is held: that begins the frame
    for address in members(space, s.space_bodies):
        i = row_of_body(s, address)
        if i < 0:
            return False
        body = tables.bodies[i]
        if body.stamp == s.frame:
            continue
        met = body.stamp >= 0
        x, y, angle = body.x, body.y, body.angle
        notice(s, address, body)
        body.stamp = s.frame
        body.was_calm = 1 if body.calm > 0 else 0
        mobile = 1 if body.inverse_mass > 0.0 or body.inverse_moment > 0.0 else 0
        body.changed = 1 if mobile != body.mobile or not body.awake else 0
        body.mobile = mobile
        if not body.awake:
            add_to_awake(tables, i, body)
        function = words(address + s.body_position_func, 1)
        body.kind = DRIFTS if function[0] == s.hold_at else LED
        moved &= body.kind == LED
        if (function[0] == s.position_func or function[0] == s.position_func_again) and s.explicit == 0:
            # Chipmunk's own: a body that is new here. It will have been moved by a whole frame before the solve.
            body.kind = DRIFTS
            if moved:
                _take_back(body, dt)
        if met and body.kind == LED and not math.isfinite(body.x + body.y + body.angle):
            body.old_x = x  # it has been moved before the frame began for us: where the last one has left it
            body.old_y = y
            body.old_a = angle
        else:
            body.old_x = body.x
            body.old_y = body.y
            body.old_a = body.angle
        body.old_vx = body.vx
        body.old_vy = body.vy
        body.old_w = body.w
        body.old_since = body.since
        force = floats(address + s.body_force, 2)
        body.old_fx = force[0]
        body.old_fy = force[1]
        body.old_torque = floats(address + s.body_torque, 1)[0]
    n = 0
    for k in range(counters[AWAKE]):
        i = tables.awake[k]
        body = tables.bodies[i]
        if body.stamp == s.frame:
            tables.awake[n] = i
            n += 1
        else:
            put_to_rest(s, body)
            counters[UNSORTED] = 1
    counters[AWAKE] = n
    counters[MOVERS] = 0
    for k in range(n):
        body = tables.bodies[tables.awake[k]]
        if not _list_shapes(s, tables, body, body.changed == 1):
            return False
    return True


@kernel
def wake(s: Any, tables: Tables, i: int) -> None:
    """A body that Chipmunk has woken within its step."""
    body = tables.bodies[i]
    body.stamp = s.frame
    read_place(s, body.address, body)
    read_motion(s, body.address, body)
    body.mobile = 1 if body.inverse_mass > 0.0 or body.inverse_moment > 0.0 else 0
    body.kind = DRIFTS
    body.old_x = body.x
    body.old_y = body.y
    body.old_a = body.angle
    body.old_vx = body.vx
    body.old_vy = body.vy
    body.old_w = body.w
    body.old_fx = 0.0  # a force would have woken it before
    body.old_fy = 0.0
    body.old_torque = 0.0
    body.since = 0.0
    body.old_since = 0.0
    body.was_calm = 0
    if not body.awake:
        add_to_awake(tables, i, body)
        _list_shapes(s, tables, body, True)


@kernel
def put_to_rest(s: Any, body: Any) -> None:
    """A body that is asleep, or static: where it has been left, and nothing moves it."""
    body.awake = 0
    body.kind = FIXED
    read_motion(s, body.address, body)
    body.mobile = 1 if body.inverse_mass > 0.0 or body.inverse_moment > 0.0 else 0
    body.inverse_mass = 0.0
    body.inverse_moment = 0.0
    body.gain_x = 0.0
    body.gain_y = 0.0
    body.gain_w = 0.0
    body.kick_x = 0.0
    body.kick_y = 0.0
    body.kick_w = 0.0
    body.load = math.inf


@kernel(forceinline=True)
def _take_back(body: Any, dt: float) -> None:
    """Undo Chipmunk's own drift."""
    body.x -= dt * body.vx
    body.y -= dt * body.vy
    body.angle -= dt * body.w
    place(body)


@kernel(forceinline=True)
def listened(s: Any) -> bool:
    """Whether callbacks of the user's may be asked about any shape."""
    return bool(s.heard_all != 0 or s.heard_alone_n > 0 or s.heard_pairs_n > 0)


@kernel
def _last(s: Any, tables: Tables, dt: float) -> None:
    """What touches still, but for a hair: Chipmunk does not take it for separated in this step."""
    for k in range(tables.counters[BOXED]):
        pair = tables.pairs[tables.near[k].pair]
        if pair.a >= 0 and pair.arbiter != 0 and lasts(load_pool(s), tables, load_work(s), pair, s.frame, dt):
            pair.lasting = s.frame
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
    s.broken = -1
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
    if not _watch(s, load_tables(s), space, dt):  # somebody came on a way of which pymunk has not told
        s.pending = 2
        if not ask(s, REGISTER) or not _watch(s, load_tables(s), space, dt):
            return False
    look_at_partners(s, load_tables(s))
    if listened(s):
        _last(s, load_tables(s), dt)
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
        _look_at_jointed(s, tables)
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
    pair.stamp = now
    if pair.waiting >= tables.counters[COUNTED]:  # frames between have failed
        pair.waiting = now - 1
    pair.arbiter = arbiter
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
