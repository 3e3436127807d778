"""A bar stuck across a plate: no node of either lies inside the other."""

import numpy as np

from ..atlas import PASS, Axis, Map, Outcome, Variant, engines, run_scene
from ..scene import ANGLE, Body, G, X, Y, block, box, set_up

LENGTH, THICK = 2.0, 0.3


def run(variant: Variant, x: float, y: float) -> Outcome:
    """Way (and turn) in a tenth of a second without gravity: none means that the overlap was not seen."""
    plate = Body("plate", (box(10.0, THICK),), (0.0, 0.0), kind="static")
    # lower end of the bar at depth x · THICK below the plate's upper face
    bar = block("bar", y * THICK, LENGTH, (0.0, THICK / 2 - x * THICK + LENGTH / 2))
    scene = set_up("crossed", (plate, bar), 0.1, gravity=(0.0, 0.0), size=THICK, pressure=G)
    settings = {"stiffness": 10.0} if variant.area else {}
    path = run_scene(variant, scene, **settings)["bar"]
    moved = path[-1, :3] - path[0, :3]  # places, not velocities: engines that push apart do it without speed
    way = float(np.hypot(moved[X], moved[Y]) / THICK + abs(moved[ANGLE]))
    return (PASS if way > 1e-6 else "not seen"), way


def atlas_map() -> Map:
    """Depth × width of the bar."""
    variants = engines()
    variants["literal, corners"] = Variant("literal", {"phase": 0.5})
    return Map(
        title="no node inside: a bar across a plate",
        x=Axis("depth of the bar's end / thickness", (0.1, 0.5, 0.9, 1.1, 1.5, 2.0, 3.0), (0.5, 1.1, 2.0)),
        y=Axis("width of the bar / thickness", (0.1, 0.3, 1.0, 3.0), (0.3, 1.0), log=True),
        measure="way in 0.1 s / thickness",
        limit=0.0,
        variants=variants,
        run=run,
        source="docs/theory.md, 1: regions without any node inside",
    )
