"""In which order near pairs and bodies are taken: from the bottom to the top, by places alone, turn by turn."""

from __future__ import annotations

import math
from typing import Any

from .broad import search, somebody_left
from .jit import kernel
from .pool import Pool
from .tables import (
    ANEW,
    FIRST,
    FIXED,
    JOINTS,
    LAST,
    LIVE,
    MET,
    NEAR,
    TURN,
    TURNED,
    Tables,
)


@kernel
def find_near(pool: Pool, tables: Tables, frame: int, h: float, time: float, gx: float, gy: float) -> bool:
    """Search pairs again if somebody has left the boxes of the last search. False: no room for them."""
    left = somebody_left(pool, tables, frame, h)
    if not (left or tables.counters[ANEW]):
        return True
    tables.counters[ANEW] = 1  # until it is done
    if not search(pool, tables, max(time, 2.0 * h), frame):
        return False
    tables.counters[ANEW] = 0
    arrange(tables, gx, gy)
    return True


@kernel(forceinline=True)
def up(gx: float, gy: float) -> tuple[float, float]:
    """The unit vector against gravity."""
    size = math.hypot(gx, gy)
    return (-gx / size, -gy / size) if size > 0.0 else (0.0, 1.0)


@kernel
def arrange(tables: Tables, gx: float, gy: float) -> None:
    """Sort the near pairs from the bottom to the top: by places alone, so that nothing depends on who came first.

    Where a frame is made of turns (`islands`), turn by turn.
    """
    ux, uy = up(gx, gy)
    near = tables.near
    n = tables.counters[NEAR]
    for i in range(n):
        one = near[i]
        pair = tables.pairs[one.pair]
        a = tables.bodies[tables.shapes[pair.a].body]
        b = tables.bodies[tables.shapes[pair.b].body]
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
        one.beside = share * abs(ux * y - uy * x)
        one.turn = turn_of(a, b) if tables.counters[TURNED] else 0
        if one.turn < 0:
            tables.counters[MET] = 1
    gap = 1
    while gap < n:
        gap = 3 * gap + 1
    while gap > 0:  # Shell's sort, in place
        for i in range(gap, n):
            _set(near[n], near[i])
            j = i
            while j >= gap and _after(near[j - gap], near[n]):
                _set(near[j], near[j - gap])
                j -= gap
            _set(near[j], near[n])
        gap //= 3
    line_up(tables, gx, gy)
    bound(tables)


@kernel
def line_up(tables: Tables, gx: float, gy: float) -> None:
    """Sort the live bodies in the same way: sums over them then do not depend on who came first either."""
    ux, uy = up(gx, gy)
    live = tables.live
    n = tables.counters[LIVE]
    gap = 1
    while gap < n:
        gap = 3 * gap + 1
    while gap > 0:
        for i in range(gap, n):
            k = live[i]
            j = i
            while j >= gap and _above(tables.bodies[live[j - gap]], tables.bodies[k], ux, uy):
                live[j] = live[j - gap]
                j -= gap
            live[j] = k
        gap //= 3


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
def _above(one: Any, other: Any, ux: float, uy: float) -> bool:
    here = ux * one.x + uy * one.y
    there = ux * other.x + uy * other.y
    if here != there:
        return bool(here > there)
    return bool(abs(ux * one.y - uy * one.x) > abs(ux * other.y - uy * other.x))


@kernel
def turn_of(a: Any, b: Any) -> int:
    """The turn to which a pair of bodies belongs; -1: to two."""
    if a.kind == FIXED or b.kind == FIXED or a.steps == b.steps:
        return int(max(a.steps, b.steps))
    return -1


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
def _set(one: Any, other: Any) -> None:
    one.pair = other.pair
    one.turn = other.turn
    one.order = other.order
    one.beside = other.beside


@kernel(forceinline=True)
def _after(one: Any, other: Any) -> bool:
    if one.turn != other.turn:
        return bool(one.turn > other.turn)
    if one.order != other.order:
        return bool(one.order > other.order)
    return bool(one.beside > other.beside)
