"""Pure geometry: the contact regions of two placed outlines."""

from __future__ import annotations

import math
import threading
from collections.abc import Sequence
from functools import cached_property, lru_cache
from math import isfinite
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .contact.space_record import overlap_by_address, state_of_arrays
from .geometry.arcs import sampled
from .geometry.direction import chord_direction
from .geometry.gate import numbers
from .geometry.outline import Outline
from .geometry.overlap import Relative, Work, enlarged, fits, new_work
from .geometry.pick import is_inside
from .geometry.place import Pose, overlaps_of_outlines, push_out
from .geometry.pool import Pool, pack
from .geometry.solid import DEFAULT_TOLERANCE

OVERLAP = np.dtype(
    [
        ("area", "f8"),  # (length^2)
        ("centroid", "f8", 2),  # (length)
        ("direction", "f8", 2),  # unit, from A to B: the way the force pushes B
        ("chord", "f8"),  # (length); 0 where the boundaries do not cross
        # RegionPolygon: an array (n, 2), made when it is looked at, of the counter-clockwise outer boundary of the
        # region, arcs sampled (length)
        ("polygon", "O"),
    ]
)
"""One row a region, as `overlap` returns them: area, centroid, direction, chord, polygon."""
OVERLAPS = np.dtype(
    [
        ("place", "i8"),  # which of the places
        ("area", "f8"),  # (length^2)
        ("centroid", "f8", 2),  # (length)
        ("direction", "f8", 2),  # unit, from A to B
        ("chord", "f8"),  # (length); 0 where the boundaries do not cross
    ]
)
"""One row a region, as `overlaps` returns them: place, area, centroid, direction, chord."""


_scratch = threading.local()


class RegionPolygon(Sequence[np.ndarray]):
    """The boundary of a region as points (n, 2), worked out the first time that somebody looks.

    Reads like the array that `numpy.asarray` makes of it: length, indices, slices, iteration. Arcs are sampled to
    `DEFAULT_TOLERANCE` times the root of the region's area.
    """

    def __init__(
        self,
        corners: np.ndarray,
        bows: np.ndarray | None,
        pose: Pose,
        middle: tuple[float, float],
        tolerance: float,
    ) -> None:
        self._made_of = corners, bows, pose, middle, tolerance

    @cached_property
    def points(self) -> np.ndarray:
        """float64 (n, 2), world (length)."""
        corners, bows, pose, middle, tolerance = self._made_of
        if bows is not None:
            bows = np.where(bows[:, 2:] == 0, 0.0, bows)  # no centre is written for no radius
            corners = sampled(corners, bows, tolerance)
        return (corners + middle) @ np.array([[pose.c, pose.s], [-pose.s, pose.c]]) + (pose.x, pose.y)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        points = self.points if dtype is None else self.points.astype(dtype, copy=False)
        return points.copy() if copy else points

    def __len__(self) -> int:
        return len(self.points)

    def __getitem__(self, index: Any) -> Any:
        return self.points[index]

    def __repr__(self) -> str:
        return repr(self.points)


#: Pairs of outlines that are kept packed.
KNOWN = 64


@lru_cache(maxsize=KNOWN)
def _packed(a: Outline, b: Outline) -> Pool:
    return pack([a, b])


def _pose(place: Sequence[float], name: str) -> tuple[float, float, float, float]:
    """x, y, cosine, sine."""
    try:
        x, y, angle = map(float, place)
    except (TypeError, ValueError, OverflowError):
        x = y = angle = math.nan
    if not (isfinite(x) and isfinite(y) and isfinite(angle)):
        raise ValueError(f"{name} must be finite (x, y, angle), got {place!r}")
    return x, y, math.cos(angle), math.sin(angle)


def _check_outlines(outline_a: object, outline_b: object) -> None:
    for name, outline in (("outline_a", outline_a), ("outline_b", outline_b)):
        if not isinstance(outline, Outline):
            raise ValueError(f"{name} must be an Outline, got {type(outline).__name__}")


def _scratch_for(pool: Pool) -> Work:
    """This thread's scratch memory, made if need be."""
    points, rings = len(pool.points), len(pool.rings)
    work: Work | None = getattr(_scratch, "work", None)
    if work is None or not fits(work, points, rings):
        _scratch.known = {}
        work = _scratch.work = new_work(max(points, 256), 64, max(rings, 16))
    return work


class _Known(NamedTuple):
    """Two packed outlines, and where machine code finds them and this thread's scratch memory."""

    address: int
    x: float
    """The middle of the first outline."""
    y: float
    pool: Pool
    work: Work
    state: np.ndarray
    """What is at the address."""


def _addressed(pool: Pool) -> _Known:
    known: dict[int, _Known] = _scratch.__dict__.get("known", {})
    found = known.get(id(pool))
    if found is None:
        work = _scratch_for(pool)
        known = _scratch.__dict__.setdefault("known", {})
        if len(known) >= KNOWN:
            known.clear()
        state = state_of_arrays(pool, work)
        head = pool.heads[0]
        found = known[id(pool)] = _Known(
            state.ctypes.data, float(head["x"]), float(head["y"]), pool, work, state
        )
    return found


def _enlarge(pool: Pool, work: Work) -> Work:
    _scratch.known = {}
    _scratch.work = enlarged(work, max(len(pool.points), 256), max(len(pool.rings), 16))
    return _scratch.work


def overlap(
    outline_a: Outline, place_a: Sequence[float], outline_b: Outline, place_b: Sequence[float]
) -> np.ndarray:
    """Contact regions of two outlines where they overlap.

    place_a, place_b: where each outline's body is, (x, y, angle) (length, length, radians).
    Returns a structured array, one OVERLAP row a connected region, empty where the outlines are apart: `area` (Eq. 4,
    length^2), `centroid` (2,) (Eq. 7, length, world), `direction` (2,), unit, from A to B: perpendicular to the chord,
    or where there is none (an outline inside the other, crossed bars) the shortest way out; `chord` (length, 0 where
    there is none); `polygon`, the region's outer boundary (n, 2) (length). Regions that touch in a single point may
    count as one.

    Raises ValueError for arguments that are no outlines, or no finite (x, y, angle).
    """
    _check_outlines(outline_a, outline_b)
    a, b = _pose(place_a, "place_a"), _pose(place_b, "place_b")
    pool = _packed(outline_a, outline_b)
    address, at_x, at_y, _, work, _ = _addressed(pool)
    n, *rel = overlap_by_address(address, *a, *b)
    while n < 0:
        _enlarge(pool, work)
        address, at_x, at_y, _, work, _ = _addressed(pool)
        n, *rel = overlap_by_address(address, *a, *b)
    out = np.zeros(n, OVERLAP)
    if n == 0:
        return out
    ox, oy, c, s = a
    pose = Pose(ox, oy, c, s)
    for k, loop in enumerate(work.loops[:n].tolist()):
        start, stop, area, x, y, chord_x, chord_y, _, _, _, arcs = loop
        chord = math.hypot(chord_x, chord_y)
        nx, ny = chord_direction(chord_x, chord_y, area)
        if nx == 0.0 and ny == 0.0:
            chord = 0.0
            nx, ny = push_out(pool, 0, 1, Relative(*rel))
        x += at_x
        y += at_y
        corners = work.polygon[start:stop].copy()
        bows = work.bows[start:stop].copy() if arcs else None
        out[k] = (
            area,
            (ox + c * x - s * y, oy + s * x + c * y),
            (c * nx - s * ny, s * nx + c * ny),
            chord,
            RegionPolygon(corners, bows, pose, (at_x, at_y), DEFAULT_TOLERANCE * math.sqrt(area)),
        )
    return out


def covers(outline: Outline, place: Sequence[float], point: Sequence[float]) -> bool:
    """Whether a point (x, y) (length, world) lies inside an outline whose body is at `place`, arcs as they are.

    place: as of `overlap`. Raises ValueError where that does, and for a point that is no two finite numbers.
    """
    _check_outlines(outline, outline)
    x, y, c, s = _pose(place, "place")
    px, py = numbers(point, "point", 2)
    pool = _packed(outline, outline)
    head = pool.heads[0]
    along, across = c * (px - x) + s * (py - y), c * (py - y) - s * (px - x)
    return bool(is_inside(pool, 0, along - float(head["x"]), across - float(head["y"]), _scratch_for(pool)))


def overlaps(outline_a: Outline, places_a: ArrayLike, outline_b: Outline, places_b: ArrayLike) -> np.ndarray:
    """Contact regions of two outlines at many places at once: what `overlap` says of each, without the polygons.

    places_a, places_b: arrays (n, 3) of x, y, angle (length, length, radians), row by row; (3,) is one place for all.
    Returns a structured array, one OVERLAPS row a connected region, in the order of the places: `place`, the number of
    its row, and `area`, `centroid`, `direction`, `chord` as of `overlap`.
    Raises ValueError for arguments that are no outlines, for places that are not finite or not of that shape.
    """
    _check_outlines(outline_a, outline_b)
    a, b = _places(places_a, "places_a"), _places(places_b, "places_b")
    counts = {len(place) for place in (a, b) if place.ndim == 2}
    if len(counts) > 1:
        raise ValueError(f"places_a and places_b must be as many, got {len(a)} and {len(b)}")
    n = counts.pop() if counts else 1
    poses = [_rows(place, n) for place in (a, b)]
    pool = _packed(outline_a, outline_b)
    work = _scratch_for(pool)
    which, room = np.zeros(max(n, 16), np.int64), np.zeros((max(n, 16), 6))
    found, start = [], 0
    while True:
        start, m = overlaps_of_outlines(pool, *poses, work, start, which, room)
        out = np.zeros(m, OVERLAPS)
        out["place"], out["area"], out["chord"] = which[:m], room[:m, 0], room[:m, 5]
        out["centroid"], out["direction"] = room[:m, 1:3], room[:m, 3:5]
        found.append(out)
        if start == n:
            return np.concatenate(found)
        if m == 0:  # one place wants more than there is
            work = _enlarge(pool, work)
            which, room = np.zeros(2 * len(which), np.int64), np.zeros((2 * len(room), 6))


def _places(places: ArrayLike, name: str) -> np.ndarray:
    try:
        given = np.asarray(places, float)
    except (TypeError, ValueError, OverflowError):
        given = np.empty(0)
    if (given.shape != (3,) and (given.ndim != 2 or given.shape[1] != 3)) or not np.isfinite(given).all():
        raise ValueError(f"{name} must be finite (n, 3) of x, y, angle, or one (3,), got {places!r:.80}")
    return given


def _rows(places: np.ndarray, n: int) -> np.ndarray:
    """(n, 4) x, y, cosine, sine."""
    given = np.broadcast_to(places, (n, 3))
    return np.column_stack(
        (given[:, :2], [[math.cos(t), math.sin(t)] for t in given[:, 2]] if n else given[:, :2])
    )
