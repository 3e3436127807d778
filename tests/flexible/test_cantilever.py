"""A clamped cantilever: beam theory, free vibration, and a ball that hits it, against full finite elements in time."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from rigidarea.flexible.body import elastic_body
from rigidarea.flexible.boundary import build
from rigidarea.flexible.element import Material, lumped_mass, stiffness
from rigidarea.flexible.integrate import Body, Simulation
from rigidarea.study.convergence import bar, beam_body, cantilever_mesh, timoshenko_cantilever

LENGTH, HEIGHT, MAT = 0.2, 0.02, Material(2e9, 0.3, 1000.0, 1.0)
RADIUS, MASS, SPEED, K = (
    0.01,
    1.0,
    1.0,
    1e10,
)  # of the ball; k: contacts as long as two thirds of a finite element
GAP = 1e-5


@pytest.fixture(scope="module")
def mesh():
    return bar(LENGTH, HEIGHT, 4)


def struck(mesh):
    """The edge (two nodes, left and right) that the ball hits from above: the last but one before the tip."""
    points = mesh.points[: mesh.n_boundary]
    top = np.flatnonzero(points[:, 1] > HEIGHT * (1 - 1e-9))
    order = top[np.argsort(points[top, 0])]
    return order[-3], order[-2]


def ball(mesh, velocity=-SPEED, above=GAP):
    t = 2 * np.pi * np.arange(20000) / 20000
    circle = RADIUS * np.column_stack([np.cos(t), np.sin(t)])
    x = mesh.points[list(struck(mesh)), 0].mean()
    return Body(
        build([circle]),
        MASS,
        0.5 * MASS * RADIUS**2,
        (x, HEIGHT + RADIUS + above),
        velocity=(0.0, velocity, 0.0),
    )


def segment(depth):
    """Area of a disc's segment of this depth."""
    d = np.clip(depth, 0.0, RADIUS)
    return RADIUS**2 * np.arccos(1 - d / RADIUS) - (RADIUS - d) * np.sqrt(2 * RADIUS * d - d * d)


def compliance(mesh, body):
    """Of the struck edge's middle, downwards."""
    c = body.boundary.flexibility + (body.boundary.modes / body.frequency**2) @ body.boundary.modes.T
    load = np.zeros(len(c))
    load[2 * np.array(struck(mesh)) + 1] = 0.5
    return float(load @ c @ load)


def explicit(mesh, duration, h):
    """The impact by central differences on all nodes: times, forces on the ball, its velocity; no modes, no frame."""
    k, m2 = stiffness(mesh, MAT).tocsr(), np.repeat(lumped_mass(mesh, MAT), 2)
    free = np.ones(len(m2))
    free[np.concatenate([2 * mesh.rings[1], 2 * mesh.rings[1] + 1])] = 0.0
    i, j = struck(mesh)
    u, v = np.zeros(len(m2)), np.zeros(len(m2))
    at, speed = np.array(ball(mesh).position), np.array([0.0, -SPEED])
    force = np.zeros(2)
    t, forces = np.arange(1, round(duration / h) + 1) * h, []
    for _ in t:
        a, b = mesh.points[i] + u[2 * i : 2 * i + 2], mesh.points[j] + u[2 * j : 2 * j + 2]
        along = (b - a) / np.hypot(*(b - a))
        normal = np.array([-along[1], along[0]])
        force = K * segment(RADIUS - (at - a) @ normal) * normal
        share = (at - a) @ along / np.hypot(*(b - a))
        load = -(k @ u)
        load[2 * i : 2 * i + 2] -= (1 - share) * force
        load[2 * j : 2 * j + 2] -= share * force
        v += h * free * load / m2
        u += h * v
        speed = speed + h * force / MASS
        at = at + h * speed
        forces.append(force)
    return t, np.array(forces), speed


def test_static_and_frequencies_against_timoshenko():
    """Tip deflection and three frequencies of a 20 : 1 bar: second order in the mesh size, to the beam's values.

    Euler and Bernoulli's values are 0.2, 1.4 and 3.2 % higher there; at a slenderness of 1000 the reference is theirs.
    """
    beam = np.array([1.8751041, 4.6940911, 7.8547574]) ** 2 * np.sqrt(1e-6 / 12)
    assert timoshenko_cantilever(1.0, 1e-3, 1.0, 0.3, 1.0) == pytest.approx(beam, rel=2e-5)
    for study in cantilever_mesh((3, 6, 12)):
        assert 1.6 < study.order < 2.6, (
            study
        )  # the clamped corners' share falls more slowly, with the other sign
        assert study.error[-1] < 0.005


def test_free_vibration_has_the_modes_frequency(mesh):
    """A clamped body's modes move: ten periods of the first, in phase and with its energy at ρ∞ = 1."""
    body = beam_body(mesh, MAT, 3)
    omega = body.frequency[0]
    # 4 elements over the height (``cantilever_mesh``)
    exact = timoshenko_cantilever(LENGTH, HEIGHT, MAT.young, MAT.poisson, MAT.density)[0]
    assert 0.99 < omega / exact < 1.02
    sim = Simulation([body, ball(mesh)], [], rho=1.0)
    sim.state.q[0], sim.state.ddq[0], sim.state.auxq[0] = 1e-3, -(omega**2) * 1e-3, -(omega**2) * 1e-3
    n = 400
    r = sim.run(10 * 2 * np.pi / omega, 2 * np.pi / omega / n)
    phase = np.angle(r.q[0] - 1j * r.dq[0] / omega)
    # the trapezoidal rule's period is long by (ω h)²/12
    assert phase == pytest.approx(-20 * np.pi * (2 * np.pi / n) ** 2 / 12, rel=1e-2)
    energy = r.kinetic - 0.5 * MASS * SPEED**2 + r.elastic  # the ball flies by
    assert np.abs(energy / energy[0] - 1).max() < 1e-9
    assert np.abs(r.x[:, 0] - r.x[0, 0]).max() == 0.0  # the frame is held


@pytest.mark.parametrize("modes", [0, 20])
def test_ball_lies_on_the_beam(mesh, modes):
    """Laid where weight, contact and bent beam are in balance, it stays. The beam gives five times what the contact
    does."""
    body = beam_body(mesh, MAT, modes)
    g, c = 9.81, compliance(mesh, body)
    depth = brentq(lambda d: K * segment(d) - MASS * g, 0.0, RADIUS)
    assert c * MASS * g > 5 * depth
    sim = Simulation(
        [ball(mesh, 0.0, -depth - c * MASS * g), body], k=K, gravity=(0.0, -g), margin=1e-3, rho=0.8
    )
    if modes:
        load = np.zeros(len(body.boundary.modes))
        load[2 * np.array(struck(mesh)) + 1] = -0.5 * MASS * g
        sim.state.q[:] = body.boundary.modes.T @ load / body.frequency**2
    r = sim.run(5e-3, 1e-5)
    # it would have fallen at g; the edge tilts under the load, so it is not quite where the flat beam would hold it
    assert np.abs(r.v[-1, 0]).max() < 0.01 * g * 5e-3
    assert r.force[-1, 1] == pytest.approx(-MASS * g, rel=0.01)


def test_impact_against_full_finite_elements(mesh):
    """Force and rebound as central differences on every node find them; momentum and energy in balance.

    Both sides are converged in time to better than the tolerances.
    """
    t, forces, speed = explicit(mesh, 2e-3, 2.5e-7)
    body = beam_body(mesh, MAT, 40)
    sim = Simulation([ball(mesh), body], k=K, margin=1e-3, rho=1.0)
    r = sim.run(2e-3, 1e-6)
    exact = np.interp(r.t, t, forces[:, 1])
    assert np.abs(-r.force[:, 1] - exact).max() < 0.03 * exact.max()
    assert r.v[-1, 0, 1] == pytest.approx(speed[1], abs=0.005 * SPEED)
    assert speed[1] < 0.8 * SPEED  # the beam has kept some: rigid and compliant levels return all of it
    impulse = np.trapezoid(-r.force[:, 1], r.t)
    assert impulse == pytest.approx(MASS * (r.v[-1, 0, 1] + SPEED), rel=1e-4)
    assert r.force[-1, 1] == 0.0
    # what is left of the difference is the scheme's, at the loss of contact
    assert r.kinetic[-1] + r.elastic[-1] == pytest.approx(0.5 * MASS * SPEED**2, rel=2e-3)


def test_compliant_level_is_a_spring_in_series(mesh):
    """Without inertia the beam is a spring behind the contact: the ball's equation of motion, solved by scipy.

    The beam is fifty times softer than the contact. Iterations that renew the displacement with the last force, and
    nothing else, run away there.
    """
    body = beam_body(mesh, MAT, 0)
    c = compliance(mesh, body)

    def force(x):
        return K * segment(brentq(lambda d: d + c * K * segment(d) - x, 0.0, x)) if x > 0 else 0.0

    end = 0.02
    out = solve_ivp(
        lambda t, y: [y[1], force(-y[0]) / MASS],
        (0, end),
        [GAP, -SPEED],
        rtol=1e-8,
        atol=1e-10,
        max_step=1e-4,
    )
    exact = max(force(-x) for x in out.y[0])
    sim = Simulation([ball(mesh), body], k=K, margin=1e-3, rho=0.8)
    r = sim.run(end, 2e-6)
    # the edge under the ball tilts: what the straight spring does not know is of that order
    assert -r.force[:, 1].min() == pytest.approx(exact, rel=0.02)
    assert r.v[-1, 0, 1] == pytest.approx(SPEED, rel=0.02)
    assert r.halved.sum() == 0


@pytest.mark.parametrize("level", ["compliant", "modal"])
@pytest.mark.parametrize(
    "held",
    [{"hub": 1, "anchor": (0.01, 0.01), "drive": (0.0, 0.0, 0.0)}, {"clamped": 1}],
    ids=["hub", "clamped"],
)
def test_soft_body(level, held):
    """Rubber under a contact a hundred times stiffer, bent by several times the search margin: it converges.

    Held by a hub, hub load, deformation and contact force are one system.
    """
    rubber = Material(1e7, 0.4, 1000.0, 0.01)
    t = 2 * np.pi * np.arange(200) / 200
    circle = np.column_stack([np.cos(t), np.sin(t)])
    outer = np.array([[0, 0], [0.1, 0], [0.1, 0.02], [0, 0.02]], float)
    beam, _ = elastic_body(
        [outer, 0.006 * circle[::-1] + [0.01, 0.01]], 2.5e-3, rubber, level, modes=20, **held
    )
    disc = Body(build([0.01 * circle]), 0.01, 5e-7, (0.09, 0.0301), velocity=(0.0, -0.5, 0.0))
    sim = Simulation([disc, beam], k=100 * rubber.young * rubber.thickness, margin=1e-3, rho=0.8)
    r = sim.run(0.05, 1e-5)
    assert r.halved.sum() == 0
    assert r.iterations.max() < 15
    assert r.force[:, 1].min() < -0.5 and r.force[-1, 1] == 0.0
    # thrown back, by no more than it brought; the clamped compliant beam has no mass to keep any
    assert (0.497 if level == "compliant" and "clamped" in held else 0.2) < r.v[-1, 0, 1] < 0.5


def test_a_ground_takes_no_anchor(mesh):
    with pytest.raises(ValueError, match="expected no anchor, drive"):
        Simulation([ball(mesh), beam_body(mesh, MAT, 0, anchor=(0.0, 0.0))])
