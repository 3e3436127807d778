"""Overlap of two outlines with arcs, worked out with 64 bits of mantissa and without the kernel's ideas.

Every edge is cut wherever it meets an edge of the other outline; of each piece one point is asked, by its winding
number, whether it lies inside the other; Green's theorem is summed over the pieces that do. No sign at an end decides
anything, no order along a ring is needed for area and centroid, nothing is shared with `rigidarea.contact`. Loops, for
the number of regions, follow the pieces from crossing to crossing.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

W = np.longdouble
TAU = 2 * W(np.pi) + 2 * W(1.2246467991473532e-16)  # to the wide type's own rounding
#: Whether the machine has such a type (x86 has, others may not).
WIDE = bool(np.finfo(W).eps < 1e-18)
_NODES, _WEIGHTS = (np.asarray(v, W) for v in np.polynomial.legendre.leggauss(24))


class Overlap(NamedTuple):
    """What is common to two outlines, in A's frame."""

    area: Any
    centroid: np.ndarray  # (2,); zeros where there is no area
    regions: list[
        tuple[Any, np.ndarray]
    ]  # (area, centroid) of each loop with a positive area, holes not taken off
    holes: int
    near: float  # least distance of two crossings (length), infinity for less than two
    least: float  # smallest loop's area, absolute (length^2)
    # Whether every piece has one that goes on where it ends. Not so where boundaries cross in a corner of a flat arc,
    # whose ends the doubles of its centre and radius leave beside its circle by up to 2^-52 of the radius: there the
    # outlines themselves have gaps, and what the loops are is not determined. Area and centroid of all together are.
    closed: bool


class Edges(NamedTuple):
    """All edges of an outline: ends, centres, signed radii, start and sweep of arcs (radians)."""

    p: np.ndarray
    q: np.ndarray
    c: np.ndarray
    r: np.ndarray
    start: np.ndarray
    sweep: np.ndarray

    def at(self, i: np.ndarray, t: np.ndarray) -> np.ndarray:
        """Points (n, 2) at parameters t, 0 to 1, of edges i."""
        angle = self.start[i] + t * self.sweep[i]
        arc = self.c[i] + np.abs(self.r[i])[:, None] * np.stack([np.cos(angle), np.sin(angle)], 1)
        return np.where(self.r[i][:, None] == 0, self.p[i] + t[:, None] * (self.q[i] - self.p[i]), arc)


def edges_of(outline: Any, x: Any = 0, y: Any = 0, angle: Any = 0) -> Edges:
    """The outline's edges, turned by angle about the origin, then shifted by (x, y)."""
    p = [np.asarray(ring, W) for ring in outline.rings]
    arcs = outline.arcs or [np.zeros((len(ring), 3)) for ring in p]
    q = np.concatenate([np.roll(ring, -1, axis=0) for ring in p])
    bow = np.concatenate([np.asarray(arc, W) for arc in arcs])
    c, s = np.cos(W(angle)), np.sin(W(angle))
    turn, shift = np.array([[c, s], [-s, c]]), np.array([x, y], W)
    a, b, m = (v @ turn + shift for v in (np.concatenate(p), q, bow[:, :2]))
    r = bow[:, 2]
    start = np.arctan2(*(a - m).T[::-1])
    end = np.arctan2(*(b - m).T[::-1])
    sweep = np.where(r > 0, (end - start) % TAU, -((start - end) % TAU))
    return Edges(a, b, m, r, start, np.where(r == 0, W(0), sweep))


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _meetings(a: Edges, b: Edges) -> tuple[np.ndarray, ...]:
    """(i, t, j, u): edge i of A at t is edge j of B at u."""
    reach_a = np.hypot(*(a.q - a.p).T) / 2 + np.where(a.r == 0, W(0), np.abs(a.r) * (1 - np.cos(a.sweep / 2)))
    reach_b = np.hypot(*(b.q - b.p).T) / 2 + np.where(b.r == 0, W(0), np.abs(b.r) * (1 - np.cos(b.sweep / 2)))
    apart = (a.p + a.q)[:, None] / 2 - (b.p + b.q)[None] / 2
    close = np.hypot(apart[..., 0], apart[..., 1]) <= (reach_a[:, None] + reach_b) * (1 + W(1e-9))
    i, j = np.nonzero(close)
    found = []
    with np.errstate(divide="ignore", invalid="ignore"):
        lines = (a.r[i] == 0) & (b.r[j] == 0)
        k, m = i[lines], j[lines]
        u, v = a.q[k] - a.p[k], b.q[m] - b.p[m]
        t = _cross(b.p[m] - a.p[k], v) / _cross(u, v)
        found.append((k, m, a.p[k] + t[:, None] * u))
        for first, second, swap in ((a, b, False), (b, a, True)):
            one, two = (j, i) if swap else (i, j)
            mixed = (first.r[one] == 0) & (second.r[two] != 0)
            k, m = one[mixed], two[mixed]
            u, w = first.q[k] - first.p[k], second.c[m] - first.p[k]
            length = np.hypot(*u.T)
            u = u / length[:, None]
            along, off = (u * w).sum(1), _cross(u, w)
            half = np.sqrt((np.abs(second.r[m]) - off) * (np.abs(second.r[m]) + off))
            for sign in (-1, 1):
                where = first.p[k] + (along + sign * half)[:, None] * u
                found.append((m, k, where) if swap else (k, m, where))
        both = (a.r[i] != 0) & (b.r[j] != 0)
        k, m = i[both], j[both]
        ra, rb, d = np.abs(a.r[k]), np.abs(b.r[m]), b.c[m] - a.c[k]
        d2 = (d * d).sum(1)
        dist = np.sqrt(d2)
        heron = (ra + rb - dist) * (ra + rb + dist) * (dist - ra + rb) * (dist + ra - rb)
        half = np.sqrt(heron) / (2 * d2)
        foot = (d2 + (ra - rb) * (ra + rb)) / (2 * d2)
        for sign in (-1, 1):
            offset = foot[:, None] * d + sign * half[:, None] * np.stack([-d[:, 1], d[:, 0]], 1)
            found.append((k, m, a.c[k] + offset))
    k, m, where = (np.concatenate(column) for column in zip(*found))
    fine = np.isfinite(where).all(1)
    k, m, where = k[fine], m[fine], where[fine]
    t, u = _parameter(a, k, where), _parameter(b, m, where)
    on = (t > 0) & (t < 1) & (u > 0) & (u < 1)
    return k[on], t[on], m[on], u[on]


def _parameter(e: Edges, i: np.ndarray, where: np.ndarray) -> np.ndarray:
    chord = e.q[i] - e.p[i]
    straight = ((where - e.p[i]) * chord).sum(1) / (chord * chord).sum(1)
    angle = np.arctan2(*(where - e.c[i]).T[::-1])
    turned = np.where(e.r[i] > 0, (angle - e.start[i]) % TAU, (e.start[i] - angle) % TAU)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(e.r[i] == 0, straight, turned / np.abs(e.sweep[i]))


def _winding(e: Edges, where: np.ndarray) -> np.ndarray:
    """Times that the outline goes round each point (n,)."""
    u, v = e.p[None] - where[:, None], e.q[None] - where[:, None]
    angle = np.arctan2(_cross(u, v), (u * v).sum(2))
    # seen from between chord and arc, the boundary goes round the other way
    w = where[:, None] - e.c[None]
    between = ((w * w).sum(2) < e.r**2) & (_cross(u, v) * e.r < 0) & (e.r != 0)
    angle = angle + np.where(between, TAU * np.sign(e.r), W(0))
    return np.rint((angle.sum(1) / TAU).astype(float)).astype(int)


def _green(p: np.ndarray, q: np.ndarray, radius: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """(area, first moments) (n, 3) by Green's theorem, of edges p -> q and arcs of signed radii (0: straight).

    angle: that an arc sweeps, of which the chord says little where it is wide.
    """
    d = q - p
    straight = np.stack(
        [
            _cross(p, q) / 2,
            d[:, 1] * (p[:, 0] ** 2 + p[:, 0] * q[:, 0] + q[:, 0] ** 2) / 6,
            -d[:, 0] * (p[:, 1] ** 2 + p[:, 1] * q[:, 1] + q[:, 1] ** 2) / 6,
        ],
        1,
    )
    # what lies between chord and arc, by Gauss along the arc about the chord's middle, where nothing cancels however
    # flat it is (as in `rigidarea.geometry.arcs.segments`); moments of degree 4 in sine and cosine of half a turn
    size, half = np.abs(radius)[:, None], np.abs(angle)[:, None] / 2
    psi = half * _NODES
    along = size * np.sin(psi)
    across = 2 * size * np.sin((half + psi) / 2) * np.sin((half - psi) / 2)
    sector = size * (along * np.sin(psi) + across * np.cos(psi)) * half * _WEIGHTS
    area = np.sign(radius) * sector.sum(1) / 2
    length = np.maximum(np.hypot(*d.T), np.finfo(float).tiny)
    right = np.stack([d[:, 1], -d[:, 0]], 1) / length[:, None]
    first = ((across * sector).sum(1) / 3)[:, None] * right + area[:, None] * (p + q) / 2
    bent = np.column_stack([area, first])
    return straight + np.where(radius[:, None] == 0, W(0), bent)


def overlap(a: Any, b: Any, x: Any, y: Any, angle: Any) -> Overlap:
    """A with B turned by angle and shifted by (x, y).

    Pieces that follow each other share the very point where they meet, and each loop is measured about a point of its
    own: of a sliver nothing is left of moments about anywhere else, nor of ends that only nearly meet.
    """
    ea, eb = edges_of(a), edges_of(b, x, y, angle)
    i, t, j, u = _meetings(ea, eb)
    spots = ea.at(i, t)
    columns: list[tuple[np.ndarray, ...]] = []
    for mine, other, edge, where, offset in ((ea, eb, i, t, 0), (eb, ea, j, u, 1)):
        n = len(mine.r)
        order = np.lexsort((where, edge))
        index = np.concatenate([np.arange(n), edge[order]])
        share = np.concatenate([np.zeros(n, W), where[order]])
        node = np.concatenate([(2 + offset) * 10**6 + np.arange(n), order])  # vertices, then crossings
        place = np.concatenate([mine.p, spots[order]])
        order = np.lexsort((share, index))
        index, share, node, place = index[order], share[order], node[order], place[order]
        last = np.append(index[1:] != index[:-1], True)
        after = np.where(last, W(1), np.append(share[1:], W(1)))
        heads = np.flatnonzero(np.append(True, last[:-1]))
        following = np.where(
            last, heads[_following(a if offset == 0 else b)[index]], np.arange(1, len(index) + 1)
        )
        inside = _winding(other, mine.at(index, (share + after) / 2)) > 0
        swept = (after - share) * mine.sweep[index]
        pieces = (node, node[following], place, place[following], mine.r[index], swept)
        columns.append(tuple(column[inside] for column in pieces))
    start, end, p, q, radius, swept = (np.concatenate(column) for column in zip(*columns))
    chains, closed = _chains(start, end)
    if not closed:
        chains = [list(range(len(start)))]
    loops = []
    for chain in filter(None, chains):
        about = p[chain[0]]
        area, *first = _green(p[chain] - about, q[chain] - about, radius[chain], swept[chain]).sum(0)
        if area != 0:
            loops.append((area, about + np.array(first) / area))
    total = sum((loop[0] for loop in loops), W(0))
    centroid = np.zeros(2, W)
    if total > 0:
        about = loops[0][1]
        centroid = about + sum(area * (at - about) for area, at in loops) / total
    near = np.inf
    if len(spots) > 1:
        gaps = np.hypot(*(spots[:, None] - spots[None]).transpose(2, 0, 1))
        near = float(gaps[np.triu_indices(len(spots), 1)].min())
    regions = [loop for loop in loops if loop[0] > 0]
    least = min((abs(float(loop[0])) for loop in loops), default=0.0)
    return Overlap(total, centroid, regions, len(loops) - len(regions), near, least, closed)


def _following(outline: Any) -> np.ndarray:
    out, n = [], 0
    for ring in outline.rings:
        out.append(n + np.roll(np.arange(len(ring)), -1))
        n += len(ring)
    return np.concatenate(out)


def _chains(starts: np.ndarray, ends: np.ndarray) -> tuple[list[list[int]], bool]:
    """Which pieces follow one another, chain by chain, and whether all chains close."""
    following = {int(s): k for k, s in enumerate(starts)}
    done: set[int] = set()
    chains = []
    closed = len(following) == len(starts)
    for first in range(len(starts)):
        chain: list[int] = []
        k = first
        while k not in done:
            done.add(k)
            chain.append(k)
            k = following.get(int(ends[k]), -1)
            if k < 0:
                closed = False
                break
        if chain:
            closed = closed and k == first
            chains.append(chain)
    return chains, closed
