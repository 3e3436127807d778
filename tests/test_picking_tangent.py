"""What is under a point level with where arcs end, are highest, or run along the look: decided as the outline is."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import shapely

import rigidarea as ra
import tangent_drawings
import tangent_families
from conftest import PURE_PYTHON
from rigidarea.overlap_queries import covers

FAMILIES = (*tangent_families.FAMILIES, *tangent_drawings.DRAWINGS)


def levels(outline: ra.Outline) -> tuple[np.ndarray, np.ndarray]:
    """x and y of all ends, centres and extremes of arcs."""
    points = np.vstack(outline.rings)
    found = [points]
    for arcs in outline.arcs:
        round_ = arcs[arcs[:, 2] != 0]
        found += [round_[:, :2], round_[:, :2] + np.abs(round_[:, 2:]), round_[:, :2] - np.abs(round_[:, 2:])]
    both = np.vstack(found)
    return both[:, 0], both[:, 1]


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.__name__)
def test_points_level_with_tangents(family: Any) -> None:
    """GEOS says which samples' polygon a point lies in, where it is further from the boundary than those: 1e-5."""
    rng = np.random.default_rng(4)
    for _ in range(2 if PURE_PYTHON else 6):
        pair = family(rng, 1.0)
        for outline in (pair.a, pair.b):
            x0, y0, x1, y1 = outline.bounds
            if max(x1 - x0, y1 - y0) > 100.0 or max(map(len, outline.rings)) > 40:
                continue
            polygon = outline.sample(1e-6).polygon if outline.arcs else outline.polygon
            xs, ys = levels(outline)
            xs, ys = (v[(low <= v) & (v <= high)] for v, low, high in ((xs, x0, x1), (ys, y0, y1)))
            xs, ys = (np.concatenate([v[:12], np.nextafter(v[:6], 9.0)]) for v in (xs, ys))
            points = np.concatenate(
                [
                    np.stack(np.meshgrid(xs, ys), -1).reshape(-1, 2),
                    np.stack(np.meshgrid(rng.uniform(x0, x1, 4), ys), -1).reshape(-1, 2),
                    np.stack(np.meshgrid(xs, rng.uniform(y0, y1, 4)), -1).reshape(-1, 2),
                ]
            )
            points = points[rng.permutation(len(points))[:60]]
            at = shapely.points(points)
            clear = shapely.distance(polygon.boundary, at) > 1e-5
            want = shapely.contains(polygon, at)
            for point, inside in zip(points[clear], want[clear]):
                assert covers(outline, (0, 0, 0), tuple(point)) == inside, (outline, tuple(point))
                turned = math.pi / 2  # c = 6e-17: level to rounding
                there = -point[1], point[0]
                assert covers(outline, (0, 0, turned), there) == inside, (outline, tuple(point))
