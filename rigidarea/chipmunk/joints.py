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

import math
from typing import Any

import numpy as np

from ..compile.jit import callback, kernel
from ..compile.raw_memory import array_at, caller
from ..contact.constants import NO_LENGTH
from ..contact.joint import spring_reach
from ..contact.joint_record import (
    DIRECTION,
    JOINT,
    KINDS,
    LIMIT,
    PARAMETERS,
    PIN,
    PIVOT,
    RATCHET,
    ROTARY_SPRING,
    SPRING,
)
from ..contact.motion import kick_of
from ..contact.space_record import EXTREME, load_tables, row_of_body
from ..contact.tables import APART, FIXED, JOINTS, REJOINED, TURN, UNSORTED, Law, Tables
from .record import notice_again, state_of, words

#: A joint gives way to what it bears by the square of a substep: one that bears more than so many times its bodies' own
#: weight takes no other number of them when they lie still, since that would move them.
BORNE = 4.0

_call_user = caller("void(uintp, uintp)")
_call_force = caller("float64(uintp, float64)")

#: Numbers of a `joint_structs.JointKind`.
KIND_WORDS = 7


@kernel(inline="always")
def joints_of(s: Any) -> np.ndarray:
    """The joints of this frame: JOINT records."""
    return array_at(s.joints_at, (s.joint_count,), JOINT)


@callback("void(uintp, float64)")
def idle(constraint: int, x: float) -> None:
    """A function of a joint that is taken."""


@callback("float64(uintp)")
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


@callback("void(uintp, float64)")
def prepared(constraint: int, dt: float) -> None:
    """In the place of a joint's preparation: nothing is done, and the joint has its own class again."""
    s = state_of(words(constraint + 8, 1)[0])
    k = _joint_of(s, constraint)
    if k >= 0:
        words(constraint, 1)[0] = joints_of(s)[k].own_class


@kernel(forceinline=True)
def _kind_of(s: Any, joint: Any) -> int:
    """Which kind of joint it is (`contact.joint_record`); -1: none that is known."""
    kinds = array_at(s.kinds_at, (KINDS, KIND_WORDS), np.uint64)
    for k in range(KINDS):
        if kinds[k, 0] == joint.own_class:
            return k
    return -1


@kernel(forceinline=True)
def _solved_as(joint: Any) -> int:
    """The kind as which a joint is solved: a pin of no length holds two points together, as a pivot does.

    Its direction would be that of what it has parted by, across which nothing would hold.
    """
    p = joint.p
    reach = abs(p[0]) + abs(p[1]) + abs(p[2]) + abs(p[3])
    return PIVOT if joint.stored == PIN and p[4] <= NO_LENGTH * reach else int(joint.stored)


@kernel
def partners_known(s: Any, constraints: np.ndarray) -> bool:
    """Whether all bodies that joints hold have rows: some are in no space (the hand that drags), or have no shapes."""
    for address in constraints:
        if address != s.hidden:
            bodies = words(address + s.constraint_a, 2)
            if row_of_body(s, bodies[0]) < 0 or row_of_body(s, bodies[1]) < 0:
                return False
    return True


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
        bodies = words(address + s.constraint_a, 2)
        before = words(address + s.constraint_pre_solve, 1)
        joint.address = address
        joint.own_class = words(address, 1)[0]
        joint.pre_solve = before[0]
        joint.taken = 0
        i = row_of_body(s, bodies[0])
        j = row_of_body(s, bodies[1])
        if i != joint.a or j != joint.b:
            known = (joint.a < 0 or i == joint.a) and (joint.b < 0 or j == joint.b)
            tables.counters[REJOINED] |= 1 if known else 3
        joint.a = i
        joint.b = j
        joint.stored = _kind_of(s, joint)
        joint.kind = joint.stored
        before[0] = s.seize_at
        if array_at(address + s.constraint_collide, (1,), np.uint8)[0] == 0 and joint.a >= 0 and joint.b >= 0:
            if apart < tables.counters[APART]:
                for k in range(2):
                    other = joint.b if k else joint.a
                    if tables.apart[apart, k] != other:
                        tables.counters[UNSORTED] = 1
                        tables.counters[REJOINED] |= 2
                        tables.bodies[tables.apart[apart, k]].joined = 0
            tables.apart[apart, 0] = joint.a
            tables.apart[apart, 1] = joint.b
            apart += 1
    if tables.counters[JOINTS] != s.joint_count:
        tables.counters[REJOINED] = 3
    tables.counters[JOINTS] = s.joint_count
    for i in range(apart, tables.counters[APART]):
        tables.bodies[tables.apart[i, 0]].joined = 0
        tables.bodies[tables.apart[i, 1]].joined = 0
    if apart != tables.counters[APART]:
        tables.counters[UNSORTED] = 1
        tables.counters[REJOINED] |= 2
        tables.counters[APART] = apart
    for i in range(apart):
        tables.bodies[tables.apart[i, 0]].joined = 1
        tables.bodies[tables.apart[i, 1]].joined = 1


@kernel
def ask_springs(s: Any, tables: Tables) -> None:
    """What springs' force functions of the user's say where the bodies are now: for the whole frame."""
    kinds = array_at(s.kinds_at, (KINDS, KIND_WORDS), np.int64)
    for joint in joints_of(s):
        if joint.mine and joint.asked == 1:
            joint.asked = 2
            force = words(joint.address + kinds[joint.kind][5], 1)[0]
            reach = spring_reach(joint, tables.bodies[joint.a], tables.bodies[joint.b])
            joint.force = _call_force(force, joint.address, reach)


@kernel
def read_joint(s: Any, joint: Any) -> None:
    """A joint's parameters as they are now, and what it did last: that is also what it is given back with."""
    joint.x = 0.0
    joint.y = 0.0
    if joint.kind < 0:
        return
    limits = array_at(joint.address + s.constraint_collide - 24, (3,), np.float64)
    changed = joint.max_force != limits[0] or joint.error_bias != limits[1] or joint.max_bias != limits[2]
    joint.max_force = limits[0]
    joint.error_bias = limits[1]
    joint.max_bias = limits[2]
    kind = array_at(s.kinds_at, (KINDS, KIND_WORDS), np.int64)[joint.stored]
    given = array_at(joint.address + kind[3], (kind[4],), np.float64)
    for i in range(kind[4]):
        changed |= joint.p[i] != given[i] and i < DIRECTION
        joint.p[i] = given[i]
        s.fragile |= abs(given[i]) > EXTREME
    if changed:
        for i in (joint.a, joint.b):
            if i >= 0:
                load_tables(s).bodies[i].disturbed = s.frame
    impulse = array_at(joint.address + kind[1], (kind[2],), np.float64)
    joint.jx = impulse[0]
    joint.jy = impulse[kind[2] - 1]
    joint.step = s.before
    joint.x = joint.jx
    joint.y = joint.jy
    joint.kind = _solved_as(joint)
    if joint.kind != joint.stored:
        joint.jx = joint.x * joint.p[DIRECTION]
        joint.jy = joint.x * joint.p[DIRECTION + 1]
        joint.x = joint.jx
        joint.y = joint.jy


@kernel
def start_joints(s: Any) -> None:
    """The joints as the frame's solve finds them; what they will have done begins with nothing."""
    for joint in joints_of(s):
        if joint.taken:
            read_joint(s, joint)
            joint.x = 0.0
            joint.y = 0.0


@kernel(forceinline=True)
def _substeps_of(tables: Tables, joint: Any) -> int:
    """The substeps in which a joint is solved: those of what it moves."""
    a = tables.bodies[joint.a]
    b = tables.bodies[joint.b]
    return int(max(a.steps if a.kind != FIXED else 0, b.steps if b.kind != FIXED else 0))


@kernel
def own_joints(s: Any, tables: Tables) -> int:
    """Which joints belong to the present turn: how many."""
    turn = tables.counters[TURN]
    count = 0
    for joint in joints_of(s):
        joint.mine = 0
        ours = joint.taken and joint.kind >= 0 and joint.a >= 0 and joint.b >= 0
        if ours and (turn == 0 or _substeps_of(tables, joint) == turn):
            joint.mine = 1
            count += 1
    return count


@kernel(forceinline=True)
def _bears_more(joint: Any, a: Any, b: Any, law: Law) -> bool:
    """Whether a joint has borne more than BORNE times what its two bodies weigh."""
    if joint.step <= 0.0:
        return True
    turns = joint.kind >= LIMIT or joint.kind == ROTARY_SPRING
    own = 0.0
    extent = math.inf
    for body in (a, b):
        inverse = body.inverse_moment if turns else body.inverse_mass
        if inverse > 0.0:
            own += 1.0 / inverse
            extent = min(extent, body.extent)
    speed = math.hypot(joint.jx, joint.jy) * (extent if turns else 1.0)
    return bool(speed > BORNE * kick_of(law, extent, joint.step) * own)


@kernel(forceinline=True)
def _disturbed(tables: Tables, joint: Any, frame: int) -> bool:
    """Whether something about one of its bodies has been changed before this frame."""
    for i in (joint.a, joint.b):
        if i >= 0 and max(tables.bodies[i].disturbed, tables.bodies[i].replaced) == frame:
            return True
    return False


@kernel
def rest_joints(s: Any, tables: Tables, dt: float) -> None:
    """Joints of bodies at rest bear for a frame of dt what they bore."""
    for joint in joints_of(s):
        ours = joint.taken and joint.kind >= 0 and joint.a >= 0 and joint.b >= 0
        if ours and _substeps_of(tables, joint) == 0 and joint.step > 0.0:
            joint.x = dt / joint.step * joint.jx
            joint.y = dt / joint.step * joint.jy


@kernel
def note_jointed(s: Any, tables: Tables, law: Law) -> None:
    """Note who hangs in a joint; nobody does so calmly with one that moves, nor under a load."""
    for joint in joints_of(s):
        for i in (joint.a, joint.b):
            if joint.taken and i >= 0 and tables.bodies[i].mobile:
                body = tables.bodies[i]
                body.calm = -2 if body.calm > 0 or body.calm == -2 else -1
                if joint.asked or _disturbed(tables, joint, s.frame):
                    body.wants = max(s.substeps, body.wants)
    for joint in joints_of(s):
        if joint.taken and joint.a >= 0 and joint.b >= 0:
            a = tables.bodies[joint.a]
            b = tables.bodies[joint.b]
            heavy = _bears_more(joint, a, b, law)
            if heavy or a.calm == -1 or b.calm == -1:
                for body in (a, b):
                    if body.calm == -2:
                        body.calm = -1 if heavy else -2
                        body.wants = max(body.wants, s.substeps) if body.wants > 0 else 0


@kernel
def give_back(s: Any, joint: Any) -> None:
    """The joint as it was, its impulse that of the whole frame."""
    if joint.taken:
        words(joint.address, 1)[0] = joint.own_class
        joint.taken = 0
        if joint.kind >= 0:
            kind = array_at(s.kinds_at, (KINDS, KIND_WORDS), np.int64)[joint.stored]
            impulse = array_at(joint.address + kind[1], (kind[2],), np.float64)
            impulse[0] = joint.x
            if kind[2] > 1:
                impulse[1] = joint.y
            elif joint.kind != joint.stored:
                impulse[0] = math.hypot(joint.x, joint.y)
                made_of = array_at(joint.address + kind[3], (PARAMETERS,), np.float64)
                made_of[DIRECTION] = joint.x / impulse[0] if impulse[0] > 0.0 else 0.0
                made_of[DIRECTION + 1] = joint.y / impulse[0] if impulse[0] > 0.0 else 0.0
            if joint.kind == RATCHET:
                array_at(joint.address + kind[3], (1,), np.float64)[0] = joint.p[0]
    before = words(joint.address + s.constraint_pre_solve, 1)
    if before[0] == s.seize_at:
        before[0] = joint.pre_solve


@kernel
def hide(s: Any) -> None:
    """Chipmunk is to find nothing to do where it starts its joints."""
    for joint in joints_of(s):
        if joint.taken:
            words(joint.address, 1)[0] = s.idle_kind


@callback("void(uintp, uintp)")
def seize(constraint: int, space: int) -> None:
    """In the place of a joint's pre_solve: the user's first, then Chipmunk is to leave it alone."""
    s = state_of(space)
    k = _joint_of(s, constraint)
    if k < 0:
        return
    joint = joints_of(s)[k]
    if joint.pre_solve != 0:
        _call_user(joint.pre_solve, constraint, space)
        for i in (joint.a, joint.b):
            if i >= 0:
                notice_again(s, load_tables(s).bodies[i])
    joint.taken = 1
    read_joint(s, joint)
    joint.asked = 0
    if joint.kind == SPRING or joint.kind == ROTARY_SPRING:
        kind = array_at(s.kinds_at, (KINDS, KIND_WORDS), np.uint64)[joint.kind]
        joint.asked = words(constraint + np.int64(kind[5]), 1)[0] != kind[6]
    words(constraint, 1)[0] = s.seized_kind
