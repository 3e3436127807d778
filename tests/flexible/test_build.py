"""Mechanisms put together by name: the example of the module, a pendulum, a clamp on part of a boundary."""

import re

import numpy as np
import pytest

from rigidarea import Outline, backend
from rigidarea.flexible import Material, Mechanism, build
from rigidarea.flexible.run import run_steps
from rigidarea.shapes import box, circle

STEEL = Material(207e9, 0.29, 7800.0, 0.02)


def test_the_example_runs():
    """The lines of the module's docstring, as they stand there: the ratio of 20 : 60, and stresses."""
    code = "\n".join(line[4:] for line in build.__doc__.splitlines() if line.startswith("    "))
    assert len(re.findall(r"\S.*", code)) <= 30
    names: dict = {}
    exec(compile(code.replace("print(", "ratio = ("), "example", "exec"), names)
    assert names["ratio"] == pytest.approx(1 / 3, rel=5e-3)
    assert names["stress"].shape[1] == 3 and np.abs(names["stress"]).max() > 1e4


@pytest.mark.parametrize("level", ["rigid", "compliant"])
def test_pendulum(level):
    """A bar on a pivot at its end: the period of small swings, √(2 L/3 g) · 2π."""
    length, g = 0.3, 9.81
    m = Mechanism(1.0, gravity=(0.0, -g), rho=0.9)
    bar = m.body(
        box(length, 0.01), STEEL, level=level, mesh=None if level == "rigid" else 5e-3,
        at=(0.5 * length, 0.0), angle=0.0,
    )  # fmt: skip
    m.pivot(bar, (0.0, 0.0))
    far = m.ground(box(0.1, 0.1), (5.0, 0.0))
    m.contact(bar, far)
    # released flat it swings through half a turn; elliptic integral of a quarter turn to either side
    from scipy.special import ellipk

    quarter = np.sqrt(length * (1 + (0.01 / length) ** 2 / 4) / (1.5 * g)) * ellipk(np.sin(np.pi / 4) ** 2)
    r = m.run(1.5 * quarter, 2e-4)
    angle = r.x[:, 0, 2]
    crossing = np.flatnonzero((angle[:-1] > -0.5 * np.pi) & (angle[1:] <= -0.5 * np.pi))[0]
    assert r.t[crossing] == pytest.approx(quarter, rel=2e-3)


def test_clamp_on_part_of_a_boundary():
    """A strip clamped at its left edge, a heavy ball laid on its tip: the beam's deflection under that weight."""
    length, height, thick = 0.2, 0.01, 0.01
    mat = Material(1e10, 0.3, 1000.0, thick)
    m = Mechanism(1e9, gravity=(0.0, -9.81), rho=0.5)
    strip = m.body(
        box(length, height),
        mat,
        mesh=2.5e-3,
        at=(0.5 * length, 0.0),
        clamp=lambda p: p[:, 0] < -0.499 * length,
    )
    radius, at = 0.01, 0.195
    load = Material(1.0, 0.0, 50.0, 1.0)
    weight = 50.0 * np.pi * radius**2 * 9.81
    stiff = 1e10 * thick * height**3 / 12
    sag = weight * at**3 / (3 * stiff)
    own = mat.density * thick * height * 9.81  # the strip's own weight, a length
    sag += own * at**2 * (6 * length**2 - 4 * length * at + at**2) / (24 * stiff)
    depth = (12 * radius) ** (-1 / 3) * (weight / 1e9) ** (2 / 3) * 1.5  # of a lens of area L³/(12 R)
    ball = m.body(
        circle(radius, tolerance=1e-6), load, level="rigid", at=(at, 0.5 * height + radius - sag - depth)
    )
    m.contact(strip, ball)
    r = m.run(0.4, 2e-4)
    # it swings about the deflection of the beam
    middle = 0.5 * height + radius - r.x[len(r.t) // 2 :, 1, 1].mean()
    assert middle == pytest.approx(sag + depth, rel=0.03)  # shear, ES-FEM, the ball's rolling on the slope
    assert r.force[-100:, 1].mean() == pytest.approx(weight, rel=0.05)


@pytest.mark.skipif(backend() != "compiled", reason="nothing is compiled")
def test_no_compilation_for_another_number_of_bodies():
    """One version of the stepper serves two bodies, three, and three with a joint."""
    for bodies, joint in ((2, False), (3, False), (3, True)):
        m = Mechanism(1e6, rho=0.8)
        for i in range(bodies):
            m.body(box(0.1, 0.1), STEEL, level="rigid", at=(0.2 * i, 0.0))
        m.contact(0, 1)
        if joint:
            m.revolute(2, (0.3, 0.0), 1)
        m.run(1e-3, 1e-4)
    assert len(run_steps.signatures) == 1


def test_bad_parts():
    m = Mechanism(1.0)
    with pytest.raises(ValueError, match="mesh, the spacing"):
        m.body(box(1, 1), STEEL)
    with pytest.raises(ValueError, match="expected neither clamp nor hub"):
        m.body(box(1, 1), STEEL, level="rigid", hub=1)
    with pytest.raises(ValueError, match="expected a body from 0 to -1, got 0"):
        m.pivot(0, (0.0, 0.0))
    with pytest.raises(ValueError, match="expected a run before"):
        m.state(None, 0, 0)
    m.body(Outline([(0, 0), (1, 0), (0, 1)]), STEEL, level="rigid")
    m.contact(0, 0)
    with pytest.raises(ValueError, match="two different bodies"):
        m.run(1.0, 0.1)
