"""A run of frames in machine code: how each is cut into steps, and what makes the cut exact.

Chipmunk's step moves positions by the old velocities, then velocities by the forces at the new positions: symplectic
Euler, first order. Begun half a step back and ended half a step on, the same step is the leapfrog: drift half, kick,
drift half; second order, exact in free fall, and nothing has to be remembered between frames, since a drift needs
nothing but velocities (Hairer, Lubich, Wanner, Acta Numerica 12 (2003), doi:10.1017/S0962492902000144).

So the steps of a frame need not be equal either. Steps are fine where bodies touch, and on a common grid; where
nothing touches, and for as long as nothing can, one long step takes the place of many.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import types

from .chipmunk import register_symbols
from .kernel.clearance import clearance, time_to_cover
from .kernel.jit import callback, kernel
from .kernel.memory import array_at
from .kernel.place import seen_from
from .kernel.pool import Pool
from .kernel.tables import Tables
from .kernel.work import Work
from .machine import floats, pose_of, word
from .stepping import highest_frequency
from .store import STATE, load_law, load_pool, load_tables, load_work

#: Chipmunk's kinds of bodies (enum cpBodyType).
_DYNAMIC, _STATIC = 0, 2
#: More shapes than this are not looked at pair by pair to see whether steps may be long.
MOST_SHAPES = 64
#: Looking at one pair costs as much as so many steps of two bodies, at the most.
STEPS_A_PAIR = 6
#: Steps until it is looked again, after it was too close to pay: doubled each time up to this.
MOST_PATIENCE = 16

register_symbols()
_user_data = types.ExternalFunction("rigidarea_cpSpaceGetUserData", types.uintp(types.uintp))
_timestamp = types.ExternalFunction("rigidarea_cpSpaceGetTimestamp", types.uint32(types.uintp))
_step = types.ExternalFunction("rigidarea_cpSpaceStep", types.void(types.uintp, types.float64))
_each_body = types.ExternalFunction(
    "rigidarea_cpSpaceEachBody", types.void(types.uintp, types.uintp, types.uintp)
)
_body_type = types.ExternalFunction("rigidarea_cpBodyGetType", types.int32(types.uintp))
_sleeping = types.ExternalFunction("rigidarea_cpBodyIsSleeping", types.uint8(types.uintp))
_body_of = types.ExternalFunction("rigidarea_cpShapeGetBody", types.uintp(types.uintp))
_reindex = types.ExternalFunction("rigidarea_cpSpaceReindexShape", types.void(types.uintp, types.uintp))


@callback(types.void(types.uintp, types.uintp))
def shift_body(body: int, at: int) -> None:
    """Drift one body by the time `shift` (Chipmunk's iterator calls it); its transform only where it settles."""
    s = array_at(at, (1,), STATE)[0]
    if _body_type(body) == _STATIC or _sleeping(body):
        return
    v = floats(body + s.body_velocity, 2)
    w = floats(body + s.body_spin, 1)
    p = floats(body + s.body_position, 2)
    angle = floats(body + s.body_angle, 1)
    if s.settle and not math.isfinite(p[0] + p[1] + angle[0] + v[0] + v[1] + w[0]):
        s.broken = 1
    if word(body + s.body_position_func) != s.position_func:
        return
    if not s.settle:
        p[0] += s.shift * v[0]
        p[1] += s.shift * v[1]
        angle[0] += s.shift * w[0]
        return
    t = floats(body + s.body_transform, 6)
    ux = p[0] - t[4]
    uy = p[1] - t[5]
    cog_x = t[0] * ux + t[1] * uy  # centre of gravity, body frame
    cog_y = t[0] * uy - t[1] * ux
    p[0] += s.shift * v[0]
    p[1] += s.shift * v[1]
    angle[0] += s.shift * w[0]
    c = math.cos(angle[0])
    n = math.sin(angle[0])
    t[0] = c
    t[1] = n
    t[2] = -n
    t[3] = c
    t[4] = p[0] - (c * cog_x - n * cog_y)
    t[5] = p[1] - (n * cog_x + c * cog_y)


@kernel(inline="always")
def _shift(space: int, s: Any, at: int, time: float, settle: bool) -> None:
    if time != 0.0:
        s.shift = time
        s.settle = settle
        _each_body(space, s.shift_at, at)


@kernel
def free_time(
    s: Any, pool: Pool, tables: Tables, work: Work, shapes: int, gravity: float, most: float
) -> float:
    """Time for which no two shapes can touch, `most` if it is longer; 0 where something but gravity acts on a body."""
    for i in range(shapes):
        if tables.shapes[i].outline < 0:
            continue
        body = _body_of(tables.shapes[i].address)
        if _body_type(body) != _DYNAMIC:
            continue
        f = floats(body + s.body_force, 2)
        own = word(body + s.body_velocity_func) == s.velocity_func
        own = own and word(body + s.body_position_func) == s.position_func
        if not own or f[0] != 0.0 or f[1] != 0.0 or floats(body + s.body_torque, 1)[0] != 0.0:
            return 0.0
    for i in range(shapes):
        a = tables.shapes[i]
        if a.outline < 0:
            continue
        body_a = _body_of(a.address)
        kind_a = _body_type(body_a)
        pose_a = pose_of(s, body_a)
        va = floats(body_a + s.body_velocity, 2)
        ha = pool.heads[a.outline]
        for j in range(i):
            b = tables.shapes[j]
            if b.outline < 0 or a.body == b.body:
                continue
            body_b = _body_of(b.address)
            kind_b = _body_type(body_b)
            if kind_a != _DYNAMIC and kind_b != _DYNAMIC:
                continue
            pose_b = pose_of(s, body_b)
            vb = floats(body_b + s.body_velocity, 2)
            hb = pool.heads[b.outline]
            # no point of one approaches the other faster than this
            speed = (
                math.hypot(va[0] - vb[0], va[1] - vb[1])
                + abs(floats(body_a + s.body_spin, 1)[0]) * _reach(s, body_a, pose_a, ha)
                + abs(floats(body_b + s.body_spin, 1)[0]) * _reach(s, body_b, pose_b, hb)
            )
            pull = gravity if (kind_a == _DYNAMIC) != (kind_b == _DYNAMIC) else 0.0
            x = pose_a.c * ha.x - pose_a.s * ha.y + pose_a.x - (pose_b.c * hb.x - pose_b.s * hb.y + pose_b.x)
            y = pose_a.s * ha.x + pose_a.c * ha.y + pose_a.y - (pose_b.s * hb.x + pose_b.c * hb.y + pose_b.y)
            apart = math.hypot(x, y) - ha.radius - hb.radius
            if apart > 0.0 and time_to_cover(apart, speed, pull) >= most:
                continue
            far = most * (speed + 0.5 * pull * most)
            rel = seen_from(ha, pose_a, hb, pose_b)
            apart = clearance(pool, a.outline, pool, b.outline, rel, far, work)
            if apart < far:
                most = min(most, time_to_cover(apart, speed, pull))
    return most


@kernel(inline="always")
def _reach(s: Any, body: int, pose: Any, head: Any) -> float:
    """Largest distance of a shape's points from its body's centre of gravity, or more."""
    p = floats(body + s.body_position, 2)
    x = pose.c * head.x - pose.s * head.y + pose.x - p[0]
    y = pose.s * head.x + pose.c * head.y + pose.y - p[1]
    return math.hypot(x, y) + head.radius


@kernel
def planned_steps(s: Any, shapes: int, stamp: int, dt: float) -> int:
    """Fine steps of a frame dt: as many as its stiffest contact asks for, `max_steps` at the most."""
    frequency = highest_frequency(load_pool(s), load_tables(s), shapes, load_law(s), stamp)
    n = max(1.0, math.ceil(dt * frequency / s.phase))
    if n > s.max_steps:
        s.wanted = np.int64(min(n, 1e15))
        return int(s.max_steps)
    return int(n)


@callback(types.int64(types.uintp, types.float64, types.int64, types.int64, types.int64))
def advance(space: int, dt: float, frames: int, steps: int, shapes: int) -> int:
    """`frames` frames of length dt, of `steps` steps (0: as planned); returns how many steps were taken."""
    at = _user_data(space)
    s = array_at(at, (1,), STATE)[0]
    g = floats(space + s.space_gravity, 2)
    gravity = math.hypot(g[0], g[1])
    total = 0
    for _ in range(frames):
        behind = 0.0  # time by which positions are behind
        left = steps
        if steps == 0:
            left = planned_steps(s, shapes, np.int64(_timestamp(space)), dt)
        fine = dt / left
        patience = 1
        wait = 0
        while left > 0 and s.stop == 0:
            taken = 1
            stamp = np.int64(_timestamp(space))
            worth = s.ballistic and shapes <= MOST_SHAPES and left > STEPS_A_PAIR * (shapes - 1) // 2
            if worth and wait == 0 and s.touched != stamp:
                most = left * fine + behind
                free = free_time(s, load_pool(s), load_tables(s), load_work(s), shapes, gravity, most)
                taken = int(min(float(left), max(1.0, (free - behind) / fine)))
                patience = 1 if taken > 1 else min(2 * patience, MOST_PATIENCE)
                wait = patience
            wait = max(0, wait - 1)
            h = taken * fine
            _shift(space, s, at, behind - 0.5 * h, False)
            _step(space, h)
            behind = 0.5 * h
            left -= taken
            total += 1
        _shift(space, s, at, behind, True)
        if s.stop != 0:
            break
    tables = load_tables(s)
    for i in range(shapes):
        if tables.shapes[i].outline >= 0:
            body = _body_of(tables.shapes[i].address)
            if _body_type(body) != _STATIC and not _sleeping(body):
                _reindex(space, tables.shapes[i].address)
    return total
