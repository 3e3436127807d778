"""One physical term at a time, against exact answers (SI units; g = 10 m/s^2 unless said)."""

import math

import numpy as np
import pymunk
import pytest
from scipy.special import ellipk

import rigidarea as ra

G = 10.0
FLOOR = pymunk.Segment, (-100.0, 0.0), (100.0, 0.0), 0.0


def world(gravity=(0.0, -G), **settings):
    space = pymunk.Space()
    space.gravity = gravity
    return space, ra.attach(space, **settings)


def floor(space, angle=0.0, friction=1.0, elasticity=1.0):
    """A line through the origin, rising by `angle`; pair values are then those of the other shape."""
    along = pymunk.Vec2d(100, 0).rotated(angle)
    shape = pymunk.Segment(space.static_body, -along, along, 0)
    shape.friction, shape.elasticity = friction, elasticity
    space.add(shape)
    return shape


def box(space, position, width=1.0, height=1.0, mass=1.0, angle=0.0, friction=0.0, elasticity=0.0):
    body = pymunk.Body(mass, pymunk.moment_for_box(mass, (width, height)))
    body.position, body.angle = position, angle
    shape = pymunk.Poly.create_box(body, (width, height))
    shape.friction, shape.elasticity = friction, elasticity
    space.add(body, shape)
    return body


def disc(space, position, radius=0.5, mass=1.0, friction=0.0, elasticity=0.0, tolerance=None):
    body = pymunk.Body(mass, pymunk.moment_for_circle(mass, 0, radius))
    body.position = position
    shape = pymunk.Circle(body, radius)
    if tolerance:
        shape.outline = ra.Outline.from_pymunk(shape, tolerance)
    shape.friction, shape.elasticity = friction, elasticity
    space.add(body, shape)
    return body


def flight_energy(body, h, inertia=True):
    """m v^2/2 + m g y + I w^2/2 of free flight; the term in h makes it exact for symplectic Euler."""
    m, v = body.mass, body.velocity
    energy = 0.5 * m * v.dot(v) + m * G * (body.position.y + 0.5 * h * v.y)
    return energy + (0.5 * body.moment * body.angular_velocity**2 if inertia else 0.0)


def run(contact, seconds, frame=1 / 60):
    for _ in range(round(seconds / frame)):
        contact.step(frame)


# --- the force ---


@pytest.mark.parametrize("kind", ["box", "disc", "capsule", "tilted floor"])
def test_at_rest_the_area_carries_the_weight(kind):
    space, contact = world(stiffness=2e4)
    tilt = 0.3 if kind == "tilted floor" else 0.0
    floor(space, tilt)
    up = pymunk.Vec2d(0, 1).rotated(tilt)
    if kind == "capsule":
        body = pymunk.Body(3.0, 1.0)
        body.position = 0, 0.25
        shape = pymunk.Segment(body, (-0.5, 0), (0.5, 0), 0.25)
        space.add(body, shape)
    elif kind == "disc":
        body = disc(space, up * 0.5, mass=3.0)
    else:
        body = box(space, up * 0.5, mass=3.0, angle=tilt, friction=1.0)
    run(contact, 4.0)
    (region,) = contact.regions
    weight = body.mass * G * math.cos(tilt)
    # settled dashpots leave rounding of positions (1e-16 m of a depth of 1e-3 m), ended sweeps a little more
    assert region["force"] == pytest.approx(weight, rel=1e-6)
    assert region["area"] == pytest.approx(weight / 2e4, rel=1e-4)  # at rest it sinks no more
    assert region["direction"] == pytest.approx(tuple(up), abs=1e-9)
    # along the direction turned by +90 degrees, which is down the slope
    assert region["friction"] == pytest.approx(-body.mass * G * math.sin(tilt), rel=1e-6, abs=1e-9)


def test_stack_interface_i_carries_what_is_above_it():
    n = 6
    space, contact = world()
    floor(space)
    bodies = [box(space, (0, 0.5 + i), mass=1.0 + i, friction=0.5) for i in range(n)]
    run(contact, 8.0)
    masses = [b.mass for b in bodies]
    forces = sorted(contact.regions["force"], reverse=True)
    exact = [G * sum(masses[i:]) for i in range(n)]
    assert forces == pytest.approx(exact, rel=1e-6)  # a solve ends at 4e-7, sooner or later


@pytest.mark.parametrize("slope", [0.3, 0.8])
def test_v_groove(slope):
    """A disc in a groove whose two walls rise at +-slope: N = m g / (2 cos slope)."""
    space, contact = world()
    for side in (-1, 1):
        wall = pymunk.Segment(space.static_body, (0, 0), (side * 10, 10 * math.tan(slope)), 0)
        space.add(wall)
    disc(space, (0, 0.5 / math.cos(slope)), mass=2.0, tolerance=1e-6)
    run(contact, 3.0)
    exact = 2.0 * G / (2 * math.cos(slope))
    assert list(contact.regions["force"]) == pytest.approx([exact, exact], rel=1e-6)


# --- restitution ---


@pytest.mark.parametrize("e", [0.3, 0.8, 1.0])
def test_apexes_of_a_bouncing_ball_fall_by_e_squared(e):
    h0, h = 1.0, 5e-6
    space, _ = world(stiffness=1e10, integration="explicit")
    floor(space)
    ball = disc(space, (0, 0.5 + h0), elasticity=e, tolerance=1e-5)
    apexes, apex = [], None
    while len(apexes) < 3:
        space.step(h)
        if ball.position.y > 0.5 + 1e-4:
            apex = flight_energy(ball, h) / G - 0.5
        elif apex is not None and ball.velocity.y > 0:
            apexes.append(apex)
            apex = None
    assert abs(ball.angular_velocity) < 1e-9
    for i, found in enumerate(apexes):
        # half the 0.002 of restitution that the issue allows, i times over: 2 i 0.001 / e of the height; what is
        # left of it here is gravity's work on damping (g times 1e-3 s in touch, over 1 m/s) and facets of 1e-5 m
        assert found == pytest.approx(e ** (2 * i) * h0, rel=2 * i * 0.001 / e + 1e-9, abs=1e-5)


@pytest.mark.parametrize("e", [0.1, 0.5, 1.0])
def test_disc_hits_a_bar_off_centre(e):
    """J = (1 + e) v / (1/m + 1/M + d^2/I), d the arm of the hit on the bar."""
    m, big, d, v = 1.0, 3.0, 0.8, 2.0
    space, _ = world((0, 0), stiffness=1e7, integration="explicit")
    bar = box(space, (0, 0), width=2.0, height=0.2, mass=big, elasticity=1.0)
    ball = disc(space, (d, 0.1 + 0.25 + 0.001), radius=0.25, mass=m, elasticity=e, tolerance=1e-5)
    ball.velocity = 0, -v
    for _ in range(4000):
        space.step(2e-6)
    impulse = (1 + e) * v / (1 / m + 1 / big + d**2 / bar.moment)
    # the bar turns by some 1e-3 while in touch
    assert ball.velocity.y + v == pytest.approx(impulse / m, rel=3e-3)
    assert bar.velocity.y == pytest.approx(-impulse / big, rel=3e-3)
    assert bar.angular_velocity == pytest.approx(-impulse * d / bar.moment, rel=3e-3)


@pytest.mark.parametrize("offset", [0.0, 0.3, 0.7, 0.9])
def test_equal_discs_meet_obliquely(offset):
    """Frictionless, e = 1: the velocities' components along the line of centres are exchanged."""
    space, _ = world((0, 0), stiffness=1e6)
    a = disc(space, (-1.01, 0), elasticity=1.0, tolerance=1e-5)
    b = disc(space, (0, offset), elasticity=1.0, tolerance=1e-5)
    a.velocity = 1, 0
    for _ in range(12000):
        space.step(1e-4)
    n = pymunk.Vec2d(math.sqrt(1 - offset**2), offset)
    # the discs sink 1e-2 m at most, which turns the line of centres while they touch
    assert tuple(b.velocity) == pytest.approx(tuple(n * n.x), abs=5e-3)
    assert tuple(a.velocity + b.velocity) == pytest.approx((1, 0), abs=1e-12)
    assert a.angular_velocity == pytest.approx(0, abs=5e-3) and b.angular_velocity == pytest.approx(
        0, abs=5e-3
    )


def test_newtons_cradle_with_gaps():
    """Equal balls a gap apart: each hit hands the whole velocity on; the last one leaves alone."""
    space, contact = world((0, 0), stiffness=1e6)
    balls = [disc(space, (1.02 * i, 0), elasticity=1.0) for i in range(5)]
    balls[0].velocity = 2, 0
    run(contact, 0.5)
    speeds = [b.velocity.x for b in balls]
    # five hits, each to 0.002 (the default step); energy among them is shared by squares
    assert speeds == pytest.approx([0, 0, 0, 0, 2], abs=0.01)
    assert sum(speeds) == pytest.approx(2, abs=1e-12)


# --- energy ---


def drift(h, seconds=2.0):
    """Largest relative change of the flight energy of a tilted box that bounces without friction, e = 1."""
    space, contact = world(stiffness=5e4, integration="explicit")
    floor(space)
    body = box(space, (0, 1.5), angle=0.3, elasticity=1.0)
    rest = body.mass * G * 0.5  # energies are counted from the lying box
    first = flight_energy(body, h) - rest
    worst, bounces, touching = 0.0, 0, False
    for _ in range(round(seconds / h)):
        space.step(h)
        touches = bool(len(contact.regions)) if touching or body.position.y < 0.75 else False
        bounces += touches and not touching
        touching = touches
        if not touches:
            worst = max(worst, abs(flight_energy(body, h) - rest - first) / first)
    assert bounces >= 3
    return worst


def test_energy_drift_of_a_bouncing_tilted_box_falls_with_the_step():
    steps = np.array([1 / 1000, 1 / 2000, 1 / 4000, 1 / 8000])
    drifts = [drift(h) for h in steps]
    order = np.polyfit(np.log(steps), np.log(drifts), 1)[0]
    assert order >= 1.0, drifts
    assert drifts[-1] <= 2e-3, drifts  # the bound


def test_energy_with_what_contacts_store_is_conserved_in_an_impact():
    """contact.energy() all through an elastic landing: the error is that of symplectic Euler, first order in h."""
    errors = []
    steps = np.array([1e-3, 5e-4, 2.5e-4])
    for h in steps:
        space, contact = world(stiffness=1e4, integration="explicit")
        floor(space)
        box(space, (0, 0.8), angle=0.5, elasticity=1.0)
        first, worst = contact.energy(), 0.0
        for _ in range(round(0.4 / h)):
            space.step(h)
            worst = max(worst, abs(contact.energy() - first))
        errors.append(worst / (G * 0.3))
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] > 0.9, errors
    assert errors[-1] < 0.02, errors


def corner_on_corner(law, h):
    """Energy change of two diamonds that meet corner to corner, one off the other's axis."""
    space, contact = world((0, 0), stiffness=1e4, law=law, length=0.5, integration="explicit")
    a = box(space, (0, 0), angle=math.pi / 4, elasticity=1.0)
    b = box(space, (0.2, 1.45), angle=math.pi / 4, elasticity=1.0)
    a.moment = b.moment = math.inf  # corners stay parallel: the overlap is a rectangle p x q, and F = k p q
    b.velocity = -4, -2
    first = contact.energy()
    touched = False
    for _ in range(round(0.6 / h)):
        space.step(h)
        if len(contact.regions):
            touched = True
        elif touched:
            break
    assert touched and not len(contact.regions)
    assert a.velocity.length > 0.1
    return abs(contact.energy() - first) / first


def test_energy_law_conserves_corner_on_corner_where_the_area_law_does_not():
    steps = np.array([4e-4, 2e-4, 1e-4, 5e-5])
    energy = [corner_on_corner("energy", h) for h in steps]
    area = [corner_on_corner("area", h) for h in steps]
    assert energy[-1] < 1e-3 and energy[-1] < 0.5 * energy[0], energy
    # no step helps the area law: what it gains or loses is there in the limit
    assert area[-1] == pytest.approx(area[-2], rel=0.1) and area[-1] > 10 * energy[-1], (area, energy)


def test_energy_law_acts_along_the_line_that_its_gradient_has():
    """Turning corners: a force through any other line does work that U = k A^2 / (2 l) does not know."""
    errors = []
    steps = np.array([2e-4, 1e-4, 5e-5, 2.5e-5])
    for h in steps:
        space, contact = world((0, 0), stiffness=1e4, law="energy", length=0.5, integration="explicit")
        a = box(space, (0, 0), angle=math.pi / 4, elasticity=1.0)
        b = box(space, (0.3, 1.35), angle=math.pi / 4 + 0.5, elasticity=1.0)
        b.velocity, b.angular_velocity = (-2, -2), 3.0
        first, touched, worst = contact.energy(), 0, 0.0
        for _ in range(round(0.3 / h)):
            space.step(h)
            touched += len(contact.regions)
            worst = max(worst, abs(contact.energy() - first) / first)
        assert touched * h > 0.02 and abs(a.angular_velocity) > 0.5
        errors.append(worst)
    # symplectic Euler's own error within a contact is of first order; a wrong line leaves a rest at h = 0
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] > 0.9, errors


# --- friction ---


@pytest.mark.parametrize("shape", ["box", "disc"])
def test_sliding_stops_after_v_squared_over_2_mu_g(shape):
    mu, v = 0.4, 2.0
    space, contact = world()
    floor(space)
    if shape == "box":
        body = box(space, (0, 0.5), friction=mu, width=2.0, height=0.2 * 5)
    else:  # a disc that may not turn
        body = disc(space, (0, 0.5), friction=mu)
        body.moment = math.inf
    run(contact, 1.0)
    start = body.position.x
    body.velocity = v, 0
    run(contact, 1.5)
    # the friction spring gives back its own stretch, some 1e-4 m
    assert body.position.x - start == pytest.approx(v**2 / (2 * mu * G), rel=2e-3)
    assert abs(body.velocity.x) < 1e-6


@pytest.mark.parametrize("theta", [0.2, 0.5])
def test_block_on_an_incline_holds_for_ever_just_below_the_limit(theta):
    mu = 1.02 * math.tan(theta)
    space, contact = world()
    floor(space, theta)
    body = box(space, pymunk.Vec2d(0, 0.25).rotated(theta), width=2.0, height=0.5, angle=theta, friction=mu)
    run(contact, 7.0)  # the stiffness follows the load, and friction's spring the stiffness
    start = body.position
    run(contact, 60.0)
    # no creep: a spring holds it, not a dashpot; only rounding (1e-16 m a step) may move it
    assert (body.position - start).length < 1e-9
    assert contact.regions[0]["friction"] == pytest.approx(-G * math.sin(theta), rel=1e-6)


@pytest.mark.parametrize("theta", [0.2, 0.5])
def test_block_on_an_incline_slides_just_above_the_limit(theta):
    mu = 0.9 * math.tan(theta)
    space, contact = world()
    floor(space, theta)
    body = box(space, pymunk.Vec2d(0, 0.25).rotated(theta), width=2.0, height=0.5, angle=theta, friction=mu)
    run(contact, 1.0)
    down = pymunk.Vec2d(-1, 0).rotated(theta)
    first = body.velocity.dot(down)
    run(contact, 1.0)
    gained = body.velocity.dot(down) - first
    assert gained == pytest.approx(G * (math.sin(theta) - mu * math.cos(theta)), rel=1e-3)


@pytest.mark.parametrize("elasticity", [1.0, 0.0])
@pytest.mark.parametrize("share", [1.5, 0.5])
def test_disc_on_an_incline_rolls_if_mu_exceeds_a_third_of_the_slope(share, elasticity):
    theta = 0.4
    mu = share * math.tan(theta) / 3
    space, contact = world()
    floor(space, theta)
    body = disc(space, pymunk.Vec2d(0, 0.5).rotated(theta), tolerance=1e-6)
    run(contact, 0.3)  # it comes to rest on the line, which e = 1 would not let it
    (shape,) = body.shapes
    shape.friction, shape.elasticity = mu, elasticity
    body.velocity, body.angular_velocity = (0, 0), 0
    run(contact, 0.2)
    down = pymunk.Vec2d(-1, 0).rotated(theta)
    first, spin = body.velocity.dot(down), body.angular_velocity
    run(contact, 1.0)
    acceleration = body.velocity.dot(down) - first
    turning = body.angular_velocity - spin
    if share > 1:
        exact, exact_turning = 2 / 3 * G * math.sin(theta), 2 / 3 * G * math.sin(theta) / 0.5
    else:
        normal = G * math.cos(theta)
        exact, exact_turning = G * math.sin(theta) - mu * normal, mu * normal * 0.5 / body.moment
    # facets of 1e-6 m sagitta shake the normal force a little
    assert acceleration == pytest.approx(exact, rel=5e-3)
    assert turning == pytest.approx(exact_turning, rel=5e-3)


@pytest.mark.parametrize(
    "share",
    [
        0.95,
        pytest.param(
            1.05,
            marks=pytest.mark.xfail(reason="leans 0.51 after 4 s, at 64 substeps a frame 1.08", strict=True),
        ),
    ],
)
def test_box_tips_when_the_slope_exceeds_width_over_height(share):
    width, height = 0.4, 1.0
    theta = share * math.atan(width / height)
    # The edge that carries must be short against the margin, 5 % of half the width: a triangle of 3 x 0.01 m; its
    # depth over its length, 2 m g / (k L^2), is then the lean.
    space, contact = world(stiffness=1e7)
    floor(space)
    body = box(space, (0, height / 2 - 2.5e-6), width, height, friction=2.0)
    for i in range(240):  # gravity leans over slowly: let go at once, the box would swing past its balance
        space.gravity = pymunk.Vec2d(0, -G).rotated(theta * min(1.0, i / 180))
        contact.step(1 / 60)
    if share < 1:
        run(contact, 2.0)
        assert 0 < abs(body.angle) < 3e-3  # 2 x 10 N / (1e7 Pa x (0.03 m)^2) = 2e-3
    else:
        assert abs(body.angle) > 1.0


def test_housner_quarter_period_of_a_rocking_block():
    """T/4 = arccosh[1 / (1 - tilt/alpha)] / p, p = sqrt(3 g / 4 R) (Housner 1963), slender block."""
    half_width, half_height = 0.1, 1.0
    reach, alpha = math.hypot(half_width, half_height), math.atan2(half_width, half_height)
    tilt = 0.4 * alpha
    space, contact = world(stiffness=1e8)
    floor(space)
    # about its lower right corner, which stands at the origin
    place = pymunk.Vec2d(-half_width, half_height).rotated(-tilt)
    body = box(space, place, 2 * half_width, 2 * half_height, angle=-tilt, friction=1.0)
    body.position -= 0, 2e-4  # the corner's own sinking: k d^2 (tan + cot)/2 = m g
    t, h = 0.0, 1e-3
    while body.angle < 0:
        space.step(h)
        t += h
        assert t < 2.0
    exact = math.acosh(1 / (1 - tilt / alpha)) / math.sqrt(3 * G / (4 * reach))
    # sin(alpha - tilt) was taken for its argument: alpha^2/6 = 0.2 %; the rest is the corner's bounce
    assert t == pytest.approx(exact, rel=0.01)
    assert contact.stiffness == 1e8


# --- concave outlines ---


def bowl(space, radius, tolerance):
    """A block with a semicircular trough around the origin; vertices lie on the arc."""
    n = math.ceil(math.pi / (2 * math.acos(1 - tolerance / radius)))
    angle = np.linspace(math.pi, 2 * math.pi, n + 1)
    arc = radius * np.column_stack((np.cos(angle), np.sin(angle)))
    rim = radius + 1
    outline = ra.Outline([(-rim, 0), *arc[:-1], arc[-1], (rim, 0), (rim, -rim), (-rim, -rim)])
    shape = outline.add_to(space.static_body, elasticity=1.0, friction=1.0)
    space.add(shape)
    return outline


@pytest.mark.parametrize("rolling", [False, True])
@pytest.mark.parametrize("elasticity", [1.0, 0.0])
def test_period_of_a_disc_in_a_circular_bowl(rolling, elasticity):
    """T = 4 sqrt(rho/g) K(sin^2(amplitude/2)); rolling without slip sqrt(3/2) times that."""
    radius, small, amplitude = 2.0, 0.5, 0.8
    rho = radius - small
    space, _ = world(stiffness=1e5)
    bowl(space, radius, 1e-5)
    place = pymunk.Vec2d(0, -rho).rotated(amplitude)
    body = disc(space, place, small, 1.0, 1.0 if rolling else 0.0, elasticity, tolerance=1e-5)
    h, t = 1e-4, 0.0
    crossings = []
    before = body.position.x
    while len(crossings) < 3:
        space.step(h)
        t += h
        if before > 0 >= body.position.x or before < 0 <= body.position.x:
            crossings.append(t)
        before = body.position.x
        assert t < 10
    period = crossings[2] - crossings[0]
    exact = 4 * math.sqrt(rho / G) * ellipk(math.sin(amplitude / 2) ** 2) * (math.sqrt(1.5) if rolling else 1)
    # it sinks 1e-3 m or so, so rho is 1e-3 longer: half that in the period; and it bounces on facets
    assert period == pytest.approx(exact, rel=2e-3)


ELL = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)]
CUP = [(0, 0), (3, 0), (3, 3), (2, 3), (2, 1), (1, 1), (1, 3), (0, 3)]
RING = [(-1.5, -1.5), (1.5, -1.5), (1.5, 1.5), (-1.5, 1.5)]


def cloud(space, offset=(0.0, 0.0), drift=(0.0, 0.0), seed=1, friction=0.5):
    rng = np.random.default_rng(seed)
    bodies = []
    for i in range(18):
        points, holes = [(ELL, ()), (CUP, ()), (RING, [np.array(RING) * 0.6])][i % 3]
        outline = ra.Outline(points, holes)
        body = outline.body(density=1.0)
        place = np.array([4.0 * (i % 6), 4.0 * (i // 6)]) + offset
        place = np.round(place * 2**20) / 2**20
        body.position = tuple(place)
        body.angle = rng.uniform(0, 6)
        body.velocity = tuple(rng.normal(0, 2, 2) - 0.3 * (place - offset - (10, 4)) + drift)
        body.angular_velocity = rng.normal()
        space.add(body, outline.add_to(body, elasticity=0.9, friction=friction))
        bodies.append(body)
    return bodies


def momentum(bodies, about=(0.0, 0.0)):
    linear, angular = np.zeros(2), 0.0
    for b in bodies:
        place = b.local_to_world(b.center_of_gravity) - about
        linear += b.mass * np.array(b.velocity)
        angular += b.mass * place.cross(b.velocity) + b.moment * b.angular_velocity
    return linear, angular


@pytest.mark.parametrize("direction", ["chord", "nodal"])
@pytest.mark.parametrize("law", ["area", "energy"])
def test_momentum_is_kept_in_a_cloud_of_concave_pieces(law, direction):
    space, contact = world((0, 0), stiffness=2e4, law=law, length=1.0, direction=direction)
    bodies = cloud(space)
    linear, angular = momentum(bodies)
    touched = 0
    for _ in range(1500):
        space.step(1e-3)
        touched += len(contact.regions)
    assert touched > 500
    scale = sum(b.mass * b.velocity.length for b in bodies)
    after = momentum(bodies)
    # rounding only: 1500 steps of 18 bodies, lengths of 20 m
    assert np.abs(after[0] - linear).max() < 1e-11 * scale
    assert abs(after[1] - angular) < 1e-11 * scale * 20


@pytest.mark.parametrize("integration", ["implicit", "explicit"])
def test_forces_do_not_know_where_or_how_fast_the_scene_is(integration):
    """Moved by 1e6 m, or drifting by 32 m/s: the same forces to 1e-6."""
    space, contact = world((0, 0), stiffness=2e4, integration=integration)
    home = cloud(space)
    while len(contact.regions) < 8:
        space.step(1e-3)
    results = []
    for offset, drift in (((0, 0), (0, 0)), ((2.0**20, -(2.0**20)), (0, 0)), ((0, 0), (32.0, -16.0))):
        space, contact = world((0, 0), stiffness=2e4, integration=integration)
        for old, body in zip(home, cloud(space, offset)):
            # multiples of 2^-20 m and 2^-10 m/s, steps of 2^-10 s: the move itself is exact
            place = np.round(np.array(old.position) * 2**20) / 2**20
            body.position = tuple(place + offset)
            body.angle = old.angle
            body.velocity = tuple(np.round(np.array(old.velocity) * 2**10) / 2**10 + drift)
            body.angular_velocity = old.angular_velocity
        space.step(2.0**-10)
        results.append(contact.regions)
    here, far, moving = results
    assert len(here) >= 8
    for other in (far, moving):
        assert other["force"] == pytest.approx(here["force"], rel=1e-6)
        assert other["friction"] == pytest.approx(here["friction"], rel=1e-6, abs=1e-6 * here["force"].max())
        assert other["direction"] == pytest.approx(here["direction"], abs=1e-6)
    # regions are those of the last substep: of two in the middle of the second, of one where the step ends
    time = 2.0**-10 * (0.75 if integration == "implicit" else 1.0)
    assert moving["centroid"] == pytest.approx(here["centroid"] + np.array((32, -16)) * time, abs=1e-9)


def test_direction_memory_of_a_ball_shot_past_the_middle_of_a_thin_plate():
    """Its centre goes through the plate's middle; it is pushed back out the way it came all the same.

    All the way through costs k times plate thickness times area of the body: 126 J for the disc, 160 J for the box.
    They have 98 J and 112 J: enough for the middle, at half, not for the other side.
    """
    for shape in ("disc", "box"):
        space, contact = world((0, 0), stiffness=1e4)
        plate = pymunk.Poly.create_box(space.static_body, (0.1, 10))
        plate.elasticity = 1.0
        space.add(plate)
        if shape == "disc":
            body = disc(space, (-1, 0), radius=0.2, elasticity=1.0)
        else:
            body = box(space, (-1, 0), width=0.4, height=0.4, elasticity=1.0)
        body.velocity = 15.0 if shape == "box" else 14.0, 0
        deepest = -math.inf
        for _ in range(20000):
            space.step(1e-5)
            deepest = max(deepest, body.position.x)
            for region in contact.regions:
                sign = -1 if region["body_b"] is body else 1
                assert region["direction"][0] * sign > 0  # body pushed to -x
        assert deepest > 0.02, (shape, deepest)  # past the plate's middle
        assert body.position.x < -0.25, shape
        # frictionless and e = 1: the energy comes back, to first order in the step
        assert body.velocity.x == pytest.approx(-15.0 if shape == "box" else -14.0, rel=2e-3)


@pytest.mark.parametrize(
    "place, out", [((1.3, 0.2), (1, 0)), ((-1.4, 0), (-1, 0)), ((0.1, 1.45), (0, 1)), ((0, -1.3), (0, -1))]
)
@pytest.mark.parametrize("inner_first", [False, True])
def test_one_outline_inside_the_other_is_pushed_out_the_shortest_way(place, out, inner_first):
    space, contact = world((0, 0), stiffness=1e4)
    makers = [
        lambda: box(space, (0, 0), width=4.0, height=4.0, mass=50.0),
        lambda: box(space, place, width=0.5, height=0.5, angle=0.1),
    ]
    bodies = [make() for make in (makers[::-1] if inner_first else makers)]
    small = bodies[0] if inner_first else bodies[1]
    space.step(1e-3)
    pushed = small.velocity / small.velocity.length
    assert tuple(pushed) == pytest.approx(out, abs=1e-9)
    for _ in range(3000):
        space.step(1e-3)
    assert not len(contact.regions)


def test_nodal_direction_at_rest_and_on_a_disc():
    """Eq. 8-15 on symmetric contacts give the chord's direction; a box still rests on m g/k."""
    for exponent in (0.0, 1.0, 2.0):
        space, contact = world(stiffness=1e4, direction="nodal", exponent=exponent)
        floor(space)
        box(space, (0, 0.5), width=2.0)
        disc(space, (5, 0.5))
        run(contact, 3.0)
        for region in contact.regions:
            assert region["force"] == pytest.approx(G, rel=1e-7)
            assert tuple(region["direction"]) == pytest.approx((0, 1), abs=1e-6)
