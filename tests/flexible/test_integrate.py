"""The stepper: free flight, pendulum, a spinning flexible ring, a bouncing disc; and how it fails."""

import numpy as np
import pytest

from rigidarea.flexible.body import elastic_body
from rigidarea.flexible.boundary import build
from rigidarea.flexible.element import Material
from rigidarea.flexible.integrate import Body, Simulation


def circle(radius, n, clockwise=False):
    t = 2 * np.pi * np.arange(n) / n * (-1 if clockwise else 1)
    return radius * np.column_stack([np.cos(t), np.sin(t)])


FLOOR = np.array([[-9.0, -2.0], [9.0, -2.0], [9.0, 0.0], [-9.0, 0.0]])


def ground():
    return Body(build([FLOOR + [0, 1]]), 1.0, 1.0, (0.0, -1.0), fixed=True)


def test_free_fall_is_exact():
    sim = Simulation([Body(build([circle(0.1, 12)]), 2.0, 0.01, (0, 50), velocity=(1, 2, 3)), ground()], rho=1.0,
                     gravity=(0, -10))  # fmt: skip
    r = sim.run(1.0, 0.01)
    assert r.x[-1, 0] == pytest.approx([1, 50 + 2 - 5, 3], rel=1e-12)
    assert r.iterations.max() == 1


def test_pendulum_has_second_order():
    """Period-scale error of a physical pendulum (large swing) falls with h², multipliers and all."""

    def end(h, rho):
        b = Body(build([circle(0.05, 12)]), 1.3, 0.02, (0.5, 0.0), hub=(-0.5, 0.0), anchor=(0.0, 0.0))
        sim = Simulation([b, ground()], [], rho=rho, gravity=(0, -9.81))
        return sim.run(1.0, h).x[-1, 0, 2]

    from scipy.integrate import solve_ivp

    k = 1.3 * 9.81 * 0.5 / (0.02 + 1.3 * 0.25)
    exact = solve_ivp(lambda t, y: [y[1], -k * np.cos(y[0])], (0, 1), [0, 0], rtol=1e-12, atol=1e-12).y[0, -1]
    h = np.array([0.01, 0.005, 0.0025])
    error = np.abs([end(x, 0.8) - exact for x in h])
    assert 1.7 < np.polyfit(np.log(h), np.log(error), 1)[0] < 2.4


def test_drive_and_damper():
    """A driven body follows its ramp; a torque on a damper ends at torque / damper with the right time constant."""
    b = Body(build([circle(0.05, 12)]), 1.0, 0.02, anchor=(0.0, 0.0), drive=(0.3, 5.0, 0.5))
    c = Body(build([circle(0.05, 12)]), 1.0, 0.02, (9, 9), anchor=(9.0, 9.0), damper=0.1, torque=0.4)
    r = Simulation([b, c], [], rho=0.7).run(1.0, 0.001)
    assert r.hub[-1, 0] == pytest.approx(0.3 + 5 * (1 - 0.25), abs=1e-9)
    assert r.hub_rate[-1, 1] == pytest.approx(4 * (1 - np.exp(-1.0 * 0.1 / 0.02)), rel=2e-3)


def test_spinning_ring_keeps_its_energy():
    """100 turns of a free, undamped, flexible ring at ρ∞ = 1: energy within 1e-6."""
    mat = Material(1e6, 0.3, 1000.0, 0.01)
    ring, _ = elastic_body(
        [circle(0.1, 400), circle(0.08, 400, True)], 0.015, mat, "modal", modes=6, velocity=(0.4, 0.0, 20.0)
    )
    sim = Simulation([ring, ground()], [], rho=1.0)
    # start swollen by the spin and shaken, so that modes and frame exchange energy
    sim.state.q[:] = ring.stretch * 20.0**2 / ring.frequency**2
    sim.state.dq[0] = 1e-3
    h = 2 * np.pi / ring.frequency.max() / 60
    r = sim.run(100 * 2 * np.pi / 20.0, h, every=20)
    energy = r.kinetic + r.elastic
    assert np.ptp(r.elastic) > 1e-6 * energy[0]  # there is an exchange to conserve
    change = np.abs(energy / energy[0] - 1).max()
    print(f"energy changed by {change:.2g}")
    assert change < 1e-6
    assert r.x[-1, 0, 0] == pytest.approx(0.4 * r.t[-1], rel=1e-9)


def test_bounce_loses_nothing_and_levels_agree():
    """A disc dropped on a floor: same bounce rigid and compliant when the contact is far softer than the disc."""
    mat = Material(1e11, 0.3, 1000.0, 0.01)
    tops = []
    for level in ("rigid", "compliant", "modal"):
        disc, _ = elastic_body([circle(0.1, 720)], 0.03, mat, level, refine=6, modes=8, position=(0.0, 0.15))
        sim = Simulation([disc, ground()], k=1e6, rho=1.0, gravity=(0, -9.81), margin=0.01)
        r = sim.run(0.35, 1e-4)
        assert r.force[:, 1].min() < -10.0  # pushed the floor down
        tops.append(r.x[2000:, 0, 1].max())
    assert tops == pytest.approx([0.15] * 3, abs=2e-5)


def test_a_step_that_fails_says_so():
    bar = np.array([[-2, -0.2], [2, -0.2], [2, 0.2], [-2, 0.2]])
    a = Body(build([bar]), 1.0, 1.0)
    b = Body(build([bar]), 1.0, 1.0, (0.0, 2.3), angle=np.pi / 2, velocity=(0.0, -230.0, 0.0))
    sim = Simulation([a, b])
    with pytest.raises(RuntimeError, match=r"step 0 .* passes through"):
        sim.run(0.1, 0.01)
    assert len(sim.record.t) == 0  # what was computed stays readable


@pytest.mark.parametrize(
    ("keys", "text"),
    [({"rho": 1.1}, "rho must lie"), ({"contact": "nts"}, "contact must be"), ({"k": -1.0}, "k must be positive"),
     ({"contact": "sts"}, "reach must be positive")],
)  # fmt: skip
def test_bad_settings(keys, text):
    with pytest.raises(ValueError, match=text):
        Simulation([ground(), ground()], **keys)


def test_index_three_needs_damping():
    b = Body(build([circle(0.05, 12)]), 1.0, 1.0, anchor=(0.0, 0.0))
    with pytest.raises(ValueError, match="rho must be below 1"):
        Simulation([b, ground()], rho=1.0)


def test_bad_body():
    mat = Material(1e9, 0.3, 1000.0)
    with pytest.raises(ValueError, match="level must be one of"):
        elastic_body([circle(1.0, 100)], 0.3, mat, "soft")
    with pytest.raises(ValueError, match="hub: a ring must be a whole number from 0 to 0, got 1"):
        elastic_body([circle(1.0, 100)], 0.3, mat, hub=1)
    with pytest.raises(ValueError, match="contact: a ring must be a whole number from 0 to 0, got 1"):
        elastic_body([circle(1.0, 100)], 0.3, mat, contact_rings=(0, 1))
