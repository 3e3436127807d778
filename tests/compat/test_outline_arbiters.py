"""What callbacks are told of outlines: where they overlap, and nothing where only their proxies do.

Against `rigidarea.overlap` at the places at which the bodies are when a frame begins, and its regions' polygons.
"""

from __future__ import annotations

import itertools
import math
import random

import numpy as np
import pymunk
import pytest
import shapely

import rigidarea as ra

DT = 1 / 60


def outlines() -> dict[str, ra.Outline]:
    angle = np.linspace(0, 2 * math.pi, 15)[:-1]
    star = np.column_stack((np.cos(angle), np.sin(angle))) * np.where(np.arange(14) % 2, 18, 40)[:, None]
    return {
        "hook": ra.Outline([(0, 0), (60, 0), (60, 50), (45, 50), (45, 15), (15, 15), (15, 50), (0, 50)]),
        "star": ra.Outline(star),
        "frame": ra.Outline(
            [(-40, -30), (40, -30), (40, 30), (-40, 30)], [[(-30, -20), (-30, 20), (30, 20), (30, -20)]]
        ),
        "bent": ra.Outline.from_bulges([(-30, -20, 0), (30, -20, 0.7), (30, 25, -0.6), (-30, 25, 0.3)]),
        "gear": ra.shapes.involute_gear(module=3, teeth=19),
        "valley": ra.Outline([(-60, -20), (60, -20), (60, 40), (0, -5), (-60, 40)]),
    }


OUTLINES = outlines()
PLAIN = ("box", "disc", "capsule", "line")


def put(name: str, body: pymunk.Body) -> pymunk.Shape:
    if name in OUTLINES:
        return OUTLINES[name].add_to(body)
    if name == "box":
        return pymunk.Poly.create_box(body, (24, 18))
    if name == "disc":
        return pymunk.Circle(body, 11, (3, 1))
    return pymunk.Segment(body, (-30, -4), (25, 6), 4 if name == "capsule" else 0)


def place(body: pymunk.Body) -> tuple[float, float, float]:
    return (*body.position, body.angle)


def _way(start: pymunk.Vec2d, end: pymunk.Vec2d, middle: pymunk.Vec2d, far: shapely.Polygon) -> pymunk.Vec2d:
    """From a line to what is on one side of it: its middle, or past an end what is nearest to that."""
    along = (end - start).normalized()
    if 0 <= (middle - start).dot(along) <= (end - start).length:
        return middle - start
    tip = start if (middle - start).dot(along) < 0 else end
    box = shapely.minimum_rotated_rectangle(far).exterior
    slack = 0.1 * min(math.dist(*pair) for pair in itertools.pairwise(box.coords[:3]))
    if shapely.distance(shapely.MultiPoint(shapely.get_coordinates(far)), shapely.Point(tip)) <= slack:
        return middle - start  # at a corner what a solve has left may show any side
    near = pymunk.Vec2d(*shapely.shortest_line(far.boundary, shapely.Point(tip)).coords[0])
    way = (tip - near if far.contains(shapely.Point(tip)) else near - tip).normalized()
    return way if abs(along.cross(way)) > math.sqrt(0.02) else middle - start


def true_regions(a: pymunk.Shape, b: pymunk.Shape) -> np.ndarray:
    """All, the largest first; of a line the side away from the other is solid: from its middle, or past the line's ends
    from what is nearest to the end."""
    found = []
    one, other = (ra.Outline.from_pymunk(shape) for shape in (a, b))
    sides = []
    for own, shape, far, partner in ((one, a, other, b), (other, b, one, a)):
        if own.mirror is None:
            sides.append(own)
            continue
        end, start = (shape.body.local_to_world(p.tolist()) for p in own.rings[0][:2])
        lower, upper = np.reshape(far.bounds, (2, 2))
        middle = partner.body.local_to_world(tuple((lower + upper) / 2))
        rings = [far.polygon.exterior, *far.polygon.interiors]
        there, *holes = ([partner.body.local_to_world(p) for p in ring.coords] for ring in rings)
        way = _way(start, end, middle, shapely.Polygon(there, holes))
        # the outline is on the right of start -> end, the mirror on its left
        sides.append(own if (end - start).cross(way) > 0 else own.mirror)
    found = ra.overlap(sides[0], place(a.body), sides[1], place(b.body))
    return found[np.argsort(-found["area"])]


def thrown_together(seed: int) -> tuple[pymunk.Space, pymunk.Shape, pymunk.Shape]:
    """Two shapes about as near as their sizes, one of them an outline, at rest."""
    draw = random.Random(seed)
    names = [draw.choice(list(OUTLINES)), draw.choice([*OUTLINES, *PLAIN])]
    draw.shuffle(names)
    space = pymunk.Space()
    bodies = [pymunk.Body(1, 100), pymunk.Body(2, 300) if seed % 3 else space.static_body]
    for body in bodies:
        body.position = draw.uniform(-35, 35), draw.uniform(-35, 35)
        body.angle = draw.uniform(-4, 4)
    shapes = [put(name, body) for name, body in zip(names, bodies)]
    if seed % 2:
        shapes.reverse()
    for shape in shapes:
        shape.collision_type = draw.choice((1, 2))
        shape.sensor = seed % 7 == 0
    space.add(*(body for body in bodies if body is not space.static_body), *shapes)
    ra.attach(space)
    return space, *shapes


@pytest.mark.shown
def test_normals_and_points_of_a_thousand_pairs(record_property):
    """In begin and pre_solve, to 1e-9; no call where the outlines are apart; is it both often enough?"""
    touching = apart = two = 0
    for seed in range(1000):
        space, a, b = thrown_together(seed)
        heard: list[tuple] = []

        def hear(arbiter, space, data, heard=heard):
            points = arbiter.contact_point_set
            heard.append((arbiter.shapes, arbiter.normal, points, arbiter.is_first_contact))

        key = (None, None) if seed % 5 == 0 else (a.collision_type, b.collision_type)
        if seed % 5 == 1:
            key = (a.collision_type, None)
        space.on_collision(*key, begin=hear, pre_solve=hear)
        wanted = true_regions(a, b)
        space.step(DT)
        if len(wanted) == 0:
            assert heard == [], seed
            apart += 1
            continue
        touching += 1
        two += len(wanted) >= 2
        calls = 4 if key == (a.collision_type, None) and a.collision_type == b.collision_type else 2
        assert len(heard) == calls, seed
        for shapes, normal, points, first in heard:
            assert first and set(shapes) == {a, b}
            sign = 1 if shapes[0] is a else -1
            assert points.normal == normal and len(points.points) == min(2, len(wanted))
            left = list(range(len(wanted)))
            for k, point in enumerate(points.points):
                # which of regions of the same area comes first is nobody's
                r = next(r for r in left if shows(point, wanted[r], sign, curved(a, b)))
                left.remove(r)
                assert wanted["area"][r] == pytest.approx(wanted["area"][k], rel=1e-9), seed
                if k == 0:
                    off = np.abs(np.array(normal) - sign * wanted["direction"][r]).max()
                    record_property("callback_normal", float(off))
                    assert normal == pytest.approx(sign * wanted["direction"][r], abs=1e-9), seed
                way = np.array(point.point_b) - np.array(point.point_a)
                assert point.distance == pytest.approx(way @ np.array(normal), abs=1e-9)
    record_property("count_callback_touching", touching)
    record_property("count_callback_apart", apart)
    assert touching > 300 and apart > 150 and two > 40, (touching, apart, two)


def shows(point: pymunk.ContactPoint, region: np.void, sign: int, curved: bool) -> bool:
    """Whether a point is the region's: its ends are the region's extremes along its direction, through its centroid."""
    n = sign * region["direction"]
    along = np.asarray(region["polygon"]) @ n
    at = region["centroid"] - n * (region["centroid"] @ n)
    # (chords of sagitta 5e-5 of the area's root stand for arcs in the polygon)
    tolerance = 1e-3 * math.sqrt(region["area"]) if curved else 1e-9
    return bool(
        np.allclose(point.point_a, at + n * along.max(), rtol=0, atol=tolerance)
        and np.allclose(point.point_b, at + n * along.min(), rtol=0, atol=tolerance)
    )


def curved(*shapes: pymunk.Shape) -> bool:
    """Whether arcs are among their edges: of a region's polygon those are chords."""
    return any(ra.Outline.from_pymunk(shape).arcs for shape in shapes)


def test_begin_and_separate_are_those_of_the_outlines():
    """A ball through a hoop of straight bars: into it, out of it, never a call; then against a bar: one of each."""
    for height, calls in ((0.0, []), (34.0, ["begin", "separate"])):
        space = pymunk.Space()
        hoop = ra.Outline(
            [(-50, -50), (50, -50), (50, -40), (-40, -40), (-40, 40), (50, 40), (50, 50), (-50, 50)]
        )
        own = hoop.add_to(space.static_body, collision_type=1, elasticity=1)
        body = pymunk.Body(1, 10)
        body.position, body.velocity = (120, height), (-200, 0)
        ball = pymunk.Circle(body, 8)
        ball.collision_type, ball.elasticity = 2, 1
        space.add(own, body, ball)
        ra.attach(space)
        heard: list[str] = []

        def hear(what, heard=heard):
            return lambda *_: heard.append(what)

        space.on_collision(1, 2, begin=hear("begin"), separate=hear("separate"))
        touched = False
        for _ in range(35):  # as far as x = 3: within the hoop, and back at no bar yet
            space.step(DT)
            assert not touched or "begin" in heard
            touched = len(ra.overlap(hoop, (0, 0, 0), ra.Outline.circle(8), place(body))) > 0
        assert heard == calls, height


def test_a_box_in_a_valley_stands_on_both_slopes():
    space = pymunk.Space()
    space.gravity = 0, -900
    valley = OUTLINES["valley"].add_to(space.static_body, collision_type=1, friction=1)
    body = pymunk.Body(1, pymunk.moment_for_box(1, (20, 20)))
    body.position = 0, 30
    box = pymunk.Poly.create_box(body, (20, 20))
    box.collision_type, box.friction = 2, 1  # smooth it only balances
    space.add(valley, body, box)
    ra.attach(space)
    heard = []
    space.on_collision(2, 1, pre_solve=lambda arbiter, *_: heard.append(arbiter.contact_point_set))
    for _ in range(120):
        space.step(DT)
    last = heard[-1]
    assert len(last.points) == 2
    slope = math.atan2(45, 60)
    assert abs(last.normal.x) == pytest.approx(math.sin(slope), abs=0.02) and last.normal.y < 0
    for point in last.points:  # on the slopes' lines, y = -5 + 0.75 |x|, and one on either side
        assert point.point_b.y == pytest.approx(-5 + 0.75 * abs(point.point_b.x), abs=0.05)
    assert last.points[0].point_b.x * last.points[1].point_b.x < 0


def test_what_a_callback_sets_is_what_counts():
    """A normal that a callback turns steers the force; a verdict of no lets it through."""
    for turn, process in ((0.4, True), (0.0, False)):
        space = pymunk.Space()
        space.gravity = 0, -900
        floor = ra.Outline([(-200, -20), (200, -20), (200, 0), (20, 0), (0, -10), (-20, 0), (-200, 0)])
        floor_shape = floor.add_to(space.static_body, collision_type=1)
        body = pymunk.Body(1, 1e9)
        body.position = 100, 9.99
        box = pymunk.Poly.create_box(body, (20, 20))
        box.collision_type = 2
        space.add(floor_shape, body, box)
        ra.attach(space)

        def change(arbiter, space, data, turn=turn, process=process):
            points = arbiter.contact_point_set
            if turn:
                points.normal = points.normal.rotated(turn)
                arbiter.contact_point_set = points
            arbiter.process_collision = process

        space.on_collision(2, 1, pre_solve=change)
        for _ in range(12):
            space.step(DT)
        if process:
            assert abs(body.velocity.x) > 20  # pushed along, as on a slope
        else:
            assert body.position.y < 9


def test_copies_and_detaching_leave_pymunks_handlers_as_they_were():
    space, *_ = thrown_together(1)
    space.on_collision(begin=lambda *_: None, pre_solve=lambda *_: None)
    handler = space._handlers[None, None]._handler
    before = handler.beginFunc
    space.step(DT)
    assert handler.beginFunc == before
    other = space.copy()
    other.step(DT)
    ra.attached(space).detach()
    space.step(DT)
    assert all(math.isfinite(body.position.x) for body in space.bodies)
