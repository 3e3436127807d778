"""What else is asked of a region with arcs and of outlines with arcs: straight stretches, the bed's energy, clearance,
the shortest way out, extents."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import shapely

import rigidarea as ra
from conftest import PURE_PYTHON, kernel_module
from rigidarea import shapes
from test_arcs import KINDS, SQUARE, TAU, placed


def loops_of(kernel: Any, a: ra.Outline, b: ra.Outline, pose: Any) -> tuple[Any, Any, Any]:
    """(pool, work, loops) of b at (x, y, angle) relative to a."""
    place, work = kernel.place, kernel_module("work").new_work(600)
    pool = kernel.pool.pack([a, b])
    there = place.Pose(float(pose[0]), float(pose[1]), math.cos(pose[2]), math.sin(pose[2]))
    n, rel = place.overlap_of_outlines(pool, 0, place.Pose(0.0, 0.0, 1.0, 0.0), 1, there, work)
    assert n >= 0
    return pool, work, (work.loops[:n], rel)


def test_straight_is_where_both_boundaries_are(kernel: Any) -> None:
    floor = ra.Outline([(-5, -1), (5, -1), (5, 0), (-5, 0)])
    many = ra.Outline(
        np.concatenate([np.linspace(p, q, 8, endpoint=False) for p, q in zip(SQUARE, np.roll(SQUARE, -1, 0))])
    )
    for other, height, want in (
        (ra.Outline.circle(0.5), 0.45, 0.0),
        (shapes.capsule(1, 0.25), 0.24, 1.0),
        (shapes.rounded_polygon(SQUARE, 0.2), 0.49, 0.6),
        (ra.Outline(SQUARE), 0.49, 1.0),
        (many, 0.49, 1.0),
    ):
        for a, b, pose in ((floor, other, (0.3, height, 0)), (other, floor, (0.3, -height, 0))):
            loops = loops_of(kernel, a, b, pose)[2][0]
            assert loops["straight"] == pytest.approx([want], abs=1e-9)


def test_collinear_points_leave_straight_alone(kernel: Any) -> None:
    """At any angle, wherever a region's first vertex lies."""
    rng = np.random.default_rng(2)
    cuts = np.concatenate(
        [np.linspace(p, q, 4, endpoint=False) for p, q in zip(SQUARE, np.roll(SQUARE, -1, 0))]
    )
    for _ in range(10 if PURE_PYTHON else 200):
        turn = rng.uniform(0, TAU)
        pose = (*rng.uniform(-0.9, 0.9, 2), rng.uniform(0, TAU))
        plain = ra.Outline(SQUARE).rotated(turn)
        split = ra.Outline(np.roll(cuts, rng.integers(0, 12), axis=0)).rotated(turn)
        want = loops_of(kernel, plain, ra.Outline(SQUARE), pose)[2][0]["straight"]
        for a, b in ((split, ra.Outline(SQUARE)), (split, ra.Outline(cuts))):
            assert loops_of(kernel, a, b, pose)[2][0]["straight"] == pytest.approx(want, abs=1e-12)


def test_bed_energy_knows_arcs(kernel: Any) -> None:
    """Against a straight edge it is area times the centroid's depth; of a whole disc, 8/3 r^3."""
    bed = kernel_module("bed")
    floor = ra.Outline([(-5, -2), (5, -2), (5, 0), (-5, 0)])
    for outline in (ra.Outline.circle(0.5), shapes.capsule(1, 0.25), KINDS["rounded box"]):
        for turn in (0.0, 0.3, 2.0) if len(outline.rings[0]) == 2 else (0.0,):  # turned, others overhang
            _, work, (loops, _) = loops_of(kernel, floor, outline, (0.2, 0.21, turn))
            total = sum(
                bed.bed_energy(work, int(k["start"]), int(k["stop"]), bool(k["arcs"]), 0.0, 1.0)
                for k in loops
            )
            depth = -(loops["y"] - 1.0)  # the floor's middle lies 1 below its face
            assert total == pytest.approx(float((loops["area"] * depth).sum()), rel=1e-9)
    _, work, (loops, _) = loops_of(kernel, ra.Outline.circle(2.0), ra.Outline.circle(0.3), (0.4, 0.5, 0))
    got = bed.bed_energy(work, 0, int(loops["stop"][0]), True, 0.6, 0.8)
    assert got == pytest.approx(8 / 3 * 0.3**3, rel=1e-12)


@pytest.mark.parametrize("name", KINDS)
def test_clearance_is_shapelys(kernel: Any, name: str) -> None:
    clearance = kernel_module("clearance").clearance
    rng = np.random.default_rng(len(name))
    done = 0
    while done < (2 if PURE_PYTHON else 12):
        other = list(KINDS)[rng.integers(0, len(KINDS))]
        a, b = KINDS[name], KINDS[other]
        t = rng.uniform(0, TAU)
        reach = rng.uniform(0, 3)
        pose = (reach * math.cos(t), reach * math.sin(t), rng.uniform(0, TAU))
        first, second = placed(a, (0, 0, 0), 1e-7), placed(b, pose, 1e-7)
        if first.boundary.intersects(second.boundary):
            continue
        pool, work, (_, rel) = loops_of(kernel, a, b, pose)
        want = first.boundary.distance(second.boundary)
        assert clearance(pool, 0, pool, 1, rel, 1e9, work) == pytest.approx(want, abs=3e-7)
        assert clearance(pool, 0, pool, 1, rel, 0.5 * want, work) == 0.5 * want
        done += 1


def test_the_shortest_way_out(kernel: Any) -> None:
    disc, small, box = ra.Outline.circle(1.0), ra.Outline.circle(0.2), ra.Outline(SQUARE)
    for a, b, pose, want in (
        (disc, small, (0.3, 0.4, 0), (0.6, 0.8)),
        (small, disc, (0.3, 0.4, 0), (0.6, 0.8)),
        (box, small, (0.1, -0.2, 0), (0, -1)),
        (small, box, (0.1, -0.2, 0), (0, -1)),
        (shapes.capsule(3, 0.5), small, (0.7, 0.1, 0), (0, 1)),
        (shapes.capsule(3, 0.5), small, (1.8, 0.0, 0), (1, 0)),
    ):
        pool, _, (loops, rel) = loops_of(kernel, a, b, pose)
        assert len(loops) == 1
        assert kernel.place.push_out(pool, 0, 1, rel) == pytest.approx(want, abs=1e-12)


def test_the_public_overlap_samples_its_polygon() -> None:
    rows = ra.overlap(KINDS["rounded L"], (0, 0, 0.2), KINDS["disc"], (0.4, 0.3, 1))
    for row in rows:
        assert shapely.Polygon(row["polygon"]).area == pytest.approx(row["area"], rel=1e-3)
        assert math.hypot(*row["direction"]) == pytest.approx(1)


def test_extent_knows_arcs(kernel: Any) -> None:
    extent = kernel_module("extent").extent
    a, b = KINDS["rounded L"], KINDS["disc"]
    _, work, (loops, _) = loops_of(kernel, a, b, (0.3, 0.2, 1.0))
    both = placed(a, (0, 0, 0)).intersection(placed(b, (0.3, 0.2, 1.0)))
    middle = np.array(both.centroid.coords[0]) - (loops["x"][0], loops["y"][0])
    assert len(loops) == 1
    for t in np.linspace(0, TAU, 9):
        n = np.array([math.cos(t), math.sin(t)])
        along = (shapely.get_coordinates(both) - middle) @ n
        k = loops[0]
        got = extent(work.polygon, work.bows, int(k["start"]), int(k["stop"]), bool(k["arcs"]), *n)
        assert got == pytest.approx((along.min(), along.max()), abs=1e-6)


def frame(thin: float, bulge: float) -> ra.Outline:
    """A star of four curved sides, hollow, with a bar to the right."""
    corners = [
        (1, -0.05, 0),
        (1, 0.05, bulge),
        (0.05, 1, 0),
        (-0.05, 1, bulge),
        (-1, 0.05, 0),
        (-1, -0.05, bulge),
    ]
    corners += [(-0.05, -1, 0), (0.05, -1, bulge)]
    hollow = [((1 - thin) * x, (1 - thin) * y, b) for x, y, b in corners]
    return ra.Outline.from_bulges([corners[0], (3, -0.05, 0), (3, 0.05, 0), *corners[1:]], [hollow])


def test_thin_curved_frames_keep_their_hollow(kernel: Any) -> None:
    """One of two regions has a hole, thinner round it than its arcs are high: which one it is in is asked on an arc.
    (On a chord it was in none, and the overlap 0.)"""
    claw = ra.Outline([(-2, -2), (1.5, -2), (1.5, 2), (2.5, 2), (2.5, -2), (3.5, -2), (3.5, 3), (-2, 3)])
    rng = np.random.default_rng(6)
    for _ in range(3 if PURE_PYTHON else 40):
        a = frame(10 ** rng.uniform(-3, -0.5), float(rng.uniform(-0.42, 0.5)))
        turn = rng.uniform(0, TAU)
        a = a.rotated(turn)
        pose = (*rng.uniform(-0.05, 0.05, 2), turn)
        want = placed(a, (0, 0, 0)).intersection(placed(claw, pose)).area
        for one, other, pose_one, pose_other in ((a, claw, (0, 0, 0), pose), (claw, a, pose, (0, 0, 0))):
            found = kernel.one(one, pose_one, other, pose_other)
            assert found.count.tolist() == [2]
            assert found.area.sum() == pytest.approx(want, abs=1e-6)


@pytest.mark.parametrize("bulge", [5e-324, 1e-310, 1e-200, 1e-16, 9e-9, -9e-9])
def test_what_is_straight_to_rounding_is_straight(bulge):
    """Its radius is rounded by more than it rises over its chord; smaller ones overflowed."""
    square = [(0, 0, 0), (10, 0, bulge), (10, 10, 0), (0, 10, 0)]
    outline = ra.Outline.from_bulges(square)
    assert (outline.area, outline.bounds) == (100, (0, 0, 10, 10))
    assert not any(arc[:, 2].any() for arc in outline.arcs)
    with pytest.raises(ValueError, match="ring must enclose an area"):
        ra.Outline.from_bulges([(0, 0, bulge), (10, 0, 0)])
    (x, _, r) = ra.Outline.from_bulges([(px, py, 2e-8 * (b != 0)) for px, py, b in square]).arcs[0][1]
    assert r == pytest.approx(10 / 8e-8) and x == pytest.approx(10 - r)  # the least arcs are still arcs
