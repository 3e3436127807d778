"""Joints between bodies of a mechanism, and to the ground: each against a closed form or scipy."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rigidarea.flexible import Material, Mechanism
from rigidarea.flexible.check import check_joints
from rigidarea.flexible.mechanism_joints import Joint
from rigidarea.shapes import box

G = 9.81
WOOD = Material(1e10, 0.3, 600.0, 0.02)
LINK = (0.4, 0.04)
MASS = 600.0 * 0.02 * 0.4 * 0.04
INERTIA = MASS * (0.4**2 + 0.04**2) / 12


def settings(level):
    return {"level": level, "mesh": None if level == "rigid" else 0.02}


def double_pendulum(duration: float, inertia: float) -> np.ndarray:
    """Angles (2,) of two links hung up level, after ``duration``: their equations of motion, by scipy.

    Lagrange: (I + m l²/4 + m l²) α1 + ½ m l² cos(θ1 - θ2) α2 + ½ m l² sin(θ1 - θ2) ω2² + 3/2 m g l cos θ1 = 0 and
    (I + m l²/4) α2 + ½ m l² cos(θ1 - θ2) α1 - ½ m l² sin(θ1 - θ2) ω1² + ½ m g l cos θ2 = 0.
    """
    l, quarter = LINK[0], inertia + MASS * LINK[0] ** 2 / 4

    def rate(_, y):
        a, b, wa, wb = y
        c, s = 0.5 * MASS * l**2 * np.cos(a - b), 0.5 * MASS * l**2 * np.sin(a - b)
        right = [-s * wb**2 - 1.5 * MASS * G * l * np.cos(a), s * wa**2 - 0.5 * MASS * G * l * np.cos(b)]
        return [wa, wb, *np.linalg.solve([[quarter + MASS * l**2, c], [c, quarter]], right)]

    return solve_ivp(rate, (0, duration), [0, 0, 0, 0], rtol=1e-11, atol=1e-11).y[:2, -1]


@pytest.mark.parametrize(
    ("level", "ground"), [("rigid", "pivot"), ("rigid", "joint"), ("compliant", "joint")]
)
def test_double_pendulum(level, ground):
    """Two links, a revolute joint between them: angles after 0.6 s; of the second order in the step."""
    error = []
    for h in (1e-3, 5e-4):
        m = Mechanism(1.0, gravity=(0.0, -G), rho=0.9)
        one = m.body(box(*LINK), WOOD, at=(0.2, 0.0), **settings(level))
        two = m.body(box(*LINK), WOOD, at=(0.6, 0.0), **settings(level))
        m.pivot(one, (0.0, 0.0)) if ground == "pivot" else m.revolute(one, (0.0, 0.0))
        hinge = m.revolute(two, (0.4, 0.0), one)
        r = m.run(0.6, h)
        inertia = m.simulation.bodies[0].inertia  # lumped at the nodes, where there is a mesh
        assert inertia == pytest.approx(INERTIA, rel=0.03)
        error.append(np.abs(r.x[-1, :, 2] - double_pendulum(0.6, inertia)).max())
        # it stays closed to Newton's tolerance
        ends = r.x[:, :, :2] + 0.2 * np.stack([np.cos(r.x[:, :, 2]), np.sin(r.x[:, :, 2])], 2) * [[[1], [-1]]]
        assert np.abs(ends[:, 0] - ends[:, 1]).max() < 1e-9
        # what the hinge does to the second link is what moves it
        acceleration = np.gradient(r.v[:, 1, :2], r.t, axis=0)[5:-5]
        pull = MASS * (acceleration + [0, G])
        assert np.abs(r.joints[5:-5, hinge, :2] - pull).max() < 0.02 * np.abs(pull).max()
    assert error[1] < 2e-4  # of turns by 2 radians
    assert error[0] / error[1] == pytest.approx(4.0, rel=0.15)


def test_two_masses_on_a_spring():
    """Frequency of the pair √(k (1/m1 + 1/m2)), the middle of mass at rest; then a damper: its logarithmic
    decrement."""
    k, frequency = 900.0, None
    for damping in (0.0, 0.4):
        m = Mechanism(1.0, rho=0.999)
        one = m.body(box(0.1, 0.1), WOOD, level="rigid")
        two = m.body(box(0.2, 0.1), WOOD, level="rigid", at=(0.5, 0.0))
        m.spring(two, (0.5, 0.0), (0.0, 0.0), one, stiffness=k, damping=damping, rest=0.45)
        r = m.run(0.4, 1e-4)
        m1, m2 = 600 * 0.02 * 0.01, 600 * 0.02 * 0.02
        reduced = m1 * m2 / (m1 + m2)
        stretch = r.x[:, 1, 0] - r.x[:, 0, 0] - 0.45
        frequency = np.sqrt(k / reduced)
        decay = damping / (2 * reduced)
        w = np.sqrt(frequency**2 - decay**2)
        exact = 0.05 * np.exp(-decay * r.t) * (np.cos(w * r.t) + decay / w * np.sin(w * r.t))
        # (ω h)²/12 a radian, and what ρ∞ below 1 takes
        assert np.abs(stretch - exact).max() < 2e-3 * 0.05
        middle = (m1 * r.x[:, 0, 0] + m2 * r.x[:, 1, 0]) / (m1 + m2)
        assert np.abs(middle - middle[0]).max() < 1e-10
        assert np.abs(r.x[:, :, 1:]).max() < 1e-12
        first = r.joints[0, 0]
        assert first[0] == pytest.approx(-k * stretch[0] - damping * (r.v[0, 1, 0] - r.v[0, 0, 0]), rel=1e-6)


@pytest.mark.parametrize("level", ["rigid", "compliant"])
def test_a_slider_slides(level):
    """A block on an inclined guide in the ground: g sin θ along it; the guide bears m g cos θ, and no moment."""
    m = Mechanism(1.0, gravity=(0.0, -G), rho=0.8)
    block = m.body(box(0.1, 0.05), WOOD, angle=0.3, **settings(level))
    guide = m.slider(block, (np.cos(0.3), np.sin(0.3)))
    r = m.run(0.5, 1e-3)
    mass = 600 * 0.02 * 0.1 * 0.05
    way = r.x[-1, 0, :2] @ [np.cos(0.3), np.sin(0.3)]
    assert way == pytest.approx(-0.5 * G * np.sin(0.3) * 0.25, rel=1e-9)
    assert np.abs(r.x[:, 0, 2] - 0.3).max() < 1e-10
    assert r.joints[-1, guide] == pytest.approx(
        [-mass * G * np.cos(0.3) * np.sin(0.3), mass * G * np.cos(0.3) ** 2, 0.0], abs=1e-7
    )


def test_a_slider_on_a_body_that_turns():
    """A collar on a turning bar: what is at r0 in the middle of its bar is thrown out as r0 cosh(ω t)."""
    m = Mechanism(1.0, rho=0.9)
    bar = m.body(box(1.0, 0.02), WOOD, level="rigid", velocity=(0.0, 0.0, 5.0))
    m.pivot(bar, (0.0, 0.0))
    m.drive(bar, 5.0)
    collar = m.body(box(0.02, 0.04), WOOD, level="rigid", at=(0.1, 0.0), velocity=(0.0, 0.5, 5.0))
    guide = m.slider(collar, (1.0, 0.0), bar)
    r = m.run(0.3, 1e-4)
    distance = np.hypot(*r.x[:, collar, :2].T)
    assert distance == pytest.approx(0.1 * np.cosh(5.0 * r.t), rel=1e-5)
    # Coriolis: 2 m ω r'
    force = np.hypot(*r.joints[-1, guide, :2])
    mass = 600 * 0.02 * 0.02 * 0.04
    assert force == pytest.approx(2 * mass * 5.0 * 0.1 * 5.0 * np.sinh(1.5), rel=1e-3)


def test_welded_bodies_are_one():
    """Two halves of a bar welded together swing as the whole bar; at the weld the moment of a beam's section."""
    angles = []
    for welded in (True, False):
        m = Mechanism(1.0, gravity=(0.0, -G), rho=0.9)
        if welded:
            one = m.body(box(0.2, 0.04), WOOD, level="rigid", at=(0.1, 0.0))
            two = m.body(box(0.2, 0.04), WOOD, level="rigid", at=(0.3, 0.0))
            weld = m.weld(two, (0.2, 0.0), one)
        else:
            one = m.body(box(*LINK), WOOD, level="rigid", at=(0.2, 0.0))
        m.pivot(one, (0.0, 0.0))
        r = m.run(0.4, 1e-3)
        angles.append(r.x[:, 0, 2])
        if welded:
            assert np.abs(r.x[:, 0, 2] - r.x[:, 1, 2]).max() < 1e-10
            # the far half, at rest and level: α = 3 g / 2 l of the whole, its own moment about the weld
            half = MASS / 2
            own = half * (0.2**2 + 0.04**2) / 12
            alpha = -0.5 * MASS * G * 0.4 / (INERTIA + MASS * 0.04)
            moment = own * alpha + half * 0.1 * (0.3 * alpha + G)
            assert r.joints[0, weld, 2] == pytest.approx(moment, rel=1e-3)
    assert np.abs(angles[0] - angles[1]).max() < 1e-5  # both of the second order in the step


def test_a_weld_to_the_ground_carries_a_weight():
    m = Mechanism(1.0, gravity=(0.0, -G), rho=0.8)
    m.body(box(*LINK), WOOD, level="rigid", at=(0.2, 0.0))
    m.weld(0, (0.0, 0.0))
    r = m.run(0.01, 1e-3)
    assert r.joints[-1, 0] == pytest.approx([0.0, MASS * G, MASS * G * 0.2], abs=1e-8)
    assert np.abs(r.x[-1, 0] - [0.2, 0, 0]).max() < 1e-12


@pytest.mark.parametrize(
    ("joint", "told"),
    [
        (Joint("ball", -1, 0), "kind must be one of"),
        (Joint("weld", 0, 0), "must tie two of the bodies"),
        (Joint("weld", 0, 2), "must tie two of the bodies 0 … 1"),
        (Joint("slider", 0, 1, axis=(0.0, 0.0)), "axis must have a direction"),
        (Joint("spring", 0, 1, stiffness=-1.0), "stiffness must be finite and not negative"),
        (Joint("revolute", 0, 1, at_a=(np.nan, 0.0)), "at_a must be 2 finite numbers"),
    ],
)
def test_bad_joints(joint, told):
    with pytest.raises(ValueError, match=told):
        check_joints([joint], 2)


def test_joints_that_say_the_same():
    m = Mechanism(1.0)
    m.body(box(*LINK), WOOD, level="rigid")
    m.weld(0, (0.0, 0.0))
    m.revolute(0, (0.1, 0.0))
    with pytest.raises(ValueError, match="must be independent, got 5 of rank 3"):
        m.run(0.1, 0.01)
    with pytest.raises(ValueError, match="expected a body from 0 to 0, got 1"):
        m.weld(1, (0.0, 0.0))
