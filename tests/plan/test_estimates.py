"""Every closed form against an exact answer that is worked out another way."""

import math

import numpy as np
import pymunk
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import rigidarea as ra
from rigidarea.plan import estimates as est

G = 9.81


def box_space(penetration=None, stiffness=None, frames=120, steps=4, boxes=1):
    space = pymunk.Space()
    space.gravity = 0, -G
    ground = pymunk.Segment(space.static_body, (-50, 0), (50, 0), 0)
    space.add(ground)
    bodies = []
    for i in range(boxes):
        body = pymunk.Body(2.0, 2.0 / 6.0)
        body.position = 0, 0.5 + i
        space.add(body, pymunk.Poly.create_box(body, (1, 1)))
        bodies.append(body)
    more = {} if penetration is None else {"penetration": penetration}
    contact = ra.attach(space, stiffness, **more)
    contact.step(1 / 60, frames, steps=steps)
    return bodies, contact


def test_penetration_is_what_a_box_sinks():
    bodies, _ = box_space(stiffness=1e5)
    expected = est.penetration(2.0 * G, 1e5, 1.0)
    assert expected == pytest.approx(1.962e-4, rel=1e-3)
    assert 0.5 - bodies[0].position.y == pytest.approx(expected, rel=1e-3)  # the solve's own rest


def test_contact_frequency_is_that_of_the_explicit_law():
    """A box let go above its rest on a stiff floor, in fine explicit steps: its period."""
    space = pymunk.Space()
    space.gravity = 0, -G
    floor = pymunk.Poly(space.static_body, [(-9, -1), (9, -1), (9, 0), (-9, 0)])
    body = pymunk.Body(2.0, 1e9)
    k = 2e4
    rest = est.penetration(2.0 * G, k, 1.0)
    body.position = 0, 0.5 - 1.5 * rest
    box = pymunk.Poly.create_box(body, (1, 1))
    floor.elasticity = box.elasticity = 1.0
    space.add(floor, body, box)
    ra.attach(space, k, integration="explicit")
    w = est.contact_frequency(k, 1.0, 2.0)
    h = 0.01 / w
    heights = []
    for _ in range(1500):
        space.step(h)
        heights.append(body.position.y - (0.5 - rest))
    crossings = np.flatnonzero(np.diff(np.sign(heights)) > 0)
    period = np.mean(np.diff(crossings)) * h
    assert period == pytest.approx(2 * math.pi / w, rel=0.01)  # a crossing is known to one of 628 steps


def test_deflection_of_a_long_bar_is_beam_theory():
    young, t, length, height, load = 2e11, 0.01, 1.0, 0.02, 100.0
    beam = load * length**3 / (48 * young * t * height**3 / 12)
    assert est.deflection(load, young, t, length, height) == pytest.approx(
        beam, rel=2e-3
    )  # compression is the rest
    assert est.deflection(load, young, t, 1.0, 1.0) == pytest.approx(1.25 * load / (young * t))


def test_first_frequency_of_a_bar_is_the_root_of_its_equation():
    young, density, length, height = 2e11, 7800.0, 1.0, 0.01
    root = brentq(lambda x: math.cos(x) * math.cosh(x) - 1.0, 4.0, 5.0)  # free at both ends
    inertia = height**2 / 12
    w = root**2 / length**2 * math.sqrt(young * inertia / density)
    assert est.bar_frequency(young, density, length, height) == pytest.approx(w, rel=1e-4)
    lump = est.bar_frequency(young, density, 1.0, 1.0)
    assert lump == pytest.approx(math.pi * math.sqrt(young / density))  # stretching is slower


@pytest.mark.slow
def test_first_frequency_of_a_ring_is_the_elements():
    from rigidarea.flexible.body import elastic_body
    from rigidarea.flexible.element import Material

    outer, inner = 0.05, 0.045
    rings = [ra.Outline.circle(r).sample(1e-6).rings[0] for r in (outer, inner)]
    outline = ra.Outline(rings[0], [rings[1]])
    body, _ = elastic_body(outline.rings, 1.25e-3, Material(207e9, 0.29, 7800.0, 0.01), "modal", modes=4)
    w = est.ring_frequency(207e9, 7800.0, 0.5 * (outer + inner), outer - inner)
    assert body.frequency[0] == pytest.approx(w, rel=0.05)  # a thin ring's theory, height/radius 0.1


def test_dynamic_error_is_that_of_an_oscillator():
    """A spring and mass pushed at a frequency: its swing beside what statics says."""
    r = 0.3
    found = solve_ivp(
        lambda t, y: (y[1], math.cos(r * t) - y[0]), (0, 400), (1 / (1 - r * r), 0.0), rtol=1e-9, atol=1e-12
    )
    swing = np.max(np.abs(found.y[0]))
    assert swing - 1.0 == pytest.approx(est.dynamic_error(r, 1.0), rel=1e-3)
    assert est.dynamic_error(1.0, 1.0) == math.inf


def test_modes_below_counts_a_rectangles_waves():
    """Weyl's count beside that of the standing waves of two speeds in a rectangle."""
    young, density, a, b = 2e11, 7800.0, 1.0, 0.7
    w = 60 * math.sqrt(young / density)
    count = 0
    for speed in (math.sqrt(young / density), math.sqrt(young / (2.6 * density))):
        i, j = np.meshgrid(np.arange(1, 200), np.arange(1, 200))
        count += int(np.sum(speed * math.pi * np.hypot(i / a, j / b) <= w))
    assert est.modes_below(w, a * b, young, density) == pytest.approx(
        count, rel=0.15
    )  # less the boundary's share
