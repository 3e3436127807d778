"""Bodies that start overlapped, or that something is moved into, are taken apart at a bounded speed."""

import math

import numpy as np
import pymunk
import pytest
from solve_world import DT, ENGINE, World, overlap

import rigidarea

#: Speed at which overlap is taken apart, at most, in sizes of a body (its largest extent) a second. A fast hand:
#: Box2D's bodies of a metre are parted at 3 m/s, pymunk's bias (1 - 0.1) of the depth a sixtieth of a second is faster.
PARTING = 4.0
#: By when two bodies lie apart, or at rest on their bed (s): from half a size deep even a tenth of the speed would do.
PARTED = 3.0
KEPT = 1e-9 if ENGINE == "area" else 0.05
SETTINGS = [(None, None), (None, 1), (None, 4), (None, 32), (1e3, None), (1e9, None), (1e9, 1)]
G = 10.0
REST = pymunk.Vec2d(0, 0)


def fastest_ever(world, seconds, steps, since=REST):
    """Largest speed of any body relative to the common one `since`, at the end of any frame."""
    worst = 0.0
    for _ in range(round(seconds / DT)):
        world.step(steps)
        worst = max(worst, *((b.velocity - since).length for b in world.bodies))
    return worst


def pair(world, kind, depth, size, ratio=1.0, velocity=(0.0, 0.0)):
    """Two bodies of `size`, the second `depth` of a size deep in the first, a little aside."""
    for i in range(2):
        at = ((1 - depth) * size * i, 0.1 * size * i)
        mass = ratio**i
        if kind == "boxes" or (kind == "box and disc" and i):
            world.box(at, (size, size), mass=mass, velocity=velocity)
        elif kind == "tilted":
            world.box(at, (size, 0.8 * size), mass=mass, angle=0.5 * i, velocity=velocity)
        else:
            world.disc(at, size / 2, mass=mass, velocity=velocity)


@pytest.mark.parametrize("stiffness, steps", SETTINGS)
@pytest.mark.parametrize("depth", [0.05, 0.4, 0.8])
@pytest.mark.parametrize("kind", ["boxes", "discs", "box and disc", "tilted"])
def test_two_free_bodies_are_parted_gently(kind, depth, stiffness, steps):
    """No gravity, no speed: each goes its way at PARTING sizes a second at most, momenta stay as they are.

    With a common speed of 100 sizes a second the same (Galilei).
    """
    for common in ((0.0, 0.0), (100.0, 40.0)):
        world = World(stiffness=stiffness or 1e5, friction=0.5)
        pair(world, kind, depth, 1.0, velocity=common)
        before = world.momentum()
        since = pymunk.Vec2d(*common)
        worst = fastest_ever(world, PARTED, steps, since)
        assert worst < PARTING, common
        assert overlap(world) < 0.01, common
        gone = np.abs(before).max() + 1.0
        assert world.momentum() == pytest.approx(before, abs=KEPT * gone * 10), common


@pytest.mark.parametrize("ratio", [1.0, 100.0])
@pytest.mark.parametrize("steps", [1, None])
def test_pixels_and_mass_ratio(steps, ratio):
    """Two discs of 15 px, 4.5 px apart, no gravity (seen: 7,400 px/s), and the same with a hundredfold mass."""
    world = World(stiffness=1e4, friction=0.5)
    pair(world, "discs", 1 - 4.5 / 30, 30.0, ratio)
    before = world.momentum()
    # the light one takes the whole relative speed
    assert fastest_ever(world, PARTED, steps) < PARTING * 30.0
    assert overlap(world) < 0.01 * 30.0**2
    assert world.momentum() == pytest.approx(before, abs=KEPT * 30 * 100)


@pytest.mark.parametrize("stiffness, steps", SETTINGS)
@pytest.mark.parametrize("depth", [0.05, 0.4])
def test_two_boxes_on_the_floor_do_not_fly(depth, stiffness, steps):
    """A box 0.4 deep in another that lies on the floor (seen: y = 64 m; pymunk 1.4).

    Thrown at PARTING it would rise by PARTING²/2g = 0.8 m; in the end it lies on top.
    """
    world = World(G, stiffness=stiffness, friction=0.5)
    world.floor()
    world.box((0, 0.5))
    upper = world.box((0.05, 1.5 - depth))
    highest = 0.0
    for _ in range(240):
        world.step(steps)
        highest = max(highest, upper.position.y)
    assert highest < 1.5 + PARTING**2 / (2 * G)
    sink = 3 * G / stiffness if stiffness else 6e-4
    resting = [b.position.y for b in world.bodies]
    assert resting == pytest.approx([0.5, 1.5], abs=2 * sink + 2e-3)
    assert world.fastest() < 0.01


@pytest.mark.parametrize("stiffness, steps", SETTINGS)
def test_falling_together_overlapped(stiffness, steps):
    """In the falling frame they part as without gravity."""
    world = World(G, stiffness=stiffness, friction=0.5)
    pair(world, "boxes", 0.4, 1.0)
    for i in range(60):
        world.step(steps)
        falling = pymunk.Vec2d(0, -G * (i + 1) * DT)
        assert max((b.velocity - falling).length for b in world.bodies) < PARTING
    assert overlap(world) < 0.01


@pytest.mark.parametrize("gravity", [0.0, G])
@pytest.mark.parametrize("stiffness, steps", SETTINGS)
@pytest.mark.parametrize("kind", [pymunk.Body.STATIC, pymunk.Body.KINEMATIC])
def test_a_body_moved_into_others(kind, stiffness, steps, gravity):
    """A static or kinematic block is set into a row of resting boxes, its velocity 0: they leave it gently."""
    world = World(gravity, stiffness=stiffness or 1e5, friction=0.5)
    world.floor()
    boxes = [world.box((1.01 * i, 0.5)) for i in range(3)]
    block = world.box((-20, 0.6), (1.0, 1.2), kind=kind)
    world.run(0.5, steps)
    block.position = -0.7, 0.6  # 0.3 deep in the first box
    world.space.reindex_shapes_for_body(block)
    assert fastest_ever(world, PARTED, steps) < PARTING
    assert boxes[0].position.x > -0.2 + 0.5 - 2 * 0.01  # clear of the block, whose right face is at -0.2
    assert all(b.position.y > 0.47 for b in boxes)  # at 1e3 N/m² they sink by 10 mm


@pytest.mark.parametrize("steps", [1, None])
def test_a_body_teleported_into_a_pile(steps):
    """Spawned in the middle of a resting pyramid: nothing faster than PARTING and what falling from there gives."""
    world = World(G, friction=0.5)
    world.floor()
    for row in range(5):
        for i in range(5 - row):
            world.box((1.1 * (i - (4 - row) / 2), 0.5 + row))
    world.run(1.0, steps)
    world.box((0.1, 1.7), (0.8, 0.8))
    # a body that is pushed up and falls back from the height of the pile
    assert fastest_ever(world, 4.0, steps) < math.sqrt(PARTING**2 + 2 * G * 5.0)
    assert max(b.position.y for b in world.bodies) < 7.0 and min(b.position.y for b in world.bodies) > 0.3


@pytest.mark.parametrize("steps", [1, 4, None])
def test_three_in_one_place(steps):
    """Three boxes spawned at one point (a hair apart) without gravity go apart, at no more than twice PARTING."""
    world = World(stiffness=1e5, friction=0.3)
    for i in range(3):
        world.box((0.01 * i, 0.013 * i * i), angle=0.2 * i)
    before = world.momentum()
    assert fastest_ever(world, 2 * PARTED, steps) < 2 * PARTING
    assert overlap(world) < 0.01
    assert world.momentum() == pytest.approx(before, abs=KEPT * 30)


@pytest.mark.parametrize("steps", [1, None])
def test_what_is_pushed_in_by_an_impact_is_not_what_starts_inside(steps):
    """A fast impact that a long step finds deep inside returns its e all the same: no bound on what was not spawned."""
    world = World(stiffness=1e7, elasticity=1.0)
    world.block(-5, -3, 5, 0)
    body = world.box((0, 1.0), velocity=(0, -20))  # 0.33 m a frame, half a metre over the block
    world.step(steps, 20)
    assert body.velocity.y == pytest.approx(20, abs=0.002 * 20)


@pytest.mark.skipif(ENGINE != "area", reason="pymunk's own is the one to compare with")
@pytest.mark.parametrize("size", [(24.0, 8.0), (30.0, 6.0)])
def test_links_that_overlap_and_collide_lie_still(size):
    """A chain whose neighbours overlap where they are hinged, as pymunk lets them: a velocity is that of what moves.

    What the joints held overlapped went on at up to 14 px/s for ever, though nothing moved.
    """
    space = pymunk.Space()
    space.gravity = 0, -900
    floor = pymunk.Segment(space.static_body, (-400, 0), (400, 0), 5)
    floor.friction = 0.7
    space.add(floor)
    before = None
    for i in range(20):
        link = pymunk.Body()
        link.position = 20 * i - 200, 12
        shape = pymunk.Poly.create_box(link, size)
        shape.mass, shape.friction = 0.5, 0.7
        space.add(link, shape)
        if before:
            space.add(pymunk.PivotJoint(before, link, (20 * i - 210, 12)))
        before = link
    rigidarea.attach(space)
    for _ in range(300):
        space.step(DT)
    # of the 15 px/s that a kick gives
    assert max(link.velocity.length for link in space.bodies) < 0.01
