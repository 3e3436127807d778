"""Pure geometry: the contact regions of two placed outlines."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from .arcs import sampled
from .kernel.direction import chord_direction
from .kernel.overlap import Work, enlarged, new_work
from .kernel.place import Pose, overlap_of_outlines, push_out
from .kernel.pool import Pool, pack
from .outline import DEFAULT_TOLERANCE, Outline

#: One row a region, as `overlap` returns them.
OVERLAP = np.dtype(
    [
        ("area", "f8"),  # (length^2)
        ("centroid", "f8", 2),  # (length)
        ("direction", "f8", 2),  # unit, from A to B: the way the force pushes B
        ("chord", "f8"),  # (length); 0 where the boundaries do not cross
        ("polygon", "O"),  # (n, 2) counter-clockwise outer boundary of the region, arcs sampled (length)
    ]
)


@lru_cache(maxsize=64)
def _packed(a: Outline, b: Outline) -> Pool:
    return pack([a, b])


def _pose(place: Sequence[float], name: str) -> Pose:
    values = np.asarray(place, dtype=float)
    if values.shape != (3,) or not np.isfinite(values).all():
        raise ValueError(f"{name} must be finite (x, y, angle), got {place!r}")
    x, y, angle = map(float, values)
    return Pose(x, y, math.cos(angle), math.sin(angle))


def overlap(
    outline_a: Outline, place_a: Sequence[float], outline_b: Outline, place_b: Sequence[float]
) -> np.ndarray:
    """Contact regions of outline A at (x, y, angle) with outline B at (x, y, angle) (length, length, radians).

    Returns a structured array, one OVERLAP row a connected region, empty where the outlines are apart. Area is Eq. 4,
    centroid Eq. 7; the direction is perpendicular to the chord, for whole outlines inside the other and for crossed
    bars (no chord) the shortest way out. Regions that touch in a single point may count as one.

    Raises ValueError for arguments that are no outlines, or no finite (x, y, angle).
    """
    for name, outline in (("outline_a", outline_a), ("outline_b", outline_b)):
        if not isinstance(outline, Outline):
            raise ValueError(f"{name} must be an Outline, got {type(outline).__name__}")
    a, b = _pose(place_a, "place_a"), _pose(place_b, "place_b")
    pool = _packed(outline_a, outline_b)
    points, rings = len(pool.points), len(pool.rings)
    work: Work = new_work(points, 64, rings)
    while (n := overlap_of_outlines(pool, 0, a, 1, b, work)[0]) < 0:
        work = enlarged(work, points, rings)
    turn = np.array([[a.c, a.s], [-a.s, a.c]])  # rows of A's frame times this: world
    head = pool.heads[0]
    middle = np.array([head["x"], head["y"]])
    out = np.zeros(n, OVERLAP)
    for row, loop in zip(out, work.loops[:n]):
        chord = math.hypot(loop["chord_x"], loop["chord_y"])
        direction = chord_direction(loop["chord_x"], loop["chord_y"], loop["area"])
        if direction == (0.0, 0.0):
            chord = 0.0
            direction = push_out(pool, 0, 1, overlap_of_outlines(pool, 0, a, 1, b, work)[1])
        row["area"] = loop["area"]
        row["centroid"] = (np.array([loop["x"], loop["y"]]) + middle) @ turn + (a.x, a.y)
        row["direction"] = np.array(direction) @ turn
        row["chord"] = chord
        span = slice(loop["start"], loop["stop"])
        corners = work.polygon[span]
        if loop["arcs"]:
            bows = np.where(
                work.bows[span, 2:] == 0, 0.0, work.bows[span]
            )  # no centre is written for no radius
            corners = sampled(corners, bows, DEFAULT_TOLERANCE * math.sqrt(loop["area"]))
        row["polygon"] = (corners + middle) @ turn + (a.x, a.y)
    return out
