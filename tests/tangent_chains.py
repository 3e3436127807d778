"""More families: near radii that touch at an arc's end, chains of tangent arcs, circles in pieces of their own."""

from __future__ import annotations

import math

import numpy as np

import rigidarea as ra
from rigidarea import shapes
from tangent_drawings import at, beside, within
from tangent_pairs import NONE, Pair, pieces_of, plate


def near_radii(rng: np.random.Generator, size: float) -> Pair:
    """A disc less wide than a capsule by 1e-8 to 0.8 of it, or a part of the disc with a corner there, touching it
    from within where its half circle ends: in the solid, or in a slot of its shape."""
    radius, length = size * rng.uniform(0.2, 1), size * rng.uniform(0.1, 2)
    less = 10 ** rng.uniform(-8, -0.1)
    r = radius * (1 - less)
    up = float(rng.choice([1.0, -1.0]))
    outer = shapes.capsule(length, radius)
    inner = ra.Outline.circle(r)
    if rng.random() < 0.5:
        sweep = rng.uniform(0.3, math.pi - 0.1)
        touch, end = at(r, up * math.pi / 2), at(r, up * (math.pi / 2 - sweep))
        start, stop = (end, touch) if up > 0 else (touch, end)
        inner = ra.Outline.from_bulges([(*start, math.tan(sweep / 4)), (*stop, 0)])
    place = (length / 2, up * (radius - r))
    flat = 2 * radius / less  # two near circles part as slowly as a flat one and its tangent
    if rng.random() < 0.5:
        return within("near radii", outer, inner, place, NONE, flat)
    return beside("near radii", plate(outer), inner, place, NONE, flat)


def chains(rng: np.random.Generator, size: float) -> Pair:
    """Waves of arcs, each tangent to the next: one solid on the other along the same arcs, or crest on crest."""
    n = int(rng.integers(2, 12))
    w, bulge = size * rng.uniform(0.2, 1), rng.uniform(0.05, 0.6)
    high = bulge * w / 2
    low = -2 * high - w
    bend = [
        bulge if k % 2 else -bulge for k in range(n)
    ]  # of the arc from k w to (k + 1) w, seen from the right
    below = ra.Outline.from_bulges(
        [(0, low, 0), (n * w, low, 0), *((k * w, 0, bend[k - 1]) for k in range(n, 0, -1)), (0, 0, 0)]
    )
    m = int(rng.integers(1, n + 1))
    k = int(rng.integers(0, n - m + 1))
    same = m == 1 or rng.random() < 0.6
    arcs = [(j * w, 0, -bend[k + j] if same else bend[k + j]) for j in range(m)]
    above = ra.Outline.from_bulges([(m * w, -low, 0), (0, -low, 0), *arcs, (m * w, 0, 0)])
    flat = 2 * m * w * (1 + bulge * bulge) / bulge
    if same:
        return beside("chains", below, above, (k * w, 0.0), pieces_of(above, lambda a: a[:, 2] != 0), flat)
    return beside("chains", below, above, (k * w, 2 * high), NONE, flat)


def _in_pieces(rng: np.random.Generator, r: float) -> ra.Outline:
    """A circle drawn of two halves, or of 3 to 6 arcs that end anywhere."""
    while rng.random() < 0.7:
        ends = np.sort(rng.uniform(-math.pi, math.pi, int(rng.integers(3, 7))))
        sweeps = np.diff(ends, append=ends[0] + math.tau)
        if 0.05 < sweeps.min() and sweeps.max() < 0.999 * math.pi:
            return ra.Outline.from_bulges([(*at(r, t), math.tan(s / 4)) for t, s in zip(ends, sweeps)])
    return ra.Outline.circle(r)


def whole_circles(rng: np.random.Generator, size: float) -> Pair:
    """A disc or a ring in a bore of its radius, or on a disc like it, each in pieces of its own."""
    r = size * rng.uniform(0.3, 1)
    one, other = _in_pieces(rng, r), _in_pieces(rng, r)
    how = int(rng.integers(3))
    if how == 0:
        return Pair(
            "circles", one, other, (0.0, 0.0), other.area, np.zeros(2), NONE, pieces_of(other), (1,), 4 * r
        )  # fmt: skip
    rim = pieces_of(other)
    if how == 2:
        bore = ra.Outline.circle(r * rng.uniform(0.2, 0.9))
        other = ra.Outline.from_curve([other.rings[0], bore.rings[0]], arcs=[other.arcs[0], bore.arcs[0]])
    return beside("circles", plate(one), other, (0.0, 0.0), rim, 4 * r)


CHAINS = (near_radii, chains, whole_circles)
