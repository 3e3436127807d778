"""Between the floor and a kinematic body that comes down: no impulse does what both ask, and nobody is shot away."""

import itertools
import math
import random

import pymunk
import pytest
from solve_world import ENGINE

import rigidarea as ra

DT = 1 / 60
#: How much faster than what comes down, or falls, anybody may be squeezed out: a disc under a piston's edge leaves as
#: a seed between two fingers does, the faster the flatter the wedge. Seen: 17; 7,500 while the search followed both.
SEEDS_SPEED = 30.0


def crusher(draw: random.Random) -> tuple[pymunk.Space, pymunk.Body, float]:
    """A room with one to four bodies under a piston, or beside a paddle that turns closer to the floor than they are
    high: (space, kinematic body, its speed).
    """
    space = pymunk.Space()
    space.gravity = 0, -900
    corners = [(0, 0), (400, 0), (400, 400), (0, 400), (0, 0)]
    for a, b in itertools.pairwise(corners):
        space.add(pymunk.Segment(space.static_body, a, b, 5))
    size = draw.uniform(8, 16)
    gap = 2 * size * draw.uniform(0.1, 1)
    body = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    piston = draw.random() < 1 / 3
    if piston:
        speed = draw.uniform(50, 400)
        body.position, body.velocity = (200, 200), (0, -speed)
        shape = pymunk.Poly.create_box(body, (60, 100))
        body.lowest = 55 + gap
    else:
        arm, turn = draw.uniform(60, 120), draw.choice((-1, 1)) * draw.uniform(1, 6)
        body.position, body.angular_velocity, speed = (200, 5 + gap + arm), turn, abs(turn) * arm
        shape = pymunk.Poly(body, [(-arm, -6), (arm, -6), (arm, 6), (-arm, 6)])
    space.add(body, shape)
    for i in range(draw.randint(1, 4)):
        one = pymunk.Body(1, pymunk.moment_for_circle(1, 0, size))
        one.position = 200 + draw.uniform(-1, 1) * (30 if piston else 80), 5 + size + 2 * size * i
        square = pymunk.Poly.create_box(one, (2 * size, 2 * size))
        space.add(one, pymunk.Circle(one, size) if draw.random() < 0.6 else square)
    for shape in space.shapes:
        shape.friction, shape.elasticity = 0.5, 0.2
    return space, body, speed


@pytest.mark.skipif(ENGINE == "pymunk", reason="leaves the room with twelve of 150")
@pytest.mark.parametrize("seed", [*range(10), 106, 232, 286])  # the last three: up to 5e6 px/s were seen
def test_nobody_is_shot_away(seed):
    """Three seconds: everything is finite, and nobody is faster than SEEDS_SPEED times what presses and falls."""
    space, crushing, speed = crusher(random.Random(seed))
    ra.attach(space)
    bodies = [b for b in space.bodies if b is not crushing]
    fastest = 0.0
    for _ in range(180):
        if crushing.velocity.y < 0 and crushing.position.y <= crushing.lowest:
            crushing.velocity = 0, 0
        space.step(DT)
        fastest = max(fastest, *(b.velocity.length for b in bodies))
        assert all(math.isfinite(sum(b.position)) for b in bodies)
    falls = math.sqrt(2 * 900 * 200)
    assert fastest <= SEEDS_SPEED * math.hypot(speed, falls)


@pytest.mark.skipif(ENGINE == "pymunk", reason="of area contact's stiffness")
@pytest.mark.parametrize("aside", [3.0, 11.0])
@pytest.mark.parametrize("disc", [True, False])
def test_what_a_kinematic_body_presses_into_a_wall_bears_no_more_than_a_bed(disc, aside):
    """Deeper than a tenth of itself no stiffness is right: thirty times the load, and what closing adds, not k A.

    (k A would be 34,000 weights of the disc here, 2,300 of the box; it bears 190 at the most.)
    """
    space = pymunk.Space()
    space.gravity = 0, -900
    for a, b in (((490, -200), (490, 500)), ((0, 0), (500, 0))):
        space.add(pymunk.Segment(space.static_body, a, b, 10))
    one = pymunk.Body(3.4, pymunk.moment_for_circle(3.4, 0, 20))
    one.position = 459, 31
    space.add(one, pymunk.Circle(one, 20) if disc else pymunk.Poly.create_box(one, (40, 40)))
    drive = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    drive.position, drive.velocity = (400, 31 + aside), (20, 0)
    press = pymunk.Poly.create_box(drive, (60, 30))
    space.add(drive, press)
    for shape in space.shapes:
        shape.friction = 0.5
    contact = ra.attach(space)
    most, seen = 0.0, 0
    for _ in range(240):
        space.step(DT)
        for region in contact.regions:
            if press in (region["shape_a"], region["shape_b"]) and region["area"] > 300.0:
                most, seen = max(most, region["force"] / (one.mass * 900)), seen + 1
    assert seen > 60 and most < 300.0


def _under_heavy_balls(seed: int, ratio: float, radius: float, slope: float) -> int:
    """How many of 40 small balls on a floor, level or sloped, get below it as three heavy ones roll over them."""
    draw = random.Random(seed)
    space = pymunk.Space()
    space.gravity = 0, -900
    high, low = 400 * slope, -400 * slope
    for ends in (((-400, high), (400, low)), ((-400, high), (-400, 700)), ((400, low), (400, 700))):
        _material(pymunk.Segment(space.static_body, *ends, radius), space, draw)
    small = []
    for i in range(40):
        body = pymunk.Body(1, pymunk.moment_for_circle(1, 0, 6))
        body.position = -360 + 18 * i + draw.uniform(-2, 2), high + 30 + draw.uniform(0, 60)
        space.add(body)
        _material(pymunk.Circle(body, 6), space, draw)
        small.append(body)
    for k in range(3):
        body = pymunk.Body(ratio, pymunk.moment_for_circle(ratio, 0, 28))
        body.position = -300 + 250 * k, 300 + draw.uniform(0, 100)
        body.velocity = draw.uniform(-200, 200), 0
        space.add(body)
        _material(pymunk.Circle(body, 28), space, draw)
    ra.attach(space)
    under = set()
    for _ in range(420):
        space.step(DT)
        under |= {i for i, body in enumerate(small) if body.position.y + body.position.x * slope < 0}
    return len(under)


def _material(shape: pymunk.Shape, space: pymunk.Space, draw: random.Random) -> None:
    shape.friction = draw.choice((0, 0.3, 0.9))
    shape.elasticity = draw.choice((0, 0.5))
    space.add(shape)


@pytest.mark.parametrize("radius", [0.0, 3.0])
@pytest.mark.parametrize("slope", [0.0, 0.07])
@pytest.mark.parametrize("ratio, most", [(100, 0), (300, 0), (1000, 2)])
def test_heavy_balls_press_small_ones_through_no_floor(ratio, most, radius, slope):
    """Of 160 small balls nobody is below the floor; under a thousand times their weight 2 at most, measured 0 to 2.

    (By pymunk's own response one in eleven, of 3,840.)
    """
    assert sum(_under_heavy_balls(seed, ratio, radius, slope) for seed in range(4)) <= most
