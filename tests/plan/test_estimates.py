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


def test_impact_depth_is_an_energy_balance():
    mass, speed, k, chord = 3.0, 2.0, 4e4, 0.7
    deepest = brentq(lambda d: 0.5 * mass * speed**2 - 0.5 * k * chord * d * d, 0.0, 1.0)
    assert est.impact_depth(speed, mass, k, chord) == pytest.approx(deepest, rel=1e-12)


@pytest.mark.parametrize("phase", [0.05, 0.3, 1.0, 4.0, 100.0])
def test_blow_depth_bounds_a_mass_on_a_spring(phase):
    """Backward Euler itself, from the touch on: no deeper, and close where it is soft or stiff."""
    speed, h = 3.0, 1 / 120
    w = phase / h
    place, rate, deepest = 0.0, speed, 0.0
    for _ in range(200):
        rate = (rate - h * w * w * place) / (1.0 + (w * h) ** 2)
        place += h * rate
        deepest = max(deepest, place)
    told = est.blow_depth(speed, w, h)
    assert deepest <= told * (1 + 1e-12)
    assert told <= math.sqrt(2.0) * deepest  # at w h = 1 the most: 1/sqrt(2) for its 1/2
    if phase > 50.0:
        assert told == pytest.approx(deepest, rel=1e-3)
        weight = G / w**2  # how deep its weight would rest
        assert told / weight == pytest.approx(speed / (G * h), rel=1e-3)


def test_blow_depth_of_a_soft_contact_is_an_energy_balance():
    speed, mass, k, chord = 3.0, 2.0, 4e3, 0.7
    w = est.contact_frequency(k, chord, mass)
    assert est.blow_depth(speed, w, 1e-6) == pytest.approx(est.impact_depth(speed, mass, k, chord), rel=1e-6)


def test_a_corner_sinks_by_the_root():
    for p in (1e-2, 1e-4, 1e-6):
        corner = ra.Outline([(-1, -1), (1, -1), (1, 1), (-1, 1)])
        depth = est.corner_depth(p) * 2.0
        place = (0.0, math.sqrt(2.0) - depth, math.pi / 4)
        floor = ra.Outline([(-9, -9), (9, -9), (9, 0), (-9, 0)])
        (region,) = ra.overlap(corner, place, floor, (0, 0, 0))
        assert region["area"] == pytest.approx(
            p * 2.0**2, rel=1e-6
        )  # what a face of that size cuts off at depth p


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


def test_resting_phase_is_that_of_the_stiffness_for_it():
    p, extent, mass, h = 2e-4, 0.8, 3.0, 1 / 120
    k = mass * G / (p * extent * extent)  # a face as long as the body is high
    assert est.resting_phase2(G, h, p, extent) == pytest.approx(
        (est.contact_frequency(k, extent, mass) * h) ** 2, rel=1e-12
    )


def test_curve_loss_is_that_of_a_polygonal_path():
    """A bead on a circle whose velocity loses, a step, what points into the wall: the stiff limit of the formula."""
    speed, radius, h, time = 2.0, 1.5, 1e-3, 0.8
    turn = speed * h / radius
    kept = math.cos(turn) ** (2 * round(time / h))
    assert 1 - kept == pytest.approx(2 * est.curve_loss(speed, radius, h, time, 1e12), rel=0.01)
    assert est.curve_loss(speed, radius, h, time, 1.0) == pytest.approx(
        0.25 * est.curve_loss(speed, radius, h, time, 1e12), rel=1e-6
    )


def test_lens_depth_is_that_of_two_arcs():
    """A disc in a hole that it nearly fills: the depth at which their lens has p s², by its exact area."""
    hole, disc, p = 1.0, 0.98, 1e-5
    area = p * (2 * disc) ** 2

    def cap(radius: float, half: float) -> float:
        return radius**2 * math.asin(half / radius) - half * math.sqrt(radius**2 - half**2)

    def lens(depth: float) -> float:  # of the disc, what is beyond the hole; its middle is c + depth off
        off = hole - disc + depth
        x = (off**2 + hole**2 - disc**2) / (2 * off)
        half = math.sqrt(hole**2 - x**2)
        return cap(disc, half) - cap(hole, half)

    low, high = 1e-9, 0.01
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if lens(middle) < area else (low, middle)
    assert est.lens_depth(p, 2 * disc, hole - disc) * (hole - disc) == pytest.approx(low, rel=0.1)


def test_what_leans_shifts_by_its_springs():
    """A rigid base on springs that push only: what its edge's share of the weight turns it by."""
    wide, high, p, margin = 1.0, 3.0, 1e-4, 0.1
    x = np.linspace(-0.5, 0.5, 20001)
    k = 1.0 / p / wide  # weight 1, p of its width where it stands upright
    at = 0.5 * (1.0 - margin) * wide
    sunk, turn = p, 0.0
    for _ in range(200):  # Newton's, on force and moment
        down = np.maximum(sunk + turn * x, 0.0)
        on = down > 0.0
        dx = x[1] - x[0]
        force, moment = k * down.sum() * dx - 1.0, k * (down * x).sum() * dx - at
        a, b, c = (k * (x[on] ** n).sum() * dx for n in range(3))
        step = np.linalg.solve([[a, b], [b, c]], [force, moment])
        sunk, turn = sunk - step[0], turn - step[1]
    slender = 0.5 * math.hypot(wide, high)
    told = est.leaning(np.array([margin]), np.array([slender]))[0]
    assert told * p == pytest.approx(turn * slender, rel=0.02)


def test_turning_gap_is_the_sagitta_of_the_way():
    speed, radius, h, depth = 2.0, 0.7, 1e-3, 1e-6
    gap = math.hypot(radius, speed * h) - radius
    assert est.turning_gap((speed / radius) ** 2, radius, h, depth) == pytest.approx(gap / depth, rel=1e-4)


def test_bounce_error_bounds_where_touch_may_lie():
    """Touch anywhere in a substep: half of it from where gravity's share is given, at the most."""
    speed, h = 3.0, 1 / 60
    worst = max(abs((0.5 * G * (t - h / 2) ** 2) / (speed**2 / (2 * G))) for t in np.linspace(0, h, 101))
    assert worst == pytest.approx(est.bounce_error(G, h, speed), rel=1e-9)


@pytest.mark.parametrize("e", [0.5, 0.8])
def test_last_speed_is_that_of_the_flights(e):
    speed, touches = 4.0, 4
    time = speed / G * (1 + 2 * sum(e**n for n in range(1, touches + 1)))
    assert est.last_speed(speed, G, np.array([e]), time)[0] == pytest.approx(max(e**touches, 0.1) * speed)
    assert est.last_speed(speed, G, np.array([1.0]), 100.0)[0] == speed


def test_sagitta_and_facets():
    radius, tolerance = 2.0, 1e-4
    ring = ra.Outline.circle(radius).sample(tolerance).rings[0]
    chord = math.dist(ring[0], ring[1])
    turn = 2 * math.pi / len(ring)
    assert est.sagitta(radius, chord) == pytest.approx(radius * (1 - math.cos(turn / 2)), rel=1e-2)
    assert est.facet_turn(radius, tolerance) == pytest.approx(
        turn, rel=0.3
    )  # the library keeps areas, and rounds up
    assert est.tolerance_for_turn(radius, est.facet_turn(radius, tolerance)) == pytest.approx(tolerance)


def test_facet_loss_is_that_of_the_edges():
    turn, angle = 0.02, 3.0
    kept = math.cos(turn) ** (2 * round(angle / turn))  # of the energy
    assert 1 - math.sqrt(kept) == pytest.approx(est.facet_loss(turn, angle, 1.0, 0.0), rel=0.02)
    assert est.facet_loss(turn, angle, 1e-3, 1.0) < 1e-3 * est.facet_loss(turn, angle, 1.0, 0.0)


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


def test_sweeps_of_a_chain():
    """Conjugate gradients on a chain of equal masses, one end fixed: e-foldings as the estimate has them."""
    n = 40
    matrix = 2 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    matrix[-1, -1] = 1.0
    load = np.ones(n)
    x, r = np.zeros(n), load.copy()
    d = r.copy()
    exact = np.linalg.solve(matrix, load)
    k = 0
    while np.linalg.norm(x - exact) > 0.01 * np.linalg.norm(exact):
        k += 1
        q = matrix @ d
        a = r @ r / (d @ q)
        x, after = x + a * d, r - a * q
        d, r = after + (after @ after) / (r @ r) * d, after
    assert k <= est.sweeps_wanted(n, 1.0) <= 6 * n  # a chain of its own is exact after n: a pile is many
    assert (
        est.sweeps_ours(n, shared=False) == 0 < k
    )  # ours are exact on it: the next substep has nothing left to do
    assert est.sweeps_ours(n, shared=False, struck=1.0) < k  # a blow's load is new
    assert est.sweeps_ours(n, shared=True) == est.sweeps_wanted(n, 1.0)


def test_ten_sweeps_find_a_towers_loads_in_one_substep():
    """Ten boxes: so many sweeps as the search takes leave the beds' own depth; half as many do not."""
    p = 1e-7
    bed = 10 * p * 10  # ten faces, no deeper than what the lowest carries
    sunk = {}
    for sweeps in (est.LEAST_PILE_SWEEPS, est.LEAST_SWEEPS):
        space = pymunk.Space()
        space.gravity, space.iterations = (0, -G), sweeps
        space.add(pymunk.Segment(space.static_body, (-50, 0), (50, 0), 0))
        bodies = []
        for i in range(10):
            body = pymunk.Body(1.0, 1.0 / 6.0)
            body.position = 0, 0.5 + i
            space.add(body, pymunk.Poly.create_box(body, (1, 1)))
            bodies.append(body)
        ra.attach(space, penetration=p).step(1 / 60, 60, steps=1)
        sunk[sweeps] = max(i + 0.5 - body.position.y for i, body in enumerate(bodies))
    assert sunk[est.LEAST_PILE_SWEEPS] <= bed
    assert sunk[est.LEAST_SWEEPS] > 100 * bed


def test_a_pile_sags_by_the_time_its_loads_take():
    h, extent = 1 / 120, 0.5
    alone = est.free_fall(G, h, extent)
    assert alone == pytest.approx(0.5 * G * h * h / extent)
    assert est.pile_sag(G, h, extent, 0.0, 10) == alone
    assert est.pile_sag(G, h, extent, 30.0, 10) == pytest.approx(16 * alone)  # four substeps long


def test_a_stack_sags_no_more_than_that():
    """Ten boxes put on each other, two substeps of ten sweeps, stiff enough that their beds are nothing."""
    bodies, _ = box_space(penetration=1e-7, frames=60, steps=2, boxes=10)
    sunk = max(i + 0.5 - body.position.y for i, body in enumerate(bodies))
    assert 0 < sunk <= est.pile_sag(G, 1 / 120, 1.0, est.sweeps_wanted(10, 1.0), 10)


def test_buckling_is_where_the_docs_have_it():
    assert est.buckling_penetration(14) == pytest.approx(2.4e-4, rel=0.02)  # "14 at 2e-4"
