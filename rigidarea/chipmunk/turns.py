"""A frame in which islands take different numbers of substeps."""

from __future__ import annotations

from typing import Any

from ..compile.jit import kernel
from ..contact.at_rest import disturb_partners, rest
from ..contact.islands import (
    FINEST,
    all_in_one_group,
    connect,
    connect_in_reach,
    mark_bodies_with_neighbours,
    next_turn,
    number,
    part,
    sort_by_turns,
    spare,
)
from ..contact.order import bound
from ..contact.space_record import load_pool, load_tables
from ..contact.tables import AWAKE, FIRST, LAST, NEAR, ROWS, SUBSTEP, TURN
from .joints import joints_of, rest_joints
from .record import floats
from .substep import near_pairs, substeps


@kernel
def substeps_by_islands(s: Any, space: int, dt: float) -> int:
    """A frame in which some bodies want more substeps than others.

    Returns how many the finest took; 0: there was no room for it.
    """
    g = floats(space + s.space_gravity, 2)
    tables = load_tables(s)
    tables.counters[TURN] = 0
    if not near_pairs(s, space, dt, dt, False):
        return 0
    disturb_partners(tables, s.frame, s.substeps)
    # substeps are for contacts: what only joints hold goes as in Chipmunk's own step
    if s.steps_given == 0 and s.joint_count > 0:
        mark_bodies_with_neighbours(tables)
        for joint in joints_of(s):
            if joint.taken:
                spare(tables, joint.a, s.substeps)
                spare(tables, joint.b, s.substeps)
    part(load_pool(s), tables, dt)
    for joint in joints_of(s):
        if joint.taken:
            connect(tables, joint.a, joint.b)
    differ = number(tables)
    if differ and connect_in_reach(load_pool(s), tables, dt):
        differ = number(tables)
    then = tables.counters[SUBSTEP]
    taken = tables.bodies[tables.awake[0]].steps if tables.counters[AWAKE] else s.substeps
    if not differ and taken == 0:
        tables.counters[ROWS] = 0
        tables.counters[FIRST] = 0
        tables.counters[LAST] = tables.counters[NEAR]
        s.contacts += rest(tables, then, dt)
        rest_joints(s, tables, dt)
        return 1
    if not differ:
        all_in_one_group(tables)
        return int(taken) if substeps(s, space, dt, taken) else 0
    sort_by_turns(tables, g[0], g[1])
    turn = next_turn(tables, FINEST)
    taken = turn
    most = max(turn, s.substeps)
    last = tables.counters[SUBSTEP] + most  # of each turn: what is there at the end is known by it
    while turn > 0:
        tables.counters[SUBSTEP] = last - turn
        if not substeps(s, space, dt, turn):
            return 0
        turn = next_turn(tables, turn)
    bound(tables)
    s.contacts += rest(tables, then, dt)
    rest_joints(s, tables, dt)
    return int(taken)
