"""Internal gears, eccentrics, flat followers: against the external gear's teeth, conjugate action, and their errors."""

import pickle

import numpy as np
import pytest
import shapely
from shapely import affinity

from rigidarea.shapes import eccentric, flat_follower, internal_gear, involute_gear
from rigidarea.shapes.curve import sample_curve


def test_spaces_are_the_external_gears_teeth():
    """At radii on the involute a space is as wide as a tooth of the external gear of equal numbers."""
    ring, gear = internal_gear(2.0, 60, tolerance=1e-6), involute_gear(2.0, 60, tolerance=1e-6)
    hole, tooth = shapely.Polygon(ring.rings[1]), shapely.Polygon(gear.rings[0])
    for radius in (58.5, 60.0, 61.5):
        t = np.linspace(-np.pi / 60, np.pi / 60, 2001)
        at = shapely.points(radius * np.cos(t), radius * np.sin(t))
        space, solid = shapely.contains(hole, at).sum(), shapely.contains(tooth, at).sum()
        assert abs(space - solid) <= 2  # samples on the flank
    assert np.hypot(*ring.rings[1].T).min() == pytest.approx(58.0, rel=1e-12)
    assert np.hypot(*ring.rings[1].T).max() == pytest.approx(62.5, rel=1e-12)
    assert np.hypot(*ring.rings[0].T).max() == pytest.approx(
        67.5, abs=1e-6
    )  # polygons about circles keep the area


def test_pinion_turns_in_the_ring_without_overlap():
    """Conjugate action: at the nominal distance and ratio the pair touches and never overlaps, whatever the angle."""
    m, z, ring_teeth = 2.0, 20, 60
    pinion = shapely.Polygon(involute_gear(m, z, tolerance=1e-5, rack_tip_radius=0.1).rings[0])
    outline = internal_gear(m, ring_teeth, tolerance=1e-5)
    ring = shapely.Polygon(outline.rings[0], outline.rings[1:])
    for phi in np.linspace(0, 2 * np.pi / z, 7):
        a = affinity.rotate(pinion, phi, (0, 0), use_radians=True)
        b = affinity.translate(
            affinity.rotate(ring, phi * z / ring_teeth, (0, 0), use_radians=True), m * (z - ring_teeth) / 2
        )
        # chords of the concave flank stand out of the curve by the tolerance, along flanks of 2.25 modules, few pairs
        assert a.intersection(b).area < 10 * 2 * 1e-5 * 2.25 * m
        assert a.distance(b) < 2e-5  # no backlash: it touches
    loose = internal_gear(m, ring_teeth, tolerance=1e-5, backlash=0.1)
    assert loose.area < outline.area


def test_eccentric_lifts_a_flat_by_its_eccentricity():
    cam, lever = eccentric(0.03, 0.008, 0.005, tolerance=1e-7), flat_follower(0.12, 0.012, 0.003)
    assert cam.centroid[0] == pytest.approx(0.008 * 0.03**2 / (0.03**2 - 0.005**2), rel=1e-4)
    for angle in np.linspace(0, 6, 5):
        c, s = np.cos(angle), np.sin(angle)
        top = (cam.rings[0] @ np.array([[c, s], [-s, c]]))[:, 1].max()
        assert top == pytest.approx(0.03 + 0.008 * s, abs=2e-7)
    assert lever.bounds == pytest.approx((-0.012, -0.006, 0.12, 0.006))
    for outline in (cam, lever, internal_gear(2.0, 40)):
        again = pickle.loads(pickle.dumps(outline)).sample(1e-6)
        assert again.area == pytest.approx(outline.area, rel=1e-3)


@pytest.mark.parametrize(
    ("make", "text"),
    [
        (lambda: internal_gear(2.0, 2), "teeth must be a whole number from 3 to 10000"),
        (lambda: internal_gear(-1.0, 40), "module"),
        (lambda: internal_gear(2.0, 15), "outside the base circle"),
        (lambda: internal_gear(2.0, 60, dedendum=4.0), "wider than 0 at the bottom"),
        (lambda: internal_gear(2.0, 60, backlash=3.0), "thicker than 0 at the tip"),
        (lambda: eccentric(1.0, 0.9, 0.2), "eccentricity must lie"),
        (lambda: flat_follower(1.0, 0.1, 0.06), "bore must lie"),
    ],
)
def test_bad_shapes(make, text):
    with pytest.raises(ValueError, match=text):
        make()


@pytest.mark.parametrize("tolerance", [1e-14, 1e-300])
def test_a_tolerance_below_rounding_is_refused(tolerance):
    """Chords of which no number can be seen to obey; a curve that stands still has none to fail."""
    with pytest.raises(ValueError, match="above the points' rounding"):
        internal_gear(1.0, 40, tolerance=tolerance)
    still = sample_curve(lambda t: np.ones((len(t), 2)), 0.0, 1.0, 1e-3)
    assert len(still) == 2
