"""A smooth disc thrown along the inside of a circle leaves it where gravity takes it off the wall."""

import math

from ..scene import Array, Body, G, Scene, disc, place_error, slab_with_hole
from ._motion import slide_and_fly

HOLE, RADIUS = 1.0, 0.1
RHO = HOLE - RADIUS
THROW = 3.5
"""v₀²/(g ρ) at the bottom: between 2 (it stays below the axis) and 5 (it goes all the way round)."""
SPEED = math.sqrt(THROW * G * RHO)


def leaving_angle() -> float:
    """Angle from the bottom at which N = 0: cos θ = (2 − v₀²/(g ρ))/3."""
    return math.acos((2 - THROW) / 3)


def motion(t: Array) -> tuple[Array, float]:
    """Places (n, 2) at times `t`, and the time of leaving, where m v²/ρ = −m g cos θ.

    Valid until the disc meets the wall again.
    """
    return slide_and_fly(RHO, 0.0, SPEED, leaving_angle(), t)


def scene() -> Scene:
    """v₀² = 3.5 g ρ: leaves the wall 120 degrees from the bottom; stops before the disc lands again."""
    ring = Body("ring", (slab_with_hole(HOLE, 1.5),), kind="static")
    return Scene(
        title="smooth disc in a loop, leaving the wall",
        bodies=(ring, disc("disc", RADIUS, (0.0, -RHO), velocity=(SPEED, 0.0))),
        duration=0.85,
        error_name="position / path radius",
        error=lambda trace: place_error(trace["disc"], motion(trace.times)[0], RHO),
        source="energy and N = 0: cos θ = (2 − v₀²/(g ρ))/3",
        size=2 * RADIUS,
        pressure=THROW * G / (2 * RADIUS) ** 2,
        tags=frozenset({"curved", "concave"}),
    )
