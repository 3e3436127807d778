"""Contact regions against shapely; nodal forces repulsive and balanced; STS equal to k A on flat faces."""

import numpy as np
import pytest
import shapely
from shapely import affinity

from rigidarea.flexible import nodal, segment
from rigidarea.flexible.boundary import build, workspace
from rigidarea.flexible.boundary_places import clear_loads

NONE = np.zeros(0)


def circle(radius, n, clockwise=False, phase=0.0):
    t = (2 * np.pi * np.arange(n) / n + phase) * (-1 if clockwise else 1)
    return np.column_stack([radius * np.cos(t), radius * np.sin(t)])


def star(rng, n=60):
    t = 2 * np.pi * np.arange(n) / n
    r = 1 + 0.3 * np.cos(5 * t + rng.uniform(0, 6)) + 0.05 * rng.standard_normal(n)
    return np.column_stack([r * np.cos(t), r * np.sin(t)])


def pose(x, y, angle):
    return np.array([x, y, np.cos(angle), np.sin(angle)])


def evaluate(rings_a, pose_a, rings_b, pose_b, k=3.0, q=1.0, module=nodal, margin=0.0):
    a, b = build(rings_a), build(rings_b)
    wa, wb = workspace(a), workspace(b)
    s = nodal.scratch(len(a.points) + len(b.points))
    pairs = nodal.search(a, pose_a, b, pose_b, margin, s)
    n = module.contact(a, wa, pose_a, NONE, b, wb, pose_b, NONE, pairs, 1, k, q, True, s)
    assert n >= 0
    return s.regions[:n], wa, wb


@pytest.mark.parametrize("seed", range(25))
def test_regions_against_shapely(seed):
    rng = np.random.default_rng(seed)
    ra, rb = [star(rng), circle(0.3, 20, True)], [star(rng)]
    angle = rng.uniform(0, 6, 2)
    shift = 1.8 * np.array([np.cos(t := rng.uniform(0, 6)), np.sin(t)])
    regions, _, _ = evaluate(ra, pose(5, -3, angle[0]), rb, pose(*(shift + [5, -3]), angle[1]))
    pa = affinity.translate(affinity.rotate(shapely.Polygon(ra[0], ra[1:]), angle[0], (0, 0), True), 5, -3)
    pb = affinity.translate(
        affinity.rotate(shapely.Polygon(rb[0]), angle[1], (0, 0), True), *(shift + [5, -3])
    )
    parts = sorted((g for g in shapely.get_parts(pa.intersection(pb)) if g.area > 0), key=lambda g: g.area)
    assert [r["area"] for r in np.sort(regions, order="area")] == pytest.approx(
        [g.area for g in parts], rel=1e-10
    )
    for r, g in zip(np.sort(regions, order="area"), parts, strict=True):
        assert (r["x"], r["y"]) == pytest.approx(g.centroid.coords[0], abs=1e-9)


@pytest.mark.parametrize("q", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("seed", range(5))
def test_loads_are_repulsive_and_balance(q, seed):
    rng = np.random.default_rng(seed)
    n = rng.integers(30, 90, 2)
    d = rng.uniform(1.85, 1.98)
    at = pose(d * np.cos(1.0), d * np.sin(1.0), 0.3)
    regions, wa, wb = evaluate([circle(1.0, n[0])], pose(0, 0, rng.uniform()), [circle(1.0, n[1])], at, q=q)
    assert len(regions) == 1
    r = regions[0]
    normal, centre = np.array([r["nx"], r["ny"]]), np.array([r["x"], r["y"]])
    assert normal @ [np.cos(1.0), np.sin(1.0)] > 0.999  # the force on B points away from A
    for w, sign in ((wa, -1.0), (wb, 1.0)):
        f, arm = w.point_load, w.position - centre
        assert (sign * f @ normal).min() >= 0.0
        assert np.abs(f.sum(0) - sign * r["force"] * normal).max() < 1e-13 * r["force"]
        moment = (arm[:, 0] * f[:, 1] - arm[:, 1] * f[:, 0])[w.touched[: w.touched[-1]]].sum()
        assert abs(moment) < 1e-13 * r["force"]  # arms are of order 0.3
    clear_loads(wa)
    assert not wa.point_load.any()


def box(x, y=None):
    """A block whose top (y given) or bottom face has nodes at ``x``."""
    x = np.asarray(x, float)
    return np.column_stack([x, np.zeros_like(x)])


def test_flat_faces_have_one_pressure():
    rng = np.random.default_rng(3)
    inner = np.sort(rng.uniform(-0.95, 0.95, 15))
    slave = np.vstack([box(np.concatenate([[-1], inner, [1]])), [[1, 1], [-1, 1]]])
    top = np.sort(rng.uniform(-1.9, 1.9, 23))[::-1]
    master = np.vstack([[[-2, -1], [2, -1]], box(np.concatenate([[2], top, [-2]]))])
    regions, wa, wb = evaluate([slave], pose(0, -0.01, 0), [master], pose(0, 0, 0), k=7.0)
    assert len(regions) == 1 and regions[0]["area"] == pytest.approx(0.02, rel=1e-12)
    for w in (wa, wb):
        p = w.pressure[w.pressure > 0]
        assert len(p) > 5 and p == pytest.approx(0.07, rel=1e-12)


def test_sts_equals_area_on_flat_faces():
    slave = np.vstack([box(np.linspace(-1, 1, 8)), [[1, 1], [-1, 1]]])
    master = np.vstack([[[-2, -1], [2, -1]], box(np.linspace(2, -2, 11))])
    for tilt in (0.0, 0.004):  # tilted, the whole face still inside
        args = ([slave], pose(0, -0.01, tilt), [master], pose(0, 0, 0))
        area, _, _ = evaluate(*args)
        sts, wa, wb = evaluate(*args, q=0.5, module=segment, margin=0.05)
        f = (sts["force"][:, None] * np.column_stack([sts["nx"], sts["ny"]])).sum(0)
        assert np.hypot(*f) == pytest.approx(area[0]["force"], rel=3e-4)  # corners differ by tilt × depth
        assert wa.point_load.sum(0) == pytest.approx(-wb.point_load.sum(0), abs=1e-15)
        x = wb.position[:, 0] @ wb.point_load[:, 1] / wb.point_load[:, 1].sum()
        assert x == pytest.approx(area[0]["x"], abs=1e-4)


@pytest.mark.parametrize(
    ("dx", "dy", "area"), [(0.5, 0, 3), (1, 1, 1), (0, -0.25, 3.5), (2, 0, 0), (2, 2, 0)]
)
def test_boundaries_that_share_lines_and_points(dx, dy, area):
    """Equal boxes, edges along each other and corners on edges, to the last bit: one region, or no area at all."""
    ring = np.array([[-1, -1], [0, -1], [1, -1], [1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0]], float)
    regions, _, _ = evaluate([ring], pose(0, 0, 0), [ring], pose(dx, dy, 0))
    assert list(regions["area"]) == ([area] if area else [])
    if area:
        assert (regions[0]["x"], regions[0]["y"]) == pytest.approx((dx / 2, dy / 2), abs=1e-15)


def test_far_from_the_origin():
    ra, rb = [circle(1.0, 50)], [circle(1.0, 41)]
    near, _, _ = evaluate(ra, pose(0, 0, 0.1), rb, pose(0, 1.875, 0.2))
    far, _, _ = evaluate(ra, pose(2**20, 2**20, 0.1), rb, pose(2**20, 2**20 + 1.875, 0.2))
    assert far[0]["area"] == pytest.approx(near[0]["area"], rel=1e-7)  # positions themselves keep 1e-10 there


def test_a_bar_through_a_bar_is_refused():
    bar = np.array([[-2, -0.2], [2, -0.2], [2, 0.2], [-2, 0.2]])
    with pytest.raises(AssertionError):
        evaluate([bar], pose(0, 0, 0), [bar], pose(0, 0, np.pi / 2))
