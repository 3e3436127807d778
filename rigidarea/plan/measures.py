"""What contacts of a space do, in a few numbers: of a probe beforehand, and while a plan runs."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

import pymunk

from ..chipmunk import AreaContact
from ..contact.constants import HIT
from ..geometry.outline import Outline

Measured = tuple[float, Any]
"""A number, and the body or shapes where it is largest."""


def measure(
    contact: AreaContact, rows: Any, h: float, found: dict[str, Measured], materials: Mapping[Any, Any]
) -> None:
    """Put into `found` what is larger than what is there: see `Watch` for the names.

    rows: the contact's regions. h: a substep (time). materials: of the bodies that have one.
    """

    def most(name: str, value: float, where: Any) -> None:
        if value > found.get(name, (0.0, None))[0]:
            found[name] = value, where

    gravity = contact.space.gravity.length
    for region in rows:
        shapes, bodies = (region["shape_a"], region["shape_b"]), (region["body_a"], region["body_b"])
        free = [body for body in bodies if body.body_type == pymunk.Body.DYNAMIC]
        if not free or region["chord"] <= 0.0:
            continue
        extent = min(extent_of(shape) for shape, body in zip(shapes, bodies) if body in free)
        if region["speed"] * h <= HIT * extent:
            most("penetration", float(region["area"] / region["chord"]) / extent, shapes)
            most("sweeps", max(0.0, float(region["speed"])) * h / extent, shapes)
        if gravity > 0.0:
            most("load", float(region["force"]) / (min(body.mass for body in free) * gravity), shapes)
        inverse = sum(1.0 / body.mass for body in free)
        most("phase", h * math.sqrt(float(region["stiffness"] * region["chord"]) * inverse), shapes)
        for body in free:
            material = materials.get(body)
            if material is not None:
                pressure = float(region["force"] / (region["chord"] * material.thickness))
                most("strain", pressure / material.young, shapes)


def fastest(space: pymunk.Space, found: dict[str, Measured]) -> None:
    """The speed of the fastest body, its rim included (length/time)."""
    for body in space.bodies:
        if body.body_type != pymunk.Body.STATIC:
            rim = abs(body.angular_velocity)
            speed = body.velocity.length + (rim * reach_of(body, body.shapes) if rim > 0.0 else 0.0)
            if speed > found.get("speed", (0.0, None))[0]:
                found["speed"] = speed, body


def reach_of(body: pymunk.Body, shapes: Iterable[pymunk.Shape]) -> float:
    """How far the boxes of a body's shapes reach from its centre (length)."""
    x, y = body.position
    return max(
        (
            math.hypot(max(box.right - x, x - box.left), max(box.top - y, y - box.bottom))
            for box in (shape.cache_bb() for shape in shapes)
        ),
        default=0.0,
    )


def extent_of(shape: pymunk.Shape) -> float:
    """Smallest extent of a shape (length)."""
    outline = vars(shape).get("outline")
    if isinstance(outline, Outline):
        return float(outline.smallest_extent)
    if isinstance(shape, pymunk.Circle):
        return 2.0 * float(shape.radius)
    if isinstance(shape, pymunk.Segment):
        return 2.0 * float(shape.radius) or float((shape.a - shape.b).length)
    assert isinstance(shape, pymunk.Poly)
    corners = shape.get_vertices()
    widths = []  # of a convex polygon one side of the narrowest strip lies along an edge
    for a, b in zip(corners, corners[1:] + corners[:1]):
        edge = b - a
        widths.append(max(edge.cross(corner - a) for corner in corners) / edge.length)
    return float(min(widths)) + 2.0 * float(shape.radius)
