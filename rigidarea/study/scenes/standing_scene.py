"""A slender block on an incline stands while tan θ < w/h."""

import math

from ..scene import G, Scene, block, floor, rest_error
from .tipping_scene import HEIGHT, MU, WIDTH

THETA = math.atan(0.9 * WIDTH / HEIGHT)


def scene() -> Scene:
    """tan θ = 0.9 w/h, five seconds; gravity is turned instead of the floor."""
    return Scene(
        title="block standing on an incline",
        bodies=(floor(), block("block", WIDTH, HEIGHT, (0.0, HEIGHT / 2))),
        gravity=(G * math.sin(THETA), -G * math.cos(THETA)),
        friction=MU,
        duration=5.0,
        error_name="displacement after 5 s / width",
        error=lambda trace: rest_error(trace, ["block"], WIDTH),
        source="statics: stands if and only if tan θ <= w/h",
        size=WIDTH,
        tags=frozenset({"rest", "corner", "flat"}),
    )
