"""FFRF terms against brute force: LᵀML and LᵀML̇q̇ from the nodal masses."""

import numpy as np
import pytest

from rigidarea.flexible.element import Material, lumped_mass
from rigidarea.flexible.floating_frame import inertia_forces, momentum_of_modes, turning_rows
from rigidarea.flexible.mesh import triangulate
from rigidarea.flexible.modes import elastic, reduce, rigid_modes


def test_against_brute_force():
    rng = np.random.default_rng(1)
    t = 2 * np.pi * np.arange(14) / 14
    mesh = triangulate(
        [np.column_stack([(1 + 0.3 * np.cos(2 * t)) * np.cos(t), 0.7 * np.sin(t) + 0.1 * np.cos(3 * t)])]
    )
    mat = Material(10.0, 0.3, 2.0)
    mass = lumped_mass(mesh, mat)
    _, centre, inertia = rigid_modes(mesh.points, mass)
    phi, _ = elastic(mesh, mat).modes(5)
    body = reduce(mesh, mat, modes=5)
    assert body.inertia == pytest.approx(inertia)
    x, m2, turn = (mesh.points - centre).ravel(), np.repeat(mass, 2), np.array([[0.0, -1.0], [1.0, 0.0]])

    def rotate(matrix, vectors):
        return np.einsum("ij,nj...->ni...", matrix, vectors.reshape(-1, 2, *vectors.shape[1:])).reshape(
            vectors.shape
        )

    theta, omega, alpha = 0.7, 1.3, -0.4
    q, dq, ddq = 0.2 * rng.standard_normal((3, 5))
    a = np.array([[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]])
    u = x + phi @ q
    columns = [np.tile([1.0, 0.0], len(mass)), np.tile([0.0, 1.0], len(mass)), rotate(a @ turn, u)]
    jacobian = np.column_stack([*columns, rotate(a, phi)])  # L
    # L̇ q̇: what is left of the acceleration at q̈ = 0
    rest = rotate(-a, u) * omega**2 + 2 * rotate(a @ turn, phi @ dq) * omega
    acceleration = np.concatenate([[0.3, -0.2, alpha], ddq])
    exact = jacobian.T @ (m2 * (jacobian @ acceleration + rest))
    out = np.zeros(5)
    none = np.zeros((0, 5, 5))
    moment = inertia_forces(
        body.inertia,
        body.stretch,
        body.coupling,
        none,
        0.0,
        0.0,
        q,
        dq,
        ddq,
        omega,
        alpha,
        out,
        np.zeros((4, 5)),
    )
    assert exact[:2] == pytest.approx(body.mass * acceleration[:2], rel=1e-10)
    assert moment == pytest.approx(exact[2], rel=1e-10)
    assert out == pytest.approx(exact[3:], rel=1e-9)
    velocity = np.concatenate([[0.5, 0.1, omega], dq])
    energy = 0.5 * m2 @ (jacobian @ velocity) ** 2
    more, swing = momentum_of_modes(body.stretch, body.coupling, np.zeros((0, len(q), len(q))), q, dq)
    ours = 0.5 * body.mass * velocity[:2] @ velocity[:2] + 0.5 * (body.inertia + more) * omega**2
    ours += omega * swing + 0.5 * dq @ dq
    assert ours == pytest.approx(energy, rel=1e-12)


def test_gradient_by_the_frames_angle():
    """``turning_rows`` against differences of ``inertia_forces``, as a step moves positions, rates and accelerations.

    Left out is what a step of h does at rates and accelerations of some units: h of the gradient at the most.
    """
    rng = np.random.default_rng(2)
    m, h, small = 5, 1e-4, 1e-7
    acc, vel = 4.0 / h**2, 2.0 / h  # of the trapezoidal rule
    stretch, q, dq, ddq = rng.standard_normal((4, m))
    coupling = rng.standard_normal((m, m))
    coupling -= coupling.T
    stiff = 0.1 * rng.standard_normal((3, m, m))
    stiff += stiff.transpose(0, 2, 1)
    work = np.zeros((4, m))

    def forces(turn, moved):
        out = np.zeros(m)
        moment = inertia_forces(
            3.0, stretch, coupling, stiff, 0.0, 0.0, q + moved, dq + vel * moved, ddq + acc * moved, 1.3 + vel * turn,
            -0.4 + acc * turn, out, work,
        )  # fmt: skip
        return np.array([moment, *out])

    centre = forces(0.0, np.zeros(m))
    rows = np.zeros(m)
    own = turning_rows(stretch, q, dq, 3.0, acc, vel, work, rows)
    by_turn = (forces(small, np.zeros(m)) - centre) / small
    by_mode = np.array([(forces(0.0, small * e) - centre)[0] for e in np.eye(m)]) / small
    room = 40 * h * acc  # of sums of some ten terms
    assert own == pytest.approx(by_turn[0], abs=room)
    assert rows == pytest.approx(by_turn[1:], abs=room)
    assert rows == pytest.approx(by_mode, abs=room)
    assert np.abs(rows).min() > 10 * room
