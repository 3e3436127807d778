"""What a contact shows of itself: its regions, the energy of the space."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pymunk

from ..contact.bed import stored
from ..contact.space_record import load_law
from ..contact.tables import SUBSTEP
from ..geometry.outline import Outline
from ..geometry.svg_picture import FILL, STATIC, path_data, svg
from .arrays import Store

REGIONS = np.dtype(
    [
        ("shape_a", "O"),
        ("shape_b", "O"),
        ("body_a", "O"),
        ("body_b", "O"),
        ("area", "f8"),  # (length^2)
        ("centroid", "f8", 2),  # where the force acts, world (length)
        ("direction", "f8", 2),  # unit, from A to B
        ("chord", "f8"),  # (length)
        ("stiffness", "f8"),  # k of F = k A (force/length^2)
        ("force", "f8"),  # normal force on B along direction (force); on A the opposite
        ("friction", "f8"),  # force on B along direction turned by +90 degrees
        ("speed", "f8"),  # closing speed (length/time)
        ("slip", "f8"),  # tangential speed of A relative to B, surface velocity included (length/time)
    ]
)
"""One row a contact region, as `AreaContact.regions` gives them."""


def regions_of(store: Store, shapes: dict[int, pymunk.Shape]) -> np.ndarray:
    """The regions of the last substep, one REGIONS row each. shapes: of the space, by Chipmunk's id."""
    tables = store.tables
    live = tables.regions[
        (tables.regions["stamp"] == tables.counters[SUBSTEP]) & (tables.counters[SUBSTEP] > 0)
    ]
    out = np.zeros(len(live), REGIONS)
    row: Any
    for row, region, pair in zip(out, live, tables.pairs[live["pair"]]):
        ident = [int(tables.shapes[pair[side]]["ident"]) for side in ("a", "b")]
        # A is who was added first; in the tables it goes by place
        sign = 1.0 if ident[0] < ident[1] else -1.0
        for side, which in zip(("a", "b"), sorted(ident)):
            shape = shapes[which]
            row[f"shape_{side}"], row[f"body_{side}"] = shape, shape.body
        row["centroid"] = region["x"], region["y"]
        row["direction"] = sign * region["nx"], sign * region["ny"]
    for name in ("area", "chord", "stiffness", "force", "friction", "speed", "slip"):
        out[name] = live[name]
    return out


def picture_of(space: pymunk.Space) -> str:
    """All shapes where they are, as SVG: outlines with their holes; segments without thickness are lines."""
    paths, boxes = [], []
    for shape in space.shapes:
        body = shape.body
        if body is None:
            continue
        outline = Outline.from_pymunk(shape)
        (c, s), (x, y) = body.rotation_vector, body.position
        place = f"matrix({c:.9g},{s:.9g},{-s:.9g},{c:.9g},{x:.9g},{y:.9g})"
        rings: Sequence[np.ndarray] = [outline.rings[0][:2]] if outline.two_sided else outline.rings
        colour = STATIC if body.body_type == pymunk.Body.STATIC else FILL
        paths.append((path_data(rings, () if outline.two_sided else outline.arcs), place, colour))
        boxes.append(shape.cache_bb())
    if not boxes:
        return svg([], (0.0, 0.0, 1.0, 1.0))
    low, high = np.min(boxes, axis=0), np.max(boxes, axis=0)
    return svg(paths, (*low[:2].tolist(), *high[2:].tolist()), down=space.gravity.y > 0)


def total_energy(space: pymunk.Space, store: Store) -> float:
    """Kinetic energy, plus potential in the space's gravity, plus what the contacts store (force length)."""
    total = 0.0
    for body in space.bodies:
        if body.body_type == pymunk.Body.DYNAMIC:
            center = body.local_to_world(body.center_of_gravity)
            total += 0.5 * body.mass * body.velocity.dot(body.velocity) - body.mass * space.gravity.dot(
                center
            )
            if math.isfinite(body.moment):
                total += 0.5 * body.moment * body.angular_velocity**2
    return total + float(stored(store.pool, store.tables, store.work, load_law(store.state[0])))
