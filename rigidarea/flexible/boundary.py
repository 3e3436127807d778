"""A body's contact boundary as the kernels see it: points, where they move, and a hierarchy of boxes over them.

Every boundary point rides on an edge of the finite-element boundary: its displacement is that of the edge's two
nodes, interpolated. With one point a node this is the paper's perimeter; with more, a curved profile (a tooth flank)
stays finer than the mesh that carries it. Kernels number bodies' points ring after ring; edge i runs from point i
to point ``next[i]``, the material on its left.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rigidarea.compile.jit import kernel
from rigidarea.flexible.blocks import NODES, Pieces, fill, fill_all, no_pieces, sparse
from rigidarea.geometry.pool import LEAF, boxes_of

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


class Boundary(NamedTuple):
    """Constant data of one body; lengths in the body frame, origin at the centre of mass.

    points (n, 2); following, ring_of (n,) int32; boxes (2 leaves, 4) the hierarchy of ``geometry.pool``, of the
    points as they are here; low, high (n,) FE boundary nodes of the carrying edge and share (n,) in [0, 1), the
    weight of ``high`` (one node where it is 0); modes (2 f + 3, m): rows 2 i, 2 i + 1 of FE boundary node i, the
    last three rows the hub's (x, y, rotation); flexibility (2 f + 3, 2 f + 3), or (0, 0) if not used; nodes (f, 2)
    the FE boundary nodes; swell (2 f + 3,) what centrifugal forces of unit angular velocity move them beyond the
    modes (time² × length), or (0,). soft (2 f + 3, r), soft_stretch (r,), tension (3, r, r): of a compliant body
    that may spin, see ``tension``; r = 0 if there is none. ready (p, p), start, path, value, relief_left,
    relief_right: of a flexibility that is made block by block, when it is used, see ``blocks`` and ``complete``; p
    = 0 if it is whole.
    """

    points: Array
    following: NDArray[np.int32]
    ring_of: NDArray[np.int32]
    boxes: Array
    low: Ints
    high: Ints
    share: Array
    modes: Array
    flexibility: Array
    nodes: Array
    swell: Array
    soft: Array
    soft_stretch: Array
    tension: Array
    ready: NDArray[np.bool_]
    start: Ints
    path: Ints
    value: Array
    relief_left: Array
    relief_right: Array


class Work(NamedTuple):
    """What changes at every evaluation: positions (world), displacements (body frame), loads, and their stamps."""

    position: Array  # (n, 2) world
    position_stamp: Ints  # (n,) evaluation that wrote the position
    displacement: Array  # (f, 2) body frame
    displacement_stamp: Ints  # (f,)
    point_load: Array  # (n, 2) force on a contact point, world
    pressure: Array  # (n,) force a length at a contact point
    point_flag: NDArray[np.bool_]  # (n,) listed in ``touched``
    touched: Ints  # (n + 1,) contact points that carry load; [-1] their number
    node_load: Array  # (f, 2) force on an FE boundary node, body frame
    node_flag: NDArray[np.bool_]  # (f,) listed in ``loaded``
    hub_load: Array  # (3,) force and moment on the hub, body frame
    loaded: Ints  # (f + 1,) FE nodes that carry load; [-1] their number
    mobility: Array  # (m,) what a force on a mode moves it within the step, 1/(M' + C' + ω²)
    spin: Array  # (1,) angular velocity of the frame, squared
    slot: Ints  # (f,) unknown of ``condense`` that is the load on a node, in the region
    slot_region: Ints  # (f,) that wrote it
    # (2,) whether spin or the hub's force change, in this step, flexibility and modes' stiffness, see ``tension``
    tight: NDArray[np.bool_]
    yielding: Array  # (r, 2 r) D in its right half
    drawn: Array  # (3, r) coordinates of what that moves: by all loads, by hub and spin alone; scratch
    still: NDArray[np.bool_]  # (1,) whether it neither moves nor yields: no load on it is an unknown


def build(
    rings: list[Array],
    carriers: tuple[Ints, Ints, Array] | None = None,
    modes: Array | None = None,
    flexibility: Array | Pieces | None = None,
    swell: Array | None = None,
    soft: tuple[Array, Array, Array] | None = None,
) -> Boundary:
    """A boundary from rings of contact points; without ``carriers`` (low, high, share) each point is its own node.

    flexibility: whole, or the pieces that it is made of when it is used.
    soft: the last three of ``Boundary``. FE nodes that no point lies on keep the body's origin as their place.
    """
    points = np.ascontiguousarray(np.vstack(rings), float)
    n = len(points)
    ends = np.cumsum([0] + [len(r) for r in rings])
    following = np.arange(1, n + 1, dtype=np.int32)
    following[ends[1:] - 1] = ends[:-1]
    ring_of = np.repeat(np.arange(len(rings), dtype=np.int32), np.diff(ends))
    boxes, _ = boxes_of(points, following, np.zeros((n, 4)))
    identity = (np.arange(n), np.arange(n), np.zeros(n))
    low, high, share = identity if carriers is None else carriers
    high = np.where(np.asarray(share) == 0.0, low, high)
    f = int(max(low.max(), high.max())) + 1
    modes = np.zeros((2 * f + 3, 0)) if modes is None else np.ascontiguousarray(modes, float)
    on_node = np.flatnonzero(np.asarray(share) == 0.0)
    nodes = np.zeros((f, 2))
    nodes[np.asarray(low, np.int64)[on_node]] = points[on_node]
    psi, h, tension = (
        (np.zeros((2 * f + 3, 0)), np.zeros(0), np.zeros((0, 0, 0)))
        if soft is None or len(soft[1]) == 0
        else soft
    )
    pieces, ready = no_pieces(), np.zeros((0, 0), bool)
    if isinstance(flexibility, Pieces):
        pieces = flexibility
        flexibility, ready = sparse(pieces)
    return Boundary(
        points, following, ring_of, boxes,
        np.asarray(low, np.int64), np.asarray(high, np.int64), np.asarray(share, float), modes,
        np.zeros((0, 0)) if flexibility is None else np.ascontiguousarray(flexibility, float),
        nodes, np.zeros(0) if swell is None else np.ascontiguousarray(swell, float),
        np.ascontiguousarray(psi, float), np.ascontiguousarray(h, float), np.ascontiguousarray(tension, float),
        ready, *pieces,
    )  # fmt: skip


def complete(b: Boundary) -> Boundary:
    """``b``, every block of its flexibility ready: for who reads it outside of the kernels."""
    if len(b.ready):
        fill_all(b.flexibility, b.ready, Pieces(*b[-5:]))
    return b


@kernel(forceinline=True)
def edges_of(b: Boundary, leaf: int) -> tuple[int, int]:
    """The first edge of a leaf of the hierarchy, and one past its last."""
    return LEAF * leaf, min(LEAF * leaf + LEAF, len(b.points))


@kernel(forceinline=True)
def span(
    at: Array, following: NDArray[np.int32], low: int, high: int, ox: float, oy: float, ux: float, uy: float
) -> tuple[float, float]:
    """Least and largest cross(u, p - o) of the ends p of the edges low … high - 1."""
    lowest = highest = ux * (at[low, 1] - oy) - uy * (at[low, 0] - ox)
    for i in range(low, high):
        j = following[i]
        o = ux * (at[j, 1] - oy) - uy * (at[j, 0] - ox)
        lowest, highest = min(lowest, o), max(highest, o)
        if j != i + 1 and i + 1 < high:  # another ring begins
            o = ux * (at[i + 1, 1] - oy) - uy * (at[i + 1, 0] - ox)
            lowest, highest = min(lowest, o), max(highest, o)
    return lowest, highest


@kernel(forceinline=True)
def strip(
    at: Array, following: NDArray[np.int32], low: int, high: int
) -> tuple[float, float, float, float, float, float]:
    """The strip that holds a leaf's edges low … high - 1: origin, chord, and the bounds of cross(chord, ·)."""
    ox, oy = at[low, 0], at[low, 1]
    end = following[high - 1]
    ux, uy = at[end, 0] - ox, at[end, 1] - oy
    below, above = span(at, following, low, high, ox, oy, ux, uy)
    slack = 1e-9 * (ux * ux + uy * uy)  # rounding: the strip decides only what is clear
    return ox, oy, ux, uy, above + slack, below - slack


@kernel
def make_ready(b: Boundary, node: int, first: int, end: int) -> None:
    """Makes the flexibility between an FE node and the nodes ``first`` … ``end`` - 1, where it is not ready."""
    i = node // NODES
    for j in range(first // NODES, (end - 1) // NODES + 1):
        if not b.ready[i, j]:
            fill(b.flexibility, b.ready, b.start, b.path, b.value, b.relief_left, b.relief_right, i, j)


def workspace(b: Boundary) -> Work:
    """Scratch arrays for one body."""
    n, f, r = len(b.points), (len(b.modes) - 3) // 2, b.soft.shape[1]
    return Work(
        np.zeros((n, 2)), np.full(n, -1), np.zeros((f, 2)), np.full(f, -1), np.zeros((n, 2)), np.zeros(n),
        np.zeros(n, bool), np.zeros(n + 1, np.int64), np.zeros((f, 2)), np.zeros(f, bool), np.zeros(3),
        np.zeros(f + 1, np.int64), np.zeros(b.modes.shape[1]), np.zeros(1), np.zeros(f, np.int64),
        np.zeros(f, np.int64), np.zeros(2, bool), np.zeros((r, 2 * r)),
        np.zeros((3, r)), np.zeros(1, bool),
    )  # fmt: skip
