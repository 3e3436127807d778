"""A box lands on one corner: only one node is inside."""

import math

import numpy as np

from ..atlas import Axis, Map, Outcome, Variant, engines, judge, run_scene
from ..scene import ANGLE, Y
from ._drop import dropped

LIMIT = 0.1


def run(variant: Variant, x: float, y: float) -> Outcome:
    """How deep the lowest corner gets below the floor within two seconds (sides)."""
    path = run_scene(variant, dropped("corner", x, y, 0.2), 1e4)["box"]
    turn = np.mod(path[:, ANGLE], math.pi / 2)
    lowest = path[:, Y] - math.sqrt(0.5) * np.cos(math.pi / 4 - turn)
    return judge(float(np.max(-lowest)), LIMIT, "fell through")


def atlas_map() -> Map:
    """Tilt × drop height."""
    variants = engines()
    variants["literal, corners"] = Variant("literal", {"phase": 0.5})
    return Map(
        title="one corner inside: a box dropped on a floor",
        x=Axis("tilt (degrees)", (0, 1, 5, 15, 30, 44, 45), (0, 5, 30, 45)),
        y=Axis("drop (sides)", (0.01, 0.1, 0.3, 1.0, 3.0), (0.1, 1.0), log=True),
        measure="deepest penetration / side",
        limit=LIMIT,
        variants=variants,
        run=run,
        source="docs/theory.md, 1: a region exists when its area is positive; the paper's gate wants nodes of both",
    )
