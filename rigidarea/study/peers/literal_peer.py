"""The paper's method as printed: its node gate (Alg. 1) and its nodal direction (Eq. 8-15), with q = 0.5.

Alg. 1 goes on only where at least one node of each body lies inside the other. Everything else is
rigidarea's. Outlines get nodes along their edges, as the paper's meshes have them (`spacing`, over the body size; none:
the corners alone, as a game has them). For the atlas: the gate is a Python callback, so that costs would say nothing.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pymunk
import shapely

from ...geometry.outline import Outline
from ..scene import Array, Scene
from .area_peer import AreaExplicit, explicit_run
from .base import Run, Settings

EXPONENT = 0.5
"""q of Eq. 12, the paper's choice."""


def any_inside(nodes: Array, edges: Array, x: float, y: float, c: float, s: float) -> bool:
    """Whether one of `nodes` (n, 2) lies inside the rings of `edges` (m, 4); nodes' pose in the edges' coordinates."""
    px = (x + c * nodes[:, 0] - s * nodes[:, 1])[:, None]
    py = (y + s * nodes[:, 0] + c * nodes[:, 1])[:, None]
    x0, y0, x1, y1 = edges.T
    across = (y0 > py) != (y1 > py)
    with np.errstate(divide="ignore", invalid="ignore"):  # a level edge is never crossed
        crossed = across & (px < x0 + (py - y0) / (y1 - y0) * (x1 - x0))
    return bool((crossed.sum(axis=1) % 2 == 1).any())


def has_node_inside(one: pymunk.Shape, other: pymunk.Shape) -> bool:
    """Whether a node of `one` lies inside `other`."""
    a, b = one.body, other.body
    assert a is not None and b is not None
    turn = a.angle - b.angle
    x, y = (a.position - b.position).rotated(-b.angle)
    nodes, edges = one.nodes, other.edges  # type: ignore[attr-defined]
    return any_inside(nodes, edges, x, y, math.cos(turn), math.sin(turn))


def gate(arbiter: pymunk.Arbiter, space: pymunk.Space, data: Any) -> None:
    """Alg. 1, lines 1-12: no contact unless each body has a node inside the other."""
    a, b = arbiter.shapes
    arbiter.process_collision = has_node_inside(a, b) and has_node_inside(b, a)


class Literal(AreaExplicit):
    """The paper's method; the settings are those of `AreaExplicit`, and `spacing`."""

    name = "literal"
    ours = False

    def refuses(self, scene: Scene) -> str:
        """Refuses to be timed: its gate runs in Python."""
        return "its node gate runs in Python: no cost to compare (see the atlas)"

    def build(self, scene: Scene, settings: Settings) -> Run:
        """An attached space whose contacts have to pass the gate."""
        more = {k: v for k, v in settings.items() if k != "spacing"}
        spacing = settings.get("spacing", math.inf) * scene.size
        made = explicit_run(scene, {**more, "direction": "nodal", "exponent": EXPONENT})
        for shape in made.space.shapes:
            outline = Outline.from_pymunk(shape)
            if math.isfinite(spacing):
                outline = Outline.from_shapely(shapely.segmentize(outline.polygon, spacing))
            shape.outline = outline  # type: ignore[attr-defined]
            rings = [np.asarray(ring) for ring in outline.polygon_rings]
            shape.nodes = np.concatenate(rings)  # type: ignore[attr-defined]
            shape.edges = np.concatenate([np.hstack((r, np.roll(r, -1, 0))) for r in rings])  # type: ignore[attr-defined]
            shape.collision_type = 1
            made.contact.refresh(shape)
        made.space.on_collision(1, 1, pre_solve=gate)
        return made


PEERS = (Literal(),)
