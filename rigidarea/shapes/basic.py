"""Disc, box, annulus, capsule, polygon with rounded corners."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from ..geometry.arcs import circle_ring
from ..geometry.gate import positive
from ..geometry.outline import Outline
from ..geometry.simple import check_simple


def circle(radius: float, *, tolerance: float | None = None) -> Outline:
    """A disc of `radius` (length); with a `tolerance` (length) sampled to it. ValueError unless they are positive."""
    return _sampled(Outline.circle(radius), tolerance)


def box(width: float, height: float) -> Outline:
    """A rectangle `width` by `height` (length). ValueError unless both are positive."""
    x, y = positive(width, "width") / 2, positive(height, "height") / 2
    return Outline([(-x, -y), (x, -y), (x, y), (-x, y)])


def ring(inner: float, outer: float, *, tolerance: float | None = None) -> Outline:
    """An annulus, or the journal of a bearing: radii `inner` < `outer` (length), the hole being a hole.

    tolerance: length; if given, the circles are sampled to it. ValueError unless 0 < inner < outer.
    """
    inner, outer = positive(inner, "inner"), positive(outer, "outer")
    if inner >= outer:
        raise ValueError(f"inner must be smaller than outer, got inner={inner!r}, outer={outer!r}")
    points, arcs = zip(*(circle_ring((0.0, 0.0), radius) for radius in (outer, inner)))
    return _sampled(Outline.from_curve(points, arcs=arcs), tolerance)


def capsule(length: float, radius: float, *, tolerance: float | None = None) -> Outline:
    """A stadium along x: two half discs of `radius`, their centres `length` apart.

    tolerance: length; if given, the arcs are sampled to it. ValueError unless all are positive.
    """
    half, radius = positive(length, "length") / 2, positive(radius, "radius")
    points = np.array([(half, -radius), (half, radius), (-half, radius), (-half, -radius)])
    arcs = np.array([(half, 0.0, radius), (0.0, 0.0, 0.0), (-half, 0.0, radius), (0.0, 0.0, 0.0)])
    return _sampled(Outline.from_curve([points], arcs=[arcs]), tolerance)


def rounded_polygon(points: ArrayLike, radius: float, *, tolerance: float | None = None) -> Outline:
    """A polygon, concave or not, every corner of which is rounded by an arc of `radius` (length) tangent to
    its two edges.

    points: (n, 2), either sense; a point between collinear edges stays a point.
    tolerance: length; if given, the arcs are sampled to it.
    ValueError for points that make no outline, and where two roundings need more than the edge between them.
    """
    radius = positive(radius, "radius")
    corner = Outline(points).rings[0]
    ahead = np.roll(corner, -1, axis=0) - corner
    length = np.hypot(*ahead.T)
    heading = np.arctan2(ahead[:, 1], ahead[:, 0])
    turn = (heading - np.roll(heading, 1) + math.pi) % (2 * math.pi) - math.pi  # left positive
    with np.errstate(over="ignore"):  # a radius near the largest float leaves no edge either
        cut = radius * np.abs(np.tan(turn / 2))  # of both edges, from the corner to the tangent point
        spare = length - cut - np.roll(cut, -1)
    noise = 1e-12 * length.max()
    if spare.min() < -noise:
        i = int(np.argmin(spare))
        raise ValueError(
            f"radius must leave every edge: edge {i} of length {length[i]:.6g} needs "
            f"{length[i] - spare[i]:.6g} for its two corners at radius {radius:.6g}"
        )
    ring: list[np.ndarray] = []
    arcs = []
    for i in range(len(corner)):
        if cut[i] <= 1e-9 * length.max():
            ring.append(corner[i])
            arcs.append((0.0, 0.0, 0.0))
            continue
        side = math.copysign(1, turn[i])
        along, leaving = ahead[i - 1] / length[i - 1], ahead[i] / length[i]
        tangent = corner[i] - cut[i] * along
        center = tangent + side * radius * np.array((-along[1], along[0]))
        if spare[i - 1] <= noise and arcs and arcs[-1] == (0.0, 0.0, 0.0):  # no edge is left: arc meets arc
            ring.pop()
            arcs.pop()
        ring += [tangent, corner[i] + cut[i] * leaving]
        arcs += [(*center.tolist(), side * radius), (0.0, 0.0, 0.0)]
    if spare[-1] <= noise and cut[0] > 0 and arcs[-1] == (0.0, 0.0, 0.0):
        ring.pop()
        arcs.pop()
    rings, bows = [np.array(ring)], [np.array(arcs)]
    check_simple(rings, bows, ["points"])  # arcs may cut into each other in a narrow neck
    return _sampled(Outline.from_curve(rings, arcs=bows), tolerance)


def _sampled(outline: Outline, tolerance: float | None) -> Outline:
    return outline if tolerance is None else outline.sample(tolerance)
