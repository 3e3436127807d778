"""Two convex outlines that do not meet: an axis along which they are apart, kept from substep to substep.

Most pairs that are near do not touch, and stay so. As long as the axis that parted them last parts them still, no
overlap need be worked out; and how fast it closes bounds whether a step can bring one (the separating axis of
Gottschalk, Lin & Manocha, SIGGRAPH 1996, doi:10.1145/237170.237244, kept as by Baraff, Comput Graph 24 (1990)).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..compile.jit import kernel
from .arc import on_arc
from .pool import Pool
from .work import Relative

#: Edges of A times edges of B up to which all their normals are tried; above, the line of centres alone.
MOST_TRIED = 64


@kernel
def reach(pool: Pool, i: int, line: bool, mx: float, my: float) -> float:
    """How far the outer ring of outline i reaches along the unit direction m, in its own frame (length).

    line: of a segment without thickness, which is its first edge: that.
    """
    head = pool.heads[i]
    if line:
        p = head.point
        return float(
            max(
                mx * pool.points[p, 0] + my * pool.points[p, 1],
                mx * pool.points[p + 1, 0] + my * pool.points[p + 1, 1],
            )
        )
    if head.disc:
        return float(head.radius)
    most = -np.inf
    for e in range(pool.rings[head.ring, 0], pool.rings[head.ring, 1]):
        x = pool.points[e, 0]
        y = pool.points[e, 1]
        most = max(most, mx * x + my * y)
        if head.arcs > 0 and pool.arcs[e, 2] > 0.0:
            r = pool.arcs[e, 2]
            k = pool.following[e]
            cx = pool.arcs[e, 0]
            cy = pool.arcs[e, 1]
            if on_arc(x, y, pool.points[k, 0], pool.points[k, 1], r, cx + r * mx, cy + r * my):
                most = max(most, mx * cx + my * cy + r)
    return float(most)


@kernel
def gap_along(
    pool: Pool, ia: int, ib: int, rel: Relative, mx: float, my: float, line_a: bool, line_b: bool
) -> float:
    """How far B is from A along m, a unit direction in A's frame; negative: so far it must go to be clear (length).

    line_a, line_b: whether one is a segment without thickness.
    """
    back = reach(pool, ib, line_b, -(rel.c * mx + rel.s * my), rel.s * mx - rel.c * my)
    return mx * rel.tx + my * rel.ty - reach(pool, ia, line_a, mx, my) - back


@kernel
def _nearest(pool: Pool, i: int, x: float, y: float) -> tuple[float, float]:
    """The point of a segment, outline i's first edge, nearest to (x, y), in its frame (length)."""
    p = pool.heads[i].point
    ax = pool.points[p, 0]
    ay = pool.points[p, 1]
    ex = pool.points[p + 1, 0] - ax
    ey = pool.points[p + 1, 1] - ay
    along = min(1.0, max(0.0, ((x - ax) * ex + (y - ay) * ey) / (ex * ex + ey * ey)))
    return ax + along * ex, ay + along * ey


@kernel
def find_axis(pool: Pool, ia: int, ib: int, rel: Relative, pair: Any, line_a: bool, line_b: bool) -> None:
    """The axis along which A and B are farthest apart, into pair.axis_x, axis_y, gap (of those that are tried).

    A's frame, A to B. No axis (0, 0) for outlines that are not convex, and where none that is tried parts them.
    """
    pair.gap = 0.0
    pair.axis_x = 0.0
    pair.axis_y = 0.0
    ha = pool.heads[ia]
    hb = pool.heads[ib]
    if not (ha.convex and hb.convex):
        return
    dx = rel.tx
    dy = rel.ty
    if line_a:
        x, y = _nearest(pool, ia, dx, dy)
        dx -= x
        dy -= y
    elif line_b:  # A's middle, as B sees it
        x, y = _nearest(pool, ib, -(rel.c * dx + rel.s * dy), rel.s * dx - rel.c * dy)
        dx += rel.c * x - rel.s * y
        dy += rel.s * x + rel.c * y
    length = math.sqrt(dx * dx + dy * dy)
    if length > 0.0:
        _try(pool, ia, ib, rel, dx / length, dy / length, pair, line_a, line_b)
    if ha.count * hb.count > MOST_TRIED:
        return
    for own in range(2):
        head = hb if own else ha
        line = line_b if own else line_a
        if (ha if own else hb).disc and not (
            head.disc or line
        ):  # it may be a corner that is nearest to a disc
            _try_corners(pool, ia, ib, rel, own == 1, pair)
        for e in range(head.point, head.point + (1 if line else head.count)):
            if pool.arcs[e, 2] == 0.0:
                k = pool.following[e]
                mx = pool.points[k, 1] - pool.points[e, 1]
                my = pool.points[e, 0] - pool.points[k, 0]
                length = math.sqrt(mx * mx + my * my)
                mx /= length
                my /= length
                if own:  # B's outward normal points from B to A
                    mx, my = -(rel.c * mx - rel.s * my), -(rel.s * mx + rel.c * my)
                _try(pool, ia, ib, rel, mx, my, pair, line_a, line_b)
                if line:
                    _try(pool, ia, ib, rel, -mx, -my, pair, line_a, line_b)


@kernel
def _try_corners(pool: Pool, ia: int, ib: int, rel: Relative, own: bool, pair: Any) -> None:
    """The ways from the corners of B (own), or of A, to the other one, a disc; from the middles of arcs."""
    head = pool.heads[ib if own else ia]
    for e in range(head.point, head.point + head.count):
        x = pool.points[e, 0]
        y = pool.points[e, 1]
        if pool.arcs[e, 2] > 0.0:
            x = pool.arcs[e, 0]
            y = pool.arcs[e, 1]
        dx = rel.tx - x
        dy = rel.ty - y
        if own:
            dx = rel.tx + rel.c * x - rel.s * y
            dy = rel.ty + rel.s * x + rel.c * y
        length = math.sqrt(dx * dx + dy * dy)
        if length > 0.0:
            _try(pool, ia, ib, rel, dx / length, dy / length, pair, False, False)


@kernel
def _try(
    pool: Pool, ia: int, ib: int, rel: Relative, mx: float, my: float, pair: Any, line_a: bool, line_b: bool
) -> None:
    gap = gap_along(pool, ia, ib, rel, mx, my, line_a, line_b)
    if gap > pair.gap:
        pair.gap = gap
        pair.axis_x = mx
        pair.axis_y = my
