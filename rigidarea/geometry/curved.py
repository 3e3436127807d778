"""Crossings of boundaries with arcs: what `crossings.py` asks for where an edge may be curved."""

from __future__ import annotations

import numpy as np

from ..compile.jit import kernel
from .arc import FIRST, SECOND, UNSURE, arc_arc, line_arc, turned
from .predicates import side
from .work import OVERFLOW, TANGLED, Relative, placed


@kernel(forceinline=True)
def along_edge(
    ax: float, ay: float, bx: float, by: float, cx: float, cy: float, r: float, x: float, y: float
) -> float:
    """Where on the edge or arc a -> b a point lies: grows along it."""
    if r != 0.0:
        return turned(ax, ay, cx, cy, r, x, y)
    ux = bx - ax
    uy = by - ay
    return ((x - ax) * ux + (y - ay) * uy) / (ux * ux + uy * uy)


@kernel
def cross_curved_leaves(
    qa: np.ndarray, next_a: np.ndarray, arcs_a: np.ndarray, a0: int, a1: int, boxes: np.ndarray, box: int,
    qb: np.ndarray, next_b: np.ndarray, arcs_b: np.ndarray, b0: int, b1: int, rel: Relative, noise: float,
    cross: np.ndarray, param: np.ndarray, spot: np.ndarray, n: int,
) -> int:  # fmt: skip
    """Append the crossings of edges a0..a1 of A, which lie in boxes[box], with edges b0..b1 of B.

    Returns their number, or OVERFLOW, or TANGLED.
    """
    near_x = boxes[box, 0] - boxes[box, 2]
    far_x = boxes[box, 0] + boxes[box, 2]
    near_y = boxes[box, 1] - boxes[box, 3]
    far_y = boxes[box, 1] + boxes[box, 3]
    for j in range(b0, b1):
        cx, cy = placed(qb, j, rel)
        dx, dy = placed(qb, next_b[j], rel)
        bow = arcs_b[j, 3]
        low_x = min(cx, dx) - bow - noise
        high_x = max(cx, dx) + bow + noise
        low_y = min(cy, dy) - bow - noise
        high_y = max(cy, dy) + bow + noise
        if high_x < near_x or low_x > far_x or high_y < near_y or low_y > far_y:
            continue
        gx, gy = placed(arcs_b, j, rel)
        u = arcs_b[j, 2]
        for i in range(a0, a1):
            k = next_a[i]
            ax = qa[i, 0]
            ay = qa[i, 1]
            bx = qa[k, 0]
            by = qa[k, 1]
            bow = arcs_a[i, 3]
            if (
                max(ax, bx) + bow < low_x
                or min(ax, bx) - bow > high_x
                or max(ay, by) + bow < low_y
                or min(ay, by) - bow > high_y
            ):
                continue
            fx = arcs_a[i, 0]
            fy = arcs_a[i, 1]
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
                enters = 1 if u > 0.0 else -1
            elif u == 0.0:
                bits, x1, y1, x2, y2 = line_arc(cx, cy, dx, dy, ax, ay, bx, by, fx, fy, r, False, noise)
                enters = -1 if r > 0.0 else 1  # B enters A: A leaves B
            else:
                bits, x1, y1, x2, y2 = arc_arc(ax, ay, bx, by, fx, fy, r, cx, cy, dx, dy, gx, gy, u, noise)
                enters = 1 if (r > 0.0) == (u > 0.0) else -1
            if bits == UNSURE:
                return TANGLED
            for bit in (FIRST, SECOND):
                if bits & bit:
                    if n == len(cross):
                        return OVERFLOW
                    x = x1 if bit == FIRST else x2
                    y = y1 if bit == FIRST else y2
                    cross[n, 0] = i
                    cross[n, 1] = j
                    cross[n, 2] = enters if bit == FIRST else -enters
                    param[n, 0] = along_edge(ax, ay, bx, by, fx, fy, r, x, y)
                    param[n, 1] = along_edge(cx, cy, dx, dy, gx, gy, u, x, y)
                    spot[n, 0] = x
                    spot[n, 1] = y
                    n += 1
    return n


@kernel
def line_line(
    ax: float, ay: float, bx: float, by: float, cx: float, cy: float, dx: float, dy: float
) -> tuple[int, float, float]:
    """(FIRST where a -> b of A enters B through c -> d, SECOND where it leaves, 0 for no crossing; the point)."""
    sc = side(ax, ay, bx, by, cx, cy, True)
    sd = side(ax, ay, bx, by, dx, dy, True)
    if (sc > 0.0) == (sd > 0.0):
        return 0, 0.0, 0.0
    sa = side(cx, cy, dx, dy, ax, ay, False)
    sb = side(cx, cy, dx, dy, bx, by, False)
    if (sa > 0.0) == (sb > 0.0):
        return 0, 0.0, 0.0
    ux = bx - ax
    uy = by - ay
    vx = dx - cx
    vy = dy - cy
    bits = FIRST if sb > 0.0 else SECOND
    if vx * vx + vy * vy < ux * ux + uy * uy:  # on the shorter edge: less room for rounding
        t = sc / (sc - sd)
        return bits, cx + t * vx, cy + t * vy
    t = sa / (sa - sb)
    return bits, ax + t * ux, ay + t * uy
