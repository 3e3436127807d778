"""Circular arcs in the overlap kernels: what lies between arc and chord, and where arcs meet edges and arcs.

An arc p -> q has a centre c and a signed radius r: r > 0 runs counter-clockwise, r < 0 clockwise; it sweeps half a
turn at the most (`arcs.py`), so its points are those of the circle to the right of p -> q for r > 0, to the
left for r < 0, and half a chord and a radius say all of its measures.

*Which crossings there are* is decided by signs at the ends of the edges alone: on which side of a line an end lies
(exact, `predicates.side`), inside or outside which circle. An edge whose ends differ crosses once; one whose ends are
alike crosses twice or not at all, both together, and a root is never compared with an end.

No double holds a point of a circle, so a sign at a circle cannot be exact. It is a filter: an end that lies further
from the other edge or arc than all rounding together (`noise`, and ROUND of the radii) has the sign it seems to have;
a nearer one is UNSURE, and the query is asked again with B shifted (`place.overlap_of_outlines`). So the signs that an
answer rests on are all those of the same two boundaries: of closed curves through the very ends that the doubles say,
on arcs that lie within rounding of the stored circles. Hence

- *tangency*: where ends are alike and the two come nearest, they cross twice or not at all by more than rounding, or
  the pair is UNSURE. After the shift they are apart, or cross well.
- *an end on a tangent, on an arc, on another end* is UNSURE, and after the shift it is beside it.
- *arcs of one radius and centre*: wherever they lie on each other one of them ends, so that is UNSURE too. Circles are
  of two halves, so they have ends.
"""

from __future__ import annotations

import math

from ..compile.jit import entry, kernel
from .predicates import side

#: Bits of what `line_arc` and `arc_arc` return.
FIRST, SECOND = 1, 2
#: An end lies on the other edge to rounding, or the circles are one: undecided. (No other result has this bit.)
UNSURE = 4
#: What an arc may be off its stored circle by, over the radius: roundings of centre, radius and distance.
ROUND = 2.0**-50
#: (half chord / radius)^2 below which the series is used: there the closed form would lose two digits.
FLAT = 0.02

# Both series follow from dF/dx = 2 x^2 (1 - x^2)^(-1/2) and dM/dx = x F (1 - x^2)^(-1/2); eight terms reach rounding at
# FLAT.
_HALVES = [math.comb(2 * k, k) / 4.0**k for k in range(8)]  # of (1 - x^2)^(-1/2)
_F = [2.0 * b / (2 * k + 3) for k, b in enumerate(_HALVES)]
_M = [sum(_F[i] * _HALVES[k - i] for i in range(k + 1)) / (2 * k + 5) for k in range(8)]
_F0, _F1, _F2, _F3, _F4, _F5, _F6, _F7 = _F
_M0, _M1, _M2, _M3, _M4, _M5, _M6, _M7 = _M


@kernel(forceinline=True)
def flat_segment(x: float, x2: float) -> tuple[float, float]:
    """`segment` of a flat one: x = half chord / radius, x2 its square, below FLAT."""
    f = _F4 + x2 * (_F5 + x2 * (_F6 + x2 * _F7))
    f = _F0 + x2 * (_F1 + x2 * (_F2 + x2 * (_F3 + x2 * f)))
    m = _M4 + x2 * (_M5 + x2 * (_M6 + x2 * _M7))
    m = _M0 + x2 * (_M1 + x2 * (_M2 + x2 * (_M3 + x2 * m)))
    x3 = x2 * x
    return x3 * f, x3 * x2 * m


@kernel(forceinline=True)
def segment(half: float, apothem: float, radius: float) -> tuple[float, float]:
    """(area, first moment about the chord, away from the centre) between a chord and its arc (length^2, length^3).

    half: of the chord; apothem: the chord's distance from the centre, negative where the arc is more than half a turn.
    """
    x = half / radius
    x2 = x * x
    r2 = radius * radius
    if x2 < FLAT and apothem > 0.0:
        area, moment = flat_segment(x, x2)
    else:
        c = apothem / radius
        area = math.atan2(half, apothem) - x * c
        moment = (2.0 / 3.0) * x2 * x - area * c
    return r2 * area, r2 * radius * moment


@kernel(forceinline=True)
def distance2(ax: float, ay: float, bx: float, by: float) -> float:
    """Squared distance of two points (length^2). (A power `x ** 2` is a loop in machine code.)"""
    dx = ax - bx
    dy = ay - by
    return dx * dx + dy * dy


@kernel(forceinline=True)
def inside(x: float, y: float, cx: float, cy: float, r: float) -> float:
    """Radius squared less distance squared of a point from the centre: positive inside the circle."""
    dx = x - cx
    dy = y - cy
    return r * r - (dx * dx + dy * dy)


@kernel(forceinline=True)
def across(x: float, y: float, cx: float, cy: float, r: float) -> bool:
    """Whether a point lies inside a circle."""
    return inside(x, y, cx, cy, r) > 0.0


@entry(forceinline=True)
def on_arc(px: float, py: float, qx: float, qy: float, r: float, x: float, y: float) -> bool:
    """Whether a point of the circle lies on its arc p -> q."""
    return ((qx - px) * (y - py) - (qy - py) * (x - px)) * r < 0.0


@kernel(forceinline=True)
def to_edge2(px: float, py: float, ax: float, ay: float, bx: float, by: float) -> float:
    """Squared distance of a point from the edge a -> b (length^2)."""
    ux = bx - ax
    uy = by - ay
    vx = px - ax
    vy = py - ay
    t = min(1.0, max(0.0, (ux * vx + uy * vy) / (ux * ux + uy * uy)))
    dx = vx - t * ux
    dy = vy - t * uy
    return dx * dx + dy * dy


@kernel
def near_arc(px: float, py: float, qx: float, qy: float, r: float, x: float, y: float, room: float) -> bool:
    """Whether a point within `room` (length) of the circle lies as near to its arc p -> q; flat arcs may say so too
    often."""
    ux = qx - px
    uy = qy - py
    left = ux * (y - py) - uy * (x - px)
    return (left if r > 0.0 else -left) < room * math.sqrt(ux * ux + uy * uy)


@kernel(forceinline=True)
def top(px: float, py: float, qx: float, qy: float, cx: float, cy: float, r: float) -> tuple[float, float]:
    """The middle of the arc p -> q. (Any point of it will do for its measures: halves add up.)"""
    gx = 0.5 * (px + qx) - cx
    gy = 0.5 * (py + qy) - cy
    g2 = gx * gx + gy * gy
    if px == qx and py == qy:  # a whole circle, whose ring is its centre
        return cx + r, cy
    if g2 <= 0.5 * r * r:  # a wide arc: across its chord
        gx = qy - py
        gy = px - qx
        f = r / math.sqrt(gx * gx + gy * gy)
    else:
        f = abs(r) / math.sqrt(g2)
    return cx + f * gx, cy + f * gy


@kernel(forceinline=True)
def turned(px: float, py: float, cx: float, cy: float, r: float, x: float, y: float) -> float:
    """How far along the arc from p a point lies: grows from 0 to 2 over half a turn, as the angle does.

    Points that rounding has put before p, or beyond the half turn, stay there.
    """
    ax = px - cx
    ay = py - cy
    bx = x - cx
    by = y - cy
    dot = ax * bx + ay * by
    cross = ax * by - ay * bx
    if r < 0.0:
        cross = -cross
    if dot >= 0.0:
        return cross / (abs(cross) + dot)
    if cross >= 0.0:
        return 1.0 - dot / (cross - dot)
    return 2.0 - cross / (-cross - dot) if cross > dot else -1.0


@kernel
def line_arc(
    ax: float, ay: float, bx: float, by: float,
    px: float, py: float, qx: float, qy: float, cx: float, cy: float, r: float, arc_of_b: bool, noise: float,
) -> tuple[int, float, float, float, float]:  # fmt: skip
    """Crossings of the edge a -> b with the arc p -> q: (bits, x1, y1, x2, y2), or UNSURE.

    FIRST: the edge enters the arc's circle at (x1, y1); SECOND: it leaves it at (x2, y2). noise: see `work.noise_of`.
    """
    ux = bx - ax
    uy = by - ay
    wx = cx - ax
    wy = cy - ay
    length2 = ux * ux + uy * uy
    turn = ux * wy - uy * wx
    room = noise + ROUND * abs(r)
    far = abs(r) + room
    if turn * turn > far * far * length2:  # beyond all rounding: neither the arc nor an end of it is there
        return 0, 0.0, 0.0, 0.0, 0.0
    p_side = side(ax, ay, bx, by, px, py, arc_of_b)
    q_side = side(ax, ay, bx, by, qx, qy, arc_of_b)
    a_deep = inside(ax, ay, cx, cy, r)
    b_deep = inside(bx, by, cx, cy, r)
    close = room * room * length2
    deep = 2.0 * room * abs(r)
    if (
        (p_side * p_side <= close and to_edge2(px, py, ax, ay, bx, by) <= room * room)
        or (q_side * q_side <= close and to_edge2(qx, qy, ax, ay, bx, by) <= room * room)
        or (abs(a_deep) <= deep and near_arc(px, py, qx, qy, r, ax, ay, room))
        or (abs(b_deep) <= deep and near_arc(px, py, qx, qy, r, bx, by, room))
    ):
        return UNSURE, 0.0, 0.0, 0.0, 0.0
    p_left = p_side > 0.0
    q_left = q_side > 0.0
    a_in = a_deep > 0.0
    b_in = b_deep > 0.0
    if a_in and b_in:
        return 0, 0.0, 0.0, 0.0, 0.0
    if p_left == q_left and a_in == b_in:
        least = max(0.0, abs(r) - room)
        if turn * turn >= least * least * length2:  # a tangent, or passing by
            tangent = turn * turn <= far * far * length2 and 0.0 < ux * wx + uy * wy < length2
            foot = turn / length2
            if tangent and on_arc(px, py, qx, qy, r, cx + foot * uy, cy - foot * ux):
                return UNSURE, 0.0, 0.0, 0.0, 0.0
            return 0, 0.0, 0.0, 0.0, 0.0
    length = math.sqrt(length2)
    ex = ux / length
    ey = uy / length
    distance = turn / length  # of the centre, to the left
    if a_in == b_in:  # both outside
        along = ex * wx + ey * wy
        if along <= 0.0 or along >= length:
            return 0, 0.0, 0.0, 0.0, 0.0
        bits = FIRST | SECOND
    else:
        bits = FIRST if b_in else SECOND
    if p_left != q_left:
        bits &= FIRST if (r > 0.0) == p_left else SECOND
    else:
        reach = abs(r) if p_left else -abs(r)
        if not on_arc(px, py, qx, qy, r, cx + reach * ey, cy - reach * ex):
            return 0, 0.0, 0.0, 0.0, 0.0
    half = math.sqrt(max(0.0, (abs(r) - abs(distance)) * (abs(r) + abs(distance))))
    fx = cx + distance * ey
    fy = cy - distance * ex
    return bits, fx - half * ex, fy - half * ey, fx + half * ex, fy + half * ey


@kernel
def circle_circle(
    ax: float, ay: float, a: float, bx: float, by: float, b: float
) -> tuple[float, float, float, float, float, float]:
    """Where the circles of radius a about (ax, ay) and b about (bx, by) meet: (dx, dy, x1, y1, x2, y2).

    (dx, dy) is the unit direction from a's centre to b's. Circle a, counter-clockwise, enters b at (x1, y1), to the
    right of it, and leaves it at (x2, y2). Where they do not meet: the point nearest to meeting, twice.
    """
    dx = bx - ax
    dy = by - ay
    d = math.sqrt(dx * dx + dy * dy)
    if d == 0.0:
        return 1.0, 0.0, ax, ay, ax, ay
    dx /= d
    dy /= d
    heron = ((a + b) - d) * (d - (a - b)) * (d + (a - b)) * (d + (a + b))
    half = math.sqrt(max(0.0, heron)) / (2.0 * d)
    if a <= b:  # from the smaller circle, whose rounding is less
        foot = min(a, max(-a, 0.5 * (d - (b - a) * (a + b) / d)))
        fx = ax + foot * dx
        fy = ay + foot * dy
    else:
        foot = min(b, max(-b, 0.5 * (d - (a - b) * (a + b) / d)))
        fx = bx - foot * dx
        fy = by - foot * dy
    return dx, dy, fx + half * dy, fy - half * dx, fx - half * dy, fy + half * dx


@kernel
def arc_arc(
    px: float, py: float, qx: float, qy: float, cx: float, cy: float, r: float,
    sx: float, sy: float, tx: float, ty: float, gx: float, gy: float, u: float, noise: float,
) -> tuple[int, float, float, float, float]:  # fmt: skip
    """Crossings of the arc p -> q (c, r) with the arc s -> t (g, u): (bits, x1, y1, x2, y2), or UNSURE.

    FIRST: the first circle, counter-clockwise, enters the second; SECOND: it leaves it.
    """
    a = abs(r)
    b = abs(u)
    dx = gx - cx
    dy = gy - cy
    d2 = dx * dx + dy * dy
    room = noise + ROUND * (a + b)
    far = a + b + room
    if d2 > far * far:  # beyond all rounding
        return 0, 0.0, 0.0, 0.0, 0.0
    p_deep = inside(px, py, gx, gy, b)
    q_deep = inside(qx, qy, gx, gy, b)
    s_deep = inside(sx, sy, cx, cy, a)
    t_deep = inside(tx, ty, cx, cy, a)
    deep_a = 2.0 * room * a
    deep_b = 2.0 * room * b
    if (
        (abs(p_deep) <= deep_b and near_arc(sx, sy, tx, ty, u, px, py, room))
        or (abs(q_deep) <= deep_b and near_arc(sx, sy, tx, ty, u, qx, qy, room))
        or (abs(s_deep) <= deep_a and near_arc(px, py, qx, qy, r, sx, sy, room))
        or (abs(t_deep) <= deep_a and near_arc(px, py, qx, qy, r, tx, ty, room))
    ):
        return UNSURE, 0.0, 0.0, 0.0, 0.0
    p_in = p_deep > 0.0
    q_in = q_deep > 0.0
    s_in = s_deep > 0.0
    t_in = t_deep > 0.0
    if p_in == q_in and s_in == t_in:
        most = max(0.0, a + b - room)
        least = abs(a - b) + room
        if d2 >= most * most or d2 <= least * least:  # they touch, or do not meet
            least = max(0.0, abs(a - b) - room)
            if least * least <= d2 and d2 > 0.0:
                d = math.sqrt(d2)
                near_a = a / d if d2 >= most * most or a > b else -a / d
                near_b = -b / d if d2 >= most * most or a < b else b / d
                if on_arc(px, py, qx, qy, r, cx + near_a * dx, cy + near_a * dy) and on_arc(
                    sx, sy, tx, ty, u, gx + near_b * dx, gy + near_b * dy
                ):
                    return UNSURE, 0.0, 0.0, 0.0, 0.0
            return 0, 0.0, 0.0, 0.0, 0.0
    dx, dy, x1, y1, x2, y2 = circle_circle(cx, cy, a, gx, gy, b)
    if p_in != q_in:
        bits = SECOND if p_in == (r > 0.0) else FIRST
    else:
        reach = -a if p_in else a
        if not on_arc(px, py, qx, qy, r, cx + reach * dx, cy + reach * dy):
            return 0, 0.0, 0.0, 0.0, 0.0
        bits = FIRST | SECOND
    if s_in != t_in:
        bits &= FIRST if s_in == (u > 0.0) else SECOND
    else:
        reach = b if s_in else -b
        if not on_arc(sx, sy, tx, ty, u, gx + reach * dx, gy + reach * dy):
            return 0, 0.0, 0.0, 0.0, 0.0
    return bits, x1, y1, x2, y2
