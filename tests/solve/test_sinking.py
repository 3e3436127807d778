"""Stiffness keeps its promise: given, A = m g/k everywhere and at any step; chosen, no deeper than `penetration`."""

import math

import numpy as np
import pytest
from solve_world import World, area_only
from test_piles import pyramid, tower

pytestmark = area_only
G = 10.0


def depths(world):
    """(n,) area over chord of the regions, and (n,) the smaller of the smallest extents of their dynamic bodies."""
    regions = world.contact.regions
    extent = {}
    for body in world.bodies:
        shape = next(iter(body.shapes))
        points = np.array(shape.get_vertices()) if hasattr(shape, "get_vertices") else np.zeros((1, 2))
        sides = np.ptp(points, axis=0) + 2 * shape.radius
        extent[body] = float(sides.min())
    sizes = [min(extent.get(r["body_a"], math.inf), extent.get(r["body_b"], math.inf)) for r in regions]
    return regions["area"] / regions["chord"], np.array(sizes)


def deepest(world):
    """Deepest region in smallest extents."""
    depth, size = depths(world)
    return float((depth / size).max())


# --- chosen ---


@pytest.mark.parametrize("steps", [1, 4, None])
@pytest.mark.parametrize("penetration", [2e-4, 1e-3])
@pytest.mark.parametrize("size", [(0.1, 4.0), (4.0, 0.1), (1.0, 1.0)])
def test_a_plank_sinks_by_the_penetration_of_its_smallest_extent(size, penetration, steps):
    """On end and lying: 0.1 m × penetration (seen: 33 mm where 0.8 mm of its length was promised).

    On end it stands: the bed's couple m g s²/(12 δ) = 42 m g/m at δ = 2e-5 against half its height, 2 m g/m.
    """
    world = World(G, friction=0.5, penetration=penetration)
    world.floor()
    plank = world.box((0, size[1] / 2), size)
    world.run(3.0, steps)
    sunk = size[1] / 2 - plank.position.y
    assert 0 < sunk <= 1.02 * penetration * min(size)
    assert deepest(world) <= 1.02 * penetration
    assert abs(plank.angle) < 1e-4 and world.fastest() < 1e-4


@pytest.mark.parametrize("steps", [2, None])
def test_the_load_carried_counts(steps):
    """The lowest of ten carries ten weights, and sinks by the root of ten as deep; so with 100 on one of 1.

    A stiffness grows in steps of 1.2, and the last one may be past what is wanted.
    """
    column = tower(10)
    heavy = World(G, friction=0.5)
    heavy.floor()
    heavy.box((0, 0.5))
    heavy.box((0, 1.5), mass=100.0)
    for world, load in (column, 10.0), (heavy, 101.0):
        world.run(6.0, steps)
        assert 0.8 <= deepest(world) / (2e-4 * load**0.5) <= 1.05


@pytest.mark.parametrize("steps", [2, None])
def test_stiffness_changes_without_moving_energy(steps):
    """While k follows a load put on, no frame gains more than 1e-3 of the load's weight times a side."""
    world = tower(3)
    world.run(2.0, steps)
    world.box((0, 3.5), mass=50.0)
    world.step(steps)
    last = world.energy()
    for _ in range(300):
        world.step(steps)
        now = world.energy()
        assert now - last < 1e-3 * 50 * G * 1.0
        last = now


@pytest.mark.parametrize("steps", [4, None])
def test_a_bouncing_ball_keeps_its_energy_though_its_load_comes_and_goes(steps):
    """e = 1: the k chosen may change between bounces, the energy of flight by 1 % at most in 10 s."""
    world = World(G, elasticity=1.0)
    world.floor()
    ball = world.disc((0, 1.5))
    start = world.flight_energy(ball)
    world.run(10.0, steps)
    seen = []
    for _ in range(60):
        world.step(steps)
        if ball.position.y > 0.6:
            seen.append(world.flight_energy(ball) - 0.5 * G)
    assert seen == pytest.approx([start - 0.5 * G] * len(seen), rel=0.01)


@pytest.mark.parametrize("steps", [2, None])
def test_force_is_stiffness_times_area_at_rest(steps):
    """Of every region of a pyramid and a heavy crate on light ones, with its own stiffness: to 1e-3."""
    world = pyramid(6)
    for i in range(2):
        world.box((20 + 1.5 * i, 0.5))
    world.box((20.75, 1.5), (3.0, 1.0), mass=60.0)
    world.run(6.0, steps)
    regions = world.contact.regions
    assert len(regions) >= 6 + 2 * 15 + 4
    assert regions["force"] == pytest.approx(regions["stiffness"] * regions["area"], rel=1e-3)
    pressed = sum(
        r["force"] * abs(r["direction"][1])
        for r in regions
        if world.space.static_body in (r["body_a"], r["body_b"])
    )
    assert pressed == pytest.approx(sum(b.mass for b in world.bodies) * G, rel=1e-3)


def test_scales_alike():
    """Sizes of 1e-3 and 1e3, masses with the square: the same share of the smallest extent."""
    found = []
    for scale in (1e-3, 1.0, 1e3):
        world = World(G * scale, friction=0.5)
        world.floor(half=500 * scale)
        world.box((0, 0.5 * scale), (scale, scale), mass=scale**2)
        world.run(3.0)
        found.append(deepest(world))
    assert found == pytest.approx([found[1]] * 3, rel=1e-6)


# --- given ---


@pytest.mark.parametrize("steps", [1, 2, 4, 16, None])
@pytest.mark.parametrize("k", [1e3, 1e5, 1e9])
def test_area_at_rest_is_weight_over_stiffness(k, steps):
    """A = m g/k for a box and a disc, at any step; regions say k."""
    world = World(G, stiffness=k, friction=0.5)
    world.floor()
    world.box((0, 0.5), mass=2.0)
    world.disc((3, 0.5), mass=2.0)
    world.run(8.0, steps)
    assert world.fastest() < 1e-3
    regions = world.contact.regions
    assert len(regions) == 2 and set(regions["stiffness"]) == {k}
    assert k * regions["area"] == pytest.approx(2.0 * G, rel=1e-3)
    assert regions["force"] == pytest.approx(2.0 * G, rel=1e-3)


@pytest.mark.parametrize("steps", [1, None])
def test_a_box_in_a_smooth_groove(steps):
    """Flanks of 45°, a face flat on each: N = m g/(2 cos 45°), A = N/k."""
    world = World(G, stiffness=1e5)
    for corners in ([(-3, 3), (0, 0), (-3, -1)], [(3, 3), (3, -1), (0, 0)]):
        world.fixed(corners)
    world.box((0, math.sqrt(0.5)), mass=2.0, angle=math.pi / 4)
    world.run(8.0, steps)
    normal = 2.0 * G / math.sqrt(2)
    regions = world.contact.regions
    assert sorted(regions["force"]) == pytest.approx([normal, normal], rel=2e-3)
    assert sorted(regions["area"]) == pytest.approx([normal / 1e5] * 2, rel=2e-3)


def sinking_of_ten(steps, seconds=10.0):
    """Sinking (m) of the top of ten boxes of one k, δ₀ = 2e-4 m a weight: exact 55 δ₀ = 0.011."""
    world = tower(10, stiffness=G / 2e-4)
    world.run(seconds, steps)
    return 9.5 - world.bodies[-1].position.y


@pytest.mark.parametrize("steps", [1, 2, 4, None])
def test_ten_boxes_of_one_stiffness(steps):
    """Interface i carries (10 - i) weights: 55 δ₀ in all, whatever the steps (seen 0.45, 0.18, 0.035 at 1, 2, 4)."""
    assert sinking_of_ten(steps) == pytest.approx(0.011, rel=0.02)
