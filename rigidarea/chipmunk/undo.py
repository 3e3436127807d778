"""A frame is begun again, or taken back."""

from __future__ import annotations

from typing import Any

from ..compile.jit import kernel
from ..contact.space_record import keep_tables, load_tables, put_tables_back
from ..contact.tables import ANEW, AWAKE, BODIES, DRIFTS, TURN, Tables, forget_contacts
from ..geometry.place import place
from .joints import joints_of, read_joint, start_joints
from .record import floats
from .substep import near_pairs


@kernel
def keep_if_fragile(s: Any, space: int, dt: float) -> bool:
    """Where a frame may fail, take down what it starts from. Whether there was room for that and who is near in it."""
    if not s.fragile:
        return True
    load_tables(s).counters[TURN] = 0
    return bool(near_pairs(s, space, dt, dt) and keep_tables(s))


@kernel
def begin_again(s: Any) -> None:
    """Back to what the frame started from, as far as it has changed it; if that was not kept, without contacts."""
    tables = load_tables(s)
    if s.kept:
        put_tables_back(s, tables)
    elif s.begun:
        tables.counters[ANEW] = 1
        forget_contacts(tables)
    for k in range(tables.counters[AWAKE]):
        body = tables.bodies[tables.awake[k]]
        body.rest_turn = body.old_turn
        if body.kind == DRIFTS:
            body.x = body.old_x
            body.y = body.old_y
            body.angle = body.old_a
            body.since = body.old_since
            place(body)
    start_joints(s)


@kernel
def undo_frame(s: Any, tables: Tables) -> None:
    """A frame that failed: every body and joint as it was; if it could not begin, those that it has taken down."""
    for k in range(tables.counters[AWAKE]):
        body = tables.bodies[tables.awake[k]]
        if body.stamp != s.frame:
            continue
        body.calm = body.was_calm
        body.undone = 1
        body.rests = body.has_rested
        body.rest_turn = body.old_turn
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
    for i in range(tables.counters[BODIES]):  # what the user has changed before it is still to act
        body = tables.bodies[i]
        body.disturbed += body.disturbed == s.frame
        body.replaced += body.replaced == s.frame
    for joint in joints_of(s):
        read_joint(s, joint)
