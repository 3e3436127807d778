"""The pre-solve hook: where Chipmunk's collision response is replaced by the area force. Machine code and plain Python.

Chipmunk calls the global handler's pre_solve last, after positions are integrated and before velocities are: a force
set there acts in the same step, which is symplectic Euler, with joints solved after it (design 2.6). The hook

1. looks up the two outlines,
2. lets `pair.pair_pull` find the regions and their force,
3. adds the force to the two bodies,
4. takes the arbiter's contact points away (count = 0). Chipmunk's solver then has nothing to solve, while the
   arbiter itself stays: sleeping islands, waking, post_solve and separate go on as ever. process_collision is left
   to the user: where a begin or pre_solve of theirs said no, there is no force either.

`python_pre_solve` is the readable statement of this; `pre_solve` is the same in machine code. Both call the same
kernel. What machine code cannot do (meet a new shape, enlarge a table, report an error) it asks Python for, through
pymunk's own trampoline, and then goes on.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import pymunk
from numba import types

from .chipmunk import register_symbols
from .force import Motion
from .jit import callback, kernel
from .memory import array_at
from .pair import (
    DONE,
    FREE_PAIRS,
    GROW_REGIONS,
    GROW_WORK,
    NOT_FINITE,
    Pose,
    Surface,
    end_pair,
    new_pair,
    pair_pull,
)
from .store import STATE, Store, load_law, load_pool, load_tables, load_work

if TYPE_CHECKING:
    from pymunk import Arbiter

#: Requests of machine code to Python.
NOTHING, NEW_SHAPE, NEW_PAIR, MORE_WORK, MORE_REGIONS, BAD_STATE = range(6)

_HALF = np.uint64(32)
_LOWER = np.uint64(0xFFFFFFFF)

register_symbols()
_user_data = types.ExternalFunction("rigidarea_cpSpaceGetUserData", types.uintp(types.uintp))
_timestamp = types.ExternalFunction("rigidarea_cpSpaceGetTimestamp", types.uint32(types.uintp))
_time_step = types.ExternalFunction("rigidarea_cpSpaceGetCurrentTimeStep", types.float64(types.uintp))
_hash_id = types.ExternalFunction("rigidarea_cpShapeGetHashID", types.uintp(types.uintp))
_sensor = types.ExternalFunction("rigidarea_cpShapeGetSensor", types.uint8(types.uintp))
_ask_python = types.ExternalFunction(
    "rigidarea_ext_cpCollisionPreSolveFunc", types.void(types.uintp, types.uintp, types.uintp)
)


@kernel(inline="always")
def _floats(address: int, n: int) -> np.ndarray:
    return array_at(address, (n,), np.float64)


@kernel(inline="always")
def _address(address: int) -> int:
    return array_at(address, (1,), np.uint64)[0]


@kernel(inline="always")
def _row(s: Any, shape: int) -> int:
    """The shape's row in the tables; -1: not known."""
    ident = _hash_id(shape)
    if ident >= s.slots_n:
        return -1
    return array_at(s.slots_at, (s.slots_n,), np.int32)[ident]


@kernel(inline="always")
def _motion(s: Any, body: int) -> Motion:
    p = _floats(body + s.body_position, 2)
    v = _floats(body + s.body_velocity, 2)
    return Motion(
        p[0],
        p[1],
        v[0],
        v[1],
        _floats(body + s.body_spin, 1)[0],
        _floats(body + s.body_inverse_mass, 1)[0],
        _floats(body + s.body_inverse_moment, 1)[0],
    )


@kernel(inline="always")
def _pose(s: Any, body: int) -> Pose:
    t = _floats(body + s.body_transform, 6)
    return Pose(t[4], t[5], t[0], t[1])


@kernel(inline="always")
def surface_velocity(
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


@callback(types.void(types.uintp, types.uintp, types.uintp))
def pre_solve(arbiter: int, space: int, data: int) -> None:
    """One touching pair of one step, in machine code. See the module's docstring."""
    at = _user_data(space)
    if at == 0:
        return
    s = array_at(at, (1,), STATE)[0]
    if array_at(arbiter + s.arbiter_process, (1,), np.uint8)[0] == 0:
        return
    shape_a = _address(arbiter + s.arbiter_shape_a)
    shape_b = _address(arbiter + s.arbiter_shape_a + 8)
    body_a = _address(arbiter + s.arbiter_body_a)
    body_b = _address(arbiter + s.arbiter_body_a + 8)
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
    count = array_at(arbiter + s.arbiter_count, (1,), np.int32)
    count[0] = 0

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

    normal = _floats(arbiter + s.arbiter_normal, 2)
    given = _floats(arbiter + s.arbiter_surface, 2)
    va = _floats(shape_a + s.shape_surface_velocity, 2)
    vb = _floats(shape_b + s.shape_surface_velocity, 2)
    vx, vy = surface_velocity(
        va[0], va[1], vb[0], vb[1], normal[0], normal[1], sign * given[0], sign * given[1]
    )
    surface = Surface(
        _floats(arbiter + s.arbiter_friction, 1)[0], _floats(arbiter + s.arbiter_elasticity, 1)[0], vx, vy
    )
    dt = _time_step(space)
    stamp = np.int64(_timestamp(space))
    while True:
        tables = load_tables(s)
        tables.shapes[sa].inverse_mass = a.inverse_mass
        tables.shapes[sa].inverse_moment = a.inverse_moment
        tables.shapes[sb].inverse_mass = b.inverse_mass
        tables.shapes[sb].inverse_moment = b.inverse_moment
        status, pull = pair_pull(
            load_pool(s), tables, load_work(s), load_law(s), p, sa, sb, _pose(s, body_a), _pose(s, body_b),
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
    if a.inverse_mass > 0.0:
        f = _floats(body_a + s.body_force, 2)
        f[0] -= pull.fx
        f[1] -= pull.fy
        _floats(body_a + s.body_torque, 1)[0] += pull.moment_a
    if b.inverse_mass > 0.0:
        f = _floats(body_b + s.body_force, 2)
        f[0] += pull.fx
        f[1] += pull.fy
        _floats(body_b + s.body_torque, 1)[0] += pull.moment_b


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


# --- the same in Python ---


def pair_of_shapes(arbiter: Arbiter) -> tuple[pymunk.Shape, pymunk.Shape]:
    """A and B: the shape that was added first is A. (Chipmunk may exchange the two from step to step.)"""
    a = pymunk.Shape._from_cp_shape(arbiter._arbiter.a)
    b = pymunk.Shape._from_cp_shape(arbiter._arbiter.b)
    assert a is not None and b is not None
    return (a, b) if a._hashid < b._hashid else (b, a)


def _python_motion(body: pymunk.Body) -> Motion:
    dynamic = body.body_type == pymunk.Body.DYNAMIC
    x, y = body.local_to_world(body.center_of_gravity)
    return Motion(
        x,
        y,
        *body.velocity,
        body.angular_velocity,
        1.0 / body.mass if dynamic else 0.0,
        1.0 / body.moment if dynamic and math.isfinite(body.moment) else 0.0,
    )


def _python_pose(body: pymunk.Body) -> Pose:
    return Pose(*body.position, *body.rotation_vector)


def python_pre_solve(
    arbiter: Arbiter, space: pymunk.Space, store: Store, pair_of: Any, ask: Any
) -> None:
    """What `pre_solve` does, one statement a fact.

    pair_of(arbiter): the pair's number in the tables. ask(request, arbiter): what machine code asks Python for.
    Two differences: a force set through pymunk wakes a sleeping body, so bodies in contact never fall asleep; and
    it costs 30 times as much.
    """
    a, b = pair_of_shapes(arbiter)
    assert a.body is not None and b.body is not None
    if not arbiter.process_collision or a.sensor or b.sensor:
        return
    if pymunk.Body.DYNAMIC not in (a.body.body_type, b.body.body_type):
        return
    arbiter._arbiter.count = 0  # nothing for Chipmunk's solver
    if not (store.knows(a._hashid) and store.knows(b._hashid)):
        ask(NEW_SHAPE, arbiter)
    p = pair_of(arbiter)
    n = arbiter._arbiter.n
    given = arbiter._arbiter.surface_vr
    sign = 1.0 if arbiter._arbiter.a == a._shape else -1.0
    surface = Surface(
        arbiter.friction,
        arbiter.restitution,
        *surface_velocity(*a.surface_velocity, *b.surface_velocity, n.x, n.y, sign * given.x, sign * given.y),
    )
    stamp = pymunk._chipmunk_cffi.lib.cpSpaceGetTimestamp(space._space)
    motion_a, motion_b = _python_motion(a.body), _python_motion(b.body)
    rows = int(store.slots[a._hashid]), int(store.slots[b._hashid])
    for row, motion in zip(rows, (motion_a, motion_b)):
        store.tables.shapes[row]["inverse_mass"] = motion.inverse_mass
        store.tables.shapes[row]["inverse_moment"] = motion.inverse_moment
    while True:
        status, pull = pair_pull(
            store.pool, store.tables, store.work, load_law(store.state[0]), p, *rows,
            _python_pose(a.body), _python_pose(b.body), motion_a, motion_b,
            surface, space.current_time_step, stamp,
        )  # fmt: skip
        if status == DONE:
            break
        ask({GROW_WORK: MORE_WORK, GROW_REGIONS: MORE_REGIONS, NOT_FINITE: BAD_STATE}[status], arbiter)
        if status == NOT_FINITE:
            return
    for body, sign, moment in ((a.body, -1.0, pull.moment_a), (b.body, 1.0, pull.moment_b)):
        if body.body_type == pymunk.Body.DYNAMIC:
            body.force += pymunk.Vec2d(sign * pull.fx, sign * pull.fy)
            body.torque += moment
