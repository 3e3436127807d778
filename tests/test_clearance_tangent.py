"""The clearance of what touches along a tangent or coincides is none: nothing says that it may go on for a while."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import rigidarea as ra
import tangent_chains
import tangent_drawings
import tangent_families
import tangent_pairs
from conftest import PURE_PYTHON, kernel_module
from rigidarea import shapes
from rigidarea.geometry import arcs as ring_arcs

TOUCHING = [
    family
    for family in (*tangent_families.FAMILIES, *tangent_drawings.DRAWINGS, *tangent_chains.CHAINS)
    if family is not tangent_families.capsule_over_bore
]


@pytest.mark.parametrize("family", TOUCHING, ids=lambda family: family.__name__)
def test_what_touches_has_no_clearance(family: Any) -> None:
    """At its place, and moved by s no more than |s| (a touching point moves by that), but for what a coordinate of the
    bodies' places rounds. Of the boundaries: so inside of each other too."""
    clearance, place, pool_of = (kernel_module(name) for name in ("clearance", "place", "pool"))
    rng = np.random.default_rng(8)
    for _ in range(4 if PURE_PYTHON else 30):
        size = 10 ** rng.uniform(-6, 6)
        pair = family(rng, size)
        if pair.family == "stacked boxes" and not len(pair.against[0]):
            continue  # corner beside corner: these may not touch
        if family in tangent_drawings.DRAWINGS and pair.area not in (0.0, pair.a.area, pair.b.area):
            continue  # boundaries cross
        pool = pool_of.pack([pair.a, pair.b])
        points = sum(len(ring) for outline in (pair.a, pair.b) for ring in outline.rings)
        work = kernel_module("work").new_work(max(256, 2 * points))
        for a, b, s in zip(*tangent_pairs.poses(rng, pair, size, 5)):
            rel = place.seen_from(pool.heads[0], place.Pose(*a), pool.heads[1], place.Pose(*b))
            noise = kernel_module("work").noise_of(pool.heads[0].radius, pool.heads[1].radius, rel)
            room = 4 * noise + 2.0**-51 * float(np.abs([*a[:2], *b[:2]]).max())
            found = clearance.clearance(pool, 0, pool, 1, rel, 1e9 * size, work)
            assert 0.0 <= found <= math.hypot(*s) + room, (pair.family, size, s)


Parallel = tuple[ra.Outline, ra.Outline, tuple[float, float]]


def in_bore(r: float, g: float, rng: np.random.Generator) -> Parallel:
    return tangent_pairs.plate(ra.Outline.circle(r)), ra.Outline.circle(r - g), (0.0, 0.0)


def in_slot(r: float, g: float, rng: np.random.Generator) -> Parallel:
    """A pin, or a tongue as long as it, or shorter."""
    length = r * rng.uniform(0.1, 5)
    short = length * float(rng.choice([rng.uniform(0.1, 0.9), 1.0]))
    inner = ra.Outline.circle(r - g) if rng.random() < 0.5 else shapes.capsule(short, r - g)
    return tangent_pairs.plate(shapes.capsule(length, r)), inner, (0.0, 0.0)


def in_kidney(r: float, g: float, rng: np.random.Generator) -> Parallel:
    middle, low = r * rng.uniform(1.1, 5), rng.uniform(-3, 3)
    high = low + rng.uniform(0.3, 1.5)
    long, tongue = (tangent_drawings.kidney(middle, width, low, high) for width in (r, r - g))
    return tangent_pairs.plate(long), tongue, (0.0, 0.0)


def in_ring(r: float, g: float, rng: np.random.Generator) -> Parallel:
    """A ring about a disc, or a ring: g between their circles."""
    inner = r - g
    disc = ra.Outline.circle(inner) if rng.random() < 0.5 else shapes.ring(inner / 2, inner)
    return shapes.ring(r, 2 * r), disc, (0.0, 0.0)


def in_corner(r: float, g: float, rng: np.random.Generator) -> Parallel:
    """One polygon, grown by r and by r - g."""
    corners = r * rng.uniform(0.5, 3, (3, 2)) * ((-1, -1), (1, -1), (0, 1))
    one, other = (ring_arcs.grown(corners, width) for width in (r, r - g))
    outer, inner = (ra.Outline.from_curve([ring], arcs=[bows]) for ring, bows in (one, other))
    return outer, inner, (0.0, 0.0)


def on_flat(r: float, g: float, rng: np.random.Generator) -> Parallel:
    """An arc of up to 1e4 its width above a face."""
    radius = r * 10 ** rng.uniform(0.1, 4)
    bulge = math.tan(math.asin(r / radius) / 2)
    foot = ra.Outline.from_bulges([(-r, 0, bulge), (r, 0, 0), (r, r, 0), (-r, r, 0)])
    return shapes.box(4 * r, 2 * r), foot, (0.0, r + r * bulge + g)


def off_capsule(r: float, g: float, rng: np.random.Generator) -> Parallel:
    """A disc beside a capsule's face, its end, or where the one goes over into the other."""
    u, length = r * rng.uniform(0.2, 2), r * rng.uniform(0.5, 3)
    far, t = r + u + g, float(rng.choice([0, rng.uniform(-1, 1), 1])) * math.pi / 2
    end = length / 2 + far * math.cos(t), far * math.sin(t)
    side = length / 2 * rng.uniform(-1, 1), far
    return shapes.capsule(length, r), ra.Outline.circle(u), end if rng.random() < 0.6 else side


def lenses(r: float, g: float, rng: np.random.Generator) -> Parallel:
    """Corner to corner, or side to side."""
    half, less = r * rng.uniform(0.2, 0.99), r * rng.uniform(0.1, 0.95)
    one, other = tangent_drawings.lens(r, half), tangent_drawings.lens(r, less)
    wide = 2 * r - math.sqrt(r * r - half * half) - math.sqrt(r * r - less * less)
    return one, other, (0.0, half + less + g) if rng.random() < 0.5 else (wide + g, 0.0)


@pytest.mark.parametrize(
    "drawing", [in_bore, in_slot, in_kidney, in_ring, in_corner, on_flat, off_capsule, lenses]
)
def test_parallel_boundaries_are_as_far_apart_as_drawn(drawing: Any) -> None:
    """From 1e-12 to a third of their size, all along or in a point; to what places and sizes round."""
    clearance, place, pool_of = (kernel_module(name) for name in ("clearance", "place", "pool"))
    rng = np.random.default_rng(9)
    for _ in range(4 if PURE_PYTHON else 60):
        r = 10 ** rng.uniform(-6, 6)
        gap = r * 10 ** rng.uniform(-12, -0.5)
        a, b, (x, y) = drawing(r, gap, rng)
        pool = pool_of.pack([a, b])
        points = sum(len(ring) for outline in (a, b) for ring in outline.rings)
        work = kernel_module("work").new_work(max(256, 2 * points))
        t, far = (
            float(rng.choice([0, rng.uniform(-7, 7)])),
            r * 10 ** rng.uniform(-1, 3) * rng.uniform(-1, 1, 2),
        )
        c, s = math.cos(t), math.sin(t)
        pose_a = place.Pose(*far, c, s)
        pose_b = place.Pose(far[0] + c * x - s * y, far[1] + s * x + c * y, c, s)
        room = 2.0**-49 * (np.abs(far).sum() + 10 * r)
        found = []
        for i, p, q in ((0, pose_a, pose_b), (1, pose_b, pose_a)):
            rel = place.seen_from(pool.heads[i], p, pool.heads[1 - i], q)
            found.append(clearance.clearance(pool, i, pool, 1 - i, rel, 1e9 * r, work))
        assert max(abs(f - gap) for f in found) <= room, (drawing.__name__, r, gap, found)
