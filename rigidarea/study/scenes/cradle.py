"""Newton's cradle with gaps: the last of five equal discs leaves with the first one's velocity."""

import numpy as np

from ..scene import VX, Scene, Trace, disc

RADIUS, COUNT, GAP, V = 0.25, 5, 0.02, 2.0


def error(trace: Trace) -> float:
    """Largest velocity error relative to the first disc's speed."""
    exact = np.zeros(COUNT)
    exact[-1] = V
    found = np.array([trace[f"disc{i}"][-1, VX] for i in range(COUNT)])
    return float(np.max(np.abs(found - exact)) / V)


def scene() -> Scene:
    """Five discs, gaps of 0.02 m, e = 1, no gravity: equal masses exchange velocities pair by pair."""
    pitch = 2 * RADIUS + GAP
    discs = tuple(
        disc(
            f"disc{i}",
            RADIUS,
            (i * pitch - (0.3 if i == 0 else 0.0), 0.0),
            velocity=(V if i == 0 else 0.0, 0.0),
        )
        for i in range(COUNT)
    )
    return Scene(
        name="cradle",
        title="Newton's cradle with gaps",
        bodies=discs,
        gravity=(0.0, 0.0),
        elasticity=1.0,
        duration=0.6,
        error_name="velocity, relative",
        error=error,
        source="equal masses, e = 1: velocities are exchanged at each impact",
        size=2 * RADIUS,
        pressure=V**2 / (2 * RADIUS) ** 3,
        tags=frozenset({"impact"}),
    )
