"""A scene of the studies as a user would build it."""

from __future__ import annotations

from functools import cache, partial

import pymunk

from ..geometry.outline import Outline
from .peers.pymunk_peer import add_joints, make_body, plain_shape, surface
from .scene import Curve, Scene


@cache
def _outline(curve: Curve, tolerance: float) -> Outline:
    """A curve's outline, which knows how to be sampled anew."""
    outer, holes = curve.rings(tolerance)
    return Outline(outer, holes).with_curve(partial(_outline, curve))


def space_of(scene: Scene) -> tuple[pymunk.Space, list[pymunk.Body]]:
    """A scene as a user would build it: arcs are arcs, other curves are sampled to a thousandth of its size."""
    space = pymunk.Space()
    space.gravity = scene.gravity
    made: dict[str, pymunk.Body] = {}
    for body in scene.bodies:
        made[body.name] = here = make_body(body)
        shapes: list[pymunk.Shape] = []
        for shape in body.shapes:
            if not isinstance(shape, Curve):
                shapes.append(plain_shape(shape, here))
            elif shape.exact is not None:
                shapes.append(shape.exact().add_to(here))
            else:
                shapes.append(_outline(shape, 1e-3 * scene.size).add_to(here))
        for made_shape in shapes:
            surface(made_shape, scene, body)
        space.add(here, *shapes)
    add_joints(scene, space, made)
    return space, list(made.values())
