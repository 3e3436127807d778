"""What is cut into convex pieces is what it was whole: nothing is caught at a cut, nor led aside by it.

Levels are triangulated, outlines decomposed (`pymunk.autogeometry.convex_decomposition`). A piece that touches with a
sharp corner has an edge there that lies within its neighbour, and of the whole's boundary it has one side alone.
Friction and restitution 0: what lies on, or falls on, a level floor keeps its speed along it, exactly.
"""

from __future__ import annotations

import math
import random

import pymunk
import pytest
from pymunk.autogeometry import convex_decomposition

import rigidarea as ra

FRAMES = 60
#: Of the speed: what first touch, found to 1e-3 of a radian on a corner, may leave.
KEPT = 1e-2


def level_of_triangles(space: pymunk.Space, draw: random.Random) -> None:
    """Sixty tiles whose upper side is y = 0, each cut along one of its diagonals."""
    wide, high = draw.uniform(20, 60), draw.uniform(10, 60)
    for k in range(-30, 30):
        x = k * wide
        tile = [(x, -high), (x + wide, -high), (x + wide, 0), (x, 0)]
        if draw.random() < 0.5:
            tile = tile[1:] + tile[:1]
        for part in (tile[:3], [tile[0], *tile[2:]]):
            space.add(pymunk.Poly(space.static_body, part))


def along_triangles(seed: int, kind: str, falls: bool, attach: bool = True) -> float:
    """By what part a body's speed along a floor of triangles changes in a second."""
    draw = random.Random(seed)
    space = pymunk.Space()
    space.gravity = 0, -900
    level_of_triangles(space, draw)
    size = draw.uniform(8, 20)
    body = pymunk.Body(1, 250)
    shape = pymunk.Circle(body, size) if kind == "disc" else pymunk.Poly.create_box(body, (2 * size, size))
    space.add(body, shape)
    speed = draw.uniform(50, 200)
    low = size if kind == "disc" else size / 2
    body.position = draw.uniform(0, 60), low + (draw.uniform(10, 60) if falls else 0)
    body.velocity = speed, -draw.uniform(0, 200) * falls
    if attach:
        ra.attach(space)
    for _ in range(FRAMES):
        space.step(1 / 60)
    return abs(body.velocity.x - speed) / math.hypot(speed, 300 * falls)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("falls", [False, True])
@pytest.mark.parametrize("kind", ["disc", "box"])
def test_a_level_of_triangles(kind: str, falls: bool, seed: int) -> None:
    assert along_triangles(seed, kind, falls) < KEPT


@pytest.mark.slow
@pytest.mark.parametrize("falls", [False, True])
@pytest.mark.parametrize("kind", ["disc", "box"])
def test_levels_of_triangles(kind: str, falls: bool) -> None:
    """200 of them, beside pymunk: as good as none is led aside. (Seen: one in 800, by 1.2 %.)"""
    ours, theirs = (
        sum(along_triangles(seed, kind, falls, attach) > KEPT for seed in range(200))
        for attach in (True, False)
    )
    print(
        f"{kind} {'lands on' if falls else 'slides along'} triangles: {ours} of 200 led aside, pymunk {theirs}"
    )
    assert ours <= 2


def pieces(kind: str, draw: random.Random) -> list[list[tuple[float, float]]]:
    """A convex outline, or one that is not, in pieces."""
    x, y = draw.uniform(12, 22), draw.uniform(6, 15)
    if kind == "two triangles":
        return [[(-x, -y), (x, -y), (x, y)], [(-x, -y), (x, y), (-x, y)]]
    if kind == "two halves":
        return [[(-x, -y), (0, -y), (0, y), (-x, y)], [(0, -y), (x, -y), (x, y), (0, y)]]
    if kind == "six triangles":
        ring = [(x * math.cos(math.pi * i / 3), x * math.sin(math.pi * i / 3)) for i in range(6)]
        return [[(0, 0), ring[i], ring[(i + 1) % 6]] for i in range(6)]
    arrow = [(-x, -y), (0, -y), (0, -2 * y), (x, 0), (0, 2 * y), (0, y), (-x, y), (-x, -y)]
    return [
        [(p.x, p.y) for p in part] for part in convex_decomposition([pymunk.Vec2d(*p) for p in arrow], 0.1)
    ]


def falls_on_a_floor(seed: int, kind: str, attach: bool = True) -> float:
    """By what part a body of pieces changes its speed along a smooth floor that it falls on, any way up."""
    draw = random.Random(seed)
    space = pymunk.Space()
    space.gravity = 0, -900
    space.add(pymunk.Poly(space.static_body, [(-900, -60), (900, -60), (900, 0), (-900, 0)]))
    parts = pieces(kind, draw)
    body = pymunk.Body(1, 250)
    space.add(body, *(pymunk.Poly(body, part) for part in parts))
    body.angle = draw.choice((0.0, math.pi / 2, draw.uniform(-3, 3)))
    speed = draw.uniform(-200, 200)
    body.velocity = speed, draw.uniform(-300, 0)
    lowest = min(pymunk.Vec2d(*p).rotated(body.angle).y for part in parts for p in part)
    body.position = 0, draw.uniform(20, 70) - lowest
    if attach:
        ra.attach(space)
    for _ in range(FRAMES):
        space.step(1 / 60)
    return abs(body.velocity.x - speed) / math.hypot(speed, 300)


def overhangs(seed: int) -> float:
    """By what part of its speed a box of four triangles is stopped that slides on to a platform, one end beyond it."""
    draw = random.Random(seed)
    space = pymunk.Space()
    space.gravity = 0, -900
    space.add(pymunk.Poly(space.static_body, [(0, -30), (400, -30), (400, 0), (0, 0)]))
    x, y = draw.uniform(12, 25), draw.uniform(6, 15)
    body = pymunk.Body(1, 250)
    ring = [(-x, -y), (x, -y), (x, y), (-x, y)]
    parts = [[(0, 0), ring[i], ring[(i + 1) % 4]] for i in range(4)]
    space.add(body, *(pymunk.Poly(body, part) for part in parts))
    speed = draw.uniform(20, 150)
    body.position = draw.uniform(0.1, 0.7) * x, y
    body.velocity = speed, 0
    ra.attach(space)
    for _ in range(FRAMES):
        space.step(1 / 60)
    return abs(body.velocity.x - speed) / speed


@pytest.mark.parametrize("seed", range(10))
def test_pieces_beyond_an_edge(seed: int) -> None:
    assert overhangs(seed) < KEPT


@pytest.mark.parametrize("gap", [1e-6, 1e-3, 0.02])
def test_tiles_a_hair_apart(gap: float) -> None:
    """No gap that rounded coordinates leave is a wall: 20 smooth boxes over tiles that far apart (px)."""
    for seed in range(20):
        draw = random.Random(seed)
        space = pymunk.Space()
        space.gravity = 0, -900
        wide = draw.uniform(20, 60)
        for k in range(-10, 30):
            x = k * (wide + gap)
            space.add(pymunk.Poly(space.static_body, [(x, -30), (x + wide, -30), (x + wide, 0), (x, 0)]))
        body = pymunk.Body(1, 250)
        size = draw.uniform(10, 20)
        space.add(body, pymunk.Poly.create_box(body, (2 * size, size)))
        speed = draw.uniform(50, 200)
        body.position = draw.uniform(0, 60), size / 2
        body.velocity = speed, 0
        ra.attach(space)
        for _ in range(FRAMES):
            space.step(1 / 60)
        assert body.velocity.x == pytest.approx(speed, rel=KEPT), f"seed {seed}"


KINDS = ["two triangles", "two halves", "six triangles", "arrow"]


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("kind", KINDS)
def test_a_body_in_pieces(kind: str, seed: int) -> None:
    assert falls_on_a_floor(seed, kind) < KEPT


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_bodies_in_pieces(kind: str) -> None:
    ours = sum(falls_on_a_floor(seed, kind) > KEPT for seed in range(200))
    print(f"{kind}: {ours} of 200 led aside")
    assert ours <= 2


@pytest.mark.parametrize("aside", [0.0, 1e-7, 1e-3, 0.03])
def test_what_stands_edge_to_edge_bears_on_its_own_tile(aside: float) -> None:
    """Twenty boxes as wide as the tiles below them, off by next to nothing: one contact each, none on a tile beside.

    (Friction lets a stack by a millionth of a pixel aside; a sliver of the next tile bore as a corner does then, and
    frames cost a third more.)
    """
    space = pymunk.Space()
    space.gravity = 0, -900
    for k in range(-12, 12):
        tile = [(20 * k, -20), (20 * k + 20, -20), (20 * k + 20, 0), (20 * k, 0)]
        space.add(pymunk.Poly(space.static_body, tile))
    for k in range(20):
        body = pymunk.Body(1, pymunk.moment_for_box(1, (20, 20)))
        body.position = 40 * (k // 4) - 90 + aside, 10 + 20 * (k % 4)
        space.add(body, pymunk.Poly.create_box(body, (20, 20)))
    for shape in space.shapes:
        shape.friction = 0.5
    contact = ra.attach(space)
    for _ in range(60):
        space.step(1 / 60)
    assert len(contact.regions) == 20
