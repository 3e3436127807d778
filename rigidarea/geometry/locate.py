"""Whether a point lies inside an outline."""

from __future__ import annotations

from ..compile.jit import kernel
from .arc import across
from .pool import LEAF, Pool
from .predicates import side
from .work import Relative, Work, placed


@kernel
def inside_outline(p: Pool, i: int, rel: Relative, x: float, y: float, point_of_b: bool, work: Work) -> bool:
    """Whether the point (x, y) of A's frame lies inside outline i: crossings of the ray to +x, by the hierarchy.

    `point_of_b`: the outline is A and the point is B's; False: the outline is B, placed by `rel`.
    """
    h = p.heads[i]
    c = 1.0 if point_of_b else rel.c
    s = 0.0 if point_of_b else rel.s
    tx = 0.0 if point_of_b else rel.tx
    ty = 0.0 if point_of_b else rel.ty
    place = Relative(c, s, tx, ty)
    pad = 8.0 * 2.0**-52 * (h.radius + abs(x) + abs(y) + abs(tx) + abs(ty))
    arcs = h.arcs > 0
    work.stack[0, 0] = 1
    depth = 1
    inside = False
    while depth > 0:
        depth -= 1
        node = work.stack[depth, 0]
        mx = p.boxes[h.box + node, 0]
        my = p.boxes[h.box + node, 1]
        hx = p.boxes[h.box + node, 2] + pad
        hy = p.boxes[h.box + node, 3] + pad
        if abs(s * mx + c * my + ty - y) > abs(s) * hx + abs(c) * hy:
            continue
        if c * mx - s * my + tx + abs(c) * hx + abs(s) * hy < x:
            continue
        if node < h.leaves:
            work.stack[depth, 0] = 2 * node
            work.stack[depth + 1, 0] = 2 * node + 1
            depth += 2
            continue
        first = (node - h.leaves) * LEAF
        for e in range(h.point + first, h.point + min(first + LEAF, h.count)):
            if point_of_b:
                ux, uy = p.points[e, 0], p.points[e, 1]
                vx, vy = p.points[p.following[e], 0], p.points[p.following[e], 1]
                up = uy > y  # the point is B's, shifted up by d^2: a vertex at its height is below it
                vp = vy > y
            else:
                ux, uy = placed(p.points, e, place)
                vx, vy = placed(p.points, p.following[e], place)
                up = uy >= y  # the edge is B's, shifted up
                vp = vy >= y
            if up != vp and (side(ux, uy, vx, vy, x, y, point_of_b) > 0.0) == vp:
                inside = not inside
            if (
                arcs and p.arcs[e, 2] != 0.0
            ):  # what lies between chord and arc is inside where the rest is not
                cx, cy = placed(p.arcs, e, place)
                r = p.arcs[e, 2]
                if across(x, y, cx, cy, r) and (side(ux, uy, vx, vy, x, y, point_of_b) < 0.0) == (r > 0.0):
                    inside = not inside
    return inside
