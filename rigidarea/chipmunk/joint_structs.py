"""Where Chipmunk keeps the numbers of each class of joints: probed as `chipmunk` probes bodies and shapes."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
import pymunk
from pymunk._chipmunk_cffi import ffi, lib

from .structs import LayoutError, layout, word_at


class JointKind(NamedTuple):
    """Where one class of joints keeps its numbers (bytes; chipmunk_structs.h); of how many they are."""

    own_class: int  # address of its four functions
    impulse: int
    impulses: int  # one or two
    parameters: int  # what it is made of, after what all constraints have
    numbers: int
    force: int  # a spring's force function; 0: it has none
    own_force: int  # Chipmunk's own


def _make_joint(name: str, one: pymunk.Body, two: pymunk.Body) -> tuple[Any, tuple[float, ...]]:
    """A joint of a class, and the parameters that its struct should have."""
    ax, ay, bx, by = 0.25, 0.5, -0.75, 0.125
    a, b = (ax, ay), (bx, by)
    if name == "GrooveJoint":
        joint = pymunk.GrooveJoint(one, two, (-1, 0.5), (2, 0.5), b)
        return joint, (0, 1, -1, 0.5, 2, 0.5, bx, by)
    given: dict[str, tuple[Any, ...]] = {
        "PinJoint": (a, b),
        "SlideJoint": (a, b, 0, 1),
        "PivotJoint": (a, b),
        "DampedSpring": (a, b, 1, 10, 1.5),
        "DampedRotarySpring": (1, 10, 1.5),
        "RotaryLimitJoint": (-2, -1),
        "RatchetJoint": (0, -0.5),
        "GearJoint": (1, 2),
        "SimpleMotor": (-4,),
    }
    joint = getattr(pymunk, name)(one, two, *given[name])
    if name == "PinJoint":
        # and what it had in the last step: where its ends were, and the direction of its impulse
        return joint, (ax, ay, bx, by, joint.distance, *[0.0] * 6)
    if name == "RatchetJoint":
        return joint, (joint.angle, 0, -0.5)
    own = given[name]
    return joint, ((ax, ay, bx, by, *own[2:]) if own[0] == a else own)


#: Where a joint keeps its impulse (bytes), and how many numbers that is; `kinds_of_joints` checks.
_IMPULSES = {
    "PinJoint": (200, 1),
    "SlideJoint": (208, 1),
    "PivotJoint": (200, 2),
    "GrooveJoint": (256, 2),
    "DampedSpring": (240, 1),
    "DampedRotarySpring": (160, 1),
    "RotaryLimitJoint": (136, 1),
    "RatchetJoint": (144, 1),
    "GearJoint": (144, 1),
    "SimpleMotor": (120, 1),
}


@lru_cache(maxsize=1)
def kinds_of_joints() -> tuple[JointKind, ...]:
    """Every class of joints, in the order of `contact.joint_record`.

    Each is loaded for a step, and must have what Chipmunk calls its impulse there, and its parameters, else
    LayoutError.
    """
    kinds = []
    for name, (at, n) in _IMPULSES.items():
        space = pymunk.Space()
        one, two = pymunk.Body(1, 1), pymunk.Body(1, 1)
        two.position = 3, 0.5
        two.velocity, two.angular_velocity = (5, 7), 3
        joint, expected = _make_joint(name, one, two)
        first = layout()["constraint_collide"] + 32  # after its flag, two callbacks, and the user's data
        found = np.frombuffer(ffi.buffer(ffi.cast("char *", joint._constraint) + first, 8 * len(expected)))
        if not np.allclose(found, expected, rtol=1e-15, atol=0):
            raise LayoutError(f"{name}: expected the parameters {expected}, found {found}")
        force, own_force = _force_function(name, joint, at)
        space.add(one, two, joint)
        lib.cpSpaceStep(space._space, 0.125)  # not space.step, which somebody may have wrapped
        impulse = np.frombuffer(ffi.buffer(ffi.cast("char *", joint._constraint), at + 8 * n))[at // 8 :]
        if not (joint.impulse != 0 and math.isclose(abs(joint.impulse), math.hypot(*impulse), rel_tol=1e-12)):
            raise LayoutError(f"{name}: its impulse {joint.impulse} is not where it was expected, {impulse}")
        kinds.append(JointKind(word_at(joint._constraint, 0), at, n, first, len(expected), force, own_force))
    return tuple(kinds)


def _force_function(name: str, joint: Any, size: int) -> tuple[int, int]:
    """Where a spring keeps its force function (bytes), and Chipmunk's own; (0, 0) of other joints."""
    names = {"DampedSpring": "force_func", "DampedRotarySpring": "torque_func"}
    if name not in names:
        return 0, 0
    other, _ = _make_joint(name, joint.a, joint.b)
    before = np.frombuffer(ffi.buffer(ffi.cast("char *", other._constraint), size), np.uint64).copy()
    setattr(other, names[name], lambda *arguments: 0.0)
    after = np.frombuffer(ffi.buffer(ffi.cast("char *", other._constraint), size), np.uint64)
    places = np.flatnonzero(before != after)
    if len(places) != 1:
        raise LayoutError(f"{name}: expected one place of its force function, found {len(places)}")
    return 8 * int(places[0]), int(before[places[0]])
