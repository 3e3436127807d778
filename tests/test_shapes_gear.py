"""Involute gears against the analytic involute, a cutting rack (shapely) and each other."""

import math

import numpy as np
import pytest
import shapely
from shapely import affinity

from rigidarea.shapes import involute_gear

ALPHA = math.radians(20)
TOLERANCE = 1e-4  # of the gears here, in modules (module 1)


def inv(angle):
    return math.tan(angle) - angle


def placed(gear, x, angle):
    turned = affinity.rotate(gear.polygon, angle, origin=(0, 0), use_radians=True)
    return affinity.translate(turned, x, 0)


def meshed(first, second, z1, z2, angle):
    """Both gears at the standard distance, gear 2 centred in mesh."""
    return placed(first, 0, angle), placed(second, (z1 + z2) / 2, math.pi + math.pi / z2 - angle * z1 / z2)


# --- one gear ---


@pytest.mark.parametrize("shift", [0.0, 0.4])
@pytest.mark.parametrize("teeth", [8, 17, 23, 57, 150])
def test_tooth_thickness_at_any_radius(teeth, shift):
    """s(r) = 2 r (s_p/2r_p + inv α − inv α_r), measured on circles. At r_p it is π m/2."""
    backlash = 0.03
    gear = involute_gear(1, teeth, profile_shift=shift, backlash=backlash, tolerance=1e-6).polygon
    pitch_radius = teeth / 2
    thickness = math.pi / 2 + 2 * shift * math.tan(ALPHA) - backlash
    for radius in (pitch_radius, pitch_radius + 0.3, pitch_radius + 0.8 + shift):
        angle = np.linspace(-math.pi / teeth, math.pi / teeth, 40001)
        inside = shapely.contains_xy(gear, radius * np.cos(angle), radius * np.sin(angle))
        measured = radius * (angle[1] - angle[0]) * np.count_nonzero(inside)
        at_radius = math.acos(pitch_radius * math.cos(ALPHA) / radius)
        exact = radius * (thickness / pitch_radius + 2 * (inv(ALPHA) - inv(at_radius)))
        # two flanks' sagittas (aslant up to 40°), and a step of the measuring circle at either end
        step = radius * (angle[1] - angle[0])
        assert measured == pytest.approx(exact, abs=2 * 1e-6 / math.cos(0.7) + 2 * step)


@pytest.mark.parametrize("teeth", [6, 12, 23, 57])
def test_flanks_unwind_from_the_base_circle(teeth):
    """On the base circle's tangent at direction φ, the flank that starts at β lies r_b (φ − β) from the foot.

    So flanks of one side are a base pitch, π m cos α, apart on it, which is what makes them conjugate.
    """
    gear = involute_gear(1, teeth, tolerance=1e-7).polygon
    base = teeth / 2 * math.cos(ALPHA)
    start = -(math.pi / 2 / teeth + inv(ALPHA)) + 2 * math.pi / teeth * np.arange(-teeth, teeth)
    found = 0
    for direction in np.linspace(0, 2 * math.pi / teeth, 7):
        foot = base * np.array((math.cos(direction), math.sin(direction)))
        along = np.array((math.sin(direction), -math.cos(direction)))
        line = shapely.LineString((foot, foot + along * 2 * base))
        crossings = (shapely.get_coordinates(line.intersection(gear.boundary)) - foot) @ along
        exact = base * (direction - start)
        radius = np.hypot(base, exact)  # on flanks, clear of root fillets and undercut, and of tips
        exact = exact[(exact > 0) & (radius > teeth / 2 - 0.1) & (radius < teeth / 2 + 0.99)]
        for s in exact:
            assert np.abs(crossings - s).min() <= 1e-7 * (1 + 1e-6)
        found += len(exact)
    assert found >= 5


@pytest.mark.parametrize(
    ("teeth", "settings"),
    [
        (6, {}),
        (8, {}),
        (8, {"profile_shift": 0.5, "backlash": 0.05}),
        (14, {"rack_tip_radius": 0.0}),
        (23, {}),
        (40, {"profile_shift": -0.3, "pressure_angle": math.radians(25), "rack_tip_radius": 0.2}),
        (60, {"addendum": 0.8, "dedendum": 1.0}),
    ],
)
def test_the_space_is_what_a_rack_cuts(teeth, settings):
    """A rack is rolled over a blank and subtracted in a thousand positions: fillets, undercut and all."""
    alpha = settings.get("pressure_angle", ALPHA)
    shift, backlash = settings.get("profile_shift", 0.0), settings.get("backlash", 0.0)
    dedendum, addendum = settings.get("dedendum", 1.25), settings.get("addendum", 1.0)
    tip_radius = settings.get("rack_tip_radius", 0.38)
    gear = involute_gear(1, teeth, tolerance=TOLERANCE, **settings).polygon

    def half_width(height):
        return math.pi / 4 + backlash / 2 + height * math.tan(alpha)

    top = 3.0  # above the reference line: clear of the blank
    tooth = shapely.Polygon(
        [
            (-half_width(top), top),
            (-half_width(-dedendum), -dedendum),
            (half_width(-dedendum), -dedendum),
            (half_width(top), top),
        ]
    )
    if tip_radius:
        rounded = tooth.buffer(-tip_radius).buffer(tip_radius, quad_segs=200)
        tooth = shapely.union(rounded, shapely.intersection(tooth, shapely.box(-9, 1, 9, 9)))
    pitch_radius = teeth / 2
    cuts = []
    for rolled in np.linspace(-4.0, 4.0, 1001):  # the pitch line's travel; ± 1.25/sin α does it all
        rack = affinity.translate(tooth, rolled, pitch_radius + shift)
        cuts.append(affinity.rotate(rack, rolled / pitch_radius, origin=(0, 0), use_radians=True))
    blank = shapely.Point(0, 0).buffer(pitch_radius + addendum + shift, quad_segs=4000)
    half = math.pi / teeth
    reach = 2 * pitch_radius
    sector = shapely.Polygon(
        [
            (0, 0),
            (reach * math.sin(-half), reach * math.cos(half)),
            (reach * math.sin(half), reach * math.cos(half)),
        ]
    )
    left = blank.difference(shapely.union_all(cuts)).intersection(sector)
    # the gear's space, between tooth 0 and 1, turned to stand at 90°
    ours = affinity.rotate(gear, math.pi / 2 - half, origin=(0, 0), use_radians=True).intersection(sector)
    # between two positions 8e-3 apart a rounded tip leaves a cusp of 8e-3²/8R, a sharp one of half the step
    allowed = TOLERANCE * 1.5 if tip_radius else 4e-3
    assert ours.difference(left.buffer(allowed)).area == pytest.approx(0, abs=1e-9)
    assert left.difference(ours.buffer(allowed)).area == pytest.approx(0, abs=1e-9)


def test_area_is_that_of_the_polar_integral():
    """∫ over the radius of the teeth's angle, found point by point."""
    gear = involute_gear(2.0, 23, tolerance=1e-6)
    assert gear.polygon.is_valid
    radius = np.linspace(23 - 2.5, 25, 4001)
    angle = np.linspace(0, math.pi / 23, 2001)
    inside = shapely.contains_xy(
        gear.polygon, *(np.multiply.outer(t, radius) for t in (np.cos(angle), np.sin(angle)))
    )
    half = np.trapezoid(inside.astype(float), angle, axis=0)
    area = math.pi * 20.5**2 + 2 * 23 * np.trapezoid(half * radius, radius)
    assert gear.area == pytest.approx(area, rel=1e-4)  # of the grid
    assert gear.centroid == pytest.approx((0, 0), abs=1e-12)


def test_sampling_by_tolerance_and_by_spacing():
    sizes = [len(involute_gear(2.0, 23, tolerance=t).rings[0]) for t in (1e-2, 1e-4, 1e-6)]
    assert sizes[2] / sizes[1] == pytest.approx(10, rel=0.1)  # the root of the tolerance
    spaced = involute_gear(2.0, 23, spacing=0.6, tolerance=1.0, bore=5.0)
    for ring in spaced.rings:
        edge = np.hypot(*(np.roll(ring, -1, axis=0) - ring).T)
        assert edge.max() <= 0.6 * (1 + 1e-9)
        assert edge.mean() > 0.4
    assert len(spaced.rings[0]) == 506  # the paper's pinion has as many nodes


# --- pairs ---


@pytest.mark.parametrize(
    ("z1", "z2", "settings"),
    [
        (23, 57, {}),
        (17, 17, {}),
        (12, 30, {}),
        (20, 200, {}),
        (23, 57, {"pressure_angle": math.radians(25)}),
        (12, 40, {"profile_shift": 0.4}),
    ],
)
def test_pairs_touch_over_a_whole_pitch_and_never_overlap(z1, z2, settings):
    """Rolled together by the tooth ratio, conjugate flanks stay in touch: the involute's constant ratio."""
    shift = settings.pop("profile_shift", 0.0)
    first = involute_gear(1, z1, tolerance=TOLERANCE, profile_shift=shift, **settings)
    second = involute_gear(1, z2, tolerance=TOLERANCE, profile_shift=-shift, **settings)
    for angle in np.linspace(0, 2 * math.pi / z1, 25):
        a, b = meshed(first, second, z1, z2, angle)
        assert a.intersection(b).area < 1e-12  # chords lie inside the flanks
        assert a.distance(b) <= 2 * TOLERANCE  # a sagitta on either side


@pytest.mark.parametrize("pair", [(6, 6), (7, 40), (8, 8), (5, 100), (6, 200)])
def test_undercut_pairs_never_overlap(pair):
    """Few teeth are undercut and may lose contact for a while, but nothing of the mate runs into them."""
    z1, z2 = pair
    first, second = (involute_gear(1, z, tolerance=TOLERANCE) for z in pair)
    for angle in np.linspace(0, 2 * math.pi / z1, 41):
        a, b = meshed(first, second, z1, z2, angle)
        assert a.intersection(b).area < 1e-12


def test_the_gap_is_the_backlash_along_the_line_of_action():
    z1, z2, backlash = 23, 57, (0.02, 0.01)
    first, second = (involute_gear(1, z, tolerance=2e-5, backlash=b) for z, b in zip((z1, z2), backlash))
    total = sum(backlash)
    for angle in np.linspace(0, 2 * math.pi / z1, 5):
        a, b = meshed(first, second, z1, z2, angle)
        assert a.distance(b) == pytest.approx(total / 2 * math.cos(ALPHA), abs=4e-5)  # half on either flank
        for side in (-1, 1):  # turned by half the play, one flank touches
            play = side * total / 2 / (z2 / 2)
            turned = affinity.rotate(b, play, origin=((z1 + z2) / 2, 0), use_radians=True)
            assert a.distance(turned) < 4e-5
            assert a.intersection(turned).area < 1e-9


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"module": 0}, "module must be positive and finite, got 0"),
        ({"teeth": 2}, "teeth must be a whole number from 3 to 10000, got 2"),
        ({"teeth": 20.5}, "teeth must be a whole number from 3 to 10000, got 20.5"),
        ({"pressure_angle": 20}, "pressure_angle must lie between 0 and π/4 radians, got 20"),
        ({"addendum": 3.0}, "thicker than 0 at the tip, got -"),
        ({"teeth": 8, "profile_shift": 0.8}, "thicker than 0 at the tip, got -"),
        ({"profile_shift": 1.0}, "profile_shift must be below .* 0.87, got 1.0"),
        ({"dedendum": 3.0}, "dedendum must leave the rack's tip a width, got a half width of -"),
        ({"rack_tip_radius": 0.6}, r"rack_tip_radius must lie between 0 and 0.47\d* modules, got 0.6"),
        ({"backlash": -1}, "backlash must be finite and not negative, got -1"),
        ({"bore": 9.0}, "bore must be smaller than the root radius 8.75, got 9.0"),
        ({"profile_shift": math.nan}, "profile_shift must be a finite number, got nan"),
        ({"tolerance": 0}, "tolerance must be positive and finite, got 0"),
        ({"spacing": -1}, "spacing must be positive and finite, got -1"),
        ({"teeth": 3, "dedendum": 1.6, "rack_tip_radius": 0.0}, "root circle|too few|flank"),
    ],
)
def test_bad_parameters_are_named(settings, message):
    with pytest.raises(ValueError, match=message):
        involute_gear(**{"module": 1.0, "teeth": 20, **settings})


def test_a_rack_tip_rounded_all_over_leaves_no_land_at_the_root():
    """Fillets of neighbouring teeth meet in one point, not in two a rounding error apart: an edge without length has
    no direction, and a mesher would take it for a feature."""
    ring = involute_gear(2e-3, 23, addendum=1.2, dedendum=1.45, tolerance=1e-7).rings[0]
    edge = np.hypot(*(np.roll(ring, -1, 0) - ring).T)
    assert edge.min() > 1e-6  # of the spacing that the tolerance asks for, 1e-5 and more
