"""A frame is given back to Chipmunk."""

from __future__ import annotations

from typing import Any

from ..compile.jit import kernel
from ..contact.tables import AWAKE, DRIFTS, LED, Tables
from ..geometry.place import place
from .frame_start import drop_borne_leads, keep_leads
from .joints import joints_of
from .record import cache_boxes, floats, words, write_bias, write_motion, write_place


@kernel
def finish_frame(s: Any, space: int, tables: Tables, good: bool, dt: float) -> None:
    """Give everything back to Chipmunk: velocities, places, and the shapes' boxes that queries look at.

    Of a frame that failed also what the user's position functions have moved.
    """
    g = floats(space + s.space_gravity, 2)
    leading = False
    for k in range(tables.counters[AWAKE]):
        body = tables.bodies[tables.awake[k]]
        if body.stamp != s.frame:
            continue
        if body.steps == 0 and good and s.explicit == 0 and body.kind == DRIFTS:  # at rest, as it was
            write_motion(s, body)
            continue
        if good:  # a frame that is run again, or fails, has not been
            leading |= keep_leads(body, g[0], g[1], dt)
            body.trend_x = body.forced_x - body.was_x
            body.trend_y = body.forced_y - body.was_y
            body.trend_w = body.forced_w - body.was_w
            body.was_x = body.forced_x
            body.was_y = body.forced_y
            body.was_w = body.forced_w
        if body.mobile or not good:
            write_motion(s, body)
        if body.kind == LED and body.mobile and good and dt > 0.0:
            write_bias(s, body, dt)
        if (body.kind == DRIFTS and s.explicit == 0) or not good:
            if body.kind == DRIFTS:
                place(body)
            write_place(s, body)
            if body.kind == DRIFTS and s.explicit == 0:
                words(body.address + s.body_position_func, 1)[0] = s.hold_at
            cache_boxes(s, body)
    if leading:
        drop_borne_leads(s, tables)
    if good and s.explicit == 0:  # what joints have made of the velocity of bodies that are in no space
        for joint in joints_of(s):
            for i in (joint.a, joint.b):
                if i >= 0 and not tables.bodies[i].awake and tables.bodies[i].inverse_mass > 0.0:
                    write_motion(s, tables.bodies[i])
