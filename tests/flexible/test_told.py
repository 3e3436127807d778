"""What was done in silence: it is right now, or an error that says what to write instead."""

import warnings

import numpy as np
import pytest

from rigidarea.flexible import Material, Mechanism, elastic_body
from rigidarea.flexible.linear_limits import MeshWarning
from rigidarea.geometry.outline import Outline
from rigidarea.shapes import box

NYLON = Material(2e8, 0.3, 1100.0, 0.02)
STEEL = Material(207e9, 0.29, 7800.0, 0.01)
LENGTH, HEIGHT, G = 0.2, 0.01, 9.81


def circle(radius, at=(0.0, 0.0), clockwise=False):
    t = (-1 if clockwise else 1) * 2 * np.pi * np.arange(64) / 64
    return radius * np.column_stack([np.cos(t), np.sin(t)]) + at


def lever():
    return Outline(2 * box(0.05, 0.01).rings[0], [circle(0.004, clockwise=True)])


@pytest.mark.parametrize("level", ["compliant", "modal"])
def test_a_clamped_body_sags_under_its_weight(level):
    """A cantilever: ρ g A L⁴ / (8 E I), and Timoshenko's shear; turned on end it is pressed together, by ρ g L²/2E."""
    for angle, exact in (
        (0.0, NYLON.density * G * LENGTH**2 / NYLON.young * (1.5 * LENGTH**2 / HEIGHT**2 + 0.6 * 2.6)),
        (np.pi / 2, NYLON.density * G * LENGTH**2 / (2 * NYLON.young)),
    ):
        m = Mechanism(1e6, gravity=(0.0, -G))
        beam = Outline(box(LENGTH, HEIGHT).rings[0] + [LENGTH / 2, 0.0])
        b = m.body(beam, NYLON, mesh=2.5e-3, level=level, angle=angle, clamp=lambda p: p[:, 0] < 1e-9)
        r = m.run(2e-3, 1e-4, shapes=True)
        state = m.state(r, -1, b)
        points = state.shape.mesh.points
        tip = np.flatnonzero(np.abs(points[:, 0] - LENGTH) < 1e-9)
        moved = state.placed()[tip].mean(0) - LENGTH * np.array([np.cos(angle), np.sin(angle)])
        assert moved[1] == pytest.approx(-exact, rel=0.02)
        # and the contact's boundary is there
        assert m.simulation.boundaries[b].points.shape == m._bodies[b].boundary.points.shape
        root = np.abs(state.stress[points[state.shape.mesh.triangles].mean(1)[:, 0] < 0.01, 0]).max()
        bending = 3 * NYLON.density * G * LENGTH**2 / HEIGHT
        if angle == 0.0:  # 6 M / (t h²), at the middle of triangles
            assert 0.7 * bending < root < 1.3 * bending


def test_a_ball_lies_on_a_beam_that_sags():
    """The boundary that others touch has sagged: a ball a sag below the straight beam does not touch it yet."""
    for below, touches in ((0.5, False), (1.5, True)):
        m = Mechanism(1e6, gravity=(0.0, -G))
        beam = Outline(box(LENGTH, HEIGHT).rings[0] + [LENGTH / 2, 0.0])
        b = m.body(beam, NYLON, mesh=2.5e-3, clamp=lambda p: p[:, 0] < 1e-9)
        sag = 1.5 * NYLON.density * G * LENGTH**4 / (NYLON.young * HEIGHT**2)
        low = m.ground(box(0.02, 0.02), at=(LENGTH - 0.01, -HEIGHT / 2 - 0.01 - below * sag))
        m.contact(low, b)
        force = np.abs(m.run(1e-3, 1e-4).forces).max()
        assert (force > 0.0) != touches


@pytest.mark.parametrize(
    ("clamp", "told"),
    [
        (lambda p: np.arange(len(p)) == 0, "hold 2 boundary nodes at least, .* got 1 of"),
        (
            lambda p: p[:, 0] > 9.0,
            r"hold 2 boundary nodes at least, .* got 0 of \d+; their x are -0.05 … 0.05",
        ),
        (lambda p: p[:, 0] < 9.0, "must leave some of what touches others free"),
        (lambda p: p[:, 0], "must return True or False for each of .* float64"),
        (lambda p: np.array([0, 1, 2]), "must return True or False for each of .* int64"),
        (lambda p: np.array([True]), r"for each of \d+ boundary nodes, got an array of bool of shape \(1,\)"),
        (0, "a function of the boundary nodes holds a part of it"),
    ],
)
def test_clamps(clamp, told):
    with pytest.raises(ValueError, match=told):
        Mechanism(1e8).body(box(0.1, 0.02), STEEL, mesh=0.01, clamp=clamp)


def test_pivots_drives_and_steps():
    m = Mechanism(1e8)
    b = m.body(lever(), STEEL, mesh=4e-3, hub=1)
    m.pivot(b, (1.0, 0.0))
    with pytest.raises(
        ValueError, match=r"its pivot must be where its hub is, \(.*\), within .*, got \(1, 0\)"
    ):
        m.run(1e-3, 1e-4)
    m = Mechanism(1e8)
    b = m.body(lever(), STEEL, mesh=4e-3, hub=1)
    m.drive(b, 10.0)
    with pytest.raises(ValueError, match="body 0 has a drive, but nothing holds it"):
        m.run(1e-3, 1e-4)
    m.pivot(b, (0.0, 0.0))
    with pytest.raises(ValueError, match=r"h must be at most the duration, 0\.001, got 0\.01"):
        m.run(1e-3, 1e-2)
    assert len(m.run(1e-3, 1e-3).t) == 1
    m._bodies[b].velocity = (1.0, 0.0, 10.0)
    with pytest.raises(ValueError, match="its velocity must leave its pivot at rest"):
        m.run(1e-3, 1e-4)


@pytest.mark.parametrize(
    ("one", "two"),
    [
        ((box(0.1, 0.1), (0.0, 0.0)), (box(0.02, 0.02), (0.01, 0.0))),  # wholly inside
        ((box(0.1, 0.1), (0.0, 0.0)), (box(0.1, 0.1), (0.03, 0.0))),
        ((Outline(circle(0.05)), (0.0, 0.0)), (Outline(circle(0.05)), (0.02, 0.0))),
    ],
)
def test_a_start_deep_inside(one, two):
    m = Mechanism(1e8)
    for outline, at in (one, two):
        m.body(outline, STEEL, level="rigid", at=at)
    m.contact(0, 1)
    with pytest.raises(ValueError, match="bodies 0 and 1 overlap at t = 0: expected a depth of at most"):
        m.run(1e-3, 1e-5)


def test_a_start_that_is_none():
    """A pin in its journal, and a box a little in the floor, are no bodies inside each other."""
    m = Mechanism(1e8)
    ring = m.body(Outline(circle(0.05), [circle(0.0201, clockwise=True)]), STEEL, level="rigid", contact=(1,))
    pin = m.body(Outline(circle(0.02)), STEEL, level="rigid")
    floor = m.ground(box(1.0, 0.1), at=(1.0, 0.0))
    block = m.body(box(0.1, 0.1), STEEL, level="rigid", at=(1.0, 0.0999))
    m.contact(ring, pin), m.contact(floor, block)
    assert m.run(1e-5, 1e-5).forces[-1, 0, 1] == 0.0


def test_a_mesh_size_for_each_ring():
    """A fine bore does not ask for a fine bar; the reduction is that of the coarse bar nearly."""
    bar = np.array(box(1.0, 0.1).rings[0])
    bore = circle(0.003, (0.45, 0.0), clockwise=True)
    _body, mesh = elastic_body([bar, bore], (0.02, 1e-3), STEEL, hub=1)
    fine = [
        np.linalg.norm(np.roll(mesh.points[r], -1, 0) - mesh.points[r], axis=1).mean() for r in mesh.rings[:2]
    ]
    assert fine == pytest.approx([0.01, 0.5e-3], rel=0.1)  # two triangles' sides between loaded nodes
    assert len(mesh.points) < 8000
    with pytest.raises(ValueError, match="size must be one for all rings or one each, 2, got 3"):
        elastic_body([bar, bore], (0.02, 1e-3, 1e-3), STEEL)
    with pytest.raises(ValueError, match=r"size\[1\] must be positive"):
        elastic_body([bar, bore], (0.02, 0.0), STEEL)
    m = Mechanism(1e8)
    m.body(Outline(bar, [bore]), STEEL, mesh=(0.02, 1e-3), hub=1, growth=0.3, sides=1)
    assert len(m._bodies[0].shape.mesh.points) < len(mesh.points)


def test_what_a_clamped_body_cannot_do():
    """Nothing of it moves but its modes: a torque, a damper or a velocity would be dropped."""
    for keys, given in (({"velocity": (3.0, 0.0, 0.0)}, {}), ({}, {"torque": 5.0}), ({}, {"damper": 2.0})):
        m = Mechanism(1e8)
        b = m.body(box(0.1, 0.02), STEEL, mesh=0.01, clamp=lambda p: p[:, 0] < -0.04, **keys)
        m.load(b, **given)
        with pytest.raises(ValueError, match="body 0 is fixed: expected no anchor, drive, torque, damper"):
            m.run(1e-3, 1e-4)


def test_states_and_rows_that_there_are_not():
    m = Mechanism(1e8)
    b = m.body(box(0.1, 0.02), STEEL, mesh=0.01)
    record = m.run(1e-3, 1e-4, shapes=True)
    assert m.state(record, -1, b).frame == pytest.approx(record.x[-1, 0])
    with pytest.raises(ValueError, match="row must be a whole number from -10 to 9, got 99"):
        m.state(record, 99, b)
    with pytest.raises(ValueError, match="body must be a whole number from 0 to 0, got -1"):
        m.state(record, -1, -1)
    with pytest.raises(ValueError, match="every must be a whole number from 1 to 10, got 100"):
        m.run(1e-3, 1e-4, every=100)
    with pytest.raises(ValueError, match="contact must name 1 ring at least"):
        m.body(box(0.1, 0.02), STEEL, mesh=0.01, contact=())


def test_a_mesh_of_one_triangle_across():
    """A beam's first bending frequency, over that of Timoshenko's beam: it is told of where it is far off."""
    bar = box(1.0, 0.1)
    exact = 0.966 * 4.73004**2 * np.sqrt(STEEL.young * 0.1**2 / 12 / STEEL.density)
    with pytest.warns(MeshWarning, match="one triangle across the body, .* mesh size of at most about 0.045"):
        body, _ = elastic_body(bar.polygon_rings, 0.1, STEEL, "modal", modes=4)
    assert body.frequency[0] > 1.2 * exact
    with warnings.catch_warnings():
        warnings.simplefilter("error", MeshWarning)
        body, _ = elastic_body(bar.polygon_rings, 0.045, STEEL, "modal", modes=4)
    assert body.frequency[0] == pytest.approx(exact, rel=0.02)
