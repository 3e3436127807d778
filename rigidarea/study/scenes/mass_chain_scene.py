"""A chain of ever lighter discs: the last one leaves with v Π 2 m_i/(m_i + m_(i+1))."""

import itertools

import numpy as np

from ..scene import Array, Scene
from ._row import row

RADIUS, GAP, V = 0.25, 0.05, 1.0
MASSES = (1.0, 0.5, 0.25, 0.125)


def after() -> Array:
    """Velocities (n,) after every pair has met once; each disc ends slower than the next, so none meet again."""
    speeds = np.zeros(len(MASSES))
    speeds[0] = V
    for i, (m, n) in enumerate(itertools.pairwise(MASSES)):
        speeds[i], speeds[i + 1] = speeds[i] * (m - n) / (m + n), speeds[i] * 2 * m / (m + n)
    return speeds


def scene() -> Scene:
    """Masses halve three times, e = 1, no gravity."""
    source = "Huygens' chain: v Π 2 m_i/(m_i + m_(i+1))"
    return row("impact along a chain of masses", source, RADIUS, GAP, 0.2, MASSES, V, after())
