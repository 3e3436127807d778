"""Overlap of two small convex outlines with arcs (capsules, rounded boxes) whose boundaries cross twice.

Nearly all pairs of them do. The crossings are found as in `curved.py`, by the same signs, among the edges of each that
reach into the box of the other; with two of them nothing has to be sorted, and the one region is A's boundary from
where it enters B to where it leaves, then B's. No crossing and boxes that leave no room for one inside the other:
apart. Whatever else there is goes the general way.
"""

from __future__ import annotations

import numpy as np

from ..compile.jit import kernel
from .arc import FIRST, SECOND, UNSURE, arc_arc, line_arc
from .curved import along_edge, line_line
from .work import A_EDGE, B_EDGE, NEARBY, OTHERWISE, TANGLED, Relative, measure, placed, put


@kernel
def convex_pair(
    qa: np.ndarray, arcs_a: np.ndarray, boxes_a: np.ndarray, a0: int, na: int, root_a: int,
    qb: np.ndarray, arcs_b: np.ndarray, boxes_b: np.ndarray, b0: int, nb: int, root_b: int, rel: Relative,
    p: np.ndarray, label: np.ndarray, bows: np.ndarray, loops: np.ndarray, noise: float,
) -> int:  # fmt: skip
    """The region of A's edges a0.., na of them, in the box boxes_a[root_a], with B's, placed; or OTHERWISE, or TANGLED.

    na is at most 256: the label holds the numbers of the edges that come near the other, until the loop is made. (They
    are found without branches: which edges those are no processor can guess.)
    """
    left = boxes_a[root_a, 0] - boxes_a[root_a, 2] - noise
    right = boxes_a[root_a, 0] + boxes_a[root_a, 2] + noise
    bottom = boxes_a[root_a, 1] - boxes_a[root_a, 3] - noise
    top = boxes_a[root_a, 1] + boxes_a[root_a, 3] + noise
    mx, my = placed(boxes_b, root_b, rel)
    half_x = abs(rel.c) * boxes_b[root_b, 2] + abs(rel.s) * boxes_b[root_b, 3] + noise
    half_y = abs(rel.s) * boxes_b[root_b, 2] + abs(rel.c) * boxes_b[root_b, 3] + noise
    if mx + half_x < left or mx - half_x > right or my + half_y < bottom or my - half_y > top:
        return 0
    close = 0  # edges of A that come near B's box
    bx = qa[a0, 0]
    by = qa[a0, 1]
    for i in range(na):
        k = a0 + i + 1 if i + 1 < na else a0
        ax = bx
        ay = by
        bx = qa[k, 0]
        by = qa[k, 1]
        bow = arcs_a[a0 + i, 3]
        label[close] = i
        close += int(
            (max(ax, bx) + bow >= mx - half_x)
            & (min(ax, bx) - bow <= mx + half_x)
            & (max(ay, by) + bow >= my - half_y)
            & (min(ay, by) - bow <= my + half_y)
        )
    reaching = close  # and of B, behind them, that come near A's
    dx, dy = placed(qb, b0, rel)
    for j in range(nb):
        cx = dx
        cy = dy
        dx, dy = placed(qb, b0 + j + 1 if j + 1 < nb else b0, rel)
        bow = arcs_b[b0 + j, 3]
        label[reaching] = j
        reaching += int(
            (max(cx, dx) + bow >= left)
            & (min(cx, dx) - bow <= right)
            & (max(cy, dy) + bow >= bottom)
            & (min(cy, dy) - bow <= top)
        )
    n = 0
    # where A enters B, and where it leaves: edge of A, edge of B, point
    in_a = in_b = out_a = out_b = -1
    in_x = in_y = out_x = out_y = 0.0
    for far in range(close, reaching):
        j = b0 + int(label[far])
        cx, cy = placed(qb, j, rel)
        dx, dy = placed(qb, j + 1 if j + 1 < b0 + nb else b0, rel)
        bow = arcs_b[j, 3]
        low_x = min(cx, dx) - bow - noise
        high_x = max(cx, dx) + bow + noise
        low_y = min(cy, dy) - bow - noise
        high_y = max(cy, dy) + bow + noise
        u = arcs_b[j, 2]
        gx = gy = 0.0
        if u != 0.0:
            gx, gy = placed(arcs_b, j, rel)
        for near in range(close):
            i = a0 + int(label[near])
            k = i + 1 if i + 1 < a0 + na else a0
            ax = qa[i, 0]
            ay = qa[i, 1]
            bx = qa[k, 0]
            by = qa[k, 1]
            bow = arcs_a[i, 3]
            if (
                (max(ax, bx) + bow < low_x)
                | (min(ax, bx) - bow > high_x)
                | (max(ay, by) + bow < low_y)
                | (min(ay, by) - bow > high_y)
            ):
                continue
            r = arcs_a[i, 2]
            enters = 1  # of the crossing at (x1, y1)
            if r == 0.0 and u == 0.0:
                bits, x1, y1 = line_line(ax, ay, bx, by, cx, cy, dx, dy)
                if bits & SECOND:
                    bits = FIRST
                    enters = -1
                x2 = x1
                y2 = y1
            elif r == 0.0:
                bits, x1, y1, x2, y2 = line_arc(ax, ay, bx, by, cx, cy, dx, dy, gx, gy, u, True, noise)
            elif u == 0.0:
                bits, x1, y1, x2, y2 = line_arc(
                    cx, cy, dx, dy, ax, ay, bx, by, arcs_a[i, 0], arcs_a[i, 1], r, False, noise
                )
                enters = -1  # where B enters A: A leaves B
            else:
                bits, x1, y1, x2, y2 = arc_arc(
                    ax, ay, bx, by, arcs_a[i, 0], arcs_a[i, 1], r, cx, cy, dx, dy, gx, gy, u, noise
                )
            if bits == UNSURE:
                return TANGLED
            if bits & FIRST:
                n += 1
                if enters == 1:
                    in_a = i
                    in_b = j
                    in_x = x1
                    in_y = y1
                else:
                    out_a = i
                    out_b = j
                    out_x = x1
                    out_y = y1
            if bits & SECOND:
                n += 1
                if enters == 1:
                    out_a = i
                    out_b = j
                    out_x = x2
                    out_y = y2
                else:
                    in_a = i
                    in_b = j
                    in_x = x2
                    in_y = y2
    if n == 0:
        # a box that holds B, and one that B's points fill: whatever holds B holds that
        b_left = b_bottom = least_x = least_y = np.inf
        b_right = b_top = most_x = most_y = -np.inf
        dx, dy = placed(qb, b0, rel)
        for j in range(b0, b0 + nb):
            cx = dx
            cy = dy
            dx, dy = placed(qb, j + 1 if j + 1 < b0 + nb else b0, rel)
            bow = arcs_b[j, 3]
            least_x = min(least_x, dx)
            most_x = max(most_x, dx)
            least_y = min(least_y, dy)
            most_y = max(most_y, dy)
            b_left = min(b_left, cx - bow, dx - bow)
            b_right = max(b_right, cx + bow, dx + bow)
            b_bottom = min(b_bottom, cy - bow, dy - bow)
            b_top = max(b_top, cy + bow, dy + bow)
        a_holds_b = least_x >= left and most_x <= right and least_y >= bottom and most_y <= top
        b_holds_a = b_left <= left and b_right >= right and b_bottom <= bottom and b_top >= top
        return OTHERWISE if a_holds_b or b_holds_a else 0
    if n != 2 or in_a < 0 or out_a < 0:
        return OTHERWISE
    if (in_a == out_a or in_b == out_b) and abs(in_x - out_x) + abs(in_y - out_y) < NEARBY * (
        right - left + top - bottom
    ):
        return OTHERWISE
    v = 0
    e = in_a
    x = in_x
    y = in_y
    more = e != out_a
    if not more:
        ax = qa[e, 0]
        ay = qa[e, 1]
        k = e + 1 if e + 1 < a0 + na else a0
        bx = qa[k, 0]
        by = qa[k, 1]
        fx = arcs_a[e, 0]
        fy = arcs_a[e, 1]
        r = arcs_a[e, 2]
        more = along_edge(ax, ay, bx, by, fx, fy, r, out_x, out_y) < along_edge(
            ax, ay, bx, by, fx, fy, r, x, y
        )
    while True:
        k = e + 1 if e + 1 < a0 + na else a0
        qx = qa[k, 0] if more else out_x
        qy = qa[k, 1] if more else out_y
        v = put(p, label, bows, v, A_EDGE, x, y, qx, qy, arcs_a[e, 0], arcs_a[e, 1], arcs_a[e, 2])
        if not more:
            break
        e = k
        x = qx
        y = qy
        more = e != out_a
    e = out_b
    x = out_x
    y = out_y
    more = e != in_b
    if not more:
        ax, ay = placed(qb, e, rel)
        bx, by = placed(qb, e + 1 if e + 1 < b0 + nb else b0, rel)
        fx, fy = placed(arcs_b, e, rel)
        r = arcs_b[e, 2]
        more = along_edge(ax, ay, bx, by, fx, fy, r, in_x, in_y) < along_edge(ax, ay, bx, by, fx, fy, r, x, y)
    while True:
        k = e + 1 if e + 1 < b0 + nb else b0
        fx, fy = placed(arcs_b, e, rel)
        qx, qy = placed(qb, k, rel)
        if not more:
            qx = in_x
            qy = in_y
        v = put(p, label, bows, v, B_EDGE, x, y, qx, qy, fx, fy, arcs_b[e, 2])
        if not more:
            break
        e = k
        x = qx
        y = qy
        more = e != in_b
    n = measure(p, label, bows, loops, 0, 0, v, True, True, noise)
    return 0 if n == 0 or loops[0].area < 0.0 else 1  # negative: rounding
