"""Contact regions of two placed boundaries that deform (the paper's Alg. 1 and the first half of Alg. 2).

Crossing points come from the candidate leaves alone; walking each perimeter from crossing to crossing gives the
regions, so the nodes inside need no inclusion test of their own. Predicates are half-open: a point on a line counts
as left of it, so a perimeter that runs through a vertex of the other crosses it once.

Body A lies left of its perimeter. Where A enters B an arc of A inside B begins; it ends where A leaves, and there an
arc of B inside A begins: together they run round a region counter-clockwise. Seen along the chord from entry to
exit, A is above, B below, and the region lies between them:

            A
    entry ─────── exit        x along the chord, y towards A
        \\__ arc __/           top: the arc of B, bottom: the arc of A
            B
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidarea.flexible.boundary import Boundary, Work, place_leaves, place_one
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
        ("give", "f8"),
        ("node_a", "i8"),
        ("node_b", "i8"),
    ]  # see ``condense``; nodes under the middle of the arcs
)
CROSSING = np.dtype(
    [("a", "i8"), ("b", "i8"), ("ta", "f8"), ("tb", "f8"), ("x", "f8"), ("y", "f8"), ("enter", "i8"), ("next_a", "i8"),
     ("next_b", "i8"), ("used", "i8")]
)  # fmt: skip

MANY = -1  # more crossings, arcs or candidates than the work arrays hold
TORN = -2  # crossings that do not alternate: a boundary that crosses itself
SLICED = -3  # a region with more than one arc a body (a bar through a bar)


@kernel
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
            # A's leaf lies in a strip along its chord; a leaf of B wholly to one side of the strip cannot cross it
            last = leaf_a
            end = next_a[high_a - 1]
            ox, oy = at_a[low_a, 0], at_a[low_a, 1]
            ux, uy = at_a[end, 0] - ox, at_a[end, 1] - oy
            above = below = 0.0
            for i in range(low_a + 1, high_a):
                o = ux * (at_a[i, 1] - oy) - uy * (at_a[i, 0] - ox)
                above, below = max(above, o), min(below, o)
            slack = 1e-9 * (ux * ux + uy * uy)  # rounding: the strip decides only what is clear
            above, below = above + slack, below - slack
        j = next_b[high_b - 1]
        o = ux * (at_b[j, 1] - oy) - uy * (at_b[j, 0] - ox)
        lowest = highest = o
        for j in range(low_b, high_b):
            o = ux * (at_b[j, 1] - oy) - uy * (at_b[j, 0] - ox)
            lowest, highest = min(lowest, o), max(highest, o)
        if lowest > above or highest < below:
            continue
        for i in range(low_a, high_a):
            ia = next_a[i]
            px, py = at_a[i, 0], at_a[i, 1]
            qx, qy = at_a[ia, 0], at_a[ia, 1]
            dx, dy = qx - px, qy - py
            for j in range(low_b, high_b):
                jb = next_b[j]
                jx, jy = at_b[j, 0], at_b[j, 1]
                # Eq. 1-3 as orientation tests: no division before a crossing is certain. One formula for both ends
                # of an edge, so that edges that share a vertex agree on its side to the last bit.
                o_r = dx * (jy - py) - dy * (jx - px)
                o_s = dx * (at_b[jb, 1] - py) - dy * (at_b[jb, 0] - px)
                if (o_r >= 0.0) == (o_s >= 0.0):
                    continue
                ex, ey = at_b[jb, 0] - jx, at_b[jb, 1] - jy
                o_p = ex * (py - jy) - ey * (px - jx)
                o_q = ex * (qy - jy) - ey * (qx - jx)
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


@kernel
def _link(ring_a: Ints, ring_b: Ints, c: NDArray[np.void], n: int) -> None:
    """next_a, next_b: the crossing that follows on the same ring of A, of B."""
    for i in range(n):
        best, wrap = -1, -1
        best_key = wrap_key = np.inf
        key = c[i]["a"] + c[i]["ta"]
        for j in range(n):
            if j != i and ring_a[c[j]["a"]] == ring_a[c[i]["a"]]:
                other = c[j]["a"] + c[j]["ta"]
                if other >= key and other < best_key and not (other == key and j < i):
                    best, best_key = j, other
                if other < wrap_key:
                    wrap, wrap_key = j, other
        c[i]["next_a"] = best if best >= 0 else wrap
        best, wrap = -1, -1
        best_key = wrap_key = np.inf
        key = c[i]["b"] + c[i]["tb"]
        for j in range(n):
            if j != i and ring_b[c[j]["b"]] == ring_b[c[i]["b"]]:
                other = c[j]["b"] + c[j]["tb"]
                if other >= key and other < best_key and not (other == key and j < i):
                    best, best_key = j, other
                if other < wrap_key:
                    wrap, wrap_key = j, other
        c[i]["next_b"] = best if best >= 0 else wrap


@kernel(inline="always")
def find_regions(
    a: Boundary, wa: Work, pose_a: Array, qa: Array, b: Boundary, wb: Work, pose_b: Array, qb: Array,
    pairs: Ints, n_pairs: int, stamp: int, crossings: NDArray[np.void], regions: NDArray[np.void],
) -> int:  # fmt: skip
    """Fills ``regions`` with the crossings of each contact region; returns their number, or MANY, TORN, SLICED.

    Poses are (x, y, cos θ, sin θ), qa and qb the modal coordinates, ``pairs`` the candidate leaves.
    """
    place_leaves(a, wa, pose_a, qa, pairs, n_pairs, 0, stamp)
    place_leaves(b, wb, pose_b, qb, pairs, n_pairs, 1, stamp)
    n = _crossings(
        a.next, a.right, a.left, wa.position, b.next, b.right, b.left, wb.position, pairs, n_pairs, crossings
    )
    if n <= 0:
        return n
    if n % 2 == 1:
        return TORN
    _link(a.ring, b.ring, crossings, n)
    count = 0
    for i in range(n):
        c = crossings[i]
        if c["enter"] == 0 or c["used"] == 1:
            continue
        out = c["next_a"]
        if out < 0 or crossings[out]["enter"] == 1:
            return TORN
        if crossings[out]["next_b"] != i:
            return SLICED
        if count == len(regions):
            return MANY
        c["used"] = crossings[out]["used"] = 1
        r, d = regions[count], crossings[out]
        r["enter_a"], r["enter_a_t"], r["enter_b"], r["enter_b_t"] = c["a"], c["ta"], c["b"], c["tb"]
        r["leave_a"], r["leave_a_t"], r["leave_b"], r["leave_b_t"] = d["a"], d["ta"], d["b"], d["tb"]
        r["enter_x"], r["enter_y"], r["leave_x"], r["leave_y"] = c["x"], c["y"], d["x"], d["y"]
        ex, ey = d["x"] - c["x"], d["y"] - c["y"]
        r["chord"] = np.hypot(ex, ey)
        if r["chord"] > 0.0:
            # Eq. 13 for q = 0: the mean normal of an arc is its chord turned by a quarter. Outward for A, so it is
            # the direction of the force on B.
            r["nx"], r["ny"] = ey / r["chord"], -ex / r["chord"]
            r["x_chord"], r["y_chord"] = 0.5 * (d["x"] + c["x"]), 0.5 * (d["y"] + c["y"])
            count += 1
    return count


@kernel(inline="always")
def arcs(
    a: Boundary, wa: Work, pose_a: Array, qa: Array, b: Boundary, wb: Work, pose_b: Array, qb: Array,
    r: Any, stamp: int, x: Array, y: Array, edge: Ints, t: Array,
) -> tuple[int, int]:  # fmt: skip
    """The two arcs of a region in its chord frame (origin at the entry, x to the exit, y to the side of A).

    Row 0 of x, y (2, k) is the arc of A from entry to exit, row 1 the arc of B walked backwards, so that x grows
    on both. Piece k, between vertices k and k + 1, lies on ``edge[·, k]`` at parameters ``t[·, k]``. Returns the
    numbers of pieces, or (MANY, MANY).
    """
    ux, uy = -r["ny"], r["nx"]  # along the chord
    following, at_a, stamp_a = a.next, wa.position, wa.position_stamp
    preceding, at_b, stamp_b = b.previous, wb.position, wb.position_stamp
    limit = x.shape[1] - 2
    for side in range(2):
        x[side, 0] = y[side, 0] = 0.0
    n_a = 0
    i, t0 = r["enter_a"], r["enter_a_t"]
    while i != r["leave_a"] or (n_a == 0 and r["leave_a_t"] < t0):
        edge[0, n_a] = i
        t[0, n_a, 0], t[0, n_a, 1] = t0, 1.0
        i, t0, n_a = following[i], 0.0, n_a + 1
        if n_a >= limit:
            return MANY, MANY
        if stamp_a[i] != stamp:
            place_one(a, wa, pose_a, qa, i, stamp)
        px, py = at_a[i, 0] - r["enter_x"], at_a[i, 1] - r["enter_y"]
        x[0, n_a], y[0, n_a] = ux * px + uy * py, -uy * px + ux * py
    edge[0, n_a] = i
    t[0, n_a, 0], t[0, n_a, 1] = t0, r["leave_a_t"]
    n_a += 1
    x[0, n_a], y[0, n_a] = r["chord"], 0.0
    n_b = 0
    j, t0 = r["enter_b"], r["enter_b_t"]
    while j != r["leave_b"] or (n_b == 0 and r["leave_b_t"] > t0):
        edge[1, n_b] = j
        t[1, n_b, 0], t[1, n_b, 1] = t0, 0.0
        if stamp_b[j] != stamp:
            place_one(b, wb, pose_b, qb, j, stamp)
        px, py = at_b[j, 0] - r["enter_x"], at_b[j, 1] - r["enter_y"]
        j, t0, n_b = preceding[j], 1.0, n_b + 1
        if n_b >= limit:
            return MANY, MANY
        x[1, n_b], y[1, n_b] = ux * px + uy * py, -uy * px + ux * py
    edge[1, n_b] = j
    t[1, n_b, 0], t[1, n_b, 1] = t0, r["leave_b_t"]
    n_b += 1
    x[1, n_b], y[1, n_b] = r["chord"], 0.0
    return n_a, n_b


@kernel(inline="always")
def area_and_centroid(x: Array, y: Array, n_a: int, n_b: int) -> tuple[float, float, float]:
    """Area and centroid (Eq. 4 and 7) of the region between the arcs, in its chord frame.

    The walk is along A and back along B; the origin is a vertex, so no digits are lost far from the world's origin.
    """
    s = sx = sy = 0.0
    for side in range(2):
        sign = 1.0 if side == 0 else -1.0
        for k in range(n_a if side == 0 else n_b):
            x0, y0, x1, y1 = x[side, k], y[side, k], x[side, k + 1], y[side, k + 1]
            cross = sign * (x0 * y1 - x1 * y0)
            s += cross
            sx += cross * (x0 + x1)
            sy += cross * (y0 + y1)
    if s <= 0.0:
        return 0.0, 0.0, 0.0
    return 0.5 * s, sx / (3.0 * s), sy / (3.0 * s)
