"""Outlines of Chipmunk's own shapes, read from where it keeps them: what `Outline.from_pymunk` says, shape after shape.

They are convex by themselves (pymunk takes hulls), so that nothing need be checked but that they have an area. Equal
shapes share an outline: `Forms` knows each by the numbers that it was made of.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from ..compile.jit import kernel, njit
from ..compile.raw_memory import array_at
from ..contact.space_record import STATE, load_pool
from ..geometry.gate import LARGEST
from ..geometry.outline import SEGMENT_THICKNESS
from ..geometry.pool import Pool, _prepare

CIRCLE, SEGMENT = 0, 1
_EPS = float(np.finfo(np.float64).eps)


class Forms(NamedTuple):
    """What is known of the pool's outlines beside what kernels see of them: H outlines."""

    extent: np.ndarray  # (H, 3): smallest extent, half width and half height of the box (length)
    mirror: np.ndarray  # (H,) int32: the other side of a two-sided segment; -1: none
    users: np.ndarray  # (H,) int32: how many shapes have it
    span: np.ndarray  # (H, 2) int32: where in `raw` the numbers are that made it, and how many; 0: given
    raw: np.ndarray  # (R,)
    table: np.ndarray  # (T,) int32: hash table of outlines by their numbers; -1: empty
    fill: np.ndarray  # (5,) int64: points, rings, boxes, heads, raw numbers in use


@kernel(inline="always")
def load_forms(s: Any) -> Forms:
    """The forms of the space whose state record is s."""
    return Forms(
        array_at(s.form_extent_at, (s.form_extent_n, 3), np.float64),
        array_at(s.form_mirror_at, (s.form_mirror_n,), np.int32),
        array_at(s.form_users_at, (s.form_users_n,), np.int32),
        array_at(s.form_span_at, (s.form_span_n, 2), np.int32),
        array_at(s.form_raw_at, (s.form_raw_n,), np.float64),
        array_at(s.form_table_at, (s.form_table_n,), np.int32),
        array_at(s.form_fill_at, (s.form_fill_n,), np.int64),
    )


@njit
def _raw(s: Any, shape: int, buffer: np.ndarray) -> int:
    """How many numbers make a shape of Chipmunk's: its kind, its radius, its points, from the lowest x on, in `buffer`.

    There may be more than there is room for: then there is nothing.
    """
    kind = array_at(array_at(shape, (1,), np.uint64)[0], (1,), np.int32)[0]
    buffer[0] = kind
    if kind == CIRCLE:
        buffer[1] = array_at(shape + s.circle_radius, (1,), np.float64)[0]
        buffer[2:4] = array_at(shape + s.circle_centre, (2,), np.float64)
        return 4
    if kind == SEGMENT:
        buffer[1] = array_at(shape + s.segment_radius, (1,), np.float64)[0]
        buffer[2:6] = array_at(shape + s.segment_ends, (4,), np.float64)
        return 6
    n = int(array_at(shape + s.poly_count, (1,), np.int32)[0])
    if 2 + 2 * n > len(buffer):
        return 2 + 2 * n
    planes = array_at(array_at(shape + s.poly_planes, (1,), np.uint64)[0], (2 * n, 4), np.float64)
    first = 0
    for i in range(1, n):
        x, y = planes[n + i, 0], planes[n + i, 1]
        if x < planes[n + first, 0] or (x == planes[n + first, 0] and y < planes[n + first, 1]):
            first = i
    buffer[1] = array_at(shape + s.poly_radius, (1,), np.float64)[0]
    for i in range(n):
        j = n + (first + i) % n
        buffer[2 + 2 * i] = planes[j, 0]
        buffer[3 + 2 * i] = planes[j, 1]
    return 2 + 2 * n


@njit
def _home(numbers: np.ndarray, mask: int) -> int:
    """Where in the hash table a form belongs (FNV-1a over its half words, of 32 bits)."""
    h = 2166136261
    for half in numbers.view(np.uint32):
        h = ((h ^ int(half)) * 16777619) & 0xFFFFFFFF
        h ^= h >> 15
    return h & mask


@njit
def _distinct(points: np.ndarray) -> np.ndarray:
    """The points of a ring without those that are the one before, rounded differently."""
    reach = np.abs(points).max()
    kept = np.empty_like(points)
    m = 0
    n = len(points)
    for i in range(n):
        before = points[i - 1]
        if (
            abs(points[i, 0] - before[0]) > 2 * _EPS * reach
            or abs(points[i, 1] - before[1]) > 2 * _EPS * reach
        ):
            kept[m] = points[i]
            m += 1
    return kept[:m]


@njit
def _grown(points: np.ndarray, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """`arcs.grown`: (points, arcs) of a convex ring grown by a radius; the arcs' fourth column is `_prepare`'s."""
    n = len(points)
    ring = np.empty((2 * n, 2))
    arcs = np.zeros((2 * n, 4))
    m = 0
    for i in range(n):
        p = points[i - 1]
        c = points[i]
        q = points[(i + 1) % n]
        size = math.hypot(c[0] - p[0], c[1] - p[1])
        bx, by = (c[1] - p[1]) / size, (p[0] - c[0]) / size
        size = math.hypot(q[0] - c[0], q[1] - c[1])
        ax, ay = (q[1] - c[1]) / size, (c[0] - q[0]) / size
        if abs(math.atan2(bx * ay - by * ax, bx * ax + by * ay)) > 1e-6:  # else the corner is none
            ring[m, 0] = c[0] + radius * bx
            ring[m, 1] = c[1] + radius * by
            arcs[m, 0] = c[0]
            arcs[m, 1] = c[1]
            arcs[m, 2] = radius
            m += 1
        ring[m, 0] = c[0] + radius * ax
        ring[m, 1] = c[1] + radius * ay
        m += 1
    return ring[:m], arcs[:m]


@njit
def _measures(ring: np.ndarray, arcs: np.ndarray) -> tuple[float, float, float]:
    """Area and first moments of a ring, counter-clockwise: of its chords, and of what is between them and its arcs."""
    area = 0.0
    x = 0.0
    y = 0.0
    n = len(ring)
    for i in range(n):
        p = ring[i]
        q = ring[(i + 1) % n]
        cross = p[0] * q[1] - p[1] * q[0]
        area += 0.5 * cross
        x += cross * (p[0] + q[0]) / 6.0
        y += cross * (p[1] + q[1]) / 6.0
        r = arcs[i, 2]
        if r > 0.0:
            half = 0.5 * math.hypot(q[0] - p[0], q[1] - p[1])
            phi = math.asin(min(1.0, half / r))
            more = r * r * (phi - math.sin(phi) * math.cos(phi))
            out = 2.0 / 3.0 * half**3  # first moment about the arc's centre, outwards
            area += more
            if half > 0.0:
                x += more * arcs[i, 0] + out * (q[1] - p[1]) / (2.0 * half)
                y += more * arcs[i, 1] + out * (p[0] - q[0]) / (2.0 * half)
    return area, x, y


@njit
def _width(points: np.ndarray) -> float:
    """The least distance of two parallel lines with a convex ring between them: one lies along an edge (length)."""
    least = np.inf
    n = len(points)
    for i in range(n):
        p = points[i]
        q = points[(i + 1) % n]
        ex, ey = q[0] - p[0], q[1] - p[1]
        size = math.hypot(ex, ey)
        if size > 0.0:
            far = 0.0
            for k in range(n):
                far = max(far, abs(ex * (points[k, 1] - p[1]) - ey * (points[k, 0] - p[0])))
            least = min(least, far / size)
    return least


@njit
def _room(pool: Pool, forms: Forms, size: int) -> bool:
    """Whether there is room for what so many numbers make: two outlines at the most."""
    fill = forms.fill
    return (
        fill[0] + 4 * size <= len(pool.points)
        and fill[1] + 2 <= len(pool.rings)
        and fill[2] + 8 * size <= len(pool.boxes)
        and fill[3] + 2 <= len(pool.heads)
        and fill[4] + size <= len(forms.raw)
    )


@njit
def _enter(
    pool: Pool,
    forms: Forms,
    ring: np.ndarray,
    arcs: np.ndarray,
    middle: tuple[float, float],
    half: tuple[float, float],
    extent: float,
) -> int:
    """A ring as an outline of the pool, about the middle of its box: its number; -1: it has no area."""
    n = len(ring)
    ring = ring - np.array(middle)
    for i in range(n):
        if arcs[i, 2] != 0.0:
            arcs[i, 0] -= middle[0]
            arcs[i, 1] -= middle[1]
    area, x, y = _measures(ring, arcs)
    size = np.abs(ring).max()
    reach = size + max(abs(middle[0]), abs(middle[1]))
    if not area > 8 * _EPS * reach * size or reach > LARGEST:
        return -1
    following, ring_of, boxes, numbers = _prepare(ring, arcs, np.array([0, n]), x / area, y / area)
    p, r, b, h = forms.fill[0], forms.fill[1], forms.fill[2], forms.fill[3]
    pool.points[p : p + n] = ring
    pool.arcs[p : p + n] = arcs
    pool.following[p : p + n] = following + p
    pool.ring_of[p : p + n] = ring_of + r
    pool.rings[r, 0] = p
    pool.rings[r, 1] = p + n
    pool.boxes[b : b + len(boxes)] = boxes
    head = pool.heads[h]
    head.point = p
    head.count = n
    head.ring = r
    head.rings = 1
    head.box = b
    head.x = middle[0]
    head.y = middle[1]
    head.area = area
    head.leaves, head.convex, head.arcs, head.disc, head.radius, head.face, head.mouth = numbers
    forms.fill[0] += n
    forms.fill[1] += 1
    forms.fill[2] += len(boxes)
    forms.fill[3] += 1
    forms.extent[h, 0] = extent
    forms.extent[h, 1] = half[0]
    forms.extent[h, 2] = half[1]
    forms.mirror[h] = -1
    forms.users[h] = 0
    forms.span[h, 1] = 0
    return h


@njit
def _make(pool: Pool, forms: Forms, raw: np.ndarray) -> int:
    """The outline of a form, new in the pool, where there is room: its number; -1: it has no area."""
    kind = raw[0]
    radius = raw[1]
    points = raw[2:].copy().reshape(-1, 2)
    if not (np.isfinite(raw).all() and radius >= 0.0):
        return -1
    if kind == SEGMENT and points[0, 0] == points[1, 0] and points[0, 1] == points[1, 1]:
        points = points[:1]
    n = len(points)
    if n == 1:
        x, y = points[0, 0], points[0, 1]
        if not radius > 0.0:
            return -1
        ring = np.array([[x + radius, y], [x - radius, y]])
        arcs = np.zeros((2, 4))
        arcs[:, 0] = x
        arcs[:, 1] = y
        arcs[:, 2] = radius
        return _enter(pool, forms, ring, arcs, (x, y), (radius, radius), 2.0 * radius)
    if kind == SEGMENT and radius == 0.0:
        return _two_sides(pool, forms, points)
    low_x, low_y = points[:, 0].min(), points[:, 1].min()
    high_x, high_y = points[:, 0].max(), points[:, 1].max()
    middle = 0.5 * (low_x + high_x), 0.5 * (low_y + high_y)
    half = 0.5 * (high_x - low_x) + radius, 0.5 * (high_y - low_y) + radius
    if radius > 0.0:
        ring, arcs = _grown(points, radius)
        return _enter(
            pool, forms, ring, arcs, middle, half, (_width(points) if n > 2 else 0.0) + 2.0 * radius
        )
    ring = _distinct(points)
    if len(ring) < 3:
        return -1
    return _enter(pool, forms, ring, np.zeros((len(ring), 4)), middle, half, _width(ring))


@njit
def _two_sides(pool: Pool, forms: Forms, points: np.ndarray) -> int:
    """A segment without thickness: the solids on its right and on its left, edge 0 of each the segment itself."""
    ax, ay = points[0, 0], points[0, 1]
    bx, by = points[1, 0], points[1, 1]
    length = math.hypot(bx - ax, by - ay)
    depth = SEGMENT_THICKNESS * length
    if not (0.0 < length < np.inf):
        return -1
    lx, ly = -(by - ay) * (depth / length), (bx - ax) * (depth / length)
    right = np.array([[bx, by], [ax, ay], [ax - lx, ay - ly], [bx - lx, by - ly]])
    left = np.array([[ax, ay], [bx, by], [bx + lx, by + ly], [ax + lx, ay + ly]])
    first = -1
    for side in range(2):
        ring = left if side else right
        low_x, low_y = ring[:, 0].min(), ring[:, 1].min()
        high_x, high_y = ring[:, 0].max(), ring[:, 1].max()
        middle = 0.5 * (low_x + high_x), 0.5 * (low_y + high_y)
        half = 0.5 * (high_x - low_x), 0.5 * (high_y - low_y)
        h = _enter(pool, forms, ring, np.zeros((4, 4)), middle, half, min(length, depth))
        if h < 0:
            return h
        if side == 0:
            first = h
    forms.mirror[first] = first + 1
    return first


@njit
def enter_form(forms: Forms, h: int) -> None:
    """Have an outline found by the numbers that it was made of."""
    mask = len(forms.table) - 1
    start = forms.span[h, 0]
    i = _home(forms.raw[start : start + forms.span[h, 1]], mask)
    while forms.table[i] >= 0:
        i = (i + 1) & mask
    forms.table[i] = h


@njit
def read_shapes(state: int, addresses: int, heads: int, start: int, n: int) -> tuple[int, int]:
    """Outlines of n of Chipmunk's shapes, from number `start` on: their numbers in the pool.

    addresses: n words; heads: n int32, those that are not negative are known already.
    Returns (how far, why): n and 0; the first that has no area, and -1; the first for which there is no room, and how
    many numbers make it.
    """
    s = array_at(state, (1,), STATE)[0]
    pool = load_pool(s)
    forms = load_forms(s)
    head_of = array_at(heads, (n,), np.int32)
    buffer = np.empty(64)
    mask = len(forms.table) - 1
    for k in range(start, n):
        if head_of[k] >= 0:
            continue
        address = int(array_at(addresses + 8 * k, (1,), np.uint64)[0])
        size = _raw(s, address, buffer)
        if size > len(buffer):
            buffer = np.empty(2 * size)
            _raw(s, address, buffer)
        raw = buffer[:size]
        i = _home(raw, mask)
        h = -1
        while forms.table[i] >= 0 and h < 0:
            h = int(forms.table[i])
            at, count = forms.span[h, 0], forms.span[h, 1]
            same = count == size
            for j in range(size if same else 0):
                same = same and forms.raw[at + j] == raw[j]
            if not same:
                h = -1
                i = (i + 1) & mask
        if h < 0:
            if not _room(pool, forms, size):
                return k, size
            h = _make(pool, forms, raw)
            if h < 0:
                return k, -1
            forms.raw[forms.fill[4] : forms.fill[4] + size] = raw
            forms.span[h, 0] = forms.fill[4]
            forms.span[h, 1] = size
            forms.fill[4] += size
            forms.table[i] = h
        head_of[k] = h
    return n, 0
