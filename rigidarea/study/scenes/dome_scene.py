"""A smooth disc slides off a round dome: it leaves at cos θ = (2/3) cos θ₀."""

import math

from ..scene import Array, Body, Circle, Scene, disc, place_error
from ._motion import slide_and_fly

DOME, RADIUS, START = 1.0, 0.2, 0.3
RHO = DOME + RADIUS


def motion(t: Array) -> tuple[Array, float]:
    """Places (n, 2) at times `t`, and the time of leaving, where m v²/ρ = m g cos θ, θ from the top."""
    leaving = math.pi - math.acos(2 / 3 * math.cos(START))  # from the lowest point, as is the start
    return slide_and_fly(RHO, math.pi - START, 0.0, leaving, t)


def scene() -> Scene:
    """Released at rest 0.3 rad from the top; no friction."""
    dome = Body("dome", (Circle(DOME),), kind="static")
    start = (RHO * math.sin(START), RHO * math.cos(START))
    return Scene(
        title="smooth disc sliding off a dome",
        bodies=(dome, disc("disc", RADIUS, start)),
        duration=1.1,
        error_name="position / path radius",
        error=lambda trace: place_error(trace["disc"], motion(trace.times)[0], RHO),
        source="energy and N = 0: cos θ = (2/3) cos θ₀",
        size=2 * RADIUS,
        tags=frozenset({"curved"}),
    )
