"""The joints of a scene file: their names, pymunk's classes, and what each of them is made from."""

from __future__ import annotations

import pymunk

POINT, NUMBER, LENGTH = "point", "number", "length"
"""Kinds of a field: [x, y] in a body's coordinates; any finite number; one that is not negative."""

#: type -> (class, fields in the order of its constructor, after the two bodies).
JOINTS: dict[str, tuple[type[pymunk.Constraint], dict[str, str]]] = {
    "pin": (pymunk.PinJoint, {"anchor_a": POINT, "anchor_b": POINT}),
    "slide": (pymunk.SlideJoint, {"anchor_a": POINT, "anchor_b": POINT, "min": LENGTH, "max": LENGTH}),
    "pivot": (pymunk.PivotJoint, {"anchor_a": POINT, "anchor_b": POINT}),
    "groove": (pymunk.GrooveJoint, {"groove_a": POINT, "groove_b": POINT, "anchor_b": POINT}),
    "spring": (
        pymunk.DampedSpring,
        {"anchor_a": POINT, "anchor_b": POINT, "rest_length": LENGTH, "stiffness": LENGTH, "damping": LENGTH},
    ),
    "rotary_spring": (
        pymunk.DampedRotarySpring,
        {"rest_angle": NUMBER, "stiffness": LENGTH, "damping": LENGTH},
    ),
    "rotary_limit": (pymunk.RotaryLimitJoint, {"min": NUMBER, "max": NUMBER}),
    "ratchet": (pymunk.RatchetJoint, {"phase": NUMBER, "ratchet": NUMBER}),
    "gear": (pymunk.GearJoint, {"phase": NUMBER, "ratio": NUMBER}),
    "motor": (pymunk.SimpleMotor, {"rate": NUMBER}),
}

#: Fields that a joint may have beside its own, with what pymunk gives them.
COMMON = ("max_force", "error_bias", "max_bias", "collide_bodies")

TYPES = {made: name for name, (made, _) in JOINTS.items()}
