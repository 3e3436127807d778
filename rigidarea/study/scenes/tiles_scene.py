"""A smooth box slides over butted tiles as over one slab: seams are not there."""

import numpy as np

from ..scene import Body, Scene, Trace, block, box

V, TILE, COUNT, SIDE = 4.0, 0.5, 30, 0.5


def error(trace: Trace, speed: float = V) -> float:
    """Largest departure of a run from x = v t (v: `speed`), y and angle constant, relative to the side."""
    moving = trace["box"]
    expected = moving[0, :3] + np.outer(trace.times, (speed, 0.0, 0.0))
    off = np.abs(moving[:, :3] - expected) * (1.0, 1.0, SIDE / 2)
    return float(off.max() / SIDE)


def scene() -> Scene:
    """4 m/s over tiles of 0.5 m, no friction; exact: uniform motion."""
    tiles = tuple(
        Body(f"tile{i}", (box(TILE, 0.5),), ((i - 1) * TILE, -0.25), kind="static") for i in range(COUNT)
    )
    sliding = block("box", SIDE, SIDE, (0.0, SIDE / 2), velocity=(V, 0.0))
    return Scene(
        title="box sliding over butted tiles",
        bodies=(*tiles, sliding),
        duration=2.5,
        error_name="departure from uniform motion / side",
        error=error,
        source="Newton's first law",
        size=SIDE,
        tags=frozenset({"flat", "seams"}),
    )
