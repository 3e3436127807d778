"""Which bodies are awake in a frame, and their shapes: listed as it begins, what a user has set of them read."""

from __future__ import annotations

import math
from typing import Any

from ..compile.jit import kernel
from ..contact.at_rest import watch_rest
from ..contact.broad import ask_about, measure, put_in_tree
from ..contact.space_record import load_pool, next_row_of_body
from ..contact.tables import AWAKE, DRIFTS, FIXED, LED, MOVERS, UNSORTED, Tables
from ..contact.tree import MOVING
from ..geometry.place import place
from .record import (
    floats,
    members,
    notice,
    notice_again,
    read_motion,
    read_place,
    read_shape,
    row_of_shape,
    words,
)


@kernel
def _list_shapes(s: Any, tables: Tables, body: Any, anew: bool) -> bool:
    """List the shapes of a body that is awake among the movers; anew: it was not, or is mobile now.

    Whether all are known.
    """
    counters = tables.counters
    address = words(body.address + s.body_shapes, 1)[0]
    while address != 0:
        i = row_of_shape(s, address)
        if i < 0:
            return False
        shape = tables.shapes[i]
        tables.movers[counters[MOVERS]] = i
        counters[MOVERS] += 1
        sensor = shape.sensor
        changed = read_shape(s, shape, body)
        if changed or anew:
            ask_about(tables, i)
            counters[UNSORTED] = 1
            body.unmeasured |= sensor != shape.sensor
        if shape.leaf >= 0 and shape.tree != MOVING:
            put_in_tree(tables, i, MOVING)
        address = words(address + s.shape_next, 1)[0]
    if body.unmeasured:  # it is as thin as its thinnest shape that is no sensor
        body.unmeasured = 0
        body.extent = 0.0
        body.reach = 0.0
        address = words(body.address + s.body_shapes, 1)[0]
        while address != 0:
            measure(load_pool(s), tables.shapes[row_of_shape(s, address)], body)
            address = words(address + s.shape_next, 1)[0]
    return True


@kernel
def add_to_awake(tables: Tables, i: int, body: Any) -> None:
    """A body that was not awake is."""
    body.awake = 1
    body.unmeasured = 1
    tables.awake[tables.counters[AWAKE]] = i
    tables.counters[AWAKE] += 1


@kernel(forceinline=True)
def _is_as_left(s: Any, address: int, body: Any) -> bool:
    """Whether a body was at rest in the last frame, and nothing has been set of it since, nor is it pushed."""
    if body.rests == 0.0 or body.wants > 0 or body.steps > 0 or not body.awake or not body.mobile:
        return False
    place = floats(address + s.body_position, 2)
    cog = floats(address + s.body_cog, 2)
    v = floats(address + s.body_velocity, 2)
    force = floats(address + s.body_force, 2)
    return bool(
        place[0] == body.x
        and place[1] == body.y
        and floats(address + s.body_angle, 1)[0] == body.angle
        and cog[0] == body.cog_x
        and cog[1] == body.cog_y
        and v[0] == body.vx
        and v[1] == body.vy
        and floats(address + s.body_spin, 1)[0] == body.w
        and floats(address + s.body_inverse_mass, 1)[0] == body.inverse_mass
        and floats(address + s.body_inverse_moment, 1)[0] == body.inverse_moment
        and force[0] == 0.0
        and force[1] == 0.0
        and floats(address + s.body_torque, 1)[0] == 0.0
        and words(address + s.body_position_func, 1)[0] == s.hold_at
    )


@kernel
def watch_bodies(s: Any, tables: Tables, space: int, dt: float) -> bool:
    """All bodies that are awake, as they are now, and those that no more are. Whether all that there are are known."""
    counters = tables.counters
    ahead = 0.5 * dt / s.substeps
    moved = True  # Chipmunk has moved what it has listed before the first that is held: that begins the frame
    i = -1
    for address in members(space, s.space_bodies):
        i = next_row_of_body(s, tables.bodies, i, address)
        if i < 0:
            return False
        body = tables.bodies[i]
        if body.stamp == s.frame:
            continue
        body.old_turn = body.rest_turn
        body.same = _is_as_left(s, address, body)
        if body.same:
            body.stamp = s.frame
            body.was_calm = 1 if body.calm > 0 or body.calm == -2 else 0
            body.has_rested = body.rests
            body.changed = 0
            moved = False
            continue
        met = body.stamp >= 0
        x, y, angle, w = body.x, body.y, body.angle, body.w
        body.left_vx = body.vx
        body.left_vy = body.vy
        if not body.undone:  # else it is known of the last one that has not failed
            body.gained = abs(body.vx - body.old_vx) + abs(body.vy - body.old_vy)
            body.gained += abs(body.w - body.old_w) * body.extent
            watch_rest(body, x, y, angle)
        body.undone = 0
        notice(s, address, body)
        told = met and body.inverse_mass == 0.0 and body.inverse_moment == 0.0
        # a new velocity has it ahead, by half a substep, of who goes along as fast as it went
        body.put_x = body.x - x + ahead * (body.vx - body.left_vx) if told else 0.0
        body.put_y = body.y - y + ahead * (body.vy - body.left_vy) if told else 0.0
        body.put_a = body.angle - angle + ahead * (body.w - w) if told else 0.0
        if not met:
            body.left_vx = body.vx
            body.left_vy = body.vy
            body.was_x = 0.0
            body.was_y = 0.0
            body.was_w = 0.0
            body.trend_x = 0.0
            body.trend_y = 0.0
            body.trend_w = 0.0
            body.lead_x = body.lead_y = body.lead_w = 0.0
        body.old_vx = body.vx
        body.old_vy = body.vy
        body.old_w = body.w
        body.old_since = body.since
        body.stamp = s.frame
        body.was_calm = 1 if body.calm > 0 or body.calm == -2 else 0
        body.has_rested = body.rests
        mobile = 1 if body.inverse_mass > 0.0 or body.inverse_moment > 0.0 else 0
        body.changed = 1 if mobile != body.mobile or not body.awake else 0
        body.mobile = mobile
        if not body.awake:
            add_to_awake(tables, i, body)
        function = words(address + s.body_position_func, 1)
        body.kind = DRIFTS if function[0] == s.hold_at else LED
        moved &= body.kind == LED
        if (function[0] == s.position_func or function[0] == s.position_func_again) and s.explicit == 0:
            # Chipmunk's own: a body that is new here. It will have been moved by a whole frame before the solve.
            body.kind = DRIFTS
            if moved:
                _take_back(body, dt)
        if met and body.kind == LED and not math.isfinite(body.x + body.y + body.angle):
            body.old_x = x  # it has been moved before the frame began for us: where the last one has left it
            body.old_y = y
            body.old_a = angle
        else:
            body.old_x = body.x
            body.old_y = body.y
            body.old_a = body.angle
        force = floats(address + s.body_force, 2)
        body.old_fx = force[0]
        body.old_fy = force[1]
        body.old_torque = floats(address + s.body_torque, 1)[0]
    n = 0
    for k in range(counters[AWAKE]):
        i = tables.awake[k]
        body = tables.bodies[i]
        if body.stamp == s.frame:
            tables.awake[n] = i
            n += 1
        else:
            put_to_rest(s, body)
            counters[UNSORTED] = 1
    counters[AWAKE] = n
    counters[MOVERS] = 0
    for k in range(n):
        body = tables.bodies[tables.awake[k]]
        if not _list_shapes(s, tables, body, body.changed == 1):
            return False
    return True


@kernel
def wake(s: Any, tables: Tables, i: int) -> None:
    """A body that Chipmunk has woken within its step."""
    body = tables.bodies[i]
    body.stamp = s.frame
    read_place(s, body.address, body)
    read_motion(s, body.address, body)
    body.mobile = 1 if body.inverse_mass > 0.0 or body.inverse_moment > 0.0 else 0
    body.kind = DRIFTS
    body.old_x = body.x
    body.old_y = body.y
    body.old_a = body.angle
    body.left_vx = body.vx
    body.left_vy = body.vy
    body.old_vx = body.vx
    body.old_vy = body.vy
    body.old_w = body.w
    body.old_fx = 0.0  # a force would have woken it before
    body.old_fy = 0.0
    body.old_torque = 0.0
    body.since = 0.0
    body.old_since = 0.0
    body.was_calm = 0
    body.old_turn = body.rest_turn
    if not body.awake:
        add_to_awake(tables, i, body)
        _list_shapes(s, tables, body, True)


@kernel
def look_again(s: Any, tables: Tables) -> None:
    """What callbacks of the user's have set of bodies since the frame began: it counts as set before.

    So that who is sent elsewhere is there, and a blow is of the velocities that a `begin` has left.
    """
    for k in range(tables.counters[AWAKE]):
        notice_again(s, tables.bodies[tables.awake[k]])


@kernel
def put_to_rest(s: Any, body: Any) -> None:
    """A body that is asleep, or static: where it has been left, and nothing moves it."""
    body.awake = 0
    body.kind = FIXED
    read_motion(s, body.address, body)
    body.mobile = 1 if body.inverse_mass > 0.0 or body.inverse_moment > 0.0 else 0
    body.inverse_mass = 0.0
    body.inverse_moment = 0.0
    body.gain_x = 0.0
    body.gain_y = 0.0
    body.gain_w = 0.0
    body.kick_x = 0.0
    body.kick_y = 0.0
    body.kick_w = 0.0
    body.load = math.inf


@kernel(forceinline=True)
def _take_back(body: Any, dt: float) -> None:
    """Undo Chipmunk's own drift."""
    body.x -= dt * body.vx
    body.y -= dt * body.vy
    body.angle -= dt * body.w
    place(body)
