"""What slides over shapes that lie flush is not caught at their seams, whoever moves them; beside pymunk's.

A body has sunk into the shape that carries it by what bears it, and meets the next one's side as high as that: a wall,
which nothing of the level's outline is. Friction and restitution 0: it keeps the speed along the ground that it had,
exactly.
"""

from __future__ import annotations

import random

import pymunk
import pytest

import rigidarea as ra

GROUNDS = ["static", "kinematic", "lift", "many", "dynamic"]
TILES = ["boxes", "overlapping boxes", "lines", "capsules"]
MOVERS = ["box", "plank", "disc", "capsule"]
FRAMES = 100


def _tile(body: pymunk.Body, kind: str, x: float, wide: float) -> pymunk.Shape:
    if kind == "lines":
        return pymunk.Segment(body, (x, 0), (x + wide, 0), 0)
    if kind == "capsules":
        return pymunk.Segment(body, (x, -3), (x + wide, -3), 3)
    over = 3 if kind == "overlapping boxes" else 0
    left, right = x - over, x + wide + over
    return pymunk.Poly(body, [(left, -20), (right, -20), (right, 0), (left, 0)])


def _lay(space: pymunk.Space, ground: str, tiles: str, wide: float, along: float, up: float) -> None:
    """3,000 px of tiles whose upper side is y = 0: of one body, or of `many` that go alike."""
    body = space.static_body
    for i in range(int(3000 / wide)):
        if ground == "dynamic" and i == 0:
            body = pymunk.Body(1e4, 1e9)
            bed = pymunk.Segment(space.static_body, (-9000, -25), (9000, -25), 5)
            space.add(body, bed, pymunk.Segment(body, (-600, -15), (2400, -15), 5))
        elif ground == "many" or (ground != "static" and i == 0):
            body = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
            space.add(body)
        if body is not space.static_body:
            body.velocity = along, up
        space.add(_tile(body, tiles, i * wide - 600, wide))


def _shapes(kind: str, side: float) -> tuple[pymunk.Body, list[pymunk.Shape], float]:
    """A body, its shapes, and how high its centre is above its underside."""
    half = side / 2
    if kind == "disc":
        body = pymunk.Body(1, pymunk.moment_for_circle(1, 0, half))
        return body, [pymunk.Circle(body, half)], half
    body = pymunk.Body(1, pymunk.moment_for_box(1, (side if kind == "box" else 2 * side, side)))
    if kind == "box":
        return body, [pymunk.Poly.create_box(body, (side, side))], half
    if kind == "capsule":
        return body, [pymunk.Segment(body, (-half, 0), (half, 0), side / 4)], side / 4
    left = pymunk.Poly(body, [(-side, -half), (0, -half), (0, half), (-side, half)])
    right = pymunk.Poly(body, [(0, -half), (side, -half), (side, half), (0, half)])
    return body, [left, right], half


def slide(mover: str, ground: str, tiles: str, seed: int, ours: bool) -> tuple[float, float]:
    """The share that it keeps of its speed along the ground, and how far it has turned at the most."""
    draw = random.Random(f"{mover} {ground} {tiles} {seed}")
    space = pymunk.Space()
    space.gravity = 0, -900
    wide, speed = draw.uniform(15, 60), draw.uniform(80, 600)
    along = 0.0 if ground == "static" else draw.uniform(-200, 200)
    up = draw.uniform(-60, 60) if ground == "lift" else 0.0
    _lay(space, ground, tiles, wide, along, up)
    body, shapes, high = _shapes(mover, draw.uniform(16, 40))
    body.position = 0, high + draw.choice([0.0, draw.uniform(0, 8)])
    body.velocity = along + speed, up
    space.add(body, *shapes)
    if ours:
        ra.attach(space)
    turned = 0.0
    for _ in range(FRAMES):
        space.step(1 / 60)
        turned = max(turned, abs(body.angle))
    return (body.velocity.x - along) / speed, turned


def _caught(mover: str, ground: str, tiles: str, seeds: range, ours: bool = True) -> int:
    """Of so many how many lose or gain 1 % of their speed, or are tipped."""
    told = [slide(mover, ground, tiles, seed, ours) for seed in seeds]
    return sum(abs(kept - 1) > 0.01 or (mover != "disc" and turned > 0.1) for kept, turned in told)


@pytest.mark.parametrize("tiles", TILES)
@pytest.mark.parametrize("ground", GROUNDS)
@pytest.mark.parametrize("mover", MOVERS)
def test_nobody_is_caught_at_a_seam(mover, ground, tiles):
    assert _caught(mover, ground, tiles, range(3)) == 0


@pytest.mark.slow
def test_of_many_hardly_anybody_is_caught():
    """Others, twenty of each kind; pymunk's beside (printed)."""
    count = {True: 0, False: 0}
    n = 0
    for mover in MOVERS:
        for ground in GROUNDS:
            for tiles in TILES:
                for ours in count:
                    count[ours] += _caught(mover, ground, tiles, range(100, 120), ours)
                n += 20
    print(f"\ncaught at a seam, of {n}: {count[True]}; pymunk {count[False]}")
    assert count[True] <= n // 200
    assert count[False] > n // 4


@pytest.mark.parametrize("seed", range(40))
def test_what_lands_smooth_keeps_its_speed_along_the_ground(seed):
    """A disc, without friction, at a flat angle or a steep one: its speed along a level ground does not change.

    To a thousandth of a pixel a second, what sinking into its bed may yet turn. (It was led along the ground as
    along a chain's next segment, and kept all of its speed: 1 % too much.)
    """
    draw = random.Random(seed)
    space = pymunk.Space()
    space.gravity = 0, -900
    space.add(pymunk.Poly(space.static_body, [(-900, -20), (900, -20), (900, 0), (-900, 0)]))
    radius, speed = draw.uniform(8, 20), draw.uniform(80, 600)
    body = pymunk.Body(1, pymunk.moment_for_circle(1, 0, radius))
    body.position = 0, radius + draw.uniform(0, 40)
    body.velocity = speed, 0
    space.add(body, pymunk.Circle(body, radius))
    ra.attach(space)
    for _ in range(60):
        space.step(1 / 60)
    assert body.velocity.x == pytest.approx(speed, abs=1e-3)
    assert abs(body.velocity.y) < 1e-6
