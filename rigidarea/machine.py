"""The pre-solve hook in machine code: what `hook.pre_solve` does, without Python.

Importing this module compiles it (or loads it from the cache). Memory is read and written by address: Chipmunk's
structs at the offsets of `chipmunk.layout`, our tables through the `store.STATE` record that is the space's user
data. What machine code cannot do (meet a new shape, enlarge a table, report an error) it asks Python for, through
pymunk's own trampoline, and then goes on.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import types

from .chipmunk import register_symbols
from .hook import BAD_STATE, MORE_REGIONS, MORE_WORK, NEW_PAIR, NEW_SHAPE, NOTHING, surface_velocity
from .kernel.crowd import expected, meet_body, put_in, remember_pull, take_out
from .kernel.jit import callback, kernel
from .kernel.memory import array_at
from .kernel.pair import DONE, GROW_WORK, NOT_FINITE, Surface, pair_pull
from .kernel.place import Pose
from .kernel.region import Motion
from .kernel.tables import FREE_PAIRS, end_pair, new_pair
from .store import STATE, load_law, load_pool, load_tables, load_work

#: Chipmunk's states of an arbiter (enum cpArbiterState).
_NORMAL, _IGNORE = 1, 2
_HALF = np.uint64(32)
_LOWER = np.uint64(0xFFFFFFFF)

register_symbols()
_user_data = types.ExternalFunction("rigidarea_cpSpaceGetUserData", types.uintp(types.uintp))
_sleep_time = types.ExternalFunction("rigidarea_cpSpaceGetSleepTimeThreshold", types.float64(types.uintp))
_timestamp = types.ExternalFunction("rigidarea_cpSpaceGetTimestamp", types.uint32(types.uintp))
_time_step = types.ExternalFunction("rigidarea_cpSpaceGetCurrentTimeStep", types.float64(types.uintp))
_hash_id = types.ExternalFunction("rigidarea_cpShapeGetHashID", types.uintp(types.uintp))
_sensor = types.ExternalFunction("rigidarea_cpShapeGetSensor", types.uint8(types.uintp))
_ask_python = types.ExternalFunction(
    "rigidarea_ext_cpCollisionPreSolveFunc", types.void(types.uintp, types.uintp, types.uintp)
)


@kernel(inline="always")
def floats(address: int, n: int) -> np.ndarray:
    """n floats of Chipmunk's memory."""
    return array_at(address, (n,), np.float64)


@kernel(inline="always")
def word(place: int) -> int:
    """A pointer in Chipmunk's memory."""
    return array_at(place, (1,), np.uint64)[0]


@kernel(inline="always")
def _row(s: Any, shape: int) -> int:
    """The shape's row in the tables; -1: not known."""
    ident = _hash_id(shape)
    if ident >= s.slots_n:
        return -1
    return array_at(s.slots_at, (s.slots_n,), np.int32)[ident]


@kernel(inline="always")
def _motion(s: Any, body: int) -> Motion:
    p = floats(body + s.body_position, 2)
    v = floats(body + s.body_velocity, 2)
    return Motion(
        p[0],
        p[1],
        v[0],
        v[1],
        floats(body + s.body_spin, 1)[0],
        floats(body + s.body_inverse_mass, 1)[0],
        floats(body + s.body_inverse_moment, 1)[0],
        0.0,
        0.0,
        0.0,
    )


@kernel(inline="always")
def pose_of(s: Any, body: int) -> Pose:
    """Where a body is."""
    t = floats(body + s.body_transform, 6)
    return Pose(t[4], t[5], t[0], t[1])


@kernel(inline="always")
def _meet(s: Any, body: int, row: Any, stamp: int) -> None:
    """The step's first look at a body.

    Chipmunk puts a body to sleep between the hook and the step's velocities, with the accumulators full: what is
    still there, unchanged, when the body is met again would push it twice.
    """
    if row.stamp != stamp:
        f = floats(body + s.body_force, 2)
        t = floats(body + s.body_torque, 1)
        if f[0] == row.force_x and f[1] == row.force_y and t[0] == row.torque:
            f[0] = 0.0
            f[1] = 0.0
            t[0] = 0.0
        meet_body(row, stamp)


@kernel(inline="always")
def _expected(s: Any, space: int, body: int, row: Any, m: Motion) -> Motion:
    if m.inverse_mass == 0.0:
        return m
    g = floats(space + s.space_gravity, 2)
    f = floats(body + s.body_force, 2)
    return expected(m, row, g[0], g[1], f[0], f[1], floats(body + s.body_torque, 1)[0])


@kernel(inline="always")
def _push(s: Any, body: int, row: Any, fx: float, fy: float, moment: float) -> None:
    """Add to the body's accumulators."""
    f = floats(body + s.body_force, 2)
    t = floats(body + s.body_torque, 1)
    f[0] += fx
    f[1] += fy
    t[0] += moment
    row.force_x = f[0]
    row.force_y = f[1]
    row.torque = t[0]
    put_in(row, fx, fy, moment)


@kernel(inline="always")
def _post_solves(s: Any, handler: int) -> bool:
    function = word(handler + s.handler_post_solve)
    return function != s.no_post_solve and function != s.unset_post_solve


@kernel(inline="always")
def _silence(s: Any, arbiter: int, space: int) -> None:
    """Leave Chipmunk's solver nothing to do for this arbiter.

    Where nobody would miss it (no sleeping, so no islands; no post_solve) the arbiter is left out of the step
    altogether, which saves a tenth of it. Else it stays, without contact points.
    """
    state = array_at(arbiter + s.arbiter_state, (1,), np.int32)
    missed = _sleep_time(space) < np.inf or _post_solves(s, s.global_handler)
    for i in range(4):
        missed = missed or _post_solves(s, word(arbiter + s.arbiter_handlers + 8 * i))
    if missed:
        array_at(arbiter + s.arbiter_count, (1,), np.int32)[0] = 0
        if state[0] == _IGNORE:
            state[0] = _NORMAL
    else:
        state[0] = _IGNORE


@callback(types.void(types.uintp, types.uintp, types.uintp))
def pre_solve(arbiter: int, space: int, data: int) -> None:
    """One touching pair of one step, in machine code. See the module's docstring."""
    at = _user_data(space)
    if at == 0:
        return
    s = array_at(at, (1,), STATE)[0]
    if array_at(arbiter + s.arbiter_process, (1,), np.uint8)[0] == 0:
        return
    shape_a = word(arbiter + s.arbiter_shape_a)
    shape_b = word(arbiter + s.arbiter_shape_a + 8)
    body_a = word(arbiter + s.arbiter_body_a)
    body_b = word(arbiter + s.arbiter_body_a + 8)
    sign = 1.0
    if _hash_id(shape_a) > _hash_id(shape_b):  # Chipmunk may exchange the two from step to step
        shape_a, shape_b = shape_b, shape_a
        body_a, body_b = body_b, body_a
        sign = -1.0
    if _sensor(shape_a) or _sensor(shape_b):
        return
    a = _motion(s, body_a)
    b = _motion(s, body_b)
    if a.inverse_mass == 0.0 and b.inverse_mass == 0.0:
        return
    _silence(s, arbiter, space)

    sa = _row(s, shape_a)
    sb = _row(s, shape_b)
    if sa < 0 or sb < 0:
        s.request = NEW_SHAPE
        _ask_python(arbiter, space, data)
        sa = _row(s, shape_a)
        sb = _row(s, shape_b)
        if sa < 0 or sb < 0:
            return  # Python keeps the error and raises it after the step
    memory = array_at(arbiter + s.arbiter_data, (1,), np.uint64)
    if memory[0] >> _HALF != s.epoch:
        if s.restoring or load_tables(s).counters[FREE_PAIRS] == 0:
            s.request = NEW_PAIR
            _ask_python(arbiter, space, data)
        if memory[0] >> _HALF != s.epoch:
            p = new_pair(load_tables(s), np.int64(_hash_id(shape_a)), np.int64(_hash_id(shape_b)))
            if p < 0:
                return
            memory[0] = (s.epoch << _HALF) | np.uint64(p)
    p = np.int64(memory[0] & _LOWER)

    normal = floats(arbiter + s.arbiter_normal, 2)
    given = floats(arbiter + s.arbiter_surface, 2)
    va = floats(shape_a + s.shape_surface_velocity, 2)
    vb = floats(shape_b + s.shape_surface_velocity, 2)
    vx, vy = surface_velocity(
        va[0], va[1], vb[0], vb[1], normal[0], normal[1], sign * given[0], sign * given[1]
    )
    surface = Surface(
        floats(arbiter + s.arbiter_friction, 1)[0], floats(arbiter + s.arbiter_elasticity, 1)[0], vx, vy
    )
    dt = _time_step(space)
    stamp = np.int64(_timestamp(space))
    tables = load_tables(s)
    row_a = tables.bodies[tables.shapes[sa].body]
    row_b = tables.bodies[tables.shapes[sb].body]
    _meet(s, body_a, row_a, stamp)
    _meet(s, body_b, row_b, stamp)
    pair = tables.pairs[p]
    if pair.stamp == stamp - 1:
        take_out(row_a, -pair.fx, -pair.fy, pair.moment_a)
        take_out(row_b, pair.fx, pair.fy, pair.moment_b)
    a = _expected(s, space, body_a, row_a, a)
    b = _expected(s, space, body_b, row_b, b)
    while True:
        tables = load_tables(s)
        tables.shapes[sa].inverse_mass = a.inverse_mass
        tables.shapes[sa].inverse_moment = a.inverse_moment
        tables.shapes[sb].inverse_mass = b.inverse_mass
        tables.shapes[sb].inverse_moment = b.inverse_moment
        status, pull = pair_pull(
            load_pool(s), tables, load_work(s), load_law(s), p, sa, sb, pose_of(s, body_a), pose_of(s, body_b),
            a, b, surface, dt, stamp,
        )  # fmt: skip
        if status == DONE:
            break
        if status == NOT_FINITE:
            s.request = BAD_STATE
            _ask_python(arbiter, space, data)
            return
        s.request = MORE_WORK if status == GROW_WORK else MORE_REGIONS
        _ask_python(arbiter, space, data)
        if s.request != NOTHING:
            return  # Python could not: it keeps the error
    tables = load_tables(s)
    remember_pull(tables.pairs[p], pull, stamp)
    if tables.pairs[p].head >= 0:
        s.touched = stamp
    if a.inverse_mass > 0.0:
        _push(s, body_a, tables.bodies[tables.shapes[sa].body], -pull.fx, -pull.fy, pull.moment_a)
    if b.inverse_mass > 0.0:
        _push(s, body_b, tables.bodies[tables.shapes[sb].body], pull.fx, pull.fy, pull.moment_b)


@callback(types.void(types.uintp, types.uintp, types.uintp))
def separate(arbiter: int, space: int, data: int) -> None:
    """Two shapes have separated, or one was removed: forget what their contact remembered."""
    at = _user_data(space)
    if at == 0:
        return
    s = array_at(at, (1,), STATE)[0]
    memory = array_at(arbiter + s.arbiter_data, (1,), np.uint64)
    if memory[0] >> _HALF == s.epoch:
        end_pair(load_tables(s), np.int64(memory[0] & _LOWER))
    memory[0] = 0
