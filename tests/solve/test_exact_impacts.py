"""Impacts and rolling whose outcome is exact, at the defaults: scenes of each kind at random.

A plastic corner, two rough discs; what lands rough and skids until it rolls; what rolls on a plank that may move.
Coulomb's law and Newton's, with the mass that the contact point feels (E. J. Routh, "Dynamics of a System of Rigid
Bodies", part 1, ch. 5): an impulse j changes a body's velocity by j/m and its spin by r x j/I.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable

import numpy as np
import pymunk
import pytest

import rigidarea as ra

DT = 1 / 60
Scene = Callable[[random.Random, bool], float | None]


def _slab(space: pymunk.Space, friction: float, elasticity: float = 0.0) -> None:
    ground = pymunk.Poly(space.static_body, [(-4000, -20), (4000, -20), (4000, 0), (-4000, 0)])
    ground.friction, ground.elasticity = friction, elasticity
    space.add(ground)


def _disc(space: pymunk.Space, radius: float, mass: float, friction: float, elasticity: float) -> pymunk.Body:
    body = pymunk.Body(mass, pymunk.moment_for_circle(mass, 0, radius))
    shape = pymunk.Circle(body, radius)
    shape.friction, shape.elasticity = friction, elasticity
    space.add(body, shape)
    return body


def _run(space: pymunk.Space, ours: bool, frames: int) -> None:
    if ours:
        ra.attach(space)
    for _ in range(frames):
        space.step(DT)


def _off_after_a_blow(
    space: pymunk.Space, body: pymunk.Body, right: np.ndarray, side: float, ours: bool
) -> float:
    """How far off a body that falls is, of its speed, in the best of the frames after it has struck (no gravity)."""
    fall = -body.velocity.y
    scale = np.array([1, 1, side / 2]) / fall
    off = math.inf
    if ours:
        ra.attach(space)
    for _ in range(6):
        space.step(DT)
        if body.velocity.y > -fall:
            now = np.array([*body.velocity, body.angular_velocity])
            off = min(off, float(np.abs(scale * (now - right)).max()))
    return off


def corner(draw: random.Random, ours: bool, friction: float) -> float | None:
    """A tilted box, without gravity, plastic: how far off it is after its first corner has struck, of its speed.

    The least of the frames after that. None: it would slip back within the impact, or the other corner follows at once.
    """
    space = pymunk.Space()
    _slab(space, friction)
    side, tilt = draw.uniform(16, 40), draw.uniform(0.15, 0.65)
    fall, along = draw.uniform(50, 600), draw.uniform(-200, 200)
    moment = pymunk.moment_for_box(1, (side, side))
    body = pymunk.Body(1, moment)
    shape = pymunk.Poly.create_box(body, (side, side))
    shape.friction = 1
    body.angle = tilt
    (x, y), (next_x, next_y) = sorted((v.rotated(tilt) for v in shape.get_vertices()), key=lambda v: v.y)[:2]
    body.position = 0, -y + draw.uniform(0.3, 2.5) * fall * DT
    body.velocity = along, -fall
    space.add(body, shape)
    felt = np.array([[1 + x * x / moment, -x * y / moment], [-x * y / moment, 1 + y * y / moment]])
    j, jt = np.linalg.solve(felt, [fall, -along])
    if abs(jt) > friction * j:
        sign = -math.copysign(friction, along)
        j = fall / (felt[0, 0] + sign * felt[0, 1])
        jt = sign * j
        if j < 0 or (along + felt[1, 0] * j + felt[1, 1] * jt) * along < 0:
            return None
    right = np.array([along + jt, j - fall, (x * j - y * jt) / moment])
    if next_y - y < -2 * DT * (right[1] + right[2] * next_x):
        return None
    return _off_after_a_blow(space, body, right, side, ours)


def two_discs(draw: random.Random, ours: bool, elasticity: float) -> float:
    """A rough disc, spinning, meets another off its middle."""
    space = pymunk.Space()
    friction = draw.uniform(0.05, 0.6)
    radius, mass = [draw.uniform(8, 20) for _ in range(2)], [draw.uniform(0.3, 3) for _ in range(2)]
    reach = sum(radius)
    off, speed, spin = draw.uniform(-0.8, 0.8) * reach, draw.uniform(50, 900), draw.uniform(-20, 20)
    one = _disc(space, radius[0], mass[0], 1.0, 1.0)
    other = _disc(space, radius[1], mass[1], friction, elasticity)
    way = math.sqrt(reach**2 - off**2)
    one.position, one.velocity = (-way - draw.uniform(0.3, 2.5) * speed * DT, off), (speed, 0)
    one.angular_velocity = spin
    _run(space, ours, 6)
    n = pymunk.Vec2d(way, -off) / reach
    t = n.perpendicular()
    inverse = 1 / mass[0] + 1 / mass[1]
    j = (1 + elasticity) * speed * n.x / inverse
    jt = (speed * t.x + spin * radius[0]) / (3 * inverse)  # a disc's rim feels a third of its mass
    jt = min(friction * j, max(-friction * j, jt))
    given = j * n + jt * t
    wrong = [(one.velocity - pymunk.Vec2d(speed, 0) + given / mass[0]).length]
    wrong.append((other.velocity - given / mass[1]).length)
    for body, r, m, was in zip((one, other), radius, mass, (spin, 0.0)):
        wrong.append(abs(r * (body.angular_velocity - was) + 2 * jt / m))
    return max(wrong) / speed


def beside_an_edge(draw: random.Random, ours: bool, elasticity: float) -> float | None:
    """A smooth tilted box strikes a ground near the end of it: how far off it is after that, of its speed.

    As `corner`. (Where the end was within a substep's way, both were taken for two faces that land flat.)
    """
    space = pymunk.Space()
    _slab(space, 0.0, elasticity)
    side, height = draw.uniform(6, 40), draw.uniform(6, 40)
    tilt, fall, beside = draw.uniform(0.25, 1.3), draw.uniform(60, 600), 10 ** draw.uniform(-0.7, 0.9)
    moment = pymunk.moment_for_box(1, (side, height))
    body = pymunk.Body(1, moment)
    shape = pymunk.Poly.create_box(body, (side, height))
    shape.elasticity = 1
    body.angle, body.velocity = tilt, (0, -fall)
    (x, y), *others = sorted((v.rotated(tilt) for v in shape.get_vertices()), key=lambda v: v.y)
    body.position = 4000 - beside - x, -y + draw.uniform(0.3, 2.5) * fall * DT
    space.add(body, shape)
    j = (1 + elasticity) * fall / (1 + x * x / moment)
    right = np.array([0, j - fall, x * j / moment])
    for next_x, next_y in others:  # another comes down at once, or the box's side on the end
        if next_y - y < -4 * DT * (right[1] + right[2] * next_x):
            return None
    across, up = next((v.x - x, v.y - y) for v in others if v.x > x)
    if beside < across and beside * up / across < -4 * DT * (right[1] + right[2] * (x + beside)):
        return None
    return _off_after_a_blow(space, body, right, side, ours)


def lands_rough(draw: random.Random, ours: bool) -> float:
    """A disc lands on a slab, is braked by as much as friction bears, and skids until it rolls."""
    space = pymunk.Space()
    space.gravity = 0, -900
    friction = draw.uniform(0.1, 0.6)
    _slab(space, friction)
    radius, high, speed = draw.uniform(8, 20), draw.uniform(20, 100), draw.uniform(50, 400)
    body = _disc(space, radius, 1, 1.0, 0.0)
    body.position, body.velocity = (0, radius + high), (speed, 0)
    fall = math.sqrt(2 * 900 * high)
    frames = int(fall / 900 / DT) + 2
    _run(space, ours, frames)
    braked = friction * (fall + 900 * (frames * DT - fall / 900))
    return abs(body.velocity.x - max(speed - braked, 2 * speed / 3)) / speed


def rolls_on_a_plank(draw: random.Random, ours: bool) -> float:
    """A disc rolls on a plank that lies on ice, at rest: nothing slows either of them. 2 s."""
    space = pymunk.Space()
    space.gravity = 0, -900
    _slab(space, 0.0)
    mass = draw.uniform(1, 5)
    plank = pymunk.Body(mass, pymunk.moment_for_box(mass, (1200, 20)))
    plank.position = 0, 10
    shape = pymunk.Poly.create_box(plank, (1200, 20))
    shape.friction = 1
    radius, speed = draw.uniform(8, 20), draw.uniform(30, 200)
    body = _disc(space, radius, draw.uniform(0.3, 8), draw.uniform(0.3, 1), 0.0)
    body.position, body.velocity, body.angular_velocity = (-150, 20 + radius), (speed, 0), -speed / radius
    space.add(plank, shape)
    _run(space, ours, 120)
    return abs(body.angular_velocity * radius + speed) / speed


#: What is asked of each, of its speed: 2e-3 where a body turns between the first touch and the frame's end, 5e-3 where
#: it turns fast; what rolls has its lever from the overlap's centroid, 1e-4 of a radius within.
KINDS: dict[str, tuple[Scene, float]] = {
    "smooth corner": (lambda draw, ours: corner(draw, ours, 0.0), 2e-3),
    "rough corner": (lambda draw, ours: corner(draw, ours, 0.4), 2e-3),
    "elastic corner beside an edge": (lambda draw, ours: beside_an_edge(draw, ours, 1.0), 5e-3),
    "half elastic corner beside an edge": (lambda draw, ours: beside_an_edge(draw, ours, 0.5), 5e-3),
    "plastic discs": (lambda draw, ours: two_discs(draw, ours, 0.0), 2e-3),
    "elastic discs": (lambda draw, ours: two_discs(draw, ours, 1.0), 2e-3),
    "half elastic discs": (lambda draw, ours: two_discs(draw, ours, 0.5), 2e-3),
    "landing": (lands_rough, 1e-3),
    "plank": (rolls_on_a_plank, 1e-3),
}


def _off(kind: str, seed: int, ours: bool) -> float | None:
    return KINDS[kind][0](random.Random(f"{kind} {seed}"), ours)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_of_many_hardly_one_is_off(kind):
    """Others, 200 of each kind: the median within a fifth of what is asked, all but 2 % within it; pymunk's beside."""
    told = {}
    for ours in (True, False):
        off = [_off(kind, seed, ours) for seed in range(1000, 1200)]
        told[ours] = sorted(x for x in off if x is not None)
    for ours, name in ((True, "ours"), (False, "pymunk")):
        off = told[ours]
        print(
            f"\n{kind}: {name} median {off[len(off) // 2]:.1e}, worst tenth {off[-len(off) // 10]:.1e}",
            end="",
        )
    most = KINDS[kind][1]
    assert told[True][len(told[True]) // 2] < 0.2 * most
    assert sum(x > most for x in told[True]) <= 0.02 * len(told[True])


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("kind", KINDS)
def test_an_impact_is_as_it_should_be(kind, seed):
    off = _off(kind, seed, True)
    assert off is None or off < KINDS[kind][1]
