"""A sliding block stops after v²/(2 μ g)."""

import numpy as np

from ..scene import G, Scene, Trace, X, block, floor

MU, V = 0.4, 3.0


def position(t: np.ndarray) -> np.ndarray:
    """Distance at times `t`: v t − μ g t²/2 until v/(μ g)."""
    t = np.minimum(t, V / (MU * G))
    return V * t - MU * G * t**2 / 2


def error(trace: Trace) -> float:
    """Largest error of the distance, relative to the stopping distance."""
    return float(np.max(np.abs(trace["block"][:, X] - position(trace.times))) / (V**2 / (2 * MU * G)))


def scene() -> Scene:
    """3 m/s, μ = 0.4."""
    return Scene(
        title="block sliding to a stop",
        bodies=(floor(), block("block", 1.0, 0.5, (0.0, 0.25), velocity=(V, 0.0))),
        friction=MU,
        duration=1.5,
        error_name="distance, relative",
        error=error,
        source="Coulomb and Newton: stops after v²/(2 μ g)",
        tags=frozenset({"friction", "flat"}),
    )
