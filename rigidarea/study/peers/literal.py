"""The paper's method as printed: its node gate (Alg. 1) and its nodal direction (Eq. 8-15), with q = 0.5.

Alg. 1 goes on only where at least one node of each body lies inside the other. Everything else is
rigidarea's. For the atlas: the gate is a Python callback, so that costs would say nothing.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pymunk
import shapely

from ..scene import Array, Scene
from .area import Area, StepRun, area_space
from .base import Run, Settings

EXPONENT = 0.5
"""q of Eq. 12, the paper's choice."""


def _placed(shape: pymunk.Shape) -> Array:
    """Nodes (n, 2) of a shape's outline in the world."""
    body, nodes = shape.body, np.concatenate(shape.outline.rings)  # type: ignore[attr-defined]
    assert body is not None
    c, s = np.cos(body.angle), np.sin(body.angle)
    return nodes @ np.array(((c, s), (-s, c))) + np.array(body.position)


def nodes_inside(one: pymunk.Shape, other: pymunk.Shape) -> int:
    """How many nodes of `one` lie inside `other`."""
    body = other.body
    assert body is not None
    c, s = np.cos(body.angle), np.sin(body.angle)
    local = (_placed(one) - np.array(body.position)) @ np.array(((c, -s), (s, c)))
    polygon = other.outline.polygon  # type: ignore[attr-defined]
    return int(np.count_nonzero(shapely.contains_xy(polygon, local[:, 0], local[:, 1])))


def gate(arbiter: pymunk.Arbiter, space: pymunk.Space, data: Any) -> None:
    """Alg. 1, lines 1-12: no contact unless each body has a node inside the other."""
    a, b = arbiter.shapes
    arbiter.process_collision = nodes_inside(a, b) > 0 and nodes_inside(b, a) > 0


class Literal(Area):
    """The paper's method; the settings are those of `Area`."""

    name = "literal"
    ours = False

    def refuses(self, scene: Scene) -> str:
        """Refuses to be timed: its gate runs in Python."""
        return "its node gate runs in Python: no cost to compare (see the atlas)"

    def build(self, scene: Scene, settings: Settings) -> Run:
        """An attached space whose contacts have to pass the gate."""
        import rigidarea

        space, bodies, contact = area_space(scene, {**settings, "direction": "nodal", "exponent": EXPONENT})
        for shape in space.shapes:
            if not hasattr(shape, "outline"):
                shape.outline = rigidarea.Outline.from_pymunk(shape)  # type: ignore[attr-defined]
            shape.collision_type = 1
        space.on_collision(1, 1, pre_solve=gate)
        return StepRun(scene, space, bodies, contact, settings.get("steps"))


PEER = Literal()
