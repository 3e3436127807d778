"""Rings of straight edges and circular arcs: their measures, extremes, and the points that stand for them.

Notation: edge i of a ring runs from point p[i] to p[i+1]. `arcs` is an (n, 3) array beside the points (n, 2): centre x,
centre y, signed radius (length); radius > 0 runs counter-clockwise about the centre, < 0 clockwise, 0 is a straight
edge. No arc sweeps more than half a turn, so that its chord and its side of it say all: an arc's points are those of
its circle to the right of p -> q for radius > 0, to the left for radius < 0.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

Points = NDArray[np.float64]

MIN_CHORDS = 3
"""Fewest chords of an arc with fixed ends: from 3 on, keeping the area moves no vertex further than the
sagitta."""
MOST_CHORDS = 100_000
"""Most chords of an arc: a tolerance that asks for more asks for a boundary that no step could walk (1 MB an arc)."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(24)
"""For polynomials of degree 4 in sine and cosine over half a turn: exact to rounding (20 nodes are enough)."""


def arc_points(
    center: tuple[float, float], radius: float, start: float, sweep: float, tolerance: float
) -> Points:
    """Points (n, 2) along a circular arc, both ends included and exactly on it, the sector's area kept
    exactly.

    center, radius: of the circle (length). start, sweep: radians; sweep > 0 runs counter-clockwise. tolerance: largest
    sagitta (length). Raises ValueError for more than MOST_CHORDS.
    With m chords of angle θ and inner vertices at radius ρ, the fan has the sector's area R²φ/2 when
    (m−2)/2·sin θ·ρ² + R·sin θ·ρ − R²φ/2 = 0.
    """
    chords = _chords(radius, abs(sweep), tolerance)
    step = abs(sweep) / chords
    quadratic, linear, constant = (chords - 2) / 2, 1.0, -abs(sweep) / (2 * math.sin(step))
    rho = radius * 2 * -constant / (linear + math.sqrt(linear * linear - 4 * quadratic * constant))
    angle = start + sweep * np.arange(chords + 1) / chords
    radii = np.full(chords + 1, rho)
    radii[0] = radii[-1] = radius
    return np.asarray(center) + radii[:, None] * np.column_stack((np.cos(angle), np.sin(angle)))


def circle_points(center: tuple[float, float], radius: float, tolerance: float) -> Points:
    """Vertices (n, 2), counter-clockwise, of the regular polygon with the circle's area; n a multiple of 4,
    n >= 8.

    center, radius: of the circle (length). tolerance: largest sagitta (length). The first edge stands across the x
    axis, so that a disc set down unturned lies on a face. Raises ValueError for more than MOST_CHORDS.
    """
    n = 4 * max(2, math.ceil(_chords(radius, 2 * math.pi, tolerance) / 4))
    rho = radius * math.sqrt((2 * math.pi / n) / math.sin(2 * math.pi / n))
    angle = 2 * math.pi * (np.arange(n) + 0.5) / n
    return np.asarray(center) + rho * np.column_stack((np.cos(angle), np.sin(angle)))


def _chords(radius: float, sweep: float, tolerance: float) -> int:
    """How many chords keep the sagitta R(1 − cos θ/2) below the tolerance, none wider than a quarter turn.

    Raises ValueError for more than MOST_CHORDS.
    """
    half = math.acos(max(1 - tolerance / radius, math.cos(math.pi / 4)))
    if sweep > 2 * half * MOST_CHORDS:
        least = radius * (1 - math.cos(0.5 * sweep / MOST_CHORDS))
        raise ValueError(
            f"tolerance must be at least {least:.3g} for an arc of radius {radius:.3g} "
            f"({MOST_CHORDS} chords), got {tolerance!r}"
        )
    return max(MIN_CHORDS, math.ceil(sweep / (2 * half) * (1 - 1e-12)))


def circle_ring(center: tuple[float, float], radius: float) -> tuple[Points, Points]:
    """(points (2, 2), arcs (2, 3)): a circle, counter-clockwise, as two halves."""
    x, y = center
    return np.array([(x + radius, y), (x - radius, y)]), np.array([(x, y, radius)] * 2, dtype=float)


def reversed_ring(points: Points, arcs: Points) -> tuple[Points, Points]:
    """A ring, points (n, 2) and arcs (n, 3), walked the other way round: both in the new order."""
    return points[::-1].copy(), np.roll(arcs[::-1], -1, axis=0) * (1.0, 1.0, -1.0)


def is_circle(arcs: Points) -> bool:
    """Whether all edges lie on one circle: then the ring is that circle."""
    return bool(arcs[0, 2] != 0 and (arcs == arcs[0]).all())


def sweeps(points: Points, arcs: Points) -> Points:
    """Signed angle (n,) that each edge turns through about its centre, -π to π; 0 for straight ones (radians)."""
    a, b = points - arcs[:, :2], _following(points) - arcs[:, :2]
    angle = np.arctan2(np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]), (a * b).sum(axis=1))
    return np.sign(arcs[:, 2]) * angle


def segments(points: Points, arcs: Points) -> tuple[Points, Points, Points]:
    """What lies between each arc and its chord, signed like the radius: area (n,), first moment (n, 2) and polar
    moment (n,) about the chord's middle. All zeros for straight edges.

    By Gauss's rule along the arc, about the chord's middle, where nothing cancels however flat the arc is: at angle
    ψ from the arc's middle, φ half the sweep, r = R (sin ψ, 2 sin((φ+ψ)/2) sin((φ-ψ)/2)) along and across the chord;
    then area = 1/2 ∫ r × dr, first moment 1/3 ∫ r (r × dr), polar moment 1/4 ∫ r² (r × dr).
    """
    radius = np.abs(arcs[:, 2])[:, None]
    half = np.abs(sweeps(points, arcs))[:, None] / 2
    psi = half * _NODES
    along = radius * np.sin(psi)
    across = radius * 2 * np.sin((half + psi) / 2) * np.sin((half - psi) / 2)
    sector = (
        radius * (along * np.sin(psi) + across * np.cos(psi)) * half * _WEIGHTS
    )  # r × dr, counter-clockwise
    sign = np.sign(arcs[:, 2])
    area = sign * sector.sum(axis=1) / 2
    chord = _following(points) - points
    length = np.maximum(np.hypot(*chord.T), np.finfo(float).tiny)
    right = np.column_stack((chord[:, 1], -chord[:, 0])) / length[:, None]
    first = ((across * sector).sum(axis=1) / 3)[:, None] * right
    return area, first, sign * ((along**2 + across**2) * sector).sum(axis=1) / 4


def area_and_first_moment(ring: Points) -> tuple[float, Points]:
    """Signed area and ∫ r dA (2,) of a polygon by Green's theorem (the paper's Eq. 4 and 7)."""
    following = _following(ring)
    cross = ring[:, 0] * following[:, 1] - ring[:, 1] * following[:, 0]
    return float(cross.sum()) / 2, cross @ (ring + following) / 6


def measures(ring: Points, arcs: Points | None) -> tuple[float, Points, float]:
    """Signed area, ∫ r dA (2,) and ∫ |r|² dA of a ring: of its chords, and of what lies between them and arcs.

    About the origin (length², length³, length⁴); arcs None: straight edges only.
    """
    area, first = area_and_first_moment(ring)
    following = _following(ring)
    cross = ring[:, 0] * following[:, 1] - ring[:, 1] * following[:, 0]
    square = (ring * ring + ring * following + following * following).sum(axis=1)
    polar = float((cross * square).sum()) / 12
    if arcs is None:
        return area, first, polar
    areas, moments, polars = segments(ring, arcs)
    middle = (ring + following) / 2
    polar += float((polars + 2 * (middle * moments).sum(axis=1) + (middle**2).sum(axis=1) * areas).sum())
    return area + float(areas.sum()), first + (moments + areas[:, None] * middle).sum(axis=0), polar


def about(arcs: Points | None, center: ArrayLike) -> Points | None:
    """The arcs relative to a centre (2,)."""
    return None if arcs is None else arcs - np.array((*np.asarray(center), 0.0))


def extremes(points: Points, arcs: Points) -> Points:
    """The ring's points and, of its arcs, those that lie furthest to -x, +x, -y, +y: their bounds are the ring's."""
    found = [points]
    following = _following(points)
    for i in np.flatnonzero(arcs[:, 2]):
        x, y, r = arcs[i]
        ends = np.array([(x - abs(r), y), (x + abs(r), y), (x, y - abs(r)), (x, y + abs(r))])
        found.append(ends[on_arc(points[i], following[i], r, ends)])
    return np.concatenate(found)


def on_arc(start: Points, end: Points, radius: float, where: Points) -> NDArray[np.bool_]:
    """Which points `where` (n, 2) of a circle lie on its arc from start to end, both (2,): (n,) bool.

    radius: signed, as in `arcs` (length).
    """
    chord, away = end - start, where - start
    left: Points = chord[0] * away[:, 1] - chord[1] * away[:, 0]
    return left * radius < 0


def sampled(points: Points, arcs: Points, tolerance: float) -> Points:
    """The ring with its arcs as chords of sagitta `tolerance` (length) at the most, areas kept (see `arc_points`)."""
    if is_circle(arcs):
        x, y, r = arcs[0]
        ring = circle_points((x, y), abs(r), tolerance)
        return ring if r > 0 else ring[::-1].copy()
    turned = sweeps(points, arcs)
    pieces = []
    for i, (x, y, r) in enumerate(arcs):
        if r == 0:
            pieces.append(points[i : i + 1])
            continue
        start = math.atan2(points[i, 1] - y, points[i, 0] - x)
        piece = arc_points((x, y), abs(r), start, turned[i], tolerance)[:-1]
        piece[0] = points[i]
        pieces.append(piece)
    return np.concatenate(pieces)


def around(points: Points, arcs: Points) -> Points:
    """Points (n, 2) whose convex hull contains the ring: arcs that bulge outwards become tangents, at most 1/64 of half
    a turn apart.
    """
    turned = sweeps(points, arcs)
    pieces = []
    for i, (x, y, r) in enumerate(arcs):
        pieces.append(points[i : i + 1])
        if r > 0:
            count = max(1, math.ceil(turned[i] / (math.pi / 64)))
            each = turned[i] / count
            angle = math.atan2(points[i, 1] - y, points[i, 0] - x) + each * (np.arange(count) + 0.5)
            reach = r / math.cos(each / 2)
            pieces.append(np.column_stack((x + reach * np.cos(angle), y + reach * np.sin(angle))))
    return np.concatenate(pieces)


def tangents(points: Points, arcs: Points) -> tuple[Points, Points]:
    """Unit directions in which each edge of a ring starts, and in which it ends: two arrays (n, 2)."""
    following = _following(points)
    chord = following - points
    out = []
    for where in (points, following):
        arm = (where - arcs[:, :2]) * np.sign(arcs[:, 2:])
        direction = np.where(arcs[:, 2:] == 0, chord, np.column_stack((-arm[:, 1], arm[:, 0])))
        out.append(direction / np.maximum(np.hypot(*direction.T), np.finfo(float).tiny)[:, None])
    return out[0], out[1]


def bulging(points: Points, bulges: Points) -> tuple[Points, Points]:
    """(points, arcs) of a ring whose edge i bulges to the right by bulges[i] = tan(sweep / 4), sweep > 0
    counter-clockwise (DXF's convention). Arcs of more than half a turn are halved, so there may be more points.
    """
    kept, arcs = [], []
    for p, q, b in zip(points, _following(points), bulges):
        chord = q - p
        right = np.array((chord[1], -chord[0]))
        if b == 0:
            kept.append(p)
            arcs.append((0.0, 0.0, 0.0))
            continue
        # the arc's top is b/2 chords to the right of the middle, its centre (1/b - b)/4 chords to the left
        center = (p + q) / 2 - right * (1 / b - b) / 4
        radius = math.hypot(*chord) * (1 / abs(b) + abs(b)) / 4
        arc = (center[0], center[1], math.copysign(radius, b))
        kept.append(p)
        arcs.append(arc)
        if abs(b) > 1:
            kept.append((p + q) / 2 + right * b / 2)
            arcs.append(arc)
    return np.array(kept), np.array(arcs)


def grown(points: Points, radius: float) -> tuple[Points, Points]:
    """(points (m, 2), arcs (m, 3)) of a convex polygon, counter-clockwise, grown by `radius` (length); of two points: a
    capsule.
    """
    edge = _following(points) - points
    normal = np.column_stack((edge[:, 1], -edge[:, 0])) / np.hypot(*edge.T)[:, None]
    ring, arcs = [], []
    for i, center in enumerate(points):
        before, after = normal[i - 1], normal[i]
        turn = math.atan2(before[0] * after[1] - before[1] * after[0], float(before @ after))
        if abs(turn) > 1e-6:  # else the corner is none: an arc of no length is worth no edge
            ring.append(center + radius * before)
            arcs.append((*center, radius))
        ring.append(center + radius * after)
        arcs.append((0.0, 0.0, 0.0))
    return np.array(ring), np.array(arcs)


def _following(points: Points) -> Points:
    return np.concatenate((points[1:], points[:1]))
