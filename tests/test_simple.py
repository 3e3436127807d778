"""Rings with arcs that bound no region are refused, by the arcs themselves; those that just do are let in."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

import rigidarea as ra
from rigidarea import shapes
from rigidarea.geometry import arcs

SQUARE = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
QUARTER = math.tan(math.pi / 8)  # bulge of a quarter turn


def circle(x: float, y: float, r: float) -> list[tuple[float, float, float]]:
    return [(x + r, y, 1), (x - r, y, 1)]


@pytest.mark.parametrize("near", [1e-2, 1e-4, 1e-6])
def test_arcs_that_cross_beside_their_corner(near: float) -> None:
    """An arc of radius 1 leaves a corner a little below the edge along x, and crosses it again `near` from there."""

    def ring(slope: float) -> list[tuple[float, float, float]]:
        sweep = 1.0
        end = (math.sin(sweep + slope) - math.sin(slope), math.cos(slope) - math.cos(sweep + slope))
        return [(0, 0, math.tan(sweep / 4)), (*end, 0), (2, 1, 0), (2, 0, 0)]

    assert ra.Outline.from_bulges(ring(near / 2)).area > 0
    with pytest.raises(ValueError, match=r"ring must not cross or touch itself; it does at"):
        ra.Outline.from_bulges(ring(-near / 2))


@pytest.mark.parametrize("depth", [1e-3, 1e-6, 1e-9, 1e-12])
def test_a_crossing_of_any_depth_is_seen(depth: float) -> None:
    """A bow that reaches over the opposite edge by `depth`, or stays below it by as much."""

    def bow(rise: float) -> list[tuple[float, float, float]]:
        return [
            (-1, 0, -rise),
            (1, 0, 0),
            (1, 0.5, 0),
            (-1, 0.5, 0),
        ]  # a bulge is the rise over half the chord

    assert ra.Outline.from_bulges(bow(0.5 - depth)).area < 2
    with pytest.raises(ValueError, match="cross or touch itself"):
        ra.Outline.from_bulges(bow(0.5 + depth))


@pytest.mark.parametrize("gap", [1e-3, 1e-6, 1e-9, 1e-12])
def test_a_hole_may_come_near_and_not_cross(gap: float) -> None:
    """A round hole in a disc, and two in a square, `gap` apart: in; as much over each other: out."""
    assert ra.Outline.from_bulges(circle(0, 0, 1), [circle(0.5, 0, 0.5 - gap)]).area < math.pi
    with pytest.raises(ValueError, match=r"holes\[0\] must lie inside the outer ring"):
        ra.Outline.from_bulges(circle(0, 0, 1), [circle(0.5, 0, 0.5 + gap)])
    left, right = circle(-0.5, 0, 0.5 - gap), circle(0.5, 0, 0.5)
    assert ra.Outline.from_bulges([(2 * x, 2 * y, b) for x, y, b in SQUARE], [left, right]).area < 16
    left = circle(-0.5, 0, 0.5 + gap)
    with pytest.raises(ValueError, match=r"holes\[.\] and holes\[.\] must be apart"):
        ra.Outline.from_bulges([(2 * x, 2 * y, b) for x, y, b in SQUARE], [left, right])


def test_rings_may_touch_as_long_as_they_part_nothing() -> None:
    touching = ra.Outline.from_bulges(circle(0, 0, 1), [circle(0.5, 0, 0.5)])  # in one point
    assert touching.area == pytest.approx(0.75 * math.pi, rel=1e-15)
    chain = [circle(x, 0, 0.25) for x in (-0.75, -0.25, 0.25)]
    assert ra.Outline.from_bulges(circle(0, 0, 1), chain).area == pytest.approx(0.8125 * math.pi, rel=1e-15)
    with pytest.raises(ValueError, match="one connected region"):
        ra.Outline.from_bulges(circle(0, 0, 1), [*chain, circle(0.75, 0, 0.25)])


@pytest.mark.parametrize(
    ("ring", "holes", "said"),
    [
        ([(0, 0, 0.5), (1, 0, -0.5)], [], "must"),  # out and back on one arc
        ([(0, 0, 0.5), (1, 0, 0), (0, 0, 0.2), (0, 1, 0)], [], "ring must not cross or touch itself"),
        ([(0, 0, 0), (1, 1, 0.1), (1, 0, 0), (0, 1, 0)], [], "ring must not cross or touch itself"),
        (SQUARE, [circle(3, 0, 0.5)], "inside the outer ring"),
        (SQUARE, [circle(0, 0, 3)], "inside the outer ring"),
        (SQUARE, [circle(0, 0, 0.5), circle(0.1, 0, 0.2)], r"holes\[.\] and holes\[.\] must be apart"),
        (SQUARE, [circle(0, 0, 0.5), circle(0, 0, 0.5)], r"holes\[.\] and holes\[.\] must be apart"),
        (SQUARE, [[(-1, -0.5, 0), (-1, 0.5, 0.3), (0, 0, 0)]], "share an edge with the outer ring"),
        (circle(0, 0, 1), [[(0, 1, QUARTER), (-1, 0, 0)]], "share an edge with the outer ring"),
        (SQUARE, [[(-0.5, 0, -0.9), (0.5, 0, 0), (0.2, 0.6, 0)]], r"holes\[0\] must not cross"),
    ],
)  # fmt: skip
def test_what_is_refused(ring: list, holes: list, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        ra.Outline.from_bulges(ring, holes)


def random_rings(rng: np.random.Generator) -> list[np.ndarray]:
    """A ring of 3 to 9 edges about the origin, and a smaller one, bulged so much that one in two crosses something."""
    rings = []
    for size in (1.0, rng.uniform(0.2, 0.8)):
        n = int(rng.integers(3, 10))
        angle = 2 * math.pi * (np.arange(n) + rng.uniform(-0.4, 0.4, n)) / n
        reach = size * rng.uniform(0.5, 1.0, n)
        bend = rng.uniform(-0.7, 0.7, n) * (rng.random(n) < 0.6)
        rings.append(np.stack([reach * np.cos(angle), reach * np.sin(angle), bend], 1))
    return rings


def test_as_geos_says_of_fine_polygons() -> None:
    """600 random rings with a hole: taken where those of 1e-7 sagitta are valid, but for the few that come nearer."""
    rng = np.random.default_rng(5)
    taken = refused = 0
    for _ in range(600):
        ring, hole = random_rings(rng)
        turned = [arcs.bulging(rows[:, :2], rows[:, 2]) for rows in (ring, hole)]
        fine = [arcs.sampled(p, bend, 1e-7) if bend[:, 2].any() else p for p, bend in turned]
        lines = [shapely.LinearRing(points) for points in fine]
        whole = shapely.Polygon(fine[0], [fine[1]])
        valid = shapely.is_valid(whole) and all(line.is_simple for line in lines)
        try:
            ra.Outline.from_bulges(ring, [hole])
        except ValueError:
            assert not valid or lines[0].distance(lines[1]) < 1e-6
            refused += 1
        else:
            assert valid
            taken += 1
    assert min(taken, refused) > 100


def test_shapes_of_many_arcs_pass() -> None:
    """Corners that leave no edge, or hardly any; far off the origin; and a check of its own for a narrow neck."""
    corners = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
    for radius in (1e-6, 0.1, 0.5 - 1e-13, 0.5):
        for away in (0.0, 1e3, 1e6):
            outline = shapes.rounded_polygon(corners + away, radius)
            assert outline.area == pytest.approx(1 - (4 - math.pi) * radius**2, rel=1e-9)
    ring = ra.Outline.from_bulges([(math.cos(a), math.sin(a), QUARTER) for a in np.arange(4) * math.pi / 2])
    assert ring.area == pytest.approx(math.pi, rel=1e-15)
    gear = [(math.cos(a), math.sin(a), (-1) ** k * 0.9) for k, a in enumerate(np.arange(400) * math.pi / 200)]
    assert 0.9 * math.pi < ra.Outline.from_bulges(gear).area < 1.1 * math.pi
