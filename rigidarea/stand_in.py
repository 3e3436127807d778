"""The shape that stands for an outline in Chipmunk's broad phase: it contains the outline, and costs little."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pymunk
import shapely

from .arcs import Points, area_and_first_moment

MAX_VERTICES = 8
"""Most vertices of a polygonal stand-in: Chipmunk's GJK walks them all."""


def stand_in(points: Points) -> tuple[type[pymunk.Shape], tuple[Any, ...]]:
    """(class, its arguments after the body) of a shape around points (n, 2).

    Their convex hull where that has no more than 8 vertices, else the tighter of a bounding circle and a bounding
    octagon; the circle, unless the octagon is a tenth smaller.
    """
    hull = shapely.get_coordinates(shapely.convex_hull(shapely.MultiPoint(points)))[:-1]
    if len(hull) <= MAX_VERTICES:
        return pymunk.Poly, (hull.tolist(),)
    octagon = _bounding_octagon(hull)
    circle = shapely.minimum_bounding_circle(shapely.MultiPoint(hull))
    center = shapely.get_coordinates(circle.centroid)[0]
    radius = float(np.hypot(*(hull - center).T).max())
    if area_and_first_moment(octagon - center)[0] > 0.9 * math.pi * radius**2:
        return pymunk.Circle, (radius, center.tolist())
    return pymunk.Poly, (octagon.tolist(),)


def _bounding_octagon(hull: Points) -> Points:
    """The smallest of a few octagons of 45° corners around a convex hull (m, 2): 8 support lines, met two
    by two."""
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
