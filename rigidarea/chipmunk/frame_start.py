"""Where the bodies are at a frame's start, and how they move."""

from __future__ import annotations

import math
from typing import Any

from ..compile.jit import kernel
from ..contact.space_record import EXTREME, next_row_of_body
from ..contact.tables import CONCAVE, LED, Tables
from .awake import wake
from .record import members, read_motion, read_place, time_step, words

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
    i = -1
    for address in members(space, s.space_bodies):
        i = next_row_of_body(s, tables.bodies, i, address)
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
