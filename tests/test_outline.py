"""Outlines against shapely, pymunk and closed forms."""

import copy
import math
import pickle
import random
from itertools import pairwise

import numpy as np
import pymunk
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from rigidarea.geometry.arcs import arc_points, circle_points
from rigidarea.geometry.outline import SEGMENT_THICKNESS, Outline

SQUARE = [(0, 0), (4, 0), (4, 4), (0, 4)]
ROUNDING = 1e-13  # relative; some hundred operations on numbers of the outline's size


def square(x, y, side=1.0):
    return [(x, y), (x + side, y), (x + side, y + side), (x, y + side)]


@st.composite
def star_shaped(draw):
    """A concave ring around the origin, radii 1 … 2, and a similar hole of radii 0.1 … 0.5; any sense."""
    seed, n, m = draw(st.integers(0, 2**32 - 1)), draw(st.integers(3, 40)), draw(st.integers(3, 12))
    rng = np.random.default_rng(seed)
    rings = []
    for count, low, high in ((n, 1.0, 2.0), (m, 0.1, 0.5)):
        angle = 2 * math.pi * (np.arange(count) + rng.uniform(0.05, 0.95, count)) / count
        radius = rng.uniform(low, high, count)
        ring = radius[:, None] * np.column_stack((np.cos(angle), np.sin(angle)))
        rings.append(ring[:: rng.choice((-1, 1))])
    # a ring of few points may leave the origin outside, and the hole with it
    return (
        rings if shapely.Polygon(rings[0]).contains_properly(shapely.Polygon(rings[1])) else (rings[0], None)
    )


# --- mass properties ---


@settings(max_examples=200, deadline=None)
@given(star_shaped(), st.floats(-100, 100), st.floats(-100, 100))
def test_area_and_centroid_agree_with_shapely(rings, dx, dy):
    points, hole = rings[0] + (dx, dy), None if rings[1] is None else rings[1] + (dx, dy)
    outline = Outline(points, [] if hole is None else [hole])
    oracle = shapely.Polygon(points, None if hole is None else [hole])
    # shapely sums relative to the first point, too; what is left is the rounding of coordinates up to 100
    assert outline.area == pytest.approx(oracle.area, rel=1e-12)
    assert outline.centroid == pytest.approx((oracle.centroid.x, oracle.centroid.y), abs=1e-11)
    assert outline.bounds == oracle.bounds
    assert outline.polygon.equals(oracle)


@settings(max_examples=100, deadline=None)
@given(star_shaped(), st.floats(0.1, 10), st.floats(-3, 3), st.floats(-3, 3))
def test_moment_agrees_with_pymunk(rings, mass, dx, dy):
    points, hole = rings
    outer = Outline(points)
    expected = pymunk.moment_for_poly(mass, outer.rings[0].tolist(), (dx, dy))
    assert outer.moment(mass, (dx, dy)) == pytest.approx(expected, rel=1e-12)
    if hole is not None:  # moments of areas subtract
        whole, inner = Outline(points, [hole]), Outline(hole)
        expected = (outer.moment(outer.area, (dx, dy)) - inner.moment(inner.area, (dx, dy))) / whole.area
        assert whole.moment(mass, (dx, dy)) == pytest.approx(mass * expected, rel=1e-11)


@settings(max_examples=50, deadline=None)
@given(star_shaped(), st.integers(0, 39))
def test_either_sense_any_start_closed_or_not_is_the_same_outline(rings, start):
    points, hole = rings
    holes = [] if hole is None else [hole]
    outline = Outline(points, holes)
    rolled = np.roll(points, start, axis=0)[::-1]
    again = Outline(np.concatenate((rolled, rolled[:1])), [hole[::-1] for hole in holes])
    assert again.area == pytest.approx(outline.area, rel=ROUNDING)
    assert again.centroid == pytest.approx(outline.centroid, abs=ROUNDING)
    assert again.moment(1.0) == pytest.approx(outline.moment(1.0), rel=10 * ROUNDING)
    assert len(again.rings[0]) == len(points)
    for i, ring in enumerate(again.rings):
        assert shapely.LinearRing(ring).is_ccw == (i == 0)


def test_box_with_a_box_hole_exactly():
    outline = Outline(square(-1, -1, 2), [square(-0.5, -0.5, 1)])
    assert outline.area == 3
    assert outline.centroid == (0, 0)
    assert outline.moment(3.0) == pytest.approx((4 * 8 - 1 * 2) / 12, rel=ROUNDING)  # m (a² + b²)/12


def test_mass_properties_keep_their_digits_far_away():
    rng = np.random.default_rng(4)
    angle = np.sort(rng.uniform(0, 2 * math.pi, 50))
    points = rng.uniform(1, 2, 50)[:, None] * np.column_stack((np.cos(angle), np.sin(angle)))
    points = np.round(points * 2**20) / 2**20  # exact also at 1e6
    near, far = Outline(points), Outline(points + 1e6)
    assert far.area == pytest.approx(near.area, rel=1e-12)
    # a centroid at 1e6 is a double there: half an ulp is 6e-11
    assert np.subtract(far.centroid, 1e6) == pytest.approx(near.centroid, abs=1.2e-10)
    central = [outline.moment(1.0, (-outline.centroid[0], -outline.centroid[1])) for outline in (near, far)]
    assert central[1] == pytest.approx(central[0], rel=1e-9)


@pytest.mark.parametrize(
    ("points", "convex"),
    [
        (SQUARE, True),
        ([(0, 0), (1, 0), (2, 0), (2, 2), (0, 2), (0, 1)], True),
        ([(0, 0), (0.1, 0.03), (0.2, 0.06), (0.7, 0.21), (0, 1)], True),  # collinear but for rounding
        ([(0, 0), (2, 0), (1, 0.5), (1, 2)], False),
        ([(0, 0), (1, 1e-9), (2, 0), (1, 2)], False),
    ],
)
def test_convex(points, convex):
    assert Outline(points).convex is convex


@pytest.mark.parametrize("angle", np.linspace(0, 3, 30))
def test_collinear_points_stay_convex_under_rounding(angle):
    points = [(0, 0), (1, 0), (2, 0), (3, 0), (3, 0.5), (3, 1), (2, 1), (1.7, 1), (0, 1)]
    assert Outline(points).rotated(angle).translated(5, -7).convex


def test_a_hole_is_not_convex():
    assert not Outline(SQUARE, [square(1, 1)]).convex


# --- arcs ---


@settings(max_examples=200, deadline=None)
@given(
    st.floats(0.01, 100),
    st.floats(-10, 10),
    st.floats(0.01, 6.28),
    st.sampled_from((-1, 1)),
    st.floats(1e-6, 0.1),
)
def test_arc_keeps_its_ends_its_area_and_the_tolerance(radius, start, sweep, sense, relative):
    tolerance = relative * radius
    points = arc_points((3, -2), radius, start, sense * sweep, tolerance) - (3, -2)
    for angle, end in ((start, points[0]), (start + sense * sweep, points[-1])):
        assert end == pytest.approx(
            (radius * math.cos(angle), radius * math.sin(angle)), abs=1e-13 * (radius + 3)
        )
    cross = points[:-1, 0] * points[1:, 1] - points[:-1, 1] * points[1:, 0]
    assert sense * cross.sum() / 2 == pytest.approx(radius**2 * sweep / 2, rel=1e-9)
    chord = points[1:] - points[:-1]
    nearest = np.abs(cross) / np.hypot(*chord.T)
    allowed = tolerance * (1 + relative + 1e-9)  # a vertex stands out by a sagitta at most, to leading order
    assert np.abs(np.hypot(*points.T) - radius).max() <= allowed
    assert np.abs(nearest - radius).max() <= allowed


def test_disc_has_the_circles_area_and_its_inertia_to_fourth_order():
    errors, counts = [], []
    for tolerance in (1e-1, 1e-2, 1e-3, 1e-4):
        disc = Outline(circle_points((0, 0), 1.0, tolerance))
        assert disc.area == pytest.approx(math.pi, rel=ROUNDING)
        counts.append(len(disc.rings[0]))
        errors.append(abs(disc.moment(1.0) - 0.5))
    order = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert order == pytest.approx(4, abs=0.1)


def test_sampling_goes_as_the_root_of_the_tolerance_and_can_be_repeated():
    disc = Outline.from_pymunk(pymunk.Circle(None, 2.0, (1, 0)), 1e-4)
    fine = disc.rotated(0.3).translated(5, 6).sample(1e-6)
    assert len(fine.rings[0]) == pytest.approx(10 * len(disc.rings[0]), rel=0.05)
    assert fine.centroid == pytest.approx((5 + math.cos(0.3), 6 + math.sin(0.3)), abs=1e-12)
    plain = Outline(SQUARE)
    assert plain.sample(1e-9) is plain
    with pytest.raises(ValueError, match="tolerance must be positive"):
        disc.sample(0)


# --- the gate ---


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ([(0, 0), (1, 0), (0, math.nan)], r"points must be finite, got \(0.0, nan\) at point 2"),
        ([(0, 0), (math.inf, 0), (0, 1)], r"points must be finite, got \(inf, 0.0\) at point 1"),
        ([(0, 0), (1e80, 0), (0, 1)], r"coordinates below 1e\+75, got 1e\+80"),
        ([(0, 0), (1, 0)], "at least 3 distinct points, got 2"),
        ([], r"shape \(n, 2\) with n >= 3, got shape \(0,\)"),
        (np.zeros((0, 2)), "at least 3 distinct points, got 0"),
        ([(0, 0), (1, 0), (1, 0), (0, 0)], r"at least 3 distinct points, got 2 \(of 4 given\)"),
        ([(0, 0), (1, 1), (3, 3)], "must enclose an area, got 0"),
        ([(0, 0), (0.1, 0.3), (0.7, 2.1), (0.2, 0.6)], "must enclose an area"),
        ([(0, 0), (2, 2), (2, 0), (0, 2)], r"cross or touch itself; it does at \(1, 1\)"),
        ([(0, 0), (4, 0), (4, 4), (3, -1)], "cross or touch itself"),
        ([(0, 0), (2, 0), (1, 0), (1, 1)], "cross or touch itself"),  # a spike
        ([1, 2, 3], r"shape \(n, 2\) with n >= 3, got shape \(3,\)"),
        (np.zeros((4, 3)), r"got shape \(4, 3\)"),
        ("outline", "must be numbers of shape"),
        ([(0, 0), (1,), (2, 2)], "must be numbers of shape"),
    ],
)
def test_bad_points_are_named(points, message):
    with pytest.raises(ValueError, match=message):
        Outline(points)


@pytest.mark.parametrize(
    ("holes", "message"),
    [
        ([square(5, 5)], r"holes\[0\] must lie inside the outer ring; \(5.5, 5.5\) of it is outside"),
        ([square(1, 1), square(3.5, 1)], r"holes\[1\] must lie inside"),
        ([square(1, 1), square(1.5, 1.5)], r"holes\[0\] and holes\[1\] must be apart"),
        ([square(1, 1), square(2, 1)], r"holes\[0\] and holes\[1\] must be apart"),  # along an edge
        ([square(1, 1, 2), square(1.5, 1.5)], r"holes\[0\] and holes\[1\] must be apart"),  # one in the other
        ([square(0, 1)], r"holes\[0\] must not share an edge with the outer ring"),
        ([SQUARE], r"holes\[0\] must not share an edge with the outer ring"),
        ([square(-1, -1, 9)], r"holes\[0\] must lie inside"),
        (
            [[(1, 1), (2, 2), (2, 1), (1, 2)]],
            r"holes\[0\] must not cross or touch itself; it does at \(1.5, 1.5\)",
        ),
        ([[(0, 2), (2, 0), (4, 2), (2, 4)]], "one connected region"),
        ([(1, 1), (2, 1), (2, 2)], r"holes\[0\] must have shape"),
    ],
)
def test_bad_holes_are_named(holes, message):
    with pytest.raises(ValueError, match=message):
        Outline(SQUARE, holes)


def test_what_is_harmless_is_mended_or_kept():
    mended = Outline([(0, 0), (0, 0), (0, 4), (4, 4), (4, 4), (4, 0), (0, 0)])
    assert len(mended.rings[0]) == 4
    assert mended.area == 16
    assert len(Outline([(0, 0), (1, 0), (2, 0), (2, 2)]).rings[0]) == 4  # a collinear point stays
    assert Outline(SQUARE, [[(0, 2), (1, 1), (1, 3)]]).area == 15  # a hole may touch in a point


@pytest.mark.parametrize("angle", [0, 0.3, 1.0])
def test_a_sliver_is_an_outline(angle):
    c, s = math.cos(angle), math.sin(angle)
    sliver = np.array([(0, 0), (1, 0), (1, 1e-10), (0, 1e-10)]) @ [[c, s], [-s, c]]
    assert Outline(sliver).area == pytest.approx(1e-10, rel=1e-5)  # its coordinates are rounded to 1e-16


def test_outlines_are_immutable_and_copies_share_them():
    outline = Outline(SQUARE, [square(1, 1)])
    given = np.array(SQUARE, dtype=float)
    kept = Outline(given)
    given[0] = 9
    assert kept.rings[0][0].tolist() == [0, 0]
    restored = pickle.loads(pickle.dumps(outline))
    for one in (outline, restored):
        with pytest.raises(ValueError, match="read-only"):
            one.rings[1][0, 0] = 1
    assert copy.deepcopy(outline) is outline
    assert restored.area == outline.area
    assert all(np.array_equal(a, b) for a, b in zip(restored.rings, outline.rings))


def test_from_shapely():
    polygon = shapely.box(0, 0, 3, 2).difference(shapely.box(1, 0.5, 2, 1))
    outline = Outline.from_shapely(polygon)
    assert len(outline.rings) == 2
    assert outline.polygon.equals(polygon)
    assert Outline.from_shapely(shapely.Polygon([(0, 0, 7), (1, 0, 7), (0, 1, 7)])).area == 0.5
    for wrong in (shapely.Point(0, 0), shapely.Polygon(), shapely.MultiPolygon([polygon]), [(0, 0)]):
        with pytest.raises(ValueError, match="one non-empty shapely Polygon"):
            Outline.from_shapely(wrong)
    with pytest.raises(ValueError, match="cross"):
        Outline.from_shapely(shapely.Polygon([(0, 0), (1, 1), (1, 0), (0, 1)]))


# --- pymunk's shapes ---


TRIANGLE = [(0, 0), (3, 0), (0, 3)]


@pytest.mark.parametrize(
    ("shape", "center"),
    [
        (pymunk.Circle(None, 0.5, (1, 2)), (1, 2)),
        (pymunk.Poly.create_box(None, (30, 20)), (0, 0)),
        (pymunk.Poly.create_box(None, (30, 20), radius=1.5), (0, 0)),
        (pymunk.Poly(None, TRIANGLE), (1, 1)),
        (pymunk.Poly(None, [*TRIANGLE, (0.5, 0.5)]), (1, 1)),  # pymunk takes the hull
        (pymunk.Poly(None, [(0, 0), (4, 0), (5, 2), (1, 2)], radius=0.3), (2.5, 1)),
        (pymunk.Poly(None, [(0, 0), (3, 0)], radius=0.3), (1.5, 0)),
        (pymunk.Segment(None, (0, 0), (5, 1), 0.2), (2.5, 0.5)),
    ],
)
def test_pymunk_shapes_have_their_area_and_place(shape, center):
    outline = Outline.from_pymunk(shape, tolerance=1e-3)
    # Chipmunk's area of a rounded shape is the exact one, and so is ours, whatever the sampling
    assert outline.area == pytest.approx(shape.area, rel=1e-12)
    assert outline.centroid == pytest.approx(center, abs=1e-12)
    # a point 2 tolerances outside or inside of it is outside or inside the shape
    shape.update(pymunk.Transform.identity())
    for grow, sign in ((2e-3, 1), (-2e-3, -1)):
        around = shapely.get_coordinates(outline.polygon.buffer(grow).exterior)
        for point in around[::5].tolist():
            assert sign * shape.point_query(point).distance > 0
    assert outline.convex
    assert Outline.from_pymunk(shape, tolerance=1e-3) is outline


def test_a_corner_of_a_billionth_of_a_degree_gets_no_arc():
    """Chipmunk's hull keeps it; three chords there would be of no length."""
    shape = pymunk.Poly(None, [(-1, 0), (0, -1e-11), (1, 0), (1, 2), (-1, 2)], radius=0.5)
    assert len(shape.get_vertices()) == 5
    ring = Outline.from_pymunk(shape).rings[0]
    assert np.hypot(*(np.roll(ring, -1, axis=0) - ring).T).min() > 0.01


def test_a_segment_without_length_is_a_disc():
    disc = Outline.from_pymunk(pymunk.Segment(None, (1, 1), (1, 1), 0.5))
    assert disc.area == pytest.approx(math.pi / 4, rel=ROUNDING)


@pytest.mark.parametrize(
    ("shape", "settings", "message"),
    [
        (pymunk.Circle(None, 0.0), {}, "radius of a pymunk shape must be positive and finite, got 0.0"),
        (pymunk.Circle(None, math.nan), {}, "got nan"),
        (pymunk.Circle(None, 1, (math.nan, 0)), {}, "must be finite"),
        (pymunk.Poly(None, [(0, 0), (1, 0), (2, 0)]), {}, "got 0.0"),
        (pymunk.Segment(None, (1, 1), (1, 1), 0), {}, "positive, finite length, got 0.0"),
        (pymunk.Circle(None, 1), {"tolerance": -1}, "tolerance must be positive and finite, got -1"),
        (
            pymunk.Segment(None, (0, 0), (1, 1), 0),
            {"thickness": 0},
            "thickness must be positive and finite, got 0",
        ),
        (pymunk.Segment(None, (0, 0), (1, 1), 0), {"side": "up"}, "'both', 'left' or 'right', got 'up'"),
        (SQUARE, {}, "expected a pymunk Circle, Poly or Segment, got list"),
    ],
)
def test_pymunk_shapes_without_a_solid_are_refused(shape, settings, message):
    with pytest.raises(ValueError, match=message):
        Outline.from_pymunk(shape, **settings)


def test_a_bare_segment_is_a_solid_behind_its_line_on_either_side():
    segment = pymunk.Segment(None, (1, 1), (4, 5), 0)  # length 5, left normal (-0.8, 0.6)
    right = Outline.from_pymunk(segment)
    left = right.mirror
    assert right.two_sided
    assert left.two_sided
    assert left.mirror is right
    for outline, sign in ((right, -1), (left, 1)):
        assert {tuple(p) for p in outline.rings[0][:2]} == {(1, 1), (4, 5)}  # edge 0 is the segment
        assert outline.area == pytest.approx(SEGMENT_THICKNESS * 25, rel=ROUNDING)
        beyond = np.subtract(outline.centroid, (1, 1)) @ (-0.8, 0.6)
        assert beyond == pytest.approx(sign * SEGMENT_THICKNESS * 5 / 2, rel=ROUNDING)
    restored = pickle.loads(pickle.dumps(right.translated(1, 0).rotated(0.1)))
    assert restored.mirror.mirror is restored
    assert restored.mirror.centroid == left.translated(1, 0).rotated(0.1).centroid
    stand_in = right.add_to(pymunk.Body())
    assert isinstance(stand_in, pymunk.Segment)
    assert (stand_in.a, stand_in.b, stand_in.radius) == ((1, 1), (4, 5), 0)


def test_a_one_sided_segment():
    floor = pymunk.Segment(None, (0, 0), (2, 0), 0)
    assert Outline.from_pymunk(floor, side="right", thickness=0.5).bounds == (0, -0.5, 2, 0)
    assert Outline.from_pymunk(floor, side="left", thickness=0.5).bounds == (0, 0, 2, 0.5)
    assert not Outline.from_pymunk(floor, side="left").two_sided


def test_neighbouring_segments_make_no_bump():
    """Behind a flat floor the solids tile; behind a hill none stands out of the ground."""
    path = [(-3, 0), (-1, 0), (0, 0), (2, -0.5), (4, -2.5), (5, -5)]
    solids = [
        Outline.from_pymunk(pymunk.Segment(None, a, b, 0), side="right").polygon for a, b in pairwise(path)
    ]
    assert solids[0].intersection(solids[1]).area == 0
    ground = shapely.Polygon([*path, (5, -50), (-50, -50), (-50, 0)])
    assert shapely.union_all(solids).difference(ground).area == pytest.approx(0, abs=1e-12)


# --- stand-ins ---


def star(n, inner):
    angle = math.pi * np.arange(2 * n) / n
    return np.where(np.arange(2 * n) % 2, inner, 1.0)[:, None] * np.column_stack(
        (np.cos(angle), np.sin(angle))
    )


@pytest.mark.parametrize(
    ("points", "kind"),
    [
        (square(1, 2), pymunk.Poly),
        ([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)], pymunk.Poly),  # an L: its hull
        (star(4, 0.5), pymunk.Poly),
        (star(30, 0.8), pymunk.Circle),
        (star(30, 0.8) * (5, 1) + (3, 3), pymunk.Poly),
        (star(30, 0.8) * (5, 1) @ [[0.92, 0.39], [-0.39, 0.92]], pymunk.Poly),  # aslant by 23°
    ],
)
def test_the_stand_in_contains_the_outline_and_weighs_nothing(points, kind):
    outline, body = Outline(points), pymunk.Body(2.0, 3.0)
    shape = outline.add_to(body, friction=0.4, elasticity=0.6, collision_type=5, sensor=True)
    assert type(shape) is kind
    assert shape.outline is outline
    assert shape.body is body
    assert (body.mass, body.moment, shape.mass) == (2.0, 3.0, 0.0)
    assert (shape.friction, shape.elasticity, shape.collision_type, shape.sensor) == (0.4, 0.6, 5, True)
    shape.cache_bb()  # else pymunk answers for where the shape was before
    for point in outline.rings[0].tolist():
        assert shape.point_query(point).distance <= 1e-12
    if kind is pymunk.Poly:
        assert len(shape.get_vertices()) <= 8
    # and is not much larger: an octagon around a disc is so by 5 %, around a flat ellipse by 17 %
    size = math.pi * shape.radius**2 if kind is pymunk.Circle else shapely.Polygon(shape.get_vertices()).area
    assert size <= 1.2 * outline.polygon.convex_hull.area


def test_chipmunk_finds_every_stand_in_that_overlaps_a_floor():
    """Of octagons with corners that rounding alone parts it missed one in thirty; against shapely's overlap."""
    draw = random.Random(6)
    bed = pymunk.Body(body_type=pymunk.Body.STATIC)  # held here: a shape does not keep its body alive
    floor = pymunk.Segment(bed, (-100, 0), (100, 0), 4)
    floor.cache_bb()
    ground = shapely.LineString([(-100, 0), (100, 0)]).buffer(4, quad_segs=500)
    for _ in range(60):
        r, body = draw.uniform(10, 25), pymunk.Body(1, 1)
        corners = [(-r, -r), (r, -r), (r, r), (-r, r)]
        shape = Outline.from_bulges([(x, y, draw.choice((0, 0.4))) for x, y in corners]).add_to(body)
        for _ in range(100 if isinstance(shape, pymunk.Poly) else 0):
            body.angle, body.position = draw.randrange(4) * math.pi / 2 + draw.gauss(0, 0.02), (0, 0)
            y = 4 - shape.cache_bb().bottom - draw.choice((0.05, 0.5, 4)) * draw.random()
            body.position = draw.uniform(0, 110), y
            shape.cache_bb()
            hull = shapely.Polygon([body.local_to_world(point) for point in shape.get_vertices()])
            if (
                hull.intersection(ground).area > 1e-3
            ):  # the ground's end has corners: less may be between them
                assert shape.shapes_collide(floor).points


@pytest.mark.parametrize("name", ["mass", "density", "colour"])
def test_other_attributes_are_refused_before_anything_is_made(name):
    body = pymunk.Body(1, 1)
    with pytest.raises(ValueError, match=rf"among friction.*got {name}"):
        Outline(SQUARE).add_to(body, **{name: 1})
    assert not body.shapes


@pytest.mark.parametrize(
    "duplicate", [lambda space: space.copy(), lambda space: pickle.loads(pickle.dumps(space))]
)
def test_outlines_survive_copying_and_pickling_a_space(duplicate):
    space, gear, disc = pymunk.Space(), Outline(star(30, 0.8)), Outline.from_pymunk(pymunk.Circle(None, 1))
    for outline in (gear, disc, disc):
        body = outline.body(mass=1)
        space.add(body, outline.add_to(body, friction=0.3))
    floor = pymunk.Segment(space.static_body, (-1, 0), (1, 0), 0)
    space.add(Outline.from_pymunk(floor).add_to(space.static_body))
    outlines = [shape.outline for shape in duplicate(space).shapes]
    assert len(outlines) == 4
    assert len({id(outline) for outline in outlines}) == 3  # shared ones stay shared
    assert sorted(outline.area for outline in outlines) == sorted(
        [gear.area, disc.area, disc.area, Outline.from_pymunk(floor).area]
    )
    assert any(outline.two_sided for outline in outlines)
    assert all(
        len(outline.sample(1e-5).rings[0]) > 100
        for outline in outlines
        if outline.convex and not outline.mirror
    )


def test_a_body_from_an_outline():
    outline = Outline([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)])
    body = outline.body(density=2.0)
    assert body.mass == 2 * outline.area
    assert body.center_of_gravity == pytest.approx(outline.centroid)
    assert body.moment == pytest.approx(
        outline.moment(body.mass, (-outline.centroid[0], -outline.centroid[1]))
    )
    assert outline.body(mass=7).mass == 7
    for wrong in ({}, {"mass": 1, "density": 1}, {"mass": -1}, {"density": math.nan}):
        with pytest.raises(ValueError, match=r"mass|density"):
            outline.body(**wrong)
    with pytest.raises(ValueError, match="mass must be finite and not negative, got -1"):
        outline.moment(-1)


def test_a_body_is_where_its_outline_was_drawn():
    """Before anybody sets its position: at the origin, its centre of gravity at the outline's centroid."""
    plate = Outline([(10, 20), (14, 20), (14, 23), (10, 23)])
    body = plate.body(mass=2)
    assert body.position == (0, 0)
    assert body.local_to_world(body.center_of_gravity) == pytest.approx(plate.centroid)
