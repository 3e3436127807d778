"""Two free discs collide off centre and rub: friction acts at one point, on both alike."""

import math

import numpy as np

from ..scene import OMEGA, VX, VY, Array, Scene, Trace, X, Y, disc

RADII, MASSES = (0.5, 0.4), (1.0, 2.0)
E, MU, V, SLANT = 0.6, 0.1, 2.0, math.radians(30)
NORMAL = np.array((math.cos(SLANT), math.sin(SLANT)))
TANGENT = np.array((-NORMAL[1], NORMAL[0]))
REDUCED = 1 / (1 / MASSES[0] + 1 / MASSES[1])


def impulses() -> tuple[float, float]:
    """(J_n, J_t): on the first disc against NORMAL and along TANGENT, on the second the opposite.

    J_n = (1 + e) v_n/(1/m + 1/M). The contact point slips with v_t against TANGENT; to stop it would take v_t m_t, of
    discs (1/m_t = Σ 1/m + r²/I = 3 Σ 1/m) a third of the reduced mass. μ J_n is less: it slips all the while, and J_t =
    μ J_n (Routh).
    """
    normal = (1 + E) * V * NORMAL[0] * REDUCED
    slip = -V * TANGENT[0]
    assert 0 < MU * normal < slip * REDUCED / 3
    return normal, MU * normal


def after() -> Array:
    """Velocities (2, 3) after the impact: vx, vy, ω. Both discs are turned the same way, by r J_t/I each."""
    normal, tangential = impulses()
    push = -normal * NORMAL + tangential * TANGENT
    moved = [(V, 0.0) + push / MASSES[0], -push / MASSES[1]]
    turned = [2 * tangential / (m * r) for m, r in zip(MASSES, RADII, strict=True)]
    return np.column_stack((moved, turned))


def angular_momentum(states: Array) -> float:
    """About the origin, of states (2, 6): Σ m (x vy − y vx) + I ω."""
    m, r = np.array(MASSES), np.array(RADII)
    orbital = m * (states[:, X] * states[:, VY] - states[:, Y] * states[:, VX])
    return float(np.sum(orbital + m * r**2 / 2 * states[:, OMEGA]))


def error(trace: Trace) -> float:
    """Largest error of a velocity (rim speed for the spin) or of the angular momentum (over m V r), relative."""
    last = np.array([trace[name][-1] for name in ("a", "b")])
    first = np.array([trace[name][0] for name in ("a", "b")])
    off = np.abs(last[:, [VX, VY, OMEGA]] - after()) * np.array([(1, 1, r) for r in RADII])
    gained = abs(angular_momentum(last) - angular_momentum(first)) / (MASSES[0] * RADII[0])
    return float(max(np.max(off), gained) / V)


def scene() -> Scene:
    """Masses 1 and 2, radii 0.5 and 0.4, line of centres at 30 degrees, e = 0.6, μ = 0.1, no gravity."""
    touch = sum(RADII) * NORMAL
    a = disc("a", RADII[0], (-0.5, 0.0), MASSES[0], velocity=(V, 0.0))
    b = disc("b", RADII[1], (float(touch[0]), float(touch[1])), MASSES[1])
    return Scene(
        title="two free discs, hitting and rubbing",
        bodies=(a, b),
        gravity=(0.0, 0.0),
        friction=MU,
        elasticity=E,
        duration=0.5,
        error_name="velocity or angular momentum, relative",
        error=error,
        source="momenta; Routh, gross sliding: J_t = μ J_n",
        size=2 * RADII[0],
        pressure=V**2,
        tags=frozenset({"impact", "friction"}),
    )
