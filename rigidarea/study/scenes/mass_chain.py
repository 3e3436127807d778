"""A chain of ever lighter discs: the last one leaves with v Π 2 m_i/(m_i + m_(i+1))."""

import itertools

import numpy as np

from ..scene import VX, Scene, Trace, disc

RADIUS, GAP, V = 0.25, 0.05, 1.0
MASSES = (1.0, 0.5, 0.25, 0.125)


def after() -> np.ndarray:
    """Velocities (n,) after every pair has met once; each disc ends slower than the next, so none meet
    again.
    """
    speeds = np.zeros(len(MASSES))
    speeds[0] = V
    for i, (m, n) in enumerate(itertools.pairwise(MASSES)):
        speeds[i], speeds[i + 1] = speeds[i] * (m - n) / (m + n), speeds[i] * 2 * m / (m + n)
    return speeds


def error(trace: Trace) -> float:
    """Largest velocity error relative to the last disc's speed."""
    exact = after()
    found = np.array([trace[f"disc{i}"][-1, VX] for i in range(len(MASSES))])
    return float(np.max(np.abs(found - exact)) / exact[-1])


def scene() -> Scene:
    """Masses halve three times, e = 1, no gravity."""
    pitch = 2 * RADIUS + GAP
    discs = tuple(
        disc(f"disc{i}", RADIUS, (i * pitch - (0.2 if i == 0 else 0.0), 0.0), m, velocity=(V * (i == 0), 0.0))
        for i, m in enumerate(MASSES)
    )
    return Scene(
        name="mass_chain",
        title="impact along a chain of masses",
        bodies=discs,
        gravity=(0.0, 0.0),
        elasticity=1.0,
        duration=0.6,
        error_name="velocity, relative",
        error=error,
        source="Huygens' chain: v Π 2 m_i/(m_i + m_(i+1))",
        size=2 * RADIUS,
        pressure=V**2 / (2 * RADIUS) ** 3,
        tags=frozenset({"impact"}),
    )
