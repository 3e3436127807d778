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
    contact: AreaContact,
    rows: Any,
    h: float,
    found: dict[str, Measured],
    materials: Mapping[Any, Any],
    extents: dict[pymunk.Shape, float],
) -> None:
    """Put into `found` what is larger than what is there: see `Watch` for the names.

    rows: the contact's regions. h: a substep (time). materials: of the bodies that have one. extents: those of shapes
    that are known (length); others are added.
    """

    def most(name: str, value: float, where: Any) -> None:
        if value > found.get(name, (0.0, None))[0]:
            found[name] = value, where

    gravity = contact.space.gravity.length
    numbers = ("chord", "speed", "area", "force", "stiffness")
    columns = (rows[name].tolist() for name in ("shape_a", "shape_b", "body_a", "body_b", *numbers))
    for shape_a, shape_b, body_a, body_b, chord, speed, area, force, stiffness in zip(*columns):
        shapes, both = (shape_a, shape_b), ((shape_a, body_a), (shape_b, body_b))
        free = [(shape, body) for shape, body in both if body.body_type == pymunk.Body.DYNAMIC]
        if not free or chord <= 0.0:
            continue
        for shape, _ in free:
            if shape not in extents:
                extents[shape] = extent_of(shape)
        extent = min(extents[shape] for shape, _ in free)
        if speed * h <= HIT * extent:
            most("penetration", area / chord / extent, shapes)
            most("sweeps", max(0.0, speed) * h / extent, shapes)
        masses = [body.mass for _, body in free]
        if gravity > 0.0:
            most("load", force / (min(masses) * gravity), shapes)
        most("phase", h * math.sqrt(stiffness * chord * sum(1.0 / mass for mass in masses)), shapes)
        for _, body in free:
            material = materials.get(body)
            if material is not None:
                most("strain", force / (chord * material.thickness) / material.young, shapes)


def fastest(space: pymunk.Space) -> Measured:
    """The speed of the fastest body, its rim included (length/time), and the body."""

    def speed(body: pymunk.Body) -> float:
        rim = abs(body.angular_velocity)
        return float(body.velocity.length + (rim * reach_of(body, body.shapes) if rim > 0.0 else 0.0))

    moving = [body for body in space.bodies if body.body_type != pymunk.Body.STATIC]
    return max(((speed(body), body) for body in moving), key=lambda each: each[0], default=(0.0, None))


def reach_of(body: pymunk.Body, shapes: Iterable[pymunk.Shape]) -> float:
    """How far the boxes of a body's shapes reach from its centre (length)."""
    x, y = body.position
    boxes = [shape.cache_bb() for shape in shapes]
    ways = (math.hypot(max(b.right - x, x - b.left), max(b.top - y, y - b.bottom)) for b in boxes)
    return max(ways, default=0.0)


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
    corners = [(float(x), float(y)) for x, y in shape.get_vertices()]
    widths = []  # of a convex polygon one side of the narrowest strip lies along an edge
    for (ax, ay), (bx, by) in zip(corners, corners[1:] + corners[:1]):
        ex, ey = bx - ax, by - ay
        widths.append(max(ex * (y - ay) - ey * (x - ax) for x, y in corners) / math.hypot(ex, ey))
    return min(widths) + 2.0 * float(shape.radius)


def turns_others(body: pymunk.Body) -> bool:
    """Whether it drives what it touches round: a kinematic body that turns, or one on a motor that has a rate."""
    if body.body_type == pymunk.Body.KINEMATIC:
        return body.angular_velocity != 0.0
    return any(isinstance(joint, pymunk.SimpleMotor) and joint.rate != 0.0 for joint in body.constraints)
