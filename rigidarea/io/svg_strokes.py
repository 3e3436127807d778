"""Strokes of a drawing as polygons."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import shapely

from .limits import check
from .rings import overlapping_boxes
from .values import Ring

#: Points of the strokes of one element, and pairs of their edges whose boxes overlap: GEOS pays for every crossing.
STROKED, CROSSING = 1_000, 50_000


class Stroke(NamedTuple):
    """A pen: its width (length), caps and joins as SVG calls them; closed: the element's rings are."""

    width: float
    cap: str
    join: str
    closed: bool


def stroked(rings: Sequence[Ring], pen: Stroke, tolerance: float | None) -> list[shapely.Polygon]:
    """What a pen covers on its way along rings, (n, 2) each."""
    check(sum(map(len, rings)), STROKED, "points of a stroke")
    ways = ((r, np.append(True, (r[1:] != r[:-1]).any(axis=1))) for r in rings)
    # a pen that does not move draws nothing
    rings = [ring[new] for ring, new in ways if np.count_nonzero(new) > 1]
    if not rings:
        return []
    ends = [(ring[:-1], ring[1:]) for ring in rings]
    low, high = (np.concatenate([how(a, b) for a, b in ends]) for how in (np.minimum, np.maximum))
    overlapping_boxes(shapely.box(*low.T, *high.T), CROSSING, "edges of a stroke", keep=False)
    half = pen.width / 2
    sagitta = min(1e-3 * pen.width if tolerance is None else tolerance, half)
    quarter = min(64, max(1, math.ceil(math.pi / 4 / math.acos(1 - sagitta / half))))
    covered = []
    look: dict[str, Any] = {
        "cap_style": pen.cap if pen.cap in ("round", "square") else "flat",
        "join_style": pen.join if pen.join in ("round", "bevel") else "mitre",
    }
    for ring in rings:
        closed = pen.closed or (len(ring) > 2 and bool((ring[0] == ring[-1]).all()))
        way = shapely.LinearRing(ring) if closed and len(ring) > 2 else shapely.LineString(ring)
        with np.errstate(invalid="ignore"):  # of numbers near the largest; what is not finite is refused
            covered.append(shapely.buffer(way, half, quad_segs=quarter, **look, mitre_limit=4.0))
    parts = shapely.get_parts(shapely.union_all(covered))
    return [part for part in parts if part.geom_type == "Polygon" and part.area > 0]
