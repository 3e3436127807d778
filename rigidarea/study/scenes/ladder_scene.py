"""A smooth ladder slides down a smooth wall and leaves it at two thirds of its first height."""

import math

import numpy as np
from scipy.integrate import quad

from ..scene import ANGLE, Array, Body, G, Polygon, Scene, Trace, floor
from ._motion import angle

LENGTH, THICK, START = 2.0, 0.1, math.radians(60)
"""A rhombus, so that its two tips are the ladder's ends; START is the angle above the floor."""


def moment(mass: float) -> float:
    """Of a rhombus with diagonals p, q about its centre: m (p² + q²)/24."""
    return mass * (LENGTH**2 + THICK**2) / 24


P2 = G * (LENGTH / 2) / ((LENGTH / 2) ** 2 + moment(1.0))
"""θ'' = −P2 cos θ: the centre moves on a circle of radius L/2, so m (L/2)² + I is the inertia."""


def leaving_angle() -> float:
    """sin θ = (2/3) sin θ₀ (for any moment of inertia: the wall's force is m x'' and x = (L/2) cos θ)."""
    return math.asin(2 / 3 * math.sin(START))


def leaving_time() -> float:
    """∫ dθ/θ', θ'² = 2 P2 (sin θ₀ − sin θ); θ = θ₀ − u² takes the root out of the integrand."""

    def integrand(u: float) -> float:
        if u == 0:
            return 2 / math.sqrt(2 * P2 * math.cos(START))
        drop = 2 * math.cos(START - u * u / 2) * math.sin(u * u / 2)
        return 2 * u / math.sqrt(2 * P2 * drop)

    return float(quad(integrand, 0.0, math.sqrt(START - leaving_angle()), epsabs=1e-13)[0])


def angle_at(t: Array) -> Array:
    """Angle above the floor at times `t`, while both ends touch."""
    return angle(lambda _, y: (y[1], -P2 * math.cos(y[0])), START, t)


def error(trace: Trace) -> float:
    """Largest error of the angle before the ladder leaves the wall, relative to the angle turned by then."""
    before = trace.times < leaving_time()
    exact = angle_at(trace.times[before])
    found = math.pi - trace["ladder"][before, ANGLE]
    return float(np.max(np.abs(found - exact)) / (START - leaving_angle()))


def leaning(steep: float) -> tuple[Body, Body]:
    """The wall x = 0, and a ladder that leans on it to the left, at the angle `steep` above the floor."""
    h = LENGTH / 2
    shape = Polygon(((-h, 0.0), (0.0, -THICK / 2), (h, 0.0), (0.0, THICK / 2)))
    wall = Body("wall", (Polygon(((-1.0, -5.0), (0.0, -5.0), (0.0, 5.0), (-1.0, 5.0))),), kind="static")
    # The body's +x axis points from the floor end up to the wall end.
    centre = (h * math.cos(steep), h * math.sin(steep))
    return wall, Body("ladder", (shape,), centre, math.pi - steep, moment=moment(1.0))


def scene() -> Scene:
    """2 m, released at 60 degrees."""
    return Scene(
        title="ladder sliding down a wall",
        bodies=(floor(), *leaning(START)),
        duration=0.75,
        error_name="angle before leaving, relative",
        error=error,
        source="energy: θ'² = 2 g' (sin θ₀ − sin θ); leaves at sin θ = (2/3) sin θ₀",
        size=LENGTH,
        tags=frozenset({"corner"}),
    )
