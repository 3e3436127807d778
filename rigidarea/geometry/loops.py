"""The overlap of any two outlines: loops through the crossings, whole rings, holes."""

from __future__ import annotations

import numpy as np

from ..compile.jit import kernel
from .arc import across, on_arc, top
from .crossings import crossings, link
from .locate import inside_outline
from .pool import Pool
from .sequence import link_curved, link_two
from .work import A_EDGE, B_EDGE, CAUGHT, NEARBY, TANGLED, Relative, Work, measure, noise_of, placed, put


@kernel
def _measure(
    p: np.ndarray, label: np.ndarray, bows: np.ndarray, loops: np.ndarray, n: int, start: int, stop: int, arcs: bool,
    noise: float,
) -> int:  # fmt: skip
    """`measure`, called."""
    return measure(p, label, bows, loops, n, start, stop, arcs, True, noise)


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
                work.polygon[v, 0], work.polygon[v, 1] = placed(pool.points, edge, rel)
            work.label[v] = along
            v += 1
            if edge == last:
                break
    return m, v


@kernel
def _curved_arc(
    points: np.ndarray, following: np.ndarray, arcs: np.ndarray, rel: Relative, cross: np.ndarray, spot: np.ndarray,
    order: np.ndarray, polygon: np.ndarray, label: np.ndarray, bows: np.ndarray, k: int, along: int, v: int,
) -> tuple[int, int]:  # fmt: skip
    """`_arc` for outlines with arcs: edges and arcs with their middles."""
    m = order[2 + along, k]
    wraps = m < 0
    if wraps:
        m = ~m
    edge = cross[k, along]
    last = cross[m, along]
    px = spot[k, 0]
    py = spot[k, 1]
    more = edge != last or wraps
    while True:
        if more:
            qx, qy = placed(points, following[edge], rel)
        else:
            qx = spot[m, 0]
            qy = spot[m, 1]
        cx, cy = placed(arcs, edge, rel)
        v = put(polygon, label, bows, v, along, px, py, qx, qy, cx, cy, arcs[edge, 2])
        if not more:
            return m, v
        edge = following[edge]
        px = qx
        py = qy
        more = edge != last


@kernel
def _in_loop(work: Work, n: int, x: float, y: float) -> bool:
    """Whether (x, y) lies inside loop n (even-odd)."""
    inside = False
    arcs = work.loops[n].arcs > 0
    start = work.loops[n].start
    stop = work.loops[n].stop
    ux = work.polygon[stop - 1, 0]
    uy = work.polygon[stop - 1, 1]
    for i in range(start, stop):
        vx = work.polygon[i, 0]
        vy = work.polygon[i, 1]
        if (uy > y) != (vy > y) and x < ux + (y - uy) * (vx - ux) / (vy - uy):
            inside = not inside
        r = work.bows[i - 1 if i > start else stop - 1, 2] if arcs else 0.0
        if r != 0.0:
            cx = work.bows[i - 1 if i > start else stop - 1, 0]
            cy = work.bows[i - 1 if i > start else stop - 1, 1]
            if across(x, y, cx, cy, r) and on_arc(ux, uy, vx, vy, r, x, y):
                inside = not inside
        ux = vx
        uy = vy
    return inside


@kernel
def _off_corner(work: Work, n: int) -> tuple[float, float]:
    """The middle of loop n's longest edge: holes may touch a ring in a corner, where inside is undecided."""
    longest = -1.0
    x = 0.0
    y = 0.0
    arcs = work.loops[n].arcs > 0
    stop = work.loops[n].stop
    k = stop - 1
    for i in range(work.loops[n].start, stop):
        ux = work.polygon[k, 0]
        uy = work.polygon[k, 1]
        vx = work.polygon[i, 0]
        vy = work.polygon[i, 1]
        length = abs(vx - ux) + abs(vy - uy)
        if length > longest:
            longest = length
            if arcs and work.bows[k, 2] != 0.0:  # a chord's middle may be beyond what the hole is in
                x, y = top(ux, uy, vx, vy, work.bows[k, 0], work.bows[k, 1], work.bows[k, 2])
            else:
                x = 0.5 * (ux + vx)
                y = 0.5 * (uy + vy)
        k = i
    return x, y


@kernel
def _gather(work: Work, n: int, most: float) -> int:
    """Give each hole loop to its region, put the regions first; their number. CAUGHT if holes of more than `most`
    (length^2) lie in none."""
    loops = work.loops
    holes = 0
    for i in range(n):
        if loops[i].area < 0.0:
            holes += 1
    if holes == 0:
        return n
    lost = 0.0
    for i in range(n):
        hole = loops[i]
        if hole.area > 0.0:
            continue
        x, y = _off_corner(work, i)
        best = -1
        for j in range(n):
            if loops[j].area > -hole.area and (holes == n - 1 or _in_loop(work, j, x, y)):
                if best < 0 or loops[j].area < loops[best].area:
                    best = j
        hole.region = best
        if best < 0:
            lost -= hole.area
    if lost > most:
        return CAUGHT
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
                exchange(loops, i, m)
            loops[m].region = m
            m += 1
    return m


@kernel
def exchange(loops: np.ndarray, i: int, j: int) -> None:
    """Exchange two loops."""
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
    a.straight, b.straight = b.straight, a.straight
    a.region, b.region = b.region, a.region
    a.arcs, b.arcs = b.arcs, a.arcs


@kernel
def _whole_rings(
    pool: Pool, i: int, place: Relative, other: Pool, o: int, rel: Relative, along: int, work: Work, n: int, v: int,
    noise: float,
) -> tuple[int, int]:  # fmt: skip
    """Loops of the rings of outline i, placed, without a crossing that lie inside the other outline."""
    h = pool.heads[i]
    g = other.heads[o]
    arcs = h.arcs > 0 or g.arcs > 0
    first = 0 if along == A_EDGE else work.hit.size // 2
    for r in range(h.rings):
        if work.hit[first + r]:
            continue
        begin = pool.rings[h.ring + r, 0]
        end = pool.rings[h.ring + r, 1]
        x, y = placed(pool.points, begin, place)
        near = np.hypot(x - rel.tx, y - rel.ty) if along == A_EDGE else np.hypot(x, y)
        if near > g.radius * (1.0 + 1e-12):
            continue
        if not inside_outline(other, o, rel, x, y, along == B_EDGE, work):
            continue
        start = v
        for k in range(begin, end):
            px, py = placed(pool.points, k, place)
            if arcs:
                qx, qy = placed(pool.points, pool.following[k], place)
                cx, cy = placed(pool.arcs, k, place)
                v = put(
                    work.polygon, work.label, work.bows, v, along, px, py, qx, qy, cx, cy, pool.arcs[k, 2]
                )
            else:
                work.polygon[v, 0] = px
                work.polygon[v, 1] = py
                work.label[v] = along
                v += 1
        n = _measure(work.polygon, work.label, work.bows, work.loops, n, start, v, arcs, noise)
    return n, v


@kernel
def general(pa: Pool, ia: int, pb: Pool, ib: int, rel: Relative, work: Work) -> int:
    """Any two outlines: crossings, loops, whole rings, holes."""
    ha = pa.heads[ia]
    hb = pb.heads[ib]
    arcs = ha.arcs > 0 or hb.arcs > 0
    noise = noise_of(ha.radius, hb.radius, rel)
    own = Relative(1.0, 0.0, 0.0, 0.0)
    half = work.hit.size // 2
    work.hit[: ha.rings] = 0
    work.hit[half : half + hb.rings] = 0
    k = crossings(pa, ia, pb, ib, rel, work)
    if k < 0:
        return k
    n = 0
    v = 0
    if k > 0:
        if arcs:
            near = NEARBY * (ha.radius + hb.radius)
            if not (
                k == 2
                and link_two(pa.ring_of, pb.ring_of, work.cross, work.param, work.spot, work.order, near)
            ) and not (
                link_curved(pa, pb, ib, rel, k, A_EDGE, work, near)
                and link_curved(pb, pa, ia, rel, k, B_EDGE, work, near)
            ):
                return TANGLED
        elif not link(
            pa.points, pa.following, pa.ring_of, pb.points, pb.following, rel, k,
            work.cross, work.param, work.spot, work.order, 0,
        ) or not link(
            pb.points, pb.following, pb.ring_of, pa.points, pa.following, rel, k,
            work.cross, work.param, work.spot, work.order, 1,
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
                if arcs:
                    i, v = _curved_arc(
                        pa.points, pa.following, pa.arcs, own, work.cross, work.spot, work.order,
                        work.polygon, work.label, work.bows, i, A_EDGE, v,
                    )  # fmt: skip
                    i, v = _curved_arc(
                        pb.points, pb.following, pb.arcs, rel, work.cross, work.spot, work.order,
                        work.polygon, work.label, work.bows, i, B_EDGE, v,
                    )  # fmt: skip
                else:
                    i, v = _arc(pa, rel, work, i, A_EDGE, v)
                    i, v = _arc(pb, rel, work, i, B_EDGE, v)
                if i == first:
                    break
            n = _measure(work.polygon, work.label, work.bows, work.loops, n, start, v, arcs, noise)
    if ha.rings > 1 or not work.hit[0]:
        n, v = _whole_rings(pa, ia, own, pb, ib, rel, 0, work, n, v, noise)
    if hb.rings > 1 or not work.hit[half]:
        n, v = _whole_rings(pb, ib, rel, pa, ia, rel, 1, work, n, v, noise)
    return (
        n if n == 0 or (n == 1 and work.loops[0].area > 0.0) else _gather(work, n, noise if arcs else np.inf)
    )
