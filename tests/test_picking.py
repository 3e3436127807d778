"""What is under the mouse: the outline itself, arcs as they are."""

import math
from types import SimpleNamespace

import pymunk
import pytest

import rigidarea as ra
from rigidarea.draw.window import Hand
from rigidarea.overlap_queries import covers


@pytest.mark.parametrize("place", [(0, 0, 0), (3, -4, 0.7), (1e5, 2e5, -2.1)])
@pytest.mark.parametrize("center", [(0, 0), (5, 1)])
def test_a_disc_to_its_rim(place, center):
    """Where a polygon of samples is off by 1e-4 and more; 1e-9: of 2e5, a thousand roundings."""
    disc = ra.Outline.circle(2.0, center)
    x, y, angle = place
    c, s = math.cos(angle), math.sin(angle)
    cx, cy = x + c * center[0] - s * center[1], y + s * center[0] + c * center[1]
    for k in range(200):
        ux, uy = math.cos(0.0314159 * k), math.sin(0.0314159 * k)
        inner, outer = 2 - 1e-9, 2 + 1e-9
        assert covers(disc, place, (cx + inner * ux, cy + inner * uy))
        assert not covers(disc, place, (cx + outer * ux, cy + outer * uy))


def test_a_hole_is_none_of_it():
    plate = ra.Outline([(0, 0), (4, 0), (4, 3), (0, 3)], holes=[[(1, 1), (1, 2), (2, 2), (2, 1)]])
    assert covers(plate, (0, 0, 0), (0.5, 0.5)) and not covers(plate, (0, 0, 0), (1.5, 1.5))
    assert covers(plate, (0, 0, math.pi / 2), (-1.5, 3.5)) and not covers(plate, (0, 0, 0), (5, 1))
    with pytest.raises(ValueError, match="point"):
        covers(plate, (0, 0, 0), (math.nan, 1))


def test_the_mouse_grabs_a_disc_at_its_rim():
    space = pymunk.Space()
    body = pymunk.Body(1, 1)
    space.add(body)
    run = SimpleNamespace(
        space=space, parts=[SimpleNamespace(body=body, outline=ra.Outline.circle(1.0))], scene=None
    )
    space.gravity = 0, -10
    hand = Hand(run)
    hand.body.position = math.cos(0.1) * (1 - 1e-9), math.sin(0.1) * (1 - 1e-9)
    hand.grab()
    assert len(space.constraints) == 1
    hand.release()
    hand.body.position = 0, 1 + 1e-9
    hand.grab()
    assert not space.constraints
