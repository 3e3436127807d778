"""A bar across the two prongs of a U stays there."""

import numpy as np

from ...geometry.outline import Outline
from ..scene import Body, Curve, Scene, block, rest_error

GAP, PRONG, DEPTH = 1.0, 0.3, 1.0


def u_shape() -> Curve:
    """A U whose prongs end at y = 0; one concave outline."""
    inner, outer = GAP / 2, GAP / 2 + PRONG
    points = np.array(
        [
            (-outer, 0.0),
            (-outer, -DEPTH - PRONG),
            (outer, -DEPTH - PRONG),
            (outer, 0.0),
            (inner, 0.0),
            (inner, -DEPTH),
            (-inner, -DEPTH),
            (-inner, 0.0),
        ]
    )
    return Curve(lambda tolerance: (points,), exact=lambda: Outline(points))


def scene() -> Scene:
    """A bar of 2 m lies on both prongs; merging the two contacts would put the force into the void."""
    body = Body("u", (u_shape(),), kind="static")
    return Scene(
        title="bar across a U",
        bodies=(body, block("bar", 2.0, 0.2, (0.2, 0.1))),
        friction=0.5,
        duration=3.0,
        error_name="displacement after settling / length",
        error=lambda trace: rest_error(trace, ["bar"], 2.0),
        source="statics: the centre of mass is between the supports",
        size=0.5,
        tags=frozenset({"rest", "concave", "flat"}),
    )
