"""Who is at rest: of whom a frame would be as the one before is not solved again.

An island of which nobody moves, where nothing that goes into its frame has changed, takes no substep. What is changed
on the way that pymunk knows it (a force, a shape's material, whoever comes near or goes) is seen as it begins:
`disturbed` tells of what no body's motion tells. Its contacts go on bearing what they bore.
"""

from __future__ import annotations

from typing import Any

from ..compile.jit import kernel
from .constants import REST_TIME, SLOWLY, STILL_KICK, STILL_WAY
from .tables import AWAKE, DRIFTS, FIRST, FIXED, LAST, LYING, NEAR, SUBSTEP, Law, Tables

#: So many frames at the least: stiffness follows a load in the frame after.
RESTED = 3


@kernel(forceinline=True)
def watch_rest(body: Any, x: float, y: float, angle: float) -> None:
    """How far a body at (x, y, angle) has gone (`went`) since it moved last, or in one to two REST_TIMEs."""
    if body.rests == 0.0:
        body.rest_x, body.rest_y, body.rest_a = body.old_x, body.old_y, body.old_a
    elif body.rests >= 2.0 * REST_TIME:
        body.rest_x, body.rest_y, body.rest_a = x, y, angle
        body.rests -= REST_TIME
    body.went = abs(x - body.rest_x) + abs(y - body.rest_y) + abs(angle - body.rest_a) * body.extent


@kernel(forceinline=True)
def _pushed(body: Any) -> float:
    """What forces and gravity would do to a body (length/time^2)."""
    return float(abs(body.forced_x) + abs(body.forced_y) + abs(body.forced_w) * body.extent)


@kernel(forceinline=True)
def _visible(body: Any, dt: float) -> float:
    """How far a body must go to have moved, in the time for which it has kept its place (length)."""
    time = max(body.has_rested + dt, RESTED * dt)
    return STILL_KICK * 0.5 * time * time * _pushed(body)


@kernel(forceinline=True)
def keeps_its_place(law: Law, body: Any, dt: float) -> bool:
    """Whether a body does not leave its place, and is pushed as in the frame before.

    What nothing pushes, or no contact bears and no joint, keeps its place where it does not move at all: slowly it
    would go on.
    """
    if body.disturbed == law.frame or body.since == 0.0 or body.asked > 0:
        return False
    speed = abs(body.vx) + abs(body.vy) + abs(body.w) * body.extent
    if body.extent == 0.0 and (body.w != 0.0 or body.forced_w != 0.0):
        return False  # no shape says how fast that is
    if not body.mobile:
        still = speed == 0.0 and body.w == 0.0
        return bool(still and body.put_x == 0.0 and body.put_y == 0.0 and body.put_a == 0.0)
    change = abs(body.forced_x - body.was_x) + abs(body.forced_y - body.was_y)
    change += abs(body.forced_w - body.was_w) * body.extent
    pushed = _pushed(body)
    room = 0.0
    if pushed > 0.0 and (body.pushed & LYING or body.calm < 0):
        unsolved = REST_TIME * SLOWLY * body.unsolved
        room = max(_visible(body, dt), min(unsolved, STILL_WAY * body.extent))
    return bool(body.kind == DRIFTS and change <= STILL_KICK * pushed and max(body.went, dt * speed) <= room)


@kernel(forceinline=True)
def has_come_to_rest(body: Any, dt: float) -> bool:
    """Whether a body has kept its place for long enough: REST_TIME, or RESTED frames where it has not moved at all."""
    if body.rests >= max(REST_TIME, (RESTED - 0.5) * dt):
        return True
    return bool(
        body.rests >= (RESTED - 0.5) * dt and body.went <= (_visible(body, dt) if body.mobile else 0.0)
    )


@kernel
def disturb_partners(tables: Tables, frame: int, n: int) -> None:
    """Who is near what does not move, and has been changed, wants n substeps (after `find_near`)."""
    for i in range(tables.counters[NEAR]):
        near = tables.near[i]
        a = tables.bodies[near.a]
        b = tables.bodies[near.b]
        if a.kind == FIXED and max(a.disturbed, a.replaced) == frame:
            b.wants = max(n, b.wants)
        elif b.kind == FIXED and max(b.disturbed, b.replaced) == frame:
            a.wants = max(n, a.wants)


@kernel
def rest(tables: Tables, then: int, dt: float) -> int:
    """Bodies at rest, and the live pairs, theirs, go on for a frame of dt: how many contacts they have.

    then: the substep in which they were looked at last (counters[SUBSTEP]).
    """
    counters = tables.counters
    for k in range(counters[AWAKE]):
        body = tables.bodies[tables.awake[k]]
        if body.steps == 0 and not body.same:
            body.vx = body.vy = body.w = 0.0
            body.old_vx = body.old_vy = body.old_w = 0.0
            body.left_vx = body.left_vy = 0.0
    contacts = 0
    for i in range(counters[FIRST], counters[LAST]):
        pair = tables.pairs[tables.near[i].pair]
        if pair.parted == then:
            pair.parted = counters[SUBSTEP]
        r = pair.head
        while r >= 0:
            region = tables.regions[r]
            region.stamp = counters[SUBSTEP]
            pair.jx += dt * (region.force * region.nx - region.friction * region.ny)
            pair.jy += dt * (region.force * region.ny + region.friction * region.nx)
            contacts += 1
            r = region.next
    return contacts
