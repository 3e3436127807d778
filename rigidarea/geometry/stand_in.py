"""The shape that stands for an outline in Chipmunk's broad phase: it contains the outline, and costs little."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pymunk
import shapely
from numpy.typing import NDArray

from .arcs import Points, area_and_first_moment

MAX_VERTICES = 8
"""Most vertices of a polygonal stand-in: Chipmunk's GJK walks them all."""
DISTINCT = 1e-9
"""Of its size: corners nearer to each other are one. An edge between two that only rounding parts has no direction, and
Chipmunk misses one in thirty of that shape's contacts, or finds them, by where it begins to look."""


def hull_of(points: Points) -> Points:
    """The corners (m, 2) of the convex hull of points (n, 2), counter-clockwise."""
    return np.ascontiguousarray(
        shapely.get_coordinates(shapely.convex_hull(shapely.LineString(points)))[-1:0:-1]
    )


def farthest(hull: Points, angles: Points) -> NDArray[np.intp]:
    """The corners (3, n) of a convex hull (m, 2) farthest in the directions `angles` (n,), among three each.

    That is where the directions of its edges, which only turn left, pass a quarter turn more (Shamos 1978); rounding
    may be one corner off.
    """
    along = np.roll(hull, -1, axis=0) - hull
    turned = np.unwrap(np.arctan2(along[:, 1], along[:, 0]))
    passed = turned[0] + (angles + math.pi / 2 - turned[0]) % (2 * math.pi)
    return np.asarray((np.searchsorted(turned, passed) + np.arange(-1, 2)[:, None]) % len(hull))


def width_of(hull: Points) -> float:
    """The least distance of two parallel lines with a convex hull (m, 2) between them: one lies along an edge of it."""
    along = np.roll(hull, -1, axis=0) - hull
    away = hull[farthest(hull, np.arctan2(along[:, 0], -along[:, 1]))] - hull
    depth = (along[:, 0] * away[..., 1] - along[:, 1] * away[..., 0]).max(axis=0)
    return float((depth / np.hypot(along[:, 0], along[:, 1])).min())


def stand_in(hull: Points) -> tuple[type[pymunk.Shape], tuple[Any, ...]]:
    """(class, its arguments after the body) of a shape around a convex hull (m, 2).

    The hull where it has no more than 8 vertices, else the tighter of a bounding circle and a bounding octagon; the
    circle, unless the octagon is a tenth smaller.
    """
    hull = _distinct(hull)
    if len(hull) <= MAX_VERTICES:
        return pymunk.Poly, (hull.tolist(),)
    octagon = _bounding_octagon(hull)
    center, radius = _bounding_circle(hull)
    if area_and_first_moment(octagon - center)[0] > 0.9 * math.pi * radius**2:
        return pymunk.Circle, (radius, center.tolist())
    return pymunk.Poly, (_distinct(octagon).tolist(),)


def _distinct(corners: Points) -> Points:
    """The corners (m, 2) of a convex polygon without those that are the next one but for rounding."""
    apart = np.hypot(*(np.roll(corners, -1, axis=0) - corners).T)
    return corners[apart > DISTINCT * np.ptp(corners, axis=0).max()]


def _bounding_circle(hull: Points) -> tuple[Points, float]:
    """Centre and radius of the smallest circle around a convex hull (m, 2).

    It is that of a few of its corners: the farthest outside is added to them until there is none (GEOS alone would take
    m^2). A circle that is not quite there after all passes still contains the hull.
    """
    few = hull[np.linspace(0, len(hull), 4, endpoint=False).astype(int)]
    for _ in range(64):
        circle = shapely.minimum_bounding_circle(shapely.MultiPoint(few))
        center = shapely.get_coordinates(circle.centroid)[0]
        away = np.hypot(*(hull - center).T)
        if away.max() <= (1 + 1e-12) * np.hypot(*(few - center).T).max():
            break
        few = np.vstack((few, hull[np.argmax(away)]))
    return center, float(away.max())


def _bounding_octagon(hull: Points) -> Points:
    """The smallest of a few octagons of 45° corners around a convex hull (m, 2): 8 support lines, met two
    by two."""
    hull = hull[np.unique(farthest(hull, np.arange(64.0) * (math.pi / 32)))]
    best, best_area = hull, math.inf
    for turn in np.arange(8) * (math.pi / 32):
        angle = turn + np.arange(9) * (math.pi / 4)
        normal = np.column_stack((np.cos(angle), np.sin(angle)))
        support = (hull @ normal.T).max(axis=0)
        # n·x = s and n'·x = s' with n' 45° on
        s, t, n, m = support[:-1, None], support[1:, None], normal[:-1], normal[1:]
        corners = s * np.column_stack((m[:, 1], -m[:, 0])) - t * np.column_stack((n[:, 1], -n[:, 0]))
        corners /= math.sin(math.pi / 4)
        area = abs(area_and_first_moment(corners - corners[0])[0])
        if area < best_area:
            best, best_area = corners, area
    return best
