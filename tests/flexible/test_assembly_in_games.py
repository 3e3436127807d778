"""What a game does to flexible parts: settings that change, speeds, falls, functions of its own, spins."""

import math

import pymunk
import pytest

import rigidarea as ra
from rigidarea import shapes
from rigidarea.flexible import Assembly, Material

RUBBER = Material(5e7, 0.45, 1150.0, 0.1)


def two_blocks(gap: float, speed: float = 0.0, **keys):
    """Two rubber blocks of 0.2 in a row, the first comes with 1 towards the other; ``speed`` is both's: their space,
    assembly and bodies."""
    space = pymunk.Space()
    block, bodies = shapes.box(0.2, 0.2), []
    assembly = Assembly(k=1e7, **keys)
    for x, v in ((0.0, 1.0), (0.2 + gap, 0.0)):
        body = block.body(density=100.0)
        body.position, body.velocity = (x, 0), (v, speed)
        shape = block.add_to(body, elasticity=1.0)
        space.add(body, shape)
        assembly.part(shape, RUBBER, mesh=0.05)
        bodies.append(body)
    return space, assembly, bodies


def test_a_mesh_size_for_each_ring():
    """As `Mechanism.body` takes it; the finest says how far a boundary goes in a step."""
    steps = []
    for mesh in (0.02, [0.04, 0.02]):
        space, body = pymunk.Space(), pymunk.Body(1.0, 1.0)
        body.angular_velocity = 10.0
        shape = shapes.ring(0.05, 0.1).add_to(body)
        space.add(body, shape, pymunk.PivotJoint(space.static_body, body, (0, 0)))
        assembly = Assembly(k=1e7)
        assembly.part(shape, RUBBER, mesh=mesh, hub=1)
        ra.attach(space, flexible=assembly)
        space.step(1 / 60)
        steps.append(assembly.steps)
    assert steps == [math.ceil(10.0 * 0.1 / 60 / (0.25 * 0.02))] * 2


def test_steps_are_for_what_may_meet():
    """A part that falls alone costs one step a frame however fast it is, and no others' step is shorter for it."""
    space, assembly, (one, _) = two_blocks(1e3)
    space.gravity = 0, -900
    ra.attach(space, flexible=assembly)
    for _ in range(30):
        space.step(1 / 60)
        assert assembly.steps == 1
    assert one.velocity == pytest.approx((1.0, -450.0), rel=1e-12)


def test_a_common_velocity_changes_nothing():
    """Galilei: what two parts do to each other is the same, and costs the same, at 200 m/s."""
    ends = []
    for speed in (0.0, 200.0):
        space, assembly, bodies = two_blocks(0.01, speed)
        ra.attach(space, flexible=assembly)
        steps = []
        for _ in range(40):
            space.step(1 / 240)
            steps.append(assembly.steps)
        ends.append([x for b in bodies for x in (b.position.x, b.velocity.x, b.angle)] + steps)
    assert ends[0][1] < 0.1  # they have met
    assert ends[1] == pytest.approx(ends[0], abs=1e-9)  # places of 30 m to rounding, over a contact


@pytest.mark.parametrize("step", [None, 1e-3])
def test_a_modal_part_that_spins_alone(step):
    """It swells, and slows by what a rod's stretch, ρ ω² (a² r − r³/3) / 2E, adds to its moment of inertia; it goes on
    so: frame and modes exchange moment of momentum at one time, or vibration would grow by what each is late."""
    space = pymunk.Space()
    a, height, spin = 0.2, 0.04, 100.0
    outline, made = shapes.box(2 * a, height), Material(5e7, 0.3, 1000.0)
    body = outline.body(density=made.density)
    body.angular_velocity = spin
    shape = outline.add_to(body)
    space.add(body, shape)
    assembly = Assembly(k=1.0, step=step)
    assembly.part(shape, made, mesh=0.02, level="modal")
    ra.attach(space, flexible=assembly)
    late = []
    for i in range(180):
        space.step(1 / 60)
        if i >= 90:
            late.append(body.angular_velocity)
    more = 8 * made.density**2 * height * spin**2 * a**5 / (15 * made.young)
    # of a rod, a tenth as wide as long; with long steps the vibration has died by now
    assert [1 - min(late) / spin, 1 - max(late) / spin] == pytest.approx([more / body.moment] * 2, rel=0.05)


def test_a_frame_that_nobody_can_wait_for():
    """10⁹ m/s through a mesh of 5 cm: an error that says so, all as before it; and then the game goes on."""
    space, assembly, (one, two) = two_blocks(0.01)
    contact = ra.attach(space, flexible=assembly)
    space.step(1e-3)
    one.velocity, at = (1e9, 0), one.position
    with pytest.raises(RuntimeError, match=r"steps, expected at most 100000: velocities up to 1e\+09"):
        space.step(1 / 60)
    assert one.position == at
    one.velocity = 0, 0
    space.step(1 / 60)
    # one in the other: no convergence, in steps that do not become shorter from frame to frame
    two.position = one.position
    told = []
    for _ in range(3):
        with pytest.raises(RuntimeError, match="tried") as error:
            contact.step(1 / 60)
        told.append(str(error.value).split("residual")[0])
    assert told[1] == told[2]


def test_numbers_that_are_none():
    """A force or a step that is not finite is named, everything as it was; a shape without an area is refused."""
    space, assembly, (one, two) = two_blocks(0.01)
    ra.attach(space, flexible=assembly)
    space.step(1e-3)
    at = one.position
    two.force = math.nan, 0.0
    with pytest.raises(
        ra.SimulationError, match="part 1: expected a finite place, velocity, force and torque"
    ):
        space.step(1e-3)
    two.force = 0.0, 0.0
    with pytest.raises(ValueError, match="dt must be a finite number, got inf"):
        space.step(math.inf)
    assert one.position == at
    space.step(1e-3)
    with pytest.raises(ValueError, match="a shape with an area, got a Segment of radius 0"):
        Assembly(k=1.0).part(pymunk.Segment(one, (0, 0), (1, 0), 0), RUBBER, mesh=0.1)


@pytest.mark.parametrize("elasticity", [0.0, 0.5])
@pytest.mark.parametrize("young", [1e7, 1e9])
def test_a_part_comes_to_rest_on_another(elasticity, young):
    """A disc falls on a slab, both yield: as it leaves, the dashpot takes all of the region's force, but no more."""
    space = pymunk.Space()
    space.gravity = 0, -9.81
    ground = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    outline = shapes.circle(0.1)
    disc = outline.body(density=100.0)
    disc.position = 0, 0.3
    parts = shapes.box(0.6, 0.2).add_to(ground, elasticity=elasticity), outline.add_to(disc, elasticity=1.0)
    space.add(ground, disc, *parts)
    assembly = Assembly(k=3e6)
    for part in parts:
        assembly.part(part, Material(young, 0.3, 1000.0, 0.1), mesh=0.05)
    ra.attach(space, flexible=assembly)
    for _ in range(120):
        space.step(1 / 120)
    # half a second of impacts, each with half the speed of that before; what is left is that of a micrometre's fall
    assert disc.velocity.length < 5e-3
    assert assembly.forces()[0, 1][1] == pytest.approx(disc.mass * 9.81, rel=1e-2)


def _sensor(space, one, two):
    two.sensor = True


def _group(space, one, two):
    one.filter = two.filter = pymunk.ShapeFilter(group=1)


def _mask(space, one, two):
    two.filter = pymunk.ShapeFilter(categories=2, mask=pymunk.ShapeFilter.ALL_MASKS() ^ 1)
    one.filter = pymunk.ShapeFilter(categories=1)


def _joint(space, one, two):
    joint = pymunk.DampedSpring(one.body, two.body, (0, 0), (0, 0), 1.0, 0.0, 0.0)
    joint.collide_bodies = False
    space.add(joint)


@pytest.mark.parametrize("when", ["before", "later"])
@pytest.mark.parametrize("part", [_sensor, _group, _mask, _joint], ids=lambda f: f.__name__)
def test_parts_that_pymunk_keeps_apart_do_not_touch(part, when):
    """Of three blocks in a row the first two do not meet; the third meets the second, as it would without them."""
    space = pymunk.Space()
    block, shapes_of = shapes.box(0.2, 0.2), []
    for x, v in ((0.0, 2.0), (0.25, 0.0), (0.5, -1.0)):
        body = block.body(density=100.0)
        body.position, body.velocity = (x, 0), (v, 0)
        shapes_of.append(block.add_to(body, elasticity=1.0))
        space.add(body, shapes_of[-1])
    if part is _sensor:
        space.remove(shapes_of[2].body, shapes_of.pop())
    if when == "before":
        part(space, *shapes_of[:2])
    assembly = Assembly(k=1e8)
    for shape in shapes_of:
        assembly.part(shape, RUBBER, mesh=0.05)
    ra.attach(space, flexible=assembly)
    if when == "later":
        space.step(1e-3)  # 0.05 between them, 2 mm nearer
        part(space, *shapes_of[:2])
    for _ in range(80):
        space.step(1e-3)
    one, two, *_ = (shape.body for shape in shapes_of)
    assert one.velocity == pytest.approx((2.0, 0.0), abs=1e-12)
    assert two.position.x - one.position.x < 0.2  # one is in the other
    # equal masses: the second goes on with the third's velocity, for what the step's first order keeps of it
    assert two.velocity.x == pytest.approx(0.0 if part is _sensor else -1.0, abs=1e-2)


@pytest.mark.parametrize("level", ["rigid", "compliant"])
def test_a_block_that_friction_holds_on_a_slope_is_at_rest(level):
    """tan 0.3 = 0.31 < 0.6. The spring that holds it has a dashpot: nothing else takes a vibration along the slope."""
    space = pymunk.Space()
    space.gravity = 0, -9.81
    slope, outline = pymunk.Body(body_type=pymunk.Body.KINEMATIC), shapes.box(0.2, 0.2)
    block = outline.body(density=100.0)
    slope.angle = block.angle = 0.3
    block.position = pymunk.Vec2d(0, 0.2005).rotated(0.3)
    keys = {} if level == "rigid" else {"mesh": 0.05}
    assembly = Assembly(k=1e7)
    for body, shape in (
        (slope, shapes.box(2.0, 0.2).add_to(slope, friction=0.6)),
        (block, outline.add_to(block, friction=1.0)),
    ):
        space.add(body, shape)
        assembly.part(shape, Material(5e8, 0.3, 1000.0, 0.1), level=level, **keys)
    ra.attach(space, flexible=assembly)
    for _ in range(60):
        space.step(1 / 60)
    assert block.velocity.length < 1e-8  # of 10 m/s in a second of free fall; rounding alone is left
    assert abs(block.angular_velocity) < 1e-8


def test_who_moves_a_part_and_what_is_tied_to_it():
    """The assembly does; a function of the user's on one of these bodies is refused, when it comes, and kept."""

    def still(body, gravity, damping, dt):
        body.velocity = 0, 0

    for who in ("part", "tied"):
        space, assembly, (one, _) = two_blocks(0.01)
        ball = pymunk.Body(1.0, 1.0)
        ball.position = 1, 0
        space.add(ball, pymunk.DampedSpring(one, ball, (0, 0), (0, 0), 1.0, 10.0, 0.0))
        body = one if who == "part" else ball
        body.velocity_func = still
        with pytest.raises(ValueError, match="velocity_func"):
            ra.attach(space, flexible=assembly)
        assert body.velocity_func is still and ra.attached(space) is None
        body.velocity_func = pymunk.Body.update_velocity
        contact = ra.attach(space, flexible=assembly)
        space.step(1e-3)
        body.velocity_func, at = still, one.position
        with pytest.raises(ValueError, match="velocity_func"):
            space.step(1e-3)
        assert one.position == at
        contact.detach()
        assert body.velocity_func is still
        space.step(1e-3)
        assert body.velocity.length == 0.0
