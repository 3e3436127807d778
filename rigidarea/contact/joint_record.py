"""A joint as a frame has it: its kind, its numbers, what it did last."""

from __future__ import annotations

import math
from typing import Any

from ..compile.jit import kernel
from ..compile.raw_memory import record

PIN, SLIDE, PIVOT, GROOVE, SPRING, ROTARY_SPRING, LIMIT, RATCHET, GEAR, MOTOR = range(10)
#: Kinds of joints.
KINDS = 10
#: Parameters of a joint: what its struct has after the part that all constraints share; a pin's direction among them.
PARAMETERS, DIRECTION = 11, 9

#: A joint of the space while a frame has it.
JOINT = record(
    [
        ("address", "u8"),  # of Chipmunk's constraint
        ("own_class", "u8"),  # its class, a struct of Chipmunk's of four functions
        ("pre_solve", "u8"),  # the user's callback; 0: none
        ("kind", "i4"),  # as which it is solved, PIN to MOTOR; -1: unknown
        ("stored", "i4"),  # as which Chipmunk keeps it
        ("taken", "i4"),  # 1: since that, until the report, we run it
        ("a", "i4"),  # rows of its bodies; -1: not ours
        ("b", "i4"),
        ("order", "i4"),  # which joint comes here in a sweep
        ("mine", "i4"),  # 1: of the turn that is being solved
        ("ordered", "i4"),  # 1: its place in that is known
        ("max_force", "f8"),
        ("error_bias", "f8"),  # share of an error that is left after a unit of time
        ("max_bias", "f8"),  # (length/time)
        ("p", "f8", (PARAMETERS,)),
        ("force", "f8"),  # of a spring, what the user's function says in this frame
        ("asked", "i4"),  # 1: there is such a function; 2: it has been asked in this frame
        ("jx", "f8"),  # impulse that it did last, as Chipmunk keeps it
        ("jy", "f8"),
        ("step", "f8"),  # in this time; 0: never
        ("x", "f8"),  # and summed over the frame
        ("y", "f8"),
    ]
)


@kernel(forceinline=True)
def anchor(body: Any, x: float, y: float) -> tuple[float, float]:
    """A point of the body's frame, from its centre of gravity, world axes (length)."""
    x -= body.cog_x
    y -= body.cog_y
    return body.c * x - body.s * y, body.s * x + body.c * y


@kernel
def held_by(joint: Any, a: Any, b: Any) -> tuple[float, float, float]:
    """The force with which a pivot, pin, slide or spring held B in its last step, world axes, and its stiffness across.

    What pulls at d turns with what it holds: across itself it is as stiff as its force is by length. (What pushes is
    not: it would buckle.)
    """
    if joint.step <= 0.0 or joint.kind > SPRING or joint.kind == GROOVE:
        return 0.0, 0.0, 0.0
    if joint.kind == PIVOT:
        return joint.jx / joint.step, joint.jy / joint.step, 0.0
    ax, ay = anchor(a, joint.p[0], joint.p[1])
    bx, by = anchor(b, joint.p[2], joint.p[3])
    nx = b.x + bx - a.x - ax
    ny = b.y + by - a.y - ay
    distance = math.hypot(nx, ny)
    if distance == 0.0:
        return 0.0, 0.0, 0.0
    pull = -joint.jx / joint.step
    if joint.kind == SLIDE and distance < 0.5 * (joint.p[4] + joint.p[5]):  # Chipmunk keeps no sign of it
        pull = -pull
    return -pull * nx / distance, -pull * ny / distance, max(0.0, pull / distance)


@kernel(forceinline=True)
def unfollowed(phase2: float, most: float) -> float:
    """The part of a stiffness that steps do not follow: those do where (w h)^2 is `most` or less."""
    return 0.0 if phase2 <= most else 1.0 - (most / phase2) ** 2
