"""What Chipmunk calls of its own accord in a step: the functions of a constraint that it alone knows.

They are of a class of the constraint's own, and Chipmunk calls them where its turn is: `silence` after the pairs are
known, so that its own solver finds nothing to do; `solve`, the frame, once velocities are integrated; `report` after
its sweeps, so that an arbiter that is asked has an answer. `advance` is several of Chipmunk's steps on end.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..compile.jit import callback, kernel
from ..compile.raw_memory import array_at
from ..contact.space_record import load_tables
from ..contact.tables import COUNTED, TOLD, Tables, find_pair
from ..contact.verdict import go_on
from .awake import look_again
from .begin import begin, listened
from .frame import whole_frame
from .joints import give_back, hide, joints_of
from .phases import REPORTING, lap, start
from .record import floats, members, row_of_shape, state_of, time_step, timestamp, user_data, words
from .structs import function

#: Two directions are of one contact up to the angle with this cosine, 60 degrees.
ALIKE = 0.5

_step = function("cpSpaceStep", "void(uintp, float64)")


@kernel(forceinline=True)
def _space_of(constraint: int) -> int:
    return words(constraint + 8, 1)[0]


@callback("void(uintp, float64)")
def silence(constraint: int, dt: float) -> None:
    """Chipmunk's own solver gets no contact points: every pair is ours."""
    space = _space_of(constraint)
    if user_data(space) == 0:
        return
    s = state_of(space)
    if s.frame != np.int64(timestamp(space)) and not begin(s, space, dt):
        return
    tables = load_tables(s)
    if listened(s) and s.explicit == 0:
        look_again(s, tables)
    for k in range(tables.counters[TOLD]):
        pair = tables.pairs[tables.told[k]]
        if pair.verdict:
            count = array_at(pair.arbiter + s.arbiter_count, (1,), np.int32)
            pair.points = count[0]
            count[0] = 0
        elif pair.owed > 0.0:
            go_on(tables, pair)
    if not s.asleep:
        return
    for arbiter in members(space, s.space_contacts - 8):
        both = words(arbiter + s.arbiter_shape_a, 2)
        a = row_of_shape(s, both[0])
        b = row_of_shape(s, both[1])
        p = find_pair(tables, a, b) if a >= 0 and b >= 0 else -1
        if (
            p >= 0 and tables.pairs[p].stamp != s.frame
        ):  # of who has been woken just now: as it was when they fell asleep
            array_at(arbiter + s.arbiter_count, (1,), np.int32)[0] = 0


@callback("void(uintp, float64)")
def solve(constraint: int, coefficient: float) -> None:
    """The frame, once velocities are integrated."""
    space = _space_of(constraint)
    if user_data(space) == 0:
        return
    s = state_of(space)
    iterations = array_at(space, (1,), np.int32)
    s.sweeps = iterations[0]
    if s.frame == np.int64(timestamp(space)):
        whole_frame(s, space)
    if s.explicit == 0:  # the sweeps are ours; of an explicit step, the joints' are Chipmunk's
        iterations[0] = 0
        hide(s)


@kernel
def _turn_normal(tables: Tables, pair: Any, n: np.ndarray, sign: float) -> None:
    """Chipmunk finds any normal of two corners that touch: where no region has it, it is that of what bears most."""
    most = 0.0
    nx = n[0]
    ny = n[1]
    r = pair.head
    while r >= 0:
        region = tables.regions[r]
        if sign * (n[0] * region.nx + n[1] * region.ny) > ALIKE:
            return
        if region.force > most:
            most = region.force
            nx = sign * region.nx
            ny = sign * region.ny
        r = region.next
    n[0] = nx
    n[1] = ny


@callback("void(uintp, uintp)")
def report(constraint: int, space: int) -> None:
    """After Chipmunk's sweeps: arbiters get their contact points again, with the impulse of the frame."""
    if user_data(space) == 0:
        return
    s = state_of(space)
    array_at(space, (1,), np.int32)[0] = s.sweeps
    if s.frame != np.int64(timestamp(space)):
        return
    start(s)
    for joint in joints_of(s):
        give_back(s, joint)
    if load_tables(s).counters[COUNTED] == s.frame:
        s.before = time_step(space)
    s.joint_count = 0  # of a frame that cannot begin there are none: those of this one may be gone by then
    tables = load_tables(s)
    for k in range(tables.counters[TOLD]):
        pair = tables.pairs[tables.told[k]]
        if not pair.verdict:
            continue
        arbiter = pair.arbiter
        array_at(arbiter + s.arbiter_count, (1,), np.int32)[0] = pair.points
        if pair.points == 0:
            continue
        n = floats(arbiter + s.arbiter_normal, 2)
        sign = -1.0 if pair.swapped else 1.0
        if sign * (pair.jx * n[0] + pair.jy * n[1]) < ALIKE * math.hypot(pair.jx, pair.jy):
            _turn_normal(tables, pair, n, sign)
        normal = sign * (pair.jx * n[0] + pair.jy * n[1]) / pair.points
        tangent = sign * (pair.jy * n[0] - pair.jx * n[1]) / pair.points
        point = words(arbiter + s.arbiter_contacts, 1)[0]
        for i in range(pair.points):
            floats(point + i * s.contact_size + s.contact_normal_impulse, 1)[0] = normal
            floats(point + i * s.contact_size + s.contact_tangent_impulse, 1)[0] = tangent
    lap(s, REPORTING)


@callback("int64(uintp, float64, int64)")
def advance(space: int, dt: float, frames: int) -> int:
    """So many frames on end, until somebody has fallen asleep (`waking.rouse`); returns how many went well."""
    for i in range(frames):
        if i > 0 and state_of(space).asleep:
            return i
        _step(space, dt)
        if user_data(space) == 0 or state_of(space).failed:
            return i
    return frames
