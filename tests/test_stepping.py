"""Steps: where the explicit one is stable, how frames converge, what any number of substeps holds and stands."""

import math

import numpy as np
import pymunk
import pytest

import rigidarea as ra

G = 10.0
K = 5e4


def world(stiffness=None, gravity=(0, -G), **settings):
    space = pymunk.Space()
    space.gravity = gravity
    line = pymunk.Segment(space.static_body, (-500, 0), (500, 0), 0)
    line.friction = line.elasticity = 1.0
    space.add(line)
    return space, ra.attach(space, stiffness, **settings)


def box(space, position, size=(1.0, 1.0), mass=1.0, friction=0.5, elasticity=0.0):
    body = pymunk.Body(mass, pymunk.moment_for_box(mass, size))
    body.position = position
    shape = pymunk.Poly.create_box(body, size)
    shape.friction, shape.elasticity = friction, elasticity
    space.add(body, shape)
    return body


def bounce_of_undamped_box(phase):
    """Largest height over rest of an undamped box that lies on a line, started 1 % of its sinking off, w h given.

    One degree of freedom: m = 1, stiffness k L = K, exactly linear while the face is in touch.
    """
    space, _ = world(K, integration="explicit")
    sink = G / K
    body = box(space, (0, 0.5 - sink * 1.01), friction=0.0, elasticity=1.0)
    body.moment = math.inf
    h = phase / math.sqrt(K)
    worst = 0.0
    for _ in range(4000):
        space.step(h)
        worst = max(worst, abs(body.position.y - 0.5 + sink))
    return worst / (0.01 * sink)


def test_stability_limit_of_a_single_contact_is_two():
    """Symplectic Euler on one spring: bounded below w h = 2, growing above. (Within 1 %: the bracket.)"""
    assert (
        bounce_of_undamped_box(1.98) < 15
    )  # bounded by 1 / sqrt(1 - (w h / 2)^2) = 7, twice over for the start
    assert bounce_of_undamped_box(2.02) > 1000  # grows by a factor of 1.33 a step until it leaves the line


def test_frames_of_any_length_tell_the_same_story():
    """1/30 and 1/120 s frames end alike, to the order of the step."""
    ends = []
    for frame in (1 / 30, 1 / 120):
        space, contact = world(K)
        body = box(space, (0, 1.0), elasticity=0.5, friction=0.3)
        body.velocity = 1, 0
        for _ in range(round(1.0 / frame)):
            contact.step(frame)
        ends.append(body.position)
    assert ends[0].x == pytest.approx(ends[1].x, rel=0.02)
    assert ends[0].y == pytest.approx(ends[1].y, abs=1e-3)


# --- second order ---


def test_frames_are_second_order_in_time():
    """A smooth pendulum of a disc in a round bowl's bottom, soft enough to be followed: error as the step squared."""

    def end(steps):
        space = pymunk.Space()
        space.gravity = 0, -G
        angle = np.linspace(0, 2 * np.pi, 400, endpoint=False)
        hole = 3 * np.column_stack((np.cos(angle), np.sin(angle)))
        bowl = ra.Outline([(-4, -4), (4, -4), (4, 4), (-4, 4)], [hole])
        space.add(bowl.add_to(space.static_body, elasticity=1.0))
        body = pymunk.Body(1, 1)
        body.position = 2.0 * math.sin(0.3), -2.0 * math.cos(0.3) - 0.01
        shape = pymunk.Circle(body, 1.0)
        shape.elasticity = 1.0
        space.add(body, shape)
        contact = ra.attach(space, 300.0, rest_speed=1e9)
        contact.step(0.1, 4, steps)
        return np.array(body.position)

    n = [16, 32, 64]
    best = end(1024)
    errors = [np.abs(end(i) - best).max() for i in n]
    order = -np.polyfit(np.log(n), np.log(errors), 1)[0]
    assert order > 1.7, errors  # first order was 1.0; facets of the bowl keep it from 2


@pytest.mark.parametrize("arguments", [(0,), (-2,), (1.5,), (1, 0), (1, -1), (True,)])
def test_bad_numbers_of_frames_and_steps(arguments):
    space, contact = world(K)
    box(space, (0, 3))
    with pytest.raises(ValueError, match=r"frames|steps"):
        contact.step(1 / 60, *arguments)


def test_after_a_frame_queries_see_where_the_bodies_are():
    space, contact = world(K)
    body = box(space, (0, 3))
    body.velocity = 10, 0
    contact.step(1 / 60)
    edge = body.position.x + 0.5
    assert space.point_query_nearest((edge - 1e-9, 3), 0, pymunk.ShapeFilter()).distance == pytest.approx(
        -1e-9, abs=1e-12
    )
    assert space.point_query_nearest((edge + 1e-3, 3), 0, pymunk.ShapeFilter()) is None


@pytest.mark.parametrize("stiffness", [1e6, 1e9, 1e12])
@pytest.mark.parametrize("steps", [1, 4])
def test_no_stiffness_is_too_high_for_a_step(stiffness, steps):
    """A box, a disc in a bowl's curve, and a pile at rest stay there; what they sink is what the step allows, g h^2."""
    space, contact = world(stiffness)
    h = 1 / 60 / steps
    bodies = [box(space, (3 * i, 0.5 + j)) for i, n in enumerate((1, 2, 3)) for j in range(n)]
    disc = pymunk.Body(1, 0.5)
    disc.position = -4, 1
    shape = pymunk.Circle(disc, 1.0)
    shape.friction = 0.5
    space.add(disc, shape)
    start = [b.position for b in (*bodies, disc)]
    contact.step(1 / 60, 240, steps)
    moved = [b.position - s for b, s in zip((*bodies, disc), start)]
    # of three boxes the lowest carries three weights, on contacts so soft that (w h)^2 summed over a body's is 1:
    # 3 g on the floor's share of 1 + 2, 2 g and 1 g on the pairs' shares
    assert max(m.length for m in moved) < 24 * G * h**2 + 1e-4
    assert max(b.velocity.length for b in (*bodies, disc)) < 0.05


@pytest.mark.parametrize("steps", [1, 4])
def test_a_stiff_contact_at_rest_is_exact_at_any_step(steps):
    """Sinking m g / (k L) to 1e-6 of the size; a bar over two supports; a block on a slope 10 % short of tipping."""
    slope = math.atan(0.9 * 0.5)
    for tilt in (0.0, slope):
        space, contact = world(1e8, gravity=(G * math.sin(tilt), -G * math.cos(tilt)))
        block = box(space, (0, 0.5), (0.5, 1.0), friction=2.0)
        for x in (9, 11):
            post = pymunk.Poly(space.static_body, [(x, 0), (x + 0.5, 0), (x + 0.5, 1), (x, 1)])
            post.friction = 2.0
            space.add(post)
        bar = box(space, (10.25, 1.1), (4.0, 0.2), friction=2.0)
        start = [block.position, bar.position]
        contact.step(1 / 60, 180, steps)
        # on the slope a face tips a little before it holds, and the bar's two contacts learn of each other within a
        # few steps: second order in the step
        for body, at, near in zip(
            (block, bar), start, (1e-6 if tilt == 0.0 else 0.01 / steps**2, 0.01 / steps**2)
        ):
            assert (body.position - at).length < near and abs(body.angle) < near
            assert body.velocity.length < 10 * near


def test_friction_at_any_step_stops_and_holds():
    """A block thrown over a floor stops after v^2 / 2 mu g: second order in the step, and then never moves."""
    far = []
    for steps in (2, 4):
        space, contact = world(1e8)
        body = box(space, (0, 0.5), friction=0.4)
        body.velocity = 3, 0
        contact.step(1 / 60, 120, steps)
        far.append(abs(body.position.x - 9 / (2 * 0.4 * G)))
        at = body.position
        contact.step(1 / 60, 30, steps)
        assert (body.position - at).length < 1e-8
    assert far[0] < 1e-3 and far[1] < 1e-3


@pytest.mark.parametrize("e", [0.0, 0.3, 0.6, 1.0])
def test_an_impact_too_short_for_the_step_is_an_impulse(e):
    """Oblique hit of a disc on a free bar off its centre, one step a frame: J = (1 + e) v / (1/m + 1/M + d^2/I)."""
    space = pymunk.Space()
    disc, bar = pymunk.Body(1, 0.02), pymunk.Body(2, 2 * (2.0**2 + 0.2**2) / 12)
    disc.position, disc.velocity = (0.6, 1.0), (0, -3)
    shapes = pymunk.Circle(disc, 0.2), pymunk.Poly.create_box(bar, (2.0, 0.2))
    shapes[0].elasticity, shapes[1].elasticity = e, 1.0
    space.add(disc, bar, *shapes)
    contact = ra.attach(space, 1e9)
    contact.step(1 / 60, 30, 1)
    near = 1e-9 if e > 0.5 else 0.03  # slow to leave, they are still in touch while the bar turns on
    impulse = (1 + e) * 3 / (1 / 1 + 1 / 2 + 0.6**2 / bar.moment)
    assert disc.velocity.y == pytest.approx(-3 + impulse, abs=near)
    assert bar.velocity.y == pytest.approx(-impulse / 2, abs=near)
    assert bar.angular_velocity == pytest.approx(-0.6 * impulse / bar.moment, abs=near)


# --- standing ---


def tower(space, n, friction=0.5):
    return [box(space, (0, 0.5 + i), friction=friction) for i in range(n)]


def stands(space, contact, bodies, seconds, sag):
    start = [b.position for b in bodies]
    for _ in range(round(seconds * 60)):
        contact.step(1 / 60)
    moved = [b.position - s for b, s in zip(bodies, start)]
    assert max(abs(m.x) for m in moved) < sag and max(abs(b.angle) for b in bodies) < sag
    assert -sag < min(m.y for m in moved) and max(m.y for m in moved) < 1e-9
    return moved


def test_a_ten_box_stack_stands_for_a_minute():
    space, contact = world()
    bodies = tower(space, 10)
    # 55 weights of 2e-4 m of sinking in all: 0.011 m
    stands(space, contact, bodies, 60, 0.0115)
    assert max(b.velocity.length for b in bodies) < 1e-6
    before = [b.position for b in bodies]
    for _ in range(600):
        contact.step(1 / 60)
    assert max((b.position - p).length for b, p in zip(bodies, before)) < 1e-8  # no creep


@pytest.mark.parametrize("depth", [0.01, 0.1, 0.4])
@pytest.mark.parametrize("steps", [None, 1, 8])
def test_a_body_put_inside_another_is_let_out_not_shot_out(depth, steps):
    """No higher than a few depths, and in the end it lies on the face."""
    space, contact = world(K)
    slab = pymunk.Poly(space.static_body, [(-3, 0), (3, 0), (3, 3), (-3, 3)])
    slab.friction = 0.5
    space.add(slab)
    body = box(space, (0, 3.5 - depth))
    heights = []
    for _ in range(240):
        contact.step(1 / 60, 1, steps)
        heights.append(body.position.y)
    assert max(heights) < 3.5 + 8 * depth
    assert heights[-1] == pytest.approx(3.5, abs=2e-3)


@pytest.mark.parametrize("gravity", [0.0, 900.0])
def test_what_hardly_moves_takes_one_substep(gravity):
    """Six crates seen from above, or on a floor, touching and at rest but for a creep: weight has no part in that."""
    space = pymunk.Space()
    space.gravity = 0, -gravity
    if gravity:
        space.add(pymunk.Segment(space.static_body, (-100, -20), (400, -20), 5))
    for i in range(6):
        crate = pymunk.Body(1, 150)
        crate.position = 29.99 * i, 0
        crate.velocity = 1e-3, 0
        space.add(crate, pymunk.Poly.create_box(crate, (30, 30)))
    contact = ra.attach(space)
    contact.step(1 / 60, frames=300)
    assert contact.step(1 / 60) == 1


@pytest.mark.parametrize("elasticity", [0.0, 1.0])
def test_without_weight_a_blow_is_the_same_at_any_speed(elasticity):
    """A disc hits a row of six that touch at 20, 1, .05 px/s: the same parts of its speed (no scale but rounding's)."""
    found = []
    for speed in (20.0, 1.0, 0.05):
        space = pymunk.Space()
        discs = []
        for i in range(7):
            disc = pymunk.Body(1, 50)
            disc.position = 20.0 * i + (0 if i else -1e-3 - 0.02 * speed), 0
            shape = pymunk.Circle(disc, 10)
            shape.elasticity = elasticity
            space.add(disc, shape)
            discs.append(disc)
        discs[0].velocity = speed, 0
        ra.attach(space).step(1 / 60, frames=30)
        found.append([disc.velocity.x / speed for disc in discs])
    assert found[0] == pytest.approx(found[1], abs=0.005)  # of the tolerances of a solve
    assert found[0] == pytest.approx(found[2], abs=0.005)
