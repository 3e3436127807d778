"""A block on an incline holds for ever while tan θ <= μ."""

import math

from ..scene import G, Scene, block, floor, rest_error

MU = 0.5
THETA = math.atan(0.9 * MU)


def scene() -> Scene:
    """tan θ = 0.9 μ, five seconds; gravity is turned instead of the floor."""
    return Scene(
        title="block held by friction",
        bodies=(floor(), block("block", 1.0, 0.5, (0.0, 0.25))),
        gravity=(G * math.sin(THETA), -G * math.cos(THETA)),
        friction=MU,
        duration=5.0,
        error_name="displacement after 5 s / length",
        error=lambda trace: rest_error(trace, ["block"], 1.0),
        source="Coulomb: holds if and only if tan θ <= μ",
        tags=frozenset({"rest", "friction", "flat"}),
    )
