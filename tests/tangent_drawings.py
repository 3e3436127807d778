"""More families of pairs that touch along a tangent or coincide: lenses, fillets, curved slots, wedges, rings, flats.

As `tangent_families`; all of them end on tangents, on arcs or on ends of the other one.
"""

from __future__ import annotations

import math

import numpy as np

import rigidarea as ra
from rigidarea import shapes
from rigidarea.geometry import arcs as ring_arcs
from tangent_pairs import NONE, Pair, Pieces, chord, line, pieces_of, plate

Point = tuple[float, float]


def at(radius: float, angle: float) -> Point:
    return radius * math.cos(angle), radius * math.sin(angle)


def arc(p: Point, q: Point, centre: Point, r: float) -> Pieces:
    return np.array([p]), np.array([q]), np.array([(*centre, r)])


def together(*pieces: Pieces) -> Pieces:
    return tuple(np.concatenate(column) for column in zip(*pieces))  # type: ignore[return-value]


def within(family: str, a: ra.Outline, b: ra.Outline, place: Point, along: Pieces, flat: float) -> Pair:
    """B inside A, some of its boundary on A's."""
    return Pair(family, a, b, place, b.area, -chord(along), NONE, along, (1,), flat)


def beside(family: str, a: ra.Outline, b: ra.Outline, place: Point, against: Pieces, flat: float) -> Pair:
    """B outside A, some of its boundary on A's."""
    return Pair(family, a, b, place, 0.0, np.zeros(2), against, NONE, (0,), flat)


def lens(radius: float, half: float) -> ra.Outline:
    """Of two circles of one radius; its corners at (0, -half), (0, half)."""
    bulge = math.tan(math.asin(half / radius) / 2)
    return ra.Outline.from_bulges([(0, -half, bulge), (0, half, bulge)])


def lenses(rng: np.random.Generator, size: float) -> Pair:
    """Two of one radius: the one in the other on the same arc, also at the same corner; or corner to corner, or side to
    side."""
    radius = size
    half = size * rng.uniform(0.2, 0.99)
    less = half * rng.uniform(0.1, 0.95)
    a, b = lens(radius, half), lens(radius, less)
    apart, closer = math.sqrt(radius**2 - half**2), math.sqrt(radius**2 - less**2)
    how = int(rng.integers(4))
    if how == 0:
        along = arc((0, -less), (0, less), (-closer, 0), radius)
        return within("lenses", a, b, (closer - apart, 0.0), along, 4 * radius)
    if how == 1:
        return beside("lenses", a, b, (2 * radius - apart - closer, 0.0), NONE, radius)
    if how == 2:
        return beside("lenses", a, b, (0.0, half + less), NONE, radius)
    top = math.asin(half / radius)
    p, q = np.array(at(radius, top - 2 * top * rng.uniform(0.05, 0.9))), np.array(at(radius, top))
    middle = (p + q) / 2
    bulge = math.tan(math.asin(math.dist(p, q) / 2 / radius) / 2)
    b = ra.Outline.from_bulges([(*(p - middle), bulge), (*(q - middle), bulge)])
    along = (p - middle)[None], (q - middle)[None], np.array([[*-middle, radius]])
    return within("lenses", a, b, (float(middle[0]) - apart, float(middle[1])), along, 4 * radius)


def stadiums(rng: np.random.Generator, size: float) -> Pair:
    """A capsule in a longer one of its width, also at its end; two at a right angle about the middle of an end."""
    r, length = size * rng.uniform(0.05, 1), size * rng.uniform(0.2, 2)
    body = shapes.capsule(length, r)
    if rng.random() < 0.4:
        length = max(length, 1.01 * r)  # so that the upright one leaves its other end alone
        body = shapes.capsule(length, r)
        other = max(size * rng.uniform(0.2, 2), 1.01 * r)
        upright = ra.Outline.from_bulges([(r, 0, 0), (r, other, 1), (-r, other, 0), (-r, 0, 1)])
        return Pair(
            "stadiums", body, upright, (length / 2, 0.0), (0.75 * math.pi + 1) * r * r,
            np.array((r, -2 * r)), NONE, arc((0, -r), (r, 0), (0, 0), r), (1,), 4 * r,
        )  # fmt: skip
    short = length * rng.uniform(0.1, 0.9)
    x = short / 2
    where = float(rng.choice([-1, rng.uniform(-1, 1), 0, 1]))
    along = line((-x, -r), (x, -r), (x, r), (-x, r))
    if abs(where) == 1:
        x *= where
        along = together(along, arc((x, -r * where), (x, r * where), (x, 0), r))
    return within(
        "stadiums", body, shapes.capsule(short, r), (where * (length - short) / 2, 0.0), along, 4 * r
    )


def fillets(rng: np.random.Generator, size: float) -> Pair:
    """Discs and a rounded box in the rounded inner corner of an angle, conforming, or touching it anywhere, also where
    it ends."""
    w, r = 4 * size, size * 10 ** rng.uniform(-2, 0)
    angle = ra.Outline.from_bulges(
        [(-w, -w, 0), (w, -w, 0), (w, 0, 0), (r, 0, -math.tan(math.pi / 8)), (0, r, 0), (0, w, 0), (-w, w, 0)]
    )
    how = int(rng.integers(5))
    if how == 0:
        return beside(
            "fillets", angle, ra.Outline.circle(r), (r, r), arc((-r, 0), (0, -r), (0, 0), r), 4 * size
        )
    if how == 1:  # on both faces
        b = r * rng.uniform(1, 2)
        return beside("fillets", angle, ra.Outline.circle(b), (b, b), NONE, 4 * size)
    if how == 2:  # on the arc
        b, t = r * rng.uniform(0.1, 0.9), float(rng.choice([0, rng.uniform(0, 1), 1])) * math.pi / 2
        x, y = (r - (r - b) * math.cos(t), r - (r - b) * math.sin(t))
        return beside("fillets", angle, ra.Outline.circle(b), (b if t == 0 else x, y), NONE, 20 * size)
    if how == 3:
        b = r * rng.uniform(0.1, 1)
        return beside("fillets", angle, ra.Outline.circle(b), (r, b), NONE, 20 * size)
    v, g = r * rng.uniform(1.1, 2, 2)
    box = shapes.rounded_polygon([(-v, -g), (v, -g), (v, g), (-v, g)], r)
    against = together(
        line((-v, g - r), (-v, r - g), (r - v, -g), (v - r, -g)), arc((-v, r - g), (r - v, -g), (r - v, r - g), r)
    )  # fmt: skip
    return beside("fillets", angle, box, (v, g), against, 4 * size)


def kidney(middle: float, r: float, low: float, high: float) -> ra.Outline:
    """A curved slot: r each way of the circle of radius `middle`, between two angles, with round ends."""
    bend = math.tan((high - low) / 4)
    outer, inner = middle + r, middle - r
    return ra.Outline.from_bulges(
        [(*at(outer, low), bend), (*at(outer, high), 1), (*at(inner, high), -bend), (*at(inner, low), 1)]
    )


def kidneys(rng: np.random.Generator, size: float) -> Pair:
    """In a curved slot a pin, or a shorter tongue, of its width, anywhere or at its end; and the tongue in a longer."""
    middle = size
    r = middle * rng.uniform(0.05, 0.6)
    low = rng.uniform(-3, 3)
    high = low + rng.uniform(0.3, 2.5)
    long = kidney(middle, r, low, high)
    how = int(rng.integers(3))
    if how == 0:
        where = int(rng.integers(3))
        t = (low, rng.uniform(low, high), high)[where]
        end = np.array(at(r, t))
        p, q = (-end, end) if where == 0 else (end, -end)
        against = NONE if where == 1 else (p[None], q[None], np.array([[0.0, 0.0, r]]))
        return beside("kidneys", plate(long), ra.Outline.circle(r), at(middle, t), against, 20 * size)
    ends = np.sort(rng.uniform(low, high, 2))
    if rng.random() < 0.5:
        ends[0] = low
    if ends[1] - ends[0] < 0.1:
        ends[1] = ends[0] + 0.1
    if rng.random() < 0.3 or ends[1] > high:
        ends[1] = high
    tongue = kidney(middle, r, *ends.tolist())
    p, q, arcs = pieces_of(tongue)
    on = [0, 2] + [1] * bool(ends[1] == high) + [3] * bool(ends[0] == low)
    common = p[on], q[on], arcs[on]
    if how == 1:
        return beside("kidneys", plate(long), tongue, (0.0, 0.0), common, 20 * size)
    return within("kidneys", long, tongue, (0.0, 0.0), common, 20 * size)


def wedges(rng: np.random.Generator, size: float) -> Pair:
    """A rounded triangle in another with a common corner's circle, of which both have an arc; often a side as well."""
    r = size * 10 ** rng.uniform(-2, 0)
    low = rng.uniform(-3, 3)
    high = low + rng.uniform(0.4, 2.0)
    wide = 3 * size * rng.uniform(0.5, 1, 2)
    ends = [low + (high - low) * rng.uniform(0, 0.4), high - (high - low) * rng.uniform(0, 0.4)]
    side = rng.random() < 0.5
    if side:
        ends[0] = low

    def grown(lengths: np.ndarray, angles: tuple[float, float]) -> ra.Outline:
        points = np.array([(0.0, 0.0), at(lengths[0], angles[0]), at(lengths[1], angles[1])])
        ring, bows = ring_arcs.grown(points, r)
        return ra.Outline.from_curve([ring], arcs=[bows])

    # as far as all of a smaller triangle with these sides is in the larger
    least = wide.min() * math.cos((high - low) / 2)
    short = least * rng.uniform(0.2, 0.9, 2)
    first, last = high + math.pi / 2, low + 3 * math.pi / 2
    along = arc(at(r, first), at(r, last), (0, 0), r)
    if side:
        p, q = np.array(at(r, last)), np.array(at(short[0], low))
        along = together(along, line(tuple(p), tuple(p + q)))
    return within(
        "wedges", grown(wide, (low, high)), grown(short, (ends[0], ends[1])), (0.0, 0.0), along, 4 * size
    )


def rings(rng: np.random.Generator, size: float) -> Pair:
    """Discs and rings about one middle with a circle in common; a disc as wide as the ring it lies in."""
    r, m, big = np.sort(size * rng.uniform(0.2, 1, 3) * (1, 1.2, 1.5)).tolist()
    ring = shapes.ring(r, big)
    how = int(rng.integers(5))
    if how == 0:
        disc = ra.Outline.circle(r)
        return beside("rings", ring, disc, (0.0, 0.0), pieces_of(disc), size)
    if how == 1:
        disc = ra.Outline.circle(big)
        along = pieces_of(disc)
        return Pair("rings", ring, disc, (0.0, 0.0), ring.area, np.zeros(2), NONE, along, (1,), size)
    if how == 2:
        inner = shapes.ring(r, m)
        return beside(
            "rings",
            shapes.ring(m, big),
            inner,
            (0.0, 0.0),
            pieces_of(inner, lambda arcs: arcs[:, 2] > 0),
            size,
        )
    if how == 3:
        inner = shapes.ring(r, m)
        along = pieces_of(inner, lambda arcs: arcs[:, 2] < 0)
        return Pair("rings", ring, inner, (0.0, 0.0), inner.area, np.zeros(2), NONE, along, (1,), size)
    t = float(rng.choice([0, math.pi / 2, rng.uniform(-3, 3)]))
    disc = ra.Outline.circle((big - r) / 2)
    return within("rings", ring, disc, at((big + r) / 2, t), NONE, 40 * size)


def flat_arcs(rng: np.random.Generator, size: float) -> Pair:
    """An arc of up to 1e6 sizes' radius on a straight face (touching, or its chord on it), in its own dent, on another.

    An arc's height is known to a few roundings of its radius: 1e-9 of the size is the height's own error at 1e6.
    """
    half = size * rng.uniform(0.3, 1)
    radius = size * 10 ** rng.uniform(0.1, 5)
    angle = math.asin(half / radius)
    bulge = math.tan(angle / 2)
    height = half * bulge
    foot = ra.Outline.from_bulges([(-half, 0, bulge), (half, 0, 0), (half, size, 0), (-half, size, 0)])
    w = half * float(rng.choice([1.0, rng.uniform(1, 3)]))
    how = int(rng.integers(4))
    if how == 0:
        w = half * rng.uniform(1.1, 3)
        segment = (
            radius**2 * (angle - math.sin(angle) * math.cos(angle))
            if angle > 0.1
            else _flat_segment(half, radius)
        )
        floor = ra.Outline([(-w, -2 * size), (w, -2 * size), (w, 0), (-w, 0)])
        return Pair(
            "flat arcs", floor, foot, (0.0, 0.0), segment, np.array((2 * half, 0.0)), NONE, NONE, (1,), size
        )  # fmt: skip
    if how == 1:
        floor = ra.Outline([(-w, -2 * size), (w, -2 * size), (w, 0), (-w, 0)])
        return beside("flat arcs", floor, foot, (0.0, height), NONE, radius)
    if how == 2:
        e = 2 * half
        dent = [(e, 0, 0), (half, 0, -bulge), (-half, 0, 0), (-e, 0, 0)]
        bed = ra.Outline.from_bulges([(-e, -2 * size, 0), (e, -2 * size, 0), *dent])
        return beside(
            "flat arcs", bed, foot, (0.0, 0.0), pieces_of(foot, lambda arcs: arcs[:, 2] > 0), 4 * radius
        )
    other = size * 10 ** rng.uniform(0.5, 5)
    bend = math.tan(math.asin(w / other) / 2)
    hill = ra.Outline.from_bulges([(-w, -2 * size, 0), (w, -2 * size, 0), (w, 0, bend), (-w, 0, 0)])
    return beside("flat arcs", hill, foot, (0.0, height + w * bend), NONE, max(radius, other))


def _flat_segment(half: float, radius: float) -> float:
    """Between a chord and its arc: the series of x - sin x cos x, x the arc's half angle, below 0.1."""
    x2 = math.asin(half / radius) ** 2
    return (
        radius**2 * x2**1.5 * (2 / 3) * (1 - x2 / 5 * (1 - x2 * 2 / 21 * (1 - x2 / 18 * (1 - x2 * 2 / 55))))
    )


def _star(rng: np.random.Generator, size: float) -> list[tuple[float, float, float]]:
    """A ring of arcs and edges, each its own, about the origin."""
    n = int(rng.integers(3, 9))
    angles = (np.arange(n) + rng.uniform(0, 0.6, n)) * (2 * math.pi / n)
    far = size * rng.uniform(0.5, 1, n)
    bulges = rng.uniform(-0.4, 0.6, n) * (rng.random(n) < 0.7)
    return [(*at(r, t), float(b)) for r, t, b in zip(far, angles, bulges)]


def cuts(rng: np.random.Generator, size: float) -> Pair:
    """A ring cut in two between two of its corners: the parts side by side, or one of them in the whole."""
    while True:
        ring = _star(rng, size)
        n = len(ring)
        k = int(rng.integers(1, n))
        bulge = float(rng.choice([0, rng.uniform(-0.9, 0.9)]))
        if k == 1 and abs(bulge - ring[0][2]) < 0.1:
            continue  # a sliver
        parts = [
            [*ring[:k], (*ring[k][:2], -bulge)],
            [(*ring[0][:2], bulge), *ring[k:]],
        ]
        try:
            whole, one, other = (ra.Outline.from_bulges(r) for r in (ring, *parts))
        except ValueError:  # it crosses itself
            continue
        if (
            min(one.area, other.area) > 1e-3 * size**2
            and abs(one.area + other.area - whole.area) < 1e-9 * size**2
        ):
            break
    flat = max(float(np.abs(arcs[:, 2]).max()) for o in (one, other) for arcs in (*o.arcs, np.zeros((1, 3))))
    p, q, arcs = pieces_of(other)
    cut = p[:1], q[:1], arcs[:1]  # from corner 0 to corner k
    if rng.random() < 0.5:
        return beside("cuts", one, other, (0.0, 0.0), cut, flat)
    return Pair(
        "cuts", whole, other, (0.0, 0.0), other.area, chord(cut), NONE, (p[1:], q[1:], arcs[1:]), (1,), flat
    )  # fmt: skip


DRAWINGS = (lenses, stadiums, fillets, kidneys, wedges, rings, flat_arcs, cuts)
