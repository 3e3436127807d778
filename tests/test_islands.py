"""Islands that take substeps of their own: each goes as it would alone, and where two meet nothing is missed."""

from __future__ import annotations

import pickle
from collections.abc import Iterable

import numpy as np
import pymunk
import pytest

import rigidarea as ra
from rigidarea.chipmunk import AreaContact, attach

FRAME = 1 / 60


def state(bodies: Iterable[pymunk.Body]) -> np.ndarray:
    """(n, 6) x, y, angle and their velocities."""
    return np.array([[*b.position, b.angle, *b.velocity, b.angular_velocity] for b in bodies])


def level(*names: str) -> tuple[AreaContact, dict[str, list[pymunk.Body]]]:
    """A pile, two balls, a pendulum whose bob lies against a box: those that are named."""
    space = pymunk.Space()
    space.gravity = 0, -10
    ground = pymunk.Segment(space.static_body, (-50, 0), (50, 0), 0)
    ground.friction, ground.elasticity = 0.6, 1.0
    space.add(ground)
    made: dict[str, list[pymunk.Body]] = {name: [] for name in names}

    def box(name: str, x: float, y: float) -> None:
        body = pymunk.Body(1, 1 / 6)
        body.position = x, y
        shape = pymunk.Poly.create_box(body, (1, 1))
        shape.friction = 0.6
        space.add(body, shape)
        made[name].append(body)

    def disc(name: str, x: float, y: float) -> None:
        body = pymunk.Body(1, 1 / 8)
        body.position = x, y
        shape = pymunk.Circle(body, 0.5)
        shape.elasticity = 0.8
        space.add(body, shape)
        made[name].append(body)

    if "pile" in names:
        for i in range(4):
            box("pile", -10 + 1.01 * (i % 2), 0.5 + i // 2)
    if "balls" in names:
        disc("balls", 5, 1.2)
        disc("balls", 8, 1.4)
    if "pendulum" in names:
        disc("pendulum", 15, 0.6)
        box("pendulum", 16.1, 0.5)
        space.add(pymunk.PivotJoint(space.static_body, made["pendulum"][0], (13, 4)))
    return attach(space), made


def test_each_island_goes_as_it_would_alone() -> None:
    """Bit by bit: the order in which islands are taken, and who else is there, is nothing to it."""
    wants = {"pile": 2, "balls": 3, "pendulum": 8}
    together, bodies = level(*wants)
    for name, steps in wants.items():
        for body in bodies[name]:  # of the balls each is an island
            together.ask(body, steps)
    for _ in range(20):
        assert together.step(FRAME, steps=2) == 8
    for name, steps in wants.items():
        alone, own = level(name)
        alone.step(FRAME, 20, steps=steps)
        assert np.array_equal(state(bodies[name]), state(own[name])), name


def test_more_substeps_are_taken_back() -> None:
    contact, bodies = level("pile", "balls")
    ball = bodies["balls"][0]
    contact.ask(ball, 8)
    assert contact.step(FRAME, steps=2) == 8
    contact.ask(ball, None)
    assert contact.step(FRAME, steps=2) == 2
    contact.ask(ball, 8)
    contact.space.remove(ball, *ball.shapes)
    assert contact.step(FRAME, steps=2) == 2  # who asked is gone


def test_copies_know_who_has_asked() -> None:
    contact, bodies = level("pile", "pendulum")
    contact.ask(bodies["pendulum"][1], 6)
    contact.step(FRAME, 3, steps=2)
    space = contact.space.copy()
    twin = ra.attached(space)
    assert twin is not None
    assert contact.step(FRAME, 3, steps=2) == twin.step(FRAME, 3, steps=2) == 6
    assert np.array_equal(state(contact.space.bodies), state(space.bodies))


def billiards(asked: int | None) -> AreaContact:
    """A heavy disc drives a light one, twice as fast, into a third that neither could reach at its own speed."""
    space = pymunk.Space()
    for x, mass, speed in ((0.0, 1e3, 60.0), (1.2, 1.0, 0.0), (3.6, 1.0, 0.0)):
        body = pymunk.Body(mass, mass / 8)
        body.position, body.velocity = (x, 0), (speed, 0)
        disc = pymunk.Circle(body, 0.5)
        disc.elasticity = 1.0
        space.add(body, disc)
    contact = attach(space)
    if asked:
        contact.ask(next(iter(space.bodies)), asked)
    return contact


def test_islands_that_meet_within_a_frame_are_one() -> None:
    """By all their kinetic energy they could: just what it would have been with everybody in the finer substeps."""
    contact, fine = billiards(8), billiards(None)
    assert contact.step(FRAME, steps=2) == 8
    fine.step(FRAME, steps=8)
    assert list(contact.space.bodies)[2].velocity.x > 50  # it has been struck
    assert np.array_equal(state(contact.space.bodies), state(fine.space.bodies))


def test_teeth_make_nobody_else_pay() -> None:
    """A gear that spins wants more substeps than two; the pile beside it goes on as if it were alone."""
    contact, bodies = level("pile")
    space = contact.space
    gear = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    gear.position, gear.angular_velocity = (30, 20), 20.0
    driven = pymunk.Body(1, 1)
    driven.position, driven.angle = (33.2, 20), np.pi + np.pi / 16
    outline = ra.shapes.involute_gear(0.2, 16)
    space.add(gear, driven, outline.add_to(gear), outline.add_to(driven))
    space.add(pymunk.PivotJoint(space.static_body, driven, (33.2, 20)))
    contact.step(FRAME)  # finds who is near
    for _ in range(2):
        assert contact.step(FRAME) > 2
    alone, own = level("pile")
    alone.step(FRAME, 3)
    # in the first frame all go together, and sweep on until the last of them has come to rest: what that leaves
    beside, alone = state(bodies["pile"]), state(own["pile"])
    assert np.allclose(beside[:, :3], alone[:, :3], rtol=0, atol=5e-5)
    assert np.allclose(beside[:, 3:], alone[:, 3:], rtol=0, atol=2e-3)


def test_joints_start_from_the_same_when_a_frame_is_run_again() -> None:
    """With a tolerance a frame is run twice: nothing is left of the first time, in the joints' bodies either."""
    contact, bodies = level("pendulum")
    twin, own = level("pendulum")
    for _ in range(3):
        taken = contact.step(FRAME, tolerance=1e-3)
        twin.step(FRAME, steps=taken)
    assert taken > 2
    assert np.array_equal(state(bodies["pendulum"]), state(own["pendulum"]))


def test_only_bodies_of_the_space_may_ask() -> None:
    contact, bodies = level("balls")
    with pytest.raises(ValueError, match="one of the space's"):
        contact.ask(pymunk.Body(1, 1), 4)
    for wrong in (0, 2.5, 2000):
        with pytest.raises(ValueError, match="steps"):
            contact.ask(bodies["balls"][0], wrong)  # type: ignore[arg-type]


def test_who_hardly_moves_takes_one_substep_whoever_else_takes_more() -> None:
    """A pile at rest goes, bit by bit, as it would without the ball that is thrown elsewhere, and comes to rest."""
    contact, bodies = level("pile")
    contact.step(FRAME, 120)
    assert contact.step(FRAME) == 1  # all of it is calm
    alone = pickle.loads(pickle.dumps(contact.space))
    for _ in range(2):
        ball = pymunk.Body(1, 1 / 8)
        ball.position, ball.velocity = (40, 3), (-3, 0)
        shape = pymunk.Circle(ball, 0.5)
        shape.elasticity = 0.8
        contact.space.add(ball, shape)
        for _ in range(30):
            assert contact.step(FRAME) == 2
            alone.step(FRAME)
        assert np.array_equal(state(bodies["pile"]), state(alone.bodies))
        contact.space.remove(ball, shape)
    # no copy of the tables, which would cost as much as the level is large
    assert contact._store.sizes()["kept"] == 0


def test_a_ball_wakes_the_calm_pile_that_it_meets() -> None:
    """Nothing is missed where an island of two substeps comes to one that took one: momentum is passed on."""
    contact, bodies = level("pile")
    contact.step(FRAME, 120)
    ball = pymunk.Body(1, 1 / 8)
    ball.position, ball.velocity = (-4, 1.5), (-30, 0)
    contact.space.add(ball, pymunk.Circle(ball, 0.5))
    for _ in range(12):  # it is there after eight
        contact.step(FRAME)
    # it had 30, and is as heavy as one box; the pile's friction takes 0.6 * 4 * 10 / 60 a frame at most
    assert ball.velocity.x > -20
    assert sum(body.velocity.x for body in bodies["pile"]) < -6
