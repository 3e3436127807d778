"""In which order near pairs and bodies are taken: from the bottom to the top, by places alone, turn by turn."""

from __future__ import annotations

import math
from typing import Any

from ..compile.jit import kernel
from ..geometry.pool import Pool
from .broad import boxes_part, end_unlisted, find_pairs, list_anew, renew_boxes, shapes_collide
from .tables import (
    ANEW,
    ASKED,
    AWAKE,
    BOXED,
    ENLISTED,
    FIRST,
    FIXED,
    JOINTS,
    KNOWN,
    LAST,
    LIVE,
    NEAR,
    REJOINED,
    TURN,
    TURNED,
    UNSORTED,
    Tables,
    disturb_both,
    end_pair,
    forget_pair,
)


@kernel
def find_near(pool: Pool, tables: Tables, frame: int, h: float, time: float) -> bool:
    """Bring the list of near pairs up to where bodies are, h before and after. False: no room for them.

    To be sieved and sorted (`sieve`, `arrange`) where counters[UNSORTED] says so.
    """
    counters = tables.counters
    if counters[ANEW] == 1:
        list_anew(tables)
        counters[ANEW] = 2
    renew_boxes(pool, tables, h, max(time, 2.0 * h))
    if counters[ASKED] > 0 and not find_pairs(tables):
        return False
    if counters[ANEW]:
        end_unlisted(tables, frame)
        counters[ANEW] = 0
    return True


@kernel(forceinline=True)
def up(gx: float, gy: float) -> tuple[float, float]:
    """The unit vector against gravity."""
    size = math.hypot(gx, gy)
    return (-gx / size, -gy / size) if size > 0.0 else (0.0, 1.0)


@kernel
def sieve(tables: Tables, frame: int) -> None:
    """The near pairs that may collide before all others, and before those that are listed for Chipmunk alone.

    Those whose boxes have parted are forgotten. Of these stay such as Chipmunk has told of in this frame, with nothing
    remembered: it is yet to hear of them. Those of which nobody is awake are remembered, but near no more.
    """
    near = tables.near
    n = 0
    k = 0
    for i in range(tables.counters[BOXED]):
        p = near[i].pair
        pair = tables.pairs[p]
        if pair.a < 0:
            continue
        one = tables.shapes[pair.a]
        other = tables.shapes[pair.b]
        parted = boxes_part(one, other)
        if not (tables.bodies[one.body].awake or tables.bodies[other.body].awake):
            pair.near = -1
            continue
        if parted and pair.stamp != frame:
            end_pair(tables, p)
            continue
        if parted:
            forget_pair(tables, p)
        collides = not parted and shapes_collide(tables, one, other)
        if pair.head >= 0 and not collides:
            disturb_both(tables, pair)
        near[k].pair = near[n].pair if collides else p
        if collides:
            near[n].pair = p
            near[n].a = one.body
            near[n].b = other.body
            near[n].extent = min(one.extent, other.extent)
            near[n].lined = one.mirror >= 0 or other.mirror >= 0
            n += 1
        k += 1
    tables.counters[BOXED] = tables.counters[KNOWN] = k
    tables.counters[NEAR] = n


@kernel
def arrange(tables: Tables, gx: float, gy: float) -> None:
    """Sort the near pairs (after `sieve`) from the bottom to the top: by places alone, so that nothing depends on who
    came first. Where a frame is made of turns (`islands`), turn by turn. And the bodies that are awake in the same way:
    sums over them then do not depend on who came first either.
    """
    ux, uy = up(gx, gy)
    for i in range(tables.counters[NEAR]):
        one = tables.near[i]
        a = tables.bodies[one.a]
        b = tables.bodies[one.b]
        x = 0.0
        y = 0.0
        if a.mobile:
            x += a.x
            y += a.y
        if b.mobile:
            x += b.x
            y += b.y
        share = 0.5 if a.mobile and b.mobile else 1.0
        one.order = share * (ux * x + uy * y)
        one.beside = share * (ux * y - uy * x)
        one.turn = turn_of(a, b) if tables.counters[TURNED] else 0
    _sort(tables, True, tables.counters[NEAR], tables.counters[BOXED], ux, uy)
    _sort(tables, False, tables.counters[AWAKE], tables.counters[AWAKE], ux, uy)
    tables.counters[UNSORTED] = 0
    bound(tables)
    enlist(tables)


@kernel
def _sort(tables: Tables, pairs: bool, n: int, room: int, ux: float, uy: float) -> None:
    """Sort near pairs, or bodies that are awake; the list has room from `room` on for n of them, and for one.

    Most are in order: those that are not are taken out, sorted (Shell) and merged with the rest (C. R. Cook and
    D. J. Kim, "Best sorting algorithm for nearly sorted lists", Comm. ACM 23 (1980)).
    """
    kept = 0
    for i in range(n):
        if kept > 0 and _later(tables, pairs, kept - 1, i, ux, uy):
            kept -= 1  # either may be the one that is out of order
            continue
        if kept < i:
            _set(tables, pairs, room, kept)
            _set(tables, pairs, kept, i)
            _set(tables, pairs, i, room)
        kept += 1
    gap = 1
    while gap < n - kept:
        gap = 3 * gap + 1
    while gap > 0:
        for i in range(kept + gap, n):
            _set(tables, pairs, room, i)
            j = i
            while j >= kept + gap and _later(tables, pairs, j - gap, room, ux, uy):
                _set(tables, pairs, j, j - gap)
                j -= gap
            if j < i:
                _set(tables, pairs, j, room)
        gap //= 3
    for i in range(kept, n):
        _set(tables, pairs, room + i - kept, i)
    left = n - kept
    for i in range(n - 1, -1, -1):
        if left == 0:
            break
        if kept > 0 and _later(tables, pairs, kept - 1, room + left - 1, ux, uy):
            kept -= 1
            _set(tables, pairs, i, kept)
        else:
            left -= 1
            _set(tables, pairs, i, room + left)


@kernel(forceinline=True)
def _later(tables: Tables, pairs: bool, i: int, j: int, ux: float, uy: float) -> bool:
    """Whether of two places in a list the first has what belongs behind what the second has."""
    if pairs:
        return bool(_after(tables, tables.near[i], tables.near[j]))
    return bool(_above(tables.bodies[tables.awake[i]], tables.bodies[tables.awake[j]], ux, uy))


@kernel(forceinline=True)
def _set(tables: Tables, pairs: bool, i: int, j: int) -> None:
    """Place i of a list as place j."""
    if not pairs:
        tables.awake[i] = tables.awake[j]
        return
    one = tables.near[i]
    other = tables.near[j]
    one.pair = other.pair
    one.a = other.a
    one.b = other.b
    one.extent = other.extent
    one.lined = other.lined
    one.turn = other.turn
    one.order = other.order
    one.beside = other.beside


@kernel
def order_joints(tables: Tables) -> None:
    """Sort the joints so that what they form without loops is eliminated exactly (`conjugate`): from its ends inwards.

    One after the other whose one body has no joint left but this one (what does not move has none): its mobility is
    taken for the last time then. In a loop, the first that is left. That is the order of leaves of a tree (D. J. Rose,
    "Triangulated graphs and the elimination process", J. Math. Anal. Appl. 32 (1970)).
    """
    joints = tables.joints
    bodies = tables.bodies
    n = tables.counters[JOINTS]
    for k in range(n):
        for i in (joints[k].a, joints[k].b):
            if i >= 0:
                bodies[i].joints = 0
                bodies[i].sum_of_joints = 0
    for k in range(n):
        joints[k].ordered = 0
        for i in (joints[k].a, joints[k].b):
            if i >= 0:
                bodies[i].joints += 1
                bodies[i].sum_of_joints += k
    tables.counters[REJOINED] = 0
    done = 0
    seed = 0
    while done < n:
        while joints[seed].ordered:
            seed += 1
        # a joint of one body that moves, or at an end; else the first left
        k = seed
        for j in range(seed, n):
            if not joints[j].ordered and (_ends_at(tables, joints[j].a) or _ends_at(tables, joints[j].b)):
                k = j
                break
        while k >= 0:
            joint = joints[k]
            joint.ordered = 1
            joints[done].order = k
            done += 1
            k = -1
            for i in (joint.a, joint.b):
                if i >= 0:
                    bodies[i].joints -= 1
                    bodies[i].sum_of_joints -= joints[done - 1].order
                    if k < 0 and bodies[i].mobile and bodies[i].joints == 1:
                        k = bodies[i].sum_of_joints


@kernel(forceinline=True)
def _ends_at(tables: Tables, i: int) -> bool:
    """Whether a body has no other joint, or does not move."""
    return i < 0 or not tables.bodies[i].mobile or tables.bodies[i].joints == 1


@kernel(forceinline=True)
def _enlist_fixed(tables: Tables, i: int, n: int) -> int:
    """List a body that does not move, unless it is listed; how many are."""
    body = tables.bodies[i]
    if body.kind == FIXED and body.listed != tables.counters[ENLISTED]:
        body.listed = tables.counters[ENLISTED]
        tables.live[n] = i
        n += 1
    return n


@kernel
def enlist(tables: Tables) -> None:
    """List the bodies that are live: those of the turn, then what does not move and is near or jointed to one (after
    `bound`).
    """
    counters = tables.counters
    turn = counters[TURN]
    n = 0
    for k in range(counters[AWAKE]):
        i = tables.awake[k]
        if turn == 0 or tables.bodies[i].steps == turn:
            tables.live[n] = i
            n += 1
    counters[ENLISTED] += 1
    for k in range(counters[FIRST], counters[LAST]):
        n = _enlist_fixed(tables, tables.near[k].a, n)
        n = _enlist_fixed(tables, tables.near[k].b, n)
    for k in range(counters[JOINTS]):
        for i in (tables.joints[k].a, tables.joints[k].b):
            if i >= 0:
                n = _enlist_fixed(tables, i, n)
    counters[LIVE] = n


@kernel(forceinline=True)
def _above(one: Any, other: Any, ux: float, uy: float) -> bool:
    here = ux * one.x + uy * one.y
    there = ux * other.x + uy * other.y
    if here != there:
        return bool(here > there)
    one_beside = ux * one.y - uy * one.x
    other_beside = ux * other.y - uy * other.x
    if abs(one_beside) != abs(other_beside):
        return bool(abs(one_beside) > abs(other_beside))
    return bool(one_beside > other_beside)


@kernel
def turn_of(a: Any, b: Any) -> int:
    """The turn to which a pair of bodies belongs; -1: to two."""
    if a.kind == FIXED:
        return int(b.steps)
    return int(a.steps) if b.kind == FIXED or a.steps == b.steps else -1


@kernel
def bound(tables: Tables) -> None:
    """Where in `near` the pairs of the present turn are."""
    counters = tables.counters
    turn = counters[TURN]
    first = 0
    while first < counters[NEAR] and tables.near[first].turn < turn:
        first += 1
    last = first
    while last < counters[NEAR] and tables.near[last].turn == turn:
        last += 1
    counters[FIRST] = first
    counters[LAST] = last


@kernel(forceinline=True)
def _after(tables: Tables, one: Any, other: Any) -> bool:
    if one.turn != other.turn:
        return bool(one.turn > other.turn)
    if one.order != other.order:
        return bool(one.order > other.order)
    if abs(one.beside) != abs(other.beside):
        return bool(abs(one.beside) > abs(other.beside))
    if one.beside != other.beside:
        return bool(one.beside > other.beside)
    return _lies_beyond(tables, tables.pairs[one.pair], tables.pairs[other.pair])


@kernel
def _lies_beyond(tables: Tables, one: Any, other: Any) -> bool:
    """Of two pairs in one place (of a box on two tiles): which has its shapes further to the right, and higher."""
    for side in range(2):
        s = tables.shapes[one.b if side else one.a]
        t = tables.shapes[other.b if side else other.a]
        if s.left != t.left:
            return bool(s.left > t.left)
        if s.bottom != t.bottom:
            return bool(s.bottom > t.bottom)
        if s.ident != t.ident:
            return bool(s.ident > t.ident)
    return False
