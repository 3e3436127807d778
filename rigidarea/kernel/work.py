"""What the overlap kernels share: where B lies relative to A, their scratch, and the measures of a loop."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from .jit import kernel
from .memory import record

#: Regions thinner than this, relative to their own perimeter, are rounding (area / perimeter^2).
NO_AREA = 1e-16
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
        (
            "straight",
            "f8",
        ),  # longest straight stretch of both boundaries: the shorter of A's and B's longest edges (length)
        ("region", "i4"),  # of a hole: the loop it is a hole of; of a region: itself
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
        c,
        s,
        (ac * dx + as_ * dy - amx) + (c * bmx - s * bmy),
        (ac * dy - as_ * dx - amy) + (s * bmx + c * bmy),
    )


@kernel(inline="always")
def placed(q: np.ndarray, i: int, rel: Relative) -> tuple[float, float]:
    """Point i of B in A's frame: always the same bits for the same point."""
    x = q[i, 0]
    y = q[i, 1]
    return rel.c * x - rel.s * y + rel.tx, rel.s * x + rel.c * y + rel.ty


@kernel
def measure(p: np.ndarray, label: np.ndarray, loops: np.ndarray, n: int, start: int, stop: int) -> int:
    """Area, centroid and chord of the polygon p[start:stop] as loop n; the number of loops there are then."""
    ox = p[start, 0]
    oy = p[start, 1]
    doubled = 0.0
    sx = 0.0
    sy = 0.0
    chord_x = 0.0
    chord_y = 0.0
    lever = 0.0
    flat_a = 0.0
    flat_b = 0.0
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
        dx = vx - ux
        dy = vy - uy
        perimeter += abs(dx) + abs(dy)
        if on_a:
            chord_x += dx
            chord_y += dy
            lever += 0.5 * (vx * vx + vy * vy - ux * ux - uy * uy)
            flat_a = max(flat_a, dx * dx + dy * dy)
        else:
            flat_b = max(flat_b, dx * dx + dy * dy)
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
    loop.straight = math.sqrt(min(flat_a, flat_b))
    loop.region = n
    return n + 1
