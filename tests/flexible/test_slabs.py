"""Regions of any shape: several arcs a body against shapely, loads by slabs balanced and equal to the closed form."""

import numpy as np
import pytest
import shapely
from shapely import affinity

from rigidarea.flexible import nodal
from rigidarea.flexible.boundary import build, workspace
from rigidarea.flexible.scratch import SLICED

NONE = np.zeros(0)
# Two tapering teeth on a bar, and a straight bar whose end reaches through the first into the second
TEETH = np.array(
    [[-4, -1], [4, -1], [4, 0], [2.5, 0], [2.2, 1.5], [1.8, 1.5], [1.5, 0], [-1.5, 0], [-1.8, 1.5], [-2.2, 1.5],
     [-2.5, 0], [-4, 0]], float
)  # fmt: skip
BAR = np.array([[-5, 0.4], [2, 0.4], [2, 0.8], [-5, 0.8]], float)


def dense(ring, step):
    """The ring with a node about every ``step``."""
    out = []
    for p, q in zip(ring, np.roll(ring, -1, 0), strict=True):
        n = max(1, round(np.hypot(*(q - p)) / step))
        out.append(p + (q - p) * np.arange(n)[:, None] / n)
    return np.vstack(out)


def evaluate(ring_a, pose_a, ring_b, pose_b, q=1.0):
    a, b = build([ring_a]), build([ring_b])
    wa, wb = workspace(a), workspace(b)
    s = nodal.scratch(len(ring_a) + len(ring_b))
    pose_a, pose_b = (np.array([x, y, np.cos(t), np.sin(t)]) for x, y, t in (pose_a, pose_b))
    pairs = nodal.search(a, pose_a, b, pose_b, 0.0, s)
    n = nodal.contact(a, wa, pose_a, NONE, b, wb, pose_b, NONE, pairs, 1, 3.0, q, True, s)
    return n, s.regions[: max(n, 0)].copy(), (wa, wb)


def check_areas(regions, polygon):
    """Areas to rounding, centroids to rounding over the size of the region."""
    parts = sorted((g for g in shapely.get_parts(polygon) if g.area > 0), key=lambda g: g.area)
    regions = np.sort(regions, order="area")
    assert regions["area"] == pytest.approx([g.area for g in parts], rel=1e-10)
    for r, g in zip(regions, parts, strict=True):
        assert (r["x"], r["y"]) == pytest.approx(g.centroid.coords[0], abs=1e-9)


def check_balance(regions, works):
    """Loads sum to Σ k A along the directions, with its moment, on either body, to rounding."""
    f = (regions["force"] * np.array([regions["nx"], regions["ny"]])).T
    moment = (regions["x"] * f[:, 1] - regions["y"] * f[:, 0]).sum()
    for w, sign in zip(works, (-1.0, 1.0), strict=True):
        p, load = w.position, w.point_load
        assert load.sum(0) == pytest.approx(sign * f.sum(0), abs=1e-12 * regions["force"].sum())
        on = w.touched[: w.touched[-1]]
        turning = (p[on, 0] * load[on, 1] - p[on, 1] * load[on, 0]).sum()
        assert turning == pytest.approx(sign * moment, abs=1e-11 * regions["force"].sum())  # arms of order 3


@pytest.mark.parametrize("step", [9.0, 0.3, 0.07])
@pytest.mark.parametrize("lift", [0.0, 0.13])
def test_bar_end_across_two_teeth(step, lift):
    """Four crossings in the first tooth, two in the second; the tapering tooth drives the bar up."""
    n, regions, works = evaluate(dense(BAR, step), (0.0, lift, 0.0), dense(TEETH, step), (0.0, 0.0, 0.0))
    assert n == 2
    check_areas(regions, shapely.Polygon(BAR + [0, lift]).intersection(shapely.Polygon(TEETH)))
    first = regions[np.argmin(regions["x"])]
    assert sorted(regions["arcs"]) == [1, 2]
    assert first["chord"] == pytest.approx(2 * 0.4 * 0.2, rel=1e-12)  # flanks lean by 0.2
    assert (first["nx"], first["ny"]) == pytest.approx((0.0, -1.0), abs=1e-9)  # the force on the teeth
    check_balance(regions, works)


def test_loads_of_several_arcs_are_repulsive():
    """The bar through the tapering tooth alone: its flanks push, no node pulls."""
    n, regions, works = evaluate(dense(BAR, 0.1), (-1.0, 0.0, 0.0), dense(TEETH, 0.1), (0.0, 0.0, 0.0))
    assert n == 1 and regions[0]["arcs"] == 2
    for w, sign in zip(works, (-1.0, 1.0), strict=True):
        push = sign * w.point_load @ [regions[0]["nx"], regions[0]["ny"]]
        assert push.min() > -1e-15 and push.max() > 1e-3
    check_balance(regions, works)


def test_wedge_through_a_plate():
    """A wedge whose tip stands out on the other side: the plate throws it back the way it came."""
    wedge = np.array([[-0.5, 3.0], [0.0, -1.0], [0.7, 3.0]])
    plate = np.array([[-3.0, 0.0], [3.0, 0.0], [3.0, 0.5], [-3.0, 0.5]])
    n, regions, works = evaluate(dense(wedge, 0.11), (0.1, 0.0, 0.05), dense(plate, 0.13), (0.0, 0.0, -0.1))
    assert n == 1 and regions[0]["arcs"] == 2
    placed = affinity.translate(affinity.rotate(shapely.Polygon(wedge), 0.05, (0, 0), True), 0.1, 0.0)
    check_areas(regions, placed.intersection(affinity.rotate(shapely.Polygon(plate), -0.1, (0, 0), True)))
    assert regions[0]["ny"] < -0.9
    check_balance(regions, works)


def star(rng, n=60):
    t = 2 * np.pi * np.arange(n) / n
    r = 1 + 0.4 * np.cos(5 * t + rng.uniform(0, 6)) + 0.05 * rng.standard_normal(n)
    return np.column_stack([r * np.cos(t), r * np.sin(t)])


def test_random_deep_overlaps_against_shapely():
    """Stars pushed deep into each other: up to ten crossings a region, arcs that fold back."""
    most = 0
    for seed in range(60):
        rng = np.random.default_rng(seed)
        ra, rb = star(rng), star(rng)
        angle, d = rng.uniform(0, 6, 2), rng.uniform(0.3, 1.7)
        _, regions, works = evaluate(ra, (0.0, 0.0, angle[0]), rb, (d, 0.2, angle[1]))
        pa = affinity.rotate(shapely.Polygon(ra), angle[0], (0, 0), True)
        pb = affinity.translate(affinity.rotate(shapely.Polygon(rb), angle[1], (0, 0), True), d, 0.2)
        overlap = pa.intersection(pb)
        assert all(not g.interiors for g in shapely.get_parts(overlap))
        check_areas(regions, overlap)
        check_balance(regions, works)
        most = max(most, regions["arcs"].max(initial=0))
    assert most >= 3


@pytest.mark.parametrize("q", [0.5, 2.0])
def test_bar_through_a_bar_has_no_direction(q):
    bar = np.array([[-2, -0.2], [2, -0.2], [2, 0.2], [-2, 0.2]])
    n, _, _ = evaluate(bar, (0.0, 0.0, 0.0), bar, (0.0, 0.0, 0.7), q)
    assert n == SLICED


def test_slabs_are_the_closed_form():
    """The same region with an exponent next to 1 goes by slabs: loads and pressures of the closed form."""
    t = 2 * np.pi * np.arange(70) / 70
    disc = np.column_stack([np.cos(t), np.sin(t)])
    at = (1.9 * np.cos(1.0), 1.9 * np.sin(1.0), 0.3)
    _, _, closed = evaluate(disc, (0.0, 0.0, 0.1), disc, at)
    _, _, slabs = evaluate(disc, (0.0, 0.0, 0.1), disc, at, 1.0 + 1e-12)
    for u, v in zip(closed, slabs, strict=True):
        assert np.abs(u.point_load - v.point_load).max() < 1e-9 * np.abs(u.point_load).max()
        assert u.pressure == pytest.approx(v.pressure, rel=1e-8, abs=1e-12)
