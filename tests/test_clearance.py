"""How far two boundaries are apart, against shapely."""

import math

import numpy as np
import pytest
import shapely
import shapely.affinity

import rigidarea as ra
from conftest import kernel_module


def star(draw, points, hole):
    """A star-shaped outline about the origin, radius 0.5 to 1, with a hole or without."""
    angle = np.sort(draw.uniform(0, 2 * math.pi, points))
    radius = draw.uniform(0.5, 1.0, points)
    rim = np.column_stack((radius * np.cos(angle), radius * np.sin(angle)))
    return shapely.Polygon(rim, [0.3 * rim] if hole else [])


@pytest.mark.parametrize("seed", range(60))
def test_distance_is_shapelys(seed):
    """Beside each other, and one inside the other's hole; turned, far from the origin, and cut off at `most`."""
    clearance, place = kernel_module("clearance"), kernel_module("place")
    draw = np.random.default_rng(seed)
    a = star(draw, int(draw.integers(8, 200)), True)
    b = star(draw, int(draw.integers(8, 60)), False)
    angle = draw.uniform(0, 6)
    if seed % 2:
        b = shapely.affinity.scale(b, 0.02, 0.02, origin=(0, 0))
        shift = draw.uniform(-0.02, 0.02, 2)
    else:
        shift = draw.uniform(2.1, 4) * np.array([math.cos(angle), math.sin(angle)])
    moved = shapely.affinity.translate(shapely.affinity.rotate(b, angle, (0, 0), use_radians=True), *shift)
    want = a.boundary.distance(moved.boundary)
    pool = kernel_module("pool").pack([ra.Outline.from_shapely(a), ra.Outline.from_shapely(b)])
    work = kernel_module("work").new_work(600)
    far = 1e3 * (seed % 3)
    pose_a = place.Pose(far, -far, 1.0, 0.0)
    pose_b = place.Pose(far + shift[0], shift[1] - far, math.cos(angle), math.sin(angle))
    rel = place.seen_from(pool.heads[0], pose_a, pool.heads[1], pose_b)
    assert clearance.clearance(pool, 0, pool, 1, rel, 1e9, work) == pytest.approx(want, rel=1e-9, abs=1e-12)
    assert clearance.clearance(pool, 0, pool, 1, rel, 0.5 * want, work) == 0.5 * want
