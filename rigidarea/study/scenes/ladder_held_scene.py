"""A ladder leaning on a rough wall, just steep enough to stand."""

import math

from ..scene import Scene, floor, rest_error
from .ladder_scene import LENGTH, leaning

STEEP, MARGIN = math.radians(60), 1.05


def least_friction(steep: float) -> float:
    """The least μ, the same at floor and wall, with which a ladder at the angle `steep` above the floor can stand.

    Both ends on the point of slipping: the wall pushes with N₂ = μ N₁ and holds up μ N₂, so N₁ (1 + μ²) = m g.
    Moments about the foot: N₂ (sin θ + μ cos θ) = m g cos θ/2. Together tan θ = (1 − μ²)/(2 μ), which is the tangent
    of π/2 − 2 atan μ.
    """
    return math.tan((math.pi / 2 - steep) / 2)


def scene() -> Scene:
    """2 m, 60 degrees, 1.05 of the least friction at both ends: nothing moves."""
    return Scene(
        title="ladder held by friction at 1.05 of the limit",
        bodies=(floor(), *leaning(STEEP)),
        friction=MARGIN * least_friction(STEEP),
        duration=5.0,
        error_name="displacement after 5 s / length",
        error=lambda trace: rest_error(trace, ["ladder"], LENGTH),
        source="statics: tan θ = (1 − μ²)/(2 μ)",
        size=LENGTH,
        tags=frozenset({"rest", "corner", "friction"}),
    )
