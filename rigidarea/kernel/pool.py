"""The gate: outlines cast once into the arrays that the kernels read, with a static hierarchy of boxes.

Kernels never validate: what is in a `Pool` is contiguous float64 / int32, counter-clockwise rings with clockwise
holes, no repeated points, coordinates relative to the middle of the outline's bounding box (so that an outline a
million lengths from its body's origin keeps its digits).

The hierarchy is implicit: `LEAF` consecutive edges share a leaf, the leaves are the last 2^d nodes of a binary
heap (node 1 the root, children 2n and 2n + 1). Consecutive edges of a ring are neighbours in space too, which makes
order along the ring as good a key as any; and nothing has to be stored but the boxes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np

from .memory import record

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
        ("convex", "i4"),  # and small enough to be clipped
        ("x", "f8"),  # middle of the bounding box, body frame (length)
        ("y", "f8"),
        ("radius", "f8"),  # about that middle (length)
        ("area", "f8"),  # (length^2)
        ("face", "f8"),  # longest chord that a straight edge cuts off at a shallow depth (length)
        ("face_arm", "f8"),  # its distance from the centroid, along itself (length)
    ],
)


class Pool(NamedTuple):
    """Outlines as the kernels see them: P points, R rings, N boxes, O outlines."""

    points: np.ndarray  # (P, 2) float64
    following: np.ndarray  # (P,) int32: the next point along the ring
    ring_of: np.ndarray  # (P,) int32
    rings: np.ndarray  # (R, 2) int32: first point, one past the last
    boxes: np.ndarray  # (N, 4) float64: middle x, y, half width, half height
    heads: np.ndarray  # (O,) HEAD


class HasRings(Protocol):
    """What the gate needs of an outline (`rigidarea.Outline` is one)."""

    @property
    def rings(self) -> tuple[np.ndarray, ...]: ...
    @property
    def area(self) -> float: ...
    @property
    def centroid(self) -> tuple[float, float]: ...
    @property
    def convex(self) -> bool: ...


#: Outlines of more points are not clipped, convex or not.
MOST_CLIPPED = 21
#: Depth at which `face` is measured, as a fraction of the outline's extent: how deep contacts are expected to go.
FACE_DEPTH = 0.02


def _boxes(points: np.ndarray, following: np.ndarray) -> tuple[np.ndarray, int]:
    """The hierarchy over the edges (point, following point): boxes (2 leaves, 4), leaves."""
    a, b = points, points[following]
    n = len(points)
    leaves = 1
    while leaves * LEAF < n:
        leaves *= 2
    low = np.full((2 * leaves, 2), np.inf)
    high = np.full((2 * leaves, 2), -np.inf)
    starts = np.arange(0, n, LEAF)
    low[leaves : leaves + len(starts)] = np.minimum.reduceat(np.minimum(a, b), starts)
    high[leaves : leaves + len(starts)] = np.maximum.reduceat(np.maximum(a, b), starts)
    level = leaves // 2
    while level:
        children = slice(2 * level, 4 * level)
        low[level : 2 * level] = low[children].reshape(level, 2, 2).min(axis=1)
        high[level : 2 * level] = high[children].reshape(level, 2, 2).max(axis=1)
        level //= 2
    boxes = np.zeros((2 * leaves, 4))
    boxes[:, 2:] = -1e300  # an empty box touches nothing
    real = np.isfinite(low[:, 0])
    boxes[real, :2] = 0.5 * (low[real] + high[real])
    boxes[real, 2:] = 0.5 * (high[real] - low[real])
    return boxes, leaves


def _face(points: np.ndarray, centroid: np.ndarray, extent: float) -> tuple[float, float]:
    """(chord, arm) for which chord (1 + arm^2 / gyration^2) is largest, over cuts at FACE_DEPTH (design 2.3).

    A straight edge pressed `FACE_DEPTH * extent` into the outline cuts off a chord (of a gear: one tooth's); its
    stiffness is k chord, its leverage on a free body the arm of its middle about the centroid.
    """
    step = max(1, len(points) // 64)
    edge = (np.roll(points, -step, axis=0) - points)[::step]
    length = np.hypot(edge[:, 0], edge[:, 1])
    keep = length > 0
    tangent = edge[keep] / length[keep, None]
    normal = np.stack([tangent[:, 1], -tangent[:, 0]], axis=1)
    height = points @ normal.T  # (points, directions)
    along = points @ tangent.T
    cut = height.max(axis=0) - FACE_DEPTH * extent
    following = np.roll(np.arange(len(points)), -1)
    h0, h1 = height - cut, height[following] - cut
    crossing = (h0 > 0) != (h1 > 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        s = along + (along[following] - along) * np.where(crossing, h0 / (h0 - h1), 0.0)
    # the line enters and leaves the outline in turn: of its stretches inside, the longest
    s = np.sort(np.where(crossing, s, np.nan), axis=0)
    pairs = len(s) // 2
    low, high = s[0 : 2 * pairs : 2], s[1 : 2 * pairs : 2]
    stretch = np.nan_to_num(high - low)
    longest = stretch.argmax(axis=0)
    column = np.arange(stretch.shape[1])
    chord = stretch[longest, column]
    arm = np.nan_to_num(0.5 * (low + high)[longest, column]) - tangent @ centroid
    gyration2 = extent**2 / 8.0  # of a disc of that diameter: only the ranking depends on it
    best = int(np.argmax(chord * (1.0 + arm**2 / gyration2)))
    return float(chord[best]), float(abs(arm[best]))


def _clippable(points: np.ndarray) -> bool:
    """Whether every point lies left of every edge's line: a convex outline cut along its edges stays itself.

    (An edge of rounding length may look the wrong way in an outline that is convex but for rounding.)
    """
    edge = np.roll(points, -1, axis=0) - points
    edge /= np.hypot(edge[:, 0], edge[:, 1])[:, None]
    apart = points[None, :, :] - points[:, None, :]
    behind = edge[:, None, 0] * apart[..., 1] - edge[:, None, 1] * apart[..., 0]
    return bool(behind.min() >= -1e-13 * np.abs(points).max())


def pack(outlines: Sequence[HasRings]) -> Pool:
    """Cast outlines into one pool. Rings are taken as `Outline` makes them (checked there)."""
    points, following, ring_of, rings, boxes = [], [], [], [], []
    heads = np.zeros(len(outlines), HEAD)
    n_points = n_rings = n_boxes = 0
    for head, outline in zip(heads, outlines):
        outer = outline.rings[0]
        low, high = outer.min(axis=0), outer.max(axis=0)
        middle = 0.5 * (low + high)
        local = np.concatenate([ring - middle for ring in outline.rings])
        sizes = [len(ring) for ring in outline.rings]
        start = np.concatenate([[0], np.cumsum(sizes)])
        nxt = np.arange(1, len(local) + 1)
        nxt[start[1:] - 1] = start[:-1]
        box, leaves = _boxes(local, nxt)
        face, arm = _face(outer - middle, np.asarray(outline.centroid) - middle, float((high - low).max()))
        head["point"], head["count"] = n_points, len(local)
        head["ring"], head["rings"] = n_rings, len(sizes)
        head["box"], head["leaves"] = n_boxes, leaves
        head["convex"] = outline.convex and len(local) <= MOST_CLIPPED and _clippable(local)
        head["x"], head["y"] = middle
        head["radius"] = np.hypot(local[:, 0], local[:, 1]).max()
        head["area"], head["face"], head["face_arm"] = outline.area, face, arm
        points.append(local)
        following.append(nxt + n_points)
        ring_of.append(np.repeat(np.arange(len(sizes)) + n_rings, sizes))
        rings.append(np.stack([start[:-1], start[1:]], axis=1) + n_points)
        boxes.append(box)
        n_points += len(local)
        n_rings += len(sizes)
        n_boxes += len(box)
    return Pool(
        np.ascontiguousarray(np.concatenate(points), dtype=np.float64),
        np.concatenate(following).astype(np.int32),
        np.concatenate(ring_of).astype(np.int32),
        np.ascontiguousarray(np.concatenate(rings), dtype=np.int32),
        np.ascontiguousarray(np.concatenate(boxes), dtype=np.float64),
        heads,
    )
