"""Queries that see outlines, against shapely on finely sampled boundaries; a hollow U is hollow."""

import math
import random

import numpy as np
import pymunk
import pytest
import shapely

import rigidarea as ra

BENT = [(-30, -20, 0), (30, -20, 0.7), (30, 25, -0.6), (-30, 25, 0.3)]
OUTLINES = {
    "hook": ra.Outline([(0, 0), (60, 0), (60, 50), (45, 50), (45, 15), (15, 15), (15, 50), (0, 50)]),
    "frame": ra.Outline(
        [(-40, -30), (40, -30), (40, 30), (-40, 30)], [[(-30, -20), (-30, 20), (30, 20), (30, -20)]]
    ),
    "bent": ra.Outline.from_bulges(BENT),
    "gear": ra.shapes.involute_gear(module=3, teeth=19),
    "disc": ra.Outline.circle(33, (4, 2)),
}


def scene(name, seed):
    draw = random.Random(seed)
    space, outline = pymunk.Space(), OUTLINES[name]
    body = outline.body(mass=1)
    body.position, body.angle = (draw.uniform(-9, 9), draw.uniform(-9, 9)), draw.uniform(-4, 4)
    shape = outline.add_to(body)
    space.add(body, shape)
    c, s = body.rotation_vector
    rings = [
        r @ np.array([[c, s], [-s, c]]) + tuple(body.position)
        for r in (outline.sample(1e-4) if outline.arcs else outline).rings
    ]
    return space, shape, shapely.Polygon(rings[0], rings[1:]), draw


@pytest.mark.parametrize("name", OUTLINES)
def test_points(name):
    seen = {True: 0, False: 0}
    for seed in range(300):
        space, shape, polygon, draw = scene(name, seed)
        point = draw.uniform(-50, 50), draw.uniform(-50, 50)
        if polygon.boundary.distance(shapely.Point(point)) > 1e-3:
            inside = polygon.contains(shapely.Point(point))
            assert ra.point_query(space, point) == ([shape] if inside else [])
            seen[inside] += 1
    assert min(seen.values()) > 40


@pytest.mark.parametrize("name", OUTLINES)
def test_rays(name):
    hits = misses = 0
    for seed in range(300):
        space, shape, polygon, draw = scene(name, seed)
        ends = [(draw.uniform(-90, 90), draw.uniform(-90, 90)) for _ in range(2)]
        start, end = ends
        found = ra.segment_query(space, start, end)
        common = polygon.intersection(shapely.LineString(ends))
        if common.is_empty:
            assert found == []
            misses += 1
            continue
        (hit,) = found
        hits += 1
        assert hit.shape is shape and hit.normal.length == pytest.approx(1)
        if polygon.contains(shapely.Point(start)):
            assert hit.alpha == 0 and hit.point == pytest.approx(start)
            continue
        nearest = shapely.get_coordinates(common)
        nearest = nearest[np.argmin(np.hypot(*(nearest - start).T))]
        way = np.subtract(end, start)
        slope = abs(hit.normal.dot(tuple(way / np.hypot(*way))))
        assert hit.point == pytest.approx(nearest, abs=2e-4 / max(slope, 1e-2))
        assert hit.point == pytest.approx(np.array(start) + hit.alpha * way, abs=1e-9)
        out = shapely.Point(np.array(hit.point) + 1e-2 * np.array(hit.normal))
        assert hit.normal.dot(tuple(way)) <= 0 and not polygon.contains(out)
    assert hits > 60 and misses > 60


CORNERED = {
    "disc": ra.Outline.circle(10),
    "ring": ra.shapes.ring(5, 10),
    "bulges": ra.Outline.from_bulges([(-10, 0, 1), (10, 0, 1)]),
    "annulus": ra.Outline.from_bulges([(-9, 0, 1), (9, 0, 1)], [[(-4, 0, 1), (4, 0, 1)]]),
    "capsule": ra.Outline.from_pymunk(pymunk.Segment(None, (-8, 0), (8, 0), 3)),
    "box": ra.Outline([(-10, -10), (10, -10), (10, 10), (-10, 10)]),
}
"""All of their corners are seen from the middle."""


@pytest.mark.parametrize("name", CORNERED)
def test_rays_through_corners(name):
    """Through a point where edges or arcs meet, from outside and onto the solid: it is hit there.

    What pymunk's own query of the proxies misses is not asked (rays through corners of its polygons).
    """
    outline, asked = CORNERED[name], 0
    for seed in range(60):
        draw, space = random.Random(seed), pymunk.Space()
        body = outline.body(mass=1)
        body.position = draw.choice([(0, 0), (100, 50), (3.7, -81.3)])
        body.angle = draw.choice([0, 0.1 * seed])
        shape = outline.add_to(body)
        space.add(body, shape)
        space.step(1e-9)
        for corner in draw.sample(outline.rings[0].tolist(), min(4, len(outline.rings[0]))):
            start, end = (body.local_to_world(tuple(k * np.array(corner))) for k in (3, -3))
            seen = space.segment_query(start, end, 0, pymunk.ShapeFilter())
            if not seen:
                continue
            asked += 1
            (hit,) = ra.segment_query(space, start, end)
            # rounding of coordinates of a hundred
            assert hit.point == pytest.approx(body.local_to_world(tuple(corner)), abs=1e-10)
            assert hit.normal.dot(end - start) < 0 and type(hit.alpha) is type(hit.point.x) is float
    assert asked > 50


def test_filters_and_what_has_no_outline_are_pymunks():
    space, shape, _, _ = scene("hook", 1)
    other = pymunk.Circle(space.static_body, 500)
    shape.filter = pymunk.ShapeFilter(categories=2)
    space.add(other)
    only = pymunk.ShapeFilter(mask=1)
    assert ra.point_query(space, (0, 0), only) == [other]
    assert [hit.shape for hit in ra.segment_query(space, (-900, 0), (900, 0), only)] == [other]
    assert ra.segment_query(space, (-900, 0), (900, 0))[0].shape is other
    with pytest.raises(ValueError, match="point must be"):
        ra.point_query(space, (math.nan, 0))
