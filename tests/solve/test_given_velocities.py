"""What a program gives a body's velocity presses it against what it touches as any force does, and moves nobody in.

Characters' velocities are set in every frame, or by a `velocity_func`; so are speed limits, planets, zones without
gravity. Chipmunk asks the function before it solves contacts, and moves bodies after.
"""

from __future__ import annotations

import itertools
import math
import random
from collections.abc import Callable

import pymunk
import pytest

import rigidarea as ra

DT = 1 / 60


def held_at(speed: float) -> Callable[[pymunk.Body, tuple[float, float], float, float], None]:
    """A velocity function that goes right at this speed, and falls."""

    def function(body: pymunk.Body, gravity: tuple[float, float], damping: float, dt: float) -> None:
        pymunk.Body.update_velocity(body, gravity, damping, dt)
        body.velocity = speed, body.velocity.y

    return function


def limited(body: pymunk.Body, gravity: tuple[float, float], damping: float, dt: float) -> None:
    """pymunk's usual example: no faster than 400 px/s."""
    pymunk.Body.update_velocity(body, gravity, damping, dt)
    if body.velocity.length > 400:
        body.velocity = body.velocity * (400 / body.velocity.length)


@pytest.mark.parametrize("crate", [False, True])
@pytest.mark.parametrize("how", ["function", "set"])
@pytest.mark.parametrize("size, speed", [(16, 100), (16, 500), (24, 200), (32, 300), (48, 500)])
def test_a_player_at_a_wall(size: float, speed: float, how: str, crate: bool) -> None:
    """Three seconds against a wall, or a crate that stands at it: no deeper than a fiftieth of itself."""
    space = pymunk.Space()
    space.gravity = 0, -900
    wall = pymunk.Poly(space.static_body, [(300, -50), (340, -50), (340, 400), (300, 400)])
    space.add(pymunk.Segment(space.static_body, (-500, -5), (500, -5), 5), wall)
    player = pymunk.Body(1, math.inf)
    right = 300.0
    if crate:
        other = pymunk.Body(2, pymunk.moment_for_box(2, (40, 40)))
        other.position = 280, 20
        right = 260.0
        space.add(other, pymunk.Poly.create_box(other, (40, 40)))
    player.position = right - size / 2 - 30, size / 2
    space.add(player, pymunk.Poly.create_box(player, (size, size)))
    if how == "function":
        player.velocity_func = held_at(speed)
    ra.attach(space)
    for _ in range(180):
        if how == "set":
            player.velocity = speed, player.velocity.y
        space.step(DT)
    assert player.position.x + size / 2 - right < 0.02 * size
    assert abs(player.position.y - size / 2) < 0.01 * size


@pytest.mark.parametrize("angle", [0.0, 0.2, 0.5])
@pytest.mark.parametrize("side", [9, 30])
def test_rest_under_a_limit_of_speed(side: float, angle: float) -> None:
    """A box on a slope below the friction angle (0.67) stays, as without the function: a tenth of a pixel in 10 s."""
    space = pymunk.Space()
    space.gravity = 0, -900
    c, s = math.cos(angle), math.sin(angle)
    ground = pymunk.Segment(space.static_body, (-600 * c, -600 * s), (600 * c, 600 * s), 0)
    body = pymunk.Body(1, pymunk.moment_for_box(1, (side, side)))
    body.angle = angle
    body.position = -s * side / 2, c * side / 2
    shape = pymunk.Poly.create_box(body, (side, side))
    ground.friction = shape.friction = 0.9
    body.velocity_func = limited
    space.add(ground, body, shape)
    ra.attach(space)
    for _ in range(30):
        space.step(DT)
    x, y = body.position
    for _ in range(600):
        space.step(DT)
    assert math.hypot(body.position.x - x, body.position.y - y) < 0.1


def planet(radius: float, g: float) -> tuple[pymunk.Space, Callable[..., None]]:
    space = pymunk.Space()
    shape = pymunk.Circle(space.static_body, radius)
    shape.friction = 0.8
    space.add(shape)

    def function(body: pymunk.Body, gravity: tuple[float, float], damping: float, dt: float) -> None:
        body.velocity -= body.position.normalized() * (g * dt)

    return space, function


@pytest.mark.parametrize(
    "radius, size, g, speed", [(200, 10, 600, 100), (100, 15, 900, 60), (400, 8, 300, 150)]
)
def test_a_disc_rolls_round_a_planet(radius: float, size: float, g: float, speed: float) -> None:
    """Twenty seconds, without sinking: within 1 % of its speed. (A weight that lags half a frame behind drives it.)"""
    space, function = planet(radius, g)
    body = pymunk.Body(1, 0.5 * size * size)
    body.position = 0, radius + size
    body.velocity = speed, 0
    body.angular_velocity = -speed / size
    body.velocity_func = function
    shape = pymunk.Circle(body, size)
    shape.friction = 0.8
    space.add(body, shape)
    ra.attach(space)
    for _ in range(1200):
        space.step(DT)
    assert body.velocity.length == pytest.approx(speed, rel=1e-2)
    assert body.position.length == pytest.approx(radius + size, abs=0.01 * size)


@pytest.mark.parametrize("g", [600, 2500])
def test_boxes_rest_on_a_planet(g: float) -> None:
    """Twelve boxes all round it: none has sunk by more than a hundredth of itself after 10 s."""
    space, function = planet(150, g)
    bodies = []
    for k in range(12):
        body = pymunk.Body(1, pymunk.moment_for_box(1, (20, 20)))
        body.angle = k * math.pi / 6
        body.position = pymunk.Vec2d(0, 165).rotated(body.angle)
        body.velocity_func = function
        shape = pymunk.Poly.create_box(body, (20, 20))
        shape.friction = 0.8
        space.add(body, shape)
        bodies.append(body)
    ra.attach(space)
    for _ in range(600):
        space.step(DT)
    assert all(159.8 < body.position.length < 160.5 for body in bodies)


def test_an_orbit_is_pymunks_own() -> None:
    """What touches nobody is moved by a function as pymunk moves it: kick, then drift; energy within 1 % in 100 s."""
    space = pymunk.Space()
    body = pymunk.Body(1, 10)
    body.position = 200, 0
    body.velocity = 0, 0.9 * math.sqrt(4e6 / 200)

    def function(body: pymunk.Body, gravity: tuple[float, float], damping: float, dt: float) -> None:
        body.velocity -= body.position * (4e6 / body.position.length**3 * dt)

    def energy() -> float:
        return 0.5 * body.velocity.dot(body.velocity) - 4e6 / body.position.length

    body.velocity_func = function
    space.add(body, pymunk.Circle(body, 5))
    ra.attach(space)
    start = energy()
    for _ in range(6000):
        space.step(DT)
    assert energy() == pytest.approx(start, rel=1e-2)


@pytest.mark.parametrize("disc", [False, True])
@pytest.mark.parametrize("size, w", [(6, 4.0), (12, 6.0), (24, 6.0)])
def test_a_turning_drum_keeps_them(size: float, w: float, disc: bool) -> None:
    """Six small bodies in a drum of 32 capsules: its wall leaves the tangent by w^2 R h^2 / 2 a frame, up to 1.7 px."""
    draw = random.Random(int(size))
    space = pymunk.Space()
    space.gravity = 0, -900
    drum = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    drum.angular_velocity = w
    ring = [pymunk.Vec2d(120, 0).rotated(2 * math.pi * k / 32) for k in range(33)]
    walls = [pymunk.Segment(drum, a, b, 4) for a, b in itertools.pairwise(ring)]
    space.add(drum, *walls)
    bodies = []
    for _ in range(6):
        body = pymunk.Body(1, pymunk.moment_for_box(1, (size, size)))
        body.position = draw.uniform(-60, 60), draw.uniform(-60, 60)
        shape = pymunk.Circle(body, size / 2) if disc else pymunk.Poly.create_box(body, (size, size))
        space.add(body, shape)
        bodies.append(body)
    for one in space.shapes:
        one.friction = 0.6
    ra.attach(space)
    for _ in range(600):
        space.step(DT)
    assert all(body.position.length < 120 for body in bodies)


@pytest.mark.parametrize("thin", [False, True])
@pytest.mark.parametrize("size, speed", [(12, 20), (24, 40), (40, 80)])
def test_a_platform_lifted_by_its_place(size: float, speed: float, thin: bool) -> None:
    """It has no velocity, and is put up by so much in every frame: who stands on it goes up with it."""
    space = pymunk.Space()
    space.gravity = 0, -900
    lift = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    shape = pymunk.Segment(lift, (-100, 0), (100, 0), 5) if thin else pymunk.Poly.create_box(lift, (200, 10))
    space.add(lift, shape)
    bodies = []
    for k in (-1, 0, 1):
        body = pymunk.Body(1, pymunk.moment_for_box(1, (size, size)))
        body.position = 60 * k, 5 + size / 2
        space.add(body, pymunk.Poly.create_box(body, (size, size)))
        bodies.append(body)
    for one in space.shapes:
        one.friction = 0.7
    ra.attach(space)
    for _ in range(180):
        lift.position = 0, lift.position.y + speed * DT
        space.reindex_shapes_for_body(lift)
        space.step(DT)
    assert all(abs(body.position.y - lift.position.y - 5 - size / 2) < 0.5 * size for body in bodies)


@pytest.mark.parametrize("kind", ["once", "held", "turns"])
@pytest.mark.parametrize("speed", [150, 600, 1000])
def test_a_dash_stays_on_the_floor(speed: float, kind: str) -> None:
    """A player who is sent along a smooth floor by a function is sent along it, by just that speed."""
    space = pymunk.Space()
    space.gravity = 0, -900
    body = pymunk.Body(1, math.inf)
    body.position = 0, 15
    space.add(pymunk.Segment(space.static_body, (-9000, -20), (9000, -20), 20), body)
    space.add(pymunk.Poly.create_box(body, (30, 30)))
    frame = 0

    def function(body: pymunk.Body, gravity: tuple[float, float], damping: float, dt: float) -> None:
        pymunk.Body.update_velocity(body, gravity, damping, dt)
        if kind == "once" and frame == 60:
            body.velocity += (speed, 0)
        if kind == "held" and frame >= 60:
            body.velocity = speed, body.velocity.y
        if kind == "turns" and frame >= 60:
            body.velocity = (speed if frame // 20 % 2 else -speed), body.velocity.y

    body.velocity_func = function
    ra.attach(space)
    highest = 0.0
    for frame in range(180):  # noqa: B007 - the function reads it
        space.step(DT)
        highest = max(highest, body.position.y)
    assert highest < 15.01
    assert abs(body.velocity.x) == pytest.approx(speed, rel=1e-6)


@pytest.mark.parametrize("n, speed, friction", [(3, 150, 0.0), (4, 200, 0.0), (6, 100, 0.5)])
def test_walkers_queue_at_a_wall(n: int, speed: float, friction: float) -> None:
    """Their velocities are set in every frame: they stand in a row, none in another, and none on another."""
    space = pymunk.Space()
    space.gravity = 0, -900
    space.add(pymunk.Segment(space.static_body, (-900, -5), (900, -5), 5))
    space.add(pymunk.Poly(space.static_body, [(300, -50), (340, -50), (340, 400), (300, 400)]))
    walkers = []
    for k in range(n):
        body = pymunk.Body(1, math.inf)
        body.position = 270 - 27 * k, 12
        space.add(body, pymunk.Poly.create_box(body, (24, 24)))
        walkers.append(body)
    for shape in space.shapes:
        shape.friction = friction
    ra.attach(space)
    for _ in range(240):
        for body in walkers:
            body.velocity = speed, body.velocity.y
        space.step(DT)
    places = sorted(body.position.x for body in walkers)
    assert all(24 - (b - a) < 0.5 for a, b in itertools.pairwise([*places, 312]))
    assert all(abs(body.position.y - 12) < 1 for body in walkers)  # rough, they take one another up by that
