"""Where the bodies are at a frame's start, and how they move."""

from __future__ import annotations

import math
from typing import Any

from ..compile.jit import kernel
from ..contact.constants import ROUNDING, STILL_KICK
from ..contact.islands import root_of
from ..contact.space_record import EXTREME, next_row_of_body
from ..contact.tables import AWAKE, CONCAVE, LED, NEAR, Tables
from ..contact.verdict import allowed
from .awake import wake
from .record import floats, members, read_motion, read_place, time_step, words

#: A body that goes so many of its sizes in a frame may come near more others than has been made room for.
FAST = 30.0


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


@kernel(forceinline=True)
def _given_whole(body: Any) -> bool:
    """Whether a function of the user's has changed a body's velocity in this frame, and it has that change."""
    return bool(body.vx != body.old_vx or body.vy != body.old_vy or body.w != body.old_w)


@kernel(forceinline=True)
def _half_on(change: float, before: float) -> float:
    """Half of a change, or of the one before, the smaller; none where they differ in sign.

    (minmod; P. L. Roe, Ann. Rev. Fluid Mech. 18 (1986), doi:10.1146/annurev.fl.18.010186.002005)
    """
    return 0.5 * math.copysign(min(abs(change), abs(before)), change) if change * before > 0.0 else 0.0


@kernel(forceinline=True)
def _turn(from_x: float, from_y: float, x: float, y: float) -> float:
    """The angle from one vector to another."""
    return math.atan2(from_x * y - from_y * x, from_x * x + from_y * y)


@kernel(forceinline=True)
def _look_ahead(body: Any, x: float, y: float) -> None:
    """What a function of the user's changes a velocity by in the middle of the frame: as it turns, so it goes on.

    (x, y): in this frame. It has seen where the body was when the frame began: of a body that rolls round a planet, a
    weight that lags behind would be a push. A player who dashes or stops is given that and nothing else (`_half_on`).
    """
    before = _turn(body.was_x - body.trend_x, body.was_y - body.trend_y, body.was_x, body.was_y)
    half = _half_on(_turn(body.was_x, body.was_y, x, y), before)
    body.kick_x = math.cos(half) * x - math.sin(half) * y
    body.kick_y = math.sin(half) * x + math.cos(half) * y


@kernel(forceinline=True)
def _lead(given: float, force: float, change: float, before: float, dt: float) -> float:
    """What a force has given ahead when a frame of dt ends, no more than half of what it gives in one (length/time).

    given: until now; force, change, before: its acceleration, by how much that has changed, and in the frame before.
    """
    given += dt * _half_on(change, before)
    most = 0.5 * dt * force
    return min(max(given, min(most, 0.0)), max(most, 0.0))


@kernel(forceinline=True)
def _left_of(lead: float, taken: float) -> float:
    """What is left to take back of what a force has given ahead, where contacts and joints have taken some of it."""
    return lead if lead * taken >= 0.0 else math.copysign(max(0.0, abs(lead) - abs(taken)), lead)


@kernel(forceinline=True)
def keep_leads(body: Any, gx: float, gy: float, dt: float) -> bool:
    """After a frame: what forces have given ahead (`leads`); whether that is anything."""
    body.lead_x, body.lead_y, body.lead_w = leads(body, gx, gy, dt)
    return bool(body.lead_x != 0.0 or body.lead_y != 0.0 or body.lead_w != 0.0)


@kernel
def drop_borne_leads(s: Any, tables: Tables) -> None:
    """What contacts and joints have borne of leads is not taken back.

    What the bodies of an island have borne of one another is still in it: all of them go on with that.
    """
    for k in range(tables.counters[AWAKE]):
        island = tables.islands[tables.awake[k]]
        island.mass = 0.0
        island.x = island.y = island.lead_x = island.lead_y = 0.0
    for k in range(tables.counters[AWAKE]):
        body = tables.bodies[tables.awake[k]]
        if _is_led(s, body) and body.inverse_mass > 0.0:
            mass = 1.0 / body.inverse_mass
            x, y = _taken_of(body)
            island = tables.islands[root_of(tables, tables.awake[k])]
            island.mass += mass
            island.x += mass * x
            island.y += mass * y
            island.lead_x += mass * (body.lead_x - _left_of(body.lead_x, x))
            island.lead_y += mass * (body.lead_y - _left_of(body.lead_y, y))
    for k in range(tables.counters[AWAKE]):
        body = tables.bodies[tables.awake[k]]
        if not _is_led(s, body):
            continue
        body.lead_w = _left_of(body.lead_w, body.w - body.old_w - body.gain_w)
        if body.inverse_mass > 0.0:
            x, y = _taken_of(body)
            island = tables.islands[root_of(tables, tables.awake[k])]
            body.lead_x = _left_of(body.lead_x, x) + _left_of(island.lead_x, island.x) / island.mass
            body.lead_y = _left_of(body.lead_y, y) + _left_of(island.lead_y, island.y) / island.mass


@kernel(forceinline=True)
def _is_led(s: Any, body: Any) -> bool:
    """Whether forces have moved a body in this frame."""
    return bool(body.stamp == s.frame and (body.steps > 0 or s.explicit > 0))


@kernel(forceinline=True)
def _taken_of(body: Any) -> tuple[float, float]:
    """What contacts and joints have given to a body in this frame (length/time)."""
    return body.vx - body.old_vx - body.gain_x, body.vy - body.old_vy - body.gain_y


@kernel(forceinline=True)
def leads(body: Any, gx: float, gy: float, dt: float) -> tuple[float, float, float]:
    """Forces were told where the body was when the frame began, and act in its middle: as they change, they go on.

    Else springs and rafts that a program makes of forces would swing higher and higher: a force that lags by half a
    frame gives energy. (The second order of Adams and Bashforth.) What has been given ahead is taken back as the force
    goes: a thruster gives what it is told and nothing else.
    """
    return (
        _lead(body.lead_x, body.forced_x - gx, body.forced_x - body.was_x, body.trend_x, dt),
        _lead(body.lead_y, body.forced_y - gy, body.forced_y - body.was_y, body.trend_y, dt),
        _lead(body.lead_w, body.forced_w, body.forced_w - body.was_w, body.trend_w, dt),
    )


@kernel(forceinline=True)
def _touch(tables: Tables, near: Any, frame: int) -> bool:
    """Whether a near pair touched when the last frame ended, and may collide in this one."""
    pair = tables.pairs[near.pair]
    return bool(pair.head >= 0 and allowed(tables, pair, frame))


@kernel
def _hold_back(s: Any, tables: Tables) -> None:
    """What presses bodies against what they touch is a kick, whoever gives it: contacts answer before they have moved.

    All that a function of the user's has changed of a velocity, since friction answers to that as well; of what the
    user has set a velocity to, the part that closes. (Sent into a wall in every frame, a body would else be in it by
    half a substep's way, in every frame.)
    """
    for i in range(tables.counters[NEAR]):
        near = tables.near[i]
        if _touch(tables, near, s.frame):
            for k in (near.a, near.b):
                body = tables.bodies[k]
                if body.mobile and body.stamp == s.frame and _given_whole(body):
                    body.gain_x += body.kick_x
                    body.gain_y += body.kick_y
                    body.gain_w += body.w - body.old_w
                    body.vx = body.old_vx
                    body.vy = body.old_vy
                    body.w = body.old_w
    for n in range(s.sweeps):  # who is held holds those behind
        held = False
        for i in range(tables.counters[NEAR]):
            near = tables.near[i if n % 2 == 0 else tables.counters[NEAR] - 1 - i]
            if _touch(tables, near, s.frame):
                r = tables.pairs[near.pair].head
                while r >= 0:
                    held |= _hold_apart(s, tables.regions[r], tables.bodies[near.a], tables.bodies[near.b])
                    r = tables.regions[r].next
        if not held:
            break


@kernel
def _hold_apart(s: Any, region: Any, a: Any, b: Any) -> bool:
    """Hold back, of the velocities that the user has set two bodies to, by what they close where they touch; whether
    that was anything.
    """
    nx = region.nx
    ny = region.ny
    of_a = 0.0
    of_b = 0.0
    if a.mobile and a.stamp == s.frame:
        of_a = max(0.0, (a.vx - a.left_vx) * nx + (a.vy - a.left_vy) * ny)
    if b.mobile and b.stamp == s.frame:
        of_b = max(0.0, (b.left_vx - b.vx) * nx + (b.left_vy - b.vy) * ny)
    set_speed = of_a + of_b
    closing = (a.vx - b.vx) * nx + (a.vy - b.vy) * ny
    if set_speed <= 0.0 or closing <= ROUNDING * set_speed:
        return False
    part = min(1.0, closing / set_speed)
    _keep_for_the_kick(a, part * of_a * nx, part * of_a * ny)
    _keep_for_the_kick(b, -part * of_b * nx, -part * of_b * ny)
    return True


@kernel(forceinline=True)
def _keep_for_the_kick(body: Any, vx: float, vy: float) -> None:
    """A part of a body's velocity is given with what the frame adds."""
    body.vx -= vx
    body.vy -= vy
    body.gain_x += vx
    body.gain_y += vy


@kernel(forceinline=True)
def _pushed_as_before(s: Any, address: int, body: Any, dt: float) -> bool:
    """Whether what the frame gives to a body at rest is what the last one gave."""
    v = floats(address + s.body_velocity, 2)
    change = abs(v[0] - body.gain_x) + abs(v[1] - body.gain_y)
    change += abs(floats(address + s.body_spin, 1)[0] - body.gain_w) * body.extent
    return bool(change <= STILL_KICK * (abs(body.gain_x) + abs(body.gain_y) + abs(body.gain_w) * body.extent))


@kernel
def start_frame(s: Any, space: int, tables: Tables) -> bool:
    """Where the bodies are at the frame's start, and what Chipmunk's and the user's functions did to velocities.

    What those did is spread over the frame (`gain`). Whether bodies' numbers may overflow in it, or room run out, is
    noted (`fragile`); of pairs and joints that is known.

    False: the state of one (`broken`) is not finite. Later that would have spread to others.
    """
    s.broken = -1
    # two that are concave may overlap in any number of places: who is at rest keeps its own
    concave = tables.counters[CONCAVE] > 0
    dt = time_step(space)
    rate = 1.0 / dt if dt > 0.0 else 0.0
    g = floats(space + s.space_gravity, 3)
    damped = 1.0 - g[2] ** dt  # Chipmunk's damping stands behind its gravity
    pressed = False
    i = -1
    for address in members(space, s.space_bodies):
        i = next_row_of_body(s, tables.bodies, i, address)
        if i < 0:
            continue
        body = tables.bodies[i]
        if body.stamp != s.frame:
            wake(s, tables, i)
        body.same = body.same and body.since > 0.0 and body.disturbed != s.frame
        if body.same and _pushed_as_before(s, address, body, dt):
            s.fragile |= _is_extreme(body, dt)
            continue
        body.same = 0
        if s.explicit or body.kind == LED:
            read_place(s, address, body)
        read_motion(s, address, body)
        state = body.x + body.y + body.angle + body.vx + body.vy + body.w
        if not math.isfinite(state + body.inverse_mass + body.inverse_moment):
            s.broken = i if s.broken < 0 else s.broken
            continue
        if _is_extreme(body, dt) or (concave and body.mobile and not body.was_calm):
            s.fragile = 1
        x = body.vx - body.old_vx
        y = body.vy - body.old_vy
        function = words(address + s.body_velocity_func, 1)[0]
        own = (
            function != s.velocity_func and function != s.velocity_func_again
        )  # the user's: whole, as in pymunk
        if own:
            _look_ahead(body, x, y)
        w = body.w - body.old_w
        lost = 0.0 if own else damped
        body.forced_x = rate * (x + lost * body.old_vx)
        body.forced_y = rate * (y + lost * body.old_vy)
        body.forced_w = rate * (w + lost * body.old_w)
        body.gain_x = body.gain_y = body.gain_w = 0.0
        # of an explicit frame it has been given, and contacts want to know it all the same
        if s.explicit or not own:
            body.gain_x = x
            body.gain_y = y
            body.gain_w = w
        if s.explicit or own:
            body.lead_x = body.lead_y = body.lead_w = 0.0
        else:
            ahead_x, ahead_y, ahead_w = leads(body, g[0], g[1], dt)
            body.gain_x += ahead_x - body.lead_x
            body.gain_y += ahead_y - body.lead_y
            body.gain_w += ahead_w - body.lead_w
            body.vx = body.old_vx
            body.vy = body.old_vy
            body.w = body.old_w
        pressed |= body.vx != body.left_vx or body.vy != body.left_vy
    if pressed and not s.explicit:
        _hold_back(s, tables)
    return bool(s.broken < 0)
