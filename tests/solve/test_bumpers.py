"""A product of elasticities above 1 gives back so much more speed: any shapes, any steps, set in any way."""

from __future__ import annotations

import math

import pymunk
import pytest

import rigidarea as ra

U = ra.Outline([(-8, -8), (8, -8), (8, 8), (4, 8), (4, -2), (-4, -2), (-4, 8), (-8, 8)])
VALLEY = ra.Outline([(-90, -50), (90, -50), (90, 20), (60, 20), (60, 4), (-60, 4), (-60, 20), (-90, 20)])


def meeting(kind: str) -> tuple[pymunk.Space, pymunk.Body, pymunk.Shape, pymunk.Shape]:
    """A body above another that it will fall on in its middle, so that nothing turns."""
    space = pymunk.Space()
    body = pymunk.Body(1, pymunk.moment_for_circle(1, 0, 8))
    wall: pymunk.Shape = pymunk.Segment(space.static_body, (-100, 0), (100, 0), 4)
    shape: pymunk.Shape = pymunk.Circle(body, 8)
    if kind == "disc on disc":
        wall = pymunk.Circle(space.static_body, 15, (0, -11))
    elif kind == "box on wall":
        body.moment, shape = pymunk.moment_for_box(1, (16, 16)), pymunk.Poly.create_box(body, (16, 16))
    elif kind == "disc on outline":
        wall = VALLEY.add_to(space.static_body)
    elif kind == "outline on line":
        body.moment, body.center_of_gravity = U.moment(1, (-U.centroid[0], -U.centroid[1])), U.centroid
        shape, wall = U.add_to(body), pymunk.Segment(space.static_body, (-100, 0), (100, 0), 0)
    elif kind == "disc on a free disc":
        other = pymunk.Body(3, 100)
        other.position = 0, -11
        wall = pymunk.Circle(other, 15)
        space.add(other)
    body.position = 0, 43.7
    space.add(body, shape, wall)
    return space, body, shape, wall


KINDS = (
    "disc on wall",
    "disc on disc",
    "box on wall",
    "disc on outline",
    "outline on line",
    "disc on a free disc",
)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("product", [1.1, 1.25, 1.5])
@pytest.mark.parametrize("steps", [None, 1, 3, 16, 100])
@pytest.mark.parametrize("how", ["shape", "pre_solve"])
def test_it_gives_back_as_much_more_as_was_asked(kind, product, steps, how):
    """Within 1 % of the speed at which they part over that at which they met."""
    for speed in (60.0, 900.0):
        space, body, shape, wall = meeting(kind)
        body.velocity = 0, -speed
        if how == "shape":
            shape.elasticity, wall.elasticity = 0.8, product / 0.8
        else:

            def set_it(arbiter, space, data):
                arbiter.restitution = product

            space.on_collision(pre_solve=set_it)
        contact = ra.attach(space)
        parting = 0.0
        for _ in range(80):
            contact.step(1 / 60, steps=steps)
            parting = body.velocity.y - wall.body.velocity.y
            if parting > 0 and len(contact.regions) == 0:
                break
        assert math.isclose(parting, product * speed, rel_tol=0.01), (parting / speed, speed)
