"""Sleeping by `space.sleep_time_threshold`, as with pymunk's own response."""

import pymunk
import pytest
from solve_world import DT, World
from test_piles import pyramid, tower

STEPS = [1, 4, None]


def asleep(world):
    return sum(b.is_sleeping for b in world.bodies)


def put_to_sleep(world, steps, threshold=0.5, within=6.0):
    """Step until all sleep; frames it took."""
    world.space.sleep_time_threshold = threshold
    for i in range(round(within / DT)):
        world.step(steps)
        if asleep(world) == len(world.bodies):
            return i + 1
    raise AssertionError(f"{asleep(world)} of {len(world.bodies)} asleep after {within} s")


@pytest.mark.parametrize("steps", STEPS)
@pytest.mark.parametrize("make", [lambda: tower(5), lambda: pyramid(8)], ids=["tower", "pyramid"])
def test_a_pile_falls_asleep_as_one_and_stays(make, steps):
    """All in the same frame (an island); asleep nothing moves, to the bit, for 5 s."""
    world = make()
    world.space.sleep_time_threshold = 0.5
    counts = []
    for _ in range(480):
        world.step(steps)
        counts.append(asleep(world))
    assert counts[-1] == len(world.bodies)
    if len(world.bodies) == 5:
        assert set(counts) == {0, 5}
    before = world.state()
    world.run(5.0, steps)
    assert (world.state() == before).all() and asleep(world) == len(world.bodies)


@pytest.mark.parametrize("steps", STEPS)
def test_what_wakes_a_pile(steps):
    """A hit, a force, an impulse, a support removed, `activate`: as pymunk's islands do, the whole pile at once."""

    def hit(world):
        world.box((0, 5.3), (0.3, 0.3), velocity=(0, -3))
        world.step(steps, 10)

    def push(world):
        world.bodies[1].force = 1, 0  # pymunk's setters wake
        world.step(steps)

    def impulse(world):
        world.bodies[4].apply_impulse_at_local_point((0.1, 0))
        world.step(steps)

    def support(world):
        lowest = world.bodies.pop(0)
        world.space.remove(lowest, *lowest.shapes)
        world.step(steps)

    def activate(world):
        world.bodies[3].activate()
        world.step(steps)

    for wake in (hit, push, impulse, support, activate):
        world = tower(5)
        put_to_sleep(world, steps)
        wake(world)
        assert not any(b.is_sleeping for b in world.bodies), wake.__name__
    world.run(1.0, steps)


@pytest.mark.parametrize("steps", STEPS)
def test_a_removed_support_lets_the_pile_fall(steps):
    world = tower(5)
    put_to_sleep(world, steps)
    lowest = world.bodies.pop(0)
    world.space.remove(lowest, *lowest.shapes)
    world.run(3.0, steps)
    assert [b.position.y for b in world.bodies] == pytest.approx([0.5, 1.5, 2.5, 3.5], abs=0.02)


@pytest.mark.parametrize("steps", STEPS)
def test_waking_is_no_jolt(steps):
    """Woken, everything is where it was, at rest: 1e-3 of a side, 1e-2 m/s (a frame of g is 0.17)."""
    world = pyramid(6)
    put_to_sleep(world, steps)
    before = world.state()
    for b in world.bodies:
        b.activate()
    worst = 0.0
    for _ in range(30):
        world.step(steps)
        worst = max(worst, world.fastest())
    assert worst < 1e-2
    assert abs(world.state()[:, :2] - before[:, :2]).max() < 1e-3


@pytest.mark.parametrize("steps", STEPS)
def test_a_block_asleep_on_a_slope_stays_when_woken(steps):
    """Friction remembers through sleep: woken ten times it has not crept."""
    world = World((10.0 * 0.3, -9.5), friction=0.5)
    world.floor()
    body = world.box((0, 0.5))
    world.run(1.0, steps)
    start = body.position
    for _ in range(10):
        put_to_sleep(world, steps)
        body.activate()
        world.step(steps, 5)
    assert (body.position - start).length < 1e-3


@pytest.mark.parametrize("steps", STEPS)
def test_what_moves_does_not_sleep_nor_what_rides_on_it(steps):
    """A box on a kinematic platform that moves stays awake; so does one that slides."""
    world = World(10.0, friction=0.5)
    world.space.sleep_time_threshold = 0.3
    world.box((0, 0), (4, 0.5), kind=pymunk.Body.KINEMATIC, velocity=(0.5, 0))
    rider = world.box((0, 0.75))
    world.run(3.0, steps)
    assert not rider.is_sleeping
    assert rider.position.x == pytest.approx(1.5, abs=0.1)


@pytest.mark.parametrize("steps", STEPS)
def test_space_step_and_frames_fall_asleep_alike(steps):
    """The threshold is time, not steps."""
    world = tower(3)
    assert put_to_sleep(world, steps, threshold=0.5, within=3.0) >= round(0.5 / DT)
