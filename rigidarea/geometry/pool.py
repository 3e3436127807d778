"""The gate: outlines cast once into the arrays that the kernels read, with a static hierarchy of boxes.

Kernels never validate: what is in a `Pool` is contiguous float64 / int32, counter-clockwise rings with clockwise
holes, no repeated points, no arc of more than half a turn, coordinates relative to the middle of the outline's bounding
box (so that an outline a million lengths from its body's origin keeps its digits), of a disc relative to its centre.

The hierarchy is implicit: `LEAF` consecutive edges share a leaf, the leaves are the last 2^d nodes of a binary
heap (node 1 the root, children 2n and 2n + 1). Consecutive edges of a ring are neighbours in space too, which makes
order along the ring as good a key as any; and nothing has to be stored but the boxes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np

from ..compile.jit import njit
from ..compile.raw_memory import record
from .teeth import mouth_of

#: Edges to a leaf. More: fewer boxes tested, more edge pairs; 4 was fastest on gears and on 64-gons.
LEAF = 4

#: One outline in a pool: where its points, rings and boxes lie, and the few numbers that steps need of it.
HEAD = record(
    [
        ("point", "i4"),  # first point
        ("count", "i4"),  # number of points (= edges)
        ("ring", "i4"),  # first ring
        ("rings", "i4"),
        ("box", "i4"),  # node n of the hierarchy is boxes[box + n]
        ("leaves", "i4"),  # a power of two
        ("convex", "i4"),  # and of MOST_WALKED edges at the most
        ("arcs", "i4"),  # number of edges that are arcs
        ("disc", "i4"),  # its one ring is a circle, about (0, 0)
        ("x", "f8"),  # middle of the bounding box, body frame (length)
        ("y", "f8"),
        ("radius", "f8"),  # about that middle (length)
        ("area", "f8"),  # (length^2)
        ("face", "f8"),  # longest chord that a straight edge cuts off at a shallow depth (length)
        ("mouth", "f8"),  # width of the slots between its teeth (length); infinity: it has none
    ],
)


class Pool(NamedTuple):
    """Outlines as the kernels see them: P points, R rings, N boxes, O outlines."""

    points: np.ndarray  # (P, 2) float64
    following: np.ndarray  # (P,) int32: the next point along the ring
    ring_of: np.ndarray  # (P,) int32
    rings: np.ndarray  # (R, 2) int32: first point, one past the last
    boxes: np.ndarray  # (N, 4) float64: middle x, y, half width, half height
    # (P, 4) float64: centre and signed radius of the arc to the following point, and how far it may be from its chord;
    # zeros: a straight edge
    arcs: np.ndarray
    heads: np.ndarray  # (O,) HEAD


class HasRings(Protocol):
    """What the gate needs of an outline (`rigidarea.Outline` is one)."""

    @property
    def rings(self) -> tuple[np.ndarray, ...]: ...
    @property
    def arcs(self) -> tuple[np.ndarray, ...]: ...
    @property
    def area(self) -> float: ...
    @property
    def centroid(self) -> tuple[float, float]: ...
    @property
    def bounds(self) -> tuple[float, float, float, float]: ...


#: Convex outlines of more edges are not walked round: by then the hierarchy is faster.
MOST_WALKED = 96
#: Depth at which `face` is measured, as a fraction of the outline's extent: how deep contacts are expected to go.
FACE_DEPTH = 0.02


@njit
def _on_arc(p: np.ndarray, q: np.ndarray, r: float, x: float, y: float) -> bool:
    """Whether a point of its circle lies on the arc p -> q."""
    return ((q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0])) * r < 0.0


@njit
def boxes_of(points: np.ndarray, following: np.ndarray, arcs: np.ndarray) -> tuple[np.ndarray, int]:
    """The hierarchy over the edges (point, following point): boxes (2 leaves, 4), leaves."""
    n = len(points)
    leaves = 1
    while leaves * LEAF < n:
        leaves *= 2
    edge = np.empty((2 * leaves, 4))  # low x, low y, high x, high y
    edge[:, :2] = np.inf
    edge[:, 2:] = -np.inf
    for i in range(n):
        node = leaves + i // LEAF
        for p in (i, np.int64(following[i])):
            for d in range(2):
                edge[node, d] = min(edge[node, d], points[p, d])
                edge[node, 2 + d] = max(edge[node, 2 + d], points[p, d])
        r = arcs[i, 2]
        if r != 0.0:
            for d in range(2):
                for sign in (-1.0, 1.0):
                    x = arcs[i, 0] + (sign * abs(r) if d == 0 else 0.0)
                    y = arcs[i, 1] + (sign * abs(r) if d == 1 else 0.0)
                    if _on_arc(points[i], points[following[i]], r, x, y):
                        edge[node, d] = min(edge[node, d], arcs[i, d] + sign * abs(r))
                        edge[node, 2 + d] = max(edge[node, 2 + d], arcs[i, d] + sign * abs(r))
    for node in range(leaves - 1, 0, -1):
        for d in range(2):
            edge[node, d] = min(edge[2 * node, d], edge[2 * node + 1, d])
            edge[node, 2 + d] = max(edge[2 * node, 2 + d], edge[2 * node + 1, 2 + d])
    boxes = np.empty((2 * leaves, 4))
    for node in range(2 * leaves):
        for d in range(2):
            if edge[node, d] <= edge[node, 2 + d]:
                boxes[node, d] = 0.5 * (edge[node, d] + edge[node, 2 + d])
                boxes[node, 2 + d] = 0.5 * (edge[node, 2 + d] - edge[node, d])
            else:  # an empty box touches nothing
                boxes[node, d] = 0.0
                boxes[node, 2 + d] = -1e300
    return boxes, leaves


@njit
def _face(points: np.ndarray, x: float, y: float) -> float:
    """The chord for which chord (1 + arm^2 / gyration^2) is largest, over cuts at FACE_DEPTH (theory 3).

    A straight edge pressed `FACE_DEPTH * extent` into the outline cuts off a chord (of a gear: one tooth's); its
    stiffness is k chord, its leverage on a free body the arm of its middle about the centroid (x, y). Directions are
    those of the outline's own edges, 64 at the most.
    """
    n = len(points)
    extent = max(points[:, 0].max() - points[:, 0].min(), points[:, 1].max() - points[:, 1].min())
    gyration2 = extent**2 / 8.0  # of a disc of that diameter: only the ranking depends on it
    step = max(1, n // 64)
    best = -1.0
    best_chord = 0.0
    cuts = np.empty(n + 1)
    for start in range(0, n, step):
        end = (start + step) % n
        tx = points[end, 0] - points[start, 0]
        ty = points[end, 1] - points[start, 1]
        length = math.hypot(tx, ty)
        if length == 0.0:
            continue
        tx /= length
        ty /= length
        top = -np.inf
        for i in range(n):
            top = max(top, points[i, 0] * ty - points[i, 1] * tx)
        level = top - FACE_DEPTH * extent
        crossings = 0
        j = n - 1
        for i in range(n):
            h0 = points[j, 0] * ty - points[j, 1] * tx - level
            h1 = points[i, 0] * ty - points[i, 1] * tx - level
            if (h0 > 0.0) != (h1 > 0.0):
                f = h0 / (h0 - h1)
                s0 = points[j, 0] * tx + points[j, 1] * ty
                s1 = points[i, 0] * tx + points[i, 1] * ty
                cuts[crossings] = s0 + f * (s1 - s0)
                crossings += 1
            j = i
        found = np.sort(cuts[:crossings])
        for k in range(0, crossings - 1, 2):  # the line enters and leaves the outline in turn
            chord = found[k + 1] - found[k]
            arm = 0.5 * (found[k] + found[k + 1]) - (x * tx + y * ty)
            rank = chord * (1.0 + arm * arm / gyration2)
            if rank > best:
                best = rank
                best_chord = chord
    return best_chord


@njit
def _convex(points: np.ndarray, arcs: np.ndarray) -> bool:
    """Whether a ring is convex, so that clipping it by its own edges or walking round it is safe.

    Every point lies left of every straight edge's line, and at every point the tangent turns left. (To rounding: an
    edge of rounding length may look the wrong way in an outline that is convex but for rounding.)
    """
    n = len(points)
    size = np.abs(points).max()
    for i in range(n):
        j = (i + 1) % n
        ex = points[j, 0] - points[i, 0]
        ey = points[j, 1] - points[i, 1]
        length = math.hypot(ex, ey)
        if arcs[i, 2] < 0.0:
            return False
        for k in range(n):
            out = ex * (points[k, 1] - points[i, 1]) - ey * (points[k, 0] - points[i, 0])
            if out < -1e-13 * size * length:
                return False
        if arcs[i, 2] > 0.0 or arcs[j, 2] > 0.0:
            ax = -(points[j, 1] - arcs[i, 1]) if arcs[i, 2] > 0.0 else ex
            ay = points[j, 0] - arcs[i, 0] if arcs[i, 2] > 0.0 else ey
            k = (j + 1) % n
            bx = -(points[j, 1] - arcs[j, 1]) if arcs[j, 2] > 0.0 else points[k, 0] - points[j, 0]
            by = points[j, 0] - arcs[j, 0] if arcs[j, 2] > 0.0 else points[k, 1] - points[j, 1]
            if ax * by - ay * bx < -1e-13 * size * (math.hypot(ax, ay) + math.hypot(bx, by)):
                return False
    return True


@njit
def _chords(points: np.ndarray, arcs: np.ndarray) -> np.ndarray:
    """A ring with each of its arcs as 32 chords: what `_face` and `mouth_of` need of it."""
    n = len(points)
    out = np.empty((32 * n, 2))
    m = 0
    for i in range(n):
        out[m] = points[i]
        m += 1
        r = arcs[i, 2]
        if r == 0.0:
            continue
        j = (i + 1) % n
        ax = points[i, 0] - arcs[i, 0]
        ay = points[i, 1] - arcs[i, 1]
        bx = points[j, 0] - arcs[i, 0]
        by = points[j, 1] - arcs[i, 1]
        step = math.atan2(abs(ax * by - ay * bx), ax * bx + ay * by) / 32.0
        if r < 0.0:
            step = -step
        for k in range(1, 32):
            c = math.cos(k * step)
            s = math.sin(k * step)
            out[m, 0] = arcs[i, 0] + c * ax - s * ay
            out[m, 1] = arcs[i, 1] + s * ax + c * ay
            m += 1
    return out[:m]


@njit
def _through_ends(points: np.ndarray, arcs: np.ndarray, following: np.ndarray, disc: bool) -> None:
    """Make ends lie on their circles where they are further off than the signs at arcs allow for (`arc`).

    Far from the body's origin, ends and centres are rounded by that much. An arc then goes through its ends, its
    middle where it is across the chord; of a disc the ends move.
    """
    size = np.abs(points).max()
    for i in range(len(points)):
        r = arcs[i, 2]
        if r == 0.0:
            continue
        px, py = points[i, 0] - arcs[i, 0], points[i, 1] - arcs[i, 1]
        qx, qy = points[following[i], 0] - arcs[i, 0], points[following[i], 1] - arcs[i, 1]
        off = max(abs(math.hypot(px, py) - abs(r)), abs(math.hypot(qx, qy) - abs(r)))
        if off <= 8.0 * 2.0**-52 * max(size, abs(r)):
            continue
        if disc:
            points[i] *= r / math.hypot(px, py)
            continue
        ux = qx - px
        uy = qy - py
        along = 0.5 * ((px + qx) * ux + (py + qy) * uy) / (ux * ux + uy * uy)
        arcs[i, 0] += along * ux
        arcs[i, 1] += along * uy
        arcs[i, 2] = math.copysign(math.hypot(px - along * ux, py - along * uy), r)


@njit
def _prepare(
    points: np.ndarray, arcs: np.ndarray, starts: np.ndarray, x: float, y: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, tuple[int, bool, int, bool, float, float, float]]:
    """Everything of one outline but its rings: following, ring_of, boxes, and the numbers of its head.

    From its points and arcs about the middle of its box, where its rings start in them, and its centroid (x, y). Arcs
    are put through their ends, and their last column is filled in.
    """
    n = len(points)
    following = np.arange(1, n + 1).astype(np.int32)
    ring_of = np.empty(n, np.int32)
    for r in range(len(starts) - 1):
        following[starts[r + 1] - 1] = starts[r]
        ring_of[starts[r] : starts[r + 1]] = r
    disc = len(starts) == 2 and arcs[0, 2] > 0.0
    for i in range(n):
        disc = disc and arcs[i, 0] == 0.0 and arcs[i, 1] == 0.0 and arcs[i, 2] == arcs[0, 2]
    _through_ends(points, arcs, following, disc)
    bent = 0
    radius = 0.0
    for i in range(n):
        radius = max(radius, math.hypot(points[i, 0], points[i, 1]))
        r = arcs[i, 2]
        if r == 0.0:
            continue
        bent += 1
        p = points[i]
        q = points[following[i]]
        far = math.hypot(arcs[i, 0], arcs[i, 1])
        reach = far + abs(r)
        if far > 0.0 and _on_arc(p, q, r, arcs[i, 0] * reach / far, arcs[i, 1] * reach / far):
            radius = max(radius, reach)
        # by the centre: of a half turn, half the chord and the radius say the height to half the digits only
        ux = q[0] - p[0]
        uy = q[1] - p[1]
        chord = math.hypot(ux, uy)
        apothem = (ux * (arcs[i, 1] - p[1]) - uy * (arcs[i, 0] - p[0])) / chord
        arcs[i, 3] = abs(r) - (apothem if r > 0.0 else -apothem) + 16.0 * 2.0**-52 * (reach + chord)
    if disc:
        radius = arcs[0, 2]
    boxes, leaves = boxes_of(points, following, arcs)
    convex = len(starts) == 2 and n <= MOST_WALKED and _convex(points, arcs)
    face = 0.0
    mouth = math.inf
    for r in range(len(starts) - 1):
        ring = points[starts[r] : starts[r + 1]]
        if bent > 0:
            ring = _chords(ring, arcs[starts[r] : starts[r + 1]])
        if r == 0:
            face = _face(ring, x, y)
        if not convex:
            mouth = min(mouth, mouth_of(ring))
    return following, ring_of, boxes, (leaves, convex, bent, disc, radius, face, mouth)


def pack(outlines: Sequence[HasRings]) -> Pool:
    """Cast outlines into one pool. Rings are taken as `Outline` makes them (checked there)."""
    heads = np.zeros(len(outlines), HEAD)
    columns: list[list[np.ndarray]] = [[], [], [], [], [], []]
    n_points = n_rings = n_boxes = 0
    for head, outline in zip(heads, outlines):
        if outline.arcs:
            xmin, ymin, xmax, ymax = outline.bounds
            middle = 0.5 * np.array((xmin + xmax, ymin + ymax))
            if len(outline.arcs) == 1 and (outline.arcs[0] == outline.arcs[0][0]).all():
                middle = outline.arcs[0][0, :2]
        else:
            outer = outline.rings[0]
            middle = 0.5 * (outer.min(axis=0) + outer.max(axis=0))
        head["x"], head["y"] = middle
        head["area"] = outline.area
        starts = np.zeros(len(outline.rings) + 1, np.int64)
        np.cumsum([len(ring) for ring in outline.rings], out=starts[1:])
        rings = outline.rings[0] if len(starts) == 2 else np.concatenate(outline.rings)
        points = np.ascontiguousarray(rings - middle, dtype=np.float64)
        arcs = np.zeros((len(points), 4))
        if outline.arcs:
            arcs[:, :3] = np.concatenate(outline.arcs)
            arcs[:, :2] -= np.where(arcs[:, 2:3] == 0, 0.0, middle)
        x, y = outline.centroid
        following, ring_of, boxes, numbers = _prepare(points, arcs, starts, x - middle[0], y - middle[1])
        names = ("leaves", "convex", "arcs", "disc", "radius", "face", "mouth")
        for name, number in zip(names, numbers):
            head[name] = number
        head["point"], head["ring"], head["box"] = n_points, n_rings, n_boxes
        head["count"], head["rings"] = len(points), len(starts) - 1
        ends = np.stack([starts[:-1], starts[1:]], axis=1).astype(np.int32)
        for column, array in zip(
            columns, (points, following + n_points, ring_of + n_rings, ends + n_points, boxes, arcs)
        ):
            column.append(array)
        n_points += len(points)
        n_rings += len(starts) - 1
        n_boxes += len(boxes)
    dtypes = (np.float64, np.int32, np.int32, np.int32, np.float64, np.float64)
    arrays = [np.concatenate(column).astype(dtype, copy=False) for column, dtype in zip(columns, dtypes)]
    return Pool(arrays[0], arrays[1], arrays[2], arrays[3], arrays[4], arrays[5], heads)
