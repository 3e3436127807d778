"""Meshes keep the outline, and refuse what they cannot mesh."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from rigidarea.flexible.mesh import keep_area, resample, triangulate


def circle(radius, n, clockwise=False):
    t = 2 * np.pi * np.arange(n) / n * (-1 if clockwise else 1)
    return np.column_stack([radius * np.cos(t), radius * np.sin(t)])


def toothed(teeth, radius, depth, n=6000):
    t = 2 * np.pi * np.arange(n) / n
    r = radius + depth * np.tanh(3 * np.sin(teeth * t))
    return np.column_stack([r * np.cos(t), r * np.sin(t)])


@pytest.mark.parametrize("growth", [0.0, 0.2])
def test_toothed_wheel_with_bore(growth):
    rings = [resample(toothed(23, 23.0, 2.2), 0.6), resample(circle(8.0, 2000, True), 0.6)]
    mesh = triangulate(rings, growth)
    # boundary nodes: the outline's points, bit for bit, and no other node on the boundary
    assert np.array_equal(mesh.points[: mesh.n_boundary], np.vstack(rings))
    sides = np.sort(np.vstack([mesh.triangles[:, [i, (i + 1) % 3]] for i in range(3)]), axis=1)
    unique, count = np.unique(sides, axis=0, return_counts=True)
    outer = unique[count == 1]
    ring_edges = np.sort(np.vstack([np.column_stack([r, np.roll(r, -1)]) for r in mesh.rings]), axis=1)
    assert np.array_equal(np.unique(ring_edges, axis=0), outer)
    # area by the shoelace formula, to rounding
    exact = sum(0.5 * np.sum(r[:, 0] * np.roll(r[:, 1], -1) - np.roll(r[:, 0], -1) * r[:, 1]) for r in rings)
    assert mesh.areas().min() > 0
    assert mesh.areas().sum() == pytest.approx(exact, rel=1e-12)
    assert mesh.min_angle() > 18.0  # typical 24°; CST error grows like 1/sin of the smallest angle
    assert cKDTree(mesh.points).query(mesh.points, k=2)[0][:, 1].min() > 0.2


def test_graded_boundary():
    fine, step, half = np.linspace(-0.1, 0.1, 81), 0.0025, [0.1]
    while half[-1] + step < np.pi:
        half.append(half[-1] + step)
        step *= 1.2
    t = np.concatenate([fine, half[1:], -np.array(half[:0:-1])])
    mesh = triangulate([np.column_stack([np.cos(t), np.sin(t)])], growth=0.25)
    assert mesh.min_angle() > 15.0
    assert len(mesh.points) < 2500


def test_size_larger_than_a_feature():
    notch = np.array([[0, 0], [10, 0], [10, 5], [5.1, 5], [5.1, 4], [4.9, 4], [4.9, 5], [0, 5]], float)
    with pytest.raises(ValueError, match="must not exceed a feature"):
        resample(notch, 1.0)
    with pytest.raises(ValueError, match="valid region"):
        triangulate([np.array([[0, 0], [1, 1], [1, 0], [0, 1]], float)])
    # a hole nearer to the rim than the boundary's spacing
    with pytest.raises(ValueError, match="larger than a feature"):
        triangulate([circle(1.0, 12), circle(0.96, 400, True)])


def test_a_profile_keeps_the_area_of_its_curve():
    """A circle's polygon of n points: its area is off by 6.6 n⁻² as sampled, by 41 n⁻⁴ as moved; corners stay."""
    for n in (20, 40):
        ring = circle(1.0, n)
        x, y = keep_area(ring).T
        area = 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))
        assert area == pytest.approx(np.pi, rel=50 / n**4)
    corners = np.array([[0, 0], [0.5, 0], [1, 0], [1, 1], [0, 1]], float)
    assert np.array_equal(keep_area(corners), corners)
