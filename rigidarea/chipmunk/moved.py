"""All that the next frame of an attached space starts from, into one block of memory and back: machine code.

Our tables, as far as they are in use; of Chipmunk what a frame reads: of bodies mass, place, motion, forces and for how
long they have idled, of joints the impulse, of a ratchet also the angle, of a pin the direction. Chipmunk's count of
steps goes on: what was noted of it is moved on with it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..compile.jit import callback, kernel
from ..compile.raw_memory import array_at, record
from ..contact.dtypes import BODY, SHAPE
from ..contact.joint_record import DIRECTION, KINDS, PIN, RATCHET
from ..contact.space_record import BACK, OUT, SIZE, load_tables, move, move_tables
from ..contact.tables import (
    AWAKE,
    BODIES,
    COUNTED,
    COUNTERS,
    FREE_PAIR,
    FREE_REGION,
    SHAPES,
    TOLD,
    USED_PAIRS,
    USED_REGIONS,
    Tables,
    append_free,
    never_used,
    rehash,
)
from .joints import KIND_WORDS
from .record import cache_boxes, floats, members, state_of, timestamp, words

#: What a block begins with; the counters follow.
HEAD = record(
    [
        ("bytes", "i8"),  # of the whole block
        ("stamp", "i8"),  # Chipmunk's number of its last step
        ("frame", "i8"),  # and of our last frame
        ("pairs", "i8"),  # for how many there was room
        ("regions", "i8"),
        ("nodes", "i8"),
        ("constraints", "i8"),
        ("sleepers", "i8"),  # words of the list of those that sleep
        ("listed", "i8"),  # bodies of Chipmunk's list of those that do not
        ("before", "f8"),
        ("rested_with", "f8"),
        ("taken", "i8"),
        ("contacts", "i8"),
        ("asleep", "i8"),
    ]
)
#: What is not as it was (`compare`); DOZED: others sleep than then, which alone can be put right.
SAME, BODIES_CHANGED, SHAPES_CHANGED, JOINTS_CHANGED, DOZED = range(5)
#: Of a joint: its address, its impulse, a ratchet's angle, a pin's direction (bytes).
_JOINT = 32
_HEAD = HEAD.itemsize
_TABLES = _HEAD + 8 * COUNTERS
_BODY, _SHAPE = BODY.itemsize, SHAPE.itemsize


@kernel
def _move_bodies(s: Any, bodies: np.ndarray, n: int, idle: int, back: int, block: int, at: int) -> int:
    """What Chipmunk has of bodies, from the mass to the transform, and for how long they have idled."""
    first = s.body_inverse_mass - 8
    for i in range(n):
        address = np.int64(bodies[i].address)
        if address != 0:
            at = move(back, block, at, address + first, s.body_transform + 48 - first)
            at = move(back, block, at, address + idle, 8)
    return int(at)


@kernel
def _move_joints(s: Any, space: int, back: int, block: int, at: int) -> int:
    """What joints did in the last frame, with which they begin the next."""
    kinds = array_at(s.kinds_at, (KINDS, KIND_WORDS), np.int64)
    for word in members(space, s.space_constraints):
        if word == s.hidden:
            continue
        address = np.int64(word)
        if back == OUT:
            words(block + at, 1)[0] = word
        for k in range(KINDS):
            if kinds[k, 0] == np.int64(words(address, 1)[0]):
                move(back, block, at + 8, address + kinds[k, 1], 8 * kinds[k, 2])
                if k == RATCHET:
                    move(back, block, at + 24, address + kinds[k, 3], 8)
                elif k == PIN:
                    move(back, block, at + 16, address + kinds[k, 3] + 8 * DIRECTION, 16)
        at += _JOINT
    return int(at)


@kernel
def _list_sleepers(s: Any, space: int, idle: int, at: int) -> int:
    """Each group that sleeps, its bodies' addresses and 0, there; how many words. at 0: counted alone.

    Chipmunk keeps with a body the first of its group, the next, and the time for which it has idled.
    """
    n = 0
    for root in members(space, s.space_sleeping):
        body = np.int64(root)
        while body != 0:
            if at != 0:
                words(at + 8 * n, 1)[0] = body
            n += 1
            body = np.int64(words(body + idle - 8, 1)[0])
        if at != 0:
            words(at + 8 * n, 1)[0] = 0
        n += 1
    return n


@callback("int64(uintp, int64, uintp, int64)")
def save(space: int, idle: int, block: int, room: int) -> int:
    """Take a snapshot; how many bytes it has. Nothing is written where there is no room for them.

    idle: where Chipmunk keeps for how long a body has idled (bytes).
    """
    s = state_of(space)
    tables = load_tables(s)
    n = tables.counters
    joints = len(members(space, s.space_constraints)) - 1
    sleepers = _list_sleepers(s, space, idle, 0)
    listed = members(space, s.space_bodies)
    size = move_tables(s, n, SIZE, 0, _TABLES) + joints * _JOINT + 8 * (sleepers + len(listed))
    size += n[BODIES] * (s.body_transform + 64 - s.body_inverse_mass)
    if size > room:
        return int(size)
    head = array_at(block, (1,), HEAD)[0]
    head.stamp = timestamp(space)
    head.frame = s.frame
    head.pairs = s.pairs_n
    head.regions = s.regions_n
    head.nodes = s.nodes_n
    head.constraints = joints
    head.sleepers = sleepers
    head.listed = len(listed)
    head.before = s.before
    head.rested_with = s.rested_with
    head.taken = s.taken
    head.contacts = s.contacts
    head.asleep = s.asleep
    at = move(OUT, block, _HEAD, s.counters_at, 8 * COUNTERS)
    at = move_tables(s, n, OUT, block, at)
    at = _move_joints(s, space, OUT, block, at)
    at += 8 * _list_sleepers(s, space, idle, block + at)
    for k in range(len(listed)):
        words(block + at + 8 * k, 1)[0] = listed[k]
    at += 8 * len(listed)
    at = _move_bodies(s, tables.bodies, n[BODIES], idle, OUT, block, at)
    head.bytes = at
    return int(at)


@callback("int64(uintp, int64, uintp)")
def compare(space: int, idle: int, block: int) -> int:
    """Whether a snapshot's bodies, shapes and joints are those of the space: SAME, or what is not."""
    s = state_of(space)
    tables = load_tables(s)
    head = array_at(block, (1,), HEAD)[0]
    then = array_at(block + _HEAD, (COUNTERS,), np.int64)
    n = tables.counters
    if then[BODIES] != n[BODIES]:
        return BODIES_CHANGED
    if then[SHAPES] != n[SHAPES] or head.nodes != s.nodes_n:
        return SHAPES_CHANGED
    at = block + _TABLES  # bodies come first, then shapes (`store.LASTING`)
    for i in range(n[BODIES]):
        if array_at(at + i * _BODY, (1,), BODY)[0].address != tables.bodies[i].address:
            return BODIES_CHANGED
    at += n[BODIES] * _BODY
    for i in range(n[SHAPES]):
        one = array_at(at + i * _SHAPE, (1,), SHAPE)[0]
        other = tables.shapes[i]
        if one.address != other.address or one.ident != other.ident or one.body != other.body:
            return SHAPES_CHANGED
        if one.outline != other.outline or one.mirror != other.mirror:
            return SHAPES_CHANGED
    constraints = members(space, s.space_constraints)
    if head.constraints != len(constraints) - 1:
        return JOINTS_CHANGED
    at = block + move_tables(s, then, SIZE, 0, _TABLES)
    for address in constraints:
        if address != s.hidden:
            if words(at, 1)[0] != address:
                return JOINTS_CHANGED
            at += _JOINT
    k = 0
    for root in members(space, s.space_sleeping):
        body = np.int64(root)
        while body != 0:
            if k >= head.sleepers or np.int64(words(at + 8 * k, 1)[0]) != body:
                return DOZED
            k += 1
            body = np.int64(words(body + idle - 8, 1)[0])
        k += 1
    return SAME if k == head.sleepers else DOZED


@callback("void(uintp, uintp)")
def reorder(space: int, block: int) -> None:
    """Chipmunk's list of bodies in the order of then, once the same ones are awake: sums over them follow it."""
    s = state_of(space)
    head = array_at(block, (1,), HEAD)[0]
    then = array_at(block + _HEAD, (COUNTERS,), np.int64)
    at = block + move_tables(s, then, SIZE, 0, _TABLES) + head.constraints * _JOINT + 8 * head.sleepers
    listed = members(space, s.space_bodies)
    if len(listed) == head.listed:
        for k in range(head.listed):
            listed[k] = words(at + 8 * k, 1)[0]


@kernel
def free_again(tables: Tables, head: Any, pairs: int, regions: int) -> None:
    """Rows that were not in use then, and have come into use, or into being, since; pairs, regions: used until now."""
    never_used(tables, pairs, regions)
    if len(tables.pairs) > head.pairs:
        append_free(tables.pairs["next"], tables.counters, FREE_PAIR, head.pairs)
    if len(tables.regions) > head.regions:
        append_free(tables.regions["next"], tables.counters, FREE_REGION, head.regions)


@kernel
def _delay(tables: Tables, late: int) -> None:
    """Numbers of frames, moved on by so many."""
    counters = tables.counters
    counters[COUNTED] += late
    for i in range(counters[BODIES]):
        if tables.bodies[i].stamp >= 0:
            tables.bodies[i].stamp += late
        if tables.bodies[i].disturbed >= 0:
            tables.bodies[i].disturbed += late
        if tables.bodies[i].replaced >= 0:
            tables.bodies[i].replaced += late
    for i in range(counters[SHAPES]):
        if tables.shapes[i].seen >= 0:
            tables.shapes[i].seen += late
    for p in range(counters[USED_PAIRS]):
        pair = tables.pairs[p]
        pair.arbiter = 0  # it may be another's by now
        if pair.stamp >= 0:
            pair.stamp += late
        if pair.lasting >= 0:
            pair.lasting += late
        if pair.waiting >= 0:
            pair.waiting += late


@callback("int64(uintp, int64, uintp)")
def restore(space: int, idle: int, block: int) -> int:
    """Put a snapshot back that `compare` has found to fit. 1: what Chipmunk takes for static is elsewhere now."""
    s = state_of(space)
    tables = load_tables(s)
    head = array_at(block, (1,), HEAD)[0]
    then = array_at(block + _HEAD, (COUNTERS,), np.int64)
    pairs = tables.counters[USED_PAIRS]
    regions = tables.counters[USED_REGIONS]
    late = np.int64(timestamp(space)) - head.stamp
    at = move(BACK, block, _HEAD, s.counters_at, 8 * COUNTERS)
    at = move_tables(s, then, BACK, block, at)
    at = _move_joints(s, space, BACK, block, at)
    at += 8 * (head.sleepers + head.listed)
    elsewhere = 0
    there = at
    for i in range(then[BODIES]):
        body = tables.bodies[i]
        if body.address != 0:
            if not body.awake:
                place = floats(body.address + s.body_transform, 6)
                kept = floats(block + there + s.body_transform - s.body_inverse_mass + 8, 6)
                for k in range(6):
                    elsewhere |= place[k] != kept[k]
            there += s.body_transform + 64 - s.body_inverse_mass
    _move_bodies(s, tables.bodies, then[BODIES], idle, BACK, block, at)
    free_again(tables, head, pairs, regions)
    _delay(tables, late)
    rehash(tables)
    tables.counters[TOLD] = 0
    s.frame = head.frame + late
    s.before = head.before
    s.rested_with = head.rested_with
    s.taken = head.taken
    s.contacts = head.contacts
    s.asleep = head.asleep
    for k in range(tables.counters[AWAKE]):  # queries look at the shapes' boxes
        cache_boxes(s, tables.bodies[tables.awake[k]])
    return elsewhere
