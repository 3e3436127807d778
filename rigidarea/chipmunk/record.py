"""Bodies and shapes of Chipmunk's memory, read into the tables' records and written back; and asking Python.

Everything here is machine code, called by Chipmunk (or interpreted, with NUMBA_DISABLE_JIT=1: the same lines).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..compile.jit import kernel
from ..compile.raw_memory import array_at, caller
from ..contact.space_record import STATE
from ..contact.tables import BOXED, KNOWN, UNSORTED, Tables
from ..geometry.place import place, shift
from .structs import function

#: What machine code asks Python for: all of it before a frame has changed anything, or when it has ended.
REGISTER, GROW, BROKEN, NORMAL = range(4)

user_data = function("cpSpaceGetUserData", "uintp(uintp)")
timestamp = function("cpSpaceGetTimestamp", "uint32(uintp)")
time_step = function("cpSpaceGetCurrentTimeStep", "float64(uintp)")
space_of = function("cpBodyGetSpace", "uintp(uintp)")
body_type = function("cpBodyGetType", "int32(uintp)")
_cache_box = function("cpShapeCacheBB", "void(uintp, uintp)")
_call_ask = caller("void(uintp)")


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


@kernel
def cache_boxes(s: Any, body: Any) -> None:
    """Have Chipmunk's queries find the body's shapes where it is."""
    shape = words(body.address + s.body_shapes, 1)[0]
    while shape != 0:
        _cache_box(s.scratch_at, shape)
        shape = words(shape + s.shape_next, 1)[0]


@kernel(forceinline=True)
def write_motion(s: Any, body: Any) -> None:
    """Give it its velocity."""
    v = floats(body.address + s.body_velocity, 2)
    v[0] = body.vx
    v[1] = body.vy
    floats(body.address + s.body_spin, 1)[0] = body.w


@kernel(forceinline=True)
def write_bias(s: Any, body: Any, dt: float) -> None:
    """Have its position function move it, in the next step, as far as contacts ask: Chipmunk's v_bias and w_bias.

    They stand behind its transform and the user's pointer (struct cpBody). All substeps of the frame have asked for it,
    of the same overlap: a substep's share.
    """
    v = floats(body.address + s.body_transform + 56, 3)
    rate = 1.0 / (dt * max(1, s.taken))
    v[0] = rate * body.put_x
    v[1] = rate * body.put_y
    v[2] = rate * body.put_a


@kernel(forceinline=True)
def read_body(s: Any, address: int, body: Any) -> bool:
    """A body as it is now; whether its place or velocity is another. Another mass disturbs whoever it rests on."""
    x, y, angle = body.x, body.y, body.angle
    vx, vy, w = body.vx, body.vy, body.w
    mass, moment, cog_x, cog_y = body.inverse_mass, body.inverse_moment, body.cog_x, body.cog_y
    read_place(s, address, body)
    read_motion(s, address, body)
    same = mass == body.inverse_mass and moment == body.inverse_moment
    if not (same and cog_x == body.cog_x and cog_y == body.cog_y):
        body.disturbed = s.frame
    set_place = x != body.x or y != body.y or angle != body.angle
    return bool(set_place or vx != body.vx or vy != body.vy or w != body.w)


@kernel(forceinline=True)
def notice(s: Any, address: int, body: Any) -> None:
    """A body that is awake, as it is now, and whether it has been set so by the user."""
    if read_body(s, address, body) and body.stamp >= 0:
        body.since = 0.0


@kernel
def notice_again(s: Any, body: Any) -> None:
    """What callbacks of the user's have set of a body since the frame began: it counts as set before."""
    held = words(body.address + s.body_position_func, 1)[0] == s.hold_at
    if body.stamp == s.frame and held and read_body(s, body.address, body):
        body.since = 0.0
        body.old_since = 0.0
        body.old_x, body.old_y, body.old_a = body.x, body.y, body.angle
        body.old_vx, body.old_vy, body.old_w = body.vx, body.vy, body.w


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
def read_shape(s: Any, shape: Any, body: Any) -> bool:
    """What the user may set of a shape, as it is now. Whether it may collide with others than before."""
    shape.seen = s.frame
    material = floats(shape.address + s.shape_elasticity, 2)
    surface = floats(shape.address + s.shape_surface_velocity, 2)
    before = shape.elasticity, shape.friction, shape.surface_x, shape.surface_y
    shape.elasticity = material[0]
    shape.friction = material[1]
    shape.surface_x = surface[0]
    shape.surface_y = surface[1]
    if before != (shape.elasticity, shape.friction, shape.surface_x, shape.surface_y):
        body.disturbed = s.frame
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
    body.disturbed = s.frame
    shape.sensor = sensor
    shape.group = group
    shape.categories = masks[0]
    shape.mask = masks[1]
    return True


@kernel
def look_at_partners(s: Any, tables: Tables) -> None:
    """What the user may set of shapes that do not move, of those that somebody who is awake is near: of new pairs."""
    for n in range(tables.counters[KNOWN], tables.counters[BOXED]):
        pair = tables.pairs[tables.near[n].pair]
        if pair.a < 0:
            continue
        for i in (pair.a, pair.b):
            shape = tables.shapes[i]
            if shape.seen != s.frame:
                body = tables.bodies[shape.body]
                if read_shape(s, shape, body):
                    tables.counters[UNSORTED] = 1
                vx, vy, w = body.vx, body.vy, body.w
                _read_velocity(s, body.address, body)
                if vx != body.vx or vy != body.vy or w != body.w:
                    body.disturbed = s.frame
    tables.counters[KNOWN] = tables.counters[BOXED]
