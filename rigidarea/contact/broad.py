"""Which pairs may touch: those whose boxes meet, of which one is awake; kept until the boxes part.

Chipmunk looks for pairs once a step, and tells of those that touch then. A contact solved in several substeps needs
those that come to touch within the frame as well. Every shape has a box with some room in one of two trees (`tree`);
who leaves it gets another, and is asked about alone. What is static or asleep is met in the trees, and asks nobody.
"""

from __future__ import annotations

import math
from typing import Any

from ..compile.jit import entry, kernel
from ..geometry.pool import Pool
from .constants import AHEAD, HUGE, LOOK, MARGIN
from .tables import (
    APART,
    ASKED,
    AWAKE,
    BOXED,
    DRIFTS,
    FREE_PAIRS,
    GONE,
    KNOWN,
    MORE_PAIRS,
    MOVERS,
    SEARCH,
    TURN,
    UNSORTED,
    Tables,
    end_pair,
    find_pair,
    new_pair,
)
from .tree import MOVING, STILL, insert, move, next_beside, next_met, remove


@kernel
def box_of(pool: Pool, shape: Any, body: Any) -> tuple[float, float, float, float]:
    """(low x, low y, high x, high y) of the shape where its body is; of a segment without thickness, its line's."""
    head = pool.heads[shape.outline]
    x = body.ox + body.c * head.x - body.s * head.y
    y = body.oy + body.s * head.x + body.c * head.y
    if shape.mirror >= 0:
        p = pool.points[head.point]
        q = pool.points[head.point + 1]
        px = x + body.c * p[0] - body.s * p[1]
        py = y + body.s * p[0] + body.c * p[1]
        qx = x + body.c * q[0] - body.s * q[1]
        qy = y + body.s * q[0] + body.c * q[1]
        return min(px, qx), min(py, qy), max(px, qx), max(py, qy)
    c = abs(body.c)
    s = abs(body.s)
    half_x = c * shape.half_x + s * shape.half_y
    half_y = s * shape.half_x + c * shape.half_y
    return x - half_x, y - half_y, x + half_x, y + half_y


@kernel(forceinline=True)
def swing(shape: Any, body: Any) -> float:
    """How fast a body's spin carries the middle of a shape's box about its centre (length/time)."""
    x = 0.5 * (shape.left + shape.right) - body.x
    y = 0.5 * (shape.bottom + shape.top) - body.y
    return float(abs(body.w) * (abs(x) + abs(y)))


@entry(forceinline=True)
def ask_about(tables: Tables, i: int) -> None:
    """Shape i is to be asked about: whom does its box meet."""
    n = tables.counters[ASKED]
    k = tables.shapes[i].asked
    if k >= n or tables.asked[k] != i:  # not among them yet
        tables.asked[n] = i
        tables.shapes[i].asked = n
        tables.counters[ASKED] = n + 1


@entry
def put_in_tree(tables: Tables, i: int, which: int) -> None:
    """Shape i in its present box in that tree, and in no other."""
    shape = tables.shapes[i]
    if shape.leaf >= 0 and shape.tree == which:
        move(
            tables.nodes,
            tables.roots,
            which,
            shape.leaf,
            shape.low_x,
            shape.low_y,
            shape.high_x,
            shape.high_y,
        )
        return
    if shape.leaf >= 0:
        remove(tables.nodes, tables.roots, shape.tree, shape.leaf)
    shape.tree = which
    shape.leaf = insert(
        tables.nodes, tables.roots, which, i, shape.low_x, shape.low_y, shape.high_x, shape.high_y
    )


@kernel
def _widen(shape: Any, body: Any, h: float, time: float) -> None:
    """A new box for a shape: where it is, was h ago and will be within AHEAD times `time`, and some room.

    And where it has been in this frame, if that is farther than it is seen.
    """
    room = MARGIN * shape.extent + time * swing(shape, body)
    ahead = AHEAD * time
    shape.low_x = shape.left - room + min(ahead * body.vx, -h * body.vx)
    shape.low_y = shape.bottom - room + min(ahead * body.vy, -h * body.vy)
    shape.high_x = shape.right + room + max(ahead * body.vx, -h * body.vx)
    shape.high_y = shape.top + room + max(ahead * body.vy, -h * body.vy)
    if body.kind == DRIFTS:
        dx = body.x - body.old_x
        dy = body.y - body.old_y
        if abs(dx) + abs(dy) > LOOK * shape.extent:
            shape.low_x -= max(0.0, dx)
            shape.low_y -= max(0.0, dy)
            shape.high_x -= min(0.0, dx)
            shape.high_y -= min(0.0, dy)


@kernel(forceinline=True)
def _is_huge(shape: Any, body: Any, time: float) -> bool:
    """Whether a shape's box has far more room than it would be given now."""
    room = shape.high_x - shape.low_x - (shape.right - shape.left) + shape.high_y - shape.low_y
    room -= shape.top - shape.bottom
    motion = time * (AHEAD * (abs(body.vx) + abs(body.vy)) + 4.0 * swing(shape, body))
    return bool(room > HUGE * (4.0 * MARGIN * shape.extent + motion))


@kernel
def renew_boxes(pool: Pool, tables: Tables, h: float, time: float) -> None:
    """Give each shape of the turn that leaves its box within h, or has shrunk its need of room, another, for `time` of
    motion, and ask about it.
    """
    turn = tables.counters[TURN]
    for k in range(tables.counters[MOVERS]):
        i = tables.movers[k]
        shape = tables.shapes[i]
        body = tables.bodies[shape.body]
        if (turn != 0 and body.steps != turn) or (body.same and body.steps == 0):
            continue
        low_x, low_y, high_x, high_y = box_of(pool, shape, body)
        shape.left = low_x
        shape.bottom = low_y
        shape.right = high_x
        shape.top = high_y
        carried = h * swing(shape, body)
        dx = h * body.vx
        dy = h * body.vy
        gained_x = h * body.gain_x  # what is flown at once is kicked on its way
        gained_y = h * body.gain_y
        if (
            low_x - carried + min(0.0, dx, dx + gained_x) < shape.low_x
            or low_y - carried + min(0.0, dy, dy + gained_y) < shape.low_y
            or high_x + carried + max(0.0, dx, dx + gained_x) > shape.high_x
            or high_y + carried + max(0.0, dy, dy + gained_y) > shape.high_y
            or _is_huge(shape, body, time)
        ):
            _widen(shape, body, h, time)
            put_in_tree(tables, i, MOVING)
            ask_about(tables, i)


@kernel
def find_pairs(tables: Tables) -> bool:
    """Enter the pairs of all that are asked about, behind tables.near[:counters[BOXED]]. False: no room, for MORE_PAIRS
    of them at least; those that are left are still to be asked about.
    """
    counters = tables.counters
    while counters[ASKED] > 0:
        i = int(tables.asked[counters[ASKED] - 1])
        shape = tables.shapes[i]
        if shape.outline >= 0 and not _pairs_of(tables, i):
            return False
        counters[ASKED] -= 1
        counters[UNSORTED] = 1
    return True


@kernel(forceinline=True)
def _next_meeting(tables: Tables, i: int, top: int, after: int) -> tuple[int, int]:
    """The next leaf whose box meets shape i's, and the branch from which to go on (`next_beside`); -1: none.

    Beginning with (shape i's leaf, -1): what is beside it in its tree, then the other tree.
    """
    shape = tables.shapes[i]
    nodes = tables.nodes
    root = tables.roots[STILL if shape.tree == MOVING else MOVING]
    if top != root:
        top, after = next_beside(nodes, top, after, shape.low_x, shape.low_y, shape.high_x, shape.high_y)
        if after >= 0:
            return top, after
    if root < 0:
        return root, -1
    return root, next_met(nodes, root, after, shape.low_x, shape.low_y, shape.high_x, shape.high_y)


@kernel
def _pairs_of(tables: Tables, i: int) -> bool:
    """Enter the pairs of shape i with what its box meets; a shape that does not move asks only what does."""
    counters = tables.counters
    shape = tables.shapes[i]
    me = tables.bodies[shape.body]
    top = int(shape.leaf if shape.tree == MOVING else tables.roots[MOVING])
    at = -1
    while True:
        top, at = _next_meeting(tables, i, top, at)
        if at < 0:
            return True
        j = int(tables.nodes[at].owner)
        other = tables.shapes[j]
        it = tables.bodies[other.body]
        if shape.body == other.body or not (me.awake or it.awake) or not (me.mobile or it.mobile):
            continue
        if me.awake and it.awake and (shape.sensor or other.sensor or not passes(shape, other)):
            continue  # (what a shape that is not awake lets pass may have changed since it was last looked at)
        p = find_pair(tables, i, j)
        if p < 0:
            if counters[FREE_PAIRS] == 0:
                counters[MORE_PAIRS] = max(counters[MORE_PAIRS], counters[ASKED])
                return False
            p = new_pair(tables, i, j)
        list_pair(tables, p)


@kernel
def list_pair(tables: Tables, p: int) -> None:
    """Pair p is among those of tables.near."""
    pair = tables.pairs[p]
    if pair.near != tables.counters[SEARCH]:
        pair.near = tables.counters[SEARCH]
        tables.near[tables.counters[BOXED]].pair = p
        tables.counters[BOXED] += 1
        tables.counters[UNSORTED] = 1


@kernel(forceinline=True)
def boxes_part(one: Any, other: Any) -> bool:
    return bool(
        one.low_x > other.high_x
        or other.low_x > one.high_x
        or one.low_y > other.high_y
        or other.low_y > one.high_y
    )


@entry
def drop_gone(tables: Tables) -> None:
    """Forget the near pairs of shapes that have gone."""
    n = 0
    for i in range(tables.counters[BOXED]):
        p = tables.near[i].pair
        pair = tables.pairs[p]
        if pair.a < 0:
            continue
        if tables.shapes[pair.a].outline < 0 or tables.shapes[pair.b].outline < 0:
            end_pair(tables, p)
            continue
        tables.near[n].pair = p
        n += 1
    tables.counters[BOXED] = n


@kernel
def forget_the_gone(tables: Tables) -> None:
    """Clear the lists of the rows of what has gone, once for all that went: before a row is used again."""
    counters = tables.counters
    if counters[GONE] == 0:
        return
    counters[GONE] = 0
    counters[UNSORTED] = 1
    drop_gone(tables)
    n = 0
    for k in range(counters[AWAKE]):
        i = tables.awake[k]
        if tables.bodies[i].awake:
            tables.awake[n] = i
            n += 1
    counters[AWAKE] = n
    n = 0
    for k in range(counters[MOVERS]):
        i = tables.movers[k]
        if tables.shapes[i].outline >= 0:
            tables.movers[n] = i
            n += 1
    counters[MOVERS] = n


@entry
def end_pairs_of(tables: Tables, i: int) -> None:
    """Shape i goes: its pairs end, and it is in no tree. `tables.near` is to be cleared by `forget_the_gone`."""
    shape = tables.shapes[i]
    if shape.leaf < 0:
        return
    top = int(shape.leaf)
    at = -1
    while True:
        top, at = _next_meeting(tables, i, top, at)
        if at < 0:
            break
        p = find_pair(tables, i, int(tables.nodes[at].owner))
        if p >= 0:
            end_pair(tables, p)
    remove(tables.nodes, tables.roots, shape.tree, shape.leaf)
    shape.leaf = -1


@kernel
def list_anew(tables: Tables) -> None:
    """All pairs are to be found again, since the tables are not as the list was made of them."""
    counters = tables.counters
    counters[SEARCH] += 1
    counters[BOXED] = counters[KNOWN] = 0
    for k in range(counters[MOVERS]):
        ask_about(tables, tables.movers[k])


@kernel
def end_unlisted(tables: Tables, frame: int) -> None:
    """After `list_anew` and `find_pairs`: pairs that have not been found again are none, but for those of which
    Chipmunk has told in this frame: their impulse is yet to be reported.
    """
    for p in range(len(tables.pairs)):
        pair = tables.pairs[p]
        if pair.a >= 0 and pair.stamp == frame:
            list_pair(tables, p)
        elif pair.a >= 0 and pair.near != tables.counters[SEARCH]:
            a = tables.bodies[tables.shapes[pair.a].body]
            b = tables.bodies[tables.shapes[pair.b].body]
            if a.awake or b.awake:
                end_pair(tables, p)


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


@kernel
def shapes_collide(tables: Tables, one: Any, other: Any) -> bool:
    """Whether of two shapes none is a sensor, one can move, and neither filters nor joints keep them apart."""
    a = tables.bodies[one.body]
    b = tables.bodies[other.body]
    if one.sensor or other.sensor or not passes(one, other) or not (a.mobile or b.mobile):
        return False
    return not (a.joined and b.joined and kept_apart(tables, one.body, other.body))


@kernel
def measure(pool: Pool, shape: Any, body: Any) -> None:
    """Take a shape into account in its body's smallest extent and reach."""
    if not shape.sensor:
        body.extent = shape.extent if body.extent == 0.0 else min(body.extent, shape.extent)
        head = pool.heads[shape.outline]
        body.reach = max(body.reach, abs(head.x) + abs(head.y) + shape.half_x + shape.half_y)


@kernel(forceinline=True)
def toothed(pool: Pool, shape: Any) -> bool:
    """Whether a shape has teeth or slots."""
    return bool(pool.heads[shape.outline].mouth < math.inf)
