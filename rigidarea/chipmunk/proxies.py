"""Pairs of which one is a proxy: Chipmunk hears of them where the outlines overlap, and nothing where they are apart.

While Chipmunk steps, its index of shapes that move asks us for what to do with a pair whose boxes meet
(`Spy`), and the user's callbacks are called through `first_begin` and `first_pre_solve`, so that their arbiter shows
what was found (`shown`). All is as it was when the step ends.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pymunk
from pymunk._chipmunk_cffi import ffi

from ..compile.jit import callback, kernel
from ..compile.raw_memory import caller
from ..contact.sides import faces
from ..contact.space_record import load_pool, load_tables, load_work
from ..contact.tables import MORE_WORK, Tables, find_pair
from ..geometry.direction import chord_direction
from ..geometry.extent import extent
from ..geometry.place import Pose, overlap_of_outlines, push_out
from .record import GROW, ask, floats, row_of_shape, state_of, words
from .shown import SHOWN, show, shown_of
from .structs import address_of

#: Words of a class of Chipmunk's indices, all functions (cpSpatialIndex.h), and which of them asks for pairs.
FUNCTIONS, REINDEX_QUERY = 11, 8

_call_collide = caller("uint32(uintp, uintp, uint32, uintp)")
_call_reindex = caller("void(uintp, uintp, uintp)")
_call_hook = caller("void(uintp, uintp, uintp)")


@kernel
def _pose(s: Any, shape: int) -> Pose:
    """Where the body of Chipmunk's shape is."""
    t = floats(words(shape + s.shape_body, 1)[0] + s.body_transform, 6)
    return Pose(t[4], t[5], t[0], t[1])


@kernel
def _side(s: Any, tables: Tables, i: int, pose: Pose, j: int, other_pose: Pose) -> int:
    """The outline that shape i shows to shape j: of a bare segment one of two."""
    shape = tables.shapes[i]
    if shape.mirror < 0:
        return int(shape.outline)
    side = 0
    kept = 0
    p = find_pair(tables, i, j)
    if p >= 0:
        pair = tables.pairs[p]
        side = pair.side_a if pair.a == i else pair.side_b
        kept = pair.kept_a if pair.a == i else pair.kept_b
        if pair.head < 0:
            side = faces(load_pool(s), shape.outline, pose, tables.shapes[j], other_pose, side, kept, 0.0)
    if side == 0:
        side = faces(load_pool(s), shape.outline, pose, tables.shapes[j], other_pose, 0, kept, 0.0)
    return int(shape.outline if side > 0 else shape.mirror)


@kernel
def _look(s: Any, tables: Tables, i: int, j: int) -> int:
    """How many regions the outlines of two shapes have, the two largest of them noted to be shown; -1: no room."""
    t = shown_of(s)
    at_a = tables.shapes[i].address
    at_b = tables.shapes[j].address
    a = _pose(s, at_a)
    b = _pose(s, at_b)
    pool = load_pool(s)
    work = load_work(s)
    ia = _side(s, tables, i, a, j, b)
    ib = _side(s, tables, j, b, i, a)
    n, rel = overlap_of_outlines(pool, ia, a, ib, b, work)
    if n <= 0:
        return int(n)
    first = 0
    second = -1
    for k in range(1, n):
        if work.loops[k].area > work.loops[first].area:
            second = first
            first = k
        elif second < 0 or work.loops[k].area > work.loops[second].area:
            second = k
    t.shape_a = at_a
    t.count = 1 if second < 0 else 2
    for k in range(t.count):
        loop = work.loops[first if k == 0 else second]
        nx, ny = chord_direction(loop.chord_x, loop.chord_y, loop.area)
        if nx == 0.0 and ny == 0.0:
            nx, ny = push_out(pool, ia, ib, rel)
        low, high = extent(work.polygon, work.bows, loop.start, loop.stop, loop.arcs == 1, nx, ny)
        middle = loop.x * nx + loop.y * ny
        x = loop.x + pool.heads[ia].x
        y = loop.y + pool.heads[ia].y
        px = a.x + a.c * x - a.s * y
        py = a.y + a.s * x + a.c * y
        dx = a.c * nx - a.s * ny
        dy = a.s * nx + a.c * ny
        if k == 0:
            t.nx = dx
            t.ny = dy
            t.ax0 = px + (high - middle) * dx
            t.ay0 = py + (high - middle) * dy
            t.bx0 = px + (low - middle) * dx
            t.by0 = py + (low - middle) * dy
        else:
            t.ax1 = px + (high - middle) * dx
            t.ay1 = py + (high - middle) * dy
            t.bx1 = px + (low - middle) * dx
            t.by1 = py + (low - middle) * dy
    return int(n)


@callback("uint32(uintp, uintp, uint32, uintp)")
def collide(one: int, other: int, ident: int, space: int) -> int:
    """Two of Chipmunk's shapes whose boxes meet: it is told of them, unless their outlines are apart."""
    s = state_of(space)
    t = shown_of(s)
    t.count = 0
    t.arbiter = np.uint64(0)
    i = row_of_shape(s, one)
    j = row_of_shape(s, other)
    if i >= 0 and j >= 0 and (load_tables(s).shapes[i].proxy or load_tables(s).shapes[j].proxy):
        n = _look(s, load_tables(s), i, j)
        while n < 0:
            load_tables(s).counters[MORE_WORK] = 1
            if not ask(s, GROW):
                return ident
            n = _look(s, load_tables(s), i, j)
        if n == 0:
            return ident
    # 0: it looks for contact points from the start, not from where it has found them a step ago, which no copy knows
    ident = _call_collide(t.collide_at, one, other, np.uint32(0), space)
    t.count = 0
    t.arbiter = np.uint64(0)
    return ident


@callback("void(uintp, uintp, uintp)")
def first_begin(arbiter: int, space: int, data: int) -> None:
    """Python's `begin`, after the arbiter has been made to show the outlines' regions."""
    s = state_of(space)
    show(s, space, arbiter)
    _call_hook(shown_of(s).begin_at, arbiter, space, data)


@callback("void(uintp, uintp, uintp)")
def first_pre_solve(arbiter: int, space: int, data: int) -> None:
    """The same of `pre_solve`."""
    s = state_of(space)
    show(s, space, arbiter)
    _call_hook(shown_of(s).pre_solve_at, arbiter, space, data)


@callback("void(uintp, uintp, uintp)")
def reindex(index: int, each: int, space: int) -> None:
    """What Chipmunk asks its index for in a step: all pairs whose boxes meet. The index has its class again."""
    t = shown_of(state_of(space))
    words(index, 1)[0] = t.class_at
    t.collide_at = each
    _call_reindex(t.reindex_at, index, t.spied_at, space)


class Spy:
    """In the place of the class of a space's index, and before the user's callbacks, from `come` to `go`."""

    def __init__(self, state: Any) -> None:
        self._shown = np.zeros(1, SHOWN)
        self._class = np.zeros(FUNCTIONS, np.uint64)
        state["shown_at"] = self._shown.ctypes.data
        self._dynamic = int(state["space_constraints"]) - 8
        self._begin = int(state["handler_pre_solve"]) - 8
        ours = (first_begin.address, first_pre_solve.address)
        pythons = (int(state["pythons_begin"]), int(state["pythons_pre_solve"]))
        self._shown["begin_at"], self._shown["pre_solve_at"] = pythons
        self._to_ours, self._to_pythons = dict(zip(pythons, ours)), dict(zip(ours, pythons))
        self._shown["first_at"] = first_pre_solve.address
        self._reindex = reindex.address
        self._shown["spied_at"] = collide.address

    def come(self, space: pymunk.Space) -> None:
        """Before a step."""
        at = ffi.cast("uintptr_t *", address_of(space._space) + self._dynamic)
        index = ffi.cast("uintptr_t *", int(at[0]))
        shown = self._shown[0]
        if shown["class_at"] != int(index[0]):
            shown["class_at"] = int(index[0])
            self._class[:] = np.frombuffer(
                ffi.buffer(ffi.cast("void *", int(index[0])), 8 * FUNCTIONS), np.uint64
            )
            shown["reindex_at"] = self._class[REINDEX_QUERY]
            self._class[REINDEX_QUERY] = self._reindex
        index[0] = self._class.ctypes.data
        self._swap(space, self._to_ours)

    def go(self, space: pymunk.Space) -> None:
        """After it: the index has its class again as soon as it has been asked, or here, if it was not."""
        at = ffi.cast("uintptr_t *", address_of(space._space) + self._dynamic)
        index = ffi.cast("uintptr_t *", int(at[0]))
        if int(index[0]) == self._class.ctypes.data:
            index[0] = int(self._shown[0]["class_at"])
        self._swap(space, self._to_pythons)

    def _swap(self, space: pymunk.Space, others: dict[int, int]) -> None:
        for key, handler in space._handlers.items():
            functions = ffi.cast("uintptr_t *", address_of(handler._handler) + self._begin)
            for k in range(
                1 if key == (None, None) else 2
            ):  # the global pre_solve is called by `pre_solve.pre_solve`
                functions[k] = others.get(int(functions[k]), int(functions[k]))
