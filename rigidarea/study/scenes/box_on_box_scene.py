"""A box dropped on a box, e = 0: it stays on it."""

import math

import numpy as np

from ..scene import ANGLE, G, Scene, Trace, X, Y, block, floor

DROP, AFTER = 3.0, 0.1
"""Height of the fall (m); time after the impact from which the boxes are looked at (s)."""


def hit() -> float:
    """Time of the impact, sqrt(2 h/g)."""
    return math.sqrt(2 * DROP / G)


def error(trace: Trace) -> float:
    """Largest distance of either box from its place of rest from 0.1 s after the impact on, over the drop.

    Without restitution nothing separates: the blow goes through the lower box into the floor, and both rest. A box that
    keeps a share e of its speed rises by e² of the drop, which is the error then. The time of the fall itself, which
    depends on the step alone, is not asked.
    """
    late = trace.times > hit() + AFTER
    worst = 0.0
    for name, height in (("lower", 0.5), ("upper", 1.5)):
        found = trace[name][late]
        moved = np.hypot(found[:, X], found[:, Y] - height)
        worst = max(worst, float(np.max(moved)), float(np.max(np.abs(found[:, ANGLE]))) / 2)
    return worst / DROP


def scene() -> Scene:
    """Equal unit boxes, the lower on the floor, the upper falls 3 m onto it."""
    bodies = (floor(), block("lower", 1.0, 1.0, (0.0, 0.5)), block("upper", 1.0, 1.0, (0.0, 1.5 + DROP)))
    return Scene(
        title="box dropped on a box, e = 0",
        bodies=bodies,
        friction=0.5,
        duration=2.0,
        error_name="height after the impact / drop",
        error=error,
        source="plastic impact: all stop",
        tags=frozenset({"impact", "flat"}),
    )
