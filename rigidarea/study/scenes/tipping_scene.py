"""A slender block on a steep rough incline tips about its lower corner."""

import math

from ..scene import ANGLE, Array, G, Scene, block, floor, relative_error
from ._motion import angle

WIDTH, HEIGHT, MU = 0.5, 1.0, 2.0
ALPHA = math.atan(WIDTH / HEIGHT)
"""Slope at which the block's weight passes through the corner: tan α = w/h."""
THETA = math.atan(1.2 * WIDTH / HEIGHT)
R = math.hypot(WIDTH, HEIGHT) / 2
P2 = 3 * G / (4 * R)
"""m g R/I about the corner, I = (4/3) m R²."""
DURATION = 0.75


def rotation(t: Array) -> Array:
    """Angle turned at times `t`: φ'' = p² sin(φ + θ − α), from rest."""
    return angle(lambda _, y: (y[1], P2 * math.sin(y[0] + THETA - ALPHA)), 0.0, t)


def scene() -> Scene:
    """tan θ = 1.2 w/h; gravity is turned instead of the floor."""
    return Scene(
        title="block tipping over",
        bodies=(floor(), block("block", WIDTH, HEIGHT, (0.0, HEIGHT / 2))),
        gravity=(G * math.sin(THETA), -G * math.cos(THETA)),
        friction=MU,
        duration=DURATION,
        error_name="angle, relative",
        error=lambda trace: relative_error(-trace["block"][:, ANGLE], rotation(trace.times)),
        source="rotation about a corner, I = (4/3) m R²; tips when tan θ > w/h",
        size=WIDTH,
        tags=frozenset({"corner"}),
    )
