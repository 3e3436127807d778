"""Families of scenes that grow: levels, terrains, sleepers, comings and goings, what flies."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from .scene import Body, Circle, Polygon, Segment, box, box_moment

SIDE = 30.0
"""Of a box, and a disc's diameter (px)."""

GRAVITY = 900.0

FRAME = 1 / 60

BLOCK = 10
"""Frames of one engine before it is the next one's turn."""

BURST = 5
"""Bodies that come, and go, in each frame of `come`."""


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
    elasticity: float = 0.0
    changes: bool = False
    asleep: bool = False
    seeds: tuple[int, ...] = ()


def _box(name: str, x: float, y: float, **more: Any) -> Body:
    return Body(name, (box(SIDE, SIDE),), (x, y), mass=1.0, moment=box_moment(1.0, SIDE, SIDE), **more)


def _disc(name: str, x: float, y: float, radius: float = SIDE / 2, **more: Any) -> Body:
    return Body(name, (Circle(radius),), (x, y), mass=1.0, moment=0.5 * radius**2, **more)


def _pile(n: int = 100, x: float = 0.0, y: float = 0.0) -> list[Body]:
    """n boxes in columns of ten, apart."""
    return [
        _box(f"box {i}", x + (i // 10 - n / 20) * 1.5 * SIDE, y + (i % 10 + 0.5) * SIDE) for i in range(n)
    ]


def _tile(x: float, y: float) -> Polygon:
    h = SIDE / 2
    return Polygon(((x - h, y - h), (x + h, y - h), (x + h, y + h), (x - h, y + h)))


def _level(n: int, top: float = 0.0) -> Body:
    """n tiles, 100 to a row, the upper side of the first row at `top`; none: one slab instead."""
    if n == 0:
        slab = 50 * SIDE
        corners = ((-slab, top - SIDE), (slab, top - SIDE), (slab, top), (-slab, top))
        return Body("level", (Polygon(corners),), kind="static")
    tiles = tuple(_tile((i % 100 - 49.5) * SIDE, top - (i // 100 + 0.5) * SIDE) for i in range(n))
    return Body("level", tiles, kind="static")


def tiles(n: int, height: float = 0.0) -> list[Body]:
    """100 boxes on a level, or so far above it (length)."""
    return [_level(n), *_pile(y=height)]


def _terrain(n: int, radius: float) -> tuple[Body, Callable[[float], float]]:
    """Gentle waves that fall towards the middle, n segments of 20 px."""

    def height(x: float) -> float:
        return 12.0 * math.sin(x / 60.0) + 0.1 * abs(x)

    xs = [20.0 * (i - n / 2) for i in range(n + 1)]
    shapes = tuple(Segment((a, height(a)), (b, height(b)), radius) for a, b in itertools.pairwise(xs))
    return Body("terrain", shapes, kind="static"), height


def rolling(n: int, radius: float, boxes: bool) -> list[Body]:
    """100 discs or boxes let go on a terrain, as far apart as it is long."""
    ground, height = _terrain(n, radius)
    apart = 20.0 * n * 0.9 / 100
    made: list[Body] = [ground]
    for i in range(100):
        x = (i - 49.5) * apart
        size = min(SIDE, 0.8 * apart)
        y = height(x) + radius + 0.9 * size
        if boxes:
            shape, moment = (box(size, size),), box_moment(1.0, size, size)
            made.append(Body(f"body {i}", shape, (x, y), mass=1.0, moment=moment))
        else:
            made.append(_disc(f"body {i}", x, y, size / 2))
    return made


def pit(n: int, radius: float, boxes: bool, seed: int) -> list[Body]:
    """n discs or boxes that fall into a pit of three walls."""
    wide = 1.2 * SIDE * math.sqrt(n)
    rng = np.random.default_rng([n, seed])
    corners = [(-wide / 2, 4 * wide), (-wide / 2, 0.0), (wide / 2, 0.0), (wide / 2, 4 * wide)]
    walls = tuple(Segment(a, b, radius) for a, b in itertools.pairwise(corners))
    made = [Body("pit", walls, kind="static")]
    across = int(wide / SIDE / 1.35)
    for i in range(n):
        x = (i % across - (across - 1) / 2) * 1.3 * SIDE + rng.uniform(-2, 2)
        y = (i // across + 1) * 1.5 * SIDE
        make = _box if boxes else _disc
        made.append(make(f"body {i}", x, y, angle=float(rng.uniform(0, 6)) if boxes else 0.0))
    return made


def sleepers(n: int) -> list[Body]:
    """n boxes in columns of two on one floor."""
    floor = Segment((-n * SIDE, -5.0), (n * SIDE, -5.0), 5.0)
    made = [Body("floor", (floor,), kind="static")]
    return made + [_box(f"box {i}", (i // 2 - n / 4) * 1.5 * SIDE, (i % 2 + 0.5) * SIDE) for i in range(n)]


def come(n: int) -> list[Body]:
    """n discs side by side on one floor; in each frame some go, and others come where they were."""
    floor = Segment((-n * SIDE, -5.0), (n * SIDE, -5.0), 5.0)
    made = [Body("floor", (floor,), kind="static")]
    return made + [_disc(f"disc {i}", (i - n / 2) * 1.2 * SIDE, SIDE / 2) for i in range(n)]


def lift(n: int) -> list[Body]:
    """20 boxes on a plate that rises, n tiles elsewhere."""
    plate = Body("lift", (box(12 * SIDE, SIDE),), (0.0, 2 * SIDE), kind="kinematic", velocity=(0.0, 20.0))
    boxes = [
        _box(f"box {i}", (i % 5 - 2) * 1.5 * SIDE, 2.5 * SIDE + (i // 5 + 0.5) * SIDE) for i in range(20)
    ]
    return [_level(n, -10 * SIDE), plate, *boxes]


def flight(n: int) -> list[Body]:
    """n discs thrown, none near another."""
    across = int(math.sqrt(n)) + 1
    return [
        _disc(f"disc {i}", 3 * SIDE * (i % across), 3 * SIDE * (i // across), velocity=(100.0, 900.0))
        for i in range(n)
    ]


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
    for boxes in (False, True):
        who = "boxes" if boxes else "discs"
        for radius in (0.0, 3.0):
            title, make = (
                f"100 {who} on terrain of radius {radius:g}",
                partial(rolling, radius=radius, boxes=boxes),
            )
            found[f"rolling {who} {radius:g}"] = Growing(title, make, (200, 1000), settle=30)
        for radius in (0.0, 5.0):
            title, make = (
                f"{who} fall into a pit, walls of radius {radius:g}",
                partial(pit, radius=radius, boxes=boxes),
            )
            seeds = tuple(range(6))
            found[f"pit {who} {radius:g}"] = Growing(title, make, (100,), settle=0, frames=240, seeds=seeds)
    return found


GROWING = _families()
