"""Work arrays of one pair of bodies: what the search found, crossings, regions, and one region's arcs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rigidarea.kernel.jit import kernel

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

# enter_*: the crossing where A enters B (edge and parameter on each body), leave_*: where it leaves
REGION = np.dtype(
    [
        (f"{end}_{body}{what}", t)
        for end in ("enter", "leave")
        for body in "ab"
        for what, t in (("", "i8"), ("_t", "f8"))
    ]
    + [(name, "f8") for name in ("enter_x", "enter_y", "leave_x", "leave_y")]
    + [("area", "f8"), ("x", "f8"), ("y", "f8"), ("nx", "f8"), ("ny", "f8"), ("chord", "f8"), ("force", "f8")]
    + [("x_chord", "f8"), ("y_chord", "f8")]
    + [
        ("first", "i8"),
        ("arcs", "i8"),
        ("serial", "i8"),
    ]  # a crossing of it, its arcs a body, number of its loads
)
CROSSING = np.dtype(
    [("a", "i8"), ("b", "i8"), ("ta", "f8"), ("tb", "f8"), ("x", "f8"), ("y", "f8"), ("enter", "i8"), ("next_a", "i8"),
     ("next_b", "i8"), ("used", "i8")]
)  # fmt: skip

CANDIDATES = 16384  # pairs of leaves: a contact along 16,000 edges
MANY = -1  # more crossings, arcs or candidates than the work arrays hold
TORN = -2  # crossings that do not alternate: a boundary that crosses itself
SLICED = -3  # a region whose arcs have no common direction (a bar through a bar)
FULL = -4  # more loaded nodes than the unknowns of ``condense`` have room for: give it more and go on


class Loads(NamedTuple):
    """The loads of all regions as unknowns, and how they answer to displacements; see ``condense``. Room for c."""

    made: Ints  # (2,) unknowns so far, serial number of the region
    region: Ints  # (c,) that number
    side: Ints  # (c,) 0: on A, 1: on B; then the body
    node: Ints  # (c,) FE boundary node, -1: one of the two of a rigid body's side
    at: Array  # (c, 2) where, world
    world: Array  # (c, 2) direction of the load, world
    local: Array  # (c, 2) and in the body frame
    force: Array  # (c,)
    stiffness: Array  # (c, c) force by displacements along the loads, changed sign
    entry: Ints  # (p,) unknowns under one point of a region, and their shares
    share: Array  # (p,)


class Scratch(NamedTuple):
    """See the module."""

    stack: Ints
    pairs: Ints  # (p, 2) candidate leaves
    close: Ints  # (p, 2) those of them that are near now
    crossings: NDArray[np.void]
    regions: NDArray[np.void]
    x: Array  # (2, n)
    y: Array
    edge: Ints
    t: Array  # (2, n, 2)
    cut: Array  # (2 n,)
    load: Loads


def loads(room: int, points: int) -> Loads:
    """Room for ``room`` loads of boundaries of ``points`` points; 0: no answer to displacements is wanted."""
    m = 4 * (points + 4) if room else 0
    return Loads(
        np.zeros(2, np.int64), np.zeros(room, np.int64), np.zeros(room, np.int64), np.zeros(room, np.int64),
        np.zeros((room, 2)),
        np.zeros((room, 2)), np.zeros((room, 2)), np.zeros(room), np.zeros((room, room)), np.zeros(m, np.int64),
        np.zeros(m),
    )  # fmt: skip


def scratch(points: int, room: int = 0) -> Scratch:
    """Arrays for boundaries of up to ``points`` points in all, and ``room`` loads as unknowns."""
    n = points + 3
    return Scratch(
        np.zeros((256, 2), np.int64), np.zeros((CANDIDATES, 2), np.int64), np.zeros((CANDIDATES, 2), np.int64),
        np.zeros(512, CROSSING), np.zeros(1024, REGION),
        np.zeros((2, n)), np.zeros((2, n)), np.zeros((2, n), np.int64), np.zeros((2, n, 2)), np.zeros(2 * n),
        loads(room, points),
    )  # fmt: skip


class Searches(NamedTuple):
    """What the search left for each of p pairs, kept while b has moved little in the frame of a; see ``search``."""

    pairs: Ints  # (p, c, 2)
    found: Ints  # (p,) candidate leaves, -1 before the first search
    posed: Array  # (p, 4) pose of b in the frame of a then
    bend: Array  # (p,) the deformation allowed for
    margin: Array  # (p,) the motion allowed for, of the point ``held``
    turn: Array  # (p,) and the turn about it
    held: Array  # (p, 2) a point of b, in its frame
    pole: Array  # (p, 2) that of the next search: the last contact


def searches(pairs: int) -> Searches:
    """Room for one search each of so many pairs."""
    p = pairs
    return Searches(
        np.zeros((p, CANDIDATES, 2), np.int64), np.full(p, -1), np.zeros((p, 4)), np.zeros(p), np.zeros(p),
        np.zeros(p), np.zeros((p, 2)), np.zeros((p, 2)),
    )  # fmt: skip


@kernel
def of_pair(s: Scratch, all_pairs: Searches, p: int) -> Scratch:
    """The work arrays with what the search left for pair p."""
    return Scratch(
        s.stack, all_pairs.pairs[p], s.close, s.crossings, s.regions, s.x, s.y, s.edge, s.t, s.cut, s.load
    )  # fmt: skip
