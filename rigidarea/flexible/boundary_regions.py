"""Contact regions of two placed boundaries that deform (the paper's Alg. 1 and the first half of Alg. 2).

Crossings, their order and what a region measures are the overlap kernel's (``geometry.overlap``: exact predicates, no
degenerate case). What differs: leaves are those that the search kept, and a point between crossings is placed when the
walk comes to it, as what it costs is its displacement. Rings without a crossing are no contact here.

Body A lies left of its perimeter. Where A enters B an arc of A inside B begins; it ends where A leaves, and there an
arc of B inside A begins: together they run round a region counter-clockwise. Most regions have one arc of each body.
Seen along the chord from entry to exit, A is above, B below, and the region lies between them:

            A
    entry ─────── exit        x along the chord, y towards A
        \\__ arc __/           top: the arc of B, bottom: the arc of A
            B

Where the arc of B ends in another entry, the region has more arcs, and what one chord is to one arc their sum is to
all of them: its length gives the stiffness, its normal the direction (Eq. 13 for q = 0).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidarea.compile.jit import entry, kernel
from rigidarea.flexible.boundary import Boundary, Work, edges_of, span, strip
from rigidarea.flexible.boundary_places import place, place_leaves
from rigidarea.flexible.scratch import SLICED, TORN, Scratch
from rigidarea.geometry.crossings import cross_leaves, link
from rigidarea.geometry.direction import chord_direction
from rigidarea.geometry.work import A_EDGE, B_EDGE, Relative, measure

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@kernel
def _crossings(a: Boundary, at_a: Array, b: Boundary, at_b: Array, n_pairs: int, s: Scratch) -> int:
    """All crossings of the leaves in ``s.close``: their number, or MANY."""
    own = Relative(1.0, 0.0, 0.0, 0.0)  # all points are where they are in the world
    cross, param, spot, pairs = s.work.cross, s.work.param, s.work.spot, s.close
    next_a, next_b = a.following, b.following
    count = low_a = high_a = 0
    last = -1
    ox = oy = ux = uy = above = below = 0.0
    for k in range(n_pairs):
        if pairs[k, 0] != last:
            last = pairs[k, 0]
            low_a, high_a = edges_of(a, last)
            ox, oy, ux, uy, above, below = strip(at_a, next_a, low_a, high_a)
        low_b, high_b = edges_of(b, pairs[k, 1])
        for j in range(low_b, high_b):
            # an edge of B wholly to one side of A's strip cannot cross it
            lowest, highest = span(at_b, next_b, j, j + 1, ox, oy, ux, uy)
            if lowest > above or highest < below:
                continue
            count = cross_leaves(
                at_a, next_a, low_a, high_a, at_b, next_b, j, j + 1, own, cross, param, spot, count
            )
            if count < 0:
                return count
    return count


@kernel
def _trace(
    bd: Boundary, w: Work, pose: Array, modal: Array, stamp: int, side: int, k: int, s: Scratch, v: int
) -> tuple[int, int]:
    """Appends the boundary of a body from crossing k to the next to the kernel's polygon: (that one, vertices)."""
    cross, param, spot = s.work.cross, s.work.param, s.work.spot
    polygon, label, on, between = s.work.polygon, s.work.label, s.on, s.between
    following, at, stamps = bd.following, w.position, w.position_stamp
    m = s.work.order[2 + side, k]
    wraps = m < 0
    if wraps:
        m = ~m
    i, last = cross[k, side], cross[m, side]
    more = i != last or wraps
    polygon[v, 0], polygon[v, 1] = spot[k, 0], spot[k, 1]
    label[v], on[v], between[v, 0] = side, i, param[k, side]
    while more:
        i = following[i]
        more = i != last
        if stamps[i] != stamp:
            place(bd, w, pose, modal, i, stamp)
        between[v, 1] = 1.0
        v += 1
        polygon[v, 0], polygon[v, 1] = at[i, 0], at[i, 1]
        label[v], on[v], between[v, 0] = side, i, 0.0
    between[v, 1] = param[m, side]
    return m, v + 1


@entry
def find_regions(
    a: Boundary, wa: Work, pose_a: Array, qa: Array, b: Boundary, wb: Work, pose_b: Array, qb: Array,
    n_pairs: int, stamp: int, s: Scratch,
) -> int:  # fmt: skip
    """Fills ``s.regions``, all but their forces: their number, or MANY, TORN, SLICED.

    Poses are (x, y, cos θ, sin θ). ``s.close`` holds what ``search`` or ``narrow`` left.
    """
    place_leaves(a, wa, pose_a, qa, s.close, n_pairs, 0, stamp)
    place_leaves(b, wb, pose_b, qb, s.close, n_pairs, 1, stamp)
    at_a, at_b, work = wa.position, wb.position, s.work
    n = _crossings(a, at_a, b, at_b, n_pairs, s)
    if n <= 0:
        return n
    own = Relative(1.0, 0.0, 0.0, 0.0)
    for side in range(2):
        at, body, there, other = (at_a, a, at_b, b) if side == 0 else (at_b, b, at_a, a)
        if not link(
            at, body.following, body.ring_of, there, other.following, own, n,
            work.cross, work.param, work.spot, work.order, side,
        ):  # fmt: skip
            return TORN
    work.done[:n] = 0
    count = v = 0
    for first in range(n):
        if work.done[first] == 1 or work.cross[first, 2] < 0:
            continue
        start, several, i = v, 0, first
        while True:
            work.done[i] = 1
            i, v = _trace(a, wa, pose_a, qa, stamp, 0, i, s, v)
            i, v = _trace(b, wb, pose_b, qb, stamp, 1, i, s, v)
            several += 1
            if i == first:
                break
        measured = measure(work.polygon, work.label, work.bows, work.loops, 0, start, v, False, False, 0.0)
        loop = work.loops[0]
        if measured == 0 or loop.area < 0.0:  # nothing, or a hole
            continue
        nx, ny = chord_direction(loop.chord_x, loop.chord_y, loop.area)
        if nx == 0.0 and ny == 0.0:
            return SLICED
        r, chord = s.regions[count], np.sqrt(loop.chord_x**2 + loop.chord_y**2)
        r["start"], r["stop"], r["arcs"] = start, v, several
        r["area"], r["x"], r["y"], r["chord"] = loop.area, loop.x, loop.y, chord
        # outward for A, so it is the direction of the force on B
        r["nx"], r["ny"] = nx, ny
        # the chord's middle, about which a turn does not change the area
        r["x_chord"], r["y_chord"] = loop.x - ny * loop.lever / chord, loop.y + nx * loop.lever / chord
        r["enter_x"], r["enter_y"] = work.spot[first, 0], work.spot[first, 1]
        count += 1
    return count


@entry
def arcs(r: Any, s: Scratch) -> tuple[int, int]:
    """The arcs of a region in its chord frame (origin at the entry, x to the exit, y to the side of A), into ``s``.

    Row 0 of x, y (2, k) is the arc of A from entry to exit, row 1 the arc of B walked backwards, so that x grows
    on both. Piece k, between vertices k and k + 1, lies on ``edge[·, k]`` at parameters ``t[·, k]``. Several arcs
    stand one after another, the axes are along and across the summed chord, and between two arcs is a piece with equal
    parameters: the way from one to the next, no boundary. Returns the numbers of pieces.
    """
    ux, uy, ox, oy = -r["ny"], r["nx"], r["enter_x"], r["enter_y"]
    polygon, label, on, between = s.work.polygon, s.work.label, s.on, s.between
    x, y, edge, t = s.x, s.y, s.edge, s.t
    n_a = n_b = 0
    start, stop = r["start"], r["stop"]
    begin = start
    while begin < stop:
        leave = begin
        while label[leave] == A_EDGE:
            leave += 1
        end = leave
        while end < stop and label[end] == B_EDGE:
            end += 1
        if begin > start:
            edge[0, n_a], t[0, n_a, 0], t[0, n_a, 1] = edge[0, n_a - 1], 0.0, 0.0
            edge[1, n_b], t[1, n_b, 0], t[1, n_b, 1] = edge[1, n_b - 1], 0.0, 0.0
            n_a, n_b = n_a + 1, n_b + 1
        for i in range(begin, leave + 1):
            px, py = polygon[i, 0] - ox, polygon[i, 1] - oy
            x[0, n_a], y[0, n_a] = ux * px + uy * py, -uy * px + ux * py
            if i < leave:
                edge[0, n_a], t[0, n_a, 0], t[0, n_a, 1] = on[i], between[i, 0], between[i, 1]
                n_a += 1
        for i in range(end, leave - 1, -1):
            j = i if i < stop else start
            px, py = polygon[j, 0] - ox, polygon[j, 1] - oy
            x[1, n_b], y[1, n_b] = ux * px + uy * py, -uy * px + ux * py
            if i > leave:
                edge[1, n_b], t[1, n_b, 0], t[1, n_b, 1] = on[i - 1], between[i - 1, 1], between[i - 1, 0]
                n_b += 1
        begin = end
    return n_a, n_b
