"""What is static or asleep is looked at by nobody, and its changes are noticed all the same: as in pymunk."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

import numpy as np
import pymunk
import pytest

import rigidarea as ra
from rigidarea.contact import tables as t

DT = 1 / 60
OTHERS = pymunk.ShapeFilter(mask=0)


def world(attached: bool) -> tuple[pymunk.Space, pymunk.Shape, pymunk.Body, pymunk.Shape]:
    """(space, a static block of 10 x 2 whose upper side is y = 0, a box of side 1 that lies on it, and its shape)."""
    space = pymunk.Space()
    space.gravity = 0, -10
    ground = pymunk.Body(body_type=pymunk.Body.STATIC)
    ground.position = 0, -1
    block = pymunk.Poly.create_box(ground, (10, 2))
    body = pymunk.Body(1, 1 / 6)
    body.position = 0, 0.5
    shape = pymunk.Poly.create_box(body, (1, 1))
    block.friction = shape.friction = 0.6
    space.add(ground, block, body, shape)
    if attached:
        ra.attach(space)
    return space, block, body, shape


def steps(space: pymunk.Space, n: int) -> None:
    for _ in range(n):
        space.step(DT)


def sunk(block: Any) -> None:
    block.unsafe_set_vertices([(-5, -1), (5, -1), (5, 0), (-5, 0)])


def sunk_and_reindexed(block: Any) -> None:
    sunk(block)
    block.space.reindex_shape(block)


def lowered(block: Any) -> None:
    block.body.position = 0, -2


def lowered_and_reindexed(block: Any) -> None:
    lowered(block)
    block.space.reindex_shapes_for_body(block.body)


def raised_and_reindexed(block: Any) -> None:
    block.body.position = 0, -0.7
    block.space.reindex_static()


def removed(block: Any) -> None:
    block.space.remove(block)


def removed_with_body(block: Any) -> None:
    block.space.remove(block, block.body)


def gone_and_back(block: Any) -> None:
    space = block.space
    space.remove(block)
    space.add(block)


#: What is done to a static shape on which a box lies: its height after a second, in pymunk to a tenth.
CHANGES: dict[str, Callable[[Any], None]] = {
    "filter": lambda block: setattr(block, "filter", OTHERS),
    "sensor": lambda block: setattr(block, "sensor", True),
    "vertices": sunk,
    "vertices, reindexed": sunk_and_reindexed,
    "moved": lowered,
    "moved, reindexed": lowered_and_reindexed,
    "raised, reindexed": raised_and_reindexed,
    "removed": removed,
    "removed with its body": removed_with_body,
    "removed and added": gone_and_back,
}


@pytest.mark.parametrize("what", CHANGES)
def test_a_static_shape_that_changes_under_a_box(what: str) -> None:
    heights = []
    for attached in (False, True):
        space, block, body, _ = world(attached)
        steps(space, 30)
        CHANGES[what](block)
        steps(space, 40)
        heights.append(body.position.y)
    assert heights[1] == pytest.approx(heights[0], abs=0.15)
    assert (abs(heights[0] - 0.5) < 0.15) == (what in ("vertices", "moved", "removed and added"))


@pytest.mark.parametrize("what", ["filter", "sensor"])
def test_what_lets_pass_and_then_does_not(what: str) -> None:
    """A body falls through while it may, and is caught by the next: changed while the body is in the air above it."""
    for attached in (False, True):
        space, block, body, _ = world(attached)
        if what == "filter":
            block.filter = OTHERS
        else:
            block.sensor = True
        body.position = 0, 1.5
        steps(space, 10)
        if what == "filter":
            block.filter = pymunk.ShapeFilter()
        else:
            block.sensor = False
        steps(space, 60)
        assert body.position.y == pytest.approx(0.5, abs=0.1)


def test_friction_elasticity_and_belts_of_static_shapes() -> None:
    """Set while a box slides, falls, lies: what the pair is now."""
    space, block, body, _ = world(True)
    body.velocity = 3, 0
    block.friction = 0.0
    steps(space, 20)
    assert body.velocity.x == pytest.approx(3, abs=1e-3)
    block.friction = 1.0
    steps(space, 40)
    assert body.velocity.x == pytest.approx(0, abs=1e-3)
    block.surface_velocity = 2, 0
    steps(space, 40)
    assert abs(body.velocity.x) == pytest.approx(2, abs=0.05)
    space, block, body, shape = world(True)
    shape.elasticity = 1.0
    body.position = 0, 1.5
    steps(space, 5)
    block.elasticity = 0.8
    highest = 0.0
    for _ in range(60):
        space.step(DT)
        if body.velocity.y > 0:
            highest = max(highest, body.position.y)
    assert highest == pytest.approx(0.5 + 0.64, abs=0.05)


def test_a_static_body_that_moves_away_as_a_dynamic_one() -> None:
    """Its type is set: it falls, and what lay on it."""
    for attached in (False, True):
        space, block, body, _ = world(attached)
        steps(space, 30)
        block.body.body_type = pymunk.Body.DYNAMIC
        block.body.mass, block.body.moment = 5, 50
        steps(space, 30)
        assert block.body.position.y < -1.5 and body.position.y < 0.2


def level(n: int, asleep: int = 0) -> tuple[pymunk.Space, ra.AreaContact]:
    """Ten boxes on n tiles, and so many boxes asleep far from them."""
    space = pymunk.Space()
    space.gravity = 0, -10
    if asleep:
        space.sleep_time_threshold = 0.3
    for i in range(n):
        corners = [(i % 50 - 25 + x, -(i // 50) - 1 + y) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
        space.add(pymunk.Poly(space.static_body, corners))
    for i in range(asleep):
        body = pymunk.Body(1, 1 / 6)
        body.position = 100 + 2 * i, 0.5
        space.add(body, pymunk.Poly.create_box(body, (1, 1)))
    if asleep:
        space.add(pymunk.Segment(space.static_body, (90, -1), (110 + 2 * asleep, -1), 1))
        while not all(body.is_sleeping for body in space.bodies):
            space.step(DT)
    for i in range(10):
        body = pymunk.Body(1, 1 / 6)
        body.position = 1.5 * i - 7, 0.6
        space.add(body, pymunk.Poly.create_box(body, (1, 1)))
    return space, ra.attach(space)


def test_lists_have_what_is_awake_and_its_pairs_alone() -> None:
    """Not one entry more for a thousand tiles, or for twenty that sleep."""
    found = []
    for n, asleep in ((100, 0), (1000, 0), (100, 20)):
        space, contact = level(n, asleep)
        steps(space, 5)
        counters = contact._store.tables.counters
        found.append([int(counters[k]) for k in (t.AWAKE, t.MOVERS, t.NEAR, t.BOXED, t.LIVE, t.TOLD)])
        assert len(contact._store.tables.pairs) < 200
    assert found[0] == found[1] == found[2] and found[0][0] == 10


def test_who_falls_asleep_and_is_hit_goes_on_with_what_it_had() -> None:
    """Pairs of a sleeping stack are remembered, near nobody, and there again when a ball wakes it."""
    space, block, body, _ = world(True)
    contact: Any = space._area_contact  # type: ignore[attr-defined]
    space.sleep_time_threshold = 0.3
    upper = pymunk.Body(1, 1 / 6)
    upper.position = 0, 1.5
    space.add(upper, pymunk.Poly.create_box(upper, (1, 1)))
    while not upper.is_sleeping:
        space.step(DT)
    steps(space, 3)
    counters = contact._store.tables.counters
    assert counters[t.NEAR] == counters[t.AWAKE] == 0
    heads = contact._store.tables.pairs["head"][contact._store.tables.pairs["a"] >= 0]
    assert len(heads) == 2 and (heads >= 0).all()
    ball = pymunk.Body(1, 0.1)
    ball.position, ball.velocity = (-4, 1.5), (8, 2)
    space.add(ball, pymunk.Circle(ball, 0.4))
    steps(space, 30)
    assert upper.position.x > 0.1 or body.position.x > 0.1
    assert body.position.y > 0.45 and block.body.position == (0, -1)


def test_bodies_come_and_go_and_rows_are_used_again() -> None:
    """Boxes and tiles come and go every frame: after a while no table grows, and everybody is held."""
    space, contact = level(100)
    rng = np.random.default_rng(4)
    alive: list[tuple[Any, ...]] = []
    sizes = set()
    for frame in range(200):
        body = pymunk.Body(1, 0.1)
        body.position = float(rng.uniform(-20, 20)), float(rng.uniform(0.4, 3))
        tile = pymunk.Segment(space.static_body, (frame % 40 - 20, 0), (frame % 40 - 19.5, 0.2), 0.1)
        alive.append((body, pymunk.Circle(body, 0.3), tile))
        space.add(*alive[-1])
        if len(alive) > 20:
            space.remove(*alive.pop(int(rng.integers(len(alive)))))
        space.step(DT)
        if frame > 100:
            tables = contact._store.tables
            sizes.add(
                (len(tables.shapes), len(tables.bodies), len(tables.pairs), len(contact._store.pool.heads))
            )
    assert len(sizes) == 1
    assert len(contact.regions) > 5 and all(-1 < body.position.y < 4 for body in space.bodies)


def test_a_copy_goes_on_to_the_bit() -> None:
    """From the middle of motion, on a level of tiles."""
    space, _ = level(100)
    steps(space, 20)
    twin = copy.deepcopy(space)
    for _ in range(30):
        space.step(DT)
        twin.step(DT)
    ours, theirs = ([(*b.position, b.angle, *b.velocity) for b in s.bodies] for s in (space, twin))
    assert ours == theirs


@pytest.mark.parametrize("radius", [0.0, 0.3])
def test_a_body_is_near_the_segments_it_can_reach(radius: float) -> None:
    """Of a terrain of 100 a disc is near two or three, thick or thin; above a thin one, not below what it stands on."""
    space = pymunk.Space()
    space.gravity = 0, -10
    for i in range(100):
        space.add(
            pymunk.Segment(space.static_body, (i - 50, 0.1 * (i % 2)), (i - 49, 0.1 * ((i + 1) % 2)), radius)
        )
    for y in (2, -6):
        body = pymunk.Body(1, 0.1)
        body.position = 0.2, y
        space.add(body, pymunk.Circle(body, 0.3))
    contact = ra.attach(space)
    steps(space, 1)
    assert contact._store.tables.counters[t.BOXED] == 0
    steps(space, 59)
    counters = contact._store.tables.counters
    assert 1 <= counters[t.BOXED] <= 3
    assert len(contact.regions) >= 1
