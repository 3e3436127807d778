"""A box lands on one corner: only one node is inside."""

import math

import numpy as np

from ..atlas import Axis, Map, Outcome, Variant, engines, judge, run_scene
from ..scene import ANGLE, Body, Scene, Y, box, box_moment, floor

LIMIT = 0.1


def run(variant: Variant, x: float, y: float) -> Outcome:
    """How deep the lowest corner gets below the floor within two seconds (sides)."""
    tilt = math.radians(x)
    reach = math.sqrt(0.5) * math.cos(math.radians(45) - tilt)
    body = Body("box", (box(1.0, 1.0),), (0.0, reach + y), tilt, moment=box_moment(1.0, 1.0, 1.0))
    scene = Scene(
        name="corner",
        title="",
        bodies=(floor(), body),
        friction=0.5,
        elasticity=0.2,
        duration=2.0,
        error_name="",
        error=lambda trace: 0.0,
        source="",
    )
    settings = {"stiffness": 1e4} if variant.peer == "literal" else {}
    path = run_scene(variant, scene, **settings)["box"]
    turn = np.mod(path[:, ANGLE], math.pi / 2)
    lowest = path[:, Y] - math.sqrt(0.5) * np.cos(math.pi / 4 - turn)
    return judge(float(np.max(-lowest)), LIMIT, "fell through")


def atlas_map() -> Map:
    """Tilt × drop height."""
    variants = engines()
    variants["literal, corners"] = Variant("literal", {"phase": 0.5})
    return Map(
        name="corner",
        title="one corner inside: a box dropped on a floor",
        x=Axis("tilt (degrees)", (0, 1, 5, 15, 30, 44, 45), (0, 5, 30, 45)),
        y=Axis("drop (sides)", (0.01, 0.1, 0.3, 1.0, 3.0), (0.1, 1.0), log=True),
        measure="deepest penetration / side",
        limit=LIMIT,
        variants=variants,
        run=run,
        source="design 2.1: a region exists when its area is positive; the paper's gate wants nodes of both",
    )
