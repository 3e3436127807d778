"""A smooth pin swings in a journal that it almost fills: a conforming contact."""

import math

from ..scene import Body, Elastic, Scene, disc, slab_with_hole
from .bowl_slide_scene import path_error, period, swing

HOLE, PIN, START = 1.0, 0.9, math.radians(60)
RHO = HOLE - PIN
STEEL = Elastic(207e9, 0.29, 0.01, 0.05)
"""Of the pin."""


def scene() -> Scene:
    """Hole 1 m, pin 0.9 m, so a pendulum of 0.1 m; two periods from 60 degrees, no friction."""
    start = (RHO * math.sin(START), -RHO * math.cos(START))
    journal = Body("journal", (slab_with_hole(HOLE, 1.5),), kind="static")
    return Scene(
        title="smooth pin in a journal",
        bodies=(journal, disc("pin", PIN, start, elastic=STEEL)),
        duration=2 * period(RHO, START),
        error_name="position over two periods / arc",
        error=lambda trace: path_error(trace, "pin", RHO, swing(trace.times, RHO, START)),
        source="pendulum of length ρ = R − r: T = 4 sqrt(ρ/g) K(sin²(θ₀/2))",
        frame=1 / 120,
        tags=frozenset({"curved", "conforming", "concave"}),
    )
