"""A tilted slender block falls back on its base (Housner's rocking block, first quarter period)."""

import math

import numpy as np
from scipy.integrate import quad

from ..scene import ANGLE, Array, G, Scene, Trace, block, floor
from ._motion import angle

WIDTH, HEIGHT, MU = 0.4, 2.0, 2.0
ALPHA = math.atan(WIDTH / HEIGHT)
R = math.hypot(WIDTH, HEIGHT) / 2
P = math.sqrt(3 * G / (4 * R))
TILT = ALPHA / 2


def tilt_at(t: Array) -> Array:
    """Tilt at times `t`: θ'' = −p² sin(α − θ), from rest at θ₀; no small-angle assumption, up to the impact."""
    return angle(lambda _, y: (y[1], -(P**2) * math.sin(ALPHA - y[0])), TILT, t)


def quarter() -> float:
    """Time of the impact: ∫ dθ/θ', with θ'² = 2 p² (cos(α − θ) − cos(α − θ₀)) from energy.

    The substitution θ = θ₀ (1 − u²) takes the root out of the integrand.
    """

    def integrand(u: float) -> float:
        # cos a − cos b = 2 sin((a + b)/2) sin((b − a)/2) keeps the digits near u = 0
        a, b = ALPHA - TILT * (1 - u * u), ALPHA - TILT
        half = TILT * u * u / 2
        ratio = math.sin(half) / (u * u) if u > 0 else TILT / 2
        return 2 * TILT / math.sqrt(4 * P**2 * math.sin((a + b) / 2) * ratio)

    return float(quad(integrand, 0.0, 1.0, epsabs=1e-13)[0])


def error(trace: Trace) -> float:
    """Largest error of the tilt before the impact, relative to the first tilt."""
    before = trace.times < quarter()
    return float(np.max(np.abs(trace["block"][before, ANGLE] - tilt_at(trace.times[before]))) / TILT)


def scene() -> Scene:
    """Tilted by α/2 about its lower left corner, released at rest."""
    # Lower left corner at the origin; the centre is R away, at angle π/2 − α + tilt.
    at = math.pi / 2 - ALPHA + TILT
    centre = (R * math.cos(at), R * math.sin(at))
    return Scene(
        title="rocking block (Housner)",
        bodies=(floor(), block("block", WIDTH, HEIGHT, centre, angle=TILT)),
        friction=MU,
        duration=0.55,
        error_name="tilt before impact, relative",
        error=error,
        source="Housner 1963, Bull. Seism. Soc. Am. 53, 403; here without the small-angle assumption",
        size=WIDTH,
        tags=frozenset({"corner"}),
    )
