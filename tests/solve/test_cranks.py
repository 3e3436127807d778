"""What turns steadily on taut joints keeps its energy: cranks of a parallelogram, a weight at the end of an arm."""

from __future__ import annotations

import math

import pymunk
import pytest

import rigidarea

DT = 1 / 60


def _energy(space: pymunk.Space) -> float:
    return math.fsum(
        0.5 * body.mass * body.velocity.dot(body.velocity) + 0.5 * body.moment * body.angular_velocity**2
        for body in space.bodies
    )


@pytest.mark.parametrize("cranks", [2, 3, 5])
def test_cranks_turn_on(cranks: int) -> None:
    """Parallel cranks on one rod, two revolutions in flight: the energy that they had, and the angle, within 1 %.

    (Jammed before: joints had what turns steadily against each other come to rest. In pymunk .38 of it is left. Four
    cranks may still jam at a dead point: more rods than are needed, each a trifle off.)
    """
    space = pymunk.Space()
    length, apart, speed = 50, 60, -10
    rod = pymunk.Body(1, pymunk.moment_for_box(1, (apart * cranks, 8)))
    rod.position, rod.velocity = (apart * (cranks - 1) / 2, length), (-speed * length, 0)
    space.add(rod)
    first = None
    for k in range(cranks):
        crank = pymunk.Body(1, pymunk.moment_for_box(1, (length, 6)))
        crank.position, crank.angle = (apart * k, length / 2), math.pi / 2
        crank.velocity, crank.angular_velocity = (-speed * length / 2, 0), speed
        space.add(crank, pymunk.PivotJoint(space.static_body, crank, (apart * k, 0)))
        space.add(pymunk.PivotJoint(crank, rod, (apart * k, length)))
        first = first or crank
    rigidarea.attach(space)
    start = _energy(space)
    for _ in range(75):
        space.step(DT)
    assert _energy(space) == pytest.approx(start, rel=0.01)
    assert first is not None
    assert first.angle - math.pi / 2 == pytest.approx(speed * 75 * DT, rel=0.01)


@pytest.mark.parametrize("locked", [False, True])
@pytest.mark.parametrize("weight", [1, 5, 20])
def test_a_weight_at_the_end_of_a_light_arm(weight: float, locked: bool) -> None:
    """It goes round on, two seconds, within 1 % of its speed. (As little as .52 was left of it; in pymunk .58.)"""
    space = pymunk.Space()
    arm = pymunk.Body(1, pymunk.moment_for_box(1, (50, 6)))
    arm.position, arm.velocity, arm.angular_velocity = (25, 0), (0, 250), 10
    box = pymunk.Body(weight, pymunk.moment_for_box(weight, (40, 40)))
    box.position, box.velocity = (50, 0), (0, 500)
    space.add(
        arm, box, pymunk.PivotJoint(space.static_body, arm, (0, 0)), pymunk.PivotJoint(arm, box, (50, 0))
    )
    if locked:
        space.add(pymunk.GearJoint(space.static_body, box, 0, 1))
    rigidarea.attach(space)
    for _ in range(120):
        space.step(DT)
    assert arm.angular_velocity == pytest.approx(10, rel=0.01)
