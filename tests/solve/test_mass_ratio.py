"""Heavy on light: it holds, sinks little on the way and as promised in the end, and the forces are statics'."""

import itertools

import numpy as np
import pytest
from solve_world import ENGINE, World, area_only, displacement

G = 10.0
PENETRATION = 2e-4


def on_two(ratio, engine=ENGINE, apart=1.2, aside=0.1, iterations=None):
    """A box 4 x 1 of `ratio` kg, `aside` off the middle, on two boxes 1 x 1 of 1 kg at ± `apart`."""
    world = World(G, friction=0.5, engine=engine, iterations=iterations)
    world.floor()
    for sign in (-1, 1):
        world.box((sign * apart, 0.5))
    world.box((aside, 1.5), (4.0, 1.0), mass=ratio)
    return world


def column(ratio, lights=3, engine=ENGINE, iterations=None):
    """A box of `ratio` kg on `lights` of 1 kg, each 1e-3 m aside to and fro."""
    world = World(G, friction=0.5, engine=engine, iterations=iterations)
    world.floor()
    for i in range(lights + 1):
        world.box((1e-3 * (-1) ** i, 0.5 + i), mass=ratio if i == lights else 1.0)
    return world


def gaps(world, kind):
    """Depths (m) of the faces in each other, by the bodies' places."""
    y = [b.position.y for b in world.bodies]
    if kind == "on two":
        heavy = world.bodies[2]
        under = [
            heavy.position.y - 0.5 + heavy.angle * (b.position.x - heavy.position.x) for b in world.bodies[:2]
        ]
        return [0.5 - y[0], 0.5 - y[1], y[0] + 0.5 - under[0], y[1] + 0.5 - under[1]]
    return [0.5 - y[0], *(1.0 - (b - a) for a, b in itertools.pairwise(y))]


def allowed(kind, ratio):
    """Depth (m) promised of the lowest: `penetration` times the root of its load over a light one's weight, 20 at most.

    Of two light ones the one nearer to the middle bears 0.55 of the heavy one. (5 % over.)
    """
    load = 3.0 + ratio if kind == "column" else 1.0 + 0.55 * ratio
    return 1.05 * PENETRATION * min(20.0, load**0.5)


def sinking(kind, ratio, steps=None, seconds=6.0, engine=ENGINE, iterations=None):
    """(deepest on the way, at the end, furthest way of a body, fastest at the end): m and m/s; sides are 1 m."""
    world = {"on two": on_two, "column": column}[kind](ratio, engine=engine, iterations=iterations)
    start = world.state()
    on_the_way = 0.0
    for _ in range(round(seconds * 60)):
        world.step(steps)
        on_the_way = max(on_the_way, *gaps(world, kind))
        if not world.finite() or displacement(world, start) > 10:
            break
    return on_the_way, max(gaps(world, kind)), displacement(world, start), world.fastest()


@pytest.mark.shown
@pytest.mark.parametrize("steps", [2, 4, None])
@pytest.mark.parametrize("ratio", [400.0, 1000.0, 10000.0])
@pytest.mark.parametrize("kind", ["on two", "column"])
def test_heavy_on_light_holds(kind, ratio, steps, record_property):
    """Deepest 0.1 of the light one on the way; after 6 s as promised (`allowed`), at rest, in place.

    Seen: mass 1,000 a little off the middle squirts one away at 5,400 px/s.
    """
    way, end, moved, speed = sinking(kind, ratio, steps)
    record_property("heavy_on_the_way", way)
    record_property("heavy_at_rest", end)
    assert moved < 0.1
    assert way < 0.1
    assert speed < 1e-3
    if ENGINE == "area":
        assert end <= allowed(kind, ratio)


def supports(world):
    """(2,) force (N) of the heavy one on each light one."""
    heavy = world.bodies[2]
    found = np.zeros(2)
    for region in world.contact.regions:
        pair = (region["body_a"], region["body_b"])
        for i, light in enumerate(world.bodies[:2]):
            if heavy in pair and light in pair:
                found[i] += region["force"]
    return found


def statics(ratio, apart=1.2, aside=0.1, side=1.0):
    """A rigid body on two Winkler beds of one stiffness: M g d = 2 K L θ (a² + L²/12), F2 - F1 = 2 K L a θ.

    What stands between, the light boxes on theirs, halves force and couple alike.
    """
    share = aside * apart / (apart**2 + side**2 / 12)
    return ratio * G / 2 * np.array((1 - share, 1 + share))


@area_only
@pytest.mark.parametrize("steps", [2, None])
@pytest.mark.parametrize("ratio", [400.0, 1000.0, 10000.0])
def test_forces_on_two_are_statics(ratio, steps):
    """Within 5 % of the closed form after 6 s (friction between them at rest as it comes)."""
    world = on_two(ratio)
    world.run(6.0, steps)
    assert supports(world) == pytest.approx(statics(ratio), rel=0.05)


@area_only
@pytest.mark.slow
@pytest.mark.parametrize("ratio", [400.0, 1000.0, 10000.0])
def test_forces_are_those_of_a_converged_solve(ratio):
    """Within 5 % of 64 substeps of 100 sweeps, after 6 s."""
    fine, coarse = on_two(ratio, iterations=100), on_two(ratio)
    fine.run(6.0, 64)
    coarse.run(6.0)
    assert supports(coarse) == pytest.approx(supports(fine), rel=0.05)


@pytest.mark.parametrize("steps", [4, None])
def test_a_wall_of_crates_with_a_heavy_one(steps):
    """40 crates of 1 kg in a pyramid-like pile with one of 100 kg on top: all stay, at rest after 6 s."""
    world = World(G, friction=0.5)
    world.floor()
    for row, count in enumerate((12, 11, 9, 8)):
        for i in range(count):
            world.box((1.05 * (i - (count - 1) / 2), 0.5 + row))
    world.box((0.0, 4.5), mass=100.0)
    start = world.state()
    world.run(6.0, steps)
    assert displacement(world, start) < 0.1
    assert world.fastest() < (1e-3 if ENGINE == "area" else 0.1)
