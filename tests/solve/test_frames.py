"""What a frame is: `space.step` and `contact.step` alike, frames at once, sweeps, tolerance, the explicit step."""

import math

import numpy as np
import pymunk
import pytest
from solve_world import DT, World, area_only
from test_mass_ratio import on_two, statics, supports
from test_symmetry import differ, heap

pytestmark = area_only
G = 10.0


def test_space_step_is_a_frame():
    """`space.step(dt)` and `contact.step(dt)`: the same bits, 2 s of a heap."""
    one, other = heap(), heap()
    for frame in range(120):
        one.space.step(DT)
        other.contact.step(DT)
        assert (one.state() == other.state()).all(), (frame, differ(one.state(), other.state()))


@pytest.mark.parametrize("steps", [1, 4, None])
def test_frames_at_once_are_frames_one_by_one(steps):
    """`frames=60`: the same bits."""
    one, other = heap(), heap()
    one.contact.step(DT, 60, steps)
    for _ in range(60):
        other.contact.step(DT, 1, steps)
    assert (one.state() == other.state()).all(), differ(one.state(), other.state())


def test_a_game_with_another_frame():
    """1/120 and 1/30 s frames through `space.step` end where 1/60 does: a box slides to rest, to 2e-3 of its way."""
    ends = []
    for dt in (1 / 120, 1 / 60, 1 / 30):
        world = World(G, friction=0.5)
        world.floor()
        body = world.box((0, 0.5), velocity=(3, 0))
        for _ in range(round(2.0 / dt)):
            world.space.step(dt)
        ends.append(body.position.x)
    exact = 9 / (2 * 0.5 * G)
    assert ends == pytest.approx([exact] * 3, abs=2e-3 * exact)


@pytest.mark.parametrize("steps", [1, 2, 8, 32, None])
def test_free_flight_is_exact(steps):
    """Position, velocity, angle after 1 s to rounding, at any steps."""
    world = World(G)
    body = world.box((0, 40), velocity=(3, 2), spin=0.5)
    world.run(1.0, steps)
    assert body.position == pytest.approx((3, 40 + 2 - G / 2), rel=1e-12)
    assert body.velocity == pytest.approx((3, 2 - G), rel=1e-12) and body.angle == pytest.approx(0.5)


@pytest.mark.parametrize("steps", [1, 4, None])
def test_who_turns_is_seen_to_come(steps):
    """A frame in which nobody can come near anybody takes no substeps; a tip far off its body's centre comes near.

    Within one turn it must meet a peg in its way, whatever its speed (100 arms, of 1 to 3 at 3 to 30 rad/s).
    """
    draw = np.random.default_rng(8)
    for _ in range(100):
        arm, spin, ahead = draw.uniform(1.0, 3.0), draw.uniform(3.0, 30.0), draw.uniform(0.7, 5.5)
        world = World(stiffness=1e6, elasticity=1.0)
        body = world.add(pymunk.Body(1.0, 1.0), spin=spin)
        tip = pymunk.Circle(body, 0.2, (arm, 0.0))
        peg = pymunk.Circle(world.space.static_body, 0.2, (arm * math.cos(ahead), arm * math.sin(ahead)))
        tip.elasticity = peg.elasticity = 1.0
        world.space.add(tip, peg)
        while body.angle < 2 * math.pi and body.angular_velocity == spin:
            world.step(steps)
        assert body.angular_velocity < spin, (arm, spin, ahead)


def test_sweeps_are_the_spaces_iterations():
    """Forces under a heavy crate after 1 s, off statics: to 5 % at any number of sweeps, by 60 to 1 %."""
    off = []
    for sweeps in (2, 10, 60):
        world = on_two(400.0, iterations=sweeps)
        world.run(1.0, 2)
        off.append(float(np.abs(supports(world) / statics(400.0) - 1).max()))
    assert max(off) < 0.05 and off[2] < 0.01


def rolling_end(steps=None, tolerance=None):
    """A disc that slips, then rolls down a slope into a bumpy floor: its place after 1.5 s."""
    world = World(G, stiffness=1e5, friction=0.4, elasticity=0.5)
    world.fixed([(-6, 0), (2, 0), (-6, 3)])
    world.floor()
    world.disc((-4.0, 3.0), 0.4, velocity=(2.0, 0.0))
    world.box((5.0, 0.6), angle=0.3, mass=2.0)
    for _ in range(90):
        world.contact.step(DT, 1, steps) if tolerance is None else world.contact.step(DT, tolerance=tolerance)
    return world.state()[:, :2]


def test_a_tolerance_buys_accuracy():
    """Beside 256 steps a frame: 1e-2, 1e-3, 1e-4 err less and less, the last a tenth of the first at most, or 1e-5."""
    exact = rolling_end(steps=256)
    errors = [float(np.abs(rolling_end(tolerance=t) - exact).max()) for t in (1e-2, 1e-3, 1e-4)]
    assert errors[1] <= 1.5 * errors[0] + 1e-5 and errors[2] <= 1.5 * errors[1] + 1e-5
    assert errors[2] < max(0.1 * errors[0], 1e-5)


@pytest.mark.parametrize("tolerance", [0.0, -1e-3, math.nan, math.inf, "fine"])
def test_bad_tolerances(tolerance):
    world = World(G)
    world.floor()
    world.box((0, 0.5))
    before = world.state()
    with pytest.raises(ValueError, match="tolerance"):
        world.contact.step(DT, tolerance=tolerance)
    assert (world.state() == before).all()


def test_steps_and_tolerance_exclude_each_other():
    world = World(G)
    world.floor()
    world.box((0, 0.5))
    with pytest.raises(ValueError, match=r"steps|tolerance"):
        world.contact.step(DT, steps=2, tolerance=1e-3)


def test_the_explicit_step_is_symplectic_euler():
    """One `space.step(h)`: y += h v, then v += h (k L depth/m - g), depth where the body now is; e = 1, no damping.

    A flat box that cannot turn, started half a sinking too deep: one degree of freedom, to rounding, two periods.
    """
    k, h = 1e4, 1e-3
    world = World(G, stiffness=k, elasticity=1.0, integration="explicit")
    world.floor()
    body = world.box((0, 0.5 - 1.5 * G / k))
    body.moment = math.inf
    y, v = body.position.y, 0.0
    for _ in range(120):
        world.space.step(h)
        y += h * v
        v += h * (k * max(0.5 - y, 0.0) - G)
        assert (body.position.y, body.velocity.y) == pytest.approx((y, v), abs=1e-10)
