"""Buckling tells the truth: towers below the limit of their sinking stand, those beyond fall as fast as a beam does."""

import math

import numpy as np
import pytest
from solve_world import DT, area_only
from test_piles import tower

G = 10.0
OFFSET = 1e-4
"""Sides by which each box is put aside at random."""


def growth(count, sinking):
    """Rate (1/s) of the fastest growing lean of `count` unit boxes, δ₀ = m g/(k s²) = `sinking`; 0 if all modes swing.

    Box j tilts by θ_j; x_j = s (θ_j/2 + Σ θ_i below). Energies in m g s: beds θ differences/(12 δ₀), the weight above
    a box lowers by its tilt, (n - j - 1/2) θ_j²/2; kinetic energy m (ẋ² + s² θ̇²/12)/2. Slip between boxes and what
    they sink are left out: n δ₀ = 4e-3.
    """
    n = count
    bed = np.diag(np.full(n, 2.0)) - np.diag(np.ones(n - 1), 1) - np.diag(np.ones(n - 1), -1)
    bed[-1, -1] = 1.0
    stiffness = bed / (12 * sinking) - np.diag(n - np.arange(n) - 0.5)
    places = np.tril(np.ones((n, n)), -1) + np.eye(n) / 2
    mass = places.T @ places + np.eye(n) / 12
    factor = np.linalg.inv(np.linalg.cholesky(mass))
    lowest = float(np.linalg.eigvalsh(factor @ stiffness @ factor.T)[0])
    return math.sqrt(max(-lowest, 0.0) * G)


def lean(world):
    """Way (sides) of the top box past the bottom one."""
    return abs(world.bodies[-1].position.x - world.bodies[0].position.x)


def measured(count, sinking, steps=None, seconds=60.0, seed=0):
    """Fitted rate (1/s) of the lean between 3e-3 and 0.1 sides, and the furthest lean."""
    world = tower(count, friction=0.9, offset=OFFSET, seed=seed, stiffness=G / sinking)
    times, leans, furthest = [], [], 0.0
    for i in range(round(seconds / DT)):
        world.step(steps)
        now = lean(world)
        furthest = max(furthest, now)
        if 3e-3 < now < 0.1:
            times.append(i * DT)
            leans.append(math.log(now))
        if now > 0.2:
            break
    rate = float(np.polyfit(times, leans, 1)[0]) if len(times) > 10 else 0.0
    return rate, furthest


def test_the_beam_formula():
    """The eigenvalue changes sign at (0.65/δ₀)^(1/3) boxes: 14.8 at 2e-4, 50.7 at 5e-6."""
    assert growth(14, 2e-4) == 0.0 and growth(16, 2e-4) > 0.0
    assert growth(49, 5e-6) == 0.0 and growth(52, 5e-6) > 0.0


@area_only
@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("steps", [4, None])
def test_twenty_on_soft_beds_fall_as_a_beam_does(steps, seed):
    """20 boxes at 2e-4 (limit 14): the lean grows at the beam's rate to 20 %."""
    rate, furthest = measured(20, 2e-4, steps, seed=seed)
    assert furthest > 0.1
    assert rate == pytest.approx(growth(20, 2e-4), rel=0.2)


@area_only
@pytest.mark.parametrize("steps", [4, None])
def test_ten_on_soft_beds_stand(steps):
    """Below the limit: after 20 s the lean is a few offsets, magnified by 1/(1 - load/limit) at most."""
    rate, furthest = measured(10, 2e-4, steps, seconds=20.0)
    assert furthest < 20 * OFFSET and rate == 0.0


@area_only
@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_forty_on_stiff_beds_stand(seed):
    """40 boxes at 5e-6 (limit 50), offsets of 1e-4 sides: stand for 60 s.

    The lean is the random walk of the offsets, and what the beds add: below 0.05.
    """
    rate, furthest = measured(40, 5e-6, seed=seed)
    assert furthest < 0.05 and rate == 0.0
