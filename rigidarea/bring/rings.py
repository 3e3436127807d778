"""Closed rings, as drawings have them, to outlines with holes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from ..outline import Outline
from .limits import Limits, check
from .values import LARGEST

Ring = NDArray[np.float64]
Indices = NDArray[np.int64]


def outlines_of_polygons(
    polygons: Sequence[shapely.Polygon], tolerance: float, limits: Limits
) -> list[Outline]:
    """One outline a polygon, thinned to `tolerance` (largest distance of a dropped point, length; 0: kept as is).

    Raises ValueError for polygons that are not valid, with the place.
    """
    check(sum(map(shapely.get_num_coordinates, polygons)), limits.points, "points")
    made = []
    for i, polygon in enumerate(polygons):
        if not shapely.is_valid(polygon):
            reason = shapely.is_valid_reason(polygon)
            raise ValueError(
                f"polygon {i}: {reason}; expected rings that neither cross themselves nor each other"
            )
        thin = shapely.simplify(polygon, tolerance, preserve_topology=True) if tolerance > 0 else polygon
        made.append(
            Outline.from_shapely(thin if isinstance(thin, shapely.Polygon) and not thin.is_empty else polygon)
        )
    return made


def polygons_of_rings(rings: Sequence[Ring], limits: Limits) -> list[shapely.Polygon]:
    """Polygons from the rings of one drawing: what lies within an odd number of them is solid (even-odd rule).

    Rings of no area are dropped. Raises ValueError for a ring that crosses itself, and for rings that cross.
    """
    check(len(rings), limits.parts, "rings")
    check(sum(map(len, rings)), limits.points, "points")
    solid = []
    for i, ring in enumerate(rings):
        if len(ring) < 3:
            continue
        if not (np.abs(ring) <= LARGEST).all():
            raise ValueError(f"ring {i}: expected finite coordinates of at most {LARGEST:g}")
        polygon = shapely.Polygon(ring)
        extent = float(np.max(np.ptp(ring, axis=0)))
        if shapely.convex_hull(polygon).area <= 1e-12 * extent**2:
            continue
        if not shapely.is_valid(polygon):
            raise ValueError(
                f"ring {i}: {shapely.is_valid_reason(polygon)}; expected a ring that does not cross itself"
            )
        solid.append(polygon)
    inner, outer = overlapping_boxes(solid, limits.parts, "rings")
    edges = np.array([polygon.exterior for polygon in solid], object)
    areas = np.array(solid, object)
    for i, j in zip(inner, outer):
        if shapely.crosses(edges[i], areas[j]) and not shapely.touches(edges[i], edges[j]):
            raise ValueError(
                f"rings {min(i, j)} and {max(i, j)} cross; expected rings apart or within each other"
            )
    parents: list[list[int]] = [[] for _ in solid]
    for i, j in zip(inner, outer):
        if shapely.covered_by(areas[i], areas[j]):
            parents[i].append(int(j))
    # a ring within an even number of others is an outer one; its holes are the rings one deeper that it holds
    holes: dict[int, list[int]] = {i: [] for i, over in enumerate(parents) if len(over) % 2 == 0}
    for i, over in enumerate(parents):
        if len(over) % 2:
            owner = min(over, key=lambda j: solid[j].area)
            if owner not in holes:
                raise ValueError(f"ring {i} lies in ring {owner} and is neither its hole nor apart from it")
            holes[owner].append(i)
    return [
        shapely.Polygon(solid[i].exterior, [solid[j].exterior for j in inner]) for i, inner in holes.items()
    ]


def overlapping_boxes(solid: Sequence[shapely.Polygon], most: int, what: str) -> tuple[Indices, Indices]:
    """Pairs (i, j), i != j, of polygons whose boxes overlap: the i and the j, each (n,).

    Raises ValueError for more than `most` pairs of `what` (1e5 nested rings have 1e10).
    """
    if not solid:
        return np.zeros(0, int), np.zeros(0, int)
    tree, found, total = shapely.STRtree(solid), [], 0
    for first in range(0, len(solid), 64):
        pairs = tree.query(solid[first : first + 64])
        pairs[0] += first
        pairs = pairs[:, pairs[0] != pairs[1]]
        total += pairs.shape[1]
        check(total, most, f"pairs of {what} whose boxes overlap")
        found.append(pairs)
    inner, outer = np.concatenate(found, axis=1)
    return inner, outer


def curve_tolerance(tolerance: float | None, bounds: tuple[float, float, float, float]) -> float:
    """The tolerance given (length, > 0), or a thousandth of the drawing's smaller extent.

    Raises ValueError for one that is not positive and finite.
    """
    if tolerance is None:
        return 1e-3 * (min(bounds[2] - bounds[0], bounds[3] - bounds[1]) or 1.0)
    if isinstance(tolerance, bool) or not (
        isinstance(tolerance, int | float) and 0 < tolerance < float("inf")
    ):
        raise ValueError(f"tolerance must be a finite number > 0, got {tolerance!r}")
    return float(tolerance)
