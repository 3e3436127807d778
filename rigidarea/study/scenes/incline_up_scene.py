"""A block pushed up an incline stops after v²/(2 g (sin θ + μ cos θ)) and stays."""

import math

import numpy as np

from ..scene import G, Scene, X, block, floor, relative_error

MU, V = 0.5, 4.0
THETA = math.atan(0.3)
DECELERATION = G * (math.sin(THETA) + MU * math.cos(THETA))


def position(t: np.ndarray) -> np.ndarray:
    """Distance up the incline at times `t`."""
    t = np.minimum(t, V / DECELERATION)
    return V * t - DECELERATION * t**2 / 2


def scene() -> Scene:
    """4 m/s up a slope of tan θ = 0.3 with μ = 0.5 (it must not slide back); gravity is turned, not the floor."""
    return Scene(
        title="block pushed up an incline",
        bodies=(floor(), block("block", 1.0, 0.5, (0.0, 0.25), velocity=(V, 0.0))),
        gravity=(-G * math.sin(THETA), -G * math.cos(THETA)),
        friction=MU,
        duration=2.0,
        error_name="distance, relative",
        error=lambda trace: relative_error(trace["block"][:, X], position(trace.times)),
        source="Coulomb and Newton: deceleration g (sin θ + μ cos θ), then rest because tan θ < μ",
        tags=frozenset({"friction", "flat"}),
    )
