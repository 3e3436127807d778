"""A block on an incline slides with a = g (sin θ − μ cos θ) when tan θ > μ."""

import math

from ..scene import G, Scene, X, block, floor, relative_error

MU = 0.3
THETA = math.atan(0.6)
ACCELERATION = G * (math.sin(THETA) - MU * math.cos(THETA))


def scene() -> Scene:
    """tan θ = 0.6, μ = 0.3, two seconds from rest; gravity is turned instead of the floor."""
    return Scene(
        title="block sliding down an incline",
        bodies=(floor(), block("block", 1.0, 0.5, (0.0, 0.25))),
        gravity=(G * math.sin(THETA), -G * math.cos(THETA)),
        friction=MU,
        duration=2.0,
        error_name="distance, relative",
        error=lambda trace: relative_error(trace["block"][:, X], ACCELERATION * trace.times**2 / 2),
        source="Coulomb and Newton: a = g (sin θ − μ cos θ)",
        tags=frozenset({"friction", "flat"}),
    )
