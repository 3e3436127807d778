"""Disc, box, annulus, capsule, polygon with rounded corners."""

from __future__ import annotations

import math
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from ..outline import DEFAULT_TOLERANCE, Outline, arc_points, circle_points, positive


def circle(radius: float, *, tolerance: float | None = None) -> Outline:
    """A disc of `radius` (length): a regular polygon of the disc's area.

    tolerance: length; default a thousandth of the radius (72 points). ValueError unless both are positive.
    """
    radius, tolerance = positive(radius, "radius"), _tolerance(tolerance, radius)
    return Outline.from_curve([circle_points((0, 0), radius, tolerance)], partial(circle, radius))


def box(width: float, height: float) -> Outline:
    """A rectangle `width` by `height` (length). ValueError unless both are positive."""
    x, y = positive(width, "width") / 2, positive(height, "height") / 2
    return Outline([(-x, -y), (x, -y), (x, y), (-x, y)])


def ring(inner: float, outer: float, *, tolerance: float | None = None) -> Outline:
    """An annulus, or the journal of a bearing: radii `inner` < `outer` (length), the hole being a hole.

    tolerance: length; default a thousandth of the inner radius. A pin with little play in the hole wants
    less than a tenth of the play. ValueError unless 0 < inner < outer.
    """
    inner, outer = positive(inner, "inner"), positive(outer, "outer")
    if inner >= outer:
        raise ValueError(f"inner must be smaller than outer, got inner={inner!r}, outer={outer!r}")
    tolerance = _tolerance(tolerance, inner)
    rings = [circle_points((0, 0), radius, tolerance) for radius in (outer, inner)]
    return Outline.from_curve(rings, partial(ring, inner, outer))


def capsule(length: float, radius: float, *, tolerance: float | None = None) -> Outline:
    """A stadium along x: two half discs of `radius`, their centres `length` apart.

    tolerance: length; default a thousandth of the radius. ValueError unless all are positive.
    """
    half, radius = positive(length, "length") / 2, positive(radius, "radius")
    tolerance = _tolerance(tolerance, radius)
    right = arc_points((half, 0), radius, -math.pi / 2, math.pi, tolerance)
    return Outline.from_curve([np.concatenate((right, -right))], partial(capsule, length, radius))


def rounded_polygon(points: ArrayLike, radius: float, *, tolerance: float | None = None) -> Outline:
    """A polygon, concave or not, every corner of which is rounded by an arc of `radius` (length) tangent to
    its two edges.

    points: (n, 2), either sense; a point between collinear edges stays a point.
    tolerance: length; default a thousandth of half the polygon's smaller extent.
    ValueError for points that make no outline, and where two roundings need more than the edge between them.
    """
    sharp, radius = Outline(points), positive(radius, "radius")
    xmin, ymin, xmax, ymax = sharp.bounds
    tolerance = _tolerance(tolerance, min(xmax - xmin, ymax - ymin) / 2)
    corner = sharp.rings[0]
    ahead = np.roll(corner, -1, axis=0) - corner
    length = np.hypot(*ahead.T)
    heading = np.arctan2(ahead[:, 1], ahead[:, 0])
    turn = (heading - np.roll(heading, 1) + math.pi) % (2 * math.pi) - math.pi  # left positive
    cut = radius * np.abs(np.tan(turn / 2))  # of both edges, from the corner to the tangent point
    spare = length - cut - np.roll(cut, -1)
    noise = 1e-12 * length.max()
    if spare.min() < -noise:
        i = int(np.argmin(spare))
        raise ValueError(
            f"radius must leave every edge: edge {i} of length {length[i]:.6g} needs "
            f"{length[i] - spare[i]:.6g} for its two corners at radius {radius:.6g}"
        )
    pieces = []
    for i in range(len(corner)):
        if cut[i] <= 1e-9 * length.max():
            pieces.append(corner[i : i + 1])
            continue
        side = math.copysign(1, turn[i])
        before = heading[i - 1]
        tangent = corner[i] - cut[i] * np.array((math.cos(before), math.sin(before)))
        center = tangent + side * radius * np.array((-math.sin(before), math.cos(before)))
        arc = arc_points(tuple(center), radius, before - side * math.pi / 2, turn[i], tolerance)
        pieces.append(arc[1:] if spare[i - 1] <= noise else arc)  # where no edge is left, arc meets arc
    return Outline(np.concatenate(pieces)).with_curve(partial(rounded_polygon, corner, radius))


def _tolerance(tolerance: float | None, size: float) -> float:
    return DEFAULT_TOLERANCE * size if tolerance is None else positive(tolerance, "tolerance")
