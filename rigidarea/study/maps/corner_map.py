"""A box lands on one corner: only one node is inside."""

import math

import numpy as np

from ..atlas import Axis, Map, Outcome, Variant, engines, judge, run_scene
from ..scene import ANGLE, Scene, Y, block, floor, set_up

LIMIT = 0.1


def dropped(name: str, tilt: float, drop: float, elasticity: float, frame: float = 1 / 60) -> Scene:
    """A unit box on a floor, its lowest corner `drop` (sides) above it, `tilt` in degrees, μ = 0.5, two seconds."""
    angle = math.radians(tilt)
    reach = math.sqrt(0.5) * math.cos(math.radians(45) - angle)
    bodies = (floor(), block("box", 1.0, 1.0, (0.0, reach + drop), angle=angle))
    return set_up(name, bodies, 2.0, friction=0.5, elasticity=elasticity, frame=frame)


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
