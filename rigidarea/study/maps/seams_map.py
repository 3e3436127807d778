"""Butted tiles against one slab: a box slides over the seams."""

import math
from functools import partial

from ..atlas import Axis, Map, Outcome, Variant, engines, judge, run_scene
from ..scene import Body, block, box, set_up
from ..scenes.tiles_scene import SIDE, error

LIMIT, WAY = 0.05, 5.0


def run(variant: Variant, x: float, y: float) -> Outcome:
    """Departure from uniform motion after ten box sides (sides)."""
    tile = y * SIDE
    count = math.ceil((WAY + 2.0) / tile) + 2
    tiles = tuple(
        Body(f"tile{i}", (box(tile, 0.5),), (i * tile - 1.0, -0.25), kind="static") for i in range(count)
    )
    sliding = block("box", SIDE, SIDE, (0.013, SIDE / 2), velocity=(x, 0.0))
    bodies, duration = (*tiles, sliding), min(WAY / x, 10.0)
    scene = set_up("seams", bodies, duration, partial(error, speed=x), size=SIDE)
    return judge(scene.measure(run_scene(variant, scene, 1e4)), LIMIT, "caught")


def atlas_map() -> Map:
    """Speed × length of a tile."""
    return Map(
        title="seams: a smooth box over butted tiles",
        x=Axis("speed (m/s)", (0.5, 1, 2, 4, 8, 16), (1, 4, 16), log=True),
        y=Axis("length of a tile / side", (0.2, 0.5, 0.9, 1.1, 2.0, 5.0), (0.5, 1.1, 5.0), log=True),
        measure="departure from uniform motion / side",
        limit=LIMIT,
        variants=engines(),
        run=run,
        source="as over one slab: uniform motion",
    )
