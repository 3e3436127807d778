"""Disc, box, annulus, capsule, rounded polygon and the curve sampler, against closed forms and shapely."""

import math
import pickle

import numpy as np
import pytest
import shapely

from rigidarea import shapes
from rigidarea.shapes.curve import sample_curve

L_SHAPE = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)]


def test_plain_shapes_exactly():
    assert shapes.circle(2).area == pytest.approx(4 * math.pi, rel=1e-13)
    assert shapes.box(3, 2).bounds == (-1.5, -1, 1.5, 1)
    assert shapes.capsule(3, 0.5).area == pytest.approx(3 + math.pi / 4, rel=1e-13)
    assert shapes.capsule(3, 0.5).centroid == pytest.approx((0, 0), abs=1e-15)
    annulus = shapes.ring(1, 2)
    assert annulus.area == pytest.approx(3 * math.pi, rel=1e-13)
    assert len(annulus.rings) == 2


def test_moment_of_an_annulus():
    """m (R² + r²)/2; a regular polygon of the circle's area errs by 4/45·(π/n)⁴ relative."""
    annulus = shapes.ring(1, 2, tolerance=1e-3)
    n = len(annulus.rings[1])
    assert annulus.moment(3.0) == pytest.approx(3 * (4 + 1) / 2, rel=4 / 45 * (math.pi / n) ** 4 * 1.1)


def test_moment_of_a_capsule():
    """A box and two half discs, each a distance 4r/3π from its flat side."""
    length, r = 3.0, 0.5
    box, half = length * 2 * r, math.pi * r**2 / 2
    reach = length / 2 + 4 * r / (3 * math.pi)
    exact = box * (length**2 + 4 * r**2) / 12
    exact += 2 * half * (r**2 / 2 - (4 * r / (3 * math.pi)) ** 2 + reach**2)
    outline = shapes.capsule(length, r, tolerance=1e-6)
    assert outline.moment(outline.area) == pytest.approx(exact, rel=1e-6)  # of the order of the tolerance


@pytest.mark.parametrize("radius", [0.05, 0.3, 0.5])
def test_rounded_polygon_loses_at_a_corner_what_the_arc_cuts_off(radius):
    """A right angle loses r²(1 − π/4); a reflex one gains as much."""
    outline = shapes.rounded_polygon(L_SHAPE, radius)
    assert outline.area == pytest.approx(5 - (5 - 1) * radius**2 * (1 - math.pi / 4), rel=1e-12)
    # opening takes the convex corners off, closing fills the reflex ones: shapely's word on the same shape
    oracle = shapely.Polygon(L_SHAPE).buffer(-radius * 0.999999, quad_segs=200).buffer(radius, quad_segs=200)
    oracle = oracle.buffer(radius, quad_segs=200).buffer(-radius, quad_segs=200)
    # our sampling, 1e-3 of half the extent of 3, and GEOS's simplification, 1e-2 of a buffer's distance
    assert outline.polygon.hausdorff_distance(oracle) < 1.5e-3 + 1e-2 * radius
    assert outline.polygon.is_valid


@pytest.mark.parametrize("angle", [0.0, 0.3, 0.7])
def test_a_square_rounded_to_a_disc(angle):
    c, s = math.cos(angle), math.sin(angle)
    square = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) @ [[c, s], [-s, c]] + (0.3, 0.7)
    disc = shapes.rounded_polygon(square, 1.0)
    assert disc.area == pytest.approx(math.pi, rel=1e-12)
    assert disc.convex
    ring = disc.rings[0]
    edges = np.hypot(*(np.roll(ring, -1, axis=0) - ring).T)
    assert edges.min() > 0.99 * edges.max()  # where two arcs meet there is one point


def test_a_collinear_point_stays_a_point():
    outline = shapes.rounded_polygon([(0, 0), (1, 0), (2, 0), (2, 2), (0, 2)], 0.1)
    assert [1, 0] in outline.rings[0].tolist()


@pytest.mark.parametrize(
    "outline",
    [
        shapes.circle(1),
        shapes.ring(1, 2),
        shapes.capsule(1, 0.2),
        shapes.rounded_polygon(L_SHAPE, 0.2),
        shapes.involute_gear(1, 12, bore=2),
        shapes.internal_gear(1, 40),
        shapes.eccentric(1, 0.3, bore=0.2),
        shapes.flat_follower(3, 0.5, bore=0.1),
        shapes.geneva().wheel,
        shapes.geneva().pin,
        shapes.geneva().locking_disc,
    ],
)
def test_every_shape_samples_itself_anew_after_pickling(outline):
    size = outline.bounds[2] - outline.bounds[0]
    fine = pickle.loads(pickle.dumps(outline)).sample(1e-7 * size)
    assert sum(map(len, fine.rings)) > 3 * sum(map(len, outline.rings))
    # (a gear's chords lie inside its convex flanks: its area is right only to the tolerance)
    assert fine.area == pytest.approx(outline.area, rel=1e-3)
    assert fine.polygon.hausdorff_distance(outline.polygon) < 1e-3 * size


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: shapes.circle(0), "radius must be positive and finite, got 0"),
        (lambda: shapes.circle(1, tolerance=-1), "tolerance must be positive and finite, got -1"),
        (lambda: shapes.box(1, math.nan), "height must be positive and finite, got nan"),
        (lambda: shapes.ring(2, 1), "inner must be smaller than outer, got inner=2.0, outer=1.0"),
        (lambda: shapes.capsule(-1, 1), "length must be positive and finite, got -1"),
        (lambda: shapes.rounded_polygon(L_SHAPE, 0.6), "edge 1 of length 1 needs 1.2 for its two corners"),
        (lambda: shapes.rounded_polygon([(0, 0), (1, 0)], 0.1), "at least 3 distinct points"),
    ],
)
def test_bad_parameters_are_named(make, message):
    with pytest.raises(ValueError, match=message):
        make()


@pytest.mark.parametrize("tolerance", [1e-1, 1e-3, 1e-5])
def test_sampled_curves_obey_the_tolerance_with_few_points(tolerance):
    def ellipse(t):
        return np.column_stack((5 * np.cos(t), np.sin(t)))

    points = sample_curve(ellipse, 0.0, math.pi, tolerance)
    fine = ellipse(np.linspace(0, math.pi, 20001))
    assert np.abs((points / (5, 1)) ** 2 @ (1, 1) - 1).max() < 1e-12
    assert shapely.LineString(points).hausdorff_distance(shapely.LineString(fine)) <= tolerance * (1 + 1e-3)
    # chords of equal sagitta number ∫ sqrt(κ/8τ) ds; κ ds³ = ab dt³ along an ellipse, v the speed ds/dt
    t = (np.arange(2000) + 0.5) * math.pi / 2000
    speed = np.hypot(5 * np.sin(t), np.cos(t))
    ideal = np.mean(np.sqrt(5 / (8 * tolerance * speed))) * math.pi
    assert len(points) - 1 <= 1.1 * ideal + 2


@pytest.mark.parametrize("tolerance", [1e-1, 1e-3, 1e-5])
@pytest.mark.parametrize("curve", [lambda t: np.tanh(20 * t), lambda t: 50 * t**2, lambda t: t**3])
def test_sampled_curves_obey_the_tolerance_where_curvature_changes_fast(curve, tolerance):
    points = sample_curve(lambda t: np.column_stack((t, curve(t))), -1.0, 1.0, tolerance)
    t = np.linspace(-1, 1, 20001)
    fine = np.column_stack((t, curve(t)))
    away = shapely.distance(shapely.points(fine), shapely.LineString(points))
    assert away.max() <= tolerance * (1 + 1e-3)


def test_spacing_bounds_the_chords():
    def line(t):
        return np.column_stack((t, 2 * t))

    points = sample_curve(line, 0.0, 1.0, 1e-3, spacing=0.3)
    assert len(points) - 1 == math.ceil(math.sqrt(5) / 0.3)
    assert len(sample_curve(line, 0.0, 1.0, 1e-3)) == 2
