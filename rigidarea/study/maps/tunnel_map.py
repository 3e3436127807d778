"""A fast box against a thin wall: does it come out behind?"""

from typing import Any

import numpy as np

from ..atlas import Axis, Map, Outcome, Variant, engines, judge, run_scene
from ..scene import Array, Body, Scene, X, block, box, set_up

SIDE, STARTS = 0.5, 4
"""Side of the box; how many starting distances, spread over one frame's way, are tried."""


def scene(speed: float, thickness: float, share: float) -> Scene:
    """A box of 0.5 m flies at a wall whose near face is x = 0."""
    frame = 1 / 60
    start = -SIDE / 2 - 0.2 - share * speed * frame
    wall = Body("wall", (box(thickness, 20.0),), (thickness / 2, 0.0), kind="static")
    flying = block("box", SIDE, SIDE, (start, 0.0), velocity=(speed, 0.0))
    duration = 2 * (0.2 + speed * frame) / speed + 0.3
    more: dict[str, Any] = {"gravity": (0.0, 0.0), "size": SIDE, "pressure": speed**2 / SIDE**3}
    return set_up("tunnel", (wall, flying), duration, elasticity=0.3, **more)


def run(variant: Variant, x: float, y: float) -> Outcome:
    """The share of starts that end behind the wall or inside it."""
    ends = [run_scene(variant, scene(x, y, i / STARTS), 1e3)["box"][-1, X] for i in range(STARTS)]
    return judge(sum(not end < SIDE / 2 for end in ends) / STARTS, 0.0, "went through")


def theory() -> list[tuple[str, Array, Array]]:
    """v h = thickness + side: longer steps can miss the wall altogether."""
    speed = np.logspace(0, 3, 30)
    return [
        ("v h = t + s, 1/240 s", speed, np.maximum(speed / 240 - SIDE, 1e-9)),
        ("v h = t + s, 1/60 s", speed, np.maximum(speed / 60 - SIDE, 1e-9)),
    ]


def atlas_map() -> Map:
    """Speed × thickness."""
    return Map(
        title="tunnelling: a fast box against a thin wall",
        x=Axis(
            "speed (m/s), box of 0.5 m", (1, 3, 10, 30, 60, 100, 200, 300, 600), (3, 30, 100, 300), log=True
        ),
        y=Axis("thickness of the wall (m)", (0.01, 0.03, 0.1, 0.3, 1.0, 3.0), (0.01, 0.1, 1.0), log=True),
        measure="share of starts that got through",
        limit=0.0,
        variants=engines(),
        run=run,
        source="discrete detection: v h < thickness + side",
        theory=theory,
        theory_of=("pymunk", "box2d"),
    )
