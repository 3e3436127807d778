"""Flexible parts on floors and joints: they lie, bounce, swing and wake as rigid bodies do, whatever the steps."""

import copy

import pymunk
import pytest

import rigidarea as ra
from rigidarea import shapes
from rigidarea.flexible import Assembly, Material

G = 9.81
SOFT = Material(1e7, 0.3, 1000.0, 0.01)
LEVELS = ["rigid", "compliant", "modal"]


def on_a_floor(outline, heights, level, elasticity=0.0, **keys):
    """Bodies of 10 kg/m² over a static floor, parts but with ``level`` None: their space, contact, assembly, bodies."""
    space, bodies = pymunk.Space(), []
    space.gravity = 0, -G
    assembly = Assembly(k=1e7, **keys)
    for height in heights:
        body = outline.body(density=10.0)
        body.position = 0, height
        shape = outline.add_to(body, friction=0.5, elasticity=elasticity)
        space.add(body, shape)
        bodies.append(body)
        if level is not None:
            assembly.part(shape, SOFT, mesh=None if level == "rigid" else 0.025, level=level)
    floor = pymunk.Segment(space.static_body, (-2, -0.1), (2, -0.1), 0.1)
    floor.friction, floor.elasticity = 0.5, 1.0
    space.add(floor)
    contact = ra.attach(space, flexible=None if level is None else assembly)
    return space, contact, assembly, bodies


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize(
    ("frame", "step"), [(1 / 60, None), (1 / 60, 1e-3), (1 / 240, None), (1 / 240, 1e-3)]
)
def test_a_part_lies_on_a_floor(level, frame, step):
    """As deep as a body that is no part: by n steps a frame it once sank at g dt (n - 1) / 2n, through the floor."""
    for count in (1, 2):
        depth = []
        for what in (None, level):
            keys = {"step": step} if what else {}
            space, _, _, bodies = on_a_floor(
                shapes.box(0.4, 0.1), [0.05 + 0.1 * i for i in range(count)], what, **keys
            )
            for _ in range(round(2 / frame)):
                space.step(frame)
            depth.append([0.05 + 0.1 * i - b.position.y for i, b in enumerate(bodies)])
            # what is left trembles by a part of what a frame of gravity gives
            assert max(b.velocity.length for b in bodies) < 0.1 * G * frame
        # a body's own stiffness follows its load, and that between parts is the assembly's: a few hundredths of a mm
        assert depth[1] == pytest.approx(depth[0], abs=4e-5)


@pytest.mark.parametrize("steps", [4, 8, 16])
def test_a_part_that_is_pressed_in_comes_out(steps):
    """What takes it out of the floor is as much whatever the substeps, which all see one overlap: it once went too far,
    and flew off."""
    _, contact, _, (body,) = on_a_floor(shapes.box(0.4, 0.1), [0.047], "rigid")
    highest = 0.0
    for _ in range(120):
        contact.step(1 / 60, steps=steps)
        highest = max(highest, body.position.y)
    assert 0.05 - 1e-3 < body.position.y and highest < 0.05 + 1e-6


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("frame", [1 / 60, 1 / 240])
def test_a_part_bounces_as_high_as_it_fell_from(level, frame):
    """Restitution 1: energy is that of the start, to rounding. A leapfrog's velocity is of the time of its place, so a
    blow changes its sign alone."""
    space, _, _, (body,) = on_a_floor(shapes.circle(0.1), [1.1], level, elasticity=1.0)
    energy, bounces = [], 0
    for _ in range(round(4 / frame)):
        before = body.velocity.y
        space.step(frame)
        bounces += before < 0 < body.velocity.y
        energy.append(0.5 * body.velocity.length**2 + G * (body.position.y - 0.1))
    assert bounces >= 4
    assert energy == pytest.approx([G] * len(energy), rel=1e-9)


@pytest.mark.parametrize("level", LEVELS)
def test_a_part_that_lands_lies_on_the_floor(level):
    """Restitution 0, from 1 m: it comes to rest, and as near the floor as the area contact lets a body lie."""
    space, _, _, (body,) = on_a_floor(shapes.circle(0.1), [1.1], level)
    for _ in range(180):
        space.step(1 / 60)
    assert -1e-4 < body.position.y - 0.1 < 0  # it fell through 7 cm in a frame
    assert body.velocity.length < 1e-3


@pytest.mark.parametrize("level", LEVELS)
def test_a_part_does_not_sleep(level):
    """Nor does what lies on it; asleep it once fell on through the floor."""
    space, _, _, bodies = on_a_floor(shapes.box(0.4, 0.1), [0.05], level)
    space.sleep_time_threshold = 0.2
    box = pymunk.Body(0.1, 1e-4)
    box.position = 0, 0.12
    space.add(box, pymunk.Poly.create_box(box, (0.04, 0.04)))
    for _ in range(120):
        space.step(1 / 60)
        assert not bodies[0].is_sleeping and not box.is_sleeping
    bodies[0].sleep()
    space.step(1 / 60)
    assert not bodies[0].is_sleeping
    assert abs(bodies[0].position.y - 0.05) < 1e-4


def test_a_copy_lies_as_its_original():
    """It goes on with the load that its original bears, and with what moves that out of the floor."""
    space, *_ = on_a_floor(shapes.box(0.4, 0.1), [0.05, 0.15], "rigid")
    for _ in range(20):
        space.step(1 / 60)
    twin = copy.deepcopy(space)
    for _ in range(5):
        space.step(1 / 60)
        twin.step(1 / 60)
    ends = [[x for b in s.bodies for x in (*b.position, b.angle, *b.velocity)] for s in (space, twin)]
    assert ends[1] == pytest.approx(ends[0], abs=1e-9)


def swinging(level, k=None):
    """A bar of 1 m from a pivot at its end, or on a spring of stiffness k without damping: its space and body."""
    space = pymunk.Space()
    space.gravity = 0, -G
    bar = shapes.box(1, 0.1)
    body = bar.body(density=10.0)
    body.position = (0.5, 0) if k is None else (0, -1)
    shape = bar.add_to(body)
    joint = (
        pymunk.PivotJoint(space.static_body, body, (0, 0))
        if k is None
        else pymunk.DampedSpring(space.static_body, body, (0, 0), (0, 0), 1, k, 0)
    )
    space.add(body, shape, joint)
    assembly = Assembly(k=1e6)
    assembly.part(
        shape, Material(1e9, 0.3, 1000.0, 0.01), mesh=None if level == "rigid" else 0.05, level=level
    )
    ra.attach(space, flexible=assembly)
    return space, body


@pytest.mark.parametrize("level", LEVELS)
def test_a_spring_swings_on(level):
    """2 m g / k from top to bottom, after 20 s as at first: steps that follow the speed pump no swing."""
    space, body = swinging(level, 100.0)
    y = []
    for _ in range(20 * 60):
        space.step(1 / 60)
        y.append(body.position.y)
    # 0.2 %: leapfrog's (ω h)²/8 at one step a frame, and what frames miss of the turning points
    for part in (y[:120], y[-120:]):
        assert max(part) - min(part) == pytest.approx(2 * body.mass * G / 100.0, rel=2e-3)


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("bias", [None, 0.0])
def test_a_pendulum_swings_on(level, bias):
    """Let go horizontally, it has the energy of the start after 20 s, and the pivot is closed, however errors of place
    are taken back: a step round a bend makes none to second order."""
    space, body = swinging(level)
    (pivot,) = space.constraints
    if bias is not None:
        pivot.error_bias = bias
    worst, off = 0.0, 0.0
    for _ in range(20 * 60):
        space.step(1 / 60)
        kinetic = 0.5 * body.mass * body.velocity.length**2 + 0.5 * body.moment * body.angular_velocity**2
        worst = max(worst, abs(kinetic / (body.mass * G * 0.5) + body.position.y / 0.5))
        off = max(off, abs(body.position.length - 0.5))
    assert worst < 2e-3  # (ω h)²/4 of it comes and goes, ω h = 0.06 where it is fastest
    assert off < 1e-4


def test_regions_of_parts():
    """Those that touch, and no rows of evaluations long past; also with no pair of parts at all."""
    space, contact, _, (body,) = on_a_floor(shapes.box(0.4, 0.1), [0.05], "compliant")
    for _ in range(30):
        space.step(1 / 60)
    assert sum(contact.regions["force"]) == pytest.approx(body.mass * G, rel=1e-3)
    space, contact, assembly, (one, two) = on_a_floor(shapes.circle(0.1), [5.0, 5.3], "compliant", 1.0)
    space.gravity = 0, 0
    two.velocity = 0, -0.5
    seen = set()
    for _ in range(60):
        space.step(1 / 60)
        seen.add(len(contact.regions))
        assert (len(contact.regions) > 0) == bool(assembly.forces())
    assert seen <= {0, 1} and one.velocity.y < two.velocity.y
