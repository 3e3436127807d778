"""Which bodies of a large space are tried out: whole islands, the largest and some of each size."""

from __future__ import annotations

import numpy as np
import pymunk
import shapely
from numpy.typing import NDArray

from . import costs

COPIES, SAMPLED = 0.5, 0.1
"""What copies may take of the budget; where that of the whole space would take more, islands are sampled to this."""
NEAR = 0.01
"""Of a box: bodies whose boxes are no further apart touch, whatever the rounding."""


def part(space: pymunk.Space, budget: float) -> list[pymunk.Body]:
    """The bodies that are not static, if copies of them are within the budget (s); else those of some islands, and what
    is kinematic. None where the largest island alone is too large.

    An island is what touches by its boxes or is jointed, as it is now.
    """
    most, some = COPIES * budget / costs.COPY_BODY_S, SAMPLED * budget / costs.COPY_BODY_S
    bodies = [body for body in space.bodies if body.body_type != pymunk.Body.STATIC]
    if len(bodies) <= most:
        return bodies
    index: dict[pymunk.Body | None, int] = {
        body: i for i, body in enumerate(bodies) if body.body_type == pymunk.Body.DYNAMIC
    }
    shapes = [shape for shape in space.shapes if shape.body in index and not shape.sensor]
    low_high = np.array([shape.cache_bb() for shape in shapes]).reshape(-1, 4)
    grown = NEAR * (low_high[:, 2:] - low_high[:, :2])
    boxes = shapely.box(*(low_high[:, :2] - grown).T, *(low_high[:, 2:] + grown).T)
    mine = np.array([index[shape.body] for shape in shapes], np.int64)
    groups = np.arange(len(bodies))
    for a, b in mine[shapely.STRtree(boxes).query(boxes, predicate="intersects")].T:
        join(groups, a, b)
    for joint in space.constraints:
        if joint.a in index and joint.b in index:
            join(groups, index[joint.a], index[joint.b])
    numbers, sizes = np.unique(groups[list(index.values())], return_counts=True)
    order = np.argsort(-sizes, kind="stable")
    while len(order) > 1 and sizes[order].sum() > some:
        order = order[::2]
    if sizes[order].sum() > most:
        return []
    kept = set(numbers[order].tolist())
    return [body for i, body in enumerate(bodies) if body not in index or int(groups[i]) in kept]


def join(groups: NDArray[np.int64], a: int, b: int) -> None:
    """Make the groups of two bodies one: `groups` (bodies,) by number."""
    if groups[a] != groups[b]:
        groups[groups == groups[b]] = groups[a]
