"""A static body that a program moves by its place, and reindexes, drives as a kinematic one: it shoots nobody.

(Mazes that are turned, walls that are pushed. Before a fin that had gone through a disc's middle sent it off at up to
3,000 px/s, where a kinematic one did not.)
"""

from __future__ import annotations

import math
import random

import pymunk
import pytest

import rigidarea

DT = 1 / 60
V = pymunk.Vec2d


def maze(body: pymunk.Body, space: pymunk.Space) -> None:
    """A ring of 24 segments with six fins inside."""
    for k in range(24):
        ends = (V(250, 0).rotated(n * math.pi / 12) for n in (k, k + 1))
        space.add(pymunk.Segment(body, *ends, 6))
    for k in range(6):
        space.add(
            pymunk.Segment(body, V(250, 0).rotated(k * math.pi / 3), V(160, 0).rotated(k * math.pi / 3), 5)
        )


@pytest.mark.parametrize("kind", [pymunk.Body.STATIC, pymunk.Body.KINEMATIC])
@pytest.mark.parametrize("turn", [0.01, 0.02, 0.04])
def test_a_maze_that_is_turned_by_its_angle(turn: float, kind: int) -> None:
    """Twenty discs, ten seconds, after the first: no faster than a fall through the maze makes them, and inside.

    (A wall carries a disc up, and it falls from there: by all of the ring's 488 px at the most.)
    """
    for seed in range(3):
        draw = random.Random(seed)
        space = pymunk.Space()
        space.gravity = 0, -900
        body = pymunk.Body(body_type=kind)
        space.add(body)
        maze(body, space)
        discs = []
        for _ in range(20):
            disc = pymunk.Body(1, pymunk.moment_for_circle(1, 0, 12))
            disc.position = draw.uniform(-100, 100), draw.uniform(-100, 100)
            space.add(disc, pymunk.Circle(disc, 12))
            discs.append(disc)
        for shape in space.shapes:
            shape.friction, shape.elasticity = 0.6, 0.3
        rigidarea.attach(space)
        fastest = 0.0
        for frame in range(600):
            body.angle += turn
            space.reindex_shapes_for_body(body)
            space.step(DT)
            if frame > 60:
                fastest = max(fastest, max(disc.velocity.length for disc in discs))
        assert fastest < math.sqrt(2 * 900 * 488)


def test_what_is_reindexed_where_it_is_drives_nobody() -> None:
    """A program that reindexes its level in every frame has the bits of one that does not.

    Also of a box that is put into the floor: it comes out as slowly as from what does not move.
    """

    def course(again: bool) -> list[tuple[float, float]]:
        space = pymunk.Space()
        space.gravity = 0, -900
        floor = pymunk.Segment(space.static_body, (-200, 0), (200, 0), 5)
        floor.friction = 0.7
        space.add(floor)
        for k in range(6):
            body = pymunk.Body(1000.0 if k == 5 else 1.0, pymunk.moment_for_box(1, (20, 20)))
            body.position = 0, 15 + 21 * k
            shape = pymunk.Poly.create_box(body, (20, 20))
            shape.friction = 0.7
            space.add(body, shape)
        put = pymunk.Body(1.0, pymunk.moment_for_box(1, (20, 20)))
        put.position = 100, 5
        space.add(put, pymunk.Poly.create_box(put, (20, 20)))
        rigidarea.attach(space)
        for _ in range(90):
            if again:
                space.reindex_static()
            space.step(DT)
        return [tuple(body.position) for body in space.bodies]

    assert course(True) == course(False)


@pytest.mark.parametrize("kind", [pymunk.Body.STATIC, pymunk.Body.KINEMATIC])
@pytest.mark.parametrize("sideways", [False, True])
@pytest.mark.parametrize("several, speed", [(1, 60), (1, 150), (1, 400), (3, 60)])
def test_what_is_moved_by_its_place_carries(several: int, speed: float, sideways: bool, kind: int) -> None:
    """A platform that rises, a wall that comes, by its place alone: what it bears is carried, and given no speed.

    One box to its allowed depth (a thousandth of it), three in a row within .7 px, a tenth of what native's sink in at
    60 px/s. (At 120 px/s they fell through before, in pymunk at 150; a box that had sunk into the platform flew off.)
    """
    space = pymunk.Space()
    space.gravity = (0, 0) if sideways else (0, -900)
    along = V(1, 0) if sideways else V(0, 1)
    platform = pymunk.Body(body_type=kind)
    shape = pymunk.Poly.create_box(platform, (20, 300) if sideways else (300, 20))
    space.add(platform, shape)
    boxes = []
    for k in range(several):
        box = pymunk.Body(1, pymunk.moment_for_box(1, (30, 30)))
        box.position = along * (25 + 30 * k)
        space.add(box, pymunk.Poly.create_box(box, (30, 30)))
        boxes.append(box)
    for shape in space.shapes:
        shape.friction = 0.5
    rigidarea.attach(space)
    for frame in range(150):
        platform.position = along * max(0.0, speed * (frame - 30) * DT)
        space.reindex_shapes_for_body(platform)
        space.step(DT)
        ahead = [along.dot(box.position - platform.position) - 25 - 30 * k for k, box in enumerate(boxes)]
        assert min(ahead) > (-0.03 if several == 1 else -0.7)
        assert max(box.velocity.length for box in boxes) < (1e-6 if several == 1 else 3.0)
    assert max(ahead) < 0.1


@pytest.mark.parametrize("kind", [pymunk.Body.STATIC, pymunk.Body.KINEMATIC])
def test_what_is_put_far_on_is_no_motion(kind: int) -> None:
    """A wall that is put half into a box, from afar, is left by it no faster than four of its sizes a second."""
    space = pymunk.Space()
    wall = pymunk.Body(body_type=kind)
    wall.position = -500, 0
    space.add(wall, pymunk.Poly.create_box(wall, (20, 300)))
    box = pymunk.Body(1, pymunk.moment_for_box(1, (30, 30)))
    box.position = 25, 0
    space.add(box, pymunk.Poly.create_box(box, (30, 30)))
    rigidarea.attach(space)
    space.step(DT)
    wall.position = 12, 0
    space.reindex_shapes_for_body(wall)
    before = box.position.x
    for _ in range(60):
        space.step(DT)
        assert box.position.x - before < 1.01 * 4 * 30 * DT
        before = box.position.x
    assert box.position.x > 36.9


def test_what_has_been_moved_once_drives_nobody_later() -> None:
    """A wall that is moved by 3 px, once: a box put 4 px into it a second later leaves as from one that never moved.

    (What had been put there before a past frame was taken from that overlap, and the box left at twice the speed.)
    """

    def course(moved: float) -> list[float]:
        space = pymunk.Space()
        wall = pymunk.Body(body_type=pymunk.Body.STATIC)
        wall.position = -10 - moved, 0
        box = pymunk.Body(1, pymunk.moment_for_box(1, (30, 30)))
        box.position = 300, 0
        space.add(wall, pymunk.Poly.create_box(wall, (20, 300)), box, pymunk.Poly.create_box(box, (30, 30)))
        rigidarea.attach(space)
        space.step(DT)
        wall.position = -10, 0
        space.reindex_shapes_for_body(wall)
        for _ in range(60):
            space.step(DT)
        box.position = 15 - 4, 0
        places = []
        for _ in range(30):
            space.step(DT)
            places.append(box.position.x)
        return places

    assert course(3.0) == course(0.0)
