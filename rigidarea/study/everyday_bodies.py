"""What the game scenes are made of: walls, grounds, boxes, polygons, discs; in pixels."""

from __future__ import annotations

import itertools
import math
import random
from collections.abc import Callable

import numpy as np

from .scene import Body, Polygon, Segment, block, box, disc

GRAVITY_PX = 900.0
"""Of games in pixels (px/s²), as in pymunk's examples."""

SIDE_PX = 30.0
"""Of a usual body (px); engines with a unit of length of their own take it for that."""

WALL_PX = 5.0
"""Radius of floors and walls (px)."""


def walls(*points: tuple[float, float], radius: float = WALL_PX, name: str = "walls") -> Body:
    """A static body of segments from point to point."""
    segments = tuple(Segment(a, b, radius) for a, b in itertools.pairwise(points))
    return Body(name, segments, kind="static")


def open_box(width: float, height: float) -> Body:
    """A floor whose upper face is y = 0 and two walls whose inner faces are `width` apart."""
    w, r = width / 2 + WALL_PX, WALL_PX
    return walls((-w, height), (-w, -r), (w, -r), (w, height))


def ground(half: float = 1000.0) -> Body:
    """A floor whose upper face is y = 0."""
    return walls((-half, -WALL_PX), (half, -WALL_PX), name="floor")


def gon(name: str, corners: int, radius: float, place: tuple[float, float], **more: object) -> Body:
    """A regular polygon of unit mass in a circle of `radius`."""
    angles = 2 * math.pi * np.arange(corners) / corners
    points = tuple(
        (float(x), float(y)) for x, y in radius * np.column_stack((np.cos(angles), np.sin(angles)))
    )
    # of a regular n-gon: m R² (2 + cos(2π/n))/6
    moment = radius**2 * (2 + math.cos(2 * math.pi / corners)) / 6
    return Body(name, (Polygon(points),), place, moment=moment, **more)  # type: ignore[arg-type]


def rounded(name: str, side: float, radius: float, place: tuple[float, float], **more: object) -> Body:
    """A square of unit mass, `side` overall, its corners rounded; the moment is that of the sharp square."""
    core = box(side - 2 * radius, side - 2 * radius)
    return Body(name, (Polygon(core.points, radius),), place, moment=side**2 / 6, **more)  # type: ignore[arg-type]


Maker = Callable[[str, random.Random, tuple[float, float]], Body]


def a_box(name: str, chance: random.Random, place: tuple[float, float]) -> Body:
    return block(name, SIDE_PX, SIDE_PX, place, angle=chance.uniform(-math.pi, math.pi))


def a_hexagon(name: str, chance: random.Random, place: tuple[float, float]) -> Body:
    return gon(name, 6, SIDE_PX / 2, place, angle=chance.uniform(-math.pi, math.pi))


def a_disc(name: str, chance: random.Random, place: tuple[float, float]) -> Body:
    return disc(name, SIDE_PX / 2, place)


def a_rounded_box(name: str, chance: random.Random, place: tuple[float, float]) -> Body:
    return rounded(name, SIDE_PX, SIDE_PX / 6, place, angle=chance.uniform(-math.pi, math.pi))


def anything(name: str, chance: random.Random, place: tuple[float, float]) -> Body:
    angle = chance.uniform(-math.pi, math.pi)
    kind = chance.randrange(5)
    size = SIDE_PX * chance.uniform(0.6, 1.2)
    if kind == 0:
        return disc(name, size / 2, place)
    if kind == 1:
        return block(name, size, 0.6 * size, place, angle=angle)
    if kind == 2:
        return rounded(name, size, size / 6, place, angle=angle)
    return gon(name, 3 if kind == 3 else 6, size / 2, place, angle=angle)
