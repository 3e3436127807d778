"""What discs do that polygons of many points did not: roll off each other, keep their energy, stay in a pit."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pymunk
import pytest
from solve_world import G, World, area_only, inside

import rigidarea as ra

R, r, START = 1.0, 0.25, 0.3


def landing(friction: float, **settings: Any) -> float:
    """How far from where it should a disc comes down that was let go near the top of a fixed one (over its radius).

    It leaves where m v^2/rho = m g cos(theta): cos(theta) is 2/3 of its start's without friction, 4/7 rolling
    (3/4 m v^2 = m g rho (cos(start) - cos(theta))). Compared at the height of the fixed one's centre.
    """
    rho = R + r
    world = World(G, friction=friction, **settings)
    world.disc((0, 0), R, kind=pymunk.Body.STATIC)
    body = world.disc((rho * math.sin(START), rho * math.cos(START)), r)

    def down(x: float, y: float, vx: float, vy: float) -> float:
        return x + vx * (vy + math.sqrt(vy * vy + 2 * G * y)) / G

    cosine = (4 / 7 if friction else 2 / 3) * math.cos(START)
    sine, speed = math.sqrt(1 - cosine**2), math.sqrt(G * rho * cosine)
    want = down(rho * sine, rho * cosine, speed * cosine, -speed * sine)
    last = 0.0
    for _ in range(200):
        last = down(*body.position, *body.velocity)  # flight is exact: any frame of it will do
        world.step()
        if body.position.y < 0:
            return (last - want) / r
    raise AssertionError("it stays where it is")


@area_only
@pytest.mark.shown
@pytest.mark.parametrize("penetration", [1e-3, 2e-4, 1e-5, 1e-6])
@pytest.mark.parametrize("friction", [0.0, 1000.0])  # the latter rolls to the last
def test_a_disc_comes_off_a_disc_where_it_should(
    friction: float, penetration: float, record_property: Any
) -> None:
    off = abs(landing(friction, penetration=penetration))
    record_property("landing", off)
    assert off <= 0.005


@area_only
@pytest.mark.parametrize("points", [5, 9, 33])
def test_collinear_points_change_no_course(points: int) -> None:
    """A box thrown on a floor: dropped on a corner, tipped, slid, for two seconds."""

    def course(points: int) -> np.ndarray:
        world = World(G, friction=0.5, elasticity=0.3)
        world.floor()
        corners = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
        ring = []
        for i in range(4):
            extra = (points - 4) // 4 + (i < (points - 4) % 4)
            share = np.arange(extra + 1)[:, None] / (extra + 1)
            ring.append(corners[i] + share * (corners[(i + 1) % 4] - corners[i]))
        body = pymunk.Body(1.0, 1 / 6)
        shape = ra.Outline(np.concatenate(ring)).add_to(body)
        world.add(body, shape, at=(0, 1.2), angle=0.3, velocity=(1, 0))
        out = []
        for _ in range(120):
            world.step()
            out.append(world.state()[0])
        return np.array(out)

    assert np.abs(course(points) - course(4)).max() <= 1e-9


def sixty(seconds: int) -> tuple[list[float], bool]:
    """(energy over the first at each second, whether all are inside) of 60 elastic discs in a box."""
    rng = np.random.default_rng(0)
    world, size = World(elasticity=1.0), 10.0
    for box in (
        (-1, -1, size + 1, 0),
        (-1, size, size + 1, size + 1),
        (-1, 0, 0, size),
        (size, 0, size + 1, size),
    ):
        world.block(*box)
    for k in range(60):
        place = (0.9 + 1.15 * (k // 8), 0.9 + 1.15 * (k % 8))
        world.disc(place, 0.3 + 0.1 * rng.random(), velocity=tuple(rng.uniform(-3, 3, 2)))
    start = world.kinetic()
    energy = []
    for _ in range(seconds):
        world.run(1.0)
        energy.append(world.kinetic() / start)
    return energy, all(0 < b.position.x < size and 0 < b.position.y < size for b in world.bodies)


@pytest.mark.slow
def test_sixty_elastic_discs_keep_their_energy_for_a_minute() -> None:
    energy, contained = sixty(60)
    assert contained
    assert max(abs(e - 1) for e in energy) < 0.01


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["discs", "rounded boxes", "mixed"])
def test_a_pit_keeps_everyone_inside(kind: str) -> None:
    rng = np.random.default_rng(3)
    world, count, width = World(G, friction=0.4), 100, 11.0
    for box in ((-1.0, -1.0, width + 1, 0.0), (-1.0, 0.0, 0.0, 55.0), (width, 0.0, width + 1, 55.0)):
        world.block(*box)
    for k in range(count):
        at = (0.55 + (k % 11) * 0.99 + rng.uniform(-0.03, 0.03), 0.6 + 1.05 * (k // 11))
        if kind == "discs" or (kind == "mixed" and k % 2):
            world.disc(at, 0.3 + 0.2 * rng.random())
        else:
            body = pymunk.Body(1.0, 1 / 6)
            world.add(body, pymunk.Poly.create_box(body, (0.7, 0.7), 0.1), at=at)
    world.run(10.0)
    assert inside(world.bodies, 0.0, width, 0.0)
    assert world.fastest() < 0.1
