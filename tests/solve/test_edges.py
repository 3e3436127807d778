"""Edges that are none, and places that are touched next: butted tiles, and a disc in a groove."""

import math

import pymunk
import pytest

import rigidarea as ra
from rigidarea.study.peers import get_peer
from rigidarea.study.scene import get_scene

G = 9.81
FRAME = 1 / 60


@pytest.mark.parametrize("penetration, steps", [(1e-3, 6), (3e-4, 12), (1e-4, 12), (3e-5, 3), (3e-5, 24)])
def test_a_box_slides_over_butted_tiles(penetration, steps):
    """It has sunk, and the next tile shows it a side as high as that: no wall. Each of these was caught at a seam.

    Smooth, so that nothing slows it: 1 % is for twenty seams, at each of which it tilts a little.
    """
    space = pymunk.Space()
    space.gravity = 0, -G
    for i in range(30):
        tile = pymunk.Body(body_type=pymunk.Body.STATIC)
        tile.position = 0.5 * (i - 1), -0.25
        space.add(tile, pymunk.Poly.create_box(tile, (0.5, 0.5)))
    box = pymunk.Body(1, 0.25 / 6)
    box.position, box.velocity = (0, 0.25), (4, 0)
    space.add(box, pymunk.Poly.create_box(box, (0.5, 0.5)))
    ra.attach(space, penetration=penetration).step(FRAME, 150, steps=steps)
    assert box.velocity.x == pytest.approx(4.0, rel=0.01)
    assert abs(box.angle) < 0.02


@pytest.mark.parametrize("drop", [0.0, 0.05])
def test_a_step_as_high_as_a_tenth_of_it_stops_a_box(drop):
    """What is higher than a body sinks is a wall all the same, and so it is from a little above the lower ground."""
    space = pymunk.Space()
    space.gravity = 0, -G
    for left, right, top in ((-5, 1, 0.0), (1, 5, 0.1)):
        points = [(left, top - 1), (right, top - 1), (right, top), (left, top)]
        space.add(pymunk.Poly(space.static_body, points))
    box = pymunk.Body(1, 1 / 6)
    box.position, box.velocity = (0, 0.5 + drop), (4, 0)
    space.add(box, pymunk.Poly.create_box(box, (1, 1)))
    contact = ra.attach(space)
    contact.step(FRAME, 20)
    assert box.velocity.x < 2.0
    assert box.position.x < 0.8  # 1.33 where nothing is in its way; it tips over the edge of 0.1


@pytest.mark.parametrize("stiffness", [1e8, 1e12])
def test_a_disc_in_a_groove_is_held_by_both_walls_from_the_first_frame(stiffness):
    """Spinning, one step a frame: its friction is that of both in every frame (the study's scene, by its own error).

    A frame without one wall's would be 4e-3 off at least.
    """
    scene = get_scene("v_groove_spin")
    run = get_peer("rigidarea").build(scene, {"stiffness": stiffness, "steps": 1})
    disc = next(body for body in run.space.bodies if body.body_type == pymunk.Body.DYNAMIC)
    slowing = 0.2 * 2 / 0.5 * G / (math.cos(math.radians(45)) * (1 + 0.2**2))
    before = disc.angular_velocity
    for _ in range(30):
        run.advance(1)
        assert before - disc.angular_velocity == pytest.approx(slowing * FRAME, abs=5e-4)
        before = disc.angular_velocity
