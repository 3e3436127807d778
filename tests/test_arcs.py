"""Overlap of outlines with arcs, against closed forms at 50 digits, shapely on area-keeping points, and itself.

Three oracles: mpmath where there is a closed form (lens, circular segment, crescent); GEOS on the sampled outlines,
which is right to the sagitta of the samples; and the general path of the kernel against its closed forms and walks,
which share the measures of an arc but not one decision.
"""

from __future__ import annotations

import math
from typing import Any

import mpmath
import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely.affinity import affine_transform

import rigidarea as ra
from conftest import PURE_PYTHON, kernel_module
from rigidarea import shapes

mpmath.mp.dps = 50
TAU = 2 * math.pi
SQUARE = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]
L_SHAPE = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
#: Convex, concave, holed, all corners rounded, one with arcs both ways; and polygons to meet them.
KINDS: dict[str, ra.Outline] = {
    "disc": ra.Outline.circle(0.7, (0.1, 0.2)),
    "capsule": shapes.capsule(1.2, 0.3),
    "rounded box": shapes.rounded_polygon(SQUARE, 0.2).translated(-0.2, 0.1),
    "box": ra.Outline(SQUARE),
    "rounded L": shapes.rounded_polygon(L_SHAPE, 0.25).translated(-0.7, -0.7),
    "ring": shapes.ring(0.4, 0.9),
    "moon": ra.Outline.from_bulges([(0, -0.8, 1.0), (0, 0.8, -0.5)]),
    "U": ra.Outline(
        [
            (-0.9, -0.6),
            (0.9, -0.6),
            (0.9, 0.6),
            (0.6, 0.6),
            (0.6, -0.3),
            (-0.6, -0.3),
            (-0.6, 0.6),
            (-0.9, 0.6),
        ]
    ),
    "24-gon": ra.Outline(
        0.8 * np.stack([np.cos(TAU * np.arange(24) / 24), np.sin(TAU * np.arange(24) / 24)], 1)
    ),
    "wheel": ra.Outline.from_bulges(
        [(math.cos(TAU * k / 12), math.sin(TAU * k / 12), 0.3 * (-1) ** k) for k in range(12)],
        [[(0.2, 0.0, 1.0), (-0.2, 0.0, 1.0)], [(0.5, 0.1, 0.0), (0.6, 0.1, -0.3), (0.5, -0.1, 0.0)]],
    ),
}


def placed(outline: ra.Outline, pose: Any, tolerance: float = 1e-8) -> Any:
    """The outline as a shapely polygon where (x, y, angle) puts it."""
    c, s = math.cos(pose[2]), math.sin(pose[2])
    return affine_transform(outline.sample(tolerance).polygon, (c, -s, s, c, pose[0], pose[1]))


def lens(a: Any, b: Any, d: Any) -> tuple[Any, Any, Any]:
    """(area, centroid's distance from a's centre, half chord) of two circles d apart, that cross; mpmath."""
    a, b, d = map(mpmath.mpf, (a, b, d))
    foot = (d * d + a * a - b * b) / (2 * d)
    half = mpmath.sqrt(a * a - foot * foot)
    u, v = mpmath.atan2(half, foot), mpmath.atan2(half, d - foot)
    area_a, area_b = a * a * u - half * foot, b * b * v - half * (d - foot)
    # a segment's first moment about the centre is (2 half)^3 / 12
    moment = 2 * half**3 / 3 + (area_b * d - 2 * half**3 / 3)
    return area_a + area_b, moment / (area_a + area_b), half


def one(kernel: Any, a: ra.Outline, pose_a: Any, b: ra.Outline, pose_b: Any) -> Any:
    """Regions of a pair, as conftest finds them: relative to A's body, world axes."""
    return kernel.one(a, pose_a, b, pose_b)


# --- closed forms ---


@pytest.mark.shown
@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("far", [0.0, 1e6])
def test_lens(kernel: Any, size: float, far: float, record_property: Any) -> None:
    """Area to 1e-9 of itself, or what the rounding of the distance allows: 6e-16 r / d of a lens of depth d."""
    rng = np.random.default_rng(7)
    for _ in range(15 if PURE_PYTHON else 300):
        a, b = size * 10 ** rng.uniform(-1, 1, 2)
        depth = 2 * min(a, b) * 10 ** rng.uniform(-10, 0)
        at = far * size * rng.uniform(-1, 1, 2)
        t = rng.uniform(0, TAU)
        to = at + (a + b - depth) * np.array([math.cos(t), math.sin(t)])
        d = mpmath.hypot(mpmath.mpf(to[0]) - mpmath.mpf(at[0]), mpmath.mpf(to[1]) - mpmath.mpf(at[1]))
        depth = float(mpmath.mpf(a) + mpmath.mpf(b) - d)
        if depth <= 1e-14 * (a + b) or d <= abs(a - b):
            continue
        found = one(kernel, ra.Outline.circle(a), (*at, 0.0), ra.Outline.circle(b), (*to, 1.0))
        area, x, half = lens(a, b, d)
        assert found.count[0] == 1
        allowed = max(1e-9, 6e-16 * max(a, b) / depth)
        record_property("lens_of_what_is_allowed", float(abs(found.area[0] / area - 1)) / allowed)
        assert abs(found.area[0] / area - 1) <= allowed
        off = (to - at) / float(d) * float(x) - found.centroid[0]
        assert np.hypot(*off) <= 1e-15 * (a + b) + 1e-9 * min(a, b)
        assert np.hypot(*found.chord[0]) == pytest.approx(2 * float(half), rel=allowed)
        assert abs(found.chord[0] @ (to - at)) <= 1e-12 * size * (a + b)


@pytest.mark.parametrize("gap", [1e-3, 1e-7, 1e-11])
def test_discs_nearly_one_on_the_other(kernel: Any, gap: float) -> None:
    """Centres nearer than a radius by far: the lens is all but a crescent of the smaller."""
    rng = np.random.default_rng(9)
    for _ in range(10 if PURE_PYTHON else 100):
        b = 1 - gap * rng.uniform(-1, 1)
        t, d = rng.uniform(0, TAU), (abs(1 - b) + gap * rng.random())
        to = d * np.array([math.cos(t), math.sin(t)])
        d = mpmath.hypot(mpmath.mpf(to[0]), mpmath.mpf(to[1]))
        found = one(kernel, ra.Outline.circle(1.0), (0, 0, 0), ra.Outline.circle(b), (*to, 1.0))
        area, x, half = lens(1, b, d)
        assert float(abs(found.area[0] - area)) <= 1e-14
        assert np.hypot(*(to / float(d) * float(x) - found.centroid[0])) <= 1e-14
        assert np.hypot(*found.chord[0]) == pytest.approx(2 * float(half), abs=1e-15 / gap)


def test_discs_apart_touching_and_nested(kernel: Any) -> None:
    disc, small = ra.Outline.circle(1.0), ra.Outline.circle(0.25)
    assert one(kernel, disc, (0, 0, 0), disc, (2.0, 0, 0)).count[0] == 0
    assert one(kernel, disc, (0, 0, 0), disc, (0, 2.0 + 1e-15, 0)).count[0] == 0
    for place in ((0.3, 0.2, 0), (0.75, 0, 0), (0.0, -0.75, 2)):  # the latter two touch from within
        for a, pa, b, pb in ((disc, (0, 0, 0), small, place), (small, place, disc, (0, 0, 0))):
            found = one(kernel, a, pa, b, pb)
            assert found.area == pytest.approx([math.pi / 16], rel=1e-12)
            assert np.array(pa[:2]) + found.centroid[0] == pytest.approx(place[:2], abs=1e-12)
            assert np.hypot(*found.chord[0]) < 1e-7
    found = one(kernel, disc, (1, 2, 0), disc, (1, 2, 1))
    assert found.area == pytest.approx([math.pi], rel=1e-15)


def test_circular_segment(kernel: Any) -> None:
    """A disc, a capsule's end, a rounded corner's arc pressed into a floor, at any angle."""
    floor = ra.Outline([(-50, -3), (50, -3), (50, 0), (-50, 0)])
    rng = np.random.default_rng(3)
    for name in ("disc", "capsule"):
        r = 0.5
        for depth in 10 ** rng.uniform(-8, -0.5, 4 if PURE_PYTHON else 60):
            t = rng.uniform(0, TAU)
            outline = ra.Outline.circle(r) if name == "disc" else shapes.capsule(4, r).translated(2, 0)
            turn = t if name == "disc" else 0.5 * math.pi  # its other end points upwards
            place = (float(rng.uniform(-3, 3)), r - depth, turn)
            d = float(mpmath.mpf(r) - mpmath.mpf(place[1]))
            angle = mpmath.acos((r - mpmath.mpf(d)) / r)
            area = r * r * (angle - mpmath.sin(angle) * mpmath.cos(angle))
            down = 2 * (r * mpmath.sin(angle)) ** 3 / 3 / area - place[1]  # depth of the centroid
            for a, pa, b, pb in ((floor, (0, 0, 0), outline, place), (outline, place, floor, (0, 0, 0))):
                found = one(kernel, a, pa, b, pb)
                assert found.area == pytest.approx([float(area)], rel=max(1e-9, 4e-15 / depth))
                at = found.centroid[0] + pa[:2]
                assert at == pytest.approx([place[0], -float(down)], abs=1e-9 * r)
                chord = 2 * r * float(mpmath.sin(angle))
                assert np.hypot(*found.chord[0]) == pytest.approx(chord, rel=max(1e-9, 4e-15 / depth))


@pytest.mark.parametrize("play", [1e-2, 1e-6, 1e-9])
def test_pin_in_its_journal(kernel: Any, play: float) -> None:
    """A crescent: what of the pin the hole does not hold."""
    hole = 1.0
    pin = hole * (1 - play)
    journal, disc = shapes.ring(hole, 1.5), ra.Outline.circle(pin)
    rng = np.random.default_rng(5)
    for share in (1.0001, 1.01, 1.5, 3.0, 30.0):
        t = rng.uniform(0, TAU)
        at = share * play * np.array([math.cos(t), math.sin(t)])
        d = mpmath.hypot(mpmath.mpf(at[0]), mpmath.mpf(at[1]))
        inside, x, _ = lens(pin, hole, d)
        area = mpmath.pi * mpmath.mpf(pin) ** 2 - inside
        reach = x * inside / area  # of the crescent's centroid from the pin's centre, along its shift
        for a, pa, b, pb in ((journal, (0, 0, 0.3), disc, (*at, t)), (disc, (*at, t), journal, (0, 0, 0.3))):
            found = one(kernel, a, pa, b, pb)
            assert found.count[0] == 1
            assert float(abs(found.area[0] - area)) <= 1e-15
            noise = 1e-15 / float(area)
            want = at * (1 + float(reach / d))
            assert found.centroid[0] + pa[:2] == pytest.approx(want, abs=max(1e-9, noise))
    for share in (0.0, 0.5, 0.99):
        assert one(kernel, journal, (0, 0, 0), disc, (share * play, 0, 0)).count[0] == 0


def test_a_pin_as_wide_as_its_hole(kernel: Any) -> None:
    """Circles that are one to rounding: no area, whatever the rounding says."""
    for x, y, angle in ((0, 0, 0), (0, 0, 1.234), (1e-16, 0, 0.5), (0, 1e-15, 2.0), (3e-15, 1e-15, 2.0)):
        found = one(kernel, shapes.ring(1, 2), (0, 0, 0.3), ra.Outline.circle(1.0), (x, y, angle))
        assert found.count[0] >= 0 and found.area.sum() < 1e-10
        whole = one(kernel, ra.Outline.circle(1.0), (0, 0, 0), shapes.ring(1, 2), (x, y, angle))
        assert whole.count[0] >= 0 and whole.area.sum() < 1e-10
    capsule = shapes.capsule(1, 0.25)
    for x in (0.0, 1e-16, 1e-15):
        found = one(kernel, capsule, (0, 0, 0.7), capsule, (x, 0, 0.7))
        assert found.area == pytest.approx([capsule.area], rel=1e-9)


# --- shapely ---


def compared(kernel: Any, a: ra.Outline, pa: Any, b: ra.Outline, pb: Any, tolerance: float = 1e-8) -> None:
    both = placed(a, pa, tolerance).intersection(placed(b, pb, tolerance))
    found = one(kernel, a, pa, b, pb)
    room = 10 * tolerance  # samples lie within their sagitta; the overlap's boundary is a few lengths long
    assert found.count[0] >= 0
    assert found.area.sum() == pytest.approx(both.area, abs=room)
    if both.area > 1e-3:
        at = (found.area[:, None] * found.centroid).sum(axis=0) / found.area.sum() + pa[:2]
        assert at == pytest.approx(both.centroid.coords[0], abs=5 * room / both.area)
    parts = [part for part in shapely.get_parts(both) if part.area > room]
    sure = all(part.buffer(-1e-4).geom_type == "Polygon" for part in parts) and len(parts) == sum(
        part.area > 1e-3 for part in shapely.get_parts(both)
    )
    grown = shapely.get_parts(shapely.buffer(both, 1e-4))
    if sure and len(grown) == len(parts) == len(shapely.get_parts(both)) and both.area > 0:
        assert found.count[0] == len(parts)


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.parametrize("other", KINDS)
def test_any_two_against_shapely(kernel: Any, name: str, other: str) -> None:
    rng = np.random.default_rng(sum(map(ord, name + other)))
    for _ in range(2 if PURE_PYTHON else 6):
        pa = (*rng.uniform(-3, 3, 2), rng.uniform(0, TAU))
        r, t = 1.6 * math.sqrt(rng.random()), rng.uniform(0, TAU)
        pb = (pa[0] + r * math.cos(t), pa[1] + r * math.sin(t), rng.uniform(0, TAU))
        compared(kernel, KINDS[name], pa, KINDS[other], pb, 1e-7)


@pytest.mark.parametrize("shrunk", [0.5, 0.9, 1 - 4e-6, 1 - 1e-9])
def test_a_capsule_in_a_larger_one(kernel: Any, shrunk: float) -> None:
    """Boundaries that do not cross, one inside the other: whichever is asked first, and however near they are."""
    outer, inner = shapes.capsule(0.8, 0.4), shapes.capsule(0.8 * shrunk, 0.4 * shrunk)
    shift = 0.2 * (1 - shrunk)
    for a, b in ((outer, inner), (inner, outer)):
        found = kernel.one(a, (0, 0, 0.7), b, (shift, -shift, 0.7))
        assert found.count[0] == 1
        assert found.area[0] == pytest.approx(inner.area, rel=1e-12)


@pytest.mark.slow
def test_a_thousand_against_shapely_at_100_000_points(kernel: Any) -> None:
    rng = np.random.default_rng(11)
    names = list(KINDS)
    for _ in range(1000):
        a, b = (KINDS[names[k]] for k in rng.integers(0, len(names), 2))
        r, t = 1.6 * math.sqrt(rng.random()), rng.uniform(0, TAU)
        compared(kernel, a, (0, 0, 0), b, (r * math.cos(t), r * math.sin(t), rng.uniform(0, TAU)), 5e-10)


lattice = st.integers(-8, 8).map(lambda k: 0.125 * k)
turns = st.one_of(
    st.integers(0, 24).map(lambda k: k * math.pi / 12), st.sampled_from([0.0, 1e-16, 1e-9, 0.3])
)
LATTICE: dict[str, ra.Outline] = {
    "disc": ra.Outline.circle(0.5),
    "small disc": ra.Outline.circle(0.25, (0.25, 0)),
    "capsule": shapes.capsule(1, 0.25),
    "rounded box": shapes.rounded_polygon([(-0.75, -0.5), (0.75, -0.5), (0.75, 0.5), (-0.75, 0.5)], 0.25),
    "box": ra.Outline([(-0.75, -0.5), (0.75, -0.5), (0.75, 0.5), (-0.75, 0.5)]),
    "rounded L": shapes.rounded_polygon(L_SHAPE, 0.25).translated(-1, -1),
    "ring": shapes.ring(0.5, 0.75),
    "notched": ra.Outline.from_bulges(
        [(-1, -0.5, 0), (1, -0.5, 0), (1, 0.5, 0), (0.5, 0.5, -1), (-0.5, 0.5, 0), (-1, 0.5, 0)]
    ),
}


@given(st.sampled_from(sorted(LATTICE)), st.sampled_from(sorted(LATTICE)), lattice, lattice, turns, turns)
def test_corners_on_arcs_and_tangents(
    kernel: Any, name: str, other: str, x: float, y: float, turn: float, also: float
) -> None:
    """Radii, corners and places on one lattice: tangent, concentric, conforming, shared edges and arcs."""
    a, b = LATTICE[name], LATTICE[other]
    pa, pb = (
        (0.0, 0.0, also),
        (x * math.cos(also) - y * math.sin(also), x * math.sin(also) + y * math.cos(also), turn),
    )
    both = placed(a, pa, 1e-6).intersection(placed(b, pb, 1e-6))
    found = one(kernel, a, pa, b, pb)
    assert found.count[0] >= 0
    assert found.area.sum() == pytest.approx(both.area, abs=2e-5)


# --- itself ---


def by_general_path(kernel: Any, a: ra.Outline, b: ra.Outline, rel: Any, work: Any) -> np.ndarray:
    loops = kernel_module("loops")
    pool = kernel.pool.pack([a, b])
    n = loops.general(pool, 0, pool, 1, rel, work)
    assert n >= 0
    return np.array(
        [
            (loop["area"], loop["x"], loop["y"], loop["chord_x"], loop["chord_y"], loop["lever"])
            for loop in work.loops[:n]
        ]
    )


@pytest.mark.parametrize("name", ["disc", "capsule", "rounded box", "box", "24-gon"])
@pytest.mark.parametrize("swap", [False, True])
def test_disc_against_convex_two_ways(kernel: Any, name: str, swap: bool) -> None:
    """The walk round a convex outline, and the lens, against crossings and loops."""
    rng = np.random.default_rng(1)
    work = kernel_module("work")
    scratch = [work.new_work(400), work.new_work(400)]
    pool, other = kernel.pool, KINDS[name]
    for _ in range(10 if PURE_PYTHON else 400):
        disc = ra.Outline.circle(10 ** rng.uniform(-1.5, 1))
        a, b = (disc, other) if swap else (other, disc)
        packed = pool.pack([a, b])
        t = rng.uniform(0, TAU)
        reach = packed.heads["radius"].sum() * 1.05 * rng.random()
        rel = work.Relative(math.cos(t), math.sin(t), *(reach * np.array([math.cos(3 * t), math.sin(3 * t)])))
        n = kernel.overlap.overlap_kernel(packed, 0, packed, 1, rel, scratch[0])
        found = np.array([tuple(loop)[2:8] for loop in scratch[0].loops[:n]])
        want = by_general_path(kernel, a, b, rel, scratch[1])
        assert n == len(want)
        if n:
            size = min(a.area, b.area)
            scale = np.sqrt(size) * np.array([np.sqrt(size), 1, 1, 1, 1, np.sqrt(size)])
            room = 1e-12 * size / want[0, 0] + 1e-9  # a shallow lens knows its centroid and chord less well
            assert (np.abs(found[0] - want[0]) <= room * scale).all()


@given(st.sampled_from(sorted(KINDS)), st.sampled_from(sorted(KINDS)), st.integers(0, 2**32 - 1))
def test_swapping_and_a_common_motion(kernel: Any, name: str, other: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    a, b = KINDS[name], KINDS[other]
    pb = (*rng.uniform(-1.3, 1.3, 2), rng.uniform(0, TAU))
    first = one(kernel, a, (0, 0, 0), b, pb)
    second = one(kernel, b, pb, a, (0, 0, 0))
    assert first.area.sum() == pytest.approx(second.area.sum(), abs=1e-12)
    assert first.chord.sum(axis=0) == pytest.approx(-second.chord.sum(axis=0), abs=1e-6)
    t, shift = rng.uniform(0, TAU), rng.uniform(-1e6, 1e6, 2)
    c, s = math.cos(t), math.sin(t)
    moved = one(
        kernel,
        a,
        (*shift, t),
        b,
        (shift[0] + c * pb[0] - s * pb[1], shift[1] + s * pb[0] + c * pb[1], pb[2] + t),
    )
    assert moved.area.sum() == pytest.approx(first.area.sum(), abs=1e-8)  # 1e6 has an ulp of 1e-10


@given(st.sampled_from(["capsule", "rounded box", "rounded L", "moon"]), st.integers(0, 2**32 - 1))
def test_arcs_and_edges_in_pieces_change_nothing(kernel: Any, name: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    whole = KINDS[name]
    points, arcs = whole.rings[0], whole.arcs[0]
    following = np.roll(points, -1, axis=0)
    ring, bent = [], []
    for p, q, arc in zip(points, following, arcs):
        share = rng.uniform(0.1, 0.9)
        if arc[2] == 0:
            middle = p + share * (q - p)
        else:
            away = p + share * (q - p) - arc[:2]
            across = np.array([(q - p)[1], -(q - p)[0]]) * np.sign(arc[2])
            away = away + across  # outwards of the chord, so on the arc's side
            middle = arc[:2] + away * abs(arc[2]) / np.hypot(*away)
        ring += [p, middle]
        bent += [arc, arc]
    split = ra.Outline.from_curve([np.array(ring)], arcs=[np.array(bent)])
    assert split.area == pytest.approx(whole.area, rel=1e-13)
    pose = (*rng.uniform(-1, 1, 2), rng.uniform(0, TAU))
    for other in ("box", "rounded box", "disc", "ring"):
        first = one(kernel, whole, (0, 0, 0), KINDS[other], pose)
        second = one(kernel, split, (0, 0, 0), KINDS[other], pose)
        assert second.area.sum() == pytest.approx(first.area.sum(), abs=1e-12)
        assert second.chord.sum(axis=0) == pytest.approx(first.chord.sum(axis=0), abs=1e-8)


# --- what else is known of a region ---
