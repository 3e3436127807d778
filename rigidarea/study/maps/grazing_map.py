"""A disc grazes the corner of a fixed box."""

import math

import numpy as np

from ..atlas import Axis, Map, Outcome, Variant, engines, judge, run_scene
from ..scene import VX, VY, Body, box, disc, set_up

RADIUS, LIMIT = 0.5, 0.1


def run(variant: Variant, x: float, y: float) -> Outcome:
    """Error of the velocity after an elastic impact on a corner, relative to the speed."""
    height = RADIUS * (1 - x)
    normal = np.array((-math.sqrt(1 - (1 - x) ** 2), 1 - x))  # from the corner (0, 0) to the disc's centre
    before = np.array((y, 0.0))
    exact = before - 2 * (before @ normal) * normal
    bodies = (
        Body("box", (box(2.0, 2.0),), (1.0, -1.0), kind="static"),
        disc("disc", RADIUS, (-1.2, height), velocity=(y, 0.0)),
    )
    duration = 1.2 / y + 0.4 / y
    scene = set_up("grazing", bodies, duration, gravity=(0.0, 0.0), elasticity=1.0, pressure=y**2)
    settings = {"stiffness": 1e7} if variant.area else {}
    last = run_scene(variant, scene, **settings)["disc"][-1]
    return judge(float(np.hypot(*(last[[VX, VY]] - exact)) / y), LIMIT, "wrong way")


def atlas_map() -> Map:
    """Overlap of the paths × speed."""
    return Map(
        title="grazing: an elastic disc on a corner",
        x=Axis("cut of the path / radius", (1e-3, 3e-3, 0.01, 0.03, 0.1, 0.3), (0.01, 0.1, 0.3), log=True),
        y=Axis("speed (m/s)", (0.3, 1, 3, 10, 30), (1, 10), log=True),
        measure="error of velocity / speed",
        limit=LIMIT,
        variants=engines(),
        run=run,
        source="v' = v − 2 (v·n) n, n from the corner to the centre",
    )
