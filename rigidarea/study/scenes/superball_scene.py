"""A perfectly elastic ball keeps its height for ever."""

from ..scene import Elastic, G, Scene, Trace, disc, floor
from .bounce_scene import apex, flight

DROP, RADIUS, BOUNCES = 0.5, 0.25, 10
STEEL = Elastic(207e9, 0.29, 0.01, 0.02)
"""Of the ball."""


def error(trace: Trace) -> float:
    """Relative error of the height after ten bounces."""
    return abs(apex(trace, BOUNCES, DROP, 1.0, RADIUS) / DROP - 1)


def scene() -> Scene:
    """Drop 0.5 m, e = 1, ten bounces."""
    start, stop = flight(BOUNCES, DROP, 1.0)
    return Scene(
        title="elastic ball, ten bounces",
        bodies=(floor(), disc("ball", RADIUS, (0.0, RADIUS + DROP), elastic=STEEL)),
        elasticity=1.0,
        duration=(start + 3 * stop) / 4,
        error_name="relative error of tenth apex",
        error=error,
        source="conservation of energy",
        size=2 * RADIUS,
        pressure=2 * G * DROP / (2 * RADIUS) ** 3,
        tags=frozenset({"impact"}),
    )
