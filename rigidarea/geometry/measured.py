"""What rings measure: area, centroid, bounds and gyration of the solid within; whether it is convex."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from . import arcs as curves
from .arcs import Points
from .gate import LARGEST

_EPS = float(np.finfo(np.float64).eps)


class Measured(NamedTuple):
    """An outline's rings as `Outline` keeps them, and what they enclose."""

    rings: tuple[Points, ...]
    arcs: tuple[Points, ...]
    area: float
    centroid: tuple[float, float]
    bounds: tuple[float, float, float, float]


def measured(rings: list[Points], arcs: Sequence[Points]) -> Measured:
    """Rings (and arcs beside them, or none) turned so that the solid is on the left, read-only, and their measures.

    Raises ValueError where coordinates are not finite, or too large, or enclose no area.
    """
    if not all(np.isfinite(ring).all() and np.abs(ring).max() <= LARGEST for ring in rings):
        raise ValueError(f"coordinates must be finite and at most {LARGEST:g} in size")
    if not any(ring[:, 2].any() for ring in arcs):
        arcs = ()
    outer = curves.extremes(rings[0], arcs[0]) if arcs else rings[0]
    lower, upper = np.minimum.reduce(outer), np.maximum.reduce(outer)
    middle = (lower + upper) / 2  # sums are taken relative to it: far from the origin they lose all digits
    if arcs and len(rings) == 1 and curves.is_circle(arcs[0]):
        middle = arcs[0][0, :2]
    total, first = 0.0, np.zeros(2)
    oriented, bent = [], []
    for i, ring in enumerate(rings):
        arc = curves.about(arcs[i], middle) if arcs else None
        area, moment, _ = curves.measures(ring - middle, arc)
        if (area > 0) == (i > 0):
            area, moment = -area, -moment
            if arcs:
                ring, arc = curves.reversed_ring(ring, arcs[i])
                bent.append(arc)
            else:
                ring = np.ascontiguousarray(ring[::-1])
        elif arcs:
            bent.append(arcs[i])
        oriented.append(ring)
        total += area
        first += moment
    for array in (*oriented, *bent):
        array.flags.writeable = False
    if not (total > 0 and math.isfinite(total)):
        raise ValueError(f"an outline must enclose an area above 0, got {total:.3g} within {upper - lower}")
    return Measured(
        tuple(oriented),
        tuple(bent),
        float(total),
        tuple((middle + first / total).tolist()),
        (*lower.tolist(), *upper.tolist()),
    )


def is_convex(ring: Points, arc: Points | None) -> bool:
    """Whether one ring has no reflex corner or hollow arc; collinear points are allowed."""
    if arc is not None:
        starts, ends = curves.tangents(ring, arc)
        behind = np.roll(ends, 1, axis=0)
        turn = behind[:, 0] * starts[:, 1] - behind[:, 1] * starts[:, 0]
        # tangents are known to the rounding of a coordinate over the shortest radius or edge
        least = np.abs(arc[:, 2])[arc[:, 2] != 0].min()
        least = min(least, np.hypot(*(np.roll(ring, -1, axis=0) - ring).T).min())
        return bool((arc[:, 2] >= 0).all() and np.all(turn >= -8 * _EPS * np.abs(ring).max() / least))
    ahead = np.roll(ring, -1, axis=0) - ring
    behind = np.roll(ahead, 1, axis=0)
    turn = behind[:, 0] * ahead[:, 1] - behind[:, 1] * ahead[:, 0]
    # a coordinate is known to half an ulp, so a turn to that times the two edges' lengths
    noise = 2 * _EPS * np.abs(ring).max() * (np.abs(ahead).sum(axis=1) + np.abs(behind).sum(axis=1))
    return bool(np.all(turn >= -noise))


def gyration(
    rings: tuple[Points, ...], arcs: tuple[Points, ...], area: float, centroid: tuple[float, float]
) -> float:
    """Squared radius of gyration about the centroid (length²)."""
    pairs = zip(rings, arcs or (None,) * len(rings))
    about = [(ring - centroid, curves.about(arc, centroid)) for ring, arc in pairs]
    return sum(curves.measures(ring, arc)[2] for ring, arc in about) / area
