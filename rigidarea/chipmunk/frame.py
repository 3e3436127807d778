"""A frame, from top to bottom: what happens in one step of Chipmunk's once it has integrated velocities.

`hidden_constraint.solve` calls `whole_frame`. Calls go down only: from here to `substep` and what stands beside it,
from there to the kernels of `contact`, and from those to `geometry` (`tests/test_frame_walk.py` follows them).
"""

from __future__ import annotations

from typing import Any

from ..compile.jit import kernel
from ..contact.islands import all_in_one_group, demand
from ..contact.motion import start_looks
from ..contact.order import order_joints
from ..contact.passed import any_body_left_its_margin, left_its_margin, recover_from_tunnelling
from ..contact.solve import finite
from ..contact.space_record import load_law, load_pool, load_tables, load_work
from ..contact.stiffness import adapt_stiffness
from ..contact.tables import AWAKE, COUNTED, REJOINED, TOOTHED, TURN, UNSORTED
from ..contact.verdict import wait_for_verdicts
from .begin import listened
from .explicit import explicit_frame
from .frame_end import finish_frame
from .frame_start import start_frame
from .joints import note_jointed, start_joints
from .phases import REPORTING, WATCHING, lap, start
from .record import BROKEN, GROW, ask, time_step
from .substep import near_pairs, substeps
from .tolerance import substeps_to_tolerance
from .turns import substeps_by_islands
from .undo import begin_again, keep_if_fragile, undo_frame


@kernel
def whole_frame(s: Any, space: int) -> None:
    """The frame; again, once there is room for what it has found; and where it fails everything as it was."""
    start(s)
    dt = time_step(space)
    good = False
    again = s.failed == 0
    while again:
        s.begun = 0
        s.kept = 0
        start_looks(load_tables(s).counters)
        good = explicit_frame(s, space, dt) if s.explicit else _frame(s, space, dt)
        if good:
            s.broken = finite(load_tables(s))
            good = s.broken < 0
        if not good:
            begin_again(s)
        again = not good and ask(s, GROW if s.broken < 0 else BROKEN)
    tables = load_tables(s)
    if good:
        tables.counters[COUNTED] = s.frame
    else:
        undo_frame(s, tables)
    finish_frame(s, space, tables, good, dt)
    lap(s, REPORTING)


@kernel
def _frame(s: Any, space: int, dt: float) -> bool:
    """One run of a frame. False: a state is not finite (`broken`), or there was no room for what it has found."""
    if not _begin(s, space, dt):
        return False
    taken = _substeps(s, space, dt)
    if taken == 0 or not _end(s, space, dt):
        return False
    s.taken = taken
    return True


@kernel
def _begin(s: Any, space: int, dt: float) -> bool:
    """Bodies and joints as they are; a frame that may fail keeps what it starts from. Whether it may go on."""
    s.contacts = 0
    tables = load_tables(s)
    if not start_frame(s, space, tables):
        return False
    start_joints(s)
    if tables.counters[REJOINED] & 2:
        for k in range(tables.counters[AWAKE]):  # whoever a joint held is among them
            tables.bodies[tables.awake[k]].disturbed = s.frame
    if tables.counters[REJOINED]:
        order_joints(tables)
    if tables.counters[UNSORTED] and tables.counters[TOOTHED] > 0:  # teeth ask before the first substep looks
        tables.counters[TURN] = 0
        if not near_pairs(s, space, dt, dt):
            return False
    if not keep_if_fragile(s, space, dt):
        return False
    lap(s, WATCHING)
    return True


@kernel
def _substeps(s: Any, space: int, dt: float) -> int:
    """All substeps: so many for all bodies, or as many as an island wants, or as the tolerance needs.

    Returns how many, of the island that took most; 0: there was no room.
    """
    tables = load_tables(s)
    n, least = demand(load_pool(s), tables, load_work(s), load_law(s), dt, s.substeps, s.steps_given == 0)
    note_jointed(s, tables, load_law(s))
    if s.tolerance > 0.0:
        all_in_one_group(tables)
        return int(substeps_to_tolerance(s, space, dt, n))
    if n > least or n > s.substeps or (n > 1 and s.joint_count > 0 and s.steps_given == 0):
        return int(substeps_by_islands(s, space, dt))
    all_in_one_group(tables)
    return int(n) if substeps(s, space, dt, n) else 0


@kernel
def _end(s: Any, space: int, dt: float) -> bool:
    """After the substeps: the user's callbacks, recovery from tunnelling, stiffness by load. Whether there was room."""
    tables = load_tables(s)
    far, lines = left_its_margin(tables)
    if far and any_body_left_its_margin(load_pool(s), tables):
        # an impact has sent a body past others since the broad phase last looked
        tables.counters[TURN] = 0
        if not near_pairs(s, space, dt, dt):
            return False
    if listened(s) and not wait_for_verdicts(load_pool(s), tables, load_work(s), s.frame, dt):
        return False
    if far or lines:
        recover_from_tunnelling(load_pool(s), tables, s.frame, far)
    if s.stiffness_given == 0:
        adapt_stiffness(tables, load_law(s), dt)
    return True
