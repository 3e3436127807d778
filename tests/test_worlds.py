"""Many worlds: each to the bit what the attached space does, whatever the threads; parameters, resets, refusals."""

from __future__ import annotations

import numpy as np
import pymunk
import pytest
from world_scenes import DT, pile, state, with_joints

import rigidarea as ra
from rigidarea.worlds import Worlds


def worlds_of(make, seed: int, n: int = 2, frames: int = 0, **more) -> tuple[pymunk.Space, Worlds]:
    space = make(seed)
    ra.attach(space)
    for _ in range(frames):
        space.step(DT)
    return space, Worlds(space, n, **more)


def plain(seed: int) -> pymunk.Space:
    """A scene with joints, of bodies that only pymunk moves."""
    return with_joints(seed)


@pytest.mark.parametrize("make", [pile, plain])
@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("frames", [0, 40])
def test_a_world_does_what_the_space_alone_does(make, seed, frames):
    space, worlds = worlds_of(make, 500 + seed, frames=frames)
    for _ in range(120):
        space.step(DT)
        states = worlds.step(DT)
        np.testing.assert_array_equal(states[0], state(space))
        np.testing.assert_array_equal(states[1], state(space))


@pytest.mark.slow
@pytest.mark.parametrize("make", [pile, plain])
@pytest.mark.parametrize("part", range(10))
def test_five_hundred_of_each(make, part):
    for seed in range(7000 + 50 * part, 7050 + 50 * part):
        space, worlds = worlds_of(make, seed, frames=seed % 60)
        for _ in range(120):
            space.step(DT)
            np.testing.assert_array_equal(worlds.step(DT)[1], state(space))


def test_forces_act_as_the_bodys_own(seed=3):
    space, worlds = worlds_of(pile, seed, 3)
    draw = np.random.default_rng(seed)
    for _ in range(60):
        forces = draw.normal(0, 2000, (3, worlds.bodies, 3))
        for body, (fx, fy, torque) in zip(space.bodies, forces[1]):
            body.force, body.torque = (fx, fy), torque
        space.step(DT)
        np.testing.assert_array_equal(worlds.step(DT, forces)[1], state(space))


def test_the_bits_do_not_depend_on_threads_nor_on_who_is_there():
    ends = []
    for n, threads in ((1024, 2), (1024, 1), (16, 5), (5, 2), (1, 1)):
        _, worlds = worlds_of(pile, 21, n, threads=threads)
        draw = np.random.default_rng(1)
        pushes = draw.normal(0, 5000, (1024, worlds.bodies, 3))
        for _ in range(40):
            worlds.step(DT, pushes[:n])
        ends.append(worlds.states)
    for other in ends[1:]:
        np.testing.assert_array_equal(other, ends[0][: len(other)])
    assert not np.array_equal(ends[0][0], ends[0][1])


def test_frames_on_end_are_frames_one_by_one():
    _, worlds = worlds_of(pile, 22, 2)
    forces = np.full((1, worlds.bodies, 3), 700.0)
    worlds.step(DT, forces, frames=50, which=[0])
    for _ in range(50):
        worlds.step(DT, forces, which=[1])
    np.testing.assert_array_equal(worlds.states[0], worlds.states[1])


def test_tables_grow_and_nothing_else_is_heard_of_it():
    """Three dozen that have never touched: at rest they have five times as many contacts."""
    _, worlds = worlds_of(lambda seed: pile(seed, 36), 23, 3)
    space, _ = worlds_of(lambda seed: pile(seed, 36), 23)
    small, snapshot = worlds.nbytes, worlds.snapshot(0)
    for frame in range(200):
        space.step(DT)
        states = worlds.step(DT, which=[0, 2])
        if frame == 60:
            worlds.reset([1])
    assert worlds.nbytes > small
    np.testing.assert_array_equal(states[1], state(space))
    worlds.step(DT, frames=200, which=[1])
    np.testing.assert_array_equal(worlds.states[1], state(space))
    worlds.restore(snapshot, [2])
    worlds.step(DT, frames=200, which=[2])
    np.testing.assert_array_equal(worlds.states[2], state(space))


def test_resets_and_snapshots_of_any_one():
    _, worlds = worlds_of(pile, 24, 4, frames=30)
    first = worlds.states
    worlds.step(DT, frames=20)
    snapshot, middle = worlds.snapshot(1), worlds.states
    worlds.step(DT, frames=20)
    end = worlds.states
    worlds.reset([2, 3])
    np.testing.assert_array_equal(worlds.states[2:], first[2:])
    np.testing.assert_array_equal(worlds.states[:2], end[:2])
    worlds.restore(snapshot, [0, 3])
    np.testing.assert_array_equal(worlds.states[[0, 3]], middle[[1, 1]])
    worlds.step(DT, frames=20, which=[0, 3])
    np.testing.assert_array_equal(worlds.states[[0, 3]], end[[1, 1]])
    worlds.step(DT, frames=40, which=[2])
    np.testing.assert_array_equal(worlds.states[2], end[2])


def one_box(mu: float = 0.5) -> pymunk.Space:
    space = pymunk.Space()
    space.gravity = 0, -100
    floor = pymunk.Segment(space.static_body, (-500, 0), (500, 0), 5)
    box = pymunk.Body(2, pymunk.moment_for_box(2, (10, 10)))
    box.position = 0, 10
    shape = pymunk.Poly.create_box(box, (10, 10))
    floor.friction = shape.friction = mu**0.5
    space.add(floor, box, shape)
    return space


def test_parameters_differ_from_world_to_world():
    """A box thrown along the floor stops at v²/2 mu g; one of mass m rests on a force m g."""
    space = one_box()
    ra.attach(space)
    worlds = Worlds(space, 4)
    worlds.step(DT, frames=60)
    mu = np.array([0.2, 0.4, 0.2, 0.4])
    worlds.friction[:] = np.sqrt(mu)[:, None]
    worlds.gravity[:] = [[0, -100], [0, -100], [0, -50], [0, -50]]
    worlds.set_mass(np.array([[1.0], [2.0], [3.0], [4.0]]), np.full((4, 1), 100.0))
    worlds.step(DT, frames=60)
    states = worlds.states
    states[:, 0, 3] = 60.0
    start = states[:, 0, 0].copy()
    worlds.put(states)
    worlds.step(DT, frames=600)
    went = worlds.states[:, 0, 0] - start
    np.testing.assert_allclose(
        went, 60.0**2 / (2 * mu * [100, 100, 50, 50]), rtol=0.01
    )  # 1/60 s of 3 or more
    weights = np.array([1, 2, 3, 4]) * [100, 100, 50, 50]
    np.testing.assert_allclose([worlds.contacts(i)["force"].sum() for i in range(4)], weights, rtol=1e-3)
    worlds.reset()
    np.testing.assert_array_equal(worlds.mass[:, 0], [1, 2, 3, 4])
    np.testing.assert_array_equal(worlds.gravity[:, 1], [-100, -100, -50, -50])
    np.testing.assert_array_equal(worlds.friction[:, 0], np.sqrt(mu))


def test_contacts_are_the_spaces():
    space, worlds = worlds_of(pile, 26, 2, frames=100)
    contact = ra.attached(space)
    space.step(DT)
    worlds.step(DT)
    ours, theirs = worlds.contacts(1), contact.regions
    place = {body: i for i, body in enumerate(space.bodies)} | {space.static_body: -1}
    rows = [
        (place[r["body_a"]], place[r["body_b"]], *r["centroid"], *r["direction"], r["force"]) for r in theirs
    ]
    mine = [(r["body_a"], r["body_b"], *r["centroid"], *r["direction"], r["force"]) for r in ours]
    assert len(rows) > 3 and sorted(map(tuple, map(np.array, rows)), key=str) == sorted(
        map(tuple, map(np.array, mine)), key=str
    )


def test_the_space_goes_on_by_itself():
    space, worlds = worlds_of(pile, 27, 2)
    before = state(space)
    worlds.step(DT, frames=100)
    np.testing.assert_array_equal(state(space), before)
    del space
    assert np.isfinite(worlds.step(DT)).all()


def test_what_is_not_finite_is_said_and_the_world_is_as_it_was():
    _, worlds = worlds_of(pile, 28, 3)
    states = worlds.states
    states[1, 0, 3] = 1e300
    worlds.put(states)
    forces = np.zeros((3, worlds.bodies, 3))
    forces[1, 0, 0] = 1e308
    with pytest.raises(ra.SimulationError, match="world 1 is not finite"):
        worlds.step(1e10, forces)
    np.testing.assert_array_equal(worlds.states[1], states[1])


def spring_of_ones_own(space: pymunk.Space) -> None:
    a, b = list(space.bodies)[:2]
    spring = pymunk.DampedSpring(a, b, (0, 0), (0, 0), 10, 10, 1)
    spring.force_func = lambda spring, distance: 0.0
    space.add(spring)


CHANGES = {
    "sleeping": lambda space: setattr(space, "sleep_time_threshold", 0.5),
    "collision callbacks": lambda space: space.on_collision(begin=lambda arbiter, space, data: None),
    "a velocity_func": lambda space: setattr(next(iter(space.bodies)), "velocity_func", lambda *args: None),
    "a position_func": lambda space: setattr(next(iter(space.bodies)), "position_func", lambda *args: None),
    "a spring's own force function": spring_of_ones_own,
}


@pytest.mark.parametrize("what", CHANGES)
def test_what_worlds_have_not_is_named(what):
    space = pile(29)
    CHANGES[what](space)
    ra.attach(space)
    with pytest.raises(ValueError, match=what):
        Worlds(space, 2)


def test_bad_arguments_are_refused():
    space = pile(30)
    with pytest.raises(ValueError, match="attach"):
        Worlds(space, 2)
    ra.attach(space)
    with pytest.raises(ValueError, match="n must be"):
        Worlds(space, 0)
    worlds = Worlds(space, 2)
    before = worlds.states
    for call, message in (
        (lambda: worlds.step(0), "dt must be"),
        (lambda: worlds.step(DT, np.zeros((2, 3))), "forces must be finite numbers"),
        (lambda: worlds.step(DT, np.full((2, worlds.bodies, 3), np.nan)), "forces must be finite numbers"),
        (lambda: worlds.step(DT, which=[0, 2]), "which must be different numbers from 0 to 1"),
        (lambda: worlds.step(DT, which=[0, 0]), "which must be different numbers from 0 to 1"),
        (lambda: worlds.put(before[0]), "states must be finite numbers"),
        (lambda: worlds.restore(None, [0]), "snapshot must be one that these worlds have taken"),
        (lambda: worlds.set_mass(-worlds.mass, worlds.moment), "mass must be positive"),
    ):
        with pytest.raises(ValueError, match=message):
            call()
    np.testing.assert_array_equal(worlds.states, before)
