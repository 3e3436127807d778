"""Teeth, slots and hooks: no tooth passes another unseen, and what only flies by asks for nothing."""

from __future__ import annotations

import math
import random

import numpy as np
import pymunk
import pytest

import rigidarea as ra
from rigidarea.geometry.pool import pack
from rigidarea.geometry.teeth import mouth_of

MODULE, TEETH = 0.002, (23, 57)
STAR = ra.Outline([(0, 9), (3, 3), (9, 0), (3, -3), (0, -9), (-3, -3), (-9, 0), (-3, 3)])


def mouth(outline: ra.Outline) -> float:
    return float(pack([outline]).heads[0]["mouth"])


def test_a_stars_slots_are_as_wide_as_its_tips_are_apart():
    assert mouth(STAR) == pytest.approx(math.hypot(9, 9), rel=1e-14)


def test_a_gears_slots_are_pitch_less_tooth():
    """At the tip circle: the pitch there less the tooth's thickness there, as chords."""
    gear = ra.shapes.involute_gear(0.002, 23)
    points = gear.sample(1e-7).rings[0]
    radius = np.hypot(*points.T)
    tips = np.sort(np.arctan2(points[:, 1], points[:, 0])[radius > radius.max() - 1e-9])
    widest = np.diff(tips).max()  # from one tooth's last point at the tip to the next one's first
    assert mouth(gear) == pytest.approx(
        2 * radius.max() * math.sin(widest / 2), rel=1e-3
    )  # a tip's arc has chords


def test_an_internal_gears_teeth_count():
    inner = ra.shapes.internal_gear(MODULE, 60)
    assert mouth(inner) < math.pi * MODULE


def test_scratches_count_little_beside_a_slot():
    slot = [(0, 0), (20, 0), (20, 10), (12, 10), (12, 2), (8, 2), (8, 10)]
    scratched = [*slot, (4, 10), (3.9, 9.95), (3.8, 10), (0, 10)]
    assert mouth(ra.Outline([*slot, (0, 10)])) == 4
    assert mouth(ra.Outline(scratched)) == pytest.approx(4, rel=1e-2)


@pytest.mark.parametrize("sides", [5, 40, 200])
def test_what_is_convex_has_none(sides):
    """Also with more sides than are walked round, corners that rounding has pushed in, and a hair's dent."""
    t = np.linspace(0, 2 * np.pi, sides, endpoint=False)
    ring = np.column_stack((np.cos(t), np.sin(t)))
    assert mouth(ra.Outline(ring)) == math.inf
    dented = np.insert(ring, 1, 0.5 * (ring[0] + ring[1]) * (1 - 1e-6 / sides), axis=0)
    assert mouth_of(dented) == math.inf


def drive(frame: float, frames: int) -> float:
    """How far a driven wheel is from where the pinion has brought it, at most, at its pitch circle (m)."""
    space = pymunk.Space()
    space.collision_slop = 1e-6
    small, large = (
        ra.shapes.involute_gear(MODULE, z, backlash=20e-6, bore=0.008, tolerance=2e-7) for z in TEETH
    )
    distance = MODULE * sum(TEETH) / 2
    pinion = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    pinion.angular_velocity = 20 * math.pi
    wheel = large.body(density=390)
    wheel.position = distance, 0
    wheel.angle = math.pi + math.pi / TEETH[1] + 40e-6 / (MODULE * TEETH[1])
    wheel.angular_velocity = -pinion.angular_velocity * TEETH[0] / TEETH[1]
    load = pymunk.SimpleMotor(space.static_body, wheel, 0)
    load.max_force = 50.0
    space.add(pinion, small.add_to(pinion), wheel, large.add_to(wheel), load)
    space.add(pymunk.PivotJoint(space.static_body, wheel, (distance, 0)))
    contact = ra.attach(space, stiffness=6e10)
    start = wheel.angle
    most = 0.0
    for _ in range(frames):
        contact.step(frame)
        most = max(most, abs(wheel.angle - start + pinion.angle * TEETH[0] / TEETH[1]))
    return most * MODULE * TEETH[1] / 2


@pytest.mark.shown
@pytest.mark.parametrize("teeth", [0.5, 1, 2, 4])
def test_no_tooth_is_missed_from_the_first_frame_on(teeth, record_property):
    """Frames in which half a tooth to four go by: the load sinks 17 um in, which is all that the wheel is late by."""
    late = drive(teeth * 0.1 / TEETH[0], int(60 / teeth))
    record_property("teeth_late_um", 1e6 * late)
    assert late < 25e-6


def test_what_flies_past_asks_for_nothing():
    """Boxes that share a quarter while tips pass by 7 px: at the default two substeps, in flight as at rest."""
    space = pymunk.Space()
    for i in range(2):
        body = STAR.body(mass=1)
        body.position = 16 * i, 12 * i
        body.velocity = 2000 - 500 * i, 300 + 500 * i
        space.add(body, STAR.add_to(body))
    contact = ra.attach(space)
    assert max(contact.step(1 / 120) for _ in range(4)) == 2
    assert [tuple(body.velocity) for body in space.bodies] == [(2000, 300), (1500, 800)]


def test_a_fountain_of_stars_takes_few_substeps():
    """They come down one upon another: 160 a frame were too many for shapes as blunt as these."""
    draw = random.Random(0)
    space = pymunk.Space()
    space.gravity = 0, -900
    space.add(pymunk.Segment(space.static_body, (-900, 0), (900, 0), 5))
    for i in range(10):
        body = STAR.body(mass=1)
        body.position, body.angle = (draw.uniform(-40, 40), 40 + 20 * i), draw.uniform(0, 6)
        shape = STAR.add_to(body)
        shape.friction, shape.elasticity = 0.5, 0.3
        space.add(body, shape)
    contact = ra.attach(space)
    taken = [contact.step(1 / 60) for _ in range(180)]
    assert np.mean(taken) < 6
    assert all(body.position.y > 5 for body in space.bodies)
