"""What once failed: three mechanisms, regions beyond four, forces of several pairs, settings that make no sense."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

from rigidarea.flexible import Body, Material, Simulation, elastic_body
from rigidarea.flexible.boundary import build
from rigidarea.flexible.linear_limits import LinearityWarning
from rigidarea.shapes import eccentric, flat_follower, internal_gear, involute_gear


def circle(radius, n=2000):
    t = 2 * np.pi * np.arange(n) / n
    return radius * np.column_stack([np.cos(t), np.sin(t)])


def slab(x=0.0, width=0.4):
    half = 0.5 * width
    corners = np.array([[-half, -0.025], [half, -0.025], [half, 0.025], [-half, 0.025]])
    return Body(build([corners]), 1.0, 1.0, (x, -0.025), fixed=True)


@pytest.mark.parametrize("level", ["compliant", "modal"])
@pytest.mark.parametrize("k", [3e6, 1e7, 1e8])
def test_soft_disc_on_a_slab(level, k):
    """A disc far softer than its contact (k/E = 10 and 100): the compliant level, without inertia of its own
    deformation, returns all of the speed."""
    soft = Material(1e6, 0.3, 1000.0, 0.01)
    disc, _ = elastic_body(
        [circle(0.05)],
        5e-3,
        soft,
        level,
        refine=4,
        modes=20,
        position=(0.0, 0.0501),
        velocity=(0.0, -0.1, 0.0),
    )
    sim = Simulation([disc, slab()], k=k, margin=2e-3, rho=0.8)
    r = sim.run(0.2, 2e-5)
    assert r.halved.sum() == 0
    assert r.force[-1, 1] == 0.0
    # the modal level keeps some as vibration
    assert r.v[-1, 0, 1] == pytest.approx(0.1, rel=2e-3 if level == "compliant" else 0.05)


@pytest.mark.parametrize("k", [6e8, 2e11])
def test_cam_and_follower(k):
    """The follower's angle is that of a flat on an eccentric disc, but for what the contact yields."""
    steel = Material(207e9, 0.29, 7800.0, 0.01)
    radius, off, height, reach, speed = 0.03, 0.008, 0.012, 0.06, 20.0
    cam, lever = (
        eccentric(radius, off, 0.006, tolerance=1e-6),
        flat_follower(0.12, height, 0.003, tolerance=1e-6),
    )
    pivot = (-reach, radius + 0.5 * height)
    a, _ = elastic_body(
        cam.rings, 2e-3, steel, "compliant", hub=1, refine=6, anchor=(0.0, 0.0), drive=(0.0, speed, 0.02)
    )
    b, _ = elastic_body(
        lever.rings, 2e-3, steel, "compliant", hub=1, anchor=pivot, position=pivot, torque=-2.0
    )
    r = Simulation([a, b], k=k, margin=5e-4, rho=0.8).run(0.2, 2e-5)
    late = r.t > 0.05
    turn, found = r.hub[late, 0], r.hub[late, 1]
    middle = off * np.column_stack([np.cos(turn), np.sin(turn)]) - pivot
    # the line of the face passes the pivot at half its height and touches the disc: its direction
    distance = np.hypot(*middle.T)
    exact = np.arctan2(middle[:, 1], middle[:, 0]) + np.arcsin((radius + 0.5 * height) / distance)
    # what it yields by: the depth of a lens A = L³/(12 R), and the lever's bending between pivot and contact
    force = np.hypot(*r.force[late].T).max()
    area = force / k
    depth = 1.5 * area / (12 * radius * area) ** (1 / 3)
    bending = force * reach**2 / (2 * steel.young * steel.thickness * height**3 / 12)
    assert np.abs(found - exact).max() < depth / reach + bending
    assert np.abs(found - exact).max() > 0.2 * bending


@pytest.mark.parametrize("backlash", [0.0, 4e-5])
def test_internal_gear_under_a_stiff_contact(backlash):
    steel = Material(207e9, 0.29, 7800.0, 0.02)
    pinion = involute_gear(2e-3, 20, bore=6e-3, tolerance=1e-6, rack_tip_radius=0.25, backlash=backlash)
    ring = internal_gear(2e-3, 60, tolerance=1e-6)
    at = (-0.04, 0.0)
    a, _ = elastic_body(
        pinion.rings, 1e-3, steel, hub=1, refine=4, anchor=(0.0, 0.0), drive=(0.0, 20.0, 0.01)
    )
    b, _ = elastic_body(
        ring.rings, 1e-3, steel, contact_rings=(1,), hub=0, refine=4, anchor=at, position=at, damper=0.5
    )
    r = Simulation([a, b], k=2e10, margin=3e-4, rho=0.8).run(0.05, 2e-5)
    ratio = r.hub_rate[r.t > 0.03, 1] / r.hub_rate[r.t > 0.03, 0]
    assert ratio.mean() == pytest.approx(1 / 3, rel=2e-3)
    assert r.halved.sum() == 0


def comb(feet=8):
    """A bar on feet, its underside at y = 0."""
    pitch, width = 0.02, 0.01
    points = []
    for i in range(feet):
        x = i * pitch
        points += [(x, 0.0), (x + width, 0.0), (x + width, 0.01), (x + pitch, 0.01)]
    points[-1] = (points[-2][0], 0.01)
    points.pop()
    points += [(points[-1][0], 0.03), (0.0, 0.03)]
    return np.array(points) - [points[-1][0] / 2 + 0.0, 0.0]


def test_every_region_is_recorded():
    """A comb of eight feet: eight regions, and their forces are all of it."""
    ring = comb() - [0.075, 0.0]
    body = Body(build([ring]), 1.0, 1e-3, (0.0, -1e-6))
    sim = Simulation([body, slab(width=0.6)], k=1e8, margin=1e-3)
    r = sim.run(1e-3, 1e-5)
    assert r.regions.shape[1] == 8 == (r.pair[0] == 0).sum()
    assert r.regions[0, :, 0].sum() == pytest.approx(np.hypot(*r.force[0]), rel=1e-9)
    assert np.ptp(np.sort(r.regions[0, :, 3])) == pytest.approx(7 * 0.02, rel=1e-6)


def test_forces_are_those_of_each_pair():
    """Two discs of different weight on two slabs: each pair has its own force; ``force`` belongs to one pair alone."""
    discs = [
        Body(build([circle(0.05, 200)]), mass, 1e-3, (x, 0.0499)) for mass, x in ((1.0, -1.0), (3.0, 1.0))
    ]
    bodies = [*discs, slab(-1.0), slab(1.0)]
    r = Simulation(bodies, [(0, 2), (1, 3)], k=1e5, gravity=(0.0, -10.0), rho=0.5).run(5.0, 1e-3, every=10)
    assert r.forces.shape == (500, 2, 2)
    assert r.forces[-100:, :, 1].mean(0) == pytest.approx(
        [-10.0, -30.0], rel=0.05
    )  # they still swing a little
    with pytest.raises(ValueError, match="force is that of the one pair: expected 1, got 2"):
        _ = r.force


def test_more_loads_than_there_is_room_for():
    """A face of some hundred nodes: the room for unknown loads grows, and the force is that of the weight."""
    soft = Material(1e7, 0.3, 1000.0, 0.01)
    corners = np.array([[0, 0], [0.3, 0], [0.3, 0.01], [0, 0.01]], float)
    block, _ = elastic_body([corners], 2e-3, soft, position=(-0.15, -1e-6))
    sim = Simulation([block, slab()], k=1e7, gravity=(0.0, -9.81), margin=1e-3, rho=0.6)
    r = sim.run(0.02, 1e-4)
    assert len(sim.scratch.load.force) > 128
    assert -r.force[:, 1].mean() == pytest.approx(block.mass * 9.81, rel=0.2)


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ({"mass": np.nan}, "body 0: mass must be positive and finite, got nan"),
        ({"inertia": -1.0}, "body 0: inertia must be positive"),
        ({"position": (0.0, np.inf)}, "body 0: position must be 2 finite numbers"),
        ({"velocity": (0.0, 0.0)}, "body 0: velocity must be 3 finite numbers"),
        ({"damping": -0.1}, "body 0: damping must be finite and not negative"),
        ({"torque": np.nan}, "body 0: torque must be a finite number"),
        ({"frequency": np.ones(2)}, "body 0: expected frequency of shape"),
    ],
)
def test_bodies_are_checked(keys, text):
    made = {"mass": 1.0, "inertia": 1.0} | keys
    with pytest.raises(ValueError, match=text):
        Simulation([Body(build([circle(0.1, 20)]), **made), slab()])


@pytest.mark.parametrize(
    ("pairs", "text"),
    [
        ([(0, 2)], r"pair 0 must name bodies 0 … 1, got \(0, 2\)"),
        ([(0, -1)], r"pair 0 must name bodies 0 … 1, got \(0, -1\)"),
        ([(1, 1)], "two different bodies"),
        ([(0, 1), (1, 0)], "must not repeat pair 0"),
        ([(0, 0.5)], r"whole numbers of shape \(p, 2\)"),
        ([0, 1], r"whole numbers of shape \(p, 2\)"),
    ],
)
def test_pairs_are_checked(pairs, text):
    with pytest.raises(ValueError, match=text):
        Simulation([Body(build([circle(0.1, 20)]), 1.0, 1.0), slab()], pairs)


def test_runs_and_sizes_are_checked():
    sim = Simulation([Body(build([circle(0.1, 20)]), 1.0, 1.0, (0.0, 1.0)), slab()])
    for every in (0, -1, 1.5):
        with pytest.raises(ValueError, match="every must be a whole number from 1 to 10"):
            sim.run(1.0, 0.1, every=every)
    for settings in ({"margin": -1.0}, {"q": np.nan}, {"gravity": (0.0, np.nan)}, {"k": np.inf}):
        with pytest.raises(ValueError):
            Simulation(sim.bodies, **settings)
    mat = Material(1e9, 0.3, 1000.0)
    for level, most in (("compliant", "8000 nodes in contact"), ("rigid", "40000 nodes on the boundary")):
        with pytest.raises(ValueError, match=f"size must be at least .* for {most}, got 1e-06"):
            elastic_body([circle(0.1)], 1e-6, mat, level)
    with pytest.raises(ValueError, match="size must be positive"):
        elastic_body([circle(0.1)], 0.0, mat)


def test_an_error_names_pair_and_stiffness():
    bar = np.array([[-2, -0.2], [2, -0.2], [2, 0.2], [-2, 0.2]])
    across = Body(build([bar]), 1.0, 1.0, (0.0, 2.3), angle=np.pi / 2, velocity=(0.0, -230.0, 0.0))
    sim = Simulation([Body(build([bar]), 1.0, 1.0), across], k=7.0)
    with pytest.raises(
        RuntimeError, match=r"pair \(0, 1\) under k = 7, E of its bodies rigid and rigid; try"
    ):
        sim.run(0.1, 0.01)


def test_where_linear_elements_end_it_says_so():
    """A rubber strip that bends by a tenth of its length; a ring that spins fast without its tension's stiffness."""
    rubber = Material(1e6, 0.4, 1000.0, 0.01)
    strip, _ = elastic_body([np.array([[0, 0], [0.1, 0], [0.1, 0.005], [0, 0.005]])], 2.5e-3, rubber)
    ball = Body(build([circle(0.005, 400)]), 0.02, 1e-6, (0.05, 0.01005), velocity=(0.0, -1.0, 0.0))
    with pytest.warns(LinearityWarning, match="body 0 deflected by"):
        Simulation([strip, ball], k=1e5, margin=1e-3).run(0.02, 1e-5)
    ring, _ = elastic_body([circle(0.05), 0.9 * circle(0.05)[::-1]], 4e-3, rubber, velocity=(0.0, 0.0, 20.0))
    far = Body(build([circle(0.05, 20)]), 1.0, 1.0, (1.0, 0.0), fixed=True)
    with warnings.catch_warnings():
        warnings.simplefilter("error", LinearityWarning)
        Simulation([ring, far]).run(1e-3, 1e-4)
    loose = ring.boundary._replace(
        soft=np.zeros((len(ring.boundary.soft), 0)), soft_stretch=np.zeros(0), tension=np.zeros((0, 0, 0))
    )
    with pytest.warns(LinearityWarning, match="body 0 spun at 20 rad/time"):
        Simulation([replace(ring, boundary=loose), far]).run(1e-3, 1e-4)
