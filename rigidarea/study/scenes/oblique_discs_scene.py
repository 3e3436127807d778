"""Two equal smooth discs collide off centre."""

import math

import numpy as np

from ..scene import VX, VY, Scene, Trace, disc

RADIUS, E, V, SLANT = 0.5, 0.9, 2.0, math.radians(30)


def after() -> np.ndarray:
    """Velocities (2, 2) after the impact: the components along the line of centres change, the others do not."""
    normal = np.array((math.cos(SLANT), math.sin(SLANT)))
    impulse = (1 + E) / 2 * V * normal[0]
    return np.array(((V, 0.0) - impulse * normal, impulse * normal))


def error(trace: Trace) -> float:
    """Largest velocity error relative to the approach speed."""
    found = np.array([trace[name][-1, [VX, VY]] for name in ("a", "b")])
    return float(np.max(np.linalg.norm(found - after(), axis=1)) / V)


def scene() -> Scene:
    """Line of centres at 30 degrees, e = 0.9, no friction, no gravity."""
    touch = 2 * RADIUS * np.array((math.cos(SLANT), math.sin(SLANT)))
    a = disc("a", RADIUS, (-0.5, 0.0), velocity=(V, 0.0))
    b = disc("b", RADIUS, (float(touch[0]), float(touch[1])))
    return Scene(
        title="oblique impact of two discs",
        bodies=(a, b),
        gravity=(0.0, 0.0),
        elasticity=E,
        duration=0.5,
        error_name="velocity after impact, relative",
        error=error,
        source="impulse J = (1 + e) v_n m/2 along the line of centres",
        size=2 * RADIUS,
        pressure=V**2,
        tags=frozenset({"impact"}),
    )
