"""A disc thrown without spin slides, then rolls: at t = v/(3 μ g) with two thirds of its speed."""

import numpy as np

from ..scene import OMEGA, G, Scene, Trace, X, disc, floor, relative_error

RADIUS, MU, V = 0.5, 0.3, 5.0


def motion(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Position and rim speed r ω (positive forwards) at times `t`.

    Sliding: v − μ g t and r ω = 2 μ g t; they meet at v/(3 μ g), and rolling goes on for ever at 2 v/3.
    """
    sliding = np.minimum(t, V / (3 * MU * G))
    x = V * sliding - MU * G * sliding**2 / 2 + 2 * V / 3 * (t - sliding)
    return x, 2 * MU * G * sliding


def error(trace: Trace) -> float:
    """Largest error of distance (relative to the whole) or rim speed (relative to its final value)."""
    x, rim = motion(trace.times)
    ball = trace["disc"]
    return max(relative_error(ball[:, X], x), relative_error(-RADIUS * ball[:, OMEGA], rim))


def scene() -> Scene:
    """5 m/s, μ = 0.3."""
    return Scene(
        title="disc: sliding turns to rolling",
        bodies=(floor(), disc("disc", RADIUS, (0.0, RADIUS), velocity=(V, 0.0))),
        friction=MU,
        duration=2.0,
        error_name="distance and rim speed, relative",
        error=error,
        source="billiard ball problem (Coriolis) for a disc: final speed 2 v/3",
        tags=frozenset({"friction", "rolling"}),
    )
