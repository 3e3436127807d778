"""Shapes and bodies come, go and are placed anew: rows of the tables, and leaves of the trees, in machine code.

Python hands over Chipmunk's addresses, when there is room for them; what is static is placed as it is then.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..kernel.broad import (
    ask_about,
    box_of,
    end_pairs_of,
    forget_the_gone,
    measure,
    put_in_tree,
    toothed,
)
from ..kernel.constants import MARGIN
from ..kernel.jit import callback, kernel
from ..kernel.memory import array_at
from ..kernel.place import place
from ..kernel.tables import (
    ANEW,
    ASKED,
    BODIES,
    CONCAVE,
    FREE_BODY,
    FREE_SHAPE,
    GONE,
    SHAPES,
    TOOTHED,
    UNSORTED,
    Tables,
)
from ..kernel.tree import MOVING, STILL, build, new_leaf
from ..store import (
    BODY_WORDS,
    SHAPE_WORDS,
    STATE,
    clear,
    drop_body,
    enter_body,
    load_pool,
    load_tables,
    row_of_body,
)
from .record import body_type, put_to_rest, read_place, row_of_shape, words

STATIC = 2
#: Shapes that come together by so many go into an empty tree at once.
MANY = 16


@kernel
def _row_of_body(s: Any, tables: Tables, address: int) -> int:
    """The row of Chipmunk's body, made if there is none: where it is, at rest."""
    i = row_of_body(s, address)
    if i >= 0:
        return i
    counters = tables.counters
    i = counters[FREE_BODY]
    if i >= 0:
        counters[FREE_BODY] = tables.bodies[i].island
    else:
        i = counters[BODIES]
        counters[BODIES] += 1
    clear(s.bodies_at + i * 8 * BODY_WORDS, BODY_WORDS)
    body = tables.bodies[i]
    body.address = address
    body.stamp = -1
    enter_body(s, address, i)
    read_place(s, address, body)
    put_to_rest(s, body)
    return int(i)


@kernel
def _let_go_of_body(s: Any, tables: Tables, i: int) -> None:
    """A body that has lost a shape, or left the space: its row is free once it has neither."""
    body = tables.bodies[i]
    body.held -= 1
    if body.held == 0:
        drop_body(s, body.address)
        body.address = 0
        body.stamp = -1
        body.awake = 0
        body.island = tables.counters[FREE_BODY]
        tables.counters[FREE_BODY] = i


@kernel
def _set_box(s: Any, tables: Tables, shape: Any, body: Any, still: bool) -> None:
    """A shape's box where its body is, with some room if it may move."""
    low_x, low_y, high_x, high_y = box_of(load_pool(s), shape, body)
    shape.left = low_x
    shape.bottom = low_y
    shape.right = high_x
    shape.top = high_y
    room = 0.0 if still else MARGIN * shape.extent
    shape.low_x = low_x - room
    shape.low_y = low_y - room
    shape.high_x = high_x + room
    shape.high_y = high_y + room


@kernel
def _come(s: Any, tables: Tables, address: int, head: int) -> int:
    """A row for Chipmunk's shape that has outline `head`; it is in no tree yet."""
    counters = tables.counters
    own = words(address + s.shape_body, 1)[0]
    b = _row_of_body(s, tables, own)
    body = tables.bodies[b]
    still = body_type(own) == STATIC
    if (
        still and not body.awake and body.held == body.entered
    ):  # the first of its shapes: it may have been moved
        read_place(s, own, body)
    body.held += 1
    body.unmeasured = 1
    i = counters[FREE_SHAPE]
    if i >= 0:
        counters[FREE_SHAPE] = tables.shapes[i].body
    else:
        i = counters[SHAPES]
        counters[SHAPES] += 1
    clear(s.shapes_at + i * 8 * SHAPE_WORDS, SHAPE_WORDS)
    shape = tables.shapes[i]
    shape.address = address
    shape.ident = np.int64(words(address + s.shape_hashid, 1)[0])
    shape.body = b
    shape.outline = head
    mirror = array_at(s.mirrors_at, (s.mirrors_n,), np.int32)[head]
    shape.mirror = mirror
    users = array_at(s.users_at, (s.users_n,), np.int32)
    users[head] += 1
    if mirror >= 0:
        users[mirror] += 1
    extents = array_at(s.extents_at, (s.extents_n, 3), np.float64)
    shape.extent = extents[head, 0]
    shape.half_x = extents[head, 1]
    shape.half_y = extents[head, 2]
    shape.leaf = -1
    shape.seen = -1
    shape.epoch = -1
    shape.tree = STILL if still else MOVING
    shape.sensor = array_at(address + s.shape_sensor, (1,), np.uint8)[0]
    array_at(s.slots_at, (s.slots_n,), np.int32)[shape.ident] = i
    counters[TOOTHED] += toothed(load_pool(s), shape)
    counters[CONCAVE] += not load_pool(s).heads[head].convex
    if not body.awake:
        measure(load_pool(s), shape, body)
    _set_box(s, tables, shape, body, still)
    return int(i)


@callback("void(uintp, uintp, uintp, int64)")
def shapes_come(state: int, addresses: int, heads: int, n: int) -> None:
    """Enter n of Chipmunk's shapes; addresses: n words; heads: n int32, the numbers of their outlines."""
    s = array_at(state, (1,), STATE)[0]
    tables = load_tables(s)
    counters = tables.counters
    forget_the_gone(tables)
    head_of = array_at(heads, (n,), np.int32)
    many = n >= MANY and tables.roots[STILL] < 0 and tables.roots[MOVING] < 0
    scratch = tables.asked[counters[ASKED] :]
    if many:
        still = 0
        moving = 0
        for k in range(n):
            i = _come(s, tables, words(addresses + 8 * k, 1)[0], head_of[k])
            shape = tables.shapes[i]
            shape.leaf = new_leaf(
                tables.nodes, tables.roots, i, shape.low_x, shape.low_y, shape.high_x, shape.high_y
            )
            if shape.tree == STILL:
                scratch[still] = shape.leaf
                still += 1
            else:
                moving += 1
                scratch[n - moving] = shape.leaf
        build(tables.nodes, tables.roots, STILL, scratch[:still])
        build(tables.nodes, tables.roots, MOVING, scratch[n - moving : n])
        counters[ANEW] = 1
        return
    for k in range(n):
        address = words(addresses + 8 * k, 1)[0]
        if row_of_shape(s, address) >= 0:  # what was interrupted is done again
            continue
        i = _come(s, tables, address, head_of[k])
        put_in_tree(tables, i, tables.shapes[i].tree)
        ask_about(tables, i)


@callback("void(uintp, uintp, int64)")
def shapes_go(state: int, idents: int, n: int) -> None:
    """Forget n of Chipmunk's shapes; idents: n words, its ids."""
    s = array_at(state, (1,), STATE)[0]
    tables = load_tables(s)
    counters = tables.counters
    slots = array_at(s.slots_at, (s.slots_n,), np.int32)
    users = array_at(s.users_at, (s.users_n,), np.int32)
    for ident in words(idents, n):
        i = int(slots[ident]) if ident < s.slots_n else -1
        if i < 0:
            continue
        slots[ident] = -1
        shape = tables.shapes[i]
        end_pairs_of(tables, i)
        users[shape.outline] -= 1
        if shape.mirror >= 0:
            users[shape.mirror] -= 1
        counters[TOOTHED] -= toothed(load_pool(s), shape)
        counters[CONCAVE] -= not load_pool(s).heads[shape.outline].convex
        tables.bodies[shape.body].unmeasured = 1
        _let_go_of_body(s, tables, shape.body)
        shape.outline = -1
        shape.mirror = -1
        shape.address = 0
        shape.body = counters[FREE_SHAPE]
        counters[FREE_SHAPE] = i
    counters[GONE] = 1


@callback("void(uintp, uintp, int64, int64)")
def bodies_come(state: int, addresses: int, n: int, hold: int) -> None:
    """Enter n of Chipmunk's bodies; hold: have the solve move them, unless their position function is the user's."""
    s = array_at(state, (1,), STATE)[0]
    tables = load_tables(s)
    forget_the_gone(tables)
    for address in words(addresses, n):
        body = tables.bodies[_row_of_body(s, tables, address)]
        if body.entered == 0:
            body.entered = 1
            body.held += 1
        function = words(address + s.body_position_func, 1)
        if hold and (function[0] == s.position_func or function[0] == s.position_func_again):
            function[0] = s.hold_at


@callback("void(uintp, uintp, int64)")
def bodies_go(state: int, addresses: int, n: int) -> None:
    """Forget n of Chipmunk's bodies."""
    s = array_at(state, (1,), STATE)[0]
    tables = load_tables(s)
    for address in words(addresses, n):
        i = row_of_body(s, address)
        if i >= 0 and tables.bodies[i].entered:
            tables.bodies[i].entered = 0
            _let_go_of_body(s, tables, i)
    tables.counters[GONE] = 1


@callback("void(uintp, uintp, int64)")
def placed_anew(state: int, addresses: int, n: int) -> None:
    """n of Chipmunk's bodies, static or asleep, are where they are now: they have been reindexed."""
    s = array_at(state, (1,), STATE)[0]
    tables = load_tables(s)
    for address in words(addresses, n):
        b = row_of_body(s, address)
        if b < 0 or tables.bodies[b].awake:
            continue
        body = tables.bodies[b]
        read_place(s, address, body)
        place(body)
        shape_at = words(address + s.body_shapes, 1)[0]
        while shape_at != 0:
            i = row_of_shape(s, shape_at)
            if i >= 0:
                shape = tables.shapes[i]
                _set_box(s, tables, shape, body, shape.tree == STILL)
                put_in_tree(tables, i, shape.tree)
                ask_about(tables, i)
            shape_at = words(shape_at + s.shape_next, 1)[0]
        tables.counters[UNSORTED] = 1
