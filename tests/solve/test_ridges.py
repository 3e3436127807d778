"""What lies on the peaks of a chain of segments, thick or thin, is carried by them, stays, and gains no energy.

A plank across a peak has its middle past the ends of both segments, and below the line of the slope that it does not
touch; two caps at a joint are one circle; two lines that turn away from one another hide nothing of each other.
"""

from __future__ import annotations

import itertools
import math
import random

import pymunk
import pytest
from solve_world import ENGINE

import rigidarea as ra

pytestmark = pytest.mark.skipif(ENGINE == "pymunk", reason="of area contact")
DT, WEIGHT = 1 / 60, 900.0


def _chain(space: pymunk.Space, points: list[tuple[float, float]], radius: float) -> None:
    for a, b in itertools.pairwise(points):
        segment = pymunk.Segment(space.static_body, a, b, radius)
        segment.friction = 0.8
        space.add(segment)


def _plank(space: pymunk.Space, size: tuple[float, float], at: tuple[float, float]) -> pymunk.Body:
    body = pymunk.Body(1, pymunk.moment_for_box(1, size))
    body.position = at
    shape = pymunk.Poly.create_box(body, size)
    shape.friction = 0.6
    space.add(body, shape)
    return body


def _space() -> pymunk.Space:
    space = pymunk.Space()
    space.gravity = 0, -WEIGHT
    return space


@pytest.mark.parametrize("radius", [0, 1, 3])
@pytest.mark.parametrize("slope", [10, 20, 30, 44, 60, 75])
def test_a_plank_laid_on_two_peaks_lies(slope, radius):
    """Nothing pushes it along, and it bears on both: what moves is less than what a step of gravity gives, 15 px/s.

    A thousandth of that at rest. (7 to 22 px/s for ever on caps; up to 81,000 px/s, or 13 px deep, on lines.)
    """
    rise, run = 36 * math.tan(math.radians(slope)), 36
    for x in (-15, -5, 0, 3, 11):
        space = _space()
        half = [(-40 - 2 * run, 0), (-40 - run, 0), (-40, rise), (-40 + run, 0)]
        _chain(space, half + [(-px, y) for px, y in reversed(half)], radius)
        body = _plank(space, (150, 10), (x, rise + 5 + radius + 1))
        ra.attach(space)
        fastest = 0.0
        for i in range(300):
            space.step(DT)
            if i > 200:
                fastest = max(fastest, body.velocity.length)
        assert fastest < 0.015, x
        # two peaks of 1,400 weights an allowed depth each, of .005 of its thickness; a corner twice that
        assert abs(body.position.y - (rise + 5 + radius)) < 0.1, x
        assert abs(body.angle) < 0.01, x


@pytest.mark.parametrize("size", [(200, 4), (100, 10)])
@pytest.mark.parametrize("height", [5, 20])
def test_a_plank_dropped_on_a_bump_gains_no_energy(size, height):
    """Of a floor of lines. (47 of 100 gained, up to 281,000 times as much; two went through.)"""
    draw = random.Random(f"{size} {height}")
    for _ in range(25):
        space = _space()
        _chain(space, [(-300, 0), (-36, 0), (0, height), (36, 0), (300, 0)], 0)
        body = _plank(space, size, (draw.uniform(-60, 60), 80))
        ra.attach(space)
        for _ in range(120):
            space.step(DT)
            energy = WEIGHT * body.position.y + 0.5 * body.kinetic_energy  # Chipmunk's is twice it
            # a fall's velocity is half a step ahead of its place, here 3 % of the energy
            assert energy < 1.04 * WEIGHT * 80
        assert body.position.y > -1 or abs(body.position.x) > 300


@pytest.mark.parametrize("shape", ["ball", "box"])
@pytest.mark.parametrize("slope", [5, 22, 24, 26, 30, 40, 50, 70])
def test_a_ridge_of_two_lines_carries(slope, shape):
    """What falls on it is no deeper than a blow's way within a step, at most. (Up to its middle, turns of 45 to 90.)"""
    down = -100 * math.tan(math.radians(slope))
    for k in range(12):
        for y in (40, 61, 90):
            space = _space()
            _chain(space, [(-100, down), (0, 0), (100, down)], 0)
            body = pymunk.Body(1, 50)
            body.position = 0.1 + 0.3 * k, y
            space.add(
                body, pymunk.Circle(body, 10) if shape == "ball" else pymunk.Poly.create_box(body, (20, 20))
            )
            ra.attach(space)
            for _ in range(60):
                space.step(DT)
                x, y = body.position
                if abs(x) < 5:
                    gone = (
                        10 - math.hypot(x, y) if shape == "ball" else 10 - y - 10 * abs(math.sin(body.angle))
                    )
                    assert gone < 2.0, (k, y)  # of 10


def test_a_capsule_that_began_across_a_thin_one_is_let_out():
    """It goes on as it flew, out of the segment that it was put across, and is not shot. (10,000 px/s.)

    Where its end is level with the segment's far side the area does not grow with the depth: a force without a slope.
    """
    draw = random.Random(594)
    for _ in range(60):
        space = pymunk.Space()
        bar = pymunk.Segment(space.static_body, (100, 250), (350, 150), 3)
        body = pymunk.Body(0.83, 278)
        body.position = 210 + draw.uniform(-20, 20), 215 + draw.uniform(-20, 20)
        body.angle = draw.uniform(0, 2 * math.pi)
        body.velocity = draw.uniform(-300, 300), draw.uniform(-300, 300)
        body.angular_velocity = draw.uniform(-4, 4)
        space.gravity = 0, -900
        space.add(bar, body, pymunk.Segment(body, (-29, 0), (29, 0), draw.uniform(2, 12)))
        ra.attach(space)
        for _ in range(60):
            space.step(DT)
            # 424 px/s given, 900 of gravity in a second, and a length a tenth of a second to come out
            assert body.velocity.length < 2200


@pytest.mark.parametrize("speed", [5, 20, 100])
@pytest.mark.parametrize("shape", ["trapezoid", "triangle"])
def test_a_slanted_front_is_not_caught_where_lines_meet(shape, speed):
    """A smooth body whose front leans back slides over a flush seam: the front corner's sliver shows no side.

    (With what is nearest deciding there as well 38, 9, 2 of 60 triangles were turned back.)
    """
    points = {"trapezoid": [(-12, -8), (12, -8), (6, 8), (-6, 8)], "triangle": [(-12, -8), (12, -8), (0, 8)]}[
        shape
    ]
    draw = random.Random(f"{shape} {speed}")
    for _ in range(20):
        space = _space()
        for a, b in [((-60, 0), (0, 0)), ((0, 0), (60, 0))]:
            space.add(pymunk.Segment(space.static_body, *draw.choice([(a, b), (b, a)]), 0))
        body = pymunk.Body(1, pymunk.moment_for_poly(1, points))
        body.position = -14 - draw.uniform(0, 0.1) * speed, 8
        body.velocity = speed, 0
        space.add(body, pymunk.Poly(body, points))
        ra.attach(space)
        while body.position.x < min(10, -12 + 2 * speed):
            space.step(DT)
            assert body.velocity.x == pytest.approx(speed, rel=0.01)
            assert abs(body.angle) < 0.01
