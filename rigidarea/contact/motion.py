"""Where bodies were and will be, and whether two outlines overlap somewhere on the way."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..compile.jit import kernel
from ..geometry.apart import find_axis, gap_along
from ..geometry.place import Pose, overlap_of_outlines, seen_from
from ..geometry.pool import Pool
from ..geometry.work import Work
from .broad import swing
from .constants import LOOK, MOST_LOOKS
from .patch import deepest_of
from .sides import shown_sides
from .tables import BODIES, DRIFTS, LOOKS_LEFT, SUBSTEP, Law, Tables

#: Looks (one overlap each) of a frame: so many, and so many a body; after that FEWEST_LOOKS each time. A frame then
#: ends in known time, but what moves by many times its size may pass another that moves unseen. What wants MOST_LOOKS
#: is looked for ten times.
LOOKS, LOOKS_A_BODY, FEWEST_LOOKS = 100_000, 1000, 2


@kernel(forceinline=True)
def pose_of(body: Any) -> Pose:
    """Where a body's outlines are."""
    return Pose(body.ox, body.oy, body.c, body.s)


@kernel
def earlier(body: Any, time: float) -> Pose:
    """Where they were `time` ago, at the velocity at which it has come; negative: will be, at its present velocity.

    What the user has put there, or sent off from there, has been there before.
    """
    if body.kind != DRIFTS:
        return pose_of(body)
    time = min(time, body.since)
    came = 1.0 if time > 0.0 else 0.0
    angle = time * (body.w - came * body.kick_w)
    cd = math.cos(angle)
    sd = math.sin(angle)
    c = body.c * cd + body.s * sd
    s = body.s * cd - body.c * sd
    x = body.x - time * (body.vx - came * body.kick_x)
    y = body.y - time * (body.vy - came * body.kick_y)
    return Pose(x - (c * body.cog_x - s * body.cog_y), y - (s * body.cog_x + c * body.cog_y), c, s)


@kernel(forceinline=True)
def centre_of(body: Any, pose: Pose) -> tuple[float, float]:
    """A body's centre of gravity, its outlines at `pose`."""
    return (
        pose.x + pose.c * body.cog_x - pose.s * body.cog_y,
        pose.y + pose.s * body.cog_x + pose.c * body.cog_y,
    )


@kernel(forceinline=True)
def kick_of(law: Law, extent: float, h: float) -> float:
    """What gravity gives in h; without weight, what takes a body of that extent as deep as it may lie (length/time)."""
    return float(law.gravity * h if law.gravity > 0.0 else law.penetration * extent / h)


@kernel(forceinline=True)
def _motion(tables: Tables, pair: Any, a: Any, b: Any) -> tuple[float, float, float]:
    """How fast A's centre moves relative to B's, the kick taken off, and the outlines' ends turn (length/time)."""
    sa = tables.shapes[pair.a]
    sb = tables.shapes[pair.b]
    dx = (a.vx - a.kick_x) - (b.vx - b.kick_x)
    dy = (a.vy - a.kick_y) - (b.vy - b.kick_y)
    turn = abs(a.w) * (sa.half_x + sa.half_y) + abs(b.w) * (sb.half_x + sb.half_y)
    return dx, dy, turn + swing(sa, a) + swing(sb, b)


@kernel(forceinline=True)
def _most_unseen(tables: Tables, pair: Any) -> float:
    """So far a pair may move between two looks (length)."""
    return LOOK * min(tables.shapes[pair.a].extent, tables.shapes[pair.b].extent)


@kernel
def little(tables: Tables, pair: Any, a: Any, b: Any, h: float) -> float:
    """How much farther the two may move or turn in h, and cannot have `jumped` (length)."""
    dx, dy, turn = _motion(tables, pair, a, b)
    return float(_most_unseen(tables, pair) - h * (abs(dx) + abs(dy) + turn))


@kernel
def seen_whole(tables: Tables, pair: Any) -> bool:
    """Whether a pair has moved so little in a frame that it cannot have `jumped`."""
    sa = tables.shapes[pair.a]
    sb = tables.shapes[pair.b]
    a = tables.bodies[sa.body]
    b = tables.bodies[sb.body]
    dx = 0.0
    dy = 0.0
    turn = 0.0
    if a.kind == DRIFTS:
        dx = a.x - a.old_x
        dy = a.y - a.old_y
        turn = abs(a.angle - a.old_a) * (sa.half_x + sa.half_y)
    if b.kind == DRIFTS:
        dx -= b.x - b.old_x
        dy -= b.y - b.old_y
        turn += abs(b.angle - b.old_a) * (sb.half_x + sb.half_y)
    return bool(abs(dx) + abs(dy) + turn <= _most_unseen(tables, pair))


@kernel
def jumped(tables: Tables, pair: Any, a: Any, b: Any, h: float) -> int:
    """Into how many looks the last substep's motion must be cut so that the pair cannot pass unseen; 1: none."""
    dx, dy, turn = _motion(tables, pair, a, b)
    least = _most_unseen(tables, pair)
    if h * (abs(dx) + abs(dy) + turn) <= least:
        return 1
    n = h * (math.sqrt(dx * dx + dy * dy) + turn) / least
    if n <= 1.0:
        return 1
    return int(min(n, MOST_LOOKS)) + 1


@kernel(forceinline=True)
def start_looks(counters: np.ndarray) -> None:
    """A frame begins: so many looks are left to it."""
    counters[LOOKS_LEFT] = LOOKS + LOOKS_A_BODY * counters[BODIES]


@kernel(forceinline=True)
def afford(counters: np.ndarray, looks: int) -> int:
    """Of so many looks those that the frame has left, FEWEST_LOOKS at least: so it ends, however fast things are."""
    looks = min(looks, max(FEWEST_LOOKS, counters[LOOKS_LEFT]))
    counters[LOOKS_LEFT] -= looks
    return int(looks)


@kernel(forceinline=True)
def since_of(a: Any, b: Any) -> float:
    """How long one of the two has moved by itself (time)."""
    return max(a.since if a.kind == DRIFTS else 0.0, b.since if b.kind == DRIFTS else 0.0)


@kernel(forceinline=True)
def unseen_for(pair: Any, h: float) -> float:
    """For how long nobody has looked at a pair without a region: a substep, and what it waited for Chipmunk (time)."""
    return h + (pair.waited if pair.waiting == pair.stamp - 1 else 0.0)


@kernel
def overlap_before(
    pool: Pool, work: Work, ia: int, ib: int, a: Any, b: Any, h: float, looks: int
) -> tuple[int, float]:
    """(regions, how long ago) at the first of `looks` places on the way of the last h where the two overlap.

    As they are now if they did so already where the user has put them.
    """
    way = min(h, since_of(a, b))
    if way < h:
        n, _ = overlap_of_outlines(pool, ia, earlier(a, way), ib, earlier(b, way), work)
        if n != 0:
            n, _ = overlap_of_outlines(pool, ia, pose_of(a), ib, pose_of(b), work)
            return n, 0.0
    for i in range(looks):
        back = way * (looks - 1 - i) / looks
        n, _ = overlap_of_outlines(pool, ia, earlier(a, back), ib, earlier(b, back), work)
        if n != 0:
            return n, back
    return 0, 0.0


@kernel
def time_of_impact(
    pool: Pool, work: Work, ia: int, ib: int, a: Any, b: Any, h: float, looks: int, deepest: float
) -> tuple[int, float]:
    """(regions, or OVERFLOW; how far ahead) at the first of `looks` places on the way of the next h, at the present
    velocities, where the two overlap, by more than `deepest` where that is not 0; at the last place if nowhere.
    """
    n = 0
    ahead = h
    for i in range(looks):
        ahead = h * (i + 1) / looks
        n, _ = overlap_of_outlines(pool, ia, earlier(a, -ahead), ib, earlier(b, -ahead), work)
        if n < 0 or (n > 0 and (deepest == 0.0 or deepest_of(work, n) > deepest)):
            break
    return n, ahead


@kernel
def meets_within(pool: Pool, tables: Tables, work: Work, pair: Any, h: float) -> int:
    """Whether the two overlap somewhere on the way of the next h, at their present velocities: regions, 0, OVERFLOW."""
    a = tables.bodies[tables.shapes[pair.a].body]
    b = tables.bodies[tables.shapes[pair.b].body]
    ia, ib = shown_sides(pool, tables, pair, pose_of(a), pose_of(b))
    looks = afford(tables.counters, jumped(tables, pair, a, b, h))
    n, _ = time_of_impact(pool, work, ia, ib, a, b, h, looks, 0.0)
    return n


@kernel
def _farthest(pool: Pool, shape: Any, body: Any) -> float:
    """At most so far from the body's centre a point of its outline is turned about (length); a disc turns under it."""
    head = pool.heads[shape.outline]
    dx = head.x - body.cog_x
    dy = head.y - body.cog_y
    own = 0.0 if head.disc else head.radius
    return float(math.sqrt(dx * dx + dy * dy) + own)


@kernel
def find_what_parts(pool: Pool, tables: Tables, pair: Any, a: Any, b: Any) -> None:
    """The axis that parts a pair most where its bodies are, and how far (`find_axis`)."""
    sa = tables.shapes[pair.a]
    sb = tables.shapes[pair.b]
    rel = seen_from(pool.heads[sa.outline], pose_of(a), pool.heads[sb.outline], pose_of(b))
    find_axis(pool, sa.outline, sb.outline, rel, pair, sa.mirror >= 0, sb.mirror >= 0)


@kernel
def gap_along_axis(pool: Pool, tables: Tables, pair: Any, pose_a: Pose, pose_b: Pose) -> float:
    """How far apart a pair is along its axis, its bodies in these places (length)."""
    sa = tables.shapes[pair.a]
    sb = tables.shapes[pair.b]
    rel = seen_from(pool.heads[sa.outline], pose_a, pool.heads[sb.outline], pose_b)
    return float(
        gap_along(pool, sa.outline, sb.outline, rel, pair.axis_x, pair.axis_y, sa.mirror >= 0, sb.mirror >= 0)
    )


@kernel
def closing_along_axis(pool: Pool, tables: Tables, pair: Any, a: Any, b: Any, part: float) -> float:
    """How fast a pair closes at most along what parts it (length/time), less `part` of the kicks."""
    nx = a.c * pair.axis_x - a.s * pair.axis_y
    ny = a.s * pair.axis_x + a.c * pair.axis_y
    closing = (a.vx - b.vx - part * (a.kick_x - b.kick_x)) * nx
    closing += (a.vy - b.vy - part * (a.kick_y - b.kick_y)) * ny
    closing += abs(a.w) * _farthest(pool, tables.shapes[pair.a], a)
    return closing + abs(b.w) * _farthest(pool, tables.shapes[pair.b], b)


@kernel
def soonest_touch(pool: Pool, tables: Tables, pair: Any, a: Any, b: Any) -> float:
    """In what time a pair touches at the soonest, as far as is known of what parts it (time)."""
    if pair.parted != tables.counters[SUBSTEP] or pair.gap <= 0.0:
        return 0.0
    closing = closing_along_axis(pool, tables, pair, a, b, 0.0)
    return float(pair.gap / closing) if closing > 0.0 else 0.0
