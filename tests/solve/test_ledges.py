"""What lands flat beyond an edge is pushed up and nowhere else, however deep the two would go on into each other."""

import random
import statistics

import pymunk
import pytest

import rigidarea

SIDE = 30.0
FRAMES = 12


def _pushed_aside(seed: int, steps: int, block: str) -> float:
    """Of the speed with which a smooth box comes down on a block's edge, the part that either is sent aside with.

    block: "static"; or free, and until two frames after the blow: "lying" on a floor, "floating" without gravity.
    """
    draw = random.Random(seed)
    space = pymunk.Space()
    space.gravity = 0, 0 if block == "floating" else -900
    mass = draw.choice((1.0, 4.0, 16.0))
    under = space.static_body
    if block != "static":
        under = pymunk.Body(mass, pymunk.moment_for_box(mass, (4 * SIDE, SIDE)))
        under.position = 2 * SIDE, -0.5 * SIDE
        space.add(under)
    left = under.world_to_local((0, -SIDE))
    corners = [left + at for at in ((0, 0), (4 * SIDE, 0), (4 * SIDE, SIDE), (0, SIDE))]
    space.add(pymunk.Poly(under, corners))
    if block == "lying":
        space.add(pymunk.Segment(space.static_body, (-900, -SIDE - 5), (900, -SIDE - 5), 5))
    body = pymunk.Body(1.0, pymunk.moment_for_box(1.0, (SIDE, SIDE)))
    space.add(body, pymunk.Poly.create_box(body, (SIDE, SIDE)))
    # its middle is over the block, and stays there
    body.position = SIDE * draw.uniform(0.05, 0.45), 0.5 * SIDE + draw.uniform(5, 40)
    aside = draw.choice((0.0, 90.0))
    down = draw.uniform(200, 900)
    body.velocity = aside, -down
    rigidarea.attach(space)
    frames = 0
    while frames < FRAMES:
        for _ in range(steps):
            space.step(1 / 60 / steps)
        frames += 1
        if block != "static" and frames < FRAMES - 2 and body.velocity.y > -0.9 * down:
            frames = FRAMES - 2  # struck off its middle the block may turn, and rebound: not asked here
    if (
        block == "static"
    ):  # on a light block that lies on a floor one of a hundred rebounds and turns: not asked here
        assert abs(body.position.y - 0.5 * SIDE) < 0.01 * SIDE
    return max(abs(body.velocity.x - aside), abs(under.velocity.x)) / down


@pytest.mark.parametrize("steps", [1, 4])
@pytest.mark.parametrize("block", ["static", "lying", "floating"])
def test_a_box_that_lands_on_an_edge_is_not_pushed_off(block: str, steps: int) -> None:
    """Exact: nothing, but for what turns already. Of 100 the median within a hundredth, the worst within a fiftieth.

    Seen: .0006, .009 on what lies; .003, .011 on what floats; .002, .009 at four steps a frame. (Before, with the
    chord from the block's wall to the box's own: .055, .35; .05, .24; .014, .08. A direction askew by less than a
    hundredth is left as it is.)
    """
    found = [_pushed_aside(seed, steps, block) for seed in range(100)]
    assert statistics.median(found) < (1e-2 if block == "floating" else 1e-3)
    assert max(found) < 2e-2
