"""Random outlines with arcs, and random pairs of them: overlapping anyhow, nearly touching, nested, conforming."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

import rigidarea as ra
from rigidarea import shapes
from rigidarea.geometry import arcs as ring_arcs

TAU = 2 * math.pi


class Pair(NamedTuple):
    how: str
    a: ra.Outline
    b: ra.Outline
    pose_a: tuple[float, float, float]
    pose_b: tuple[float, float, float]


def scaled(outline: ra.Outline, size: float) -> ra.Outline:
    return ra.Outline.from_curve(
        [size * ring for ring in outline.rings], arcs=[size * arc for arc in outline.arcs]
    )


def star(rng: np.random.Generator, bulge: float, hole: bool) -> ra.Outline:
    """A ring of 5 to 12 edges, in and out, straight or arcs either way; a hole of arcs. Drawn until simple."""
    while True:
        ring, holes = star_rings(rng, bulge, hole)
        try:
            return ra.Outline.from_bulges(ring, holes)
        except ValueError as refused:
            assert "must not cross or touch itself" in str(refused)


def star_rings(rng: np.random.Generator, bulge: float, hole: bool) -> tuple[np.ndarray, list[Any]]:
    n = int(rng.integers(5, 13))
    angle = TAU * (np.arange(n) + rng.uniform(-0.2, 0.2, n)) / n
    reach = rng.uniform(0.6, 1.2, n)
    bend = bulge * rng.uniform(-1, 1, n) * (rng.random(n) < 0.7)
    ring = np.stack([reach * np.cos(angle), reach * np.sin(angle), bend], 1)
    holes = []
    if hole:
        turn = rng.uniform(0, TAU)
        spots = [(0.25 * math.cos(turn + k * TAU / 3), 0.25 * math.sin(turn + k * TAU / 3)) for k in range(3)]
        holes.append([(*spot, rng.uniform(-0.3, 0.5)) for spot in spots])
    return ring, holes


def polygon(rng: np.random.Generator, n: int) -> ra.Outline:
    """n points on a circle: convex."""
    angle = np.sort(TAU * (np.arange(n) + rng.uniform(-0.4, 0.4, n)) / n)
    return ra.Outline(np.stack([np.cos(angle), np.sin(angle)], 1))


def rounded(rng: np.random.Generator) -> ra.Outline:
    """A box with rounded corners, from nearly sharp to nearly a capsule."""
    w, h = rng.uniform(0.3, 1.0, 2)
    corners = [(-w, -h), (w, -h), (w, h), (-w, h)]
    return shapes.rounded_polygon(corners, min(w, h) * 10 ** rng.uniform(-4, -0.01))


def channel(rng: np.random.Generator) -> ra.Outline:
    """A rounded U."""
    t = rng.uniform(0.2, 0.35)
    u = [
        (-1, -0.8),
        (1, -0.8),
        (1, 0.8),
        (1 - t, 0.8),
        (1 - t, t - 0.8),
        (t - 1, t - 0.8),
        (t - 1, 0.8),
        (-1, 0.8),
    ]
    return shapes.rounded_polygon(u, 0.45 * t)


MAKERS: dict[str, Callable[[np.random.Generator], ra.Outline]] = {
    "disc": lambda rng: ra.Outline.circle(10 ** rng.uniform(-0.5, 0), tuple(rng.uniform(-0.5, 0.5, 2))),
    "capsule": lambda rng: shapes.capsule(rng.uniform(0.1, 2), rng.uniform(0.1, 0.8)),
    "rounded box": rounded,
    "box": lambda rng: shapes.box(*rng.uniform(0.3, 2, 2)),
    "polygon": lambda rng: polygon(rng, int(rng.integers(3, 20))),
    "ring": lambda rng: shapes.ring(rng.uniform(0.3, 0.9), 1.0),
    "moon": lambda rng: ra.Outline.from_bulges([(0, -0.8, rng.uniform(0.6, 1)), (0, 0.8, -rng.uniform(0, 0.55))]),
    "channel": channel,
    "star": lambda rng: star(rng, 0.15, False),
    "holed star": lambda rng: star(rng, 0.15, True),
}  # fmt: skip


@lru_cache
def bank(seed: int, each: int) -> dict[str, list[ra.Outline]]:
    rng = np.random.default_rng(seed)
    return {name: [make(rng) for _ in range(each)] for name, make in MAKERS.items()}


def about(outline: ra.Outline) -> tuple[np.ndarray, float]:
    """Middle of the bounds and a radius about it that holds the outline."""
    xmin, ymin, xmax, ymax = outline.bounds
    return np.array([(xmin + xmax) / 2, (ymin + ymax) / 2]), math.hypot(xmax - xmin, ymax - ymin) / 2


def random_pair(rng: np.random.Generator, outlines: dict[str, list[ra.Outline]], touch: Any) -> Pair:
    """Any two, of sizes 1e-6 to 1e6 and up to 1e3 apart, at the origin or 1e6 sizes off it.

    Overlapping anyhow, nearly touching, one inside the other, or nearly the same shape nearly in the same place.
    """
    names = list(outlines)
    a, b = (
        outlines[names[k]][rng.integers(len(outlines[names[k]]))] for k in rng.integers(len(names), size=2)
    )
    how = rng.choice(["any", "any", "tangent", "inside", "conforming"])
    size = 10 ** rng.uniform(-6, 6)
    ratio = 10 ** rng.uniform(0, 3) if how in ("inside", "tangent") else 10 ** rng.uniform(-0.5, 0.5)
    t, turn, toward = rng.uniform(0, TAU, 3)
    gap = 10 ** rng.uniform(-12, -2)
    if how == "conforming":
        b, ratio, turn = conforming(rng, a, gap)
    a, b = scaled(a, size * ratio), scaled(b, size)
    if rng.random() < 0.5 and how != "conforming":
        a, b = b, a
    (ma, ra_), (mb, rb) = about(a), about(b)
    away = np.array([math.cos(toward), math.sin(toward)])
    c, s = math.cos(turn), math.sin(turn)
    mb = np.array([c * mb[0] - s * mb[1], s * mb[0] + c * mb[1]])
    if how == "any":
        at = ma - mb + away * (ra_ + rb) * rng.random()
    elif how == "inside":
        at = ma - mb + away * abs(ra_ - rb) * rng.random()
    elif how == "conforming":
        at = away * size * gap * rng.uniform(0.1, 2)  # not in the same place: there neither inside is defined
    else:
        at = touch(a, b, ma - mb, away, turn) - away * size * gap
    far = how != "conforming" and rng.random() < 0.3  # there a gap below 1e-10 is none
    start = 1e6 * size * rng.uniform(-1, 1, 2) * far
    ct, st = math.cos(t), math.sin(t)
    there = start + np.array([ct * at[0] - st * at[1], st * at[0] + ct * at[1]])
    return Pair(how, a, b, (*start.tolist(), t), (*there.tolist(), t + turn))


def conforming(rng: np.random.Generator, a: ra.Outline, gap: float) -> tuple[ra.Outline, float, float]:
    """(outline that fits a but for a gap, a's size over the gap-less one's, angle): grown, shrunk or turned by it."""
    if len(a.rings) > 1 and rng.random() < 0.5:  # fill its hole
        ring, arc = a.rings[1], a.arcs[1] if a.arcs else np.zeros((len(a.rings[1]), 3))
        ring, arc = ring_arcs.reversed_ring(ring, arc)
        return ra.Outline.from_curve([ring], arcs=[arc]), 1.0 + gap * rng.choice([-1, 0, 1]), 0.0
    return a, 1.0 + gap * rng.choice([-1, 0, 1]), gap * float(rng.choice([-1, 0, 1]))
