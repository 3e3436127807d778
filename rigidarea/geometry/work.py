"""What the overlap kernels share: where B lies relative to A, their scratch, and the measures of a loop."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..compile.jit import kernel
from ..compile.raw_memory import record
from .arc import FLAT, distance2, flat_segment, top

#: Regions thinner than this, relative to their own perimeter, are rounding (area / perimeter^2).
NO_AREA = 1e-16
#: Instead of a number of crossings or regions. The scratch is too small: enlarge it (`enlarged`) and call again.
OVERFLOW = -1
#: Rounding cannot tell: an end lies on the other boundary, crossings do not alternate. Shift it a little and ask again.
TANGLED = -2
#: An answer that no two outlines allow was caught (`overlap.impossible`). As TANGLED; that it never happens is tested.
CAUGHT = -4
#: Of the short ways through two convex outlines: the general one is to be asked.
OTHERWISE = -3
#: Two crossings nearer than this, over the radii: which comes first is not taken from where they are alone.
NEARBY = 1e-5
#: Which outline an edge of a region lies on.
A_EDGE, B_EDGE = 0, 1

LOOP = record(
    [
        ("start", "i4"),  # polygon vertices start .. stop of `Work.polygon`
        ("stop", "i4"),
        ("area", "f8"),  # (length^2), negative: a hole
        ("x", "f8"),  # centroid, A's frame (length)
        ("y", "f8"),
        ("chord_x", "f8"),  # sum of (end - start) over the arcs of A, A's frame (length)
        ("chord_y", "f8"),
        ("lever", "f8"),  # sum of (|end|^2 - |start|^2) / 2 over the arcs of A, about the centroid (length^2)
        # longest straight stretch of both boundaries: the shorter of A's and B's longest, points on it not counted;
        # 0 where one of the two is nothing but arcs (length)
        ("straight", "f8"),
        ("region", "i4"),  # of a hole: the loop it is a hole of; of a region: itself
        ("arcs", "i4"),  # 1: its edges may be arcs, `Work.bows` says which; 0: all are straight
    ],
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
    # (V, 3) float64: centre and signed radius of the arc to the next vertex, radius 0: a straight edge (A's frame). The
    # polygon has the ends and the middle of every arc. Not written where loops have no arcs.
    bows: np.ndarray
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
        np.empty((2 * points + 4 * crossings, 2)),
        np.empty(2 * points + 4 * crossings, np.uint8),
        np.empty((2 * points + 4 * crossings, 3)),
        np.empty(crossings + rings, LOOP),
    )


def fits(work: Work, points: int, rings: int) -> bool:
    """Whether `work` can hold any query on outlines of `points` points and `rings` rings together."""
    return len(work.polygon) >= 2 * points + 4 * len(work.cross) and len(work.hit) >= 2 * rings


def enlarged(work: Work, points: int, rings: int) -> Work:
    """A scratch for `points` and `rings` with twice the crossings."""
    return new_work(points, 2 * len(work.cross), rings)


@kernel(forceinline=True)
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
        c,
        s,
        (ac * dx + as_ * dy - amx) + (c * bmx - s * bmy),
        (ac * dy - as_ * dx - amy) + (s * bmx + c * bmy),
    )


@kernel(forceinline=True)
def placed(q: np.ndarray, i: int, rel: Relative) -> tuple[float, float]:
    """Point i of B in A's frame: always the same bits for the same point."""
    x = q[i, 0]
    y = q[i, 1]
    return rel.c * x - rel.s * y + rel.tx, rel.s * x + rel.c * y + rel.ty


@kernel(forceinline=True)
def noise_of(radius_a: float, radius_b: float, rel: Relative) -> float:
    """What a placed coordinate may be wrong by (length): eight roundings of the largest."""
    return 8.0 * 2.0**-52 * (radius_a + radius_b + abs(rel.tx) + abs(rel.ty))


@kernel(forceinline=True)
def put(
    polygon: np.ndarray, label: np.ndarray, bows: np.ndarray, v: int, own: int,
    px: float, py: float, qx: float, qy: float, cx: float, cy: float, r: float,
) -> int:  # fmt: skip
    """Append the edge p -> q (q left out) of a loop with arcs, an arc's middle too; the number of vertices then.

    (Kernels that are called often take the arrays they need, and what they call for every edge is inlined: an array
    costs nine words a call, a whole `Work` a hundred.)
    """
    if px != qx or py != qy:
        polygon[v, 0] = px
        polygon[v, 1] = py
        label[v] = own
        bows[v, 2] = r
        if r != 0.0:
            bows[v, 0] = cx
            bows[v, 1] = cy
            v += 1
            polygon[v, 0], polygon[v, 1] = top(px, py, qx, qy, cx, cy, r)
            label[v] = own
            bows[v, 0] = cx
            bows[v, 1] = cy
            bows[v, 2] = r
        v += 1
    return v


@kernel(forceinline=True)
def measure(
    p: np.ndarray, label: np.ndarray, bows: np.ndarray, loops: np.ndarray, n: int, start: int, stop: int, arcs: bool,
    flat: bool, noise: float,
) -> int:  # fmt: skip
    """Area, centroid, chord and straight stretch of the polygon start:stop as loop n; the number of loops then.

    arcs: whether its edges may be arcs, by `bows`: two vertices each, start and middle. flat: whether both outlines
    have straight edges; else there is no straight stretch to look for. noise: see `noise_of`; edges that turn by no
    more at a vertex are one straight stretch, and a region with arcs that is no wider is none.
    """
    if stop - start < 2:
        return n
    ox = p[start, 0]
    oy = p[start, 1]
    doubled = 0.0
    sx = 0.0
    sy = 0.0
    chord_x = 0.0
    chord_y = 0.0
    lever = 0.0
    flat_a = 0.0  # squared lengths of the longest stretches
    flat_b = 0.0
    perimeter = 0.0
    ux = 0.0  # the edge being walked: from u to v
    uy = 0.0
    # the stretch that is being walked: where it began, its last edge, whether the loop's start lies in it
    run_x = 0.0
    run_y = 0.0
    run_dx = 0.0
    run_dy = 0.0
    run_of = 2  # nobody's
    leading = True
    none_yet = True  # no edge so far but such as are rounding
    first_x = 0.0
    first_y = 0.0
    first_dx = 0.0
    first_dy = 0.0
    first_of = 2
    i = start
    while i < stop:
        r = bows[i, 2] if arcs else 0.0
        j = i + 1 if r == 0.0 else i + 2
        vx = 0.0
        vy = 0.0
        if j < stop:
            vx = p[j, 0] - ox
            vy = p[j, 1] - oy
        own = label[i]
        cross = ux * vy - uy * vx
        doubled += cross
        sx += (ux + vx) * cross
        sy += (uy + vy) * cross
        dx = vx - ux
        dy = vy - uy
        steps = abs(dx) + abs(dy)
        perimeter += steps
        if own == A_EDGE:
            chord_x += dx
            chord_y += dy
            lever += 0.5 * (vx * vx + vy * vy - ux * ux - uy * uy)
        if r != 0.0:
            run_of = 2
            leading = False
            none_yet = False
            chord2 = dx * dx + dy * dy
            if chord2 > 0.0:
                radius = abs(r)
                x = min(1.0, 0.5 * math.sqrt(chord2) / radius)
                x2 = x * x
                if x2 < FLAT:
                    area, moment = flat_segment(x, x2)
                else:
                    if x2 < 0.5:
                        c = math.sqrt((1.0 - x) * (1.0 + x))
                        area = math.asin(x) - x * c
                    else:  # the sine says little of a wide arc's angle: its middle does
                        tx = p[i + 1, 0] - ox - 0.5 * (ux + vx)
                        ty = p[i + 1, 1] - oy - 0.5 * (uy + vy)
                        c = 1.0 - math.sqrt(tx * tx + ty * ty) / radius
                        area = 0.5 * math.pi - math.asin(c) - x * c
                    moment = (2.0 / 3.0) * x2 * x - area * c
                area *= r * radius
                moment *= 3.0 * radius * radius / x
                doubled += 2.0 * area
                sx += 3.0 * area * (ux + vx) + moment * dy
                sy += 3.0 * area * (uy + vy) - moment * dx
        elif flat and steps > noise:
            if not (
                own == run_of
                and abs(run_dx * dy - run_dy * dx) <= noise * (abs(run_dx) + abs(run_dy) + steps)
                and run_dx * dx + run_dy * dy > 0.0
            ):
                leading = none_yet
                run_x = ux
                run_y = uy
                run_of = own
            run_dx = dx
            run_dy = dy
            reach = distance2(vx, vy, run_x, run_y)
            if own == A_EDGE:
                flat_a = max(flat_a, reach)
            else:
                flat_b = max(flat_b, reach)
            if leading:
                first_x = vx
                first_y = vy
                first_of = own
                if none_yet:
                    first_dx = dx
                    first_dy = dy
            none_yet = False
        ux = vx
        uy = vy
        i = j
    if abs(doubled) <= 2.0 * NO_AREA * perimeter * perimeter or (arcs and abs(doubled) <= noise * perimeter):
        return n  # with arcs, whose crossings rounding moves: nor what a displacement by rounding makes
    if not leading and run_of == first_of and run_of != 2:  # does the last stretch go on in the first?
        room = noise * (abs(run_dx) + abs(run_dy) + abs(first_dx) + abs(first_dy))
        if abs(run_dx * first_dy - run_dy * first_dx) <= room and run_dx * first_dx + run_dy * first_dy > 0.0:
            reach = distance2(first_x, first_y, run_x, run_y)
            if run_of == A_EDGE:
                flat_a = max(flat_a, reach)
            else:
                flat_b = max(flat_b, reach)
    loop = loops[n]
    loop.start = start
    loop.stop = stop
    loop.area = 0.5 * doubled
    third = 1.0 / (3.0 * doubled)
    sx *= third
    sy *= third
    loop.x = ox + sx
    loop.y = oy + sy
    loop.chord_x = chord_x
    loop.chord_y = chord_y
    loop.lever = lever - sx * chord_x - sy * chord_y
    loop.straight = math.sqrt(min(flat_a, flat_b)) if flat else 0.0
    loop.region = n
    loop.arcs = 1 if arcs else 0
    return n + 1
