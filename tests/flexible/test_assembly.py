"""Flexible bodies in a pymunk space: figures of the case, momentum, joints, what the rest of the space notices."""

import copy
import math
import pickle

import numpy as np
import pymunk
import pytest

import rigidarea as ra
from rigidarea import shapes
from rigidarea.cases import gearbox
from rigidarea.flexible import Assembly, Material

RUBBER = Material(5e7, 0.45, 1150.0, 0.1)


def gears_and_boxes(boxes: int, level: str = "compliant", drive: str = "kinematic", mesh: float = 1.2e-3):
    """The case's gearbox in a space with boxes falling beside it: space, assembly, pinion, wheel, boxes, its drive."""
    space = pymunk.Space()
    space.gravity = 0, -9.81
    outlines = gearbox.outlines()
    density = gearbox.STEEL.density * gearbox.THICKNESS
    pinion = (
        pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        if drive == "kinematic"
        else outlines[0].body(density=density)
    )
    wheel = outlines[1].body(density=density)
    wheel.position, wheel.angle = (gearbox.CENTRES, 0), math.pi + math.pi / gearbox.TEETH[1]
    # the case has neither friction nor damping
    parts = [o.add_to(b, elasticity=1.0) for o, b in zip(outlines, (pinion, wheel), strict=True)]
    pivot = pymunk.PivotJoint(space.static_body, wheel, (gearbox.CENTRES, 0))
    damper = pymunk.DampedRotarySpring(space.static_body, wheel, 0, 0, gearbox.DAMPER)
    space.add(pinion, wheel, *parts, pivot, damper)
    if drive == "kinematic":

        def turn(speed):
            pinion.angular_velocity = speed
    else:
        motor = pymunk.SimpleMotor(space.static_body, pinion, 0)
        space.add(motor, pymunk.PivotJoint(space.static_body, pinion, (0, 0)))

        def turn(speed):
            motor.rate = -speed

    floor = pymunk.Segment(space.static_body, (-1, -0.1), (1, -0.1), 0.01)
    floor.friction = 0.5
    space.add(floor)
    fallen = []
    for i in range(boxes):
        box = pymunk.Body(0.05, 0.05 * 2 * 0.02**2 / 12)
        box.position = 0.3 + 0.025 * (i % 10), -0.07 + 0.03 * (i // 10)
        shape = pymunk.Poly.create_box(box, (0.02, 0.02))
        shape.friction = 0.5
        space.add(box, shape)
        fallen.append(box)
    assembly = Assembly(k=gearbox.K)
    for shape in parts:
        flexible = {"mesh": mesh, "hub": 1} if level != "rigid" else {}
        assembly.part(shape, gearbox.STEEL, level=level, refine=6, **flexible)
    return space, assembly, pinion, wheel, fallen, turn


def ripple(level: str, drive: str, boxes: int, frame: float, duration: float) -> tuple[float, float]:
    """Mean ratio, and its ripple (percent) from the end of the ramp, as ``gearbox.measure`` has them."""
    space, assembly, pinion, wheel, _, turn = gears_and_boxes(boxes, level, drive)
    ra.attach(space, flexible=assembly)
    ratio = []
    for i in range(round(duration / frame)):
        t = (i + 0.5) * frame
        turn(gearbox.SPEED * min(t / gearbox.RAMP, 1.0))
        space.step(frame)
        if t >= gearbox.RAMP:
            ratio.append(-wheel.angular_velocity / pinion.angular_velocity)
    return float(np.mean(ratio)), 100 * float(np.std(ratio)) / gearbox.IDEAL


@pytest.mark.slow
@pytest.mark.parametrize(
    ("level", "drive"), [("compliant", "kinematic"), ("compliant", "motor"), ("modal", "kinematic")]
)
def test_gears_among_boxes_have_the_figures_of_the_case(level, drive):
    """Mean ratio and ripple of the flexible stepper's own run, which drives the hub and knows no boxes."""
    case = gearbox.measure(gearbox.simulation(level, 1.2, refine=6).run(0.35, gearbox.STEP))
    mean, rms = ripple(level, drive, 50, 1e-4, 0.35)
    assert mean == pytest.approx(case["mean_ratio"], abs=5e-5)
    assert rms == pytest.approx(
        case["ratio_rmse_percent"], rel=0.05
    )  # steps of the first order beside the second


@pytest.mark.slow
def test_a_geneva_drive_has_the_figures_of_the_case():
    """The case's drive as parts: the crank a kinematic body, the wheel on a pivot with a damper; one engagement."""
    from types import SimpleNamespace

    from rigidarea.cases import geneva_case as gv

    duration = 0.75
    sim, start = gv.simulation("compliant")
    case = gv.measure(sim.run(duration, gv.STEP), start, 6)
    drive = shapes.geneva(6, gv.CENTRES, gv.PIN, gv.CLEARANCE, bore=0.004, tolerance=2e-8)
    space = pymunk.Space()
    crank = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    crank.angle, crank.angular_velocity = start, gv.SPEED
    wheel = drive.wheel.body(density=gv.STEEL.density * gv.THICKNESS)
    wheel.position, wheel.angle = (gv.CENTRES, 0), drive.wheel_angle(-drive.entry_angle)
    pin, slots = drive.pin.add_to(crank, elasticity=1.0), drive.wheel.add_to(wheel, elasticity=1.0)
    ground = space.static_body
    space.add(crank, wheel, pin, slots, pymunk.PivotJoint(ground, wheel, (gv.CENTRES, 0)))
    space.add(pymunk.DampedRotarySpring(ground, wheel, 0, 0, gv.DAMPER))
    assembly = Assembly(k=gv.K)
    assembly.part(pin, gv.STEEL, mesh=1e-3, refine=gv.REFINE)
    assembly.part(slots, gv.STEEL, mesh=1e-3, refine=gv.REFINE, hub=1)
    ra.attach(space, flexible=assembly)
    rows = []
    for i in range(round(duration / gv.STEP)):
        space.step(gv.STEP)
        force = assembly.forces().get((0, 1), (0.0, 0.0))
        rows.append(((i + 1) * gv.STEP, crank.angle, wheel.angle, *force))
    t, *angles, fx, fy = np.array(rows).T
    record = SimpleNamespace(
        t=t, hub=np.column_stack(angles), force=np.column_stack([fx, fy]), iterations=np.ones(len(t))
    )
    ours = gv.measure(record, start, 6)
    for name in ("rms_percent", "rms_mean_norm_percent", "contact_delay_ms", "force_max_n"):
        print(f"{name}: {ours[name]:.4g} in a space, {case[name]:.4g} the case")
    assert ours["rms_percent"] == pytest.approx(case["rms_percent"], rel=0.05)  # steps of the first order
    assert ours["contact_delay_ms"] == pytest.approx(case["contact_delay_ms"], abs=1e3 * gv.STEP)
    assert ours["force_max_n"] == pytest.approx(case["force_max_n"], rel=0.1)


def test_boxes_go_on_as_they_are():
    """Boxes that touch no part end where they do without parts; the same joints, so that the solve sweeps alike."""
    ends = []
    for flexible in (True, False):
        space, assembly, pinion, wheel, boxes, turn = gears_and_boxes(20)
        turn(1.0)
        if not flexible:
            for shape in list(space.shapes):
                if shape.body in (pinion, wheel):
                    space.remove(shape)
        contact = ra.attach(space, flexible=assembly if flexible else None)
        contact.step(1 / 60, 40)
        ends.append([(*b.position, b.angle) for b in boxes])
    assert np.array(ends[0]) == pytest.approx(
        np.array(ends[1]), abs=1e-9
    )  # of a box of 0.02: rounding, grown


def two_blocks(level: str, gap: float = 0.0, k: float = 1e7):
    """Two rubber blocks in a space without gravity, and a rigid ball beside the second."""
    space = pymunk.Space()
    block = shapes.box(0.4, 0.2)
    bodies = []
    for x, y, v, w in ((0.0, 0.0, 1.0, 0.3), (0.45 + gap, 0.05, -0.5, -0.2)):
        body = block.body(density=RUBBER.density * RUBBER.thickness)
        body.position, body.velocity, body.angular_velocity = (x, y), (v, 0.1), w
        bodies.append(body)
    parts = [block.add_to(b) for b in bodies]
    ball = pymunk.Body(3.0, 3.0 * 0.05**2 / 2)
    ball.position, ball.velocity = (0.75, 0.02), (-2.0, 0.0)
    round_one = pymunk.Circle(ball, 0.05)
    round_one.friction = round_one.elasticity = 0.5
    space.add(*bodies, *parts, ball, round_one)
    assembly = Assembly(k=k)
    for shape in parts:
        shape.friction = shape.elasticity = 0.5
        assembly.part(shape, RUBBER, level=level, mesh=None if level == "rigid" else 0.04)
    return space, assembly, [*bodies, ball]


def momentum(bodies):
    """Linear and angular momentum about the origin (3,)."""
    p = sum(np.array(b.velocity) * b.mass for b in bodies)
    turn = sum(b.mass * b.position.cross(b.velocity) + b.moment * b.angular_velocity for b in bodies)
    return np.array([*p, turn])


@pytest.mark.parametrize("level", ["rigid", "compliant", "modal"])
def test_momentum_is_handed_over_exactly(level):
    """Part on part, and a rigid ball on a part: every impulse has its opposite, at one point and one time."""
    space, assembly, bodies = two_blocks(level)
    ra.attach(space, flexible=assembly)
    before = momentum(bodies)
    speed, met = bodies[0].velocity.x, False
    for _ in range(60):
        space.step(1 / 120)
        met |= bool(assembly.forces())
        # the modes' own spin is part of the moment of momentum, as the moment that they exert is
        tolerance = 1e-12 if level != "modal" else 1e-3
        assert momentum(bodies)[:2] == pytest.approx(before[:2], abs=1e-12 * 20)
        assert momentum(bodies)[2] == pytest.approx(before[2], abs=tolerance * 20)
    assert met and bodies[0].velocity.x < speed - 0.1
    assert bodies[2].velocity.x > -1.5  # the ball came at 2


def test_pymunks_joints_hold_a_part():
    """A rubber bar on a PivotJoint: it swings as a pendulum, and the pivot's impulse is what holds it."""
    length, g = 0.6, 9.81
    space = pymunk.Space()
    space.gravity = 0, -g
    bar = shapes.box(length, 0.05)
    body = bar.body(density=100.0)
    body.position = length / 2, 0
    shape = bar.add_to(body)
    pivot = pymunk.PivotJoint(space.static_body, body, (0, 0))
    space.add(body, shape, pivot)
    assembly = Assembly(k=1e7, step=2e-4)
    assembly.part(shape, RUBBER, mesh=0.025)
    ra.attach(space, flexible=assembly)
    from scipy.special import ellipk

    quarter = math.sqrt(length * (1 + (0.05 / length) ** 2 / 4) / (1.5 * g)) * ellipk(0.5)
    frame, angle, times = 1 / 120, [], []
    for i in range(round(1.2 * quarter / frame)):
        space.step(frame)
        angle.append(body.angle)
        times.append((i + 1) * frame)
    assert np.interp(math.pi / 2, -np.array(angle), times) == pytest.approx(
        quarter, rel=2e-3
    )  # of the first order
    # a step leaves the pivot by (w h)²/2 of the arm, error_bias takes 6 times the error back a second
    assert body.local_to_world((-length / 2, 0)).length < 5e-4 * length


def test_joints_between_a_part_and_a_rigid_body():
    """A rubber link on a pivot, a rigid one on its end: a double pendulum keeps its energy, and its joint closed."""
    space = pymunk.Space()
    space.gravity = 0, -9.81
    link = shapes.box(0.4, 0.05)
    one, two = (link.body(density=100.0) for _ in range(2))
    one.position, two.position = (0.2, 0), (0.6, 0)
    shape, other = link.add_to(one), link.add_to(two)
    hinge = pymunk.PivotJoint(one, two, (0.4, 0))
    hinge.collide_bodies = False
    space.add(one, two, shape, other, pymunk.PivotJoint(space.static_body, one, (0, 0)), hinge)
    assembly = Assembly(k=1e7, step=1e-4)
    assembly.part(shape, RUBBER, mesh=0.025)
    contact = ra.attach(space, flexible=assembly)
    before, fallen = contact.energy(), 0.0
    for _ in range(60):
        space.step(1 / 120)
        fallen = min(fallen, two.position.y)
    assert contact.energy() == pytest.approx(before, abs=5e-3 * two.mass * 9.81 * 0.8)
    assert one.local_to_world((0.2, 0)).get_distance(two.local_to_world((-0.2, 0))) < 1e-3 * 0.4
    assert fallen < -0.3


def test_a_spring_acts_once():
    """A part on a DampedSpring without damping: the period of a mass on a spring, 2 π √(m / k)."""
    space = pymunk.Space()
    block = shapes.box(0.2, 0.2)
    body = block.body(density=100.0)
    body.position = 1.1, 0
    shape = block.add_to(body)
    space.add(body, shape, pymunk.DampedSpring(space.static_body, body, (0, 0), (0, 0), 1.0, 400.0, 0.0))
    assembly = Assembly(k=1e7, step=1e-3)
    assembly.part(shape, RUBBER, mesh=0.05)
    ra.attach(space, flexible=assembly)
    frame = 1 / 120
    x = [1.1]
    for _ in range(60):
        space.step(frame)
        x.append(body.position.x)
    crossings = np.flatnonzero(np.diff(np.sign(np.array(x) - 1.0)))
    exact = [c + (x[c] - 1.0) / (x[c] - x[c + 1]) for c in crossings]
    half = np.diff(exact).mean() * frame
    assert half == pytest.approx(
        math.pi * math.sqrt(body.mass / 400.0), rel=1e-3
    )  # chords of the sine, steps of 1 ms


def test_a_limited_motor_has_its_force_once():
    """A brake of a limited moment slows a part's disc at exactly that moment, whatever the frame."""
    for frame in (1 / 60, 1 / 240):
        space = pymunk.Space()
        disc = shapes.circle(0.2)
        body = disc.body(density=100.0)
        body.angular_velocity = 10.0
        shape = disc.add_to(body)
        brake = pymunk.SimpleMotor(space.static_body, body, 0.0)
        brake.max_force = 2.0
        space.add(body, shape, pymunk.PivotJoint(space.static_body, body, (0, 0)), brake)
        assembly = Assembly(k=1e7)
        assembly.part(shape, RUBBER, mesh=0.04)
        ra.attach(space, flexible=assembly)
        for _ in range(round(0.25 / frame)):
            space.step(frame)
        assert body.angular_velocity == pytest.approx(10.0 - 2.0 * 0.25 / body.moment, rel=1e-9)
        assert brake.impulse == pytest.approx(2.0 * frame, rel=1e-9)
        assert brake.max_force == 2.0


def test_a_box_rests_on_a_part():
    """A rigid box on a rubber slab that two pivots hold: it stands, and the pivots carry both weights."""
    space = pymunk.Space()
    space.gravity = 0, -10
    slab = shapes.box(1.0, 0.2)
    body = slab.body(density=100.0)
    shape = slab.add_to(body, friction=0.5)
    pivots = [pymunk.PivotJoint(space.static_body, body, (x, 0.0)) for x in (-0.4, 0.4)]
    box = pymunk.Body(5.0, 5.0 * 2 * 0.2**2 / 12)
    box.position = 0.1, 0.2
    cube = pymunk.Poly.create_box(box, (0.2, 0.2))
    cube.friction = 0.5
    space.add(body, shape, *pivots, box, cube)
    assembly = Assembly(k=1e7)
    assembly.part(shape, RUBBER, mesh=0.05)
    ra.attach(space, flexible=assembly)
    carried = []
    for _ in range(240):
        space.step(1 / 60)
        carried.append(sum(p.impulse for p in pivots) * 60)
    assert box.position.y == pytest.approx(0.2, abs=2e-3)
    assert abs(box.angle) < 1e-2 and box.velocity.length < 1e-2
    assert np.mean(carried[120:]) == pytest.approx(
        (body.mass + box.mass) * 10, rel=0.02
    )  # pivots push apart a little


def test_stress_of_a_part():
    """Two blocks pressed together by forces: the pressure between them over the height is what the stress says."""
    space, assembly, (one, two, ball) = two_blocks("compliant", gap=-0.05)
    two.position, two.angle = (0.4, 0.001), 0.0
    for body in (one, two):
        body.velocity, body.angular_velocity = (0, 0), 0
    space.remove(ball, *ball.shapes)
    space.damping = 1e-30  # a second: vibrations die
    ra.attach(space, flexible=assembly)
    for _ in range(200):
        one.force, two.force = (1000.0, 0.0), (-1000.0, 0.0)
        space.step(1 / 240)
    ((_, force),) = assembly.forces().items()
    # a force on the frame is spread over the block: half of it is left in the middle
    stress = assembly.state(0).stress[:, 0]
    assert force[0] == pytest.approx(1000.0, rel=0.05)
    assert stress.mean() == pytest.approx(-0.5 * force[0] / (0.2 * RUBBER.thickness), rel=0.02)
    rows = [r for r in ra.attached(space).regions if r["body_a"] is one]
    assert sum(r["force"] for r in rows) == pytest.approx(math.hypot(*force), rel=0.02)


@pytest.mark.parametrize("way", ["copy", "pickle"])
def test_a_copy_goes_on_as_its_original(way):
    space, assembly, _ = two_blocks("compliant", gap=-0.049)
    ra.attach(space, flexible=assembly)
    for _ in range(4):
        space.step(1e-3)
    assert assembly.forces()
    twin = copy.deepcopy(space) if way == "copy" else pickle.loads(pickle.dumps(space))
    for _ in range(10):
        space.step(1e-3)
        twin.step(1e-3)
    ends = [[(*b.position, b.angle, *b.velocity) for b in s.bodies] for s in (space, twin)]
    assert np.array(ends[0]) == pytest.approx(np.array(ends[1]), rel=1e-9)


def test_detached_bodies_are_pymunks_again():
    space, assembly, bodies = two_blocks("compliant")
    contact = ra.attach(space, flexible=assembly)
    space.step(1 / 60)
    contact.detach()
    at, v = bodies[0].position, bodies[0].velocity
    space.step(1 / 60)
    assert bodies[0].position.x == pytest.approx(at.x + v.x / 60, rel=1e-12)
    with pytest.raises(RuntimeError, match="in no space"):
        assembly.forces()
    ra.attach(space, flexible=assembly)  # and back


def test_refusals():
    space, assembly, (one, *_rest) = two_blocks("rigid")
    (shape,) = one.shapes
    with pytest.raises(ValueError, match="one part a body"):
        assembly.part(shape, RUBBER, level="rigid")
    with pytest.raises(ValueError, match="k must be positive"):
        Assembly(k=-1.0)
    with pytest.raises(ValueError, match="mesh, the spacing"):
        Assembly(k=1.0).part(shape, RUBBER)
    with pytest.raises(ValueError, match="neither clamp nor hub"):
        Assembly(k=1.0).part(shape, RUBBER, level="rigid", hub=1)
    with pytest.raises(ValueError, match="static"):
        Assembly(k=1.0).part(pymunk.Circle(space.static_body, 1.0), RUBBER, level="rigid")
    with pytest.raises(ValueError, match="Assembly, got int"):
        ra.attach(space, flexible=3)
    with pytest.raises(ValueError, match="at least 1 part"):
        ra.attach(space, flexible=Assembly(k=1.0))
    assert ra.attached(space) is None
    ra.attach(space, flexible=assembly)
    with pytest.raises(RuntimeError, match="before attach"):
        assembly.part(shape, RUBBER, level="rigid")
    with pytest.raises(ValueError, match="in a space already"):
        ra.attach(pymunk.Space(), flexible=assembly)
    at = one.position
    space.remove(shape)
    with pytest.raises(RuntimeError, match="part 0 has left the space"):
        space.step(1 / 60)
    assert one.position == at
