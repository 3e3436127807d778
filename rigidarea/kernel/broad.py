"""Which pairs may touch: sort and sweep over boxes with some room, made anew only when a shape leaves its box.

Chipmunk looks for pairs once a step, and tells of those that touch then. A contact solved in several substeps needs
those that come to touch within the frame as well. Sort and sweep (Baraff 1992): shapes in the order of their boxes'
low x, which hardly changes from search to search, so that insertion sort takes it up where it was.
"""

from __future__ import annotations

import math
from typing import Any

from .constants import LOOK, MARGIN
from .jit import entry, kernel
from .pool import Pool
from .tables import (
    APART,
    BODIES,
    CONCAVE,
    DRIFTS,
    FIXED,
    FREE_PAIRS,
    MORE_PAIRS,
    NEAR,
    SEARCH,
    SHAPES,
    TOOTHED,
    TURN,
    Tables,
    end_pair,
    find_pair,
    new_pair,
    pairs_in_use,
    rehash,
)


@kernel
def box_of(pool: Pool, shape: Any, body: Any) -> tuple[float, float, float, float]:
    """(low x, low y, high x, high y) of the shape where its body is, either side of a two-sided one."""
    head = pool.heads[shape.outline]
    x = body.ox + body.c * head.x - body.s * head.y
    y = body.oy + body.s * head.x + body.c * head.y
    c = abs(body.c)
    s = abs(body.s)
    half_x = c * shape.half_x + s * shape.half_y
    half_y = s * shape.half_x + c * shape.half_y
    low_x, low_y, high_x, high_y = x - half_x, y - half_y, x + half_x, y + half_y
    if shape.mirror >= 0:
        other = pool.heads[shape.mirror]
        x = body.ox + body.c * other.x - body.s * other.y
        y = body.oy + body.s * other.x + body.c * other.y
        low_x, low_y = min(low_x, x - half_x), min(low_y, y - half_y)
        high_x, high_y = max(high_x, x + half_x), max(high_y, y + half_y)
    return low_x, low_y, high_x, high_y


@kernel(forceinline=True)
def swing(shape: Any, body: Any) -> float:
    """How fast a body's spin carries the middle of a shape's box about its centre (length/time)."""
    x = 0.5 * (shape.left + shape.right) - body.x
    y = 0.5 * (shape.bottom + shape.top) - body.y
    return float(abs(body.w) * (abs(x) + abs(y)))


@kernel
def somebody_left(pool: Pool, tables: Tables, frame: int, h: float) -> bool:
    """Whether a shape that moves leaves its box, h before now or h after it. Renews the boxes of the turn's shapes."""
    gone = False
    turn = tables.counters[TURN]
    for i in range(tables.counters[SHAPES]):
        shape = tables.shapes[i]
        if shape.outline < 0:
            continue
        body = tables.bodies[shape.body]
        if body.stamp != frame and shape.low_x <= shape.high_x:
            continue
        if turn != 0 and body.steps != turn and body.kind != FIXED:
            continue
        low_x, low_y, high_x, high_y = box_of(pool, shape, body)
        shape.left = low_x
        shape.bottom = low_y
        shape.right = high_x
        shape.top = high_y
        carried = swing(shape, body)
        dx = h * (abs(body.vx) + carried)
        dy = h * (abs(body.vy) + carried)
        if (
            low_x - dx < shape.low_x
            or low_y - dy < shape.low_y
            or high_x + dx > shape.high_x
            or high_y + dy > shape.high_y
        ):
            gone = True
    return gone


@kernel
def _widen(pool: Pool, tables: Tables, time: float) -> None:
    """A new box for every shape: where it is, where it was and will be within `time`, and some room.

    And where it has been in this frame, if that is farther than it is seen.
    """
    for i in range(tables.counters[SHAPES]):
        shape = tables.shapes[i]
        if shape.outline < 0:
            continue
        body = tables.bodies[shape.body]
        shape.left, shape.bottom, shape.right, shape.top = box_of(pool, shape, body)
        carried = swing(shape, body)
        dx = time * (abs(body.vx) + carried) + MARGIN * shape.extent
        dy = time * (abs(body.vy) + carried) + MARGIN * shape.extent
        shape.low_x = shape.left - dx
        shape.low_y = shape.bottom - dy
        shape.high_x = shape.right + dx
        shape.high_y = shape.top + dy
        if body.kind == DRIFTS:
            dx = body.x - body.old_x
            dy = body.y - body.old_y
            if abs(dx) + abs(dy) > LOOK * shape.extent:
                shape.low_x -= max(0.0, dx)
                shape.low_y -= max(0.0, dy)
                shape.high_x -= min(0.0, dx)
                shape.high_y -= min(0.0, dy)


@kernel
def search(pool: Pool, tables: Tables, time: float, frame: int) -> bool:
    """Find all pairs whose boxes meet, the boxes made for `time` of motion. False: no room, for MORE_PAIRS of them.

    tables.near has them then, in no order. Pairs that are near no more are forgotten, but for those of
    which Chipmunk has told in this frame: a blow may have parted them, and its impulse is yet to be reported.
    """
    _widen(pool, tables, time)
    counters = tables.counters
    shapes = tables.shapes
    order = tables.sorted
    n = counters[SHAPES]
    for i in range(n):  # as far as the last search left it in order
        me = order[i]
        key = shapes[me].low_x
        j = i
        while j > 0 and shapes[order[j - 1]].low_x > key:
            order[j] = order[j - 1]
            j -= 1
        order[j] = me
    counters[SEARCH] += 1
    counters[MORE_PAIRS] = 0
    mark = counters[SEARCH]
    for i in range(n):
        one = shapes[order[i]]
        if one.outline < 0:
            continue
        me = tables.bodies[one.body]
        for j in range(i + 1, n):
            other = shapes[order[j]]
            if other.outline < 0:
                continue
            if other.low_x > one.high_x:
                break
            if other.low_y > one.high_y or other.high_y < one.low_y or one.body == other.body:
                continue
            it = tables.bodies[other.body]
            if not (me.mobile or it.mobile) or (
                me.joined and it.joined and kept_apart(tables, one.body, other.body)
            ):
                continue
            if one.sensor or other.sensor or not passes(one, other):
                continue
            p = find_pair(tables, order[i], order[j])
            if p < 0:
                if counters[FREE_PAIRS] == 0:
                    counters[MORE_PAIRS] += 1
                    continue
                p = new_pair(tables, order[i], order[j])
            tables.pairs[p].near = mark
    if counters[MORE_PAIRS] > 0:
        return False
    k = 0
    ended = 0
    left = pairs_in_use(tables)
    for p in range(len(tables.pairs)):
        if left == 0:
            break
        pair = tables.pairs[p]
        if pair.a >= 0:
            left -= 1
            if pair.near == mark:
                tables.near[k].pair = p
                k += 1
            elif pair.stamp != frame:
                end_pair(tables, p)
                ended += 1
    if ended > 0:
        rehash(tables)
    counters[NEAR] = k
    return True


@kernel
def kept_apart(tables: Tables, a: int, b: int) -> bool:
    """Whether a joint with collide_bodies = False holds the two bodies."""
    for i in range(tables.counters[APART]):
        p = tables.apart[i, 0]
        q = tables.apart[i, 1]
        if (p == a and q == b) or (p == b and q == a):
            return True
    return False


@kernel(forceinline=True)
def passes(one: Any, other: Any) -> bool:
    """Chipmunk's filter: whether the two shapes may collide."""
    return (one.group == 0 or one.group != other.group) and (
        (one.categories & other.mask) != 0 and (other.categories & one.mask) != 0
    )


@entry
def extents(pool: Pool, tables: Tables) -> None:
    """Every body's smallest extent and its reach, from its shapes'; how many of these are toothed, and not convex."""
    tables.counters[TOOTHED] = 0
    tables.counters[CONCAVE] = 0
    for i in range(tables.counters[BODIES]):
        tables.bodies[i].extent = 0.0
        tables.bodies[i].reach = 0.0
    for i in range(tables.counters[SHAPES]):
        shape = tables.shapes[i]
        if shape.outline >= 0 and not shape.sensor:
            body = tables.bodies[shape.body]
            body.extent = shape.extent if body.extent == 0.0 else min(body.extent, shape.extent)
            head = pool.heads[shape.outline]
            tables.counters[TOOTHED] += head.mouth < math.inf
            tables.counters[CONCAVE] += not head.convex
            body.reach = max(body.reach, abs(head.x) + abs(head.y) + shape.half_x + shape.half_y)
