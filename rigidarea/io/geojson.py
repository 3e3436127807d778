"""Outlines from GeoJSON (RFC 7946): polygons and multipolygons, wherever in a file they are."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
import shapely

from ..geometry.gate import not_negative, positive
from ..geometry.outline import Outline
from .limits import LIMITS, Limits, allowed, check, read, shown, text
from .rings import Ring, outlines_of_polygons
from .texts import parse_json
from .values import LARGEST, coordinates, first_wrong

#: Lists and objects within each other in a file: what a stack bears. Collections are counted as they are read.
DEEPEST = 400
GROUPS = {"FeatureCollection": "features", "GeometryCollection": "geometries"}


def outlines_from_geojson(
    source: str | os.PathLike[str] | dict[str, Any],
    *,
    scale: float = 1.0,
    tolerance: float = 0.0,
    limits: Limits = LIMITS,
) -> list[Outline]:
    """One outline for every polygon of a GeoJSON file, or of an object already parsed, in its order.

    Such an object may have tuples for lists, as shapely's `__geo_interface__` has.

    Coordinates are taken as plane lengths and multiplied by `scale` (longitudes and latitudes have to be projected
    first); a third one is dropped. tolerance: largest distance of a point that may be dropped (length, after scale).
    Points and lines are passed over.

    Raises ValueError for what is no GeoJSON, for coordinates that are not finite, for polygons that cross themselves,
    and for more than `limits` allow.
    """
    allowed(limits)
    scale, tolerance = positive(scale, "scale"), not_negative(tolerance, "tolerance")
    if isinstance(source, dict):
        found = source
    else:
        found = parse_json(text(read(source, limits), str(source)), str(source), DEEPEST, limits)
    polygons: list[shapely.Polygon] = []
    points = [0]
    _walk(found, polygons, points, scale, 0, limits)
    return outlines_of_polygons(polygons, tolerance, limits)


def _walk(
    found: Any, polygons: list[shapely.Polygon], points: list[int], scale: float, depth: int, limits: Limits
) -> None:
    if depth > limits.depth:
        raise ValueError(f"expected at most {limits.depth} collections within each other")
    if not isinstance(found, dict) or not isinstance(found.get("type"), str):
        raise ValueError(f"expected a GeoJSON object with a type, got {shown(found, 80)}")
    kind = found["type"]
    if kind in GROUPS:
        for part in _list(found.get(GROUPS[kind]), GROUPS[kind]):
            _walk(part, polygons, points, scale, depth + 1, limits)
    elif kind == "Feature":
        if found.get("geometry") is not None:
            _walk(found["geometry"], polygons, points, scale, depth + 1, limits)
    elif kind in ("Polygon", "MultiPolygon"):
        parts = _list(found.get("coordinates"), "coordinates")
        for rings in [parts] if kind == "Polygon" else parts:
            check(len(polygons) + 1, limits.parts, "polygons")
            placed = [_ring(ring, points, scale, limits) for ring in _list(rings, "a polygon's rings")]
            if not placed:
                raise ValueError("expected a polygon with at least one ring, got none")
            polygons.append(shapely.Polygon(placed[0], placed[1:]))
    elif kind not in ("Point", "MultiPoint", "LineString", "MultiLineString"):
        raise ValueError(f"expected a type of GeoJSON, got {shown(kind, 80)}")


def _list(found: Any, what: str) -> list[Any]:
    if isinstance(found, tuple):  # of a `__geo_interface__`
        return list(found)
    if not isinstance(found, list):
        raise ValueError(f"expected {what} as a list, got {shown(found, 80)}")
    return found


def _ring(found: Any, points: list[int], scale: float, limits: Limits) -> Ring:
    ring = _list(found, "a ring")
    points[0] += len(ring)
    check(points[0], limits.points, "points")
    if len(ring) < 4:
        raise ValueError(f"expected a ring of at least 4 points, the last one the first, got {len(ring)}")
    if tuple in set(map(type, ring)):
        ring = [list(point) if isinstance(point, tuple) else point for point in ring]
    placed = coordinates(ring, (2, 3))
    if placed is None:
        plane = [point[:2] if isinstance(point, list) else point for point in ring]  # of more dimensions
        placed = coordinates(plane, (2,))
        if placed is None:
            bad = plane[first_wrong(plane, (2,))]
            if not isinstance(bad, list) or len(bad) < 2 or set(map(type, bad)) - {int, float}:
                raise ValueError(f"expected a point as [x, y], got {shown(bad, 80)}")
            raise ValueError(f"expected finite coordinates of at most {LARGEST:g}, got {shown(bad, 80)}")
    placed = scale * placed[:, :2]
    if not np.isfinite(placed).all():
        raise ValueError(f"expected finite coordinates, got more than that after scale {scale:g}")
    return placed
