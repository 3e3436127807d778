"""A scene of the studies as a user would build it."""

from __future__ import annotations

from functools import cache, partial

import pymunk

from ..geometry.outline import Outline
from .peers.pymunk_peer import make_space, plain_shape
from .scene import Curve, Scene, Shape


@cache
def _outline(curve: Curve, tolerance: float) -> Outline:
    """A curve's outline, which knows how to be sampled anew."""
    outer, *holes = curve.rings(tolerance)
    return Outline(outer, holes).with_curve(partial(_outline, curve))


def space_of(scene: Scene) -> tuple[pymunk.Space, list[pymunk.Body]]:
    """A scene as a user would build it: arcs are arcs, other curves are sampled to a thousandth of its size."""

    def shape_of(shape: Shape, made: pymunk.Body) -> pymunk.Shape:
        if not isinstance(shape, Curve):
            return plain_shape(shape, made)
        outline = shape.exact() if shape.exact is not None else _outline(shape, 1e-3 * scene.size)
        return outline.add_to(made)

    return make_space(scene, lambda body, made: [shape_of(shape, made) for shape in body.shapes])
