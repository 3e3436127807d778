"""A frame: one step of Chipmunk's, in which a constraint of ours solves all contacts and joints together.

The constraint (`hidden`, known to Chipmunk alone) has a class of its own, and Chipmunk calls that class's functions
where a constraint's turn is: `silence` after the pairs are known, so that its own solver finds nothing to do; `solve`
once velocities are integrated; `report` after its sweeps, so that whoever asks an arbiter gets an answer.

`solve` is the frame: substeps of drift, kick, overlap, rows, sweeps, drift; island by island where some take more of
them than others (`contact.islands`).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..compile.jit import callback, kernel
from ..compile.raw_memory import array_at
from ..contact.constants import MOST_SUBSTEPS
from ..contact.islands import (
    FINEST,
    all_in_one_group,
    connect,
    demand,
    mark_bodies_with_neighbours,
    next_turn,
    number,
    part,
    share_kicks,
    spare,
)
from ..contact.motion import start_looks
from ..contact.order import order_joints
from ..contact.passed import any_body_left_its_margin, left_its_margin, recover_from_tunnelling
from ..contact.solve import finish, finite, respond_explicitly
from ..contact.space_record import (
    EXTREME,
    keep_tables,
    load_law,
    load_pool,
    load_tables,
    load_work,
    put_tables_back,
    row_of_body,
)
from ..contact.stiffness import adapt_stiffness
from ..contact.tables import (
    ANEW,
    AWAKE,
    CONCAVE,
    COUNTED,
    DRIFTS,
    LED,
    MET,
    REJOINED,
    ROWS,
    SUBSTEP,
    TOLD,
    TOOTHED,
    TURN,
    UNSORTED,
    Tables,
    find_pair,
    forget_contacts,
)
from ..contact.verdict import wait_for_verdicts
from ..geometry.place import place
from .joints import give_back, hide, joints_of, read_joint, start_joints
from .phases import REPORTING, WATCHING, lap, start
from .record import (
    BROKEN,
    GROW,
    ask,
    begin,
    floats,
    listened,
    members,
    read_motion,
    read_place,
    row_of_shape,
    state_of,
    time_step,
    timestamp,
    user_data,
    wake,
    words,
    write_motion,
    write_place,
)
from .structs import function
from .substep import find_contacts, near_pairs, substeps

#: A body that goes so many of its sizes in a frame may come near more others than has been made room for.
FAST = 30.0

_cache_box = function("cpShapeCacheBB", "void(uintp, uintp)")
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
    for k in range(tables.counters[TOLD]):
        pair = tables.pairs[tables.told[k]]
        if pair.verdict:
            count = array_at(pair.arbiter + s.arbiter_count, (1,), np.int32)
            pair.points = count[0]
            count[0] = 0
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


@kernel(forceinline=True)
def _is_extreme(body: Any, dt: float) -> bool:
    """Whether a frame of dt may take a body's numbers beyond what is finite, or it past a crowd of others."""
    place = abs(body.x) + abs(body.y) + abs(body.angle)
    speed = abs(body.vx) + abs(body.vy)
    most = place + speed + abs(body.w) + body.inverse_mass + body.inverse_moment
    light = min(body.inverse_mass, body.inverse_moment)
    return bool(
        most > EXTREME
        or (light > 0.0 and light * EXTREME < 1.0)
        or (body.extent > 0.0 and dt * speed > FAST * body.extent)
    )


@kernel
def _keep_if_fragile(s: Any, space: int, dt: float) -> bool:
    """Where a frame may fail, take down what it starts from. Whether there was room for that and who is near in it."""
    if not s.fragile:
        return True
    load_tables(s).counters[TURN] = 0
    return bool(near_pairs(s, space, dt, dt) and keep_tables(s))


@kernel
def _start(s: Any, space: int, tables: Tables) -> bool:
    """Where the bodies are at the frame's start, and what Chipmunk's and the user's functions did to velocities.

    What those did is spread over the frame (`gain`). Whether bodies' numbers may overflow in it, or room run out, is
    noted (`fragile`); of pairs and joints that is known.

    False: the state of one (`broken`) is not finite. Later that would have spread to others.
    """
    s.broken = -1
    # two that are concave may overlap in any number of places: who is at rest keeps its own
    concave = tables.counters[CONCAVE] > 0
    dt = time_step(space)
    for address in members(space, s.space_bodies):
        i = row_of_body(s, address)
        if i < 0:
            continue
        body = tables.bodies[i]
        if body.stamp != s.frame:
            wake(s, tables, i)
        if s.explicit or body.kind == LED:
            read_place(s, address, body)
        read_motion(s, address, body)
        state = body.x + body.y + body.angle + body.vx + body.vy + body.w
        if not math.isfinite(state + body.inverse_mass + body.inverse_moment):
            s.broken = i if s.broken < 0 else s.broken
            continue
        if _is_extreme(body, dt) or (concave and body.mobile and not body.was_calm):
            s.fragile = 1
        body.thrust = math.hypot(body.vx - body.old_vx, body.vy - body.old_vy)
        function = words(address + s.body_velocity_func, 1)[0]
        whole = (function != s.velocity_func and function != s.velocity_func_again) or s.explicit
        body.gain_x = 0.0
        body.gain_y = 0.0
        body.gain_w = 0.0
        if not whole:
            body.gain_x = body.vx - body.old_vx
            body.gain_y = body.vy - body.old_vy
            body.gain_w = body.w - body.old_w
            body.vx = body.old_vx
            body.vy = body.old_vy
            body.w = body.old_w
        elif s.explicit:  # the kick has been given; contacts want to know it all the same
            body.gain_x = body.vx - body.old_vx
            body.gain_y = body.vy - body.old_vy
            body.gain_w = body.w - body.old_w
    return bool(s.broken < 0)


@kernel
def _explicit_frame(s: Any, space: int, dt: float) -> bool:
    """The paper's step: F = k A where Chipmunk has moved the bodies to (symplectic Euler), joints after it."""
    if not _start(s, space, load_tables(s)):
        return False
    if not _keep_if_fragile(s, space, dt):
        return False
    all_in_one_group(load_tables(s))
    share_kicks(load_tables(s), 1)
    if not find_contacts(s, space, dt, dt, False):
        return False
    tables = load_tables(s)
    s.contacts = tables.counters[ROWS]
    respond_explicitly(tables)
    finish(tables, load_law(s), s.frame, dt, True)
    return True


@kernel
def _again(s: Any) -> None:
    """Back to what the frame started from, as far as it has changed it; if that was not kept, without contacts."""
    tables = load_tables(s)
    if s.kept:
        put_tables_back(s, tables)
    elif s.begun:
        tables.counters[ANEW] = 1
        forget_contacts(tables)
    for k in range(tables.counters[AWAKE]):
        body = tables.bodies[tables.awake[k]]
        if body.kind == DRIFTS:
            body.x = body.old_x
            body.y = body.old_y
            body.angle = body.old_a
            body.since = body.old_since
            place(body)
    start_joints(s)


@kernel
def _difference(s: Any) -> float:
    """How far the places of this run and of the one before (noted in `seen`) are apart, over the smallest extents."""
    tables = load_tables(s)
    most = 0.0
    for k in range(tables.counters[AWAKE]):
        i = tables.awake[k]
        body = tables.bodies[i]
        if body.kind == DRIFTS and body.extent > 0.0:
            seen = floats(s.seen_at + 24 * i, 3)
            dx = body.x - seen[0]
            dy = body.y - seen[1]
            most = max(most, math.sqrt(dx * dx + dy * dy) / body.extent + abs(body.angle - seen[2]))
    return most


@kernel
def _see(s: Any) -> None:
    """Note where this run has taken the bodies."""
    tables = load_tables(s)
    for k in range(tables.counters[AWAKE]):
        i = tables.awake[k]
        body = tables.bodies[i]
        seen = floats(s.seen_at + 24 * i, 3)
        seen[0] = body.x
        seen[1] = body.y
        seen[2] = body.angle


@kernel
def _turns(s: Any, space: int, dt: float) -> int:
    """A frame in which some bodies want more substeps than others.

    Returns how many the finest took; 0: there was no room for it.
    """
    g = floats(space + s.space_gravity, 2)
    tables = load_tables(s)
    tables.counters[TURN] = 0
    if not near_pairs(s, space, dt, dt, False):
        return 0
    # substeps are for contacts: what only joints hold goes as in Chipmunk's own step
    if s.steps_given == 0 and s.joint_count > 0:
        mark_bodies_with_neighbours(tables)
        for joint in joints_of(s):
            if joint.taken:
                spare(tables, joint.a, s.substeps)
                spare(tables, joint.b, s.substeps)
    part(tables)
    for joint in joints_of(s):
        if joint.taken:
            connect(tables, joint.a, joint.b)
    if number(tables, g[0], g[1]) < 2:
        all_in_one_group(load_tables(s))
        taken = tables.bodies[tables.awake[0]].steps if tables.counters[AWAKE] else s.substeps
        return int(taken) if substeps(s, space, dt, taken) else 0
    turn = next_turn(tables, FINEST)
    taken = turn
    most = max(turn, s.substeps)
    if not keep_tables(s):
        return 0
    last = tables.counters[SUBSTEP] + most  # of each turn: what is there at the end is known by it
    while turn > 0:
        tables.counters[SUBSTEP] = last - turn
        if not substeps(s, space, dt, turn):
            return 0
        turn = next_turn(tables, turn)
    if tables.counters[MET]:
        _again(s)
        s.contacts = 0
        all_in_one_group(load_tables(s))
        if not substeps(s, space, dt, most):
            return 0
        taken = most
    return int(taken)


@kernel
def _whom_it_met(s: Any, space: int, dt: float) -> bool:
    """Near is also whom a blow has sent somebody past since the last search. Whether there was room for that."""
    tables = load_tables(s)
    if not any_body_left_its_margin(load_pool(s), tables):
        return True
    tables.counters[TURN] = 0
    return bool(near_pairs(s, space, dt, dt))


@kernel
def _frame(s: Any, space: int, dt: float) -> bool:
    """All substeps of a frame: so many, or as many as an island wants, or as the tolerance needs.

    The error of n substeps falls as 1/n^2 while nothing new happens, so that two runs, of n and 2n, differ by three
    times the error of the finer one (Richardson). Where something does happen it falls as 1/n, and the difference
    is the error itself: that is what is compared.
    """
    s.contacts = 0
    tables = load_tables(s)
    if not _start(s, space, tables):
        return False
    start_joints(s)
    if tables.counters[REJOINED]:
        order_joints(tables)
    if tables.counters[UNSORTED] and tables.counters[TOOTHED] > 0:  # teeth ask before the first substep looks
        tables.counters[TURN] = 0
        if not near_pairs(s, space, dt, dt):
            return False
    if not _keep_if_fragile(s, space, dt):
        return False
    lap(s, WATCHING)
    n, least = demand(load_pool(s), tables, load_work(s), load_law(s), dt, s.substeps, s.steps_given == 0)
    # What hangs in a joint is never calm: it is held the better the shorter the step.
    for joint in joints_of(s):
        for i in (joint.a, joint.b):
            if joint.taken and i >= 0 and tables.bodies[i].mobile:
                tables.bodies[i].calm = -1
    if s.tolerance > 0.0:
        all_in_one_group(load_tables(s))
        if not keep_tables(s) or not substeps(s, space, dt, n):
            return False
        while 2 * n <= MOST_SUBSTEPS:
            _see(s)
            _again(s)
            n *= 2
            s.contacts = 0
            if not substeps(s, space, dt, n):
                return False
            if _difference(s) <= s.tolerance:
                break
    elif n > least or n > s.substeps or (n > 1 and s.joint_count > 0 and s.steps_given == 0):
        n = _turns(s, space, dt)
    else:
        all_in_one_group(load_tables(s))
        if not substeps(s, space, dt, n):
            return False
    if n == 0:
        return False
    far, lines = left_its_margin(tables)
    if far and not _whom_it_met(s, space, dt):
        return False
    if listened(s) and not wait_for_verdicts(load_pool(s), tables, load_work(s), s.frame, dt):
        return False
    if far or lines:
        recover_from_tunnelling(load_pool(s), tables, s.frame, far)
    if s.stiffness_given == 0:
        adapt_stiffness(tables, load_law(s), dt)
    s.taken = n
    return True


@kernel
def _finish_frame(s: Any, tables: Tables, good: bool) -> None:
    """Give everything back to Chipmunk: velocities, places, and the shapes' boxes that queries look at.

    Of a frame that failed also what the user's position functions have moved.
    """
    for k in range(tables.counters[AWAKE]):
        body = tables.bodies[tables.awake[k]]
        if body.stamp != s.frame:
            continue
        if body.mobile or not good:
            write_motion(s, body)
        if (body.kind == DRIFTS and s.explicit == 0) or not good:
            write_place(s, body)
            if body.kind == DRIFTS and s.explicit == 0:
                words(body.address + s.body_position_func, 1)[0] = s.hold_at
            shape = words(body.address + s.body_shapes, 1)[0]
            while shape != 0:
                _cache_box(s.scratch_at, shape)
                shape = words(shape + s.shape_next, 1)[0]


@kernel
def _finish_jointed(s: Any, tables: Tables) -> None:
    """What joints have made of the velocity of bodies that are in no space."""
    for joint in joints_of(s):
        for i in (joint.a, joint.b):
            if i >= 0 and not tables.bodies[i].awake and tables.bodies[i].inverse_mass > 0.0:
                write_motion(s, tables.bodies[i])


@kernel
def _undo(s: Any, tables: Tables) -> None:
    """A frame that failed: every body and joint as it was; if it could not begin, those that it has taken down."""
    for k in range(tables.counters[AWAKE]):
        body = tables.bodies[tables.awake[k]]
        if body.stamp != s.frame:
            continue
        body.calm = body.was_calm
        body.x = body.old_x
        body.y = body.old_y
        body.angle = body.old_a
        body.vx = body.old_vx
        body.vy = body.old_vy
        body.w = body.old_w
        place(body)
        force = floats(body.address + s.body_force, 2)
        force[0] = body.old_fx
        force[1] = body.old_fy
        floats(body.address + s.body_torque, 1)[0] = body.old_torque
    for joint in joints_of(s):
        read_joint(s, joint)


@kernel
def _whole_frame(s: Any, space: int) -> None:
    """The frame; again, once there is room for what it has found; and where it fails everything as it was."""
    start(s)
    dt = time_step(space)
    good = False
    again = s.failed == 0
    while again:
        s.begun = 0
        s.kept = 0
        start_looks(load_tables(s).counters)
        good = _explicit_frame(s, space, dt) if s.explicit else _frame(s, space, dt)
        if good:
            s.broken = finite(load_tables(s))
            good = s.broken < 0
        if not good:
            _again(s)
        again = not good and ask(s, GROW if s.broken < 0 else BROKEN)
    tables = load_tables(s)
    if good:
        tables.counters[COUNTED] = s.frame
    else:
        _undo(s, tables)
    _finish_frame(s, tables, good)
    if good and s.explicit == 0:
        _finish_jointed(s, tables)
    lap(s, REPORTING)


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
        _whole_frame(s, space)
    if s.explicit == 0:  # the sweeps are ours; of an explicit step, the joints' are Chipmunk's
        iterations[0] = 0
        hide(s)


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
