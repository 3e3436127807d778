"""Joints are solved with the contacts, substep by substep: Chipmunk calls them once a frame, which would be too late.

For the length of a frame a joint is *taken*: the solve calls the functions of its class (a struct of four) with the
substep's time, and where Chipmunk would call them the joint has a class that does nothing. It has that one only
between two things that Chipmunk does on end, never while anything of the user's runs: pymunk's joints look at their
class before they answer anything, and end the process if it is another's (a spring's force function asks for its rest
length). So `seize`, after the user's pre_solve, hides the joint's class from Chipmunk's preparation, which gives it
back (`prepared`); `hide` does at the end of the solve, which is the first thing when Chipmunk starts its joints; and
`give_back` ends it before the first post_solve. A joint's impulse is then the frame's sum, so that one that is to
break at a force breaks at it.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import types

from ..chipmunk import function
from ..kernel.jit import callback, kernel
from ..kernel.memory import array_at, caller
from ..kernel.tables import APART, UNSORTED, Tables
from ..store import JOINT, KINDS, STATE, row_of_body

_user_data = function("cpSpaceGetUserData", types.uintp(types.uintp))
_call_user = caller(types.void(types.uintp, types.uintp))
_call = caller(types.void(types.uintp, types.float64))
_call_force = caller(types.float64(types.uintp, types.float64))

#: Places of a class's functions.
PRE_STEP, APPLY_CACHED, APPLY = 0, 1, 2


@kernel(inline="always")
def _words(address: int, n: int) -> np.ndarray:
    return array_at(address, (n,), np.uint64)


@kernel(inline="always")
def joints_of(s: Any) -> np.ndarray:
    """The joints of this frame: JOINT records."""
    return array_at(s.joints_at, (s.joint_count,), JOINT)


@callback(types.void(types.uintp, types.float64))
def idle(constraint: int, x: float) -> None:
    """A function of a joint that is taken."""


@callback(types.float64(types.uintp))
def no_impulse(constraint: int) -> float:
    """The impulse of a joint that is taken."""
    return 0.0


@kernel(forceinline=True)
def _joint_of(s: Any, constraint: int) -> int:
    joints = joints_of(s)
    for i in range(len(joints)):
        k = (s.joint_cursor + i) % len(joints)
        if joints[k].address == constraint:
            s.joint_cursor = k  # asked for once more, or its neighbour is next
            return k
    return -1


@callback(types.void(types.uintp, types.float64))
def prepared(constraint: int, dt: float) -> None:
    """In the place of a joint's preparation: nothing is done, and the joint has its own class again."""
    s = array_at(_user_data(_words(constraint + 8, 1)[0]), (1,), STATE)[0]
    k = _joint_of(s, constraint)
    if k >= 0:
        _words(constraint, 1)[0] = joints_of(s)[k].kind


@kernel
def _ask_once(s: Any, joint: Any) -> None:
    """For this frame a spring's force function, if it is the user's, is ours, which asks it once (`spring`)."""
    joint.force_at = 0
    kinds = array_at(s.springs_at, (6,), np.uint64)
    for i in range(0, 6, 3):
        if kinds[i] == joint.kind:
            own = _words(joint.address + np.int64(kinds[i + 1]), 1)
            if own[0] != kinds[i + 2]:
                joint.force_at = np.int64(kinds[i + 1])
                joint.force_func = own[0]
                joint.asked = 0
                own[0] = s.spring_at


@callback(types.float64(types.uintp, types.float64))
def spring(constraint: int, x: float) -> float:
    """In the place of a spring's force function of the user's: what it says in the first substep holds for the frame.

    x: distance or angle.
    """
    s = array_at(_user_data(_words(constraint + 8, 1)[0]), (1,), STATE)[0]
    k = _joint_of(s, constraint)
    if k < 0:
        return 0.0
    joint = joints_of(s)[k]
    if joint.asked == 0:
        joint.asked = 1
        joint.force = _call_force(joint.force_func, constraint, x)
    return float(joint.force)


@kernel
def take_joints(s: Any, tables: Tables, constraints: np.ndarray) -> None:
    """At a frame's begin: list the space's joints, and be called around each of them."""
    s.joint_count = 0
    apart = 0
    for address in constraints:
        if address == s.hidden:
            continue
        s.joint_count += 1
        joint = joints_of(s)[s.joint_count - 1]
        bodies = _words(address + s.constraint_a, 2)
        before = _words(address + s.constraint_pre_solve, 1)
        joint.address = address
        joint.kind = _words(address, 1)[0]
        joint.pre_solve = before[0]
        joint.taken = 0
        joint.a = row_of_body(s, bodies[0])
        joint.b = row_of_body(s, bodies[1])
        joint.x = 0.0
        joint.y = 0.0
        joint.at = -1
        joint.count = 0
        kinds = array_at(s.kinds_at, (3 * KINDS,), np.int64)
        for k in range(KINDS):
            if np.uint64(kinds[k]) == joint.kind:
                joint.at = kinds[KINDS + k]
                joint.count = kinds[2 * KINDS + k]
        before[0] = s.seize_at
        _ask_once(s, joint)
        if array_at(address + s.constraint_collide, (1,), np.uint8)[0] == 0 and joint.a >= 0 and joint.b >= 0:
            if apart < tables.counters[APART]:
                for k in range(2):
                    other = joint.b if k else joint.a
                    if tables.apart[apart, k] != other:
                        tables.counters[UNSORTED] = 1
                        tables.bodies[tables.apart[apart, k]].joined = 0
            tables.apart[apart, 0] = joint.a
            tables.apart[apart, 1] = joint.b
            apart += 1
    for i in range(apart, tables.counters[APART]):
        tables.bodies[tables.apart[i, 0]].joined = 0
        tables.bodies[tables.apart[i, 1]].joined = 0
    if apart != tables.counters[APART]:
        tables.counters[UNSORTED] = 1
        tables.counters[APART] = apart
    for i in range(apart):
        tables.bodies[tables.apart[i, 0]].joined = 1
        tables.bodies[tables.apart[i, 1]].joined = 1


@kernel
def give_back(s: Any, joint: Any) -> None:
    """The joint as it was, its impulse that of the whole frame."""
    if joint.taken:
        _words(joint.address, 1)[0] = joint.kind
        joint.taken = 0
        if joint.count > 0:
            impulse = array_at(joint.address + joint.at, (joint.count,), np.float64)
            impulse[0] = joint.x
            if joint.count > 1:
                impulse[1] = joint.y
    if joint.force_at > 0:
        own = _words(joint.address + np.int64(joint.force_at), 1)
        if own[0] == s.spring_at:
            own[0] = joint.force_func
        joint.force_at = 0
    before = _words(joint.address + s.constraint_pre_solve, 1)
    if before[0] == s.seize_at:
        before[0] = joint.pre_solve


@kernel
def hide(s: Any) -> None:
    """Chipmunk is to find nothing to do where it starts its joints."""
    for joint in joints_of(s):
        if joint.taken:
            _words(joint.address, 1)[0] = s.idle_kind


@kernel
def keep_impulse(joint: Any) -> None:
    """Take down what the joint starts from."""
    if joint.count > 0:
        impulse = array_at(joint.address + joint.at, (joint.count,), np.float64)
        joint.start_x = impulse[0]
        joint.start_y = impulse[joint.count - 1]


@callback(types.void(types.uintp, types.uintp))
def seize(constraint: int, space: int) -> None:
    """In the place of a joint's pre_solve: the user's first, then Chipmunk is to leave it alone."""
    s = array_at(_user_data(space), (1,), STATE)[0]
    k = _joint_of(s, constraint)
    if k < 0:
        return
    joint = joints_of(s)[k]
    if joint.pre_solve != 0:
        _call_user(joint.pre_solve, constraint, space)
    joint.taken = 1
    keep_impulse(joint)
    _words(constraint, 1)[0] = s.seized_kind


@kernel
def scale_impulse(joint: Any, factor: float) -> None:
    """What the joint starts from: of the last frame's sum, a substep's share."""
    if joint.count > 0:
        impulse = array_at(joint.address + joint.at, (joint.count,), np.float64)
        for i in range(joint.count):
            impulse[i] *= factor


@kernel(forceinline=True)
def is_spring(s: Any, joint: Any) -> bool:
    """Whether a joint begins with no impulse of the substep before: a spring's force is given."""
    kinds = array_at(s.springs_at, (6,), np.uint64)
    return bool(joint.kind == kinds[0] or joint.kind == kinds[3])


@kernel
def restore_impulse(joint: Any) -> None:
    """The joint as it started."""
    joint.x = 0.0
    joint.y = 0.0
    if joint.count > 0:
        impulse = array_at(joint.address + joint.at, (joint.count,), np.float64)
        impulse[joint.count - 1] = joint.start_y
        impulse[0] = joint.start_x


@kernel
def add_impulse(joint: Any) -> None:
    """Sum up what it has done in a substep."""
    if joint.count > 0:
        impulse = array_at(joint.address + joint.at, (joint.count,), np.float64)
        joint.x += impulse[0]
        if joint.count > 1:
            joint.y += impulse[1]


@kernel(forceinline=True)
def run(joint: Any, which: int, x: float) -> None:
    """One of its own functions."""
    _call(_words(joint.kind, 4)[which], joint.address, x)
