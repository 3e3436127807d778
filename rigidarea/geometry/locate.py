"""Whether a point lies inside an outline, which of its edges is nearest, and which way it is from there."""

from __future__ import annotations

import math

from ..compile.jit import kernel
from .arc import across, distance2
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


@kernel
def nearest_edge(pool: Pool, i: int, rel: Relative, x: float, y: float) -> tuple[float, float, float, float]:
    """Both ends of the straight edge of outline i, placed by `rel`, that is nearest to a point."""
    head = pool.heads[i]
    least = math.inf
    best = (0.0, 0.0, 0.0, 0.0)
    for e in range(pool.rings[head.ring, 0], pool.rings[head.ring, 1]):
        k = pool.following[e]
        px = rel.c * pool.points[e, 0] - rel.s * pool.points[e, 1] + rel.tx
        py = rel.s * pool.points[e, 0] + rel.c * pool.points[e, 1] + rel.ty
        qx = rel.c * pool.points[k, 0] - rel.s * pool.points[k, 1] + rel.tx
        qy = rel.s * pool.points[k, 0] + rel.c * pool.points[k, 1] + rel.ty
        dx = qx - px
        dy = qy - py
        square = dx * dx + dy * dy
        part = ((x - px) * dx + (y - py) * dy) / square if square > 0.0 else 0.0
        part = min(1.0, max(0.0, part))
        distance = distance2(x, y, px + part * dx, py + part * dy)
        if distance < least:
            least = distance
            best = (px, py, qx, qy)
    return best


@kernel
def way_into(pool: Pool, i: int, x: float, y: float) -> tuple[float, float, float]:
    """Which way outline i is from a point of its frame, by what of its boundary is nearest: against the normal there.

    Of a corner, towards it; from it where the point is within. Of any length. And how far the nearest corner is, of two
    straight edges (length; infinity: there is none).
    """
    head = pool.heads[i]
    least = math.inf
    corner = math.inf
    best = (0.0, 0.0)
    for e in range(head.point, head.point + head.count):
        k = pool.following[e]
        fx = x - pool.points[e, 0]
        fy = y - pool.points[e, 1]
        dx = pool.points[k, 0] - pool.points[e, 0]
        dy = pool.points[k, 1] - pool.points[e, 1]
        radius = pool.arcs[e, 2] if head.arcs > 0 else 0.0
        out_x = dy
        out_y = -dx
        if radius == 0.0:
            square = dx * dx + dy * dy
            beside = 0.0 < fx * dx + fy * dy < square
            distance = (fx * dy - fy * dx) ** 2 / square
            if head.arcs == 0 or pool.arcs[k, 2] == 0.0:
                corner = min(corner, (fx - dx) ** 2 + (fy - dy) ** 2)
        else:  # of no more than half a turn: the way from the centre leaves between its two ends
            ux = x - pool.arcs[e, 0]
            uy = y - pool.arcs[e, 1]
            turn = math.copysign(1.0, radius)
            out_x = turn * ux
            out_y = turn * uy
            first = (ux - fx) * uy - (uy - fy) * ux
            second = ux * (uy - fy + dy) - uy * (ux - fx + dx)
            beside = turn * first >= 0.0 and turn * second >= 0.0
            distance = (math.sqrt(ux * ux + uy * uy) - abs(radius)) ** 2
        if beside and distance < least:
            least = distance
            best = (-out_x, -out_y)
        distance = fx * fx + fy * fy
        if distance < least:
            least = distance
            best = (fx, fy) if fx * dy - fy * dx < 0.0 else (-fx, -fy)
    return best[0], best[1], math.sqrt(corner)
