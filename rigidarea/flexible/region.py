"""Contact regions of two placed boundaries that deform (the paper's Alg. 1 and the first half of Alg. 2).

Crossing points come from the candidate leaves alone; walking each perimeter from crossing to crossing gives the
regions, so the nodes inside need no inclusion test of their own. Predicates are half-open: a point on a line counts
as left of it, so a perimeter that runs through a vertex of the other crosses it once.

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

from rigidarea.flexible.boundary import Boundary, Work
from rigidarea.flexible.place import place, place_leaves
from rigidarea.flexible.scratch import MANY, SLICED, TORN, Scratch
from rigidarea.kernel.jit import entry, kernel

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

NO_CHORD = 1e-9  # a summed chord this small beside its parts is rounding: no direction


@kernel(forceinline=True)
def strip(at: Array, following: Ints, low: int, high: int) -> tuple[float, float, float, float, float, float]:
    """The strip that holds a leaf's edges low … high - 1: origin, chord, and the bounds of cross(chord, ·)."""
    ox, oy = at[low, 0], at[low, 1]
    end = following[high - 1]
    ux, uy = at[end, 0] - ox, at[end, 1] - oy
    above = below = 0.0
    for i in range(low + 1, high):
        o = ux * (at[i, 1] - oy) - uy * (at[i, 0] - ox)
        above, below = max(above, o), min(below, o)
    slack = 1e-9 * (ux * ux + uy * uy)  # rounding: the strip decides only what is clear
    return ox, oy, ux, uy, above + slack, below - slack


@kernel(forceinline=True)
def _crossings(
    next_a: Ints, first_a: Ints, size_a: Ints, at_a: Array, next_b: Ints, first_b: Ints, size_b: Ints, at_b: Array,
    pairs: Ints, n_pairs: int, out: NDArray[np.void],
) -> int:  # fmt: skip
    count = 0
    last = -1
    ox = oy = ux = uy = above = below = 0.0
    for k in range(n_pairs):
        leaf_a, leaf_b = pairs[k, 0], pairs[k, 1]
        low_a, high_a = first_a[leaf_a], first_a[leaf_a] - size_a[leaf_a]
        low_b, high_b = first_b[leaf_b], first_b[leaf_b] - size_b[leaf_b]
        if leaf_a != last:
            last = leaf_a
            ox, oy, ux, uy, above, below = strip(at_a, next_a, low_a, high_a)
        # a leaf of B wholly to one side of A's strip cannot cross it
        j = next_b[high_b - 1]
        lowest = highest = ux * (at_b[j, 1] - oy) - uy * (at_b[j, 0] - ox)
        for j in range(low_b, high_b):
            o = ux * (at_b[j, 1] - oy) - uy * (at_b[j, 0] - ox)
            lowest, highest = min(lowest, o), max(highest, o)
        if lowest > above or highest < below:
            continue
        for i in range(low_a, high_a):
            ia = next_a[i]
            px, py = at_a[i, 0], at_a[i, 1]
            dx, dy = at_a[ia, 0] - px, at_a[ia, 1] - py
            # Eq. 1-3 as orientation tests: no division before a crossing is certain. One formula for both ends of an
            # edge, so that edges that share a vertex agree on its side to the last bit.
            o_s = dx * (at_b[low_b, 1] - py) - dy * (at_b[low_b, 0] - px)
            for j in range(low_b, high_b):
                jb = next_b[j]
                o_r, o_s = o_s, dx * (at_b[jb, 1] - py) - dy * (at_b[jb, 0] - px)
                if (o_r >= 0.0) == (o_s >= 0.0):
                    continue
                jx, jy = at_b[j, 0], at_b[j, 1]
                ex, ey = at_b[jb, 0] - jx, at_b[jb, 1] - jy
                o_p = ex * (py - jy) - ey * (px - jx)
                o_q = ex * (at_a[ia, 1] - jy) - ey * (at_a[ia, 0] - jx)
                if (o_p >= 0.0) == (o_q >= 0.0):
                    continue
                if count == len(out):
                    return MANY
                t = o_p / (o_p - o_q)
                c = out[count]
                c["a"], c["b"], c["ta"], c["tb"] = i, j, t, o_r / (o_r - o_s)
                c["x"], c["y"] = px + t * dx, py + t * dy
                c["enter"] = 1 if o_q >= 0.0 else 0  # A runs to the left of B's edge: into B
                c["used"] = 0
                count += 1
    return count


@kernel(forceinline=True)
def _following(ring: Ints, edge: Ints, t: Array, n: int, i: int) -> int:
    """The crossing that follows crossing i on the same ring of one body."""
    best, wrap = -1, -1
    best_key = wrap_key = np.inf
    key = edge[i] + t[i]
    for j in range(n):
        if j != i and ring[edge[j]] == ring[edge[i]]:
            other = edge[j] + t[j]
            if other >= key and other < best_key and not (other == key and j < i):
                best, best_key = j, other
            if other < wrap_key:
                wrap, wrap_key = j, other
    return best if best >= 0 else wrap


@kernel(forceinline=True)
def _around(crossings: NDArray[np.void], first: int, r: Any) -> int:
    """Follows a region from crossing ``first`` round its arcs: 1, or 0 if it has no extent, or TORN, SLICED."""
    start = crossings[first]
    cx = cy = length = moment = 0.0
    arcs = 0
    i = first
    while True:
        c = crossings[i]
        out = c["next_a"]
        if c["enter"] == 0 or out < 0 or crossings[out]["enter"] == 1 or c["used"] == 1:
            return TORN
        d = crossings[out]
        c["used"] = d["used"] = 1
        ex, ey = d["x"] - c["x"], d["y"] - c["y"]
        if arcs == 0:
            r["leave_a"], r["leave_a_t"], r["leave_b"], r["leave_b_t"] = d["a"], d["ta"], d["b"], d["tb"]
            r["leave_x"], r["leave_y"] = d["x"], d["y"]
        cx, cy, length = cx + ex, cy + ey, length + np.sqrt(ex * ex + ey * ey)
        # of the chord's middle about the first crossing: how a turn changes the area
        moment += ex * (0.5 * (c["x"] + d["x"]) - start["x"]) + ey * (0.5 * (c["y"] + d["y"]) - start["y"])
        arcs += 1
        i = d["next_b"]
        if i == first:
            break
    chord = np.sqrt(cx * cx + cy * cy)
    if arcs > 1 and chord < NO_CHORD * length:
        return SLICED
    r["first"], r["arcs"], r["chord"] = first, arcs, chord
    r["enter_a"], r["enter_a_t"], r["enter_b"], r["enter_b_t"] = (
        start["a"],
        start["ta"],
        start["b"],
        start["tb"],
    )
    r["enter_x"], r["enter_y"] = start["x"], start["y"]
    if chord == 0.0:
        return 0
    # Eq. 13 for q = 0: the mean normal of an arc is its chord turned by a quarter. Outward for A, so it is the
    # direction of the force on B.
    ux, uy = cx / chord, cy / chord
    r["nx"], r["ny"] = uy, -ux
    r["x_chord"], r["y_chord"] = start["x"] + ux * moment / chord, start["y"] + uy * moment / chord
    return 1


@entry(forceinline=True)
def find_regions(
    a: Boundary, wa: Work, pose_a: Array, qa: Array, b: Boundary, wb: Work, pose_b: Array, qb: Array,
    n_pairs: int, stamp: int, s: Scratch,
) -> int:  # fmt: skip
    """Fills ``s.regions`` with the crossings and chord of each region: their number, or MANY, TORN, SLICED.

    Poses are (x, y, cos θ, sin θ). ``s.close`` holds what ``search`` or ``narrow`` left.
    """
    place_leaves(a, wa, pose_a, qa, s.close, n_pairs, 0, stamp)
    place_leaves(b, wb, pose_b, qb, s.close, n_pairs, 1, stamp)
    crossings, regions = s.crossings, s.regions
    n = _crossings(
        a.next,
        a.right,
        a.left,
        wa.position,
        b.next,
        b.right,
        b.left,
        wb.position,
        s.close,
        n_pairs,
        crossings,
    )
    if n <= 0:
        return n
    if n % 2 == 1:
        return TORN
    for i in range(n):
        crossings[i]["next_a"] = _following(a.ring, crossings["a"], crossings["ta"], n, i)
        crossings[i]["next_b"] = _following(b.ring, crossings["b"], crossings["tb"], n, i)
    count = 0
    for i in range(n):
        if crossings[i]["enter"] == 1 and crossings[i]["used"] == 0:
            if count == len(regions):
                return MANY
            code = _around(crossings, i, regions[count])
            if code < 0:
                return code
            count += code
    return count


@kernel(forceinline=True)
def _trace(
    bd: Boundary, w: Work, pose: Array, modal: Array, stamp: int, side: int, first: int, t_first: float, last: int,
    t_last: float, ox: float, oy: float, ux: float, uy: float, x: Array, y: Array, edge: Ints, t: Array, n: int,
) -> int:  # fmt: skip
    """Appends the pieces of one arc after piece n - 1: along the perimeter for A (side 0), backwards for B."""
    onward = 1.0 - side  # where on its edge the walk goes
    walk = bd.next if side == 0 else bd.previous
    at, stamps = w.position, w.position_stamp
    begin = n
    i, t0 = first, t_first
    while i != last or (n == begin and (t_last < t0 if side == 0 else t_last > t0)):
        edge[n], t[n, 0], t[n, 1] = i, t0, onward
        n += 1
        if n >= len(x) - 2:
            return MANY
        vertex = i
        i, t0 = walk[i], side
        if side == 0:
            vertex = i
        if stamps[vertex] != stamp:
            place(bd, w, pose, modal, vertex, stamp)
        px, py = at[vertex, 0] - ox, at[vertex, 1] - oy
        x[n], y[n] = ux * px + uy * py, -uy * px + ux * py
    edge[n], t[n, 0], t[n, 1] = i, t0, t_last
    return n + 1


@entry(forceinline=True)
def arcs(
    a: Boundary, wa: Work, pose_a: Array, qa: Array, b: Boundary, wb: Work, pose_b: Array, qb: Array,
    r: Any, stamp: int, x: Array, y: Array, edge: Ints, t: Array,
) -> tuple[int, int]:  # fmt: skip
    """The two arcs of a region in its chord frame (origin at the entry, x to the exit, y to the side of A).

    Row 0 of x, y (2, k) is the arc of A from entry to exit, row 1 the arc of B walked backwards, so that x grows
    on both. Piece k, between vertices k and k + 1, lies on ``edge[·, k]`` at parameters ``t[·, k]``. Returns the
    numbers of pieces, or (MANY, MANY).
    """
    ux, uy = -r["ny"], r["nx"]
    ox, oy = r["enter_x"], r["enter_y"]
    n_a = _trace(
        a, wa, pose_a, qa, stamp, 0, r["enter_a"], r["enter_a_t"], r["leave_a"], r["leave_a_t"],
        ox, oy, ux, uy, x[0], y[0], edge[0], t[0], 0,
    )  # fmt: skip
    n_b = _trace(
        b, wb, pose_b, qb, stamp, 1, r["enter_b"], r["enter_b_t"], r["leave_b"], r["leave_b_t"],
        ox, oy, ux, uy, x[1], y[1], edge[1], t[1], 0,
    )  # fmt: skip
    if n_a == MANY or n_b == MANY:
        return MANY, MANY
    x[0, 0] = y[0, 0] = x[1, 0] = y[1, 0] = y[0, n_a] = y[1, n_b] = 0.0
    x[0, n_a] = x[1, n_b] = r["chord"]
    return n_a, n_b


@entry
def all_arcs(
    a: Boundary, wa: Work, pose_a: Array, qa: Array, b: Boundary, wb: Work, pose_b: Array, qb: Array,
    r: Any, stamp: int, s: Scratch,
) -> tuple[int, int]:  # fmt: skip
    """``arcs`` of a region with any number of them, one after another, into ``s``.

    The axes are along and across the summed chord. Between two arcs stands a piece with equal parameters: the way
    from one to the next, no boundary.
    """
    ux, uy = -r["ny"], r["nx"]
    ox, oy = r["enter_x"], r["enter_y"]
    x, y, edge, t = s.x, s.y, s.edge, s.t
    n_a = n_b = 0
    i = r["first"]
    for arc in range(r["arcs"]):
        c = s.crossings[i]
        d = s.crossings[c["next_a"]]
        i = d["next_b"]
        e = s.crossings[i]
        if arc > 0:
            edge[0, n_a], t[0, n_a, 0], t[0, n_a, 1] = edge[0, n_a - 1], 0.0, 0.0
            edge[1, n_b], t[1, n_b, 0], t[1, n_b, 1] = edge[1, n_b - 1], 0.0, 0.0
            n_a, n_b = n_a + 1, n_b + 1
        x[0, n_a], y[0, n_a] = _framed(c, ox, oy, ux, uy)
        x[1, n_b], y[1, n_b] = _framed(e, ox, oy, ux, uy)
        n_a = _trace(
            a, wa, pose_a, qa, stamp, 0, c["a"], c["ta"], d["a"], d["ta"], ox, oy, ux, uy, x[0], y[0], edge[0], t[0],
            n_a,
        )  # fmt: skip
        n_b = _trace(
            b, wb, pose_b, qb, stamp, 1, e["b"], e["tb"], d["b"], d["tb"], ox, oy, ux, uy, x[1], y[1], edge[1], t[1],
            n_b,
        )  # fmt: skip
        if n_a == MANY or n_b == MANY:
            return MANY, MANY
        x[0, n_a], y[0, n_a] = _framed(d, ox, oy, ux, uy)
        x[1, n_b], y[1, n_b] = x[0, n_a], y[0, n_a]
    return n_a, n_b


@kernel(forceinline=True)
def _framed(crossing: Any, ox: float, oy: float, ux: float, uy: float) -> tuple[float, float]:
    px, py = crossing["x"] - ox, crossing["y"] - oy
    return ux * px + uy * py, -uy * px + ux * py


@entry(forceinline=True)
def area_and_centroid(x: Array, y: Array, t: Array, n_a: int, n_b: int) -> tuple[float, float, float]:
    """Area and centroid (Eq. 4 and 7) of the region between the arcs, in its chord frame.

    The walk is along A and back along B; the origin is a vertex, so no digits are lost far from the world's origin.
    """
    s = sx = sy = 0.0
    for side in range(2):
        sign = 1.0 if side == 0 else -1.0
        for k in range(n_a if side == 0 else n_b):
            if t[side, k, 0] == t[side, k, 1]:
                continue
            x0, y0, x1, y1 = x[side, k], y[side, k], x[side, k + 1], y[side, k + 1]
            cross = sign * (x0 * y1 - x1 * y0)
            s += cross
            sx += cross * (x0 + x1)
            sy += cross * (y0 + y1)
    if s <= 0.0:
        return 0.0, 0.0, 0.0
    return 0.5 * s, sx / (3.0 * s), sy / (3.0 * s)
