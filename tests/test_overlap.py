"""Overlap kernel against shapely, exact rational arithmetic, and its own invariances.

The oracle: both outlines placed in double precision relative to A's body, intersected by GEOS (OverlayNG through
shapely, on arrays); its polygons' areas, first moments and number are compared with the kernel's regions.
"""

from __future__ import annotations

import math
import os
import subprocess
import sys
from collections.abc import Callable
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

import rigidarea as ra

Found = Any  # conftest's record of the regions of many pairs

#: Pairs a kind; the whole of KINDS times this is the number in `make test`.
PAIRS = int(os.environ.get("PAIRS", "1500"))
AREA_TOLERANCE = 1e-9  # of the smaller outline's area (the figure)
EPS = 2.0**-52


# --- outlines ---


def radial(rng: np.random.Generator, n: int, jag: float) -> np.ndarray:
    """A star-shaped ring about 0, radii 1 - jag to 1."""
    t = 2 * np.pi * (np.arange(n) + rng.uniform(-0.35, 0.35, n)) / n
    r = 1 - jag * rng.random(n)
    return np.stack([r * np.cos(t), r * np.sin(t)], axis=1)


def star(points: int, inner: float) -> np.ndarray:
    t = np.pi * np.arange(2 * points) / points
    r = np.where(np.arange(2 * points) % 2, inner, 1.0)
    return np.stack([r * np.cos(t), r * np.sin(t)], axis=1)


def comb(teeth: int, gap: float, length: float) -> np.ndarray:
    """A back with teeth downwards, 2 wide."""
    w = 2.0 / (teeth + (teeth - 1) * gap)
    ring = [(-1.0, 0.3), (-1.0, -length)]
    x = -1.0
    for i in range(teeth):
        ring += [(x + w, -length)]
        if i < teeth - 1:
            ring += [(x + w, 0.0), (x + w * (1 + gap), 0.0), (x + w * (1 + gap), -length)]
        x += w * (1 + gap)
    return np.array(ring + [(1.0, 0.3)])[::-1]


def split(rng: np.random.Generator, ring: np.ndarray, most: int = 3) -> np.ndarray:
    """The same ring with up to `most` further vertices on each edge (collinear to rounding)."""
    following = np.roll(ring, -1, axis=0)
    parts = []
    for p, q in zip(ring, following):
        t = np.concatenate([[0.0], np.sort(rng.random(rng.integers(0, most + 1)))])
        parts.append(p + t[:, None] * (q - p))
    return np.concatenate(parts)


def polyomino(rng: np.random.Generator, size: int, fill: float) -> list[ra.Outline]:
    """Connected unions of unit cells, with every degeneracy: holes, holes that touch a ring in a vertex."""
    cells = np.argwhere(rng.random((size, size)) < fill)
    whole = shapely.union_all(shapely.box(cells[:, 0], cells[:, 1], cells[:, 0] + 1, cells[:, 1] + 1))
    if rng.random() < 0.5:  # all lattice points kept as vertices, or corners only
        whole = shapely.simplify(whole, 0.0)
    middle = (size // 2, size // 2)
    parts = [p for p in shapely.get_parts(whole) if p.area > 1.5]
    return [ra.Outline.from_shapely(shapely.transform(p, lambda xy: xy - middle)) for p in parts]


def box(w: float, h: float, x: float = 0.0, y: float = 0.0) -> np.ndarray:
    return np.array(
        [(x - w / 2, y - h / 2), (x + w / 2, y - h / 2), (x + w / 2, y + h / 2), (x - w / 2, y + h / 2)]
    )


def gear(teeth: int) -> np.ndarray:
    """Something like a gear, 10 points a tooth."""
    t = 2 * np.pi * np.arange(10 * teeth) / (10 * teeth)
    r = 1.0 + np.tanh(3 * np.sin(teeth * t)) * 1.1 / teeth
    return np.stack([r * np.cos(t), r * np.sin(t)], axis=1)


# --- pairs: each kind is (outlines A, outlines B, poses A, poses B) ---


class Pairs(NamedTuple):
    outlines: list[Any]
    ia: np.ndarray
    ib: np.ndarray
    pa: np.ndarray
    pb: np.ndarray


def turned(angle: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    return np.stack([x, y, np.cos(angle), np.sin(angle)], axis=1)


def scattered(rng: np.random.Generator, n: int, a: list[Any], b: list[Any], reach: float = 1.6) -> Pairs:
    """Any of a with any of b, at any angle, middles up to `reach` apart; A somewhere, also turned."""
    at = rng.uniform(-5, 5, (n, 2))
    r, t = reach * np.sqrt(rng.random(n)), rng.uniform(0, 2 * np.pi, n)
    return Pairs(
        a + b,
        rng.integers(0, len(a), n),
        len(a) + rng.integers(0, len(b), n),
        turned(rng.uniform(0, 2 * np.pi, n), at[:, 0], at[:, 1]),
        turned(rng.uniform(0, 2 * np.pi, n), at[:, 0] + r * np.cos(t), at[:, 1] + r * np.sin(t)),
    )


def convex(rng: np.random.Generator, n: int) -> Pairs:
    def one(most: int) -> Any:
        t = np.sort(rng.uniform(0, 2 * np.pi, rng.integers(3, most)))
        ring = np.stack([np.cos(t), rng.uniform(0.1, 1) * np.sin(t)], axis=1)
        return ra.Outline(ring)

    small, large = [one(9) for _ in range(40)], [one(60) for _ in range(20)]
    return scattered(rng, n, small + large, small + large)


def concave(rng: np.random.Generator, n: int) -> Pairs:
    a = [ra.Outline(radial(rng, int(rng.integers(5, 40)), rng.uniform(0.2, 0.95))) for _ in range(60)]
    return scattered(rng, n, a, a)


def holes(rng: np.random.Generator, n: int) -> Pairs:
    def one() -> Any:
        ring = radial(rng, int(rng.integers(12, 30)), 0.2)
        if rng.random() < 0.5:
            return ra.Outline(ring, [0.65 * radial(rng, int(rng.integers(9, 20)), 0.6)])
        middles = 0.45 * star(2, 1.0)
        return ra.Outline(ring, [m + rng.uniform(0.05, 0.2) * radial(rng, 7, 0.5) for m in middles])

    a = [one() for _ in range(50)]
    return scattered(rng, n, a, a, 1.3)


def bar_on_u(rng: np.random.Generator, n: int) -> Pairs:
    us, bars = [], []
    for _ in range(20):
        w, d = rng.uniform(0.05, 0.6), rng.uniform(0.2, 1.5)
        us.append(
            ra.Outline(
                [
                    (-1, -d - 0.3),
                    (1, -d - 0.3),
                    (1, 0),
                    (1 - w, 0),
                    (1 - w, -d),
                    (-1 + w, -d),
                    (-1 + w, 0),
                    (-1, 0),
                ]
            )
        )
        bars.append(ra.Outline(box(rng.uniform(1.0, 4), rng.uniform(0.02, 0.3))))
    pairs = scattered(rng, n, us, bars, 0.0)
    return pairs._replace(
        pa=turned(np.zeros(n), np.zeros(n), np.zeros(n)),
        pb=turned(rng.normal(0, 0.1, n), rng.normal(0, 0.3, n), rng.normal(0, 0.1, n)),
    )


def stars(rng: np.random.Generator, n: int) -> Pairs:
    a = [ra.Outline(star(int(rng.integers(3, 12)), rng.uniform(0.05, 0.8))) for _ in range(40)]
    return scattered(rng, n, a, a, 1.0)


def combs(rng: np.random.Generator, n: int) -> Pairs:
    a = [
        ra.Outline(comb(int(rng.integers(2, 12)), rng.uniform(0.3, 2), rng.uniform(0.3, 2)))
        for _ in range(30)
    ]
    pairs = scattered(rng, n, a, a, 1.0)
    angle = np.where(rng.random(n) < 0.5, np.pi, np.pi / 2) + rng.normal(0, 0.05, n)
    zero = np.zeros(n)
    return pairs._replace(
        pa=turned(zero, zero, zero), pb=turned(angle, rng.normal(0, 0.5, n), rng.normal(-1, 0.5, n))
    )


def crossed_bars(rng: np.random.Generator, n: int) -> Pairs:
    a = [ra.Outline(box(rng.uniform(1, 3), 10 ** rng.uniform(-4, -0.5))) for _ in range(40)]
    return scattered(rng, n, a, a, 0.4)


def inside(rng: np.random.Generator, n: int) -> Pairs:
    large = [ra.Outline(radial(rng, int(rng.integers(4, 40)), 0.3)) for _ in range(30)]
    small = [
        ra.Outline(10 ** rng.uniform(-4, -0.6) * radial(rng, int(rng.integers(3, 20)), 0.5))
        for _ in range(30)
    ]
    pairs = scattered(rng, n, large, small, 0.6)
    swap = rng.random(n) < 0.5
    return Pairs(
        pairs.outlines,
        np.where(swap, pairs.ib, pairs.ia),
        np.where(swap, pairs.ia, pairs.ib),
        np.where(swap[:, None], pairs.pb, pairs.pa),
        np.where(swap[:, None], pairs.pa, pairs.pb),
    )


def in_a_hole(rng: np.random.Generator, n: int) -> Pairs:
    rings = [ra.Outline(radial(rng, 20, 0.2), [0.7 * radial(rng, 16, 0.1)]) for _ in range(30)]
    small = [
        ra.Outline(rng.uniform(0.1, 0.75) * radial(rng, int(rng.integers(3, 20)), 0.4)) for _ in range(30)
    ]
    return scattered(rng, n, rings, small, 0.45)


def lattice(rng: np.random.Generator, n: int, half: bool = True) -> Pairs:
    """Everything touches everything: shared edges, vertices on vertices and on edges, exactly."""
    a = [p for _ in range(40) for p in polyomino(rng, int(rng.integers(2, 7)), rng.uniform(0.4, 0.8))]
    step = rng.choice([0.5, 1.0], n) if half else np.ones(n)
    shift = rng.integers(-2, 3, (n, 2)) * step[:, None]
    quarter = np.array([(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)])
    qa, qb = quarter[rng.integers(0, 4, n)], quarter[rng.integers(0, 4, n)]
    ia, ib = rng.integers(0, len(a), n), rng.integers(0, len(a), n)
    return Pairs(a, ia, ib, np.concatenate([np.zeros((n, 2)), qa], 1), np.concatenate([shift, qb], 1))


def lattice_turned(rng: np.random.Generator, n: int) -> Pairs:
    """The same after a common turn: degenerate to rounding only."""
    pairs = lattice(rng, n)
    return moved(pairs, rng.uniform(0, 2 * np.pi, n), rng.uniform(-5, 5, (n, 2)))


def moved(pairs: Pairs, angle: np.ndarray, shift: np.ndarray) -> Pairs:
    """A rigid motion of both bodies: turned about the origin, then shifted."""
    c, s = np.cos(angle), np.sin(angle)

    def move(p: np.ndarray) -> np.ndarray:
        return np.stack(
            [
                c * p[:, 0] - s * p[:, 1] + shift[:, 0],
                s * p[:, 0] + c * p[:, 1] + shift[:, 1],
                c * p[:, 2] - s * p[:, 3],
                s * p[:, 2] + c * p[:, 3],
            ],
            axis=1,
        )

    return pairs._replace(pa=move(pairs.pa), pb=move(pairs.pb))


def triangles_on_lattice(rng: np.random.Generator, n: int) -> Pairs:
    """Triangles and quadrilaterals with small integer corners: slanted edges through each other's vertices."""
    a = []
    while len(a) < 80:
        ring = rng.integers(-3, 4, (int(rng.integers(3, 6)), 2)).astype(float)
        try:
            a.append(ra.Outline(ring))
        except ValueError:
            continue
    pairs = lattice(rng, n, half=False)
    return pairs._replace(outlines=a, ia=rng.integers(0, len(a), n), ib=rng.integers(0, len(a), n))


def collinear(rng: np.random.Generator, n: int) -> Pairs:
    """An outline over itself, the edges of both split differently: all edges shared, to rounding."""
    rings = [radial(rng, int(rng.integers(4, 20)), 0.6) for _ in range(25)] + [box(2, 1) for _ in range(5)]
    a = [ra.Outline(split(rng, r)) for r in rings]
    b = [ra.Outline(split(rng, r)) for r in rings]
    i = rng.integers(0, len(a), n)
    t = rng.uniform(0, 2 * np.pi, n)
    at = rng.uniform(-5, 5, (n, 2))
    near = at + rng.choice([0.0, 1e-16, 1e-13, 1e-9, 1e-3], n)[:, None] * rng.normal(size=(n, 2))
    return Pairs(a + b, i, len(a) + i, turned(t, at[:, 0], at[:, 1]), turned(t, near[:, 0], near[:, 1]))


def blunt(rng: np.random.Generator, n: int) -> Pairs:
    """Corners cut off a few roundings wide, poked through edges: crossings that rounding puts in one place.

    With 9 corners and more cut off: large enough for the general way, convex or not.
    """
    return _blunt(rng, n, 9)


def blunt_convex(rng: np.random.Generator, n: int) -> Pairs:
    """The same with few corners, of which many pairs are convex and clipped."""
    return _blunt(rng, n, 3)


def _blunt(rng: np.random.Generator, n: int, least: int) -> Pairs:

    def cut(ring: np.ndarray) -> np.ndarray:
        before, after = np.roll(ring, 1, axis=0) - ring, np.roll(ring, -1, axis=0) - ring
        width = 10 ** rng.uniform(-15, -12, (len(ring), 1))
        return np.stack([ring + width * before, ring + width * after], axis=1).reshape(-1, 2)

    corners = rng.integers(least, least + 6, (2, 30))
    a = [ra.Outline(cut(radial(rng, int(m), 0.7))) for m in corners[0]]
    b = [ra.Outline(rng.choice([1, 20]) * radial(rng, int(m), 0.7)) for m in corners[1]]
    pairs = scattered(rng, n, a, b + a, 1.2)
    # put one of A's corners, exactly or nearly, on the middle of one of B's edges
    for k in range(n):
        ra_, rb = pairs.outlines[pairs.ia[k]].rings[0], pairs.outlines[pairs.ib[k]].rings[0]
        i, j = rng.integers(0, len(ra_)), rng.integers(0, len(rb))
        p, q = ra_[i], rb[j] + rng.random() * (rb[(j + 1) % len(rb)] - rb[j])
        x, y, c, s = pairs.pa[k]
        cb, sb = pairs.pb[k, 2:]
        jitter = rng.choice([0, 1e-16, 1e-15, 1e-14]) * rng.normal(size=2)
        pairs.pb[k, 0] = x + c * p[0] - s * p[1] - (cb * q[0] - sb * q[1]) + jitter[0]
        pairs.pb[k, 1] = y + s * p[0] + c * p[1] - (sb * q[0] + cb * q[1]) + jitter[1]
    return pairs


def vertex_on_edge(rng: np.random.Generator, n: int) -> Pairs:
    """One of A's corners on one of B's edges or corners, to rounding."""
    a = [ra.Outline(radial(rng, int(rng.integers(3, 20)), rng.uniform(0.1, 0.8))) for _ in range(40)]
    pairs = scattered(rng, n, a, a, 1.2)
    for k in range(n):
        ra_, rb = pairs.outlines[pairs.ia[k]].rings[0], pairs.outlines[pairs.ib[k]].rings[0]
        i, j = rng.integers(0, len(ra_)), rng.integers(0, len(rb))
        along = rng.choice([0.0, rng.random()])
        p, q = ra_[i], rb[j] + along * (rb[(j + 1) % len(rb)] - rb[j])
        x, y, c, s = pairs.pa[k]
        cb, sb = pairs.pb[k, 2:]
        pairs.pb[k, 0] = x + c * p[0] - s * p[1] - (cb * q[0] - sb * q[1])
        pairs.pb[k, 1] = y + s * p[0] + c * p[1] - (sb * q[0] + cb * q[1])
    return pairs


def ulps(rng: np.random.Generator, n: int) -> Pairs:
    """Lattice outlines, every coordinate off by a few roundings."""
    a = []
    for outline in lattice(rng, 1).outlines + triangles_on_lattice(rng, 1).outlines:
        noisy = [r + rng.integers(-3, 4, r.shape) * EPS * np.abs(r).max() for r in outline.rings]
        try:
            a.append(ra.Outline(noisy[0], noisy[1:]))
        except ValueError:
            continue  # holes that touched now cross
    pairs = lattice(rng, n)
    return pairs._replace(outlines=a, ia=rng.integers(0, len(a), n), ib=rng.integers(0, len(a), n))


def gears(rng: np.random.Generator, n: int) -> Pairs:
    n = max(n // 5, 4)
    a = [ra.Outline(gear(k), [0.4 * star(7, 0.9)]) for k in (11, 23, 57)]
    pairs = scattered(rng, n, a, a, 0.0)
    zero = np.zeros(n)
    t = rng.uniform(0, 2 * np.pi, n)
    r = rng.uniform(1.85, 2.2, n)
    return pairs._replace(
        pa=turned(t, zero, zero), pb=turned(rng.uniform(0, 6, n), r * np.cos(t), r * np.sin(t))
    )


def far(rng: np.random.Generator, n: int) -> Pairs:
    """1e6 from the origin; A's outline besides 1e6 from its body's origin, as far back. Same outlines as `concave`."""
    pairs = concave(rng, n)
    shift = np.round(rng.uniform(-1, 1, (n, 2)) * 1e6)
    return pairs._replace(
        pa=pairs.pa + np.pad(shift, ((0, 0), (0, 2))), pb=pairs.pb + np.pad(shift, ((0, 0), (0, 2)))
    )


def slivers(rng: np.random.Generator, n: int) -> Pairs:
    """1 by 1e-10 (2^-33), axis-aligned at dyadic places: shapely is exact here too."""
    thin = 2.0**-33
    a = [
        ra.Outline(box(1, thin)),
        ra.Outline(box(thin, 1)),
        ra.Outline(box(1, 1)),
        ra.Outline(box(0.5, thin / 2)),
    ]
    pairs = scattered(rng, n, a, a, 0.0)
    shift = rng.integers(-64, 65, (n, 2)) / 128.0
    shift *= rng.choice([1.0, thin], (n, 2))
    zero = np.zeros(n)
    return pairs._replace(
        ib=rng.integers(0, 4, n), pa=turned(zero, zero, zero), pb=turned(zero, shift[:, 0], shift[:, 1])
    )


KINDS: dict[str, Callable[[np.random.Generator, int], Pairs]] = {
    f.__name__: f
    for f in (
        convex, concave, holes, bar_on_u, stars, combs, crossed_bars, inside, in_a_hole, lattice, lattice_turned,
        triangles_on_lattice, collinear, blunt, blunt_convex, vertex_on_edge, ulps, gears, far, slivers,
    )
}  # fmt: skip


# --- the oracle ---


def placed(polygons: np.ndarray, poses: np.ndarray, origin: np.ndarray) -> np.ndarray:
    """Polygons at poses, relative to `origin`."""
    xy, which = shapely.get_coordinates(polygons, return_index=True)
    c, s = poses[which, 2], poses[which, 3]
    at = (poses[:, :2] - origin)[which]
    turned_xy = np.stack([c * xy[:, 0] - s * xy[:, 1], s * xy[:, 0] + c * xy[:, 1]], axis=1)
    return shapely.set_coordinates(polygons.copy(), turned_xy + at)


def first_moment(polygons: np.ndarray) -> np.ndarray:
    return shapely.get_coordinates(shapely.centroid(polygons)) * shapely.area(polygons)[:, None]


class Truth(NamedTuple):
    a: np.ndarray  # placed polygons
    b: np.ndarray
    both: np.ndarray
    area: np.ndarray  # (n,)
    moment: np.ndarray  # (n, 2)
    count: np.ndarray  # (n,)
    smaller: np.ndarray  # (n,) smaller outline's area
    size: np.ndarray  # (n,) its extent


def truth(pairs: Pairs) -> Truth:
    shapes = np.array([o.polygon for o in pairs.outlines])
    origin = pairs.pa[:, :2]
    a = placed(shapes[pairs.ia], pairs.pa, origin)
    b = placed(shapes[pairs.ib], pairs.pb, origin)
    both = shapely.intersection(a, b)
    parts, of = shapely.get_parts(both, return_index=True)
    real = shapely.area(parts) > 0  # points and lines in common, empty intersections: no regions
    parts, of = parts[real], of[real]
    n = len(a)
    area = np.bincount(of, shapely.area(parts), minlength=n)
    moment = first_moment(parts) if len(parts) else np.zeros((0, 2))
    moments = np.stack([np.bincount(of, moment[:, k], minlength=n) for k in (0, 1)], axis=1)
    bounds = np.stack([shapely.bounds(a), shapely.bounds(b)])
    size = (bounds[..., 2:] - bounds[..., :2]).max(axis=-1).min(axis=0)
    smaller = np.minimum(shapely.area(a), shapely.area(b))
    return Truth(a, b, both, area, moments, np.bincount(of, minlength=n), smaller, size)


def certain_count(a: Any, b: Any, size: float) -> int | None:
    """Number of regions, where no region, neck or gap is thinner than 1e-9 of the size; else None.

    Growing both outlines by 1e-9 closes gaps and widens necks of no width, shrinking them opens necks: a count that
    survives both is certain. Regions that come up thin in either are those of outlines that only touch.
    """
    counts = set()
    for t in (1e-9 * size, -1e-9 * size):
        parts = shapely.get_parts(
            a.buffer(t, join_style="mitre").intersection(b.buffer(t, join_style="mitre"))
        )
        counts.add(sum(p.area > 1e-8 * size * p.length for p in parts))
    return counts.pop() if len(counts) == 1 else None


Ring = list[tuple[Fraction, Fraction]]


def clipped(ring: Ring, a: tuple[Fraction, Fraction], b: tuple[Fraction, Fraction]) -> Ring:
    """The part of a convex ring to the left of a -> b, exactly."""
    heights = [(b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]) for x, y in ring]
    out = []
    for i, (x, y) in enumerate(ring):
        h, g = heights[i], heights[i - 1]
        if (h > 0 > g) or (g > 0 > h):
            t = g / (g - h)
            u, v = ring[i - 1]
            out.append((u + t * (x - u), v + t * (y - v)))
        if h >= 0:
            out.append((x, y))
    return out


def moments(ring: Ring) -> tuple[Fraction, Fraction, Fraction]:
    area = mx = my = Fraction(0)
    for (x, y), (u, v) in zip(ring, ring[1:] + ring[:1]):
        cross = x * v - u * y
        area += cross / 2
        mx += (x + u) * cross / 6
        my += (y + v) * cross / 6
    return area, mx, my


def triangles(polygon: Any) -> list[tuple[int, Ring]]:
    """Signed triangles that add up to the polygon, holes included."""
    out = []
    for k, ring in enumerate((polygon.exterior, *polygon.interiors)):
        xy = [(Fraction(x), Fraction(y)) for x, y in ring.coords[:-1]]
        turn = 1 if (moments(xy)[0] > 0) == (k == 0) else -1
        for p, q in pairwise(xy[1:]):
            area = moments([xy[0], p, q])[0]
            if area:
                out.append((turn if area > 0 else -turn, [xy[0], p, q] if area > 0 else [xy[0], q, p]))
    return out


def exactly(a: Any, b: Any) -> tuple[float, np.ndarray]:
    """Area and first moment of the intersection of two polygons in rational arithmetic: no rounding, no cases.

    Both polygons are sums of signed triangles; triangles are clipped by triangles.
    """
    total = [Fraction(0)] * 3
    right = triangles(b)
    for sign_a, t in triangles(a):
        low, high = [min(c) for c in zip(*t)], [max(c) for c in zip(*t)]
        for sign_b, u in right:
            if any(max(c) <= l or min(c) >= h for c, l, h in zip(zip(*u), low, high)):
                continue
            ring = t
            for i in range(3):
                ring = clipped(ring, u[i], u[(i + 1) % 3])
            if len(ring) > 2:
                total = [s + sign_a * sign_b * m for s, m in zip(total, moments(ring))]
    return float(total[0]), np.array([float(total[1]), float(total[2])])


class Report(NamedTuple):
    pairs: int
    overlapping: int
    area_error: float  # worst, of the smaller outline's area
    moment_error: (
        float  # worst first moment about the true centroid, of the smaller outline's area times its size
    )
    arbitrated: int  # pairs that rational arithmetic decided, because the kernel and GEOS differ
    wrong: list[int]  # pairs whose number of regions is certain, and not the kernel's
    undecided: int


def compared(kernel: Any, pairs: Pairs) -> Report:
    found = kernel.many(*pairs)
    true = truth(pairs)
    area_true, moment_true = true.area.copy(), true.moment.copy()
    arbitrated = np.flatnonzero(np.abs(found.total(found.area) - true.area) > AREA_TOLERANCE * true.smaller)
    for i in arbitrated[:20]:  # more than a handful are no accident
        area_true[i], moment_true[i] = exactly(true.a[i], true.b[i])
    area = np.abs(found.total(found.area) - area_true) / true.smaller
    middle = (
        moment_true / np.where(area_true > 0, area_true, 1.0)[:, None]
    )  # about it both moments are to vanish
    off = (found.centroid - middle[found.pair]) * found.area[:, None]
    moment = np.hypot(found.total(off[:, 0]), found.total(off[:, 1])) / (true.smaller * true.size)
    # regions of a mean width below 1e-9 of the size, ours alone or shapely's alone, count for nothing
    thick = found.area > 1e-9 * true.size[found.pair] * found.extent
    count = np.where(found.count < 0, -1, np.bincount(found.pair[thick], minlength=len(area)))
    differ = np.flatnonzero(count != true.count)
    wrong = [
        int(i) for i in differ if certain_count(true.a[i], true.b[i], true.size[i]) not in (None, count[i])
    ]
    return Report(
        len(area), int((area_true > 0).sum()), float(area.max()), float(moment.max()), len(arbitrated),
        wrong, int((found.count < 0).sum()),
    )  # fmt: skip


# --- against the oracles ---


def rng_of(kind: str, seed: int) -> np.random.Generator:
    return np.random.default_rng([seed, *kind.encode()])


def check(kernel: Any, kind: str, n: int, seed: int, record: Any) -> None:
    report = compared(kernel, KINDS[kind](rng_of(kind, seed), n))
    record("overlap_area", report.area_error)
    record("overlap_moment", report.moment_error)
    record("count_overlap_pairs", report.pairs)
    record("count_overlap_wrong", len(report.wrong) + report.undecided)
    assert report.undecided == 0
    assert report.area_error <= AREA_TOLERANCE
    assert report.moment_error <= AREA_TOLERANCE
    assert report.wrong == []
    assert n < 500 or report.overlapping >= 0.4 * report.pairs  # the test is about overlaps
    assert report.arbitrated <= 2 + 0.002 * report.pairs  # else GEOS is no oracle here


@pytest.mark.shown
@pytest.mark.parametrize("kind", KINDS)
def test_area_centroid_and_count_against_shapely(kernel: Any, kind: str, record_property: Any) -> None:
    check(kernel, kind, PAIRS, 1, record_property)


@pytest.mark.slow
@pytest.mark.shown
@pytest.mark.parametrize("kind", KINDS)
def test_area_centroid_and_count_of_100_000_pairs(kernel: Any, kind: str, record_property: Any) -> None:
    check(kernel, kind, 8000, 2, record_property)


def test_hole_that_hangs_on_a_vertex_of_its_region(kernel: Any) -> None:
    """A hole loop whose first vertex lies on the region's boundary still belongs to it, with other regions about."""
    ring = [(-3, -3), (2, -3), (2, -2), (3, -2), (3, 2), (2, 2), (2, 3), (-3, 3)]
    holes = [
        [
            (-1, 2),
            (0, 2),
            (0, 0),
            (1, 0),
            (1, -1),
            (0, -1),
            (0, -2),
            (-1, -2),
            (-1, -1),
            (-2, -1),
            (-2, 0),
            (-1, 0),
        ],
        [(2, 0), (1, 0), (1, 1), (2, 1)],
    ]
    b = [(-1, -2), (-3, -2), (-3, -3), (0, -3), (0, -2), (1, -2), (1, 0), (3, 0), (3, 2), (2, 2)]
    b += [(2, 3), (0, 3), (0, 2), (1, 2), (1, 1), (-1, 1), (-1, 0), (-2, 0), (-2, -1), (-1, -1)]
    found = kernel.one(ra.Outline(ring, holes), (0, 0, 1, 0), ra.Outline(b), (1, 0.5, -1, 0))
    assert found.area.sum() == 8.5


def test_no_region_without_area(kernel: Any) -> None:
    """Corners on edges to rounding: what rounding leaves there has no area, and never a negative one."""
    rng = np.random.default_rng(1)
    for kind in (vertex_on_edge, blunt, triangles_on_lattice):
        found = kernel.many(*kind(rng, 4 * PAIRS))
        assert (found.area > 0).all()
        assert np.isfinite(found.centroid).all() and np.isfinite(found.chord).all()


# --- slivers: shapely's own rounding shows there, so rational arithmetic is the oracle ---


def test_axis_aligned_slivers_exactly(kernel: Any) -> None:
    """1 by 2^-33 (1.2e-10) at dyadic places: nothing rounds, so the area is the exact product to the last digits."""
    rng = np.random.default_rng(3)
    thin = 2.0**-33
    flat = ra.Outline(
        np.concatenate(
            [[(-0.5 + k / 16, -thin / 2) for k in range(17)], [(0.5 - k / 16, thin / 2) for k in range(17)]]
        )
    )
    kinds = [
        (ra.Outline(box(1, thin)), 1, thin),
        (ra.Outline(box(thin, 1)), thin, 1),
        (flat, 1, thin),
        (ra.Outline(box(1, 1)), 1, 1),
    ]
    for _ in range(PAIRS):
        (a, wa, ha), (b, wb, hb) = (kinds[i] for i in rng.integers(0, 4, 2))
        x, y = rng.integers(-40, 41, 2) / 64 * rng.choice([1.0, thin], 2)
        found = kernel.one(a, (0, 0, 1, 0), b, (x, y, 1, 0))
        sides = [
            max(
                Fraction(0),
                min(Fraction(p) / 2, Fraction(at) + Fraction(q) / 2)
                - max(-Fraction(p) / 2, Fraction(at) - Fraction(q) / 2),
            )
            for p, q, at in ((wa, wb, x), (ha, hb, y))
        ]
        area = float(sides[0] * sides[1])
        assert len(found.area) == (area > 0)
        assert abs(found.area.sum() - area) <= 8 * EPS * area


def test_slivers_at_any_angle(kernel: Any) -> None:
    """Slivers 1 by 1e-10 that cross slivers and squares at any angle, against rational arithmetic.

    A crossing is a point in double precision: rounded by half an ulp of the size, across a sliver of length 1. That
    alone is an area of 1e-16, 1e-6 of a sliver's. So the bound is one of rounding: a few eps size^2, not 1e-9 of
    1e-10 size^2; and it is the same whether the sliver is A or B.
    """
    rng = np.random.default_rng(4)
    worst = 0.0
    for k in range(max(PAIRS // 5, 20)):
        t = rng.uniform(0, 2 * np.pi)
        turn = np.array([[np.cos(t), np.sin(t)], [-np.sin(t), np.cos(t)]])
        a = ra.Outline(box(1, 1e-10) @ turn)
        b = ra.Outline(box(1, 1e-10 if k % 2 else 1) @ turn.T)
        place = (*rng.uniform(-0.4, 0.4, 2), 1.0, 0.0)
        if k % 3 == 0:
            a, b = b, a
        found = kernel.one(a, (0, 0, 1, 0), b, place)
        # the very points that the kernel sees: middles taken off, then placed
        pool = kernel.pool.pack([a, b])
        rel = kernel.overlap.relative(
            0.0, 0.0, 1.0, 0.0, *place, *(float(h[n]) for h in pool.heads for n in "xy")
        )
        ring_a, ring_b = (pool.points[h["point"] :][: h["count"]] for h in pool.heads)
        area, _ = exactly(shapely.Polygon(ring_a), shapely.Polygon(ring_b + (rel.tx, rel.ty)))
        worst = max(worst, abs(found.area.sum() - area))
    print(f"slivers at any angle: worst area error {worst / EPS:.2f} eps size^2")
    assert worst <= 4 * EPS


# --- far away ---


def test_far_from_the_origin(kernel: Any) -> None:
    """1e6 lengths away, by the bodies' positions and by the outlines' own coordinates, areas agree to 1e-6.

    A coordinate of 1e6 is known to 1.2e-10; with boundaries of a few lengths that moves an area by some 1e-9.
    """
    rng = np.random.default_rng(5)
    pairs = concave(rng, PAIRS)
    near = kernel.many(*pairs)
    shift = np.array([1e6, -1e6 / 3])
    body = kernel.many(*pairs._replace(pa=pairs.pa + [*shift, 0, 0], pb=pairs.pb + [*shift, 0, 0]))
    away = [ra.Outline(o.rings[0] + shift) for o in pairs.outlines]

    def back(p: np.ndarray) -> np.ndarray:
        turned_shift = np.stack(
            [p[:, 2] * shift[0] - p[:, 3] * shift[1], p[:, 3] * shift[0] + p[:, 2] * shift[1]], 1
        )
        return np.concatenate([p[:, :2] - turned_shift, p[:, 2:]], axis=1)

    frame = kernel.many(*pairs._replace(outlines=away, pa=back(pairs.pa), pb=back(pairs.pb)))
    area = near.total(near.area)
    large = area > 1e-2 * min(
        o.area for o in pairs.outlines
    )  # a smaller overlap loses digits to positions alone
    assert large.sum() > 0.3 * len(area)
    for other in (body, frame):
        assert np.abs(other.total(other.area) - area)[large].max() <= 1e-6 * area[large].min()
        same = near.count == other.count
        assert same.mean() > 0.999
    chord = [np.stack([f.total(f.chord[:, k]) for k in (0, 1)], 1) for f in (near, body, frame)]
    for other in chord[1:]:
        assert np.abs(other - chord[0])[large & (near.count == 1)].max() <= 1e-6


# --- direction ---


def boundary_integral(a: Any, both: Any, size: float) -> np.ndarray:
    """Integral of A's outward normal over those edges of the intersection that lie on A's boundary (not B's)."""
    total = np.zeros(2)
    for part in shapely.get_parts(both):
        if part.area == 0:
            continue
        for ring in (part.exterior, *part.interiors):
            xy = np.array(ring.coords)
            if shapely.is_ccw(ring) != (ring.equals(part.exterior)):
                xy = xy[::-1]  # solid on the left
            edge = np.diff(xy, axis=0)
            middle = xy[:-1] + 0.5 * edge
            on_a = shapely.distance(shapely.points(middle), a.boundary) < 1e-12 * size
            total += np.array([edge[on_a, 1].sum(), -edge[on_a, 0].sum()])
    return total


SMOOTH = [
    "convex",
    "concave",
    "holes",
    "bar_on_u",
    "stars",
    "combs",
    "crossed_bars",
    "inside",
    "in_a_hole",
    "gears",
]
"""Kinds in general position: no shared edges, along which which outline is inside is rounding's choice."""


@pytest.mark.parametrize("kind", SMOOTH)
def test_chord_is_the_integral_of_the_normal(kernel: Any, kind: str) -> None:
    pairs = KINDS[kind](rng_of(kind, 6), max(PAIRS // 10, 10))
    found, true = kernel.many(*pairs), truth(pairs)
    for i in range(len(pairs.ia)):
        x, y = found.chord[found.pair == i].sum(axis=0)
        normal = boundary_integral(true.a[i], true.both[i], true.size[i])
        assert np.hypot(y - normal[0], -x - normal[1]) <= 1e-9 * true.size[i] * max(1.0, found.count[i])


def test_direction_points_from_a_to_b(kernel: Any) -> None:
    """Two boxes, a box on a floor, a corner in a floor: directions that anybody can see."""
    square, floor = ra.Outline(box(1, 1)), ra.Outline(box(10, 1))
    for b, place, seen in (
        (square, (0.9, 0.1, 0.0), (1, 0)),
        (square, (-0.9, 0.1, 0.0), (-1, 0)),
        (floor, (0.3, -0.98, 0.0), (0, -1)),
        (floor, (0.3, 0.98, np.pi), (0, 1)),
        (floor, (0.0, -1.2, 0.0), (0, -1)),
    ):
        found = kernel.one(square, (0, 0, np.pi / 4 if place[1] == -1.2 else 0), b, place)
        assert len(found.area) == 1
        direction = kernel.direction.chord_direction(*found.chord[0], found.area[0])
        # the boxes of the first rows overlap at a corner: the chord is the diagonal of a 0.1 by 0.9 rectangle
        want = np.array(seen) if abs(place[1]) > 0.5 else np.array([0.9 * seen[0], 0.1]) / np.hypot(0.9, 0.1)
        assert np.allclose(direction, want, atol=1e-12)


# --- invariances ---

kinds = st.sampled_from([k for k in KINDS if k not in ("blunt", "blunt_convex")])
smooth = st.sampled_from(SMOOTH)
seeds = st.integers(0, 2**32 - 1)


def sums(found: Found, about: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Area, first moment about a point for each pair, and chord of each pair."""
    rel = found.centroid - about[found.pair]
    moment = [found.total(found.area * rel[:, k]) for k in (0, 1)]
    chord = [found.total(found.chord[:, k]) for k in (0, 1)]
    return found.total(found.area), np.stack(moment, 1), np.stack(chord, 1)


@given(kinds, seeds)
def test_swapping_a_and_b(kernel: Any, kind: str, seed: int) -> None:
    pairs = KINDS[kind](np.random.default_rng(seed), 20)
    swapped = pairs._replace(ia=pairs.ib, ib=pairs.ia, pa=pairs.pb, pb=pairs.pa)
    between = pairs.pb[:, :2] - pairs.pa[:, :2]
    one, two = sums(kernel.many(*pairs), 0 * between), sums(kernel.many(*swapped), -between)
    scale = np.array(
        [min(pairs.outlines[i].area, pairs.outlines[j].area) for i, j in zip(pairs.ia, pairs.ib)]
    )
    rounding = 1e-11 * scale + 100 * EPS * max(1.0, scale.max())
    assert (np.abs(one[0] - two[0]) <= rounding).all()
    assert (np.abs(one[1] - two[1]) <= 20 * rounding[:, None]).all()
    if kind in SMOOTH:
        assert np.abs(one[2] + two[2]).max() <= 1e-9


@given(smooth, seeds, st.floats(0, 2 * np.pi), st.floats(-100, 100))
def test_common_rigid_motion(kernel: Any, kind: str, seed: int, angle: float, shift: float) -> None:
    pairs = KINDS[kind](np.random.default_rng(seed), 20)
    n = len(pairs.ia)
    there = moved(pairs, np.full(n, angle), np.full((n, 2), shift))
    zero = np.zeros((n, 2))
    one, two = sums(kernel.many(*pairs), zero), sums(kernel.many(*there), zero)
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    tolerance = 1e-11  # positions of 100 known to 1e-14, over boundaries of tens of lengths (combs)
    assert np.abs(one[0] - two[0]).max() <= tolerance
    assert np.abs(one[1] @ turn - two[1]).max() <= 10 * tolerance
    assert np.abs(one[2] @ turn - two[2]).max() <= 1e-9


@given(st.sampled_from(["convex", "concave", "stars", "combs", "crossed_bars"]), seeds)
def test_collinear_vertices_change_nothing(kernel: Any, kind: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    pairs = KINDS[kind](rng, 20)
    finer = [ra.Outline(split(rng, o.rings[0])) for o in pairs.outlines]
    zero = np.zeros((20, 2))
    one, two = sums(kernel.many(*pairs), zero), sums(kernel.many(*pairs._replace(outlines=finer)), zero)
    assert np.abs(one[0] - two[0]).max() <= 1e-12
    assert np.abs(one[1] - two[1]).max() <= 1e-12
    assert np.abs(one[2] - two[2]).max() <= 1e-9


def test_finer_sampling_converges_to_the_lens(kernel: Any) -> None:
    """Two discs sampled by n chords: area to the exact lens as 1/n^2; the chord's direction is right at any n."""
    d, r = 1.7, 1.0
    lens = 2 * r**2 * math.acos(d / (2 * r)) - 0.5 * d * math.sqrt(4 * r**2 - d**2)
    counts = 2 ** np.arange(4, 12)
    errors = []
    for n in counts:
        t = 2 * np.pi * np.arange(n) / n
        disc = ra.Outline(np.stack([np.cos(t), np.sin(t)], 1))
        found = kernel.one(disc, (0, 0, 0.0), disc, (d * np.cos(0.4), d * np.sin(0.4), 2 * 0.4 - np.pi))
        errors.append(abs(found.area.sum() - lens))
        direction = kernel.direction.chord_direction(*found.chord[0], found.area[0])
        assert np.allclose(direction, (np.cos(0.4), np.sin(0.4)), atol=1e-9)  # mirror images of each other
    order = -np.polyfit(np.log(counts[2:]), np.log(errors[2:]), 1)[0]
    assert 1.8 < order < 2.2


@given(seeds)
def test_areas_add_up(kernel: Any, seed: int) -> None:
    """A body cut in two along a diagonal overlaps as much as it did whole."""
    rng = np.random.default_rng(seed)
    ring = radial(rng, int(rng.integers(6, 20)), 0.0)  # convex: every diagonal is inside
    k = int(rng.integers(2, len(ring) - 2))
    whole, b, c = (
        ra.Outline(ring),
        ra.Outline(ring[: k + 1]),
        ra.Outline(np.concatenate([ring[k:], ring[:1]])),
    )
    a = ra.Outline(radial(rng, int(rng.integers(4, 30)), rng.uniform(0, 0.9)))
    place = (*rng.uniform(-1, 1, 2), rng.uniform(0, 6))
    areas = [kernel.one(a, (0, 0, 0.3), part, place).area.sum() for part in (whole, b, c)]
    assert abs(areas[0] - areas[1] - areas[2]) <= 1e-13


# --- determinism ---


def test_same_input_same_bits(kernel: Any) -> None:
    """Whatever was in the scratch before."""
    for kind in KINDS:
        pairs = KINDS[kind](rng_of(kind, 7), 30)
        clean = kernel.many(*pairs)
        dirty = kernel.work(pairs.outlines)
        noise = np.random.default_rng(0)
        for array in dirty:
            array.view(np.uint8).reshape(-1)[:] = noise.integers(0, 256, array.nbytes, dtype=np.uint8)
        again = kernel.many(*pairs, work=dirty)
        for one, two in zip(clean, again):
            assert one.tobytes() == two.tobytes(), kind
        order = noise.permutation(len(pairs.ia))  # nor on which pair was asked for before
        mixed = kernel.many(pairs.outlines, *(array[order] for array in pairs[1:]))
        assert (mixed.count == clean.count[order]).all()
        assert mixed.total(mixed.area).tobytes() == clean.total(clean.area)[order].tobytes(), kind


# --- the predicate ---


def rational_side(a: Any, b: Any, p: Any) -> Fraction:
    (ax, ay), (bx, by), (px, py) = (tuple(map(Fraction, q)) for q in (a, b, p))
    return (ax - px) * (by - py) - (ay - py) * (bx - px)


def triples(n: int) -> Any:
    """Points on, and a few ulps off, lines: small integers, and doubles of many magnitudes."""
    rng = np.random.default_rng(8)
    for i in range(n):
        a, b = (
            rng.integers(-5, 6, (2, 2)).astype(float)
            if i % 2
            else rng.normal(size=(2, 2)) * 10.0 ** rng.integers(-9, 9)
        )
        p = a + rng.choice([0.0, 0.5, 1.0, 2.0, rng.random()]) * (b - a)
        p = p + rng.integers(-2, 3, 2) * np.maximum(
            np.spacing(p), 1e-3 * EPS * np.abs(b - a).max()
        ) * rng.choice([0, 1, 1000])
        yield tuple(map(float, a)), tuple(map(float, b)), tuple(map(float, p))


def test_side_is_exact_and_ties_are_a_shift_of_b(kernel: Any) -> None:
    """The sign is that of rational arithmetic with B shifted by (d, d^2), d too small to matter otherwise."""
    side = kernel.predicates.side
    d = Fraction(1, 2**400)
    ties = 0
    for a, b, p in triples(20 * PAIRS):
        exact = rational_side(a, b, p)
        ties += exact == 0
        for point_of_b in (True, False):
            shift = d if point_of_b else -d
            # the shift of the edge by (-d, -d^2) is one of the point by (d, d^2), and the other way round
            moved_p = (Fraction(p[0]) + shift, Fraction(p[1]) + (d * d if point_of_b else -d * d))
            want = rational_side(a, b, moved_p)
            got = side(*a, *b, *p, point_of_b)
            if a == b:  # no edge
                continue
            assert (got > 0) == (want > 0) and got != 0.0
            assert exact == 0 or (got > 0) == (exact > 0)
            assert (side(*b, *a, *p, point_of_b) > 0) != (
                got > 0
            )  # the other way along the edge, the other side
        if exact == 0 and a != b:
            assert (side(*a, *b, *p, True) > 0) != (side(*a, *b, *p, False) > 0)
    assert ties > 2 * PAIRS


# --- the public function ---


def test_overlap_function_says_what_the_kernel_says(kernel: Any) -> None:
    rng = np.random.default_rng(9)
    for kind in ("convex", "holes", "bar_on_u", "stars", "inside"):
        pairs = KINDS[kind](rng, 10)
        found = kernel.many(*pairs)
        for i in range(10):
            pa, pb = ((*p[:2], math.atan2(p[3], p[2])) for p in (pairs.pa[i], pairs.pb[i]))
            regions = ra.overlap(pairs.outlines[pairs.ia[i]], pa, pairs.outlines[pairs.ib[i]], pb)
            mine = found.pair == i
            assert len(regions) == found.count[i]
            assert np.allclose(regions["area"], found.area[mine], rtol=1e-12, atol=1e-15)
            assert np.allclose(regions["centroid"], found.centroid[mine] + pa[:2], atol=1e-12)
            assert np.allclose(np.hypot(*regions["direction"].T), 1.0)
            for region in regions:  # the outer boundary: with a hole it encloses more
                assert shapely.Polygon(region["polygon"]).area >= region["area"] * (1 - 1e-12)
                assert shapely.is_ccw(shapely.LinearRing(region["polygon"]))


def test_overlap_function_refuses_what_is_no_outline() -> None:
    outline = ra.Outline(box(1, 1))
    for args in (
        ([(0, 0), (1, 0), (1, 1)], (0, 0, 0), outline, (0, 0, 0)),
        (outline, (0, 0), outline, (0, 0, 0)),
        (outline, (0, 0, 0), outline, (0, math.nan, 0)),
    ):
        with pytest.raises(ValueError, match=r"outline_a|place_a|place_b"):
            ra.overlap(*args)


# --- without compilation ---


@pytest.mark.skipif(bool(os.environ.get("NUMBA_DISABLE_JIT")), reason="this is the run without compilation")
def test_the_same_without_compilation() -> None:
    """The kernels' tests again as plain Python, with fewer pairs: either alone proves half."""
    here = Path(__file__).parent
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1", "PAIRS": "12"}
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "-m",
        "not slow",
        "--maxfail=3",
        "-p",
        "no:cacheprovider",
    ]
    files = [str(here / "test_overlap.py"), str(here / "test_force.py")]
    done = subprocess.run(command + files, cwd=here.parent, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-2000:]
