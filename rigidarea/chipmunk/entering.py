"""Shapes and bodies come, go and are placed anew: rows of the tables, and leaves of the trees, in machine code.

Python hands over Chipmunk's addresses, when there is room for them; what is static is placed as it is then.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..compile.jit import callback, kernel
from ..compile.raw_memory import array_at
from ..contact.broad import (
    ask_about,
    box_of,
    end_pairs_of,
    forget_the_gone,
    measure,
    put_in_tree,
    toothed,
)
from ..contact.constants import MARGIN
from ..contact.space_record import (
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
from ..contact.tables import (
    ANEW,
    ASKED,
    BODIES,
    CONCAVE,
    FREE_BODY,
    FREE_SHAPE,
    GONE,
    MORE_BODIES,
    MORE_SHAPES,
    MORE_SLOTS,
    SHAPES,
    TOOTHED,
    UNSORTED,
    Tables,
)
from ..contact.tree import MOVING, STILL, build, new_leaf
from ..geometry.place import place
from .awake import put_to_rest
from .chipmunk_outlines import load_forms
from .record import body_type, read_place, row_of_shape, words

STATIC = 2
#: Shapes that come together by so many go into an empty tree at once.
MANY = 16


@kernel
def _row_of_body(s: Any, tables: Tables, address: int) -> int:
    """The row of Chipmunk's body, made if there is none: where it is, at rest. -1: there is no room for it."""
    i = row_of_body(s, address)
    if i >= 0:
        return i
    counters = tables.counters
    i = counters[FREE_BODY]
    if i >= 0:
        counters[FREE_BODY] = tables.bodies[i].island
    elif counters[BODIES] == len(tables.bodies):
        counters[MORE_BODIES] = 1
        return -1
    else:
        i = counters[BODIES]
        counters[BODIES] += 1
    clear(s.bodies_at + i * 8 * BODY_WORDS, BODY_WORDS)
    body = tables.bodies[i]
    body.address = address
    body.stamp = -1
    body.replaced = -1
    body.disturbed = -1
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
def _set_box(s: Any, shape: Any, body: Any, still: bool) -> None:
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
    """A row for Chipmunk's shape that has outline `head`; it is in no tree yet. -1: there is no room for its body."""
    counters = tables.counters
    own = words(address + s.shape_body, 1)[0]
    b = _row_of_body(s, tables, own)
    if b < 0:
        return -1
    body = tables.bodies[b]
    still = body_type(own) == STATIC
    if (
        still and not body.awake and body.held == body.entered
    ):  # the first of its shapes: it may have been moved
        read_place(s, own, body)
    body.held += 1
    body.unmeasured = 1
    body.disturbed = s.frame + 1
    i = counters[FREE_SHAPE]
    if i >= 0:
        counters[FREE_SHAPE] = tables.shapes[i].body
    else:
        i = counters[SHAPES]
        counters[SHAPES] += 1
    shape = tables.shapes[i]
    asked = shape.asked
    clear(s.shapes_at + i * 8 * SHAPE_WORDS, SHAPE_WORDS)
    shape.asked = asked  # the row may be listed still: not twice
    shape.address = address
    shape.ident = np.int64(words(address + s.shape_hashid, 1)[0])
    shape.body = b
    shape.outline = head
    forms = load_forms(s)
    mirror = forms.mirror[head]
    shape.mirror = mirror
    forms.users[head] += 1
    if mirror >= 0:
        forms.users[mirror] += 1
    shape.extent = forms.extent[head, 0]
    shape.half_x = forms.extent[head, 1]
    shape.half_y = forms.extent[head, 2]
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
    _set_box(s, shape, body, still)
    return int(i)


@kernel
def _has_room(s: Any, tables: Tables, addresses: int, n: int) -> bool:
    """Whether there is room for n of Chipmunk's shapes; if not, for how many more of what is noted."""
    counters = tables.counters
    last = 0
    for address in words(addresses, n):
        last = max(last, int(np.int64(words(address + s.shape_hashid, 1)[0])))
    free = len(tables.shapes) - counters[SHAPES]
    i = counters[FREE_SHAPE]
    while i >= 0 and free < n:
        i = tables.shapes[i].body
        free += 1
    counters[MORE_SLOTS] = max(0, last + 1 - s.slots_n)
    counters[MORE_SHAPES] = max(0, n - free)
    return bool(counters[MORE_SLOTS] == 0 and counters[MORE_SHAPES] == 0)


@callback("int64(uintp, uintp, uintp, int64)")
def shapes_come(state: int, addresses: int, heads: int, n: int) -> int:
    """Enter n of Chipmunk's shapes; how many there was room for (MORE_...), the first ones.

    addresses: n words; heads: n int32, the numbers of their outlines.
    """
    s = array_at(state, (1,), STATE)[0]
    tables = load_tables(s)
    counters = tables.counters
    forget_the_gone(tables)
    if not _has_room(s, tables, addresses, n):
        return 0
    head_of = array_at(heads, (n,), np.int32)
    many = n >= MANY and tables.roots[STILL] < 0 and tables.roots[MOVING] < 0
    scratch = tables.asked[counters[ASKED] :]
    still = 0
    moving = 0
    done = 0
    for address in words(addresses, n):
        if many or row_of_shape(s, address) < 0:  # what was interrupted is done again
            i = _come(s, tables, address, head_of[done])
            if i < 0:
                break
            shape = tables.shapes[i]
            if not many:
                put_in_tree(tables, i, shape.tree)
                ask_about(tables, i)
            else:
                shape.leaf = new_leaf(
                    tables.nodes, tables.roots, i, shape.low_x, shape.low_y, shape.high_x, shape.high_y
                )
                moving += shape.tree == MOVING
                still += shape.tree == STILL
                scratch[n - moving if shape.tree == MOVING else still - 1] = shape.leaf
        done += 1
    if many:
        build(tables.nodes, tables.roots, STILL, scratch[:still])
        build(tables.nodes, tables.roots, MOVING, scratch[n - moving : n])
        counters[ANEW] = 1
    return done


@callback("void(uintp, uintp)")
def shape_goes(state: int, ident: int) -> None:
    """Forget one of Chipmunk's shapes, by its id, if it is known."""
    s = array_at(state, (1,), STATE)[0]
    tables = load_tables(s)
    counters = tables.counters
    slots = array_at(s.slots_at, (s.slots_n,), np.int32)
    i = int(slots[ident]) if ident < s.slots_n else -1
    if i < 0:
        return
    slots[ident] = -1
    shape = tables.shapes[i]
    end_pairs_of(tables, i)
    users = load_forms(s).users
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
    s.pending = max(1, s.pending)


@callback("int64(uintp, uintp, int64, int64)")
def bodies_come(state: int, addresses: int, n: int, hold: int) -> int:
    """Enter n of Chipmunk's bodies; how many there was room for (MORE_BODIES), the first ones.

    hold: have the solve move them, unless their position function is the user's.
    """
    s = array_at(state, (1,), STATE)[0]
    tables = load_tables(s)
    forget_the_gone(tables)
    done = 0
    for address in words(addresses, n):
        i = _row_of_body(s, tables, address)
        if i < 0:
            tables.counters[MORE_BODIES] = n - done
            break
        body = tables.bodies[i]
        if body.entered == 0:
            body.entered = 1
            body.held += 1
        function = words(address + s.body_position_func, 1)
        if hold and (function[0] == s.position_func or function[0] == s.position_func_again):
            function[0] = s.hold_at
        done += 1
    return done


@callback("void(uintp, uintp, int64)")
def body_goes(state: int, address: int, there: int) -> None:
    """Forget one of Chipmunk's bodies, if it is known. there: its memory is, its position function is given back."""
    s = array_at(state, (1,), STATE)[0]
    tables = load_tables(s)
    if there and words(address + s.body_position_func, 1)[0] == s.hold_at:
        words(address + s.body_position_func, 1)[0] = s.position_func
    i = row_of_body(s, address)
    if i >= 0 and tables.bodies[i].entered:
        tables.bodies[i].entered = 0
        _let_go_of_body(s, tables, i)
    tables.counters[GONE] = 1
    s.pending = max(1, s.pending)


@callback("void(uintp, uintp, int64)")
def placed_anew(state: int, addresses: int, n: int) -> None:
    """n of Chipmunk's bodies, static or asleep, are where they are now: they have been reindexed."""
    s = array_at(state, (1,), STATE)[0]
    tables = load_tables(s)
    for address in words(addresses, n):
        b = row_of_body(s, address)
        if b < 0 or (tables.bodies[b].awake and body_type(address) != STATIC):
            continue
        body = tables.bodies[b]
        x, y, angle = body.x, body.y, body.angle
        read_place(s, address, body)
        place(body)
        if body.x != x or body.y != y or body.angle != angle:
            body.replaced = s.frame + 1
            body.put_x = body.x - x
            body.put_y = body.y - y
            body.put_a = body.angle - angle
        shape_at = words(address + s.body_shapes, 1)[0]
        while shape_at != 0:
            i = row_of_shape(s, shape_at)
            if i >= 0:
                shape = tables.shapes[i]
                _set_box(s, shape, body, shape.tree == STILL)
                put_in_tree(tables, i, shape.tree)
                ask_about(tables, i)
            shape_at = words(shape_at + s.shape_next, 1)[0]
        tables.counters[UNSORTED] = 1
