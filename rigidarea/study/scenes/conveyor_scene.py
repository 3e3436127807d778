"""A block laid on a belt slides until it has the belt's speed, after u/(μ g)."""

import numpy as np

from ..scene import G, Scene, X, block, floor, relative_error

MU, U = 0.25, 2.0


def position(t: np.ndarray) -> np.ndarray:
    """Distance at times `t`: μ g t²/2 until u/(μ g), then with the belt."""
    sliding = np.minimum(t, U / (MU * G))
    return MU * G * sliding**2 / 2 + U * (t - sliding)


def scene() -> Scene:
    """Belt 2 m/s, μ = 0.25."""
    return Scene(
        title="block on a conveyor belt",
        bodies=(floor(name="belt", surface_speed=U), block("block", 1.0, 0.5, (0.0, 0.25))),
        friction=MU,
        duration=2.0,
        error_name="distance, relative",
        error=lambda trace: relative_error(trace["block"][:, X], position(trace.times)),
        source="Coulomb and Newton: a = μ g until the speeds agree",
        tags=frozenset({"friction", "flat"}),
    )
