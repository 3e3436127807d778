"""Joints within a substep: what they start from, and their own functions on the velocities of the solve."""

from __future__ import annotations

from typing import Any

from ..kernel.jit import kernel
from ..kernel.solve import usable
from ..kernel.tables import TURN, Tables
from .joints import APPLY_CACHED, PRE_STEP, is_spring, joints_of, run, scale_impulse
from .record import floats


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
def _read_velocity(s: Any, body: Any) -> None:
    v = floats(body.address + s.body_velocity, 2)
    body.vx = v[0]
    body.vy = v[1]
    body.w = floats(body.address + s.body_spin, 1)[0]


@kernel(forceinline=True)
def _hand_over(s: Any, tables: Tables, joint: Any) -> None:
    """Give a joint's bodies the velocities of the solve."""
    if joint.a >= 0:
        write_motion(s, tables.bodies[joint.a])
    if joint.b >= 0:
        write_motion(s, tables.bodies[joint.b])


@kernel(forceinline=True)
def _take_over(s: Any, tables: Tables, joint: Any) -> None:
    """What joints have made of them."""
    if joint.a >= 0:
        _read_velocity(s, tables.bodies[joint.a])
    if joint.b >= 0:
        _read_velocity(s, tables.bodies[joint.b])


@kernel
def run_joints(s: Any, tables: Tables, which: int, x: float) -> None:
    """One function of each of the turn's joints, in their order, on the velocities of the solve."""
    for joint in joints_of(s):
        if joint.mine:
            _hand_over(s, tables, joint)
    for joint in joints_of(s):
        if joint.mine:
            run(joint, which, x)
    for joint in joints_of(s):
        if joint.mine:
            _take_over(s, tables, joint)


@kernel(forceinline=True)
def _substeps_of(tables: Tables, joint: Any) -> int:
    """The substeps in which a joint is solved: those of what it moves."""
    n = 0
    for i in (joint.a, joint.b):
        if i >= 0:
            n = max(n, tables.bodies[i].steps)
    return int(n)


@kernel
def own_joints(s: Any, tables: Tables) -> int:
    """Which joints belong to the present turn: how many."""
    turn = tables.counters[TURN]
    count = 0
    for joint in joints_of(s):
        joint.mine = 0
        if joint.taken and (turn == 0 or _substeps_of(tables, joint) == turn):
            joint.mine = 1
            count += 1
    return count


@kernel
def start_joints(s: Any, tables: Tables, h: float, n: int) -> None:
    """The joints as they are where the bodies are now, and what they did last.

    n: in the first of n substeps; 0: in another. What they did in the last frame is kept as its sum.
    """
    for joint in joints_of(s):
        if joint.mine:
            if joint.a >= 0:
                write_place(s, tables.bodies[joint.a])
            if joint.b >= 0:
                write_place(s, tables.bodies[joint.b])
            if n > 0:
                scale_impulse(joint, 1.0 / n)
    run_joints(s, tables, PRE_STEP, h)


@kernel
def lessen_joints(s: Any, tables: Tables, h: float) -> None:
    """Of what joints begin with, only what is usable."""
    for joint in joints_of(s):
        if joint.mine and not is_spring(s, joint):
            part = 1.0
            for i in (joint.a, joint.b):
                if i >= 0:
                    part = min(part, usable(tables.bodies[i], h))
            if part < 1.0:
                _hand_over(s, tables, joint)
                run(joint, APPLY_CACHED, part - 1.0)
                _take_over(s, tables, joint)
                scale_impulse(joint, part)
