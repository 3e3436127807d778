"""Work arrays of one pair of bodies: what the search found, the kernel's, regions, and one region's arcs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rigidarea.compile.jit import kernel
from rigidarea.geometry.work import OVERFLOW, TANGLED, Work, new_work

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

REGION = np.dtype(
    [(name, "f8") for name in ("enter_x", "enter_y")]  # a crossing where A enters B
    + [("area", "f8"), ("x", "f8"), ("y", "f8"), ("nx", "f8"), ("ny", "f8"), ("chord", "f8"), ("force", "f8")]
    + [("x_chord", "f8"), ("y_chord", "f8")]
    # its vertices in ``Work.polygon``, arcs a body, number of its loads
    + [("start", "i8"), ("stop", "i8"), ("arcs", "i8"), ("serial", "i8")]
)

CROSSINGS = 512  # room for a pair's; a region takes two at least
CANDIDATES = 16384  # pairs of leaves: a contact along 16,000 edges
MANY = OVERFLOW  # more crossings, regions or candidates than the work arrays hold
TORN = TANGLED  # crossings that do not alternate: a boundary that crosses itself
SLICED = -3  # a region whose arcs have no common direction (a bar through a bar)
FULL = -4  # more loaded nodes than the unknowns of ``condense`` have room for: give it more and go on


class Loads(NamedTuple):
    """The loads of all regions as unknowns, and how they answer to displacements; see ``condense``. Room for c."""

    # (6,) unknowns so far; of the present region: serial number, first unknown, flat, first unknowns of its rigid sides
    made: Ints
    region: Ints  # (c,) that number
    side: Ints  # (c,) 0: on A, 1: on B; then the body
    node: Ints  # (c,) FE boundary node, -1: on a rigid body's side; -2: a moment there, its sign ``local[i, 0]``
    at: Array  # (c, 2) where, world
    world: Array  # (c, 2) direction of the load, world
    local: Array  # (c, 2) and in the body frame
    force: Array  # (c,)
    turn: Array  # (2, c) turn of its region's direction by displacement along and across the load, counter-clockwise
    stiffness: Array  # (c, c) force by displacements along the loads, changed sign
    across: Array  # (c, c) the same by displacements across them
    entry: Ints  # (p,) unknowns under one piece of a region, and their shares at its Gauss points
    share: Array  # (3, p)
    slide: Array  # (p,) change of these by displacement across
    place: (
        Array  # (3, 3) parameters of the points on the edges of A, of B, and between the ends of a rigid side
    )
    point: Array  # (3, 3) of each point force, stiffness, and weight in the direction's turn


class Scratch(NamedTuple):
    """See the module."""

    pairs: Ints  # (p, 2) candidate leaves
    gap: Array  # (p,) how far apart they are at least, undeformed, and
    far: Array  # (p,) how far the second is at most from the point about which the search lets it turn
    close: Ints  # (p, 2) those of them that are near now
    work: Work
    on: Ints  # (v,) the contact edge that each edge of ``work.polygon`` lies on
    between: Array  # (v, 2) its parameters there
    regions: NDArray[np.void]
    x: Array  # (2, v)
    y: Array
    edge: Ints
    t: Array  # (2, v, 2)
    cut: Array  # (2 v,)
    load: Loads


def loads(room: int, points: int) -> Loads:
    """Room for ``room`` loads of boundaries of ``points`` points; 0: no answer to displacements is wanted."""
    m = 4 * (points + 4) if room else 0
    return Loads(
        np.zeros(6, np.int64), np.zeros(room, np.int64), np.zeros(room, np.int64), np.zeros(room, np.int64),
        np.zeros((room, 2)),
        np.zeros((room, 2)), np.zeros((room, 2)), np.zeros(room), np.zeros((2, room)),
        np.zeros((room, room)), np.zeros((room, room)), np.zeros(m, np.int64),
        np.zeros((3, m)), np.zeros(m), np.zeros((3, 3)), np.zeros((3, 3)),
    )  # fmt: skip


def scratch(points: int, room: int = 0) -> Scratch:
    """Arrays for boundaries of up to ``points`` points in all, and ``room`` loads as unknowns."""
    work = new_work(points, CROSSINGS)
    v = len(work.polygon)
    return Scratch(
        np.zeros((CANDIDATES, 2), np.int64), np.zeros(CANDIDATES), np.zeros(CANDIDATES),
        np.zeros((CANDIDATES, 2), np.int64), work,
        np.zeros(v, np.int64), np.zeros((v, 2)), np.zeros(CROSSINGS, REGION),
        np.zeros((2, v)), np.zeros((2, v)), np.zeros((2, v), np.int64), np.zeros((2, v, 2)), np.zeros(2 * v),
        loads(room, points),
    )  # fmt: skip


class Searches(NamedTuple):
    """What the search left for each of p pairs, kept while b has moved little in the frame of a; see ``search``."""

    pairs: Ints  # (p, c, 2)
    gap: Array  # (p, c) see ``Scratch``, where b was then
    far: Array  # (p, c)
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
        np.zeros((p, CANDIDATES, 2), np.int64), np.zeros((p, CANDIDATES)), np.zeros((p, CANDIDATES)),
        np.full(p, -1), np.zeros((p, 4)), np.zeros(p), np.zeros(p),
        np.zeros(p), np.zeros((p, 2)), np.zeros((p, 2)),
    )  # fmt: skip


@kernel
def of_pair(s: Scratch, all_pairs: Searches, p: int) -> Scratch:
    """The work arrays with what the search left for pair p."""
    return Scratch(
        all_pairs.pairs[p], all_pairs.gap[p], all_pairs.far[p], s.close, s.work, s.on, s.between, s.regions, s.x, s.y,
        s.edge, s.t, s.cut, s.load,
    )  # fmt: skip
