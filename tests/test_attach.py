"""attach(): what it returns, the same bits from run to run."""

import hashlib
import math
import subprocess
import sys
import textwrap

import numpy as np
import pymunk
import pytest

import rigidarea as ra

G = 10.0
DT = 1 / 960


def floor(space, friction=0.8, elasticity=0.6, thick=False):
    shape = pymunk.Segment(space.static_body, (-50, -0.5 * thick), (50, -0.5 * thick), 0.5 * thick)
    shape.friction, shape.elasticity = friction, elasticity
    space.add(shape)
    return shape


def put(
    space, shape_of, position, angle=0.0, velocity=(0, 0), spin=0.0, mass=1.0, friction=0.7, elasticity=0.5
):
    body = pymunk.Body(mass, 0.2 * mass)
    shape = shape_of(body)
    shape.friction, shape.elasticity = friction, elasticity
    body.position, body.angle, body.velocity, body.angular_velocity = position, angle, velocity, spin
    space.add(body, shape)
    return body


def outline(points, holes=()):
    made = ra.Outline(points, holes)
    return made.add_to


def square(body):
    return pymunk.Poly.create_box(body, (1, 1))


def disc(body):
    return pymunk.Circle(body, 0.5)


CUP = outline(
    [(-0.9, -0.6), (0.9, -0.6), (0.9, 0.9), (0.6, 0.9), (0.6, -0.3), (-0.6, -0.3), (-0.6, 0.9), (-0.9, 0.9)]
)
RING = outline([(-1, -1), (1, -1), (1, 1), (-1, 1)], [[(-0.7, -0.7), (0.7, -0.7), (0.7, 0.7), (-0.7, 0.7)]])


def scene_stack(space):
    floor(space)
    for i in range(4):
        put(space, square, (0.1 * i, 0.6 + 1.1 * i), angle=0.02 * i)


def scene_bounce(space):
    floor(space, elasticity=1.0)
    for i in range(5):
        put(
            space,
            disc if i % 2 else square,
            (2.5 * i, 1.5),
            0.3 * i,
            (1, 0),
            spin=2.0 * i,
            elasticity=0.2 * (i + 1),
        )


def scene_holes(space):
    floor(space, thick=True)
    put(space, RING, (0, 1.5), 0.3, (0.5, 0))
    put(space, disc, (0.05, 1.6), spin=8.0)
    put(space, CUP, (4, 1.2), -0.4)
    put(space, disc, (4.0, 3.2), velocity=(0.1, -1))
    put(space, lambda b: pymunk.Segment(b, (-0.6, 0), (0.6, 0), 0.1), (4.3, 4.5), 0.7)


def scene_slopes(space):
    """Segments without thickness, in a zigzag, entered from both sides; a conveyor; a kinematic paddle."""
    for a, b in (((-4, 3), (2, 1.5)), ((5, 1.0), (-1, -0.5)), ((-4, -3), (6, -2))):
        shape = pymunk.Segment(space.static_body, a, b, 0)
        shape.friction, shape.elasticity = 0.3, 0.5
        space.add(shape)
    shape.surface_velocity = 0.7, 0
    paddle = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    paddle.position, paddle.angular_velocity = (3, -1.2), 1.5
    space.add(paddle, pymunk.Poly.create_box(paddle, (2, 0.2)))
    put(space, disc, (-3, 4))
    put(space, square, (-2, 4.5), 0.5)
    put(space, lambda b: pymunk.Poly.create_box(b, (0.8, 0.5), 0.1), (0, 3), 1.0)
    put(space, disc, (0, -1.5), velocity=(0, 6))


SCENES = {
    f.__name__.removeprefix("scene_"): f for f in (scene_stack, scene_bounce, scene_holes, scene_slopes)
}


def state(space):
    return np.array([(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in space.bodies])


def trajectory(scene, n=2000, **settings):
    space = pymunk.Space()
    space.gravity = 0, -G
    settings.setdefault("stiffness", 5e4)
    contact = ra.attach(space, **settings)
    SCENES[scene](space)
    states, regions = [], 0
    for _ in range(n):
        space.step(DT)
        states.append(state(space))
        regions += len(contact.regions)
    assert regions > n / 8
    return np.array(states)


# --- determinism ---

PROGRAM = """
    import hashlib, sys
    sys.path.insert(0, {here!r})
    import test_attach as t
    if {noise}:  # other spaces before and beside it, and other memory
        junk = [bytearray(1000 * i) for i in range(200)]
        t.trajectory("bounce", n=900)
        t.trajectory("holes", n=900, integration="explicit")
    for scene in t.SCENES:
        states = t.trajectory(scene, n=1200)
        print(scene, hashlib.sha256(states.tobytes()).hexdigest())
"""


def test_the_same_bits_from_two_processes_whatever_came_before():
    from pathlib import Path

    here = str(Path(__file__).parent)
    told = []
    for noise in (False, True):
        code = textwrap.dedent(PROGRAM.format(here=here, noise=noise))
        run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=300)
        assert run.returncode == 0, run.stderr[-2000:]
        told.append(run.stdout)
    assert told[0] == told[1] and len(told[0].splitlines()) == len(SCENES)
    mine = [f"{scene} {hashlib.sha256(trajectory(scene, n=1200).tobytes()).hexdigest()}" for scene in SCENES]
    assert told[0].splitlines() == mine  # a third process, with pytest in it


# --- what attach returns ---


def test_attached_finds_the_contact():
    space = pymunk.Space()
    assert ra.attached(space) is None
    contact = ra.attach(space, 1e4)
    assert ra.attached(space) is contact and contact.space is space
    contact.detach()
    assert ra.attached(space) is None
    assert ra.attach(space, 2e4).stiffness == 2e4


@pytest.mark.parametrize("integration", ["implicit", "explicit"])
def test_regions_tell_what_happened(integration):
    """Every field of one resting and sliding contact, and its signs, for either order of the shapes."""
    for first in ("floor", "box"):
        space = pymunk.Space()
        space.gravity = 0, -G
        contact = ra.attach(space, 5e4, integration=integration)
        ground = None
        if first == "floor":
            ground = floor(space, friction=0.5)
        body = put(space, square, (0, 0.5 - 2 * G / 5e4), mass=2.0, friction=0.8, elasticity=0.0)
        ground = ground or floor(space, friction=0.5)
        (shape,) = body.shapes
        assert len(contact.regions) == 0 and contact.regions.dtype == ra.REGIONS
        for _ in range(200):
            space.step(DT)
        body.velocity = 1.5, 0
        for _ in range(100):  # a hundred steps on it slides steadily
            space.step(DT)
        (r,) = contact.regions
        a, b = (ground, shape) if first == "floor" else (shape, ground)
        assert r["shape_a"] is a and r["shape_b"] is b and r["body_a"] is a.body and r["body_b"] is b.body
        up = 1 if first == "floor" else -1  # from A to B
        assert tuple(r["direction"]) == pytest.approx((0, up), abs=1e-9)
        # the tilt: friction's moment mu m g / 2 turns the pressure, the resultant stays m g
        assert r["force"] == pytest.approx(2 * G, rel=1e-2)
        assert r["area"] == pytest.approx(
            r["force"] / 5e4, rel=1e-2
        )  # it still sways: the dashpot has a share
        assert r["chord"] == pytest.approx(1.0, abs=0.25)
        speed = body.velocity.x
        assert 0 < speed < 1.5
        # friction on B along (0, up) turned by +90 degrees = (-up, 0); it acts against the box's motion
        on_box = r["friction"] * -up * (1 if first == "floor" else -1)
        assert on_box == pytest.approx(-0.4 * r["force"], rel=1e-12)
        # slip of A relative to B along the same; the box's speed then was one step's braking higher
        along = -up * (0 - speed if first == "floor" else speed - 0)
        assert r["slip"] == pytest.approx(along, rel=1e-2)
        assert abs(r["speed"]) < 1e-2


def test_regions_of_a_bar_across_a_cup_are_two():
    space = pymunk.Space()
    contact = ra.attach(space, 5e4)
    body = put(space, CUP, (0, 0))
    bar = put(space, lambda b: pymunk.Poly.create_box(b, (3, 0.5)), (0, 1.1499))
    space.step(1e-8)  # of no length, nearly: nothing moves
    regions = contact.regions
    assert len(regions) == 2
    assert {(r["body_a"], r["body_b"]) for r in regions} == {(body, bar)}
    assert sorted(regions["centroid"][:, 0]) == pytest.approx([-0.75, 0.75], abs=1e-6)
    assert regions["area"] == pytest.approx([0.3e-4, 0.3e-4], rel=1e-6)


def test_energy_of_a_space_without_contact_is_kinetic_and_potential():
    space = pymunk.Space()
    space.gravity = 3, -G
    contact = ra.attach(space, 1e4)
    body = put(space, square, (2, 5), velocity=(3, 4), spin=2.0, mass=2.0)
    body.center_of_gravity = 0.5, 0
    body.position = 2, 5
    # centre of gravity at (2.5, 5)
    exact = 0.5 * 2 * 25 + 0.5 * body.moment * 4 - 2 * (3 * 2.5 - G * 5)
    assert contact.energy() == pytest.approx(exact, rel=1e-14)


def test_energy_stored_in_a_pressed_box_is_half_k_depth_squared():
    space = pymunk.Space()
    contact = ra.attach(space, 1e4)
    floor(space, friction=0.0)
    put(space, square, (0, 0.49), friction=0.0)
    space.step(1e-9)  # of no length, nearly: nothing moves
    # k times integral of depth^2 / 2 over the face of 1 m
    assert contact.energy() == pytest.approx(0.5 * 1e4 * 0.01**2, rel=1e-6)


@pytest.mark.parametrize(
    "step", [lambda s, c: s.step(1e-3), lambda s, c: c.step(1e-3)], ids=["space", "contact"]
)
def test_stiffness_is_chosen_for_each_pair(step):
    """m g / (penetration size^2), by either way of stepping; contact.stiffness itself is None then."""
    space = pymunk.Space()
    space.gravity = 0, -G
    contact = ra.attach(space, penetration=1e-3)
    floor(space)
    light = put(space, square, (0, 0.49999))
    heavy = put(space, square, (5, 0.49999), mass=100.0)
    step(space, contact)
    assert contact.stiffness is None
    chosen = {(r["body_a"] if r["body_b"] is space.static_body else r["body_b"]): r for r in contact.regions}
    assert chosen[light]["stiffness"] == pytest.approx(G / 1e-3, rel=1e-12)
    assert chosen[heavy]["stiffness"] == pytest.approx(100 * G / 1e-3, rel=1e-12)
    contact.stiffness = 3e4  # from now on everywhere
    step(space, contact)
    assert set(contact.regions["stiffness"]) == {3e4} and contact.stiffness == 3e4


def test_a_user_of_pymunk_needs_one_line_more():
    """The README's promise: the same scene, native and attached, ends alike."""
    ends = []
    for attach in (False, True):
        space = pymunk.Space()
        space.gravity = 0, -G
        if attach:
            ra.attach(space)
        floor(space, friction=1.0, elasticity=0.0)
        body = put(space, square, (0, 0.5), velocity=(3, 0), friction=0.3, elasticity=0.0)
        for _ in range(2 * 960):
            space.step(DT)
        ends.append(body.position.x)
    assert ends == pytest.approx([9 / (2 * 0.3 * G)] * 2, rel=0.01)  # v^2 / (2 mu g)


def test_moving_a_body_by_hand_and_refresh():
    """Teleporting into and out of contact; vertices changed by unsafe_set_vertices are read after refresh()."""
    space = pymunk.Space()
    space.gravity = 0, -G
    contact = ra.attach(space, 5e4)
    floor(space, elasticity=0.0)
    body = put(space, square, (0, 5))
    space.step(DT)
    body.position = 3, 0.4999
    space.step(DT)
    assert len(contact.regions) == 1
    body.position = 3, 8
    space.step(DT)
    assert len(contact.regions) == 0
    (shape,) = body.shapes
    shape.unsafe_set_vertices([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    contact.refresh(shape)
    body.position, body.velocity = (3, 1.0), (0, 0)
    for _ in range(2000):
        space.step(DT)
    assert body.position.y == pytest.approx(1.0 - G / 5e4 / 2, abs=1e-6)
    assert math.isfinite(contact.energy())
