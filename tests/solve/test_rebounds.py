"""What must not bounce, and what must neither gain nor lose: boxes on boxes, elastic chains, elastic gases."""

import math

import numpy as np
import pytest
from solve_world import DT, ENGINE, World, area_only
from test_impacts import NEAR_ZERO


def dropped(upper, lower, steps, height=3.0):
    """A box of `upper` kg from `height` on one of `lower` kg at rest: (fastest upward over arrival speed, world)."""
    world = World(10.0, friction=0.5)
    world.floor()
    world.box((0, 0.5), mass=lower)
    world.run(1.0, steps)  # at rest on its bed
    world.box((0, 1.5 + height), mass=upper)
    fastest = 0.0
    for _ in range(180):
        world.step(steps)
        fastest = max(fastest, *(b.velocity.y for b in world.bodies))
    return fastest / math.sqrt(2 * 10.0 * height), world


@pytest.mark.parametrize("steps", [1, 2, 4, 16, None])
@pytest.mark.parametrize("upper, lower", [(1.0, 1.0), (100.0, 1.0), (1.0, 100.0)])
def test_a_box_dropped_on_a_box_stays(upper, lower, steps):
    """e = 0, from 3 m: nothing moves up faster than 0.01 of the speed of arrival, and both come to rest in place."""
    back, world = dropped(upper, lower, steps)
    assert back < NEAR_ZERO
    heights = [b.position.y for b in world.bodies]
    # sinking of 2e-4 m a weight carried, the chosen stiffness being at most some seconds late
    assert heights == pytest.approx([0.5, 1.5], abs=0.03)
    assert world.fastest() < 0.01


def chain(steps, seconds=3.0, engine=ENGINE):
    """Elastic discs of 1, 10 … 10,000 go for a wall, the lightest first: kinetic energy over that at the start.

    Its most in the last half second (contacts under way store some), and its most ever.
    """
    world = World(stiffness=1e6, elasticity=1.0, engine=engine)
    world.block(-2, -5, 0, 5)
    for i in range(5):
        world.disc((0.3 + 0.55 * i, 0.0), 0.25, mass=10.0**i, velocity=(-1, 0))
    start = world.kinetic()
    seen = []
    for _ in range(round(seconds / DT)):
        world.step(steps)
        seen.append(world.kinetic() / start)
        if not all(b.position.x > 0 for b in world.bodies):
            return -math.inf, math.inf
    return max(seen[-30:]), max(seen)


@pytest.mark.parametrize("steps", [1, 4, 64, None])
def test_an_elastic_chain_against_a_wall(steps):
    """Mass ratio 1e4, e = 1: energy never grows by 1 %, nobody goes through the wall; enough steps lose no 1 % either.

    (The lightest meets its neighbours dozens of times a frame: few steps cannot follow it, and may lose.)
    """
    last, most = chain(steps)
    assert most < 1.01
    if steps is None or steps >= 64:
        assert last > 0.99


def gas(steps, seconds, count=60, engine=ENGINE, seed=20):
    """Kinetic energy over its start of equal elastic discs in a box: its median over the last ten frames."""
    draw = np.random.default_rng(seed)
    world = World(stiffness=1e5, elasticity=1.0, engine=engine)
    columns, pitch = 8, 1.4
    side = columns * pitch
    for left, bottom, right, top in ((-2, -2, 0, side + 2), (side, -2, side + 2, side + 2)):
        world.block(left, bottom, right, top)
        world.block(bottom, left, top, right)
    for i in range(count):
        at = ((i % columns + 0.5) * pitch, (i // columns + 0.5) * pitch)
        world.disc(at, velocity=tuple(draw.normal(0.0, 2.0, 2)))
    start = world.kinetic()
    world.run(seconds - 10 * DT, steps)
    last = []
    for _ in range(10):
        world.step(steps)
        last.append(world.kinetic())
    assert all(0 < b.position.x < side and 0 < b.position.y < side for b in world.bodies)
    return float(np.median(last)) / start


@pytest.mark.parametrize("steps", [2, 4, None])
def test_a_wall_that_sends_a_disc_back_at_another_gives_nothing(steps):
    """e = 1: one bounces off the other, then off a wall while both overlap still, and off the other again."""
    world = World(stiffness=1e5, elasticity=1.0)
    world.block(11.2, -2, 13.2, 13.2)
    world.disc((10.67699665996267, 5.137357300279784), velocity=(2.1785076865533872, 0.9945662320245403))
    world.disc((9.671904711756119, 4.9193455629303), velocity=(3.589452241812492, 2.5096200150039722))
    start = world.kinetic()
    world.run(0.1, steps)
    assert world.kinetic() == pytest.approx(
        start, rel=2e-3
    )  # what contacts that steps follow keep is e within 0.002
    assert all(b.velocity.x < 0 for b in world.bodies)


@pytest.mark.shown
@pytest.mark.parametrize(
    "seconds, seed", [(5, 20), *(pytest.param(60, n, marks=pytest.mark.slow) for n in range(20, 26))]
)
@pytest.mark.parametrize("steps", [4, None])
def test_a_gas_of_elastic_discs_keeps_its_energy(steps, seconds, seed, record_property):
    """e = 1, no friction: 1 % of kinetic energy, some 3 of 60 discs being in touch (and out of it within 10 frames)."""
    kept = gas(steps, seconds, seed=seed)
    record_property("gas_energy", kept)
    record_property("least_gas_energy", kept)
    assert kept == pytest.approx(1.0, abs=0.01)


@area_only
@pytest.mark.parametrize("steps", [1, None])
def test_what_a_bounce_leaves_overlapped_stores_nothing(steps):
    """Four free discs in a row, pixels, e = 1, stiff beside the step: `energy()` is what they came with, every frame.

    (Blow follows upon blow within a frame, which ends with some up to half a step's way in each other: a thousand
    times that energy, were all of k A to come back.)
    """
    world = World(stiffness=1e7, elasticity=1.0)
    for i, speed in enumerate((600.0, 0.0, 0.0, -200.0)):
        world.disc((21.0 * i, 0.3 * i), 10.0, velocity=(speed, 0.0))
    start = world.kinetic()
    seen = []
    for _ in range(20):
        world.step(steps)
        seen.append(world.contact.energy() / start)
    assert (
        world.bodies[0].velocity.x < 100.0 and world.bodies[3].velocity.x > 300.0
    )  # it has gone through the row
    assert seen == pytest.approx([1.0] * 20, abs=0.01)  # e = 1 is kept to 1 %
