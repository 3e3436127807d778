"""Two outlines where their bodies are: their overlap, and the shortest way apart."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from ..compile.jit import entry, kernel
from .apart import gap_along
from .arc import ROUND
from .direction import chord_direction
from .loops import exchange
from .overlap import A_EDGE, OVERFLOW, Relative, Work, overlap_kernel, relative
from .pool import Pool
from .work import noise_of

#: A tangle is asked again with B shifted: at first by so many times the rounding of coordinates,
SHIFT = 16.0
#: each time by so much more, so often at the most (1e-14 to 1e-3 of the size),
GROWTH, SHIFTS = 1.5, 64
#: and another way: 22.5 degrees at first, no multiple of the 15, 30, 45 that are drawn; then the golden angle on.
FIRST_WAY, NEXT_WAY = math.pi / 8.0, math.pi * (3.0 - math.sqrt(5.0))

#: Up to such an angle the series of sine and cosine that `turn` takes are exact to rounding: what they leave out is
#: angle^8 / 40320 (radians).
SERIES = 0.03


class Pose(NamedTuple):
    """Where a body's origin is, and cosine and sine of its angle."""

    x: float
    y: float
    c: float
    s: float


@kernel(forceinline=True)
def place(body: Any) -> None:
    """What follows from a body's centre and angle."""
    body.c = math.cos(body.angle)
    body.s = math.sin(body.angle)
    shift(body)


@kernel(forceinline=True)
def turn(body: Any, angle: float) -> None:
    """Turn a body about its centre, which may have moved: as `place` has it but for rounding, and cheaper."""
    body.angle += angle
    if abs(angle) > SERIES:
        place(body)
        return
    square = angle * angle
    c = 1.0 - square * (1.0 - square * (1.0 - square / 30.0) / 12.0) / 2.0
    s = angle * (1.0 - square * (1.0 - square * (1.0 - square / 42.0) / 20.0) / 6.0)
    body.c, body.s = c * body.c - s * body.s, s * body.c + c * body.s
    shift(body)


@kernel(forceinline=True)
def shift(body: Any) -> None:
    """The same where only its centre has moved."""
    body.ox = body.x - (body.c * body.cog_x - body.s * body.cog_y)
    body.oy = body.y - (body.s * body.cog_x + body.c * body.cog_y)


@kernel
def seen_from(head: Any, pose: Pose, other: Any, other_pose: Pose) -> Relative:
    """An outline (its head, its body's pose) as the first one sees it."""
    return relative(
        pose.x, pose.y, pose.c, pose.s, other_pose.x, other_pose.y, other_pose.c, other_pose.s,
        head.x, head.y, other.x, other.y,
    )  # fmt: skip


@kernel
def _without_thin(work: Work, n: int, width: float) -> int:
    """Leave out regions of no more area than a shift by `width` (length) makes along their boundary, or what their
    arcs may be off their circles (ROUND); the others' number."""
    m = 0
    for k in range(n):
        loop = work.loops[k]
        around = 0.0
        radius_a = 0.0
        radius_b = 0.0
        ux = work.polygon[loop.stop - 1, 0]
        uy = work.polygon[loop.stop - 1, 1]
        for i in range(loop.start, loop.stop):
            vx = work.polygon[i, 0]
            vy = work.polygon[i, 1]
            around += abs(vx - ux) + abs(vy - uy)
            ux = vx
            uy = vy
            if loop.arcs > 0 and work.label[i] == A_EDGE:
                radius_a = max(radius_a, abs(work.bows[i, 2]))
            elif loop.arcs > 0:
                radius_b = max(radius_b, abs(work.bows[i, 2]))
        if loop.area > 0.5 * (width + ROUND * (radius_a + radius_b)) * around:
            if m != k:
                exchange(work.loops, m, k)
            m += 1
    return m


@kernel
def _common_way(a: Any, b: Any, rel: Relative) -> float:
    """A direction in A's frame (radians) that, asked for (B, A), is the same one in the world, and turned round: B
    shifted by it is A shifted by that."""
    half = 0.5 * math.atan2(rel.s, rel.c)
    along = math.cos(half) * rel.tx + math.sin(half) * rel.ty
    if a.radius != b.radius:
        along = a.radius - b.radius
    elif a.area != b.area:
        along = a.area - b.area
    return half if along >= 0.0 else half + math.pi


@kernel
def _shifted(pool: Pool, ia: int, ib: int, rel: Relative, work: Work) -> int:
    """`overlap_kernel` with B a little beside `rel`: the least of a series of shifts where nothing is in doubt.

    A shift by w moves a corner off an edge of another direction by a part of w; it is undecided while that part is less
    than the rounding. (Two gears of 400 edges that are one need 300 times the rounding, flat arcs, whose circles round
    like their radii, as much more as they are flat.) The area is off by w times the overlap's extent at the most, and
    what is no thicker than w is left out: it may be the shift's own.
    """
    width = noise_of(pool.heads[ia].radius, pool.heads[ib].radius, rel)
    step = SHIFT * width
    way = FIRST_WAY + _common_way(pool.heads[ia], pool.heads[ib], rel)
    for _ in range(SHIFTS):
        beside = Relative(rel.c, rel.s, rel.tx + step * math.cos(way), rel.ty + step * math.sin(way))
        n = overlap_kernel(pool, ia, pool, ib, beside, work)
        if n >= 0:
            return _without_thin(work, n, step + width)
        if n == OVERFLOW:
            return n
        step *= GROWTH
        way += NEXT_WAY
    return 0


@entry
def overlap_of_outlines(pool: Pool, ia: int, a: Pose, ib: int, b: Pose, work: Work) -> tuple[int, Relative]:
    """(number of regions, in `work`; B relative to A) of two placed outlines; or OVERFLOW instead of a number."""
    rel = seen_from(pool.heads[ia], a, pool.heads[ib], b)
    n = overlap_kernel(pool, ia, pool, ib, rel, work)
    if n < OVERFLOW:
        n = _shifted(pool, ia, ib, rel, work)
    return n, rel


@entry
def push_out(pool: Pool, ia: int, ib: int, rel: Relative) -> tuple[float, float]:
    """Direction A to B of the shortest way apart, in A's frame, of the normals of both outer rings' straight edges and
    the lines from the arcs' centres through each other and through points.

    Exact for convex outlines (at the shortest way an edge, or an arc and a point, or two arcs face each other); for
    concave ones a sensible guess. Only for regions that are born without a direction: one outline inside the other, or
    two bars crossed.
    """
    best = np.inf
    best_x = 0.0
    best_y = 1.0
    for of_a in (True, False):
        edges = ia if of_a else ib
        ends = ib if of_a else ia
        head = pool.heads[edges]
        other = pool.heads[ends]
        # points beyond number 64 are those of a curve, whose edges have said as much
        points = other.count if other.count <= 64 else 0
        for e in range(pool.rings[head.ring, 0], pool.rings[head.ring, 1]):
            k = pool.following[e]
            r = pool.arcs[e, 2]
            for j in range(1 if r == 0.0 else points + other.count):
                if r == 0.0:
                    mx = pool.points[k, 1] - pool.points[e, 1]
                    my = pool.points[e, 0] - pool.points[k, 0]
                    if not of_a:  # B's outward normal points from B to A
                        mx, my = -(rel.c * mx - rel.s * my), -(rel.s * mx + rel.c * my)
                else:
                    f = other.point + (j if j < points else j - points)
                    if j >= points and pool.arcs[f, 2] == 0.0:
                        continue
                    far = pool.points if j < points else pool.arcs
                    own_x = pool.arcs[e, 0]
                    own_y = pool.arcs[e, 1]
                    far_x = far[f, 0]
                    far_y = far[f, 1]
                    if of_a:
                        far_x, far_y = (
                            rel.c * far_x - rel.s * far_y + rel.tx,
                            rel.s * far_x + rel.c * far_y + rel.ty,
                        )
                    else:
                        own_x, own_y = (
                            rel.c * own_x - rel.s * own_y + rel.tx,
                            rel.s * own_x + rel.c * own_y + rel.ty,
                        )
                    mx = far_x - own_x
                    my = far_y - own_y
                length = math.sqrt(mx * mx + my * my)
                if length == 0.0:
                    continue
                mx /= length
                my /= length
                for way in (1.0, -1.0):
                    if r == 0.0 and way < 0.0:
                        continue
                    depth = -gap_along(pool, ia, ib, rel, way * mx, way * my, False, False)
                    if 0.0 < depth < best:
                        best = depth
                        best_x = way * mx
                        best_y = way * my
    return best_x, best_y


@entry
def overlaps_of_outlines(
    pool: Pool, a: np.ndarray, b: np.ndarray, work: Work, start: int, which: np.ndarray, out: np.ndarray
) -> tuple[int, int]:
    """Regions of the pool's first two outlines at many places, from row `start` on.

    a, b: (n, 4) x, y, cosine, sine of each. Writes, a region, the row in `which` and in `out` (m, 6) area, centroid,
    direction, chord. Returns the row at which room (in `work`, `which`, `out`) has run out, n if it has not, and how
    many regions are written.
    """
    m = 0
    for i in range(start, len(a)):
        pose = Pose(a[i, 0], a[i, 1], a[i, 2], a[i, 3])
        n, rel = overlap_of_outlines(pool, 0, pose, 1, Pose(b[i, 0], b[i, 1], b[i, 2], b[i, 3]), work)
        if n < 0 or m + n > len(out):
            return i, m
        for k in range(n):
            loop = work.loops[k]
            chord = math.sqrt(loop.chord_x * loop.chord_x + loop.chord_y * loop.chord_y)
            nx, ny = chord_direction(loop.chord_x, loop.chord_y, loop.area)
            if nx == 0.0 and ny == 0.0:
                chord = 0.0
                nx, ny = push_out(pool, 0, 1, rel)
            x = loop.x + pool.heads[0].x
            y = loop.y + pool.heads[0].y
            which[m] = i
            out[m, 0] = loop.area
            out[m, 1] = pose.x + pose.c * x - pose.s * y
            out[m, 2] = pose.y + pose.s * x + pose.c * y
            out[m, 3] = pose.c * nx - pose.s * ny
            out[m, 4] = pose.s * nx + pose.c * ny
            out[m, 5] = chord
            m += 1
    return len(a), m
