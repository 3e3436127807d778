"""Many worlds: each to the bit what the attached space does, whatever the threads; parameters, resets, refusals."""

from __future__ import annotations

import numpy as np
import pymunk
import pytest

import rigidarea as ra
from rigidarea.worlds import Worlds
from world_scenes import DT, pile, state, with_joints


def worlds_of(make, seed: int, n: int = 2, frames: int = 0, **more) -> tuple[pymunk.Space, Worlds]:
    space = make(seed)
    ra.attach(space)
    for _ in range(frames):
        space.step(DT)
    return space, Worlds(space, n, **more)


def check_world(make, seed: int) -> None:
    space, worlds = worlds_of(make, seed, frames=seed % 60)
    for _ in range(120):
        space.step(DT)
        np.testing.assert_array_equal(worlds.step(DT)[1], state(space))


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


def test_what_parts_within_a_frame_is_forgotten():
    """Boxes that part within a frame: the space kept the pair, of which Chipmunk had told, and its world did not."""
    check_world(plain, 5739)


@pytest.mark.slow
@pytest.mark.parametrize("make", [pile, plain])
@pytest.mark.parametrize("part", range(10))
def test_five_hundred_of_each(make, part):
    for seed in range(7000 + 50 * part, 7050 + 50 * part):
        check_world(make, seed)


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


def different(threads: int = 2, n: int = 12) -> tuple[list[pymunk.Space], Worlds]:
    """Piles of 7 to 30 bodies and scenes with joints, of which n worlds are made in turn."""
    spaces = [pile(600, 7), with_joints(601), pile(602, 30), with_joints(603), pile(604), pile(605, 12)]
    for space in spaces:
        ra.attach(space)
    return spaces, Worlds(spaces, n, threads=threads)


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_worlds_of_different_spaces_do_what_each_alone_does(threads):
    """Each is as one of Worlds of its own space: forces, resets, snapshots, contacts, room as it grows."""
    spaces, worlds = different(threads)
    alone = [Worlds(space, 1, threads=1) for space in spaces]
    counts = [len(space.bodies) for space in spaces]
    assert worlds.bodies == max(counts) and len(set(counts)) > 3
    np.testing.assert_array_equal(worlds.mask.sum(axis=1), counts + counts)
    draw = np.random.default_rng(2)
    kept, small = None, worlds.nbytes
    for frame in range(150):
        forces = draw.normal(0, 3000, (6, worlds.bodies, 3))
        states = worlds.step(DT, np.concatenate([forces, forces]))
        assert not states[~worlds.mask].any()
        for i, (one, count) in enumerate(zip(alone, counts)):
            ends = one.step(DT, forces[i : i + 1, :count])
            for world in (i, i + 6):
                np.testing.assert_array_equal(states[world, :count], ends[0])
        if frame == 40:
            kept = [(worlds.snapshot(i + 6), one.snapshot(0)) for i, one in enumerate(alone)]
        if frame == 60:
            worlds.reset([0, 1, 6, 7])
            alone[0].reset()
            alone[1].reset()
        if frame == 120:
            for i in (2, 3):
                worlds.restore(kept[i][0], [i, i + 6])
                alone[i].restore(kept[i][1], [0])
    assert worlds.nbytes > small  # some had too little room: all have grown
    np.testing.assert_array_equal(worlds.states[6:], worlds.states[:6])
    every = worlds.contacts()
    for world in range(12):
        mine, own = every[every["world"] == world], alone[world % 6].contacts(0)
        for name in set(own.dtype.names) - {"world"}:
            np.testing.assert_array_equal(np.sort(mine[name], axis=0), np.sort(own[name], axis=0))
    np.testing.assert_array_equal(worlds.contacts([7, 2]), every[np.isin(every["world"], [2, 7])])
    assert len(every) > 20


def box_of(side: float) -> pymunk.Space:
    """A box of this side on a slope of 1 in 2 by gravity; above it one more, of every second space."""
    space = pymunk.Space()
    space.gravity = 50, -100
    floor = pymunk.Segment(space.static_body, (-500, 0), (5000, 0), 5)
    floor.friction = 0.5
    space.add(floor)
    for k in range(1 + int(side) % 2):
        box = pymunk.Body(side, side**3 / 6)
        box.position = 0, 5 + side * (0.5 + k)
        shape = pymunk.Poly.create_box(box, (side, side))
        shape.friction = 0.5
        space.add(box, shape)
    ra.attach(space)
    return space


def test_parameters_of_worlds_of_different_sizes():
    """Boxes of four sides slide at g (sin - mu cos), mu of the world's own, and weigh what the world says."""
    sides = [10.0, 15.0, 20.0, 25.0]
    worlds = Worlds([box_of(side) for side in sides], 8)
    np.testing.assert_array_equal(worlds.mass[:4], [[10, 0], [15, 15], [20, 0], [25, 25]])
    mu = np.linspace(0.1, 0.4, 8)
    worlds.friction[:] = np.sqrt(mu)[:, None]
    worlds.damping[:] = 1.0
    masses = np.where(worlds.mask, 3.0 + np.arange(8)[:, None], 0.0)
    worlds.set_mass(masses, np.where(worlds.mask, 1e3, 0.0))
    np.testing.assert_array_equal(worlds.mass, masses)
    worlds.step(DT, frames=30)  # they sink to where they rest
    before = worlds.states[:, 0, 3]
    worlds.step(DT, frames=60)
    gained = worlds.states[:, 0, 3] - before
    alone = worlds.mask.sum(axis=1) == 1  # a stack rocks as it goes
    np.testing.assert_allclose(gained[alone], (50 - 100 * mu)[alone], rtol=5e-3)
    forces = worlds.contacts()
    for world in range(8):
        on_floor = (forces["world"] == world) & ((forces["body_a"] == -1) | (forces["body_b"] == -1))
        assert forces["force"][on_floor].sum() == pytest.approx(100 * masses[world].sum(), rel=5e-3)
    np.testing.assert_array_equal(worlds.contacts(3)["world"], 3)


def test_bad_sets_of_spaces_are_refused():
    spaces, worlds = different()
    with pytest.raises(ValueError, match="n must be a multiple of the number of spaces, 6, got 7"):
        Worlds(spaces, 7)
    with pytest.raises(ValueError, match="expected a space, or a sequence of them"):
        Worlds([])
    with pytest.raises(ValueError, match="expected a space, or a sequence of them"):
        Worlds([spaces[0], None])
    with pytest.raises(ValueError, match="expected a space, or a sequence of them, got None"):
        Worlds(None)
    with pytest.raises(ValueError, match="attach"):
        Worlds([spaces[0], pile(1)])
    with pytest.raises(ValueError, match="snapshot must be one that these worlds have taken"):
        worlds.restore(worlds.snapshot(1), [1, 2])
    with pytest.raises(ValueError, match="number must be"):
        worlds.joint(0)  # piles have none
    jointed = [pile(606, 5), pile(607, 5)]
    for space, joint in zip(jointed, (pymunk.PinJoint, pymunk.PivotJoint)):
        one, other = list(space.bodies)[:2]
        space.add(joint(one, other, (0, 0), (5, 0)))
        ra.attach(space)
    with pytest.raises(ValueError, match="the same kinds of joints"):
        Worlds(jointed).joint(0)
    assert Worlds(jointed).n == 2


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
        (
            lambda: worlds.set_mass(np.inf * worlds.mass, worlds.moment),
            "mass must be positive and finite, .*inf",
        ),
        (lambda: worlds.set_mass(worlds.mass, np.nan * worlds.moment), "moment must be positive"),
    ):
        with pytest.raises(ValueError, match=message):
            call()
    worlds.set_mass(worlds.mass, np.inf * worlds.moment)  # as pymunk has it: a body that never turns
    worlds.set_mass(worlds.mass, np.ones((2, worlds.bodies)))
    assert (worlds.moment == 1).all()
    np.testing.assert_array_equal(worlds.states, before)
