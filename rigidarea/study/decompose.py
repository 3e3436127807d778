"""Exact convex decomposition of an outline, as engines without concave shapes need it.

A constrained Delaunay triangulation (shapely/GEOS), whose triangles are then merged across diagonals as long
as the union stays convex (Hertel and Mehlhorn 1983: at most four times the least number of pieces).
"""

from __future__ import annotations

import numpy as np
import shapely

from .scene import Array, Rings


def triangles(rings: Rings) -> list[Array]:
    """Counter-clockwise triangles (3, 2) that tile an outline with holes exactly; no vertices are added."""
    outer, *holes = rings
    parts = shapely.constrained_delaunay_triangles(shapely.Polygon(outer, holes)).geoms
    return [np.asarray(shapely.orient_polygons(part).exterior.coords)[:-1] for part in parts]


def convex_pieces(rings: Rings, most: int | None = None) -> list[Array]:
    """Convex counter-clockwise polygons (n, 2) tiling an outline with holes; at most `most` vertices each."""
    vertices: dict[tuple[float, float], int] = {}
    points: list[tuple[float, float]] = []
    pieces: list[list[int] | None] = []
    for triangle in triangles(rings):
        piece = []
        for x, y in triangle.tolist():
            if (x, y) not in vertices:
                vertices[x, y] = len(points)
                points.append((x, y))
            piece.append(vertices[x, y])
        pieces.append(piece)

    owner = {edge: i for i, piece in enumerate(pieces) if piece for edge in _edges(piece)}
    inner = [edge for edge in owner if edge[0] < edge[1] and edge[::-1] in owner]
    # Longest diagonals first: removing them leaves the roundest pieces.
    inner.sort(key=lambda edge: -_length2(points[edge[0]], points[edge[1]]))
    for edge in inner:
        first, second = owner[edge], owner[edge[::-1]]
        one, other = pieces[first], pieces[second]
        if first == second or one is None or other is None:
            continue
        merged = _merge(one, other, edge)
        if (most is None or len(merged) <= most) and _convex_at(points, merged, edge):
            pieces[first], pieces[second] = merged, None
            owner.update({side: first for side in _edges(merged)})
    return [np.array([points[i] for i in piece]) for piece in pieces if piece]


def _edges(piece: list[int]) -> list[tuple[int, int]]:
    return list(zip(piece, piece[1:] + piece[:1]))


def _length2(a: tuple[float, float], b: tuple[float, float]) -> float:
    return (a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2


def _merge(one: list[int], other: list[int], edge: tuple[int, int]) -> list[int]:
    """Both pieces without their common edge: `one` walks edge[0] -> edge[1], `other` the reverse."""
    at = one.index(edge[1])
    start = other.index(edge[0])
    return one[at:] + one[:at] + (other[start:] + other[:start])[1:-1]


def _convex_at(points: list[tuple[float, float]], piece: list[int], edge: tuple[int, int]) -> bool:
    """Whether the merged piece turns left (strictly, to the digits of the sides) where the diagonal ended."""
    n = len(piece)
    for corner in edge:
        i = piece.index(corner)
        a, b, c = points[piece[i - 1]], points[corner], points[piece[(i + 1) % n]]
        turn = (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])
        if turn <= 1e-9 * (_length2(a, b) * _length2(b, c)) ** 0.5:
            return False
    return True
