"""Whether rings of straight edges and arcs bound one region: decided by the arcs themselves, not by points on them.

Two edges meet in at most two points, and those are known in closed form (line and line, line and circle, circle and
circle); where edges lie on each other, or touch with an end, an end of one lies on the other. So all places where rings
meet are found among these points. A ring that meets itself is none. Where two rings meet they may touch: the pieces
between the meeting points say whether one crosses the other, each by one point of it.

What is nearer than `_ROOM` roundings is in the same place. Notation as in `arcs.py`.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from .arcs import Points

_ROOM = 64 * float(np.finfo(np.float64).eps)
"""Over the largest coordinate and radius: some ten roundings of each of the steps from arcs to a meeting point."""
_SHORT = 1e-6
"""Of an edge's length: where two edges are tangent, rounding moves their meeting point by the root of `_ROOM` (1.2e-7
of a radius). What lies on the other edge for no longer than this touches it; for longer: the edge is shared."""

Indices = NDArray[np.intp]


class _Edges(NamedTuple):
    """All edges: ends, centre and signed radius, ring, the next edge of that ring. Lengths about a common middle."""

    p: Points
    q: Points
    c: Points
    r: Points
    ring: Indices
    following: Indices

    @property
    def chord(self) -> Points:
        return self.q - self.p

    def reach(self) -> tuple[Points, Points]:
        """Lower left and upper right corners (n, 2) of boxes around the edges.

        An arc of half a turn at the most stays within a square about its chord's middle, a diagonal of two half chords.
        """
        bow = np.where(self.r == 0, 0.0, np.hypot(*self.chord.T) / 2)[:, None]
        return np.minimum(self.p, self.q) - bow, np.maximum(self.p, self.q) + bow

    def at(self, k: int, t: float) -> Points:
        """The point of edge k a fraction t along it."""
        if self.r[k] == 0:
            return self.p[k] + t * (self.q[k] - self.p[k])
        start, sweep = self._angles(k)
        angle = start + t * sweep
        return self.c[k] + abs(self.r[k]) * np.array((np.cos(angle), np.sin(angle)))

    def along(self, k: int, where: Points) -> Points:
        """What fraction of edge k lies before each of the points (n, 2) of it."""
        if self.r[k] == 0:
            chord = self.q[k] - self.p[k]
            return np.asarray((where - self.p[k]) @ chord / (chord @ chord))
        start, sweep = self._angles(k)
        away = where - self.c[k]
        # from the middle of the arc, where no angle is near the jump of half a turn
        turned = np.arctan2(away[:, 1], away[:, 0]) - (start + sweep / 2)
        return 0.5 + (turned - 2 * np.pi * np.round(turned / (2 * np.pi))) / sweep

    def _angles(self, k: int) -> tuple[float, float]:
        a, b = self.p[k] - self.c[k], self.q[k] - self.c[k]
        sweep = np.arctan2(abs(a[0] * b[1] - a[1] * b[0]), a @ b) * np.sign(self.r[k])
        return float(np.arctan2(a[1], a[0])), float(sweep)


def check_simple(rings: Sequence[Points], arcs: Sequence[Points], names: Sequence[str]) -> None:
    """ValueError naming the fault and the place, unless the rings bound one region: the first with holes in it.

    rings, arcs: as `Outline` has them, in either sense. A ring neither crosses nor touches itself; holes lie inside the
    first ring and outside each other, and may touch in single points as long as the region stays in one piece.
    """
    points = np.concatenate(rings)
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    lengths = [len(ring) for ring in rings]
    start = np.repeat(np.cumsum([0, *lengths[:-1]]), lengths)
    edge = np.arange(len(points))
    following = np.where(np.append(start[1:], -1) == start, edge + 1, start)
    bend = np.concatenate(arcs)
    centre = np.where(bend[:, 2:] == 0, 0.0, bend[:, :2] - middle)
    points = points - middle
    edges = _Edges(
        points, points[following], centre, bend[:, 2], np.repeat(np.arange(len(rings)), lengths), following
    )
    i, j, where = _meetings(edges)
    own = edges.ring[i] == edges.ring[j]
    if own.any():
        first = int(np.argmax(own))
        raise ValueError(
            f"{names[edges.ring[i[first]]]} must not cross or touch itself; it does {_place(where[first] + middle)}"
        )
    _check_sides(edges, i, j, where, middle, names)
    _check_whole(edges, i, j, where, middle)


def _place(where: Points) -> str:
    return f"at ({where[0]:.6g}, {where[1]:.6g})"


def _room(edges: _Edges, i: Indices) -> Points:
    """What rounding may move a meeting point of edge i by (length)."""
    return _ROOM * (np.abs(edges.p).max() + np.abs(edges.r[i]))


def _meetings(edges: _Edges) -> tuple[Indices, Indices, Points]:
    """All (edge, edge, point (n, 2)) in which edges meet, but for the corners that neighbours share."""
    length = np.hypot(*edges.chord.T)
    low, high = edges.reach()
    boxes = shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1])
    i, j = shapely.STRtree(boxes).query(boxes)
    i, j = i[i < j], j[i < j]
    room = _room(edges, i) + _room(edges, j)
    found = np.stack(
        [*_intersections(edges, i, j, room), edges.p[i], edges.q[i], edges.p[j], edges.q[j]], axis=1
    )
    near = room[:, None]
    meets = _on(edges, i[:, None], found, near) & _on(edges, j[:, None], found, near)
    for before, after in ((i, j), (j, i)):
        # edge `before` ends where `after` starts: what they enclose up to a point at a distance d from there is as
        # thick as their curvatures bend them apart, d^2 / 8 each
        neighbours = edges.following[before] == after
        away = np.hypot(*np.moveaxis(found - edges.q[before][:, None], 2, 0))
        with np.errstate(divide="ignore"):
            bend = np.where(edges.r == 0, 0.0, 1 / edges.r)
        apart = np.abs(bend[before] + bend[after])[:, None] * away**2 / 8
        short = _SHORT * np.minimum(length[before], length[after])[:, None]
        meets &= ~(neighbours[:, None] & ((away <= 4 * near) | ((apart <= near) & (away <= short))))
    pair, which = np.nonzero(meets)
    return i[pair], j[pair], found[pair, which]


def _on(edges: _Edges, k: Indices, where: Points, room: Points) -> NDArray[np.bool_]:
    """Whether each point lies on edge k, give or take `room`. Not a number lies on none."""
    chord = edges.chord[k]
    length = np.hypot(chord[..., 0], chord[..., 1])
    from_p = where - edges.p[k]
    along = (from_p * chord).sum(axis=-1) / length
    left = (chord[..., 0] * from_p[..., 1] - chord[..., 1] * from_p[..., 0]) / length
    radius = edges.r[k]
    off = np.hypot(*np.moveaxis(where - edges.c[k], -1, 0)) - np.abs(radius)
    # no arc of half a turn or less goes beyond its ends
    between = (along >= -room) & (along <= length + room)
    bent = (np.abs(off) <= room) & (left * np.sign(radius) <= room)
    return between & np.where(radius == 0, np.abs(left) <= room, bent)


def _intersections(edges: _Edges, i: Indices, j: Indices, room: Points) -> tuple[Points, Points]:
    """The two points (n, 2) in which the lines or circles of edges i and j meet; not a number: there is none.

    Lines of neighbours meet in their corner, and nowhere else.
    """
    swap = (edges.r[i] != 0) & (edges.r[j] == 0)  # a line first
    i, j = np.where(swap, j, i), np.where(swap, i, j)
    u, v = edges.chord[i], edges.chord[j]
    ri, rj = np.abs(edges.r[i]), np.abs(edges.r[j])
    with np.errstate(divide="ignore", invalid="ignore"):
        t = _cross(edges.p[j] - edges.p[i], v) / _cross(u, v)
        neighbours = (edges.following[i] == j) | (edges.following[j] == i)
        lines = np.where(neighbours, np.nan, t)[:, None] * u + edges.p[i]
        # a line and a circle: the foot of its centre, and half the chord to either side
        e = u / np.hypot(*u.T)[:, None]
        to_c = edges.c[j] - edges.p[i]
        distance = _cross(e, to_c)
        half = np.sqrt(np.maximum((rj - distance) * (rj + distance), 0.0))
        half = np.where(np.abs(distance) <= rj + room, half, np.nan)[:, None] * e
        foot = edges.p[i] + (e * to_c).sum(axis=1)[:, None] * e
        # two circles: the foot of their chord on the line of centres, and Heron's half chord
        between = edges.c[j] - edges.c[i]
        d = np.hypot(*between.T)
        none = (d > ri + rj + room) | (d < np.abs(ri - rj) - room) | (d == 0)
        e = between / np.where(none, np.nan, d)[:, None]
        reach = (d * d + (ri - rj) * (ri + rj)) / (2 * d)
        chord = np.sqrt(np.maximum((ri + rj - d) * (d - ri + rj) * (d + ri - rj) * (d + ri + rj), 0.0)) / (
            2 * d
        )
        centre = edges.c[i] + reach[:, None] * e
        across = chord[:, None] * np.column_stack((-e[:, 1], e[:, 0]))
    straight, round_ = (rj == 0)[:, None], (ri != 0)[:, None]
    return (
        np.where(straight, lines, np.where(round_, centre - across, foot - half)),
        np.where(straight, np.nan, np.where(round_, centre + across, foot + half)),
    )


def _cross(a: Points, b: Points) -> Points:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def _inside(edges: _Edges, ring: int, where: Points) -> bool:
    """Whether a point (2,) off the ring lies in it: in the polygon of its chords, or else in what an arc adds to it."""
    of = edges.ring == ring
    p, q, r = edges.p[of], edges.q[of], edges.r[of]
    left = _cross(q - p, where - p) > 0  # the same answer for chord and arc: where they disagree is nowhere
    up = q[:, 1] > where[1]
    met = ((p[:, 1] > where[1]) != up) & (left == up)  # a ray to the right
    within = np.hypot(*(where - edges.c[of]).T) < np.abs(r)
    bulged = (r != 0) & within & (left == (r < 0))
    return bool((np.count_nonzero(met) + np.count_nonzero(bulged)) % 2)


def _check_sides(
    edges: _Edges, i: Indices, j: Indices, where: Points, middle: Points, names: Sequence[str]
) -> None:
    """ValueError unless every piece of a hole lies inside the first ring, and outside all other holes."""
    rings = int(edges.ring[-1]) + 1
    first = np.searchsorted(edges.ring, np.arange(rings))
    low, high = edges.reach()
    low, high = np.minimum.reduceat(low, first), np.maximum.reduceat(high, first)
    for mine in range(1, rings):
        # only where boxes overlap; the first ring has to be looked at in any case
        near = np.flatnonzero(((low <= high[mine]) & (high >= low[mine])).all(axis=1))
        for other in np.union1d(near, 0).tolist():
            if other == mine:
                continue
            ours = ((edges.ring[i] == mine) & (edges.ring[j] == other), i)
            theirs = ((edges.ring[j] == mine) & (edges.ring[i] == other), j)
            there = np.flatnonzero(edges.ring == other)
            for spot, short in _pieces(edges, mine, [(k[of], where[of]) for of, k in (ours, theirs)]):
                on = bool(_on(edges, there, spot[None], _room(edges, there)).any())
                if short if on else _inside(edges, other, spot) == (other == 0):
                    continue
                place = _place(spot + middle)
                if other == 0 and on:
                    raise ValueError(
                        f"{names[mine]} must not share an edge with the outer ring; it does {place}"
                    )
                if other == 0:
                    raise ValueError(f"{names[mine]} must lie inside the outer ring; it is outside {place}")
                raise ValueError(f"{names[mine]} and {names[other]} must be apart; they meet {place}")


def _pieces(edges: _Edges, ring: int, cuts: list[tuple[Indices, Points]]) -> list[tuple[Points, bool]]:
    """The pieces into which the cuts (edges, points of them) divide the ring's edges: a point (2,) of each, and whether
    it is short; of the edges that are not cut, one stands for all."""
    edge, where = np.concatenate([k for k, _ in cuts]), np.concatenate([w for _, w in cuts])
    found = []
    for k in np.unique(edge):
        ends = np.unique(np.clip([0.0, 1.0, *edges.along(k, where[edge == k])], 0.0, 1.0))
        found += [(edges.at(k, (a + b) / 2), bool(b - a <= _SHORT)) for a, b in pairwise(ends)]
    whole = np.setdiff1d(np.flatnonzero(edges.ring == ring), edge)
    if len(whole):
        found.append((edges.at(int(whole[0]), 0.5), False))
    return found


def _check_whole(edges: _Edges, i: Indices, j: Indices, where: Points, middle: Points) -> None:
    """ValueError if rings that touch close a chain, which parts what they bound."""
    size = _SHORT * np.abs(edges.p).max()
    spots: list[Points] = []
    group = list(range(int(edges.ring[-1]) + 1))  # rings, then spots: what hangs together has one number
    hung = set()
    for a, b, spot in zip(edges.ring[i], edges.ring[j], where):
        near = [n for n, other in enumerate(spots) if np.abs(other - spot).max() <= size]
        if not near:
            spots.append(spot)
            near = [len(spots) - 1]
            group.append(len(group))
        node = len(group) - len(spots) + near[0]
        for ring in {int(a), int(b)}:
            if (ring, near[0]) in hung:
                continue
            hung.add((ring, near[0]))
            if group[ring] == group[node]:
                raise ValueError(
                    f"rings must bound one connected region; those that touch {_place(spot + middle)} part it"
                )
            group = [group[ring] if g == group[node] else g for g in group]
