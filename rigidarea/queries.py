"""Queries of a space that see outlines as they are: pymunk's own see their proxies, which contain them."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import pymunk
from pymunk import PointQueryInfo, SegmentQueryInfo, Vec2d

from .geometry.arcs import Points, on_arc
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
    start = np.concatenate(outline.rings) @ turn + at
    end = np.concatenate([np.roll(ring, -1, axis=0) for ring in outline.rings]) @ turn + at
    arcs = np.concatenate(outline.arcs).copy() if outline.arcs else np.zeros((len(start), 3))
    arcs[:, :2] = arcs[:, :2] @ turn + at
    return _Edges(start, end, arcs)


def _crossings(a: Points, b: Points, edges: _Edges) -> tuple[Points, Points]:
    """Where the way from a to b, both (2,), crosses edges: fractions of it (m,), normals (m, 2) out of the solid."""
    way = b - a
    found: list[tuple[float, Points]] = []
    straight = edges.arcs[:, 2] == 0
    p, q = edges.start[straight], edges.end[straight]
    along = q - p
    cross = way[0] * along[:, 1] - way[1] * along[:, 0]
    off = p - a
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (off[:, 0] * along[:, 1] - off[:, 1] * along[:, 0]) / cross
        u = (off[:, 0] * way[1] - off[:, 1] * way[0]) / cross
    inside = (t >= 0) & (t <= 1) & (u >= 0) & (u <= 1)  # NaN and infinity, parallel, are neither
    for i in np.flatnonzero(inside):
        found.append((float(t[i]), np.array((along[i, 1], -along[i, 0])) / math.hypot(*along[i])))
    for i in np.flatnonzero(~straight):
        x, y, r = edges.arcs[i]
        off = a - (x, y)
        square, half, rest = way @ way, off @ way, off @ off - r * r
        inside = half * half - square * rest
        if square == 0 or inside < 0:
            continue
        for sign in (-1, 1):
            t = (-half + sign * math.sqrt(inside)) / square
            point = a + t * way
            if 0 <= t <= 1 and on_arc(edges.start[i], edges.end[i], r, point[None])[0]:
                found.append((t, (point - (x, y)) / r))
    fractions = np.array([t for t, _ in found])
    normals = np.array([n for _, n in found]).reshape(-1, 2)
    return fractions, normals


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
            back = (a - b) / (math.hypot(*(a - b)) or 1.0)
            found.append(SegmentQueryInfo(shape, Vec2d(*a), Vec2d(*back), 0.0))
            continue
        fractions, normals = _crossings(a, b, _edges(outline, shape.body))
        if len(fractions):
            k = int(np.argmin(fractions))
            t = float(fractions[k])
            found.append(SegmentQueryInfo(shape, Vec2d(*(a + t * (b - a))), Vec2d(*normals[k]), t))
    return sorted(found, key=lambda hit: hit.alpha)
