"""Families of scenes that grow: levels, terrains, sleepers, comings and goings, what flies."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from .everyday_bodies import SIDE_PX as SIDE
from .everyday_bodies import ground, walls
from .scene import Body, block, box, disc


@dataclass(frozen=True)
class Growing:
    """A family of scenes over a size: `make(size)` its bodies; `settle`: frames that are not timed; `frames` that are.

    changes: bodies come and go; asleep: everybody sleeps before the first frame that is timed. seeds: of what falls, so
    many courses are timed together (`make(size, seed=...)`), since one alone says little: 30 % more or less.
    """

    title: str
    make: Callable[..., list[Body]]
    sizes: tuple[int, ...]
    settle: int = 120
    frames: int = 120
    changes: bool = False
    asleep: bool = False
    seeds: tuple[int, ...] = ()


def _boxes(places: Iterable[tuple[float, float]]) -> list[Body]:
    return [block(f"box {i}", SIDE, SIDE, place) for i, place in enumerate(places)]


def _level(n: int, top: float = 0.0) -> Body:
    """n tiles, 100 to a row, the upper side of the first row at `top`; none: one slab instead."""
    places = [((i % 100 - 49.5) * SIDE, top - (i // 100 + 0.5) * SIDE) for i in range(n)]
    slab = box(100 * SIDE, SIDE, (0.0, top - SIDE / 2))
    return Body("level", tuple(box(SIDE, SIDE, place) for place in places) or (slab,), kind="static")


def tiles(n: int, height: float = 0.0) -> list[Body]:
    """100 boxes on a level, or so far above it (length)."""
    columns = [((i // 10 - 5.0) * 1.5 * SIDE, height + (i % 10 + 0.5) * SIDE) for i in range(100)]
    return [_level(n), *_boxes(columns)]


def _terrain(n: int, radius: float) -> tuple[Body, Callable[[float], float]]:
    """Gentle waves that fall towards the middle, n segments of 20 px."""

    def height(x: float) -> float:
        return 12.0 * math.sin(x / 60.0) + 0.1 * abs(x)

    xs = [20.0 * (i - n / 2) for i in range(n + 1)]
    return walls(*((x, height(x)) for x in xs), radius=radius, name="terrain"), height


def rolling(n: int, radius: float, boxes: bool) -> list[Body]:
    """100 discs or boxes let go on a terrain, as far apart as it is long."""
    terrain, height = _terrain(n, radius)
    apart = 20.0 * n * 0.9 / 100
    size = min(SIDE, 0.8 * apart)
    made = [terrain]
    for i in range(100):
        x = (i - 49.5) * apart
        name, place = f"body {i}", (x, height(x) + radius + 0.9 * size)
        made.append(block(name, size, size, place) if boxes else disc(name, size / 2, place))
    return made


def pit(n: int, radius: float, boxes: bool, seed: int) -> list[Body]:
    """n discs or boxes that fall into a pit of three walls."""
    wide = 1.2 * SIDE * math.sqrt(n)
    rng = np.random.default_rng([n, seed])
    corners = [(-wide / 2, 4 * wide), (-wide / 2, 0.0), (wide / 2, 0.0), (wide / 2, 4 * wide)]
    made = [walls(*corners, radius=radius, name="pit")]
    across = int(wide / SIDE / 1.35)
    for i in range(n):
        x = (i % across - (across - 1) / 2) * 1.3 * SIDE + rng.uniform(-2, 2)
        name, place = f"body {i}", (x, (i // across + 1) * 1.5 * SIDE)
        if boxes:
            made.append(block(name, SIDE, SIDE, place, angle=float(rng.uniform(0, 6))))
        else:
            made.append(disc(name, SIDE / 2, place))
    return made


def sleepers(n: int) -> list[Body]:
    """n boxes in columns of two on one floor."""
    return [
        ground(n * SIDE),
        *_boxes(((i // 2 - n / 4) * 1.5 * SIDE, (i % 2 + 0.5) * SIDE) for i in range(n)),
    ]


def come(n: int) -> list[Body]:
    """n discs side by side on one floor; in each frame some go, and others come where they were."""
    places = [((i - n / 2) * 1.2 * SIDE, SIDE / 2) for i in range(n)]
    return [ground(n * SIDE), *(disc(f"disc {i}", SIDE / 2, place) for i, place in enumerate(places))]


def lift(n: int) -> list[Body]:
    """20 boxes on a plate that rises, n tiles elsewhere."""
    plate = Body("lift", (box(12 * SIDE, SIDE),), (0.0, 2 * SIDE), kind="kinematic", velocity=(0.0, 20.0))
    places = [((i % 5 - 2) * 1.5 * SIDE, 2.5 * SIDE + (i // 5 + 0.5) * SIDE) for i in range(20)]
    return [_level(n, -10 * SIDE), plate, *_boxes(places)]


def flight(n: int) -> list[Body]:
    """n discs thrown, none near another."""
    across = int(math.sqrt(n)) + 1
    places = [(3 * SIDE * (i % across), 3 * SIDE * (i // across)) for i in range(n)]
    return [disc(f"disc {i}", SIDE / 2, place, velocity=(100.0, 900.0)) for i, place in enumerate(places)]


def _families() -> dict[str, Growing]:
    found = {
        "tiles": Growing("100 boxes on a level of tiles", tiles, (0, 1000, 10000, 40000)),
        "falling": Growing(
            "100 boxes fall on a level of tiles", partial(tiles, height=5 * SIDE), (1000, 40000), settle=0
        ),
        "sleepers": Growing("boxes asleep, nobody awake", sleepers, (500, 5000, 20000), asleep=True),
        "come": Growing(
            "5 discs come and 5 go a frame", come, (300, 3000), settle=60, frames=60, changes=True
        ),
        "lift": Growing("20 boxes on a lift, tiles elsewhere", lift, (0, 1000, 10000)),
        "flight": Growing("discs in flight", flight, (200, 2000), settle=5, frames=60),
    }
    for who, boxes in (("discs", False), ("boxes", True)):
        for radius in (0.0, 3.0):
            make = partial(rolling, radius=radius, boxes=boxes)
            title = f"100 {who} on terrain of radius {radius:g}"
            found[f"rolling {who} {radius:g}"] = Growing(title, make, (200, 1000), settle=30)
        for radius in (0.0, 5.0):
            make = partial(pit, radius=radius, boxes=boxes)
            title = f"{who} fall into a pit, walls of radius {radius:g}"
            timed: dict[str, Any] = {"settle": 0, "frames": 240, "seeds": tuple(range(6))}
            found[f"pit {who} {radius:g}"] = Growing(title, make, (100,), **timed)
    return found


GROWING = _families()
