"""Overlap of two placed outlines: its connected regions, each with area, centroid and chord.

Two algorithms, one result. Small convex pairs (boxes, most game polygons) are clipped edge by edge (Sutherland &
Hodgman, Commun ACM 17, 1974). Everything else, with holes, concave, thousands of edges, goes the general way:

1. *Crossings.* Both hierarchies are walked together; where two leaves meet, edge pairs are tested with the exact
   predicate of `predicates.side`. A crossing is where A's boundary enters B (+1) or leaves it (-1); where A leaves
   B, B enters A, and the other way round. Cost follows the contact, not the outlines.
2. *Loops.* Follow A from where it enters B to where it leaves; change to B, which enters A there, until it leaves;
   change back. Crossings of one ring alternate, so every crossing lies on exactly one loop and every loop closes.

            B ___________           A: entering at p, leaving at q: the arc p..q of A lies inside B
             /     q__p  \\          B: entering at q, leaving at p: the arc q..p of B lies inside A
        ____/_____/    \\__\\__       p..q..p, counter-clockwise, is the region; the chord of A's arc is q - p
         A                            and of B's arc p - q: equal and opposite by construction

3. *Rings without a crossing* lie wholly inside the other outline or wholly outside: one point decides.
4. *Signs.* A loop with positive area is a region, one with negative area is a hole of the region around it.

Degenerate cases need no code: the predicate shifts B by an infinitesimal (see `predicates`), after which there are
none. What the shift leaves behind, loops of no area, is dropped.

Differences from the paper: Alg. 1 asks for a node of each body inside the other and for two crossings; here a region
is there when its area is positive, however many crossings it has, and whatever nodes (design 2.1). Area and centroid
are Eq. 4 and Eq. 7, taken relative to a point of the region.

Everything is computed in A's frame, with B placed relative to A, so that a common offset costs no digits.
Kernel arguments: a `Pool` and the number of an outline in it for A and for B, a `Relative` pose, a `Work`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from .jit import kernel
from .pool import LEAF, Pool
from .predicates import side

#: Regions thinner than this, relative to their own perimeter, are rounding (area / perimeter^2).
NO_AREA = 1e-16
#: At most this many edge pairs for the clipping of convex outlines; above, the hierarchy is faster.
CLIP_PAIRS = 64
#: The scratch is too small: enlarge it (`enlarged`) and call again.
OVERFLOW = -1
#: The crossings do not alternate: an outline crosses itself within rounding. Shift it a little and call again.
TANGLED = -2

A_EDGE, B_EDGE = 0, 1

LOOP = np.dtype(
    [
        ("start", "i4"),  # polygon vertices start .. stop of `Work.polygon`
        ("stop", "i4"),
        ("area", "f8"),  # (length^2), negative: a hole
        ("x", "f8"),  # centroid, A's frame (length)
        ("y", "f8"),
        ("chord_x", "f8"),  # sum of (end - start) over the arcs of A, A's frame (length)
        ("chord_y", "f8"),
        ("lever", "f8"),  # sum of (|end|^2 - |start|^2) / 2 over the arcs of A, about the centroid (length^2)
        ("region", "i4"),  # of a hole: the loop it is a hole of; of a region: itself
    ],
    align=True,
)


class Relative(NamedTuple):
    """B's outline frame seen from A's: p_A = (c x - s y + tx, s x + c y + ty)."""

    c: float
    s: float
    tx: float
    ty: float


class Work(NamedTuple):
    """Scratch of one query; also its result (`loops`, `polygon`, `label`)."""

    stack: np.ndarray  # (S, 2) int32
    cross: np.ndarray  # (K, 3) int32: edge of A, edge of B, +1 A enters B / -1 A leaves B
    param: np.ndarray  # (K, 2) float64: where along the edge of A, of B
    spot: np.ndarray  # (K, 2) float64: the crossing point
    order: np.ndarray  # (4, K) int32: order along A, along B; next along A, along B
    done: np.ndarray  # (K,) uint8
    hit: np.ndarray  # (R,) uint8: rings with a crossing
    polygon: np.ndarray  # (V, 2) float64: all loops, vertex by vertex, A's frame
    label: np.ndarray  # (V,) uint8: which outline the edge to the next vertex lies on (A_EDGE, B_EDGE)
    loops: np.ndarray  # (L,) LOOP


def new_work(points: int = 256, crossings: int = 32, rings: int = 16) -> Work:
    """Scratch for outlines of `points` points together, and that many crossings."""
    return Work(
        np.empty((512, 2), np.int32),
        np.empty((crossings, 3), np.int32),
        np.empty((crossings, 2)),
        np.empty((crossings, 2)),
        np.empty((4, crossings), np.int32),
        np.empty(crossings, np.uint8),
        np.empty(2 * rings, np.uint8),
        np.empty((points + 2 * crossings, 2)),
        np.empty(points + 2 * crossings, np.uint8),
        np.empty(crossings + rings, LOOP),
    )


def fits(work: Work, points: int, rings: int) -> bool:
    """Whether `work` can hold any query on outlines of `points` points and `rings` rings together."""
    return len(work.polygon) >= points + 2 * len(work.cross) and len(work.hit) >= 2 * rings


def enlarged(work: Work, points: int, rings: int) -> Work:
    """A scratch for `points` and `rings` with twice the crossings."""
    return new_work(points, 2 * len(work.cross), rings)


@kernel(inline="always")
def relative(
    ax: float, ay: float, ac: float, as_: float, bx: float, by: float, bc: float, bs: float,
    amx: float, amy: float, bmx: float, bmy: float,
) -> Relative:  # fmt: skip
    """Place B's outline (middle bm) relative to A's (middle am), bodies at (x, y) with cosine and sine of the angle."""
    c = ac * bc + as_ * bs
    s = ac * bs - as_ * bc
    dx = bx - ax
    dy = by - ay
    return Relative(
        c, s, (ac * dx + as_ * dy - amx) + (c * bmx - s * bmy), (ac * dy - as_ * dx - amy) + (s * bmx + c * bmy)
    )


@kernel
def _measure(p: np.ndarray, label: np.ndarray, loops: np.ndarray, n: int, start: int, stop: int) -> int:
    """Area, centroid and chord of the polygon p[start:stop] as loop n; the number of loops there are then."""
    ox = p[start, 0]
    oy = p[start, 1]
    doubled = 0.0
    sx = 0.0
    sy = 0.0
    chord_x = 0.0
    chord_y = 0.0
    lever = 0.0
    perimeter = 0.0
    ux = p[stop - 1, 0] - ox
    uy = p[stop - 1, 1] - oy
    on_a = label[stop - 1] == A_EDGE
    for i in range(start, stop):
        vx = p[i, 0] - ox
        vy = p[i, 1] - oy
        cross = ux * vy - uy * vx
        doubled += cross
        sx += (ux + vx) * cross
        sy += (uy + vy) * cross
        perimeter += abs(vx - ux) + abs(vy - uy)
        if on_a:
            chord_x += vx - ux
            chord_y += vy - uy
            lever += 0.5 * (vx * vx + vy * vy - ux * ux - uy * uy)
        on_a = label[i] == A_EDGE
        ux = vx
        uy = vy
    if abs(doubled) <= 2.0 * NO_AREA * perimeter * perimeter:
        return n
    loop = loops[n]
    loop.start = start
    loop.stop = stop
    loop.area = 0.5 * doubled
    sx /= 3.0 * doubled
    sy /= 3.0 * doubled
    loop.x = ox + sx
    loop.y = oy + sy
    loop.chord_x = chord_x
    loop.chord_y = chord_y
    loop.lever = lever - sx * chord_x - sy * chord_y
    loop.region = n
    return n + 1


@kernel
def _clip(
    qa: np.ndarray, a0: int, na: int, qb: np.ndarray, b0: int, nb: int, rel: Relative,
    p: np.ndarray, label: np.ndarray, loops: np.ndarray,
) -> int:  # fmt: skip
    """Two small convex outlines: B, points qb[b0:b0+nb], clipped by the edges of A. Labels go along with vertices."""
    n = nb
    src = 0
    dst = len(label) // 2
    for i in range(n):
        x = qb[b0 + i, 0]
        y = qb[b0 + i, 1]
        p[i, 0] = rel.c * x - rel.s * y + rel.tx
        p[i, 1] = rel.s * x + rel.c * y + rel.ty
        label[i] = B_EDGE
    ex = qa[a0 + na - 1, 0]
    ey = qa[a0 + na - 1, 1]
    for j in range(na):
        fx = qa[a0 + j, 0]
        fy = qa[a0 + j, 1]
        dx = fx - ex
        dy = fy - ey
        # one pass to see whether this edge cuts at all: most do not
        outside = 0
        for i in range(src, src + n):
            if dx * (p[i, 1] - ey) - dy * (p[i, 0] - ex) <= 0.0:
                outside += 1
        if outside == n:
            return 0
        if outside > 0:
            m = dst
            ux = p[src + n - 1, 0]
            uy = p[src + n - 1, 1]
            ulabel = label[src + n - 1]
            du = dx * (uy - ey) - dy * (ux - ex)
            for i in range(src, src + n):
                vx = p[i, 0]
                vy = p[i, 1]
                vlabel = label[i]
                dv = dx * (vy - ey) - dy * (vx - ex)
                if (du > 0.0) != (dv > 0.0):
                    t = du / (du - dv)
                    p[m, 0] = ux + t * (vx - ux)
                    p[m, 1] = uy + t * (vy - uy)
                    label[m] = A_EDGE if du > 0.0 else ulabel  # leaving: along A's edge until B comes back in
                    m += 1
                if dv > 0.0:
                    p[m, 0] = vx
                    p[m, 1] = vy
                    label[m] = vlabel
                    m += 1
                ux = vx
                uy = vy
                ulabel = vlabel
                du = dv
            n = m - dst
            src, dst = dst, src
        ex = fx
        ey = fy
    return _measure(p, label, loops, 0, src, src + n)


@kernel(inline="always")
def _boxes_meet(qa: np.ndarray, na: int, qb: np.ndarray, nb: int, rel: Relative, pad: float) -> bool:
    """Separating axes of two hierarchy boxes: the two of A's frame and the two of B's."""
    ac = abs(rel.c)
    as_ = abs(rel.s)
    bhx = qb[nb, 2] + pad
    bhy = qb[nb, 3] + pad
    ahx = qa[na, 2]
    ahy = qa[na, 3]
    bx = qb[nb, 0]
    by = qb[nb, 1]
    dx = rel.c * bx - rel.s * by + rel.tx - qa[na, 0]
    dy = rel.s * bx + rel.c * by + rel.ty - qa[na, 1]
    return (
        abs(dx) <= ahx + ac * bhx + as_ * bhy
        and abs(dy) <= ahy + as_ * bhx + ac * bhy
        and abs(rel.c * dx + rel.s * dy) <= bhx + ac * ahx + as_ * ahy
        and abs(rel.c * dy - rel.s * dx) <= bhy + as_ * ahx + ac * ahy
    )


@kernel(inline="always")
def _placed(q: np.ndarray, i: int, rel: Relative) -> tuple[float, float]:
    """Point i of B in A's frame: always the same bits for the same point."""
    x = q[i, 0]
    y = q[i, 1]
    return rel.c * x - rel.s * y + rel.tx, rel.s * x + rel.c * y + rel.ty


@kernel
def _cross_leaves(
    qa: np.ndarray, next_a: np.ndarray, a0: int, a1: int, qb: np.ndarray, next_b: np.ndarray, b0: int, b1: int,
    rel: Relative, cross: np.ndarray, param: np.ndarray, spot: np.ndarray, n: int,
) -> int:  # fmt: skip
    """Append the crossings of edges a0..a1 of A with edges b0..b1 of B; their number then, or OVERFLOW."""
    for j in range(b0, b1):
        cx, cy = _placed(qb, j, rel)
        dx, dy = _placed(qb, next_b[j], rel)
        low_x = min(cx, dx)
        high_x = max(cx, dx)
        low_y = min(cy, dy)
        high_y = max(cy, dy)
        for i in range(a0, a1):
            ax = qa[i, 0]
            ay = qa[i, 1]
            k = next_a[i]
            bx = qa[k, 0]
            by = qa[k, 1]
            if max(ax, bx) < low_x or min(ax, bx) > high_x or max(ay, by) < low_y or min(ay, by) > high_y:
                continue
            sc = side(ax, ay, bx, by, cx, cy, True)
            sd = side(ax, ay, bx, by, dx, dy, True)
            if (sc > 0.0) == (sd > 0.0):
                continue
            sa = side(cx, cy, dx, dy, ax, ay, False)
            sb = side(cx, cy, dx, dy, bx, by, False)
            if (sa > 0.0) == (sb > 0.0):
                continue
            if n == len(cross):
                return OVERFLOW
            cross[n, 0] = i
            cross[n, 1] = j
            cross[n, 2] = 1 if sb > 0.0 else -1
            # The point on the shorter edge (less room for rounding), the other parameter from the point: edges that
            # are parallel within rounding cross anywhere along their common stretch, but not outside of it.
            ux = bx - ax
            uy = by - ay
            vx = dx - cx
            vy = dy - cy
            uu = ux * ux + uy * uy
            vv = vx * vx + vy * vy
            if vv < uu:
                u = sc / (sc - sd)
                x = cx + u * vx
                y = cy + u * vy
                t = ((x - ax) * ux + (y - ay) * uy) / uu
            else:
                t = sa / (sa - sb)
                x = ax + t * ux
                y = ay + t * uy
                u = ((x - cx) * vx + (y - cy) * vy) / vv
            param[n, 0] = t
            param[n, 1] = u
            spot[n, 0] = x
            spot[n, 1] = y
            n += 1
    return n


@kernel
def _crossings(pa: Pool, ia: int, pb: Pool, ib: int, rel: Relative, work: Work) -> int:
    """All crossings of the two boundaries, by a walk down both hierarchies at once."""
    ha = pa.heads[ia]
    hb = pb.heads[ib]
    pad = 8.0 * 2.0**-52 * (ha.radius + hb.radius + abs(rel.tx) + abs(rel.ty))
    stack = work.stack
    stack[0, 0] = 1
    stack[0, 1] = 1
    depth = 1
    n = 0
    while depth > 0:
        depth -= 1
        na = stack[depth, 0]
        nb = stack[depth, 1]
        if not _boxes_meet(pa.boxes, ha.box + na, pb.boxes, hb.box + nb, rel, pad):
            continue
        leaf_a = na >= ha.leaves
        leaf_b = nb >= hb.leaves
        if leaf_a and leaf_b:
            a0 = (na - ha.leaves) * LEAF
            b0 = (nb - hb.leaves) * LEAF
            n = _cross_leaves(
                pa.points, pa.following, ha.point + a0, ha.point + min(a0 + LEAF, ha.count),
                pb.points, pb.following, hb.point + b0, hb.point + min(b0 + LEAF, hb.count),
                rel, work.cross, work.param, work.spot, n,
            )  # fmt: skip
            if n < 0:
                return n
            continue
        # go down in the larger box
        size_a = pa.boxes[ha.box + na, 2] + pa.boxes[ha.box + na, 3]
        size_b = pb.boxes[hb.box + nb, 2] + pb.boxes[hb.box + nb, 3]
        if leaf_b or (not leaf_a and size_a >= size_b):
            stack[depth, 0] = 2 * na
            stack[depth, 1] = nb
            stack[depth + 1, 0] = 2 * na + 1
            stack[depth + 1, 1] = nb
        else:
            stack[depth, 0] = na
            stack[depth, 1] = 2 * nb
            stack[depth + 1, 0] = na
            stack[depth + 1, 1] = 2 * nb + 1
        depth += 2
    return n


@kernel
def _before(
    q: np.ndarray, other: np.ndarray, following: np.ndarray, rel: Relative, edge: int, end: int,
    k: int, m: int, cross: np.ndarray, param: np.ndarray, along: int,
) -> bool:  # fmt: skip
    """Whether crossing k comes before crossing m on the edge `edge` -> `end` of q that both lie on.

    Rounded parameters settle it unless the two crossing edges share a corner v: that corner may poke through by any
    little, also by the infinitesimal of the tie-break alone. Then u - v - w crosses to v and back, and the turn at v
    says which leg comes first; exactly.
    """
    f = cross[k, 1 - along]
    g = cross[m, 1 - along]
    first = following[f] == g
    if not first and following[g] != f:
        return param[k, along] < param[m, along]
    u, v = (f, g) if first else (g, f)
    w = following[v]
    if along == A_EDGE:
        ux, uy = _placed(other, u, rel)
        vx, vy = _placed(other, v, rel)
        wx, wy = _placed(other, w, rel)
        left = side(q[edge, 0], q[edge, 1], q[end, 0], q[end, 1], vx, vy, True) > 0.0
    else:
        ux, uy = other[u, 0], other[u, 1]
        vx, vy = other[v, 0], other[v, 1]
        wx, wy = other[w, 0], other[w, 1]
        ax, ay = _placed(q, edge, rel)
        bx, by = _placed(q, end, rel)
        left = side(ax, ay, bx, by, vx, vy, False) > 0.0
    # v to the left of the edge: the leg to u is met first if u -> w turns counter-clockwise about v
    return ((side(vx, vy, ux, uy, wx, wy, True) > 0.0) == left) == first


@kernel
def _link(
    q: np.ndarray, following: np.ndarray, ring_of: np.ndarray, other: np.ndarray, other_following: np.ndarray,
    rel: Relative, n: int, cross: np.ndarray, param: np.ndarray, order: np.ndarray, along: int,
) -> bool:  # fmt: skip
    """order[2 + along, k]: the crossing after k along its ring of A (0) or B (1). False if they do not alternate.

    ~k where the ring's first point is passed on the way.
    """
    for i in range(n):  # insertion sort: n is small, and crossings come nearly in order
        edge = cross[i, along]
        j = i
        while j > 0:
            m = order[along, j - 1]
            e = cross[m, along]
            if e < edge or (
                e == edge
                and not _before(q, other, other_following, rel, edge, following[edge], i, m, cross, param, along)
            ):
                break
            order[along, j] = m
            j -= 1
        order[along, j] = i
    low = 0
    while low < n:
        ring = ring_of[cross[order[along, low], along]]
        high = low
        last = low
        while last + 1 < n and ring_of[cross[order[along, last + 1], along]] == ring:
            last += 1
        for high in range(low, last + 1):
            k = order[along, high]
            m = order[along, high + 1 if high < last else low]
            if cross[k, 2] == cross[m, 2]:
                return False
            order[2 + along, k] = m if high < last else ~m  # ~: past the start of the ring
        low = last + 1
    return True


@kernel
def _arc(pool: Pool, rel: Relative, work: Work, k: int, along: int, v: int) -> tuple[int, int]:
    """Append the boundary along A (0) or B (1) from crossing k to the next, left out: (that crossing, vertices)."""
    work.polygon[v, 0] = work.spot[k, 0]
    work.polygon[v, 1] = work.spot[k, 1]
    work.label[v] = along
    v += 1
    m = work.order[2 + along, k]
    wraps = m < 0
    if wraps:
        m = ~m
    edge = work.cross[k, along]
    last = work.cross[m, along]
    if edge != last or wraps:
        while True:
            edge = pool.following[edge]
            if along == A_EDGE:
                work.polygon[v, 0] = pool.points[edge, 0]
                work.polygon[v, 1] = pool.points[edge, 1]
            else:
                work.polygon[v, 0], work.polygon[v, 1] = _placed(pool.points, edge, rel)
            work.label[v] = along
            v += 1
            if edge == last:
                break
    return m, v


@kernel
def _inside(p: Pool, i: int, rel: Relative, x: float, y: float, point_of_b: bool, work: Work) -> bool:
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
                ux, uy = _placed(p.points, e, place)
                vx, vy = _placed(p.points, p.following[e], place)
                up = uy >= y  # the edge is B's, shifted up
                vp = vy >= y
            if up != vp and (side(ux, uy, vx, vy, x, y, point_of_b) > 0.0) == vp:
                inside = not inside
    return inside


@kernel
def _in_loop(work: Work, n: int, x: float, y: float) -> bool:
    """Whether (x, y) lies inside loop n (even-odd)."""
    inside = False
    start = work.loops[n].start
    stop = work.loops[n].stop
    ux = work.polygon[stop - 1, 0]
    uy = work.polygon[stop - 1, 1]
    for i in range(start, stop):
        vx = work.polygon[i, 0]
        vy = work.polygon[i, 1]
        if (uy > y) != (vy > y) and x < ux + (y - uy) * (vx - ux) / (vy - uy):
            inside = not inside
        ux = vx
        uy = vy
    return inside


@kernel
def _gather(work: Work, n: int) -> int:
    """Give each hole loop to its region, put the regions first; their number."""
    loops = work.loops
    holes = 0
    for i in range(n):
        if loops[i].area < 0.0:
            holes += 1
    if holes == 0:
        return n
    for i in range(n):
        hole = loops[i]
        if hole.area > 0.0:
            continue
        x = work.polygon[hole.start, 0]
        y = work.polygon[hole.start, 1]
        best = -1
        for j in range(n):
            if loops[j].area > -hole.area and (holes == n - 1 or _in_loop(work, j, x, y)):
                if best < 0 or loops[j].area < loops[best].area:
                    best = j
        hole.region = best
    for i in range(n):
        hole = loops[i]
        if hole.area > 0.0 or hole.region < 0:
            continue
        region = loops[hole.region]
        area = region.area + hole.area
        x = (region.x * region.area + hole.x * hole.area) / area
        y = (region.y * region.area + hole.y * hole.area) / area
        region.lever += (
            hole.lever
            + (region.x - x) * region.chord_x + (region.y - y) * region.chord_y
            + (hole.x - x) * hole.chord_x + (hole.y - y) * hole.chord_y
        )  # fmt: skip
        region.x = x
        region.y = y
        region.area = area
        region.chord_x += hole.chord_x
        region.chord_y += hole.chord_y
    # regions to the front, by exchange; the holes keep pointing at theirs
    m = 0
    for i in range(n):
        if loops[i].area > 0.0:
            if i != m:
                for j in range(n):
                    if loops[j].area < 0.0 and loops[j].region == i:
                        loops[j].region = m
                _exchange(loops, i, m)
            loops[m].region = m
            m += 1
    return m


@kernel
def _exchange(loops: np.ndarray, i: int, j: int) -> None:
    a = loops[i]
    b = loops[j]
    a.start, b.start = b.start, a.start
    a.stop, b.stop = b.stop, a.stop
    a.area, b.area = b.area, a.area
    a.x, b.x = b.x, a.x
    a.y, b.y = b.y, a.y
    a.chord_x, b.chord_x = b.chord_x, a.chord_x
    a.chord_y, b.chord_y = b.chord_y, a.chord_y
    a.lever, b.lever = b.lever, a.lever
    a.region, b.region = b.region, a.region


@kernel
def _whole_rings(
    pool: Pool, i: int, other: Pool, o: int, rel: Relative, along: int, work: Work, n: int, v: int
) -> tuple[int, int]:
    """Loops of the rings of outline i without a crossing that lie inside the other outline."""
    h = pool.heads[i]
    g = other.heads[o]
    first = 0 if along == A_EDGE else work.hit.size // 2
    for r in range(h.rings):
        if work.hit[first + r]:
            continue
        begin = pool.rings[h.ring + r, 0]
        end = pool.rings[h.ring + r, 1]
        if along == A_EDGE:
            x, y = pool.points[begin, 0], pool.points[begin, 1]
            near = np.hypot(x - rel.tx, y - rel.ty)
        else:
            x, y = _placed(pool.points, begin, rel)
            near = np.hypot(x, y)
        if near > g.radius * (1.0 + 1e-12):
            continue
        if not _inside(other, o, rel, x, y, along == B_EDGE, work):
            continue
        start = v
        for k in range(begin, end):
            if along == A_EDGE:
                work.polygon[v, 0] = pool.points[k, 0]
                work.polygon[v, 1] = pool.points[k, 1]
            else:
                work.polygon[v, 0], work.polygon[v, 1] = _placed(pool.points, k, rel)
            work.label[v] = along
            v += 1
        n = _measure(work.polygon, work.label, work.loops, n, start, v)
    return n, v


@kernel
def _general(pa: Pool, ia: int, pb: Pool, ib: int, rel: Relative, work: Work) -> int:
    """Any two outlines: crossings, loops, whole rings, holes."""
    ha = pa.heads[ia]
    hb = pb.heads[ib]
    half = work.hit.size // 2
    work.hit[: ha.rings] = 0
    work.hit[half : half + hb.rings] = 0
    k = _crossings(pa, ia, pb, ib, rel, work)
    if k < 0:
        return k
    n = 0
    v = 0
    if k > 0:
        if not _link(
            pa.points, pa.following, pa.ring_of, pb.points, pb.following, rel, k,
            work.cross, work.param, work.order, 0,
        ) or not _link(
            pb.points, pb.following, pb.ring_of, pa.points, pa.following, rel, k,
            work.cross, work.param, work.order, 1,
        ):  # fmt: skip
            return TANGLED
        for i in range(k):
            work.done[i] = 0
            work.hit[pa.ring_of[work.cross[i, 0]] - ha.ring] = 1
            work.hit[half + pb.ring_of[work.cross[i, 1]] - hb.ring] = 1
        for first in range(k):
            if work.done[first] or work.cross[first, 2] < 0:
                continue
            start = v
            i = first
            while True:
                work.done[i] = 1
                i, v = _arc(pa, rel, work, i, A_EDGE, v)
                i, v = _arc(pb, rel, work, i, B_EDGE, v)
                if i == first:
                    break
            n = _measure(work.polygon, work.label, work.loops, n, start, v)
    n, v = _whole_rings(pa, ia, pb, ib, rel, 0, work, n, v)
    n, v = _whole_rings(pb, ib, pa, ia, rel, 1, work, n, v)
    return _gather(work, n)


@kernel(inline="always")
def overlap_kernel(pa: Pool, ia: int, pb: Pool, ib: int, rel: Relative, work: Work) -> int:
    """Regions of A and B placed by `rel`: their number, work.loops[:number]; or OVERFLOW, or TANGLED.

    The work must hold the two outlines (`fits`). Holes of regions follow them in work.loops where there are any.
    """
    ha = pa.heads[ia]
    hb = pb.heads[ib]
    if ha.convex and hb.convex and ha.count * hb.count <= CLIP_PAIRS:
        return _clip(
            pa.points, ha.point, ha.count, pb.points, hb.point, hb.count, rel, work.polygon, work.label, work.loops
        )
    return _general(pa, ia, pb, ib, rel, work)
