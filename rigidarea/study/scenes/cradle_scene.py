"""Newton's cradle with gaps: the last of five equal discs leaves with the first one's velocity."""

import numpy as np

from ..scene import Scene
from ._row import row

RADIUS, COUNT, GAP, V = 0.25, 5, 0.02, 2.0


def scene() -> Scene:
    """Five discs, gaps of 0.02 m, e = 1, no gravity: equal masses exchange velocities pair by pair."""
    source = "equal masses, e = 1: velocities are exchanged at each impact"
    masses, exact = (1.0,) * COUNT, V * np.eye(COUNT)[-1]
    return row("Newton's cradle with gaps", source, RADIUS, GAP, 0.3, masses, V, exact)
