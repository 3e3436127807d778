"""Pairs of outlines that touch along a tangent or coincide, by construction, and their exact overlap.

Where B stands exactly, the area is known in closed form. Moved by a little s, it grows, to first order, by the flux of
s through B's boundary: all of it where that boundary lies inside A, of coincident boundaries only what moves into A
(the solids lie on opposite sides) or out of it (on the same side). What is left out is the area of segments that a
tangent cuts off at a depth of |s|: `rest`, 2 sqrt(2 r) |s|^1.5 a tangent, 1e-13 of the size for |s| = 1e-9.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

import rigidarea as ra
from rigidarea import shapes
from rigidarea.geometry import arcs as ring_arcs

Pieces = tuple[
    np.ndarray, np.ndarray, np.ndarray
]  # starts (n, 2), ends (n, 2), arcs (n, 3) of B, at B's own place
NONE: Pieces = (np.zeros((0, 2)), np.zeros((0, 2)), np.zeros((0, 3)))


class Pair(NamedTuple):
    """A pair and its area where B stands at `place` (x, y) in A's frame, unturned."""

    family: str
    a: ra.Outline
    b: ra.Outline
    place: tuple[float, float]
    area: float
    inside: np.ndarray  # (2,) sum of end - start over B's boundary inside A (length)
    against: Pieces  # of B's boundary that coincides with A's, solids on opposite sides
    along: Pieces  # on the same side
    counts: tuple[int, ...]  # of regions, where B stands exactly; more may appear where it is moved
    flat: float  # largest radius that a tangent cuts a segment off (length)

    def area_at(self, s: np.ndarray) -> np.ndarray:
        """Area (n,) with B moved by s (n, 2), to first order."""
        area = self.area + s[:, 0] * self.inside[1] - s[:, 1] * self.inside[0]
        for pieces, sign in ((self.against, 1.0), (self.along, -1.0)):
            chord = (pieces[1] - pieces[0]).sum(0)
            area = area + 0.5 * (s[:, 0] * chord[1] - s[:, 1] * chord[0] + sign * swept(pieces, s))
        return area

    def rest(self, s: np.ndarray) -> np.ndarray:
        """What `area_at` may leave out (n,)."""
        return 8 * math.sqrt(2 * self.flat) * np.hypot(*s.T) ** 1.5


def swept(pieces: Pieces, s: np.ndarray) -> np.ndarray:
    """Integral of |s . n| (n,) along the pieces."""
    p, q, arcs = pieces
    total = np.zeros(len(s))
    toward, size = np.arctan2(s[:, 1], s[:, 0]), np.hypot(*s.T)
    for start, end, (x, y, r) in zip(p, q, arcs):
        if r == 0:
            d = end - start
            total += np.abs(s[:, 0] * d[1] - s[:, 1] * d[0])
            continue
        low = math.atan2(start[1] - y, start[0] - x)
        high = math.atan2(end[1] - y, end[0] - x)
        if r < 0:
            low, high = high, low
        high += 2 * math.pi * (high <= low)
        total += abs(r) * size * (_primitive(high - toward) - _primitive(low - toward))
    return total


def _primitive(x: np.ndarray) -> np.ndarray:
    """Integral of |cos| from 0 to x."""
    k = np.floor(x / math.pi + 0.5)
    return 2 * k + np.sin(x - k * math.pi)


def pieces_of(outline: ra.Outline, keep: Callable[[np.ndarray], np.ndarray] | None = None) -> Pieces:
    """All edges of an outline, or those whose arcs `keep` (n,) bool picks."""
    p = np.concatenate(outline.rings)
    q = np.concatenate([np.roll(ring, -1, axis=0) for ring in outline.rings])
    arcs = np.concatenate(outline.arcs) if outline.arcs else np.zeros((len(p), 3))
    chosen = np.ones(len(p), bool) if keep is None else keep(arcs)
    return p[chosen], q[chosen], arcs[chosen]


def chord(pieces: Pieces) -> np.ndarray:
    return np.asarray((pieces[1] - pieces[0]).sum(0))


def line(*ends: tuple[float, float]) -> Pieces:
    """Straight pieces, ends two by two."""
    points = np.array(ends, float).reshape(-1, 2, 2)
    return points[:, 0], points[:, 1], np.zeros((len(points), 3))


def plate(hole: ra.Outline) -> ra.Outline:
    """A square three times as wide as the hole in it."""
    x0, y0, x1, y1 = hole.bounds
    w = 1.5 * max(x1 - x0, y1 - y0, abs(x0 + x1), abs(y0 + y1))
    square = np.array([(-w, -w), (w, -w), (w, w), (-w, w)])
    arcs = hole.arcs or (np.zeros((len(hole.rings[0]), 3)),)
    return ra.Outline.from_curve([square, hole.rings[0]], arcs=[np.zeros((4, 3)), arcs[0]])


def gear(rng: np.random.Generator, size: float, bore: bool) -> tuple[ra.Outline, float, float]:
    """(teeth of radial flanks between arcs about the origin, tip radius, root radius)."""
    n = int(rng.integers(3, 25))
    tip, root = size, size * rng.uniform(0.5, 0.95)
    step = 2 * math.pi / n
    width = step * rng.uniform(0.2, 0.8)
    phase = rng.uniform(0, step) if rng.random() < 0.5 else 0.0
    ring = []
    for k in range(n):
        t = k * step + phase
        bend = math.tan(width / 4), math.tan((step - width) / 4)
        for r, angle, bulge in (
            (tip, t, bend[0]),
            (tip, t + width, 0.0),
            (root, t + width, bend[1]),
            (root, t + step, 0.0),
        ):
            ring.append((r * math.cos(angle), r * math.sin(angle), bulge))
    points, arcs = ring_arcs.bulging(np.array(ring)[:, :2], np.array(ring)[:, 2])
    rings, bows = [points], [arcs]
    if bore:
        hole = ring_arcs.circle_ring((0.0, 0.0), 0.5 * root)
        rings.append(hole[0])
        bows.append(hole[1])
    return ra.Outline.from_curve(rings, arcs=bows), tip, root


def crescent(rng: np.random.Generator, size: float) -> ra.Outline:
    return ra.Outline.from_bulges([(0, -size, rng.uniform(0.6, 1)), (0, size, -rng.uniform(0.05, 0.55))])


def rounded(rng: np.random.Generator, size: float) -> tuple[ra.Outline, float, float, float]:
    """(box of half widths w, h, w, h, radius of its corners)."""
    w, h = size * rng.uniform(0.3, 1.0, 2)
    r = min(w, h) * 10 ** rng.uniform(-3, -0.01)
    return shapes.rounded_polygon([(-w, -h), (w, -h), (w, h), (-w, h)], r), w, h, r


def any_shape(rng: np.random.Generator, size: float) -> ra.Outline:
    kind = rng.integers(5)
    if kind == 0:
        return ra.Outline.circle(size * rng.uniform(0.2, 1))
    if kind == 1:
        return shapes.capsule(size * rng.uniform(0.1, 2), size * rng.uniform(0.1, 1))
    if kind == 2:
        return rounded(rng, size)[0]
    return crescent(rng, size) if kind == 3 else gear(rng, size, False)[0]


class Posed(NamedTuple):
    """Poses (n, 4) of A and of B (x, y, cosine, sine), and how far B really is from its place, in A's frame (n, 2)."""

    a: np.ndarray
    b: np.ndarray
    s: np.ndarray


def poses(rng: np.random.Generator, pair: Pair, size: float, count: int) -> Posed:
    """At angle 0 and turned (round ones each their own way), moved by 0 and 1e-17 to 1e-9 of the size, at the origin
    and up to 1e9 sizes off it."""
    wide = np.longdouble
    angle = rng.uniform(-7, 7, count) * (rng.random(count) < 0.6)
    angle = np.where(rng.random(count) < 0.15, rng.integers(-4, 5, count) * (math.pi / 4), angle)
    c, s = np.cos(angle), np.sin(angle)
    off = size * 10 ** rng.uniform(-17, -9, count) * (rng.random(count) < 0.6)
    toward = rng.uniform(0, 2 * math.pi, count)
    toward = np.where(rng.random(count) < 0.4, rng.integers(0, 4, count) * (math.pi / 2), toward)
    x, y = pair.place[0] + off * np.cos(toward), pair.place[1] + off * np.sin(toward)
    far = size * 10 ** rng.uniform(-2, 9, count) * (rng.random(count) < 0.3)
    home = far[:, None] * rng.uniform(-1, 1, (count, 2))
    there = home + np.stack([c * x - s * y, s * x + c * y], 1)
    d = there.astype(wide) - home
    real = (
        np.stack([c * d[:, 0] + s * d[:, 1], c * d[:, 1] - s * d[:, 0]], 1)
        / (c.astype(wide) ** 2 + s.astype(wide) ** 2)[:, None]
    )
    s_real = (real - np.array(pair.place, wide)).astype(float)
    turn = np.stack([c, s], 1)
    if len(pair.b.rings) == 1 and pair.b.arcs and ring_arcs.is_circle(pair.b.arcs[0]):  # round: turned anyhow
        more = angle + rng.uniform(-7, 7, count) * (rng.random(count) < 0.5)
        return Posed(
            np.hstack([home, turn]), np.hstack([there, np.stack([np.cos(more), np.sin(more)], 1)]), s_real
        )
    return Posed(np.hstack([home, turn]), np.hstack([there, turn]), s_real)
