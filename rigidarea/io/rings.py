"""Closed rings, as drawings have them, to outlines with holes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from ..geometry.outline import Outline
from ..geometry.thin import thinned
from .limits import Limits, check
from .values import LARGEST, Ring

Indices = NDArray[np.int64]


def outlines_of_polygons(
    polygons: Sequence[shapely.Polygon], tolerance: float, limits: Limits
) -> list[Outline]:
    """One outline a polygon, thinned to `tolerance` (largest distance of a dropped point, length; 0: kept as is).

    Raises ValueError for polygons that are not valid, with the place.
    """
    check(int(shapely.get_num_coordinates(polygons).sum()), limits.points, "points")
    check(int(shapely.get_num_interior_rings(polygons).sum()) + len(polygons), limits.rings, "rings")
    rings = [shapely.get_coordinates(ring) for polygon in polygons for ring in shapely.get_rings(polygon)]
    check_tangle(rings, limits)
    valid = shapely.is_valid(polygons)
    if not valid.all():
        i = int(np.argmin(valid))
        raise ValueError(
            f"polygon {i}: {shapely.is_valid_reason(polygons[i])};"
            " expected rings that neither cross themselves nor each other"
        )
    return [
        Outline.from_shapely(_thin(polygon, tolerance) if tolerance > 0 else polygon) for polygon in polygons
    ]


def check_tangle(rings: Sequence[Ring], limits: Limits) -> None:
    """ValueError for rings that wind so that whoever looks for crossings has to look at too many pairs of their edges.

    Stretches of edges that go on in one quadrant do not meet themselves: GEOS looks at pairs of such, whose boxes
    overlap. Of a million points on a gear there are a few hundred; of ten thousand on a star, ten thousand.
    """
    if sum(map(len, rings)) < 2000:
        return
    low, high = [], []
    for ring in rings:
        steps = np.diff(ring, axis=0, append=ring[:1])
        quadrant = 2 * (steps[:, 0] < 0) + (steps[:, 1] < 0)
        starts = np.flatnonzero(np.diff(quadrant, prepend=-1))
        ends = ring[np.append(starts[1:], 0)]  # the last point of a stretch is the next one's first
        low.append(np.minimum(np.minimum.reduceat(ring, starts), ends))
        high.append(np.maximum(np.maximum.reduceat(ring, starts), ends))
    boxes = shapely.box(*np.concatenate(low).T, *np.concatenate(high).T)
    overlapping_boxes(boxes, 5 * limits.points, "stretches of rings", keep=False)


def _thin(polygon: shapely.Polygon, tolerance: float) -> shapely.Polygon:
    """The polygon with fewer points: by half the tolerance, and half of that, where its rings would cross."""
    rings = [shapely.get_coordinates(ring)[:-1] for ring in (polygon.exterior, *polygon.interiors)]
    for _ in range(8):
        thin = [ring[thinned(ring, tolerance)] for ring in rings]
        if all(len(ring) > 2 for ring in thin):
            found = shapely.Polygon(thin[0], thin[1:])
            if shapely.is_valid(found):
                return found
        tolerance /= 2
    return polygon


def polygons_of_rings(rings: Sequence[Ring], limits: Limits) -> list[shapely.Polygon]:
    """Polygons from the rings of one drawing: what lies within an odd number of them is solid (even-odd rule).

    Rings of no area are dropped. Raises ValueError for a ring that crosses itself, and for rings that cross.
    """
    check(len(rings), limits.rings, "rings")
    check(sum(map(len, rings)), limits.points, "points")
    kept = []
    for i, ring in enumerate(rings):
        if len(ring) >= 3:
            if not (np.abs(ring) <= LARGEST).all():
                raise ValueError(f"ring {i}: expected finite coordinates of at most {LARGEST:g}")
            kept.append(i)
    if not kept:
        return []
    lengths = [len(rings[i]) for i in kept]
    edges = shapely.linearrings(
        np.concatenate([rings[i] for i in kept]), indices=np.repeat(np.arange(len(kept)), lengths)
    )
    bounds = shapely.bounds(edges)
    extent = (bounds[:, 2:] - bounds[:, :2]).max(axis=1)
    check_tangle([rings[i] for i in kept], limits)
    solid = shapely.polygons(edges)
    wide = shapely.area(shapely.convex_hull(solid)) > 1e-12 * extent**2
    edges, solid, kept = edges[wide], solid[wide], np.array(kept)[wide].tolist()
    valid = shapely.is_valid(solid)
    if not valid.all():
        i = int(np.argmin(valid))
        raise ValueError(
            f"ring {kept[i]}: {shapely.is_valid_reason(solid[i])}; expected a ring that does not cross itself"
        )
    if len(solid) == 1:
        return solid.tolist()
    inner, outer = overlapping_boxes(solid, limits.parts, "rings")
    areas = shapely.area(solid)
    inside = (areas[inner] < areas[outer]) | ((areas[inner] == areas[outer]) & (inner < outer))
    inner, outer = inner[inside], outer[inside]  # the larger one lies in no smaller one
    told = shapely.get_num_coordinates(edges)[inner].sum()
    check(int(told), 10 * limits.points, "points in pairs of rings whose boxes overlap")
    shapely.prepare(solid)
    within = shapely.covers(solid[outer], edges[inner])
    meet = ~within & shapely.intersects(solid[outer], edges[inner])
    for i, j in zip(inner[meet], outer[meet]):
        if shapely.crosses(edges[i], solid[j]):
            first, second = sorted((kept[i], kept[j]))
            raise ValueError(f"rings {first} and {second} cross; expected rings apart or within each other")
    parents: list[list[int]] = [[] for _ in solid]
    for i, j in zip(inner[within].tolist(), outer[within].tolist()):
        parents[i].append(j)
    # a ring within an even number of others is an outer one; its holes are the rings one deeper that it holds
    holes: dict[int, list[int]] = {i: [] for i, over in enumerate(parents) if len(over) % 2 == 0}
    for i, over in enumerate(parents):
        if len(over) % 2:
            owner = min(over, key=lambda j: areas[j])
            if owner not in holes:
                raise ValueError(
                    f"ring {kept[i]} lies in ring {kept[owner]}, a hole; expected rings apart or within each other"
                )
            holes[owner].append(i)
    return [shapely.Polygon(edges[i], [edges[j] for j in inner]) for i, inner in holes.items()]


def overlapping_boxes(
    solid: Sequence[shapely.Polygon], most: int, what: str, keep: bool = True
) -> tuple[Indices, Indices]:
    """Pairs (i, j), i != j, of polygons whose boxes overlap: the i and the j, each (n,); none without `keep`.

    Raises ValueError for more than `most` pairs of `what` (1e5 nested rings have 1e10).
    """
    if not len(solid):
        return np.zeros(0, int), np.zeros(0, int)
    tree, found, total = shapely.STRtree(solid), list[Indices](), 0
    for first in range(0, len(solid), 64):
        pairs = tree.query(solid[first : first + 64])
        pairs[0] += first
        pairs = pairs[:, pairs[0] != pairs[1]]
        total += pairs.shape[1]
        check(total, most, f"pairs of {what} whose boxes overlap")
        if keep or not found:
            found.append(pairs)
    inner, outer = np.concatenate(found, axis=1)
    return inner, outer
