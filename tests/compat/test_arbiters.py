"""What arbiters say with area contact, beside what pymunk's own solver makes them say: random sweeps, fixed seeds."""

import itertools
import math
import random

import pymunk
import pytest

import rigidarea as ra

DT = 1 / 60
SEEDS = range(12)


def landed(seed, engine, gap=-1e-3, angle=0.0):
    """A disc or a box just in touch with a floor that leans by `angle`; random size, mass, friction, gravity."""
    draw = random.Random(seed)
    space = pymunk.Space()
    g, size, mass = draw.uniform(5, 900), draw.uniform(0.5, 30), draw.uniform(0.1, 50)
    space.gravity = 0, -g
    c, s = math.cos(angle), math.sin(angle)
    far = 100 * size
    floor = pymunk.Segment(space.static_body, (-far * c, -far * s), (far * c, far * s), 0.1 * size)
    floor.friction, floor.elasticity, floor.collision_type = draw.uniform(0.2, 1), draw.uniform(0, 1), 1
    disc = seed % 2 == 0
    moment = pymunk.moment_for_circle(mass, 0, size) if disc else pymunk.moment_for_box(mass, (2 * size,) * 2)
    body = pymunk.Body(mass, moment)
    up = (1.1 + gap) * size
    body.position, body.angle = (-up * s, up * c), angle
    shape = pymunk.Circle(body, size) if disc else pymunk.Poly.create_box(body, (2 * size, 2 * size))
    shape.friction, shape.collision_type = draw.uniform(0.2, 1), 2
    space.add(floor, body, shape)
    if engine == "area":
        ra.attach(space)
    return space, body, shape, floor


def told(arbiter):
    """All that an arbiter says before the solve."""
    points = arbiter.contact_point_set
    return [
        *arbiter.normal, *points.normal, arbiter.friction, arbiter.restitution, *arbiter.surface_velocity,
        arbiter.is_first_contact, arbiter.is_removal, arbiter.process_collision,
        *(value for p in points.points for value in (*p.point_a, *p.point_b, p.distance)),
    ]  # fmt: skip


@pytest.mark.parametrize("phase", ["begin", "pre_solve", "post_solve"])
@pytest.mark.parametrize("seed", SEEDS)
def test_places_and_materials_are_pymunks_own(seed, phase):
    """The same pair at the same place: normal, points, friction, restitution are the same numbers, in each phase."""
    found = []
    for engine in ("pymunk", "area"):
        space, body, shape, floor = landed(seed, engine)
        heard = []

        def hear(arbiter, space, data, heard=heard, shape=shape, floor=floor):
            assert arbiter.shapes == (floor, shape) and arbiter.bodies == (floor.body, shape.body)
            heard.append(told(arbiter))

        space.on_collision(1, 2, **{phase: hear})
        if engine == "pymunk":  # which moves bodies before it looks: as area contact looks where they are
            body.position_func = lambda body, dt: None
        space.step(DT)
        found.append(heard)
    assert len(found[0]) == len(found[1]) == 1
    native, own = found[0][0], found[1][0]
    if (
        phase == "post_solve"
    ):  # points are told by their bodies, which have moved by then: in free fall, at the most
        moved = 2 * space.gravity.length * DT**2
        assert own[11:] == pytest.approx(native[11:], abs=moved)
        native, own = native[:11], own[:11]
    assert own == pytest.approx(native, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("engine", ["pymunk", "area"])
@pytest.mark.parametrize("seed", SEEDS)
def test_the_impulse_is_what_changes_the_momentum(seed, engine):
    """Down a slope, from frame to frame: m (v' - v) - m g dt is the arbiter's impulse.

    To rounding, but for who comes to rest: it loses the last 1e-6 of what its weight gives in a frame.
    """
    space, body, *_ = landed(seed, engine, angle=0.3)
    frame = []

    def after(arbiter, space, data):
        frame.append((arbiter.total_impulse, arbiter.normal))

    space.on_collision(1, 2, post_solve=after)
    seen = 0
    for _ in range(60):
        before = body.velocity
        frame.clear()
        space.step(DT)
        given = body.mass * (body.velocity - before - space.gravity * DT)
        if frame:
            ((impulse, normal),) = frame
            sign = 1 if impulse.dot(given) > 0 else -1  # on which of the two: pymunk's choice, tested below
            scale = body.mass * (space.gravity.length * DT + before.length)
            assert (sign * impulse - given).length < (1e-6 if body.velocity == (0, 0) else 1e-9) * scale
            assert abs(given.dot(normal)) >= 0 and abs(normal.length - 1) < 1e-12
            seen += 1
    assert seen > 20


def against_each_other(arbiter):
    """Of `total_ke` (cpArbiterTotalKE) the part of friction at points whose sum is zero (Chipmunk's memory)."""
    contacts = [arbiter._arbiter.contacts[i] for i in range(arbiter._arbiter.count)]
    most = max(abs(c.jtAcc) for c in contacts)
    if len(contacts) < 2 or abs(sum(c.jtAcc for c in contacts)) > 1e-9 * most:
        return 0.0
    return sum(c.jtAcc**2 / c.tMass for c in contacts)


@pytest.mark.parametrize("seed", SEEDS)
def test_at_rest_it_carries_the_weight_and_says_so_as_pymunk_does(seed):
    """each_arbiter after two seconds: normal, impulse (direction too), energy, count as natively; m g dt to 1 %.

    Of pymunk's energy (a sum of squares over the points) without what the frictions of a box's two points do against
    each other: nothing slides, their sum is zero, and how much of it there is, is left over from how it landed.
    """
    answers = []
    for engine in ("pymunk", "area"):
        space, body, _shape, floor = landed(seed, engine)
        floor.elasticity = 0
        for _ in range(120):
            space.step(DT)
        rows = []
        body.each_arbiter(
            lambda a, rows=rows: rows.append(
                (
                    *(*a.normal, *a.total_impulse, a.total_ke - against_each_other(a)),
                    *(len(a.contact_point_set.points), a.is_first_contact),
                )
            )
        )
        (row,) = rows
        answers.append(row)
        assert math.hypot(row[2], row[3]) == pytest.approx(body.mass * space.gravity.length * DT, rel=0.01)
    native, own = answers
    scale = math.hypot(native[2], native[3])
    assert own[:2] == pytest.approx(native[:2], abs=1e-3)
    assert own[2:4] == pytest.approx(native[2:4], abs=0.01 * scale)
    assert own[4] == pytest.approx(native[4], rel=0.02)  # a square of what is right to 1 %
    assert own[5:] == native[5:]


@pytest.mark.parametrize("engine", ["pymunk", "area"])
@pytest.mark.parametrize("seed", SEEDS)
def test_grounding_as_pymunks_platformer_asks_it(seed, engine):
    """The steepest normal of `each_arbiter` points up while it stands, and nothing touches once it has jumped."""
    space, body, shape, _floor = landed(seed, engine)

    def ground():
        normals = []
        body.each_arbiter(lambda a: normals.append(-a.normal.y if a.shapes[0] is shape else a.normal.y))
        return normals

    for _ in range(60):
        space.step(DT)
    for _ in range(20):
        space.step(DT)
        assert max(abs(n) for n in ground()) > 0.99
    body.apply_impulse_at_local_point((0, body.mass * 0.5 * space.gravity.length))
    for _ in range(6):
        space.step(DT)
    assert ground() == []


@pytest.mark.parametrize("what", ["friction", "restitution", "surface_velocity"])
@pytest.mark.parametrize("seed", SEEDS)
def test_what_pre_solve_sets_is_obeyed(seed, what):
    """Against the same scene whose shapes had those values from the start: the same motion, to rounding."""
    value = {"friction": 0.0, "restitution": 0.7, "surface_velocity": (3.0, 0.0)}[what]
    ends = []
    for by_hand in (True, False):
        space, body, shape, floor = landed(seed, "area", gap=0.3 if what == "restitution" else -1e-3)
        body.velocity = 4, 0

        def change(arbiter, space, data, by_hand=by_hand):
            if by_hand:
                setattr(arbiter, what, value)

        space.on_collision(1, 2, pre_solve=change)
        if not by_hand:
            if what == "friction":
                shape.friction = 0.0
            elif what == "restitution":
                floor.elasticity = shape.elasticity = math.sqrt(0.7)
            else:
                floor.surface_velocity = -3.0, 0.0  # B's minus A's
        for _ in range(40):
            space.step(DT)
        ends.append([*body.position, body.angle, *body.velocity])
    assert ends[0] == pytest.approx(ends[1], rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("turn", [-0.4, 0.2, 0.5])
def test_a_normal_set_in_pre_solve_is_obeyed(turn):
    """As pymunk's breakout steers its ball: it is reflected by the normal that the paddle's callback says."""
    speeds = []
    for engine in ("pymunk", "area"):
        space = pymunk.Space()
        paddle = pymunk.Segment(space.static_body, (-50, 0), (50, 0), 8)
        paddle.elasticity, paddle.friction, paddle.collision_type = 1, 0, 1
        ball = pymunk.Body(1, math.inf)
        ball.position, ball.velocity = (0, 60), (0, -400)
        shape = pymunk.Circle(ball, 5)
        shape.elasticity, shape.friction, shape.collision_type = 1, 0, 2
        space.add(paddle, ball, shape)

        def steer(arbiter, space, data):
            points = arbiter.contact_point_set
            points.normal = pymunk.Vec2d(0, 1).rotated(turn)
            arbiter.contact_point_set = points

        space.on_collision(1, 2, pre_solve=steer)
        if engine == "area":
            ra.attach(space)
        for _ in range(12):
            space.step(DT)
        speeds.append(ball.velocity)
    expected = pymunk.Vec2d(0, 400).rotated(2 * turn)
    assert (speeds[0] - expected).length < 4  # pymunk itself, in a step
    assert (speeds[1] - expected).length < 4


class Drawn(pymunk.SpaceDebugDrawOptions):
    """What `debug_draw` draws of contacts."""

    def __init__(self):
        super().__init__()
        self.flags = pymunk.SpaceDebugDrawOptions.DRAW_COLLISION_POINTS
        self.segments = []

    def draw_segment(self, a, b, color):
        self.segments.append((*a, *b))


@pytest.mark.parametrize("seed", SEEDS)
def test_contact_points_are_drawn_where_pymunk_draws_them(seed):
    drawn = []
    for engine in ("pymunk", "area"):
        space, *_ = landed(seed, engine)
        space.step(1e-9)  # hardly anything has moved
        options = Drawn()
        space.debug_draw(options)
        drawn.append(sorted(options.segments))
    assert len(drawn[0]) == len(drawn[1]) > 0
    for native, own in zip(*drawn):
        assert own == pytest.approx(native, abs=1e-6)


def _normals_on_a_corner(seed: int) -> list[pymunk.Vec2d]:
    """What an upright capsule that stands exactly above a corner of a chain hears, after its second second."""
    draw = random.Random(seed)
    space = pymunk.Space()
    space.gravity = 0, -900
    points = [(x, draw.uniform(-15, 15)) for x in (-50, 0, 50)]
    for a, b in itertools.pairwise(points):
        segment = pymunk.Segment(space.static_body, a, b, draw.choice([0, 2]))
        segment.friction = 1
        space.add(segment)
    body = pymunk.Body(1, float("inf"))
    body.position = 0, 60
    shape = pymunk.Segment(body, (0, -10), (0, 10), 10)
    shape.friction = 0.8
    space.add(body, shape)
    ra.attach(space)
    for _ in range(120):
        space.step(1 / 60)
    normals: list[pymunk.Vec2d] = []
    body.each_arbiter(lambda arbiter: normals.append(arbiter.normal))
    return normals


def test_who_stands_on_a_corner_is_told_so():
    """Chipmunk finds (1, 0) where a capsule's end is exactly above a corner: of 300, 34 never heard that they stand.

    One in fifty still does not: its overlap is less than what a solve leaves, and Chipmunk sees none.
    """
    heard = [_normals_on_a_corner(seed) for seed in range(100)]
    assert sum(not any(n.y < -0.5 for n in normals) for normals in heard) <= 3


@pytest.mark.parametrize("radius", [0.0, 3.0])
@pytest.mark.parametrize("seed", SEEDS)
def test_what_lies_on_a_terrain_hears_all_that_bears_it(seed, radius):
    """20 discs in the dips of 40 chained segments, 10 s: their arbiters' impulses are their weight's.

    A contact that bore while it was held an unseen hair above its segment was in no arbiter.
    """
    draw = random.Random(seed)
    space = pymunk.Space()
    space.gravity = 0, -900
    xs = [20.0 * i - 400.0 for i in range(41)]
    ys = [6e-4 * x * x + h for x, h in zip(xs, itertools.accumulate(draw.uniform(-6, 6) for _ in xs))]
    places = list(zip(xs, ys))
    for a, b in itertools.pairwise(places):
        segment = pymunk.Segment(space.static_body, a, b, radius)
        segment.friction = 0.5
        space.add(segment)
    bodies = []
    for i in range(20):
        size = draw.uniform(6, 16)
        body = pymunk.Body(1, size * size / 2)
        x, y = places[3 + 36 * i // 20]
        body.position = x, y + size + 10
        disc = pymunk.Circle(body, size)
        disc.friction = 0.5
        space.add(body, disc)
        bodies.append(body)
    ra.attach(space)
    for _ in range(600):
        space.step(DT)
    lying = [body for body in bodies if body.velocity.length < 0.01]
    assert len(lying) > 10
    for body in lying:
        heard = pymunk.Vec2d(0, 0)

        def hear(arbiter, body=body):
            nonlocal heard
            heard += arbiter.total_impulse * (-1 if arbiter.bodies[0] is body else 1)

        body.each_arbiter(hear)
        # to what a resting solve leaves
        assert abs(heard) == pytest.approx(body.mass * 900 * DT, rel=0.01)
