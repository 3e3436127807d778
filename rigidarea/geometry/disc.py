"""Overlap of a disc with any convex outline, edges and arcs (two discs: `two_discs`).

A disc's boundary has no corner and no start, so nothing of it can lie on a corner of the other: every decision is
whether an end of an edge lies inside the circle, a sign that both edges at that end share, and that rounding cannot
touch (else TANGLED, see `arc`). One walk round the other outline, past what lies out of the disc's reach, finds where
it enters the disc and leaves it, in order; between a leaving and the next entering the disc's own arc closes the
region, because both are convex. The region is one. Where the two lie so near to each other that the arc between could
as well be the rest of the circle (OTHERWISE), the general way asks a point.
"""

from __future__ import annotations

import math

import numpy as np

from ..compile.jit import kernel
from .arc import ROUND, across, circle_circle, distance2, on_arc, segment
from .pool import LEAF
from .two_discs import whole_disc
from .work import A_EDGE, B_EDGE, NEARBY, NO_AREA, OTHERWISE, TANGLED, Relative, measure, placed, put

#: Instead of a number of vertices: the region is all of the disc.
WHOLE = -1


@kernel
def _put(
    p: np.ndarray, label: np.ndarray, bows: np.ndarray, v: int, own: int,
    px: float, py: float, qx: float, qy: float, cx: float, cy: float, r: float,
) -> int:  # fmt: skip
    """`put`, called: for what happens rarely."""
    return put(p, label, bows, v, own, px, py, qx, qy, cx, cy, r)


@kernel(forceinline=True)
def _close(
    p: np.ndarray, label: np.ndarray, bows: np.ndarray, v: int, own: int,
    px: float, py: float, qx: float, qy: float, cx: float, cy: float, r: float,
) -> int:  # fmt: skip
    """Append the disc's arc p -> q, counter-clockwise, however far."""
    ax = px - cx
    ay = py - cy
    bx = qx - cx
    by = qy - cy
    if ax * by - ay * bx < 0.0:
        # more than half a turn: halved opposite the middle of the chord
        mx = -(ax + bx)
        my = -(ay + by)
        if mx * mx + my * my < r * r:
            mx = by - ay
            my = ax - bx
        f = r / math.sqrt(mx * mx + my * my)
        mx = cx + f * mx
        my = cy + f * my
        v = _put(p, label, bows, v, own, px, py, mx, my, cx, cy, r)
        px = mx
        py = my
    return put(p, label, bows, v, own, px, py, qx, qy, cx, cy, r)


@kernel
def _close_between(
    p: np.ndarray, label: np.ndarray, bows: np.ndarray, v: int, own: int,
    px: float, py: float, qx: float, qy: float, cx: float, cy: float, r: float,
) -> int:  # fmt: skip
    """`_close`, called: where the outline comes in again, which is rare."""
    return _close(p, label, bows, v, own, px, py, qx, qy, cx, cy, r)


@kernel
def _cut_by_arc(
    px: float, py: float, qx: float, qy: float, ax: float, ay: float, a: float, p_in: bool, q_in: bool,
    cx: float, cy: float, r: float, room: float,
) -> tuple[bool, bool, bool, float, float, float, float]:  # fmt: skip
    """Where the arc p -> q, counter-clockwise, enters the disc and leaves it: (whether it touches it within `room`,
    whether it enters, whether it leaves, entry, exit)."""
    if p_in == q_in:
        d = math.sqrt(distance2(cx, cy, ax, ay))
        reach = (-a if p_in else a) / d if d > 0.0 else 0.0
        if not on_arc(px, py, qx, qy, a, ax + reach * (cx - ax), ay + reach * (cy - ay)):
            return False, False, False, 0.0, 0.0, 0.0, 0.0
        if d >= a + r - room or d <= abs(a - r) + room:
            return d <= a + r + room and d >= abs(a - r) - room, False, False, 0.0, 0.0, 0.0, 0.0
    _, _, x1, y1, x2, y2 = circle_circle(ax, ay, a, cx, cy, r)
    if p_in == q_in:
        return False, True, True, x1, y1, x2, y2
    return False, q_in, p_in, x1, y1, x2, y2


@kernel
def _cut_off(
    p: np.ndarray, label: np.ndarray, bows: np.ndarray, loops: np.ndarray, own: int,
    cx: float, cy: float, r: float, ux: float, uy: float, half: float, distance: float, noise: float,
) -> int:  # fmt: skip
    """The region that one straight edge along (ux, uy) cuts off a disc whose centre lies `distance` to its right.

    half: of the chord. No more than half of the disc, and in closed form.
    """
    area, moment = segment(half, distance, r)
    if area <= max(NO_AREA * 16.0 * half, 2.0 * noise) * half:  # as `measure` has it
        return 0
    fx = cx - distance * uy
    fy = cy + distance * ux
    hx = half * ux
    hy = half * uy
    p[0, 0] = fx - hx
    p[0, 1] = fy - hy
    p[1, 0] = fx + hx
    p[1, 1] = fy + hy
    p[2, 0] = cx - r * uy
    p[2, 1] = cy + r * ux
    label[0] = own
    bows[0, 2] = 0.0
    mine = B_EDGE if own == A_EDGE else A_EDGE
    for v in range(1, 3):
        label[v] = mine
        bows[v, 0] = cx
        bows[v, 1] = cy
        bows[v, 2] = r
    along = moment / area
    sign = 2.0 if own == A_EDGE else -2.0
    loop = loops[0]
    loop.start = 0
    loop.stop = 3
    loop.area = area
    loop.x = fx - along * uy
    loop.y = fy + along * ux
    loop.chord_x = sign * hx
    loop.chord_y = sign * hy
    loop.lever = 0.0
    loop.straight = 0.0
    loop.region = 0
    loop.arcs = 1
    return 1


@kernel
def disc_convex(
    cx: float, cy: float, r: float, points: np.ndarray, arcs: np.ndarray, boxes: np.ndarray, begin: int, count: int,
    leaf: int, place: Relative, own: int, p: np.ndarray, label: np.ndarray, bows: np.ndarray, loops: np.ndarray,
    noise: float,
) -> int:  # fmt: skip
    """A disc at (cx, cy) with the convex outline of `count` edges from begin on, placed (by the identity if it is A).

    Worked out where the outline's own coordinates are, so that only the disc's centre and the result need placing.
    Of its hierarchy only the leaves are looked at, rows of boxes from `leaf` on: edges of those that the disc's reach
    does not meet are passed over. own: the outline's label, A_EDGE or B_EDGE. p, label, bows, loops: the scratch's.
    """
    dx = cx - place.tx
    dy = cy - place.ty
    kx = place.c * dx + place.s * dy
    ky = place.c * dy - place.s * dx
    mine = B_EDGE if own == A_EDGE else A_EDGE
    r2 = r * r
    reach = r + 2.0 * noise
    near = 2.0 * r * (noise + ROUND * r)
    within2 = r2 - near  # nearer than that, squared: certainly within the circle
    beyond2 = r2 + near  # farther: certainly beyond
    v = 0
    crossed = 0
    open_ = False  # left, and not entered since, at (out_x, out_y)
    out_x = out_y = in_x = in_y = 0.0
    edge_x = edge_y = edge_half = edge_distance = 0.0  # of the last straight edge that cuts the circle
    for first in range(0, count, LEAF):
        row = leaf + first // LEAF
        far_x = max(0.0, abs(kx - boxes[row, 0]) - boxes[row, 2])
        far_y = max(0.0, abs(ky - boxes[row, 1]) - boxes[row, 3])
        if far_x * far_x + far_y * far_y > reach * reach:
            continue
        px = points[begin + first, 0]
        py = points[begin + first, 1]
        wx = kx - px
        wy = ky - py
        p_in = wx * wx + wy * wy < within2
        for e in range(begin + first, begin + min(first + LEAF, count)):
            k = e + 1 if e + 1 < begin + count else begin
            qx = points[k, 0]
            qy = points[k, 1]
            vx = kx - qx
            vy = ky - qy
            far2 = vx * vx + vy * vy
            q_in = far2 <= beyond2
            if q_in and far2 >= within2:
                return TANGLED
            a = arcs[e, 2]
            enters = False
            leaves = False
            x1 = y1 = x2 = y2 = 0.0
            ax = ay = 0.0
            if a == 0.0:
                if not (p_in and q_in):
                    ux = qx - px
                    uy = qy - py
                    turn = ux * wy - uy * wx
                    length2 = ux * ux + uy * uy
                    cuts = p_in or q_in
                    if not cuts:
                        far2 = turn * turn
                        if far2 > beyond2 * length2:
                            if turn < 0.0:
                                return 0  # the whole disc lies beyond this edge
                        else:
                            certain = far2 < within2 * length2
                            if not certain and turn < 0.0:
                                return 0  # or what does not is rounding
                            cuts = 0.0 < ux * wx + uy * wy < length2
                            if cuts and not certain:
                                return TANGLED
                    if cuts:
                        inverse = 1.0 / math.sqrt(length2)
                        ux *= inverse
                        uy *= inverse
                        distance = turn * inverse
                        half = math.sqrt(max(0.0, (r - abs(distance)) * (r + abs(distance))))
                        edge_x = ux
                        edge_y = uy
                        edge_half = half
                        edge_distance = distance
                        fx = kx + distance * uy
                        fy = ky - distance * ux
                        enters = not p_in
                        leaves = not q_in
                        x1 = fx - half * ux
                        y1 = fy - half * uy
                        x2 = fx + half * ux
                        y2 = fy + half * uy
            else:
                ax = arcs[e, 0]
                ay = arcs[e, 1]
                d2 = distance2(kx, ky, ax, ay)
                room = noise + ROUND * (a + r)
                least = max(0.0, abs(a - r) - room)
                if p_in != q_in or least * least <= d2 <= (a + r + room) * (a + r + room):
                    touches, enters, leaves, x1, y1, x2, y2 = _cut_by_arc(
                        px, py, qx, qy, ax, ay, a, p_in, q_in, kx, ky, r, room
                    )
                    if touches:
                        return TANGLED
            # what of p -> q lies inside the disc, and the disc's arc before it
            back = enters and leaves and p_in  # an arc goes out and comes in again
            if back:
                v = _put(p, label, bows, v, own, px, py, x2, y2, ax, ay, a)
                out_x = x2
                out_y = y2
                open_ = True
            if enters:
                crossed += 1
                if open_:
                    if distance2(x1, y1, out_x, out_y) < NEARBY * NEARBY * r2:
                        return OTHERWISE
                    v = _close_between(p, label, bows, v, mine, out_x, out_y, x1, y1, kx, ky, r)
                    open_ = False
                else:
                    in_x = x1
                    in_y = y1
            if p_in or enters:
                gone = leaves and not back
                v = put(
                    p, label, bows, v, own, x1 if enters else px, y1 if enters else py,
                    x2 if gone else qx, y2 if gone else qy, ax, ay, a,
                )  # fmt: skip
                if gone:
                    out_x = x2
                    out_y = y2
                    open_ = True
            px = qx
            py = qy
            wx = vx
            wy = vy
            p_in = q_in
    n = 0
    if crossed == 0:
        v = _nested(kx, ky, r, points, arcs, begin, count, own, p, label, bows)
        if v == WHOLE:
            v = 0
            n = whole_disc(p, label, bows, loops, mine, kx, ky, r)
    elif crossed == 1 and v == 1 and edge_distance < 0.0 and bows[0, 2] == 0.0:
        v = 0
        n = _cut_off(p, label, bows, loops, own, kx, ky, r, edge_x, edge_y, edge_half, -edge_distance, noise)
    elif open_:
        if distance2(out_x, out_y, in_x, in_y) < NEARBY * NEARBY * r2:
            return OTHERWISE
        v = _close(p, label, bows, v, mine, out_x, out_y, in_x, in_y, kx, ky, r)
    if v > 0:
        n = measure(p, label, bows, loops, 0, 0, v, True, False, noise)
    if n == 0 or loops[0].area < 0.0:  # negative: rounding
        return 0
    if own == B_EDGE:
        _put_there(p, bows, loops, place)
    return 1


@kernel(forceinline=True)
def _put_there(p: np.ndarray, bows: np.ndarray, loops: np.ndarray, place: Relative) -> None:
    """Place the first loop."""
    loop = loops[0]
    for i in range(loop.stop):
        p[i, 0], p[i, 1] = placed(p, i, place)
        if bows[i, 2] != 0.0:
            bows[i, 0], bows[i, 1] = placed(bows, i, place)
    x = loop.x
    y = loop.y
    loop.x = place.c * x - place.s * y + place.tx
    loop.y = place.s * x + place.c * y + place.ty
    x = loop.chord_x
    y = loop.chord_y
    loop.chord_x = place.c * x - place.s * y
    loop.chord_y = place.s * x + place.c * y


@kernel
def _nested(
    cx: float, cy: float, r: float, points: np.ndarray, arcs: np.ndarray, begin: int, count: int, own: int,
    p: np.ndarray, label: np.ndarray, bows: np.ndarray,
) -> int:  # fmt: skip
    """`disc_convex` where boundaries do not cross: all of the outline, put down (its vertices' number), if it lies in
    the disc; WHOLE if the disc lies in it; 0 if they are apart."""
    farthest = 0.0
    inside = True  # the disc's centre, of the polygon of the chords, or of what an arc adds to it
    v = 0
    for e in range(begin, begin + count):
        k = e + 1 if e + 1 < begin + count else begin
        px = points[e, 0]
        py = points[e, 1]
        qx = points[k, 0]
        qy = points[k, 1]
        ax = arcs[e, 0]
        ay = arcs[e, 1]
        a = arcs[e, 2]
        v = put(p, label, bows, v, own, px, py, qx, qy, ax, ay, a)
        farthest = max(farthest, distance2(px, py, cx, cy))
        if (qx - px) * (cy - py) - (qy - py) * (cx - px) < 0.0 and not (
            a > 0.0 and across(cx, cy, ax, ay, a)
        ):
            inside = False
    for k in range(v):
        farthest = max(farthest, distance2(p[k, 0], p[k, 1], cx, cy))
    if farthest <= r * r * (1.0 + 1e-9):  # a corner may touch the circle
        return v
    return WHOLE if inside else 0
