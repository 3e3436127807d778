"""Friction and damping of flexible contacts, against closed forms, rigid bodies and one that yields."""

import numpy as np
import pytest

from rigidarea.flexible import Material, Mechanism
from rigidarea.shapes import box, circle

G = 9.81
STONE = Material(1e9, 0.3, 1000.0, 0.1)


def on_an_incline(angle: float, friction: float, level: str, duration: float):
    """A block set on a slope, a little above its depth at rest; the record."""
    m = Mechanism(1e7, gravity=(G * np.sin(angle), -G * np.cos(angle)), rho=0.8)
    mesh = None if level == "rigid" else 0.05
    m.ground(box(4.0, 0.2), (0.0, -0.1))
    weight = 1000.0 * 0.1 * 0.2 * 0.1 * G
    m.body(box(0.2, 0.1), STONE, level=level, mesh=mesh, at=(0.0, 0.05 - weight / (1e7 * 0.2)))
    m.contact(0, 1, friction=friction, restitution=0.2)
    return m.run(duration, 5e-4)


@pytest.mark.parametrize("level", ["rigid", "compliant"])
def test_a_block_holds_below_the_friction_angle(level):
    """tan 0.3 = 0.309 < 0.35: after it has settled it does not creep; the force along the slope is its weight's."""
    r = on_an_incline(0.3, 0.35, level, 1.0)
    x = r.x[:, 1, 0]
    late = len(x) // 2
    assert abs(x[-1] - x[late]) < 1e-9  # of a block of 0.2 m, in half a second
    weight = 1000.0 * 0.1 * 0.2 * 0.1 * G
    assert r.force[-1] == pytest.approx([-weight * np.sin(0.3), weight * np.cos(0.3)], rel=1e-3)


def test_a_block_slides_above_it():
    """a = g (sin θ − μ cos θ)."""
    r = on_an_incline(0.5, 0.3, "rigid", 0.5)
    late = r.t > 0.1
    a = np.polyfit(r.t[late], r.v[late, 1, 0], 1)[0]
    assert a == pytest.approx(G * (np.sin(0.5) - 0.3 * np.cos(0.5)), rel=2e-3)


@pytest.mark.parametrize(("restitution", "off"), [(1.0, 2e-3), (0.5, 0.1), (0.0, 0.17)])
def test_restitution(restitution, off):
    """A disc on a slab. A chord that grows with the depth makes the dashpot approximate: 0 returns 0.155."""
    m = Mechanism(1e6, rho=1.0)
    m.ground(box(2.0, 0.2), (0.0, -0.1))
    m.body(circle(0.1, tolerance=1e-5), STONE, level="rigid", at=(0.0, 0.1001), velocity=(0.0, -1.0, 0.0))
    m.contact(0, 1, restitution=restitution)
    r = m.run(0.2, 1e-4)
    assert r.v[-1, 1, 1] == pytest.approx(restitution, abs=off)
    assert r.forces[:, 0, 1].min() >= 0.0  # it never pulls


@pytest.mark.parametrize("level", ["rigid", "compliant"])
@pytest.mark.parametrize("k", [1e8, 1e10, 1e12])
def test_a_blow_in_a_long_step_gains_nothing(level, k):
    """A box flat on a wall, at 1 m/s and steps of which up to 70 are a radian of the contact: those in which they come
    together or part are halved until they follow it."""
    m = Mechanism(k)
    keys = {} if level == "rigid" else {"mesh": 0.05}
    material = Material(1e9, 0.3, 1000.0, 0.01)
    b = m.body(box(0.2, 0.2), material, level=level, at=(0.1 + 1e-6, 0.0), velocity=(-1.0, 0.0, 0.0), **keys)
    m.contact(b, m.ground(box(0.2, 0.6), at=(-0.1, 0.0)))
    r = m.run(6e-3, 1e-4)
    # (ω h)²/20, ω h at most 0.3; where the box yields, more than once in a while it is pressed unevenly
    assert r.v[-1, 0, 0] == pytest.approx(1.0, abs=0.01 if level == "rigid" else 0.03)


@pytest.mark.parametrize("restitution", [0.0, 0.5, 0.8])
@pytest.mark.parametrize("level", ["compliant", "modal"])
def test_restitution_of_a_disc_that_yields(restitution, level):
    """The dashpot is that of contact and bodies in series: what comes back does not depend on k. (By the contact's
    stiffness alone, of 0.5 came back 0.22 at k = 100 E.) Vibration adds to what modes return."""
    back = []
    for what, k in (("rigid", 1e8), (level, 1e8), (level, 1e11)):
        m = Mechanism(k)
        keys = {} if what == "rigid" else {"mesh": 0.02}
        material = Material(1e9, 0.3, 1000.0, 0.01)
        b = m.body(circle(0.1), material, level=what, at=(0.1 + 1e-6, 0.0), velocity=(-1.0, 0.0, 0.0), **keys)
        m.contact(b, m.ground(box(0.2, 0.6), at=(-0.1, 0.0)), restitution=restitution)
        back.append(m.run(6e-3, 4e-6).v[-1, 0, 0])
    assert back[1:] == pytest.approx([back[0]] * 2, abs=0.06 if level == "compliant" else 0.12)


def test_friction_keeps_momentum_and_turns_a_disc():
    """A spinning disc set on a free slab: friction is equal and opposite, and it rolls in the end."""
    m = Mechanism(1e7, gravity=(0.0, 0.0), rho=0.8)
    a = m.body(box(1.0, 0.1), STONE, level="rigid", at=(0.0, -0.05), velocity=(0.0, 0.05, 0.0))
    b = m.body(circle(0.05, tolerance=1e-5), STONE, level="rigid", at=(0.0, 0.05), velocity=(0.0, -0.05, 3.0))
    m.contact(a, b, friction=0.5, restitution=0.5)
    r = m.run(0.05, 1e-4)
    mass = np.array([10.0, 1000.0 * 0.1 * np.pi * 0.05**2])
    p = (mass[None, :, None] * r.v[:, :, :2]).sum(1)
    assert p == pytest.approx(
        np.broadcast_to(p[0], p.shape), abs=2e-6
    )  # Newton's tolerance: 1e-7 of the force
    assert r.v[-1, 1, 0] - r.v[-1, 0, 0] < -1e-3  # it has been pushed aside, against its turn
    assert abs(r.v[-1, 1, 2]) < 3.0


def test_outlines_that_share_lines_do_not_pass():
    """Two boxes of one height, pushed together: their edges lie on the same lines, to the last bit."""
    m = Mechanism(1e7, rho=0.9)
    for x, v in ((0.0, 1.0), (0.4, -1.0)):
        m.body(box(0.4, 0.2), STONE, level="rigid", at=(x, 0.0), velocity=(v, 0.0, 0.0))
    m.contact(0, 1)
    r = m.run(0.05, 1e-4)
    assert r.v[-1, :, 0] == pytest.approx([-1.0, 1.0], abs=0.02)


def test_bad_values():
    m = Mechanism(1.0)
    for x in (0.0, 2.0):
        m.body(box(1, 1), STONE, level="rigid", at=(x, 0.0))
    with pytest.raises(ValueError, match="friction must be finite and not negative"):
        m.contact(0, 1, friction=-0.1)
