"""Area of the overlap of two outlines with arcs, at 50 digits (mpmath), degenerate or not.

Every edge is cut wherever it crosses an edge of the other outline; of each piece the middle is asked, by crossings of a
ray, whether it lies inside the other; Green's theorem is summed over the pieces that do. B stands 1e-30 of the size
beside where it is said to stand: what touches or coincides there no longer does at 50 digits, and the area is the same.
"""

from __future__ import annotations

import itertools
import math
from typing import Any, NamedTuple

import mpmath
from mpmath import mpc, mpf

DIGITS = 50
TINY = "1e-30"
#: Where on a piece it is asked: not in the very middle, where by symmetry a corner may lie on the ray.
MIDDLE = 0.4142135


class Edge(NamedTuple):
    """From p to q; of an arc, centre, signed radius (0: straight), angle at p and angle swept."""

    p: Any
    q: Any
    c: Any
    r: Any
    start: Any
    sweep: Any

    def at(self, t: Any) -> Any:
        """The point at parameter t, 0 to 1."""
        if self.r == 0:
            return self.p + t * (self.q - self.p)
        return self.c + abs(self.r) * mpmath.expj(self.start + t * self.sweep)

    def parameter(self, z: Any) -> Any:
        """Of a point of the edge's line or circle; in (0, 1): of the edge."""
        if self.r == 0:
            d = self.q - self.p
            return ((z - self.p) * d.conjugate()).real / abs(d) ** 2
        return _turned(mpmath.arg(z - self.c) - self.start, self.r) / self.sweep

    def green(self, t: Any, u: Any) -> Any:
        """Its part of the area, from parameter t to u."""
        a, b = self.at(t), self.at(u)
        area = _cross(a, b) / 2
        if self.r != 0:
            angle = (u - t) * self.sweep
            area += self.r**2 / 2 * (angle - mpmath.sin(angle))
        return area


def _near(a: Edge, b: Edge) -> bool:
    """Whether discs about the two edges' chords, as wide as arcs may be, meet."""
    reach = [
        abs(complex(e.q - e.p)) / 2 + (abs(float(e.r)) * (1 - math.cos(e.sweep / 2)) if e.r else 0)
        for e in (a, b)
    ]
    return abs(complex(a.p + a.q - b.p - b.q)) / 2 <= (reach[0] + reach[1]) * (1 + 1e-6)


def _cross(a: Any, b: Any) -> Any:
    return a.real * b.imag - a.imag * b.real


def _turned(angle: Any, r: Any) -> Any:
    """An angle in [0, 2 pi) counter-clockwise, (-2 pi, 0] clockwise."""
    turn = 2 * mpmath.pi
    return angle % turn if r > 0 else -((-angle) % turn)


def edges_of(outline: Any, turn: Any, shift: Any) -> list[Edge]:
    """The outline's edges, turned by the complex number `turn`, then shifted."""
    out = []
    for k, ring in enumerate(outline.rings):
        points = [turn * mpc(x, y) + shift for x, y in ring.tolist()]
        bows = outline.arcs[k].tolist() if outline.arcs else [[0.0] * 3] * len(points)
        for i, (x, y, r) in enumerate(bows):
            p, q, c = points[i], points[(i + 1) % len(points)], turn * mpc(x, y) + shift
            start = sweep = radius = mpf(0)
            if r:
                # through both ends: doubles leave them beside the stored circle, and the boundary would have gaps
                u = (q - p) / abs(q - p)
                c -= ((c - (p + q) / 2) * u.conjugate()).real * u
                radius = mpmath.sign(r) * abs(c - p)
                start = mpmath.arg(p - c)
                sweep = _turned(mpmath.arg(q - c) - start, r)
            out.append(Edge(p, q, c, radius, start, sweep))
    return out


def _meetings(a: Edge, b: Edge) -> list[Any]:
    """Points of both lines or circles."""
    if a.r == 0 and b.r == 0:
        u, v = a.q - a.p, b.q - b.p
        across = _cross(u, v)
        return [] if across == 0 else [a.p + _cross(b.p - a.p, v) / across * u]
    if b.r == 0:
        a, b = b, a
    if a.r == 0:
        u = (a.q - a.p) / abs(a.q - a.p)
        w = (b.c - a.p) * u.conjugate()
        rest = b.r**2 - w.imag**2
        return [] if rest <= 0 else [a.p + (w.real + sign * mpmath.sqrt(rest)) * u for sign in (-1, 1)]
    d = b.c - a.c
    d2 = abs(d) ** 2
    if d2 == 0:
        return []
    along = (d2 + a.r**2 - b.r**2) / (2 * d2)
    rest = a.r**2 / d2 - along**2
    return [] if rest <= 0 else [a.c + mpc(along, sign * mpmath.sqrt(rest)) * d for sign in (-1, 1)]


def _inside(edges: list[Edge], z: Any) -> bool:
    """Even-odd, by the polygon of the chords and what lies between chords and arcs."""
    inside = False
    for e in edges:
        left = _cross(e.p - z, e.q - z)
        up = e.q.imag > z.imag
        if (e.p.imag > z.imag) != up and (left > 0) == up:
            inside = not inside
        if e.r != 0 and abs(z - e.c) < abs(e.r) and (left < 0) == (e.r > 0):
            inside = not inside
    return inside


def area(a: Any, b: Any, pose_a: tuple[float, ...], pose_b: tuple[float, ...]) -> float:
    """Of A and B at poses (x, y, cosine, sine), as given: their doubles are taken as exact."""
    with mpmath.workdps(DIGITS):
        turn_a, turn_b = mpc(*pose_a[2:]), mpc(*pose_b[2:])
        turn_a, turn_b = turn_a / abs(turn_a), turn_b / abs(turn_b)
        back = turn_a.conjugate()
        place = (mpc(*pose_b[:2]) - mpc(*pose_a[:2])) * back
        beside = mpf(TINY) * math.sqrt(min(a.area, b.area)) * mpmath.expj(mpf("0.7"))
        one = edges_of(a, mpc(1), mpc(0))
        two = edges_of(b, turn_b * back, place + beside)
        total = mpf(0)
        for mine, other in ((one, two), (two, one)):
            for e in mine:
                cuts = [mpf(0), mpf(1)]
                for f in other:
                    for z in _meetings(e, f) if _near(e, f) else []:
                        t, u = e.parameter(z), f.parameter(z)
                        if 0 < t < 1 and 0 < u < 1:
                            cuts.append(t)
                cuts.sort()
                for t, u in itertools.pairwise(cuts):
                    if u > t and _inside(other, e.at(t + (u - t) * MIDDLE)):
                        total += e.green(t, u)
        return float(total)
