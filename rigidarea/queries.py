"""Queries of a space that see outlines as they are: pymunk's own see their proxies, which contain them."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import pymunk
from pymunk import PointQueryInfo, SegmentQueryInfo, Vec2d

from .geometry.arcs import Points
from .geometry.gate import numbers
from .geometry.outline import Outline, outline_on
from .overlap_queries import covers

#: Every shape; pymunk's default.
ANY = pymunk.ShapeFilter()


class _Edges(NamedTuple):
    """All edges of an outline in the world."""

    start: Points
    end: Points
    arcs: Points


def _edges(outline: Outline, body: pymunk.Body) -> _Edges:
    c, s = body.rotation_vector
    turn, at = np.array([[c, s], [-s, c]]), np.array(tuple(body.position))
    rings = [ring @ turn + at for ring in outline.rings]
    start, end = np.concatenate(rings), np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])
    arcs = np.concatenate(outline.arcs).copy() if outline.arcs else np.zeros((len(start), 3))
    arcs[:, :2] = arcs[:, :2] @ turn + at
    return _Edges(start, end, arcs)


def _entries(a: Points, b: Points, edges: _Edges) -> list[tuple[float, Points]]:
    """Where the way from a to b, both (2,), enters the solid: fractions of it, and normals (2,) out of the solid.

    Where edges meet at least one of them has it: the side on which a corner lies is the same for both, and arcs end
    later by what coordinates are rounded by.
    """
    way = b - a
    length = math.hypot(*way)
    if length == 0:
        return []
    reach = max(np.abs(part).max() for part in (a, b, edges.start, edges.arcs))
    room = 16 * math.ulp(reach)  # roundings of turns, differences and products
    found: list[tuple[float, Points]] = []
    bent = edges.arcs[:, 2] != 0
    side = way[0] * (edges.start[:, 1] - a[1]) - way[1] * (edges.start[:, 0] - a[0])
    side_end = way[0] * (edges.end[:, 1] - a[1]) - way[1] * (edges.end[:, 0] - a[0])
    for i in np.flatnonzero(~bent & (side >= 0) & (side_end <= 0) & (side > side_end)):
        (x, y), (dx, dy) = edges.start[i] - a, edges.end[i] - edges.start[i]
        t = (x * dy - y * dx) / (way[0] * dy - way[1] * dx)
        found.append((t, np.array((dy, -dx)) / math.hypot(dx, dy)))
    for i in np.flatnonzero(bent):
        x, y, r = edges.arcs[i]
        off = a - (x, y)
        square, half, rest = way @ way, off @ way, off @ off - r * r
        inside = half * half - square * rest
        if inside < 0:
            continue
        t = (-half - math.copysign(math.sqrt(inside), r)) / square  # the other crossing is where it leaves
        point = a + t * way
        if _near_arc(edges.start[i], edges.end[i], r, point, room):
            found.append((t, (point - (x, y)) / r))
    near = room / length
    return [(min(max(t, 0.0), 1.0), normal) for t, normal in found if -near <= t <= 1 + near]


def _near_arc(start: Points, end: Points, radius: float, point: Points, room: float) -> bool:
    """Whether a point (2,) of a circle lies on its arc from start to end, both (2,), to within `room` (length)."""
    chord, away = end - start, point - start
    length = math.hypot(*chord)
    left = math.copysign(1.0, radius) * (chord[0] * away[1] - chord[1] * away[0])
    return bool(left <= room * length and -room <= chord @ away / length <= length + room)


def _check(space: object, shape_filter: object) -> None:
    for name, given, kind in (
        ("space", space, pymunk.Space),
        ("shape_filter", shape_filter, pymunk.ShapeFilter),
    ):
        if not isinstance(given, kind):
            raise ValueError(f"{name} must be a pymunk.{kind.__name__}, got {given!r:.80}")


def point_query(
    space: pymunk.Space, point: tuple[float, float], shape_filter: pymunk.ShapeFilter = ANY
) -> list[pymunk.Shape]:
    """The shapes that cover a point (length): `space.point_query(point, 0, shape_filter)`, outlines as they are.

    A hole, a slot and the gap between two teeth are none of a shape. Raises ValueError for no two finite numbers, no
    space, or no filter.
    """
    _check(space, shape_filter)
    at = numbers(point, "point", 2)
    hits: list[PointQueryInfo] = space.point_query((float(at[0]), float(at[1])), 0, shape_filter)
    return [hit.shape for hit in hits if hit.shape is not None and _covers(hit.shape, point)]


def _covers(shape: pymunk.Shape, point: tuple[float, float]) -> bool:
    outline = outline_on(shape)
    if outline is None or outline.two_sided or shape.body is None:
        return True
    return covers(outline, (*shape.body.position, shape.body.angle), point)


def segment_query(
    space: pymunk.Space,
    start: tuple[float, float],
    end: tuple[float, float],
    shape_filter: pymunk.ShapeFilter = ANY,
) -> list[SegmentQueryInfo]:
    """What a ray from start to end hits: `space.segment_query(start, end, 0, shape_filter)`, outlines as they are.

    One for each shape, where the ray first enters it, the nearest first: point, normal out of the solid, alpha (the
    fraction of the way). A ray that starts inside an outline hits it at once, with the way back as its normal.
    Raises ValueError for places that are no two finite numbers, no space, or no filter.
    """
    _check(space, shape_filter)
    a, b = (np.array(numbers(place, name, 2), float) for place, name in ((start, "start"), (end, "end")))
    found = []
    for hit in space.segment_query(tuple(a.tolist()), tuple(b.tolist()), 0, shape_filter):
        shape = hit.shape
        outline = None if shape is None else outline_on(shape)
        if shape is None or shape.body is None or outline is None or outline.two_sided:
            found.append(hit)
            continue
        if _covers(shape, (float(a[0]), float(a[1]))):
            t, normal = 0.0, (a - b) / (math.hypot(*(a - b)) or 1.0)
        elif entries := _entries(a, b, _edges(outline, shape.body)):
            t, normal = min(entries, key=lambda entry: entry[0])
        else:
            continue
        point = (a + t * (b - a)).tolist()
        found.append(SegmentQueryInfo(shape, Vec2d(*point), Vec2d(*normal.tolist()), float(t)))
    return sorted(found, key=lambda hit: hit.alpha)
