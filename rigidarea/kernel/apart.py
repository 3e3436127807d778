"""Two convex outlines that do not meet: an axis along which they are apart, kept from substep to substep.

Most pairs that are near do not touch, and stay so. As long as the axis that parted them last parts them still, no
overlap need be worked out; and how fast it closes bounds whether a step can bring one (the separating axis of
Gottschalk, Lin & Manocha, SIGGRAPH 1996, doi:10.1145/237170.237244, kept as by Baraff, Comput Graph 24 (1990)).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .arc import on_arc
from .jit import kernel
from .pool import Pool
from .work import Relative

#: Edges of A times edges of B up to which all their normals are tried; above, the line of centres alone.
MOST_TRIED = 64


@kernel
def reach(pool: Pool, i: int, mx: float, my: float) -> float:
    """How far the outer ring of outline i reaches along the unit direction m, in its own frame (length)."""
    head = pool.heads[i]
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
def gap_along(pool: Pool, ia: int, ib: int, rel: Relative, mx: float, my: float) -> float:
    """How far B is from A along m, a unit direction in A's frame; negative: so far it must go to be clear (length)."""
    back = reach(pool, ib, -(rel.c * mx + rel.s * my), rel.s * mx - rel.c * my)
    return mx * rel.tx + my * rel.ty - reach(pool, ia, mx, my) - back


@kernel
def find_axis(pool: Pool, ia: int, ib: int, rel: Relative, pair: Any) -> None:
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
    length = math.sqrt(rel.tx * rel.tx + rel.ty * rel.ty)
    if length > 0.0:
        _try(pool, ia, ib, rel, rel.tx / length, rel.ty / length, pair)
    if ha.count * hb.count > MOST_TRIED:
        return
    for own in range(2):
        head = hb if own else ha
        for e in range(head.point, head.point + head.count):
            if pool.arcs[e, 2] == 0.0:
                k = pool.following[e]
                mx = pool.points[k, 1] - pool.points[e, 1]
                my = pool.points[e, 0] - pool.points[k, 0]
                length = math.sqrt(mx * mx + my * my)
                mx /= length
                my /= length
                if own:  # B's outward normal points from B to A
                    mx, my = -(rel.c * mx - rel.s * my), -(rel.s * mx + rel.c * my)
                _try(pool, ia, ib, rel, mx, my, pair)


@kernel
def _try(pool: Pool, ia: int, ib: int, rel: Relative, mx: float, my: float, pair: Any) -> None:
    gap = gap_along(pool, ia, ib, rel, mx, my)
    if gap > pair.gap:
        pair.gap = gap
        pair.axis_x = mx
        pair.axis_y = my
