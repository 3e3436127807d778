"""Who is at rest is not solved again, and moves at once when anything is changed on which it rests.

Each change is made in two equal worlds at rest: in one frames are as they come, the other is solved in every frame
(`steps` are given). Both must go on alike.
"""

import math

import pymunk
import pytest
from solve_world import ENGINE

import rigidarea

DT = 1 / 60
TILT = 0.2
pytestmark = pytest.mark.skipif(ENGINE == "pymunk", reason="of area contact's frames")


class Slope:
    """Three boxes on one another on a slope, a disc and a box against its stop, a box on a kinematic platform."""

    def __init__(self):
        self.space = space = pymunk.Space()
        space.gravity = 0, -900
        self.slope = pymunk.Segment(
            space.static_body, (0, 0), (600 * math.cos(TILT), 600 * math.sin(TILT)), 4
        )
        self.stop = pymunk.Segment(space.static_body, (0, 0), (-40 * math.sin(TILT), 40 * math.cos(TILT)), 4)
        space.add(self.slope, self.stop)
        self.stack = [self._box(300, 20 + 32 * i) for i in range(3)]
        self.low = self._box(21, 20)
        self.disc = pymunk.Body(1, pymunk.moment_for_circle(1, 0, 15))
        self.disc.position = self._at(53, 20)
        space.add(self.disc, pymunk.Circle(self.disc, 15))
        self.platform = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        self.platform.position = -200, 100
        space.add(self.platform, pymunk.Poly.create_box(self.platform, (100, 20)))
        self.rider = pymunk.Body(1, pymunk.moment_for_box(1, (32, 32)))
        self.rider.position = -200, 126.3
        space.add(self.rider, pymunk.Poly.create_box(self.rider, (32, 32)))
        for shape in space.shapes:
            shape.friction = 0.9
        self.contact = rigidarea.attach(space)
        for _ in range(900):
            space.step(DT)

    def _at(self, along, up):
        c, s = math.cos(TILT), math.sin(TILT)
        return along * c - up * s, along * s + up * c

    def _box(self, along, up):
        body = pymunk.Body(1, pymunk.moment_for_box(1, (32, 32)))
        body.position, body.angle = self._at(along, up), TILT
        self.space.add(body, pymunk.Poly.create_box(body, (32, 32)))
        return body

    @property
    def places(self):
        return [(*b.position, 20 * b.angle) for b in (*self.stack, self.low, self.disc, self.rider)]


def _set(name, value):
    """A change of an attribute: of the middle box, of its shape, of the platform, of the world's slope ..."""
    *path, last = name.split(".")

    def change(world):
        one = world
        for part in path:
            one = one[int(part)] if part.isdigit() else getattr(one, part)
        setattr(one, last, value)

    return change


def _first_shape(world):
    return next(iter(world.stack[0].shapes))


def _material(name, value, shape=_first_shape):
    return lambda world: setattr(shape(world), name, value)


def _goes(what):
    return lambda world: world.space.remove(*what(world))


def _push(world):
    world.rider.apply_force_at_world_point((4000, 0), world.rider.position)


def _impulse(world):
    world.low.apply_impulse_at_world_point((0, 100), world.low.position)


def _slope_moves(world):
    world.space.static_body.position = 0, -5
    world.space.reindex_static()


def _comes(world, overlapping):
    body = pymunk.Body(5, pymunk.moment_for_circle(5, 0, 10))
    x, y = world.stack[2].position
    body.position = x, y + (18 if overlapping else 32)
    body.velocity = 0, 0 if overlapping else -300
    world.space.add(body, pymunk.Circle(body, 10))


def _wall_comes(world):
    x, y = world.rider.position
    world.space.add(
        pymunk.Poly(world.space.static_body, [(x + 12, y - 10), (x + 60, y - 10), (x + 60, y + 10)])
    )


def _joint_comes(world):
    spring = pymunk.DampedSpring(world.space.static_body, world.rider, (-100, 126), (0, 0), 10, 50, 5)
    world.space.add(spring)


def _refused(world):
    def no(arbiter, space, data):
        arbiter.process_collision = False

    world.slope.collision_type = 7
    world.space.on_collision(7, None, pre_solve=no)


def _smooth(world):
    def smooth(arbiter, space, data):
        arbiter.friction = 0.0

    world.slope.collision_type = 7
    world.space.on_collision(7, None, pre_solve=smooth)


def _led(world):
    world.platform.position += (0, 1)


def _kinematic(world):
    world.stack[0].body_type = pymunk.Body.KINEMATIC
    world.stack[0].velocity = 0, 30


def _other_vertices(world):
    shape = next(iter(world.rider.shapes))
    shape.unsafe_set_vertices([(-16, -12), (16, -12), (16, 16), (-16, 16)])
    world.space.reindex_shape(shape)


CHANGES = {
    "velocity": _set("stack.1.velocity", (50, 0)),
    "spin": _set("disc.angular_velocity", 3.0),
    "place": lambda world: setattr(world.rider, "position", world.rider.position + (0, 20)),
    "angle": _set("rider.angle", 0.2),
    "force": _push,
    "torque": _set("disc.torque", 1e5),
    "impulse": _impulse,
    "gravity": _set("space.gravity", (500, -900)),
    "mass": _set("stack.2.mass", 50.0),
    "friction of a shape": _material("friction", 0.0),
    "friction of the slope": _material("friction", 0.0, lambda world: world.slope),
    "surface velocity": _material("surface_velocity", (200, 0), lambda world: world.slope),
    "sensor": _material("sensor", True),
    "filter": _material("filter", pymunk.ShapeFilter(mask=0)),
    "filter of the slope": _material("filter", pymunk.ShapeFilter(mask=0), lambda world: world.slope),
    "support goes": _goes(lambda world: (world.stack[0], *world.stack[0].shapes)),
    "its shape goes": _goes(lambda world: world.stack[0].shapes),
    "slope goes": _goes(lambda world: [world.slope]),
    "slope moves": _slope_moves,
    "velocity of what is static": lambda world: setattr(world.space.static_body, "velocity", (100, 0)),
    "platform starts": _set("platform.velocity", (100, 50)),
    "platform turns": _set("platform.angular_velocity", 1.0),
    "platform is led": _led,
    "somebody strikes": lambda world: _comes(world, False),
    "somebody is in it": lambda world: _comes(world, True),
    "a wall in it": _wall_comes,
    "a joint": _joint_comes,
    "refused": _refused,
    "smooth by a callback": _smooth,
    "type": _kinematic,
    "centre of gravity": _set("rider.center_of_gravity", (20, 0)),
    "vertices": _other_vertices,
    "penetration": lambda world: setattr(world.contact, "penetration", 0.02),
    "stiffness": lambda world: setattr(world.contact, "stiffness", 1e3),
}


def _step(free, solved):
    """A frame as it comes, and one that is solved whatever is at rest."""
    free.space.step(DT)
    solved.contact.step(DT, steps=2)


def _stays(free, solved):
    """Nothing moves, to the bit, while nothing changes."""
    rest = free.places
    for _ in range(10):
        _step(free, solved)
    assert free.places == rest


def _course(free, solved, change, part):
    """How far a change moves anybody in a third of a second: the same in both, to so large a part of the way (px)."""
    before = solved.places
    for world in (free, solved):
        change(world)
    went = 0.0
    for _ in range(20):
        _step(free, solved)
        for old, one, other in zip(before, free.places, solved.places):
            went = max(went, math.dist(old, other))
            assert math.dist(one, other) < 0.05 + part * math.dist(old, other)
    return went


@pytest.mark.parametrize("name", CHANGES)
def test_a_change_moves_who_is_at_rest(name):
    """The same course for a third of a second, to a tenth of the way and a twentieth of a pixel.

    (Frames of one substep and of two differ by that much; a body put into another is let out by a part a substep.)
    """
    free, solved = Slope(), Slope()
    _stays(free, solved)
    assert all(body.velocity == (0, 0) for body in (*free.stack, free.low, free.disc, free.rider))
    part = 0.7 if name in ("angle", "a wall in it") else 0.1
    assert _course(free, solved, CHANGES[name], part) > 0.03


class Hung:
    """A box in a spring, a plank in a pin and a slide, an arm against its limit by a motor, one dragged by a hand."""

    def __init__(self):
        self.space = space = pymunk.Space()
        space.gravity = 0, -900
        ground = space.static_body
        self.box = self._body(-200, 0)
        self.spring = pymunk.DampedSpring(ground, self.box, (-200, 100), (0, 16), 60, 400, 30)
        self.plank = self._body(0, 0, 100)
        self.pin = pymunk.PinJoint(ground, self.plank, (-40, 80), (-40, 0))
        self.slide = pymunk.SlideJoint(ground, self.plank, (40, 80), (40, 0), 20, 80)
        self.arm = self._body(200, 0, 100)
        self.pivot = pymunk.PivotJoint(ground, self.arm, (160, 0))
        self.limit = pymunk.RotaryLimitJoint(ground, self.arm, -0.5, 0.5)
        self.motor = pymunk.SimpleMotor(ground, self.arm, -1)
        self.hand = pymunk.Body(body_type=pymunk.Body.KINEMATIC)  # in no space, as pymunk's examples have it
        self.hand.position = 400, 100
        self.held = self._body(400, 80)
        self.grip = pymunk.PivotJoint(self.hand, self.held, (0, 0), (0, 16))
        self.damper = pymunk.DampedRotarySpring(ground, self.held, 0, 0, 3000)
        space.add(
            self.spring, self.pin, self.slide, self.pivot, self.limit, self.motor, self.grip, self.damper
        )
        self.contact = rigidarea.attach(space)
        self.motor.max_force = 2e5
        space.damping = 0.01
        for _ in range(1800):
            space.step(DT)

    def _body(self, x, y, wide=32):
        body = pymunk.Body(1, pymunk.moment_for_box(1, (wide, 32)))
        body.position = x, y
        self.space.add(body, pymunk.Poly.create_box(body, (wide, 32)))
        return body

    @property
    def bodies(self):
        return self.box, self.plank, self.arm, self.held

    @property
    def places(self):
        return [(*b.position, 20 * b.angle) for b in self.bodies]


JOINT_CHANGES = {
    "rest length": _set("spring.rest_length", 80.0),
    "stiffness": _set("spring.stiffness", 200.0),
    "force": _set("spring.force_func", lambda spring, distance: 1500.0),
    "a pin's length": _set("pin.distance", 100.0),
    "a slide's": _set("slide.max", 100.0),
    "an anchor": _set("pin.anchor_b", (-20, 0)),
    "a motor": _set("motor.rate", 1.0),
    "a limit": _set("limit.max", 0.0),
    "no force": _set("grip.max_force", 0.0),
    "goes": _goes(lambda world: [world.slide]),
    "comes": lambda world: world.space.add(pymunk.GearJoint(world.space.static_body, world.box, 0.5, 1)),
    "hand": _set("hand.position", (410, 110)),
}


@pytest.mark.parametrize("name", JOINT_CHANGES)
def test_a_change_of_a_joint_moves_who_hangs_in_it(name):
    """As of contacts; of what is to be mended, a substep mends a part."""
    free, solved = Hung(), Hung()
    _stays(free, solved)
    assert all(body.velocity == (0, 0) for body in free.bodies)
    pulls = [joint.impulse for joint in free.space.constraints]
    free.space.step(DT)
    assert pulls == [joint.impulse for joint in free.space.constraints] and min(map(abs, pulls[:5])) > 0
    solved.contact.step(DT, steps=2)
    assert _course(free, solved, JOINT_CHANGES[name], 0.6) > 0.5


def test_what_is_at_rest_is_reported_as_before():
    """Impulses, regions and contacts in frames at rest are those of the frame before, and go with the frame's time."""
    world = Slope()

    def weights(dt):
        world.space.step(dt)
        total = pymunk.Vec2d(0, 0)

        def add(arbiter):
            nonlocal total
            total += arbiter.total_impulse

        world.stack[0].each_arbiter(add)
        return total / dt

    first = weights(DT)
    regions = world.contact.regions
    assert len(regions) > 6
    for dt in (DT, DT, DT / 2, 2 * DT):
        assert weights(dt) == pytest.approx(first, rel=1e-5)
    again = world.contact.regions
    assert [tuple(r["centroid"]) for r in again] == [tuple(r["centroid"]) for r in regions]


def test_nobody_is_heard_to_part_or_touch_at_rest():
    """`begin` and `separate` are silent for five seconds, `pre_solve` and `post_solve` are not."""
    world = Slope()
    heard = []
    for kind in ("begin", "separate", "pre_solve", "post_solve"):
        world.space.on_collision(**{kind: lambda arbiter, space, data, kind=kind: heard.append(kind)})
    world.space.step(DT)
    heard.clear()
    for _ in range(300):
        world.space.step(DT)
    assert {kind: heard.count(kind) // 300 for kind in set(heard)} == {"pre_solve": 7, "post_solve": 7}
    assert all(body.velocity == (0, 0) for body in world.stack)


def test_what_balances_by_a_millionth_falls():
    """A stick that stands on its end, off by 1e-5 rad: it falls in the time that a stick takes (an exact integral)."""
    space = pymunk.Space()
    space.gravity = 0, -900
    floor = pymunk.Segment(space.static_body, (-500, 0), (500, 0), 5)
    stick = pymunk.Body(1, pymunk.moment_for_box(1, (1e-3, 100)))
    shape = pymunk.Segment(stick, (0, -50), (0, 50), 1)
    stick.position, stick.angle = (0, 56), 1e-5
    floor.friction = shape.friction = 1.0
    space.add(floor, stick, shape)
    rigidarea.attach(space)
    frames = 0
    while abs(stick.angle) < 0.5 and frames < 600:
        space.step(DT)
        frames += 1
    # 0.5 = 1e-5 cosh(w t), w^2 = 3 g / 2 l of a rod about its end
    assert frames * DT == pytest.approx(math.acosh(0.5 / 1e-5) / math.sqrt(1.5 * 900 / 101), rel=0.25)


def test_who_hangs_at_rest_from_what_others_hit_stays_so():
    """A bob at rest, pinned to the body of the floor on which a linked pair bounces: not a bit of it moves."""
    space = pymunk.Space()
    space.gravity = 0, -900
    floor = pymunk.Segment(space.static_body, (-500, 0), (500, 0), 5)
    bob = pymunk.Body(1, pymunk.moment_for_circle(1, 0, 10))
    bob.position = 200, 100
    pair = [pymunk.Body(1, pymunk.moment_for_circle(1, 0, 10)) for _ in range(2)]
    for body, x in zip(pair, (-30, 0), strict=True):
        body.position = x, 200
    rod = pymunk.PinJoint(space.static_body, bob, (200, 180))
    link = pymunk.PinJoint(*pair)
    space.add(floor, bob, *pair, *(pymunk.Circle(body, 10) for body in (bob, *pair)), rod, link)
    for shape in space.shapes:
        shape.elasticity = 1.0
    rigidarea.attach(space)
    for _ in range(60):
        space.step(DT)
    place = bob.position, bob.angle
    for _ in range(240):
        space.step(DT)
        assert (bob.velocity, bob.angular_velocity) == ((0, 0), 0)
        assert rod.impulse == pytest.approx(900 * DT, rel=1e-5)
    assert (bob.position, bob.angle) == place
    assert max(abs(body.velocity) for body in pair) > 100
