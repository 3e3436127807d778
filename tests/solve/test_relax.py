"""What opens overlaps gives no speed; what is calm takes one substep; nothing tumbles through a segment."""

import math

import pytest
from solve_world import DT, World, area_only


@area_only
@pytest.mark.parametrize("steps", [1, 2, 4, None])
def test_what_is_pressed_in_comes_out_without_speed(steps):
    """A box set 2 % of its side into the floor rises to its bed; at no frame's end does it go at a tenth of the speed
    that has moved it, 0.02 m in (1 + S) substeps. (The shorter the step, the more of that is the spring's own.)
    """
    world = World(10.0, friction=0.5)
    world.floor()
    box = world.box((0, 0.48))
    fastest = 0.0
    for _ in range(90):
        world.step(steps)
        fastest = max(fastest, abs(box.velocity.y))
    assert box.position.y == pytest.approx(0.5, abs=4e-4)
    assert fastest < 0.1 * 0.02 / (9.0 * DT / (steps or 2))


@area_only
def test_ten_boxes_pressed_together_do_not_throw_each_other():
    """Each 2 % too deep, 0.2 m in all: the pile grows to its height, and no box above it by more than a hundredth."""
    world = World(10.0, friction=0.5)
    world.floor()
    boxes = [world.box((0, 0.48 + 0.98 * i)) for i in range(10)]
    highest = 0.0
    for _ in range(240):
        world.step(None)
        highest = max(highest, boxes[-1].position.y)
    assert boxes[-1].position.y == pytest.approx(9.5, abs=0.02)
    assert highest < 9.51


@area_only
def test_what_is_calm_takes_one_substep():
    """At rest one, two from the frame on in which somebody moves; and the bed is the same."""
    world = World(10.0, stiffness=1e5, friction=0.5)
    world.floor()
    boxes = [world.box((0, 0.5 + i)) for i in range(3)]
    world.run(3.0, None)
    assert world.contact.step(DT) == 1
    before = [b.position.y for b in boxes]
    world.step(2, 30)
    assert [b.position.y for b in boxes] == pytest.approx(before, abs=1e-6)  # the bed is 1e-4 deep
    world.step(None, 10)
    boxes[2].velocity = 1.0, 0.0
    assert world.contact.step(DT) == 2


@pytest.mark.parametrize("seed", range(6))
def test_what_tumbles_fast_stays_in_its_room(seed):
    """Eight boxes of 30 px at 1e4 px/s in a room of four segments: no middle is farther out than half a diagonal.

    Nor is anybody faster than all energy of the start in one body: 1e4 sqrt(8) px/s.
    """
    world = World(elasticity=0.9, friction=0.3, stiffness=1e5)
    corners = [(0, 0), (600, 0), (600, 400), (0, 400)]
    for a, b in zip(corners, corners[1:] + corners[:1]):
        world.segment(a, b)
    for i in range(8):
        aim = 0.7 + i + 0.13 * seed
        velocity = (1e4 * math.cos(aim), 1e4 * math.sin(aim))
        world.box((60 + 65 * i, 200), (30, 30), angle=0.3 * i, velocity=velocity)
    out = 15 * math.sqrt(2) + 1
    for _ in range(90):
        world.step(None)
        for b in world.bodies:
            assert -out < b.position.x < 600 + out and -out < b.position.y < 400 + out
            assert b.velocity.length < 1e4 * math.sqrt(8)


@area_only
@pytest.mark.parametrize("steps", [1, 2, 4, None])
def test_six_discs_in_three_rows_lie_still(steps):
    """Rolling on each other they stand by friction alone, of exactly as many contacts as they need (2 x 9 for 3 x 6).

    A friction spring that does not take what relaxing has moved them by creeps, and so does one that turns under
    velocities that contacts have yet to stop: they roll apart within 4 s.
    """
    world = World(900.0, friction=1.5)
    world.floor()
    radius = 12.0
    discs = [
        world.disc(((k - (2 - row) / 2) * 2.002 * radius, radius + row * math.sqrt(3) * radius), radius)
        for row in range(3)
        for k in range(3 - row)
    ]
    world.run(3.0, steps)
    places = [disc.position for disc in discs]
    world.run(3.0, steps)
    moved = max((disc.position - place).length for disc, place in zip(discs, places, strict=True))
    assert moved < 1e-3  # px: a fifth of a bed's depth at 2e-4
    assert max(disc.velocity.length for disc in discs) < 1e-3  # px/s, of the 15 that a frame of gravity gives
