"""What lands flat beyond an edge is pushed up and nowhere else, however deep the two would go on into each other."""

import random
import statistics

import pymunk
import pytest

import rigidarea

SIDE = 30.0
FRAMES = 12


def _pushed_aside(seed: int, steps: int) -> float:
    """Of the speed with which a smooth box comes down on a block's edge, the part that it is sent aside with."""
    draw = random.Random(seed)
    space = pymunk.Space()
    space.gravity = 0, -900
    space.add(pymunk.Poly(space.static_body, [(0, -SIDE), (4 * SIDE, -SIDE), (4 * SIDE, 0), (0, 0)]))
    body = pymunk.Body(1.0, pymunk.moment_for_box(1.0, (SIDE, SIDE)))
    space.add(body, pymunk.Poly.create_box(body, (SIDE, SIDE)))
    # its middle is over the block, and stays there
    body.position = SIDE * draw.uniform(0.05, 0.45), 0.5 * SIDE + draw.uniform(5, 40)
    aside = draw.choice((0.0, 90.0))
    down = draw.uniform(200, 900)
    body.velocity = aside, -down
    rigidarea.attach(space)
    for _ in range(FRAMES * steps):
        space.step(1 / 60 / steps)
    assert abs(body.position.y - 0.5 * SIDE) < 0.01 * SIDE, body.position
    return abs(body.velocity.x - aside) / down


@pytest.mark.parametrize("steps", [1, 4])
def test_a_box_that_lands_on_an_edge_is_not_pushed_off(steps: int) -> None:
    """Exact: nothing. Of 100 the median within a thousandth of the speed, the worst within a fiftieth.

    Seen: .0002, .010 at one step a frame; .0002, .008 at four. (Before, with the chord from the block's wall to the
    box's own: .048, .25; .014, .08. A direction askew by less than a hundredth is left as it is.)
    """
    found = [_pushed_aside(seed, steps) for seed in range(100)]
    assert statistics.median(found) < 1e-3
    assert max(found) < 2e-2
