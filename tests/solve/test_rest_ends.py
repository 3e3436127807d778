"""Changes that reach who is at rest on a by-way: beside a frame that may fail, within callbacks, after a restore."""

import pymunk
import pytest
from solve_world import ENGINE

import rigidarea

DT = 1 / 60
pytestmark = pytest.mark.skipif(ENGINE == "pymunk", reason="of area contact's frames")


class Boxes:
    """Two boxes of 20 px on one another on a floor, at rest; `beside`: something far off that makes frames fragile."""

    def __init__(self, beside="nothing", gravity=(0, -900)):
        self.space = space = pymunk.Space()
        space.gravity = gravity
        self.floor = pymunk.Segment(space.static_body, (-300, 0), (300, 0), 5)
        space.add(self.floor)
        self.boxes = []
        for i in range(2):
            box = pymunk.Body(1, 300)
            box.position = 0, 15 + 20 * i
            space.add(box, pymunk.Poly.create_box(box, (20, 20)))
            self.boxes.append(box)
        for shape in space.shapes:
            shape.friction = 0.8
        self.far = pymunk.Body(1, 1000)
        self.far.position = 5000, 50000
        if beside == "concave":
            ring = [(0, 0), (60, 0), (60, 50), (45, 50), (45, 15), (15, 15), (15, 50), (0, 50)]
            space.add(self.far, rigidarea.Outline(ring).add_to(self.far))
        elif beside != "nothing":
            space.add(self.far, pymunk.Circle(self.far, 2))
            self.far.velocity = 9000, 0
            self.far.velocity_func = lambda *_: None
        self.contact = rigidarea.attach(space)
        for _ in range(400):
            space.step(DT)
        assert all(box.velocity == (0, 0) for box in self.boxes)

    def went(self, frames=40):
        before = [box.position for box in self.boxes]
        for _ in range(frames):
            self.space.step(DT)
        return [box.position - old for box, old in zip(self.boxes, before)]


def _floor_moves(world):
    world.space.static_body.position = 0, -20
    world.space.reindex_static()


ENDS = {
    "floor": (lambda w: setattr(w.floor, "filter", pymunk.ShapeFilter(mask=0)), [-200, -200]),
    "floor moves": (_floor_moves, [-20, -20]),
    "lower": (lambda w: setattr(*w.boxes[0].shapes, "filter", pymunk.ShapeFilter(mask=0)), [-200, -20]),
}


@pytest.mark.parametrize("beside", ["nothing", "concave", "bullet"])
@pytest.mark.parametrize("name", ENDS)
def test_what_bears_them_ends_beside_what_may_fail(name, beside):
    """They fall as they must (exact: g t^2 / 2 in 40 frames, or to where the floor is now)."""
    world = Boxes(beside)
    change, exact = ENDS[name]
    change(world)
    assert [way.y for way in world.went()] == pytest.approx(exact, abs=0.1)


@pytest.mark.parametrize("what", ["mass", "center_of_gravity"])
def test_what_a_callback_sets_of_a_body(what):
    """In `pre_solve`, as between frames: the same bits two frames later."""
    found = []
    for within in (False, True):
        world = Boxes()
        (shape,) = world.boxes[1].shapes
        shape.collision_type = 1
        todo = []
        world.space.on_collision(
            1, None, pre_solve=lambda arbiter, space, data, todo=todo: [t() for t in todo]
        )
        world.went(300)
        value = 30 if what == "mass" else (15, 0)

        def change(world=world, value=value, todo=todo):
            setattr(world.boxes[1], what, value)
            todo.clear()

        if within:
            todo.append(change)
        else:
            change()
        world.went(60)
        found.append(world.boxes)
    between, inside = ([(*b.position, b.angle) for b in boxes] for boxes in found)
    for one, other in zip(between, inside):  # a frame later
        assert one == pytest.approx(other, abs=0.5)
    if what == "mass":
        weight = []
        found[1][0].each_arbiter(lambda arbiter: weight.append(arbiter.total_impulse.length / DT))
        assert max(weight) == pytest.approx(31 * 900, rel=0.02)
    else:
        assert abs(inside[1][2]) > 0.3


@pytest.mark.parametrize("what", ["friction", "surface", "velocity", "centre"])
def test_what_is_changed_before_a_frame_that_fails(what):
    """It acts in the next: the lower box slides, is carried along, tips."""
    world = Boxes("bullet", gravity=(300, -900) if what == "friction" else (0, -900))
    if what == "friction":
        world.floor.friction = 0.0
    elif what == "surface":
        world.floor.surface_velocity = 100, 0
    elif what == "velocity":
        world.space.static_body.velocity = 100, 0
    else:
        world.boxes[1].center_of_gravity = 15, 0
    world.far.velocity = float("nan"), 0
    with pytest.raises(rigidarea.SimulationError):
        world.space.step(DT)
    world.far.velocity = 0, 0
    lower, upper = world.went()
    assert max(abs(lower.x), abs(upper.x), abs(upper.y)) > 5


@pytest.mark.parametrize("name, value, deep", [("penetration", 0.02, 0.4), ("stiffness", 2e3, 0.045)])
def test_a_setting_acts_after_a_restore(name, value, deep):
    """The upper box sinks to what was set since the snapshot was taken: k A = m g, or to that part of its size."""
    world = Boxes()
    snapshot = world.contact.snapshot()
    setattr(world.contact, name, value)
    world.contact.restore(snapshot)
    world.went(600)
    upper, lower = (box.position.y for box in world.boxes[::-1])
    exact = deep if name == "penetration" else 900 / (2e3 * 20)
    assert 20 - (upper - lower) == pytest.approx(exact, rel=0.05)


def test_a_joint_that_lets_its_bodies_collide():
    """`collide_bodies = True` of two that overlap by half, both at rest: they part."""
    space = pymunk.Space()
    space.gravity, space.damping = (0, -900), 0.05
    two = []
    for x in (0, 10):
        disc = pymunk.Body(1, 300)
        disc.position = x, 0
        spring = pymunk.DampedSpring(space.static_body, disc, (x, 100), (0, 0), 80, 200, 20)
        space.add(disc, pymunk.Circle(disc, 10), spring)
        two.append(disc)
    joint = pymunk.SlideJoint(*two, (0, 0), (0, 0), 0, 500)
    joint.collide_bodies = False
    space.add(joint)
    rigidarea.attach(space)
    for _ in range(900):
        space.step(DT)
    assert two[0].position.get_distance(two[1].position) == pytest.approx(10, abs=1e-3)
    joint.collide_bodies = True
    for _ in range(60):
        space.step(DT)
    assert two[0].position.get_distance(two[1].position) > 19


@pytest.mark.parametrize("kind", ["kinematic", "free", "driven", "pushed"])
@pytest.mark.parametrize("sensor", [False, True])
def test_what_has_no_size_turns_on(kind, sensor):
    """A radar, a flywheel: a body without shapes, or with a sensor alone, at 1 rad/s for 5 s, or by a steady torque."""
    space = pymunk.Space()
    body = pymunk.Body(1, 100, pymunk.Body.KINEMATIC if kind == "kinematic" else pymunk.Body.DYNAMIC)
    space.add(body)
    if sensor:
        shape = pymunk.Circle(body, 10)
        shape.sensor = True
        space.add(shape)
    if kind == "driven":
        space.add(pymunk.SimpleMotor(space.static_body, body, -1))
    elif kind != "pushed":
        body.angular_velocity = 1.0
    rigidarea.attach(space)
    for _ in range(300):
        if kind == "pushed":
            body.torque = 20.0
        space.step(DT)
    assert abs(body.angle) == pytest.approx(2.5 if kind == "pushed" else 5.0, rel=0.01)


@pytest.mark.parametrize("kind", ["wall", "pivot"])
@pytest.mark.parametrize("hold", [0, 1, 60])
def test_what_has_borne_a_force_does_not_recoil(kind, hold):
    """A force that grows, held by a wall or a joint, then ends: nothing moves (what came ahead was borne as well)."""
    space = pymunk.Space()
    body = pymunk.Body(1, 100)
    space.add(body, pymunk.Poly.create_box(body, (20, 20)))
    joint = pymunk.PivotJoint(space.static_body, body, (0, 0), (0, 0))
    space.add(joint if kind == "pivot" else pymunk.Segment(space.static_body, (15, -50), (15, 50), 5))
    rigidarea.attach(space)
    for i in range(30 + hold):
        body.force = 6000 * min(1, (i + 1) / 30), 0
        space.step(DT)
    if kind == "pivot":
        space.remove(joint)
    for _ in range(30):
        space.step(DT)
    assert body.velocity.length < 0.05 and abs(body.position.x) < 0.05


def test_what_comes_to_be_static_is_where_it_is_put():
    """A kinematic floor is made static, moved and reindexed before the next step: the box comes down on it."""
    space = pymunk.Space()
    space.gravity = 0, -900
    floor = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    box = pymunk.Body(1, 300)
    box.position = 0, 15
    shapes = pymunk.Segment(floor, (-100, 0), (100, 0), 5), pymunk.Poly.create_box(box, (20, 20))
    space.add(floor, box, *shapes)
    rigidarea.attach(space)
    for _ in range(100):
        space.step(DT)
    floor.body_type = pymunk.Body.STATIC
    floor.position = 0, -30
    space.reindex_shapes_for_body(floor)
    for _ in range(60):
        space.step(DT)
    assert box.position.y == pytest.approx(-15, abs=0.02)
