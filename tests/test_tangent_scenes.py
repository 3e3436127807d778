"""Machines without clearance: pins in slots and bores of their own width, for a minute. Nobody is thrown.

Contact touches here along tangents and all round; what the pin does is known: it stays, slides with g sin t, rolls with
2/3 g sin t, or drives a yoke, or a Geneva wheel, as their kinematics say.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pymunk
import pytest

import rigidarea as ra
from rigidarea import shapes

pytestmark = pytest.mark.slow

G, DT, MINUTE = 10.0, 1 / 60, 3600


def slotted(hole: ra.Outline, width: float) -> ra.Outline:
    """A square plate, `width` half wide, with a hole."""
    square = np.array([(-width, -width), (width, -width), (width, width), (-width, width)])
    return ra.Outline.from_curve([square, hole.rings[0]], arcs=[np.zeros((4, 3)), hole.arcs[0]])


def pin_in(
    hole: ra.Outline,
    r: float,
    at: tuple[float, float] = (0.0, 0.0),
    gravity: tuple[float, float] = (0.0, 0.0),
    friction: float = 0.0,
) -> tuple[pymunk.Space, pymunk.Body]:
    space = pymunk.Space()
    space.gravity = gravity
    x0, y0, x1, y1 = hole.bounds
    plate = slotted(hole, 1.5 * max(x1 - x0, y1 - y0)).add_to(space.static_body)
    body = pymunk.Body(1.0, r * r / 2)
    body.position = at
    pin = ra.Outline.circle(r).add_to(body)
    plate.friction = pin.friction = friction
    space.add(plate, body, pin)
    ra.attach(space)
    return space, body


def run(space: pymunk.Space, frames: int, look: Callable[[float], None] = lambda t: None) -> None:
    for k in range(frames):
        space.step(DT)
        look((k + 1) * DT)


@pytest.mark.parametrize("seed", range(12))
def test_a_pin_at_rest_stays(seed: int) -> None:
    """In a slot or a bore of its own width, anywhere in it, without gravity."""
    rng = np.random.default_rng(seed)
    r, length = rng.uniform(0.05, 1, 2)
    bore = seed % 3 == 0
    hole = ra.Outline.circle(r) if bore else shapes.capsule(length, r)
    at = (0.0, 0.0) if bore else (float(rng.choice([-1, rng.uniform(-1, 1), 0, 1])) * length / 2, 0.0)
    space, body = pin_in(hole, r, at)
    run(space, MINUTE)
    assert abs(body.position - at) <= 1e-9 * r
    assert abs(body.velocity) <= 1e-9 * r and abs(body.angular_velocity) <= 1e-9


@pytest.mark.parametrize("slope", [2e-4, 0.01, math.radians(30)])
@pytest.mark.parametrize("friction", [0.0, 1.0])
@pytest.mark.parametrize("r", [0.05, 0.1234567, 0.3])
def test_a_pin_slides_and_rolls_down_its_slot(slope: float, friction: float, r: float) -> None:
    """Along a slot inclined to gravity, 3 m or a minute long, whichever is less."""
    gain = G * math.sin(slope) * (2 / 3 if friction else 1)
    space, body = pin_in(
        shapes.capsule(4.0, r), r, (-1.5, 0.0), (G * math.sin(slope), -G * math.cos(slope)), friction
    )
    off = []

    def look(t: float) -> None:
        off.append(abs(body.position.x + 1.5 - gain * t * t / 2) / 3.0)
        assert abs(body.position.y) <= 0.01 * r

    run(space, min(MINUTE, int(math.sqrt(6.0 / gain) / DT)), look)
    assert max(off) <= 0.005


@pytest.mark.parametrize("friction", [0.05, 0.2, 0.6])
@pytest.mark.parametrize("r", [0.05, 0.1234567, 0.3])
def test_a_pin_that_slides_in_its_slot_comes_to_roll(friction: float, r: float) -> None:
    """v0 - mu g t until 2/3 of v0, and that from then on (Routh, Advanced rigid dynamics, 1905): the side it lies on
    slows it, the other, which it touches as well, does nothing.

    Off by 0.005 of v0: the frame in which sliding ends is split nowhere, and the slot's sides give by 2e-4 of r.
    """
    start = 1.5
    of_each = math.sqrt(friction)  # a pair has the product
    space, body = pin_in(shapes.capsule(8.0, r), r, (-3.5, 0.0), (0.0, -G), of_each)
    body.velocity = (start, 0.0)
    off = []

    def look(t: float) -> None:
        speed = max(start - friction * G * t, 2 / 3 * start)
        off.append(abs(body.velocity.x - speed) / start)
        assert abs(body.position.y) <= 0.01 * r

    run(space, int(6.5 / start / DT), look)
    assert max(off) <= 0.005
    assert -body.angular_velocity * r == pytest.approx(2 / 3 * start, rel=0.005)


@pytest.mark.parametrize("spin", [0.0, 3.0])
@pytest.mark.parametrize("r", [0.07, 0.25, 0.7654321])
def test_a_pin_lies_and_spins_in_its_bore(spin: float, r: float) -> None:
    """Smooth and under gravity: it lies there, and its spin stays. (Spun it may whirl, a hundredth of r about,
    and that changes its spin in the fourth digit.)"""
    space, body = pin_in(ra.Outline.circle(r), r, (0.0, 0.0), (0.0, -G))
    body.angular_velocity = spin
    far = []
    run(space, MINUTE, lambda t: far.append(abs(body.position)))
    assert max(far) <= (0.05 * r if spin else 1e-3 * r)
    assert body.angular_velocity == pytest.approx(spin, abs=1e-3)
    if not spin:
        assert abs(body.velocity) <= 1e-6


@pytest.mark.parametrize("r", [0.1, 0.1234567])
def test_a_scotch_yoke_without_clearance(r: float) -> None:
    """x = R cos(w t), of a yoke that a pin drives in a slot of its width."""
    crank, speed = 1.0, math.tau / 3
    space = pymunk.Space()
    drive = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    drive.angular_velocity = speed
    pin = ra.Outline.circle(r, (crank, 0.0)).add_to(drive)
    slot = shapes.capsule(2 * crank + r, r).rotated(math.pi / 2)
    yoke = pymunk.Body(1.0, math.inf)
    yoke.position = (crank, 0.0)
    plate = slotted(slot, 2.0 * crank).add_to(yoke)
    guide = pymunk.GrooveJoint(space.static_body, yoke, (-10, 0), (10, 0), (0, 0))
    pin.friction = plate.friction = 0.0
    space.add(drive, pin, yoke, plate, guide)
    ra.attach(space)
    off = []
    run(space, MINUTE, lambda t: off.append(abs(yoke.position.x - crank * math.cos(speed * t))))
    assert max(off) <= 0.02 * crank
    assert abs(yoke.position.y) <= 0.01 * crank


@pytest.mark.parametrize("pin", [0.8, 0.8123457])
def test_a_geneva_drive_without_clearance(pin: float) -> None:
    """The wheel turns by a sixth a turn, along tan psi = l sin phi / (1 - l cos phi); the pin as wide as the slots."""
    parts = shapes.geneva(6, 5.0, pin, 0.0, locking_clearance=0.01)
    speed, start = math.pi, -parts.entry_angle - 0.3
    space = pymunk.Space()
    drive = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    drive.angle, drive.angular_velocity = start, speed
    wheel = pymunk.Body(1.0, parts.wheel.moment(1.0))
    wheel.position, wheel.angle = (5.0, 0.0), parts.wheel_angle(start)
    made = [parts.pin.add_to(drive), parts.locking_disc.add_to(drive), parts.wheel.add_to(wheel)]
    for shape in made:
        shape.friction = 0.0
    axle = pymunk.PivotJoint(space.static_body, wheel, (5.0, 0.0), (0.0, 0.0))
    axle.collide_bodies = False
    space.add(drive, wheel, axle, *made)
    ra.attach(space)
    first, ratio, off = wheel.angle, math.sin(math.pi / 6), []

    def look(t: float) -> None:
        turns, phi = divmod(start + speed * t + math.pi, math.tau)
        phi = min(max(phi - math.pi, -parts.entry_angle), parts.entry_angle)
        psi = math.atan2(ratio * math.sin(phi), 1 - ratio * math.cos(phi))
        want = -(psi + math.pi / 6) - turns * math.pi / 3
        off.append(abs(wheel.angle - first - want))
        assert abs(wheel.angular_velocity) <= 2 * speed * ratio / (1 - ratio)

    run(space, MINUTE, look)
    assert max(off) <= 0.05
