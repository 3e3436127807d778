"""Snapshots, copies and pickles go on with the same bits; what has changed since is refused before anything has."""

from __future__ import annotations

import copy
import pickle
import random
import time

import numpy as np
import pymunk
import pytest

import rigidarea as ra
from world_scenes import DT, mixed, pile, sleepy, state, with_joints

SCENES = {"piles": pile, "joints": with_joints, "sleepers": sleepy, "mixed": mixed}


def steps(space: pymunk.Space, n: int) -> None:
    for _ in range(n):
        space.step(DT)


def attached(make, seed: int) -> tuple[pymunk.Space, ra.AreaContact]:
    space = make(seed)
    contact = ra.attach(space)
    draw = random.Random(seed)
    steps(space, 30 + draw.randrange(120))
    if draw.random() < 0.5:  # who goes leaves rows free, and who comes takes them
        gone = draw.choice(list(space.bodies))
        place = gone.position
        space.remove(*gone.constraints, *gone.shapes, gone)
        steps(space, draw.randrange(3))
        came = pymunk.Body(1, 100)
        came.position = place.x, place.y + 100
        space.add(came, pymunk.Circle(came, 8))
        steps(space, draw.randrange(3))
    return space, contact


def check_restored(make, seed: int, frames: int) -> None:
    space, contact = attached(make, seed)
    snapshot = contact.snapshot()
    steps(space, frames)
    expected, asleep = state(space), [body.is_sleeping for body in space.bodies]
    steps(space, random.Random(seed + 1).randrange(200))
    contact.restore(snapshot)
    steps(space, frames)
    np.testing.assert_array_equal(state(space), expected)
    assert [body.is_sleeping for body in space.bodies] == asleep


def check_copied(make, seed: int, how: str) -> None:
    space, _ = attached(make, seed)
    if how == "pickle":
        other = pickle.loads(pickle.dumps(space))
    else:
        other = space.copy() if how == "copy" else copy.deepcopy(space)
    assert [body.is_sleeping for body in other.bodies] == [body.is_sleeping for body in space.bodies]
    steps(space, 60)
    steps(other, 60)
    np.testing.assert_array_equal(state(other), state(space))


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("seed", range(6))
def test_after_a_restore_the_run_goes_on_with_the_same_bits(scene, seed):
    check_restored(SCENES[scene], 1000 + seed, 60)


@pytest.mark.parametrize("scene", SCENES)
def test_six_hundred_frames_after_a_restore(scene):
    check_restored(SCENES[scene], 77, 600)


@pytest.mark.parametrize("how", ["pickle", "copy", "deepcopy"])
@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("seed", range(4))
def test_copies_of_piles_joints_and_sleepers_go_on_bit_for_bit(scene, how, seed):
    check_copied(SCENES[scene], 2000 + seed, how)


@pytest.mark.parametrize("how", ["pickle", "copy"])
def test_joints_that_chipmunk_lists_in_another_order(how):
    """One was removed: who is kept apart was listed otherwise in the copy, which sorted its pairs anew."""
    check_copied(with_joints, 5371, how)


@pytest.mark.slow
@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("part", range(10))
def test_a_thousand_of_each(scene, part):
    for seed in range(3000 + 100 * part, 3100 + 100 * part):
        check_restored(SCENES[scene], seed, 600 if seed % 10 == 0 else 60)
        check_copied(SCENES[scene], seed, "pickle")


def test_a_snapshot_can_be_put_back_again_and_again():
    space, contact = attached(pile, 5)
    snapshot, ends = contact.snapshot(), []
    for _ in range(3):
        contact.restore(snapshot)
        steps(space, 50)
        ends.append(state(space))
    np.testing.assert_array_equal(ends[0], ends[1])
    np.testing.assert_array_equal(ends[0], ends[2])


def test_tables_that_have_grown_since():
    """Before they fall there is hardly a contact; at rest there are many."""
    space = pile(8, 60)
    contact = ra.attach(space)
    space.step(DT)
    snapshot = contact.snapshot()
    steps(space, 150)
    expected = state(space)
    assert len(contact.regions) > 60
    contact.restore(snapshot)
    steps(space, 150)
    np.testing.assert_array_equal(state(space), expected)


def test_what_the_user_does_after_it_is_undone():
    space, contact = attached(pile, 9)
    snapshot, before = contact.snapshot(), state(space)
    body = next(iter(space.bodies))
    mass = body.mass
    body.position, body.velocity, body.mass, body.force = (200, 800), (3, 4), 7.0, (5, 5)
    contact.restore(snapshot)
    np.testing.assert_array_equal(state(space), before)
    assert body.mass == mass and body.force == (0, 0)
    assert (
        space.point_query_nearest(body.position, 0, pymunk.ShapeFilter()) is not None
    )  # queries see it there


def test_what_a_callback_refused_stays_refused():
    """Inside a platform that it has been let through, a player is not asked about again."""
    space = pymunk.Space()
    space.gravity = 0, -900
    platform = pymunk.Segment(space.static_body, (-100, 0), (100, 0), 10)
    player = pymunk.Body(1, float("inf"))
    player.position, player.velocity = (0, -60), (0, 420)
    feet = pymunk.Circle(player, 10)
    platform.collision_type, feet.collision_type = 1, 2
    space.add(platform, player, feet)
    begins = []

    def one_way(arbiter, space, data):
        begins.append(player.velocity.y)
        arbiter.process_collision = player.velocity.y <= 0

    space.on_collision(1, 2, begin=one_way)
    contact = ra.attach(space)
    while not begins:
        space.step(DT)
    snapshot, place = contact.snapshot(), player.position
    assert abs(place.y) < 20
    steps(space, 90)
    expected, heard = state(space), len(begins)
    assert heard == 2 and 19 < player.position.y < 21  # it fell back onto it
    contact.restore(snapshot)
    assert player.position == place
    steps(space, 90)
    np.testing.assert_array_equal(state(space), expected)
    assert len(begins) == heard + 1  # of the landing alone


@pytest.mark.parametrize("what", ["body", "shape", "joint", "gone"])
def test_a_space_of_other_things_is_refused_before_anything_has_changed(what):
    space, contact = attached(pile, 11)
    snapshot = contact.snapshot()
    first, second = list(space.bodies)[:2]
    if what == "body":
        body = pymunk.Body(1, 1)
        space.add(body, pymunk.Circle(body, 5))
    elif what == "shape":
        space.add(pymunk.Circle(first, 5))
    elif what == "joint":
        space.add(pymunk.PivotJoint(first, second, first.position))
    else:
        space.remove(first, *first.shapes)
    steps(space, 3)
    before = state(space)
    with pytest.raises(ValueError, match=r"expected the (bodies|shapes|joints) that the space had"):
        contact.restore(snapshot)
    np.testing.assert_array_equal(state(space), before)


def test_other_peoples_snapshots_are_refused():
    _, contact = attached(pile, 12)
    _, other = attached(pile, 12)
    for given in (other.snapshot(), None, b""):
        with pytest.raises(ValueError, match="snapshot must be one that this contact has taken"):
            contact.restore(given)
    with pytest.raises(TypeError, match="copy or pickle the space"):
        pickle.dumps(contact.snapshot())
    contact.detach()
    with pytest.raises(RuntimeError, match="detached"):
        contact.snapshot()


def test_within_a_step_there_is_no_snapshot():
    space, contact = attached(pile, 13)
    said = []

    def ask(arbiter, space, data):
        for call in (contact.snapshot, lambda: contact.restore(None)):
            try:
                call()
            except (RuntimeError, ValueError) as error:
                said.append(str(error))

    space.on_collision(pre_solve=ask)
    space.step(DT)
    assert "snapshot() within a step: call it after the step" in said


def test_it_takes_microseconds():
    """Must: 20 us for 20 bodies. Twenty times that, for machines that do something else."""
    space = pile(3, 20)
    contact = ra.attach(space)
    steps(space, 200)
    snapshot = contact.snapshot()
    for call in (contact.snapshot, lambda: contact.restore(snapshot)):
        least = 1.0
        for _ in range(50):
            start = time.perf_counter()
            call()
            least = min(least, time.perf_counter() - start)
        assert least < 400e-6
