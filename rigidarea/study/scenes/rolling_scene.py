"""A disc on an incline rolls with a = (2/3) g sin θ when μ >= tan θ/3."""

import math

from ..scene import ANGLE, G, Scene, Trace, X, disc, floor, relative_error

RADIUS, MU, THETA = 0.5, 0.5, math.radians(30)
ACCELERATION = 2 / 3 * G * math.sin(THETA)


def error(trace: Trace) -> float:
    """Largest error of distance travelled or rim distance turned, relative to the whole distance."""
    exact = ACCELERATION * trace.times**2 / 2
    ball = trace["disc"]
    return max(relative_error(way, exact) for way in (ball[:, X], -RADIUS * ball[:, ANGLE]))


def scene() -> Scene:
    """30 degrees, μ = 0.5 (tan θ/3 = 0.19), two seconds; gravity is turned instead of the floor."""
    return Scene(
        title="disc rolling down an incline",
        bodies=(floor(), disc("disc", RADIUS, (0.0, RADIUS))),
        gravity=(G * math.sin(THETA), -G * math.cos(THETA)),
        friction=MU,
        duration=2.0,
        error_name="distance and turn, relative",
        error=error,
        source="rolling without slip: a = g sin θ/(1 + I/(m r²)), I = m r²/2",
        tags=frozenset({"friction", "rolling"}),
    )
