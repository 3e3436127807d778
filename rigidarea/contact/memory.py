"""What a copy of an attached space is told, so that it goes on as its original does.

Pairs with their regions, the shapes' boxes, and the impulses that joints start from, which pymunk's copies forget.
Pairs keep their numbers: what comes first where two are equally high is decided by them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pymunk
from pymunk._chipmunk_cffi import ffi, lib

from ..chipmunk import address_of, centre_of, joint_impulse, put_centre
from ..kernel.broad import drop_pairs, put_in_tree
from ..kernel.tables import (
    ANEW,
    APART,
    ASKED,
    AWAKE,
    BOXED,
    COUNTED,
    FREE_PAIR,
    FREE_PAIRS,
    FREE_REGION,
    FREE_REGIONS,
    NEAR,
    SEARCH,
    SUBSTEP,
    TURNED,
    UNSORTED,
    USED_PAIRS,
    USED_REGIONS,
    end_pair,
    rehash,
)
from .arrays import Store


class Memory(NamedTuple):
    """Arrays of a `Store`; shapes and joints by their places in the space's lists."""

    pairs: np.ndarray
    """(n,) PAIR, the two shapes by their rows."""
    regions: np.ndarray
    """(n,) REGION."""
    near: np.ndarray
    """(n,) int32: pairs in the order of the sweeps."""
    rows: np.ndarray
    """(n,) int: each shape's row; -1: it has come since the last frame."""
    shapes: np.ndarray
    """(n,) SHAPE, by row."""
    counters: np.ndarray
    joints: list[np.ndarray]
    """Impulses."""
    before: float
    """In which time they did them."""
    bodies: np.ndarray
    """(n, 5): of each body, the substeps asked for its island, those of the last frame, whether it was pushed, whether
    calm, and for how long it has moved by itself."""
    awake: np.ndarray
    """(n,) int: the bodies that are awake in the order of sums over them, by their places in the space's list."""
    centres: np.ndarray
    """(n, 2) where each body's centre of gravity is: pymunk restores a body's place before its centre of gravity, and
    leaves one elsewhere whose centre is not its origin."""


_COUNTERS = [FREE_REGION, FREE_REGIONS, FREE_PAIR, FREE_PAIRS, SEARCH, SUBSTEP, NEAR, BOXED]
_COUNTERS += [UNSORTED, TURNED, COUNTED, USED_PAIRS, USED_REGIONS]
#: What a body keeps.
_BODY = ("asked", "taken", "pushed", "calm", "since")
#: What a shape keeps.
_SHAPE = (
    *("group", "categories", "mask", "low_x", "low_y", "high_x", "high_y"),
    *("left", "bottom", "right", "top"),
)


def remember(store: Store, space: pymunk.Space) -> Memory:
    """What of a space's tables, and of its bodies and joints, the next frame starts from."""
    rows = [int(store.slots[s._hashid]) if store.knows(s._hashid) else -1 for s in space.shapes]
    tables = store.tables
    return Memory(
        tables.pairs.copy(),
        tables.regions.copy(),
        tables.near.copy(),
        np.array(rows, np.int64),
        tables.shapes.copy(),
        tables.counters.copy(),
        [np.array(joint_impulse(joint)) for joint in space.constraints],
        float(store.state["before"][0]),
        np.array(
            [tables.bodies[store.row_of(address_of(b._body))][list(_BODY)].tolist() for b in space.bodies]
        ),
        _awake(store, space),
        np.array([centre_of(b).copy() for b in space.bodies]),
    )


def _body_rows(store: Store, space: pymunk.Space) -> np.ndarray:
    """The row of every body of the space's list; -1: it has none."""
    return np.array([store.row_of(address_of(b._body)) for b in space.bodies], np.int64)


def _awake(store: Store, space: pymunk.Space) -> np.ndarray:
    """`Memory.awake`."""
    place = np.full(len(store.tables.bodies) + 1, -1)
    place[_body_rows(store, space)] = np.arange(len(space.bodies))
    places = place[store.tables.awake[: store.tables.counters[AWAKE]]]
    return places[places >= 0]


def recall(store: Store, space: pymunk.Space, memory: Memory) -> None:
    """Give the tables of a copied space what its original remembers. Its bodies and shapes are entered already."""
    for body, centre in zip(space.bodies, memory.centres):
        if not np.array_equal(centre_of(body), centre):
            put_centre(body, *centre)
            space.reindex_shapes_for_body(body)
    mine = np.array([store.slots[shape._hashid] for shape in space.shapes], np.int64)
    known = memory.rows >= 0
    row_of = np.full(len(memory.shapes) + 1, -1)  # its row here by its row there; the last for none
    row_of[memory.rows[known]] = mine[known]
    for name in _SHAPE:
        store.tables.shapes[name][mine[known]] = memory.shapes[name][memory.rows[known]]
    if len(memory.pairs) > len(store.tables.pairs):
        store.grow_pairs(len(memory.pairs))
    if len(memory.regions) > len(store.tables.regions):
        store.grow_regions(len(memory.regions))
    pairs, regions = memory.pairs.copy(), memory.regions.copy()
    used = pairs["a"] >= 0
    for name in ("a", "b"):
        pairs[name][used] = row_of[pairs[name][used]]
    # as many of each as there, which may be fewer than here: what goes with them is of their size
    store.tables = store.tables._replace(
        pairs=pairs,
        regions=regions,
        near=memory.near.copy(),
        told=np.zeros(len(pairs), np.int32),
    )
    store.renew_rows()
    store.sync()
    tables = store.tables
    for i in mine[known]:
        put_in_tree(tables, int(i), int(tables.shapes[i]["tree"]))
    tables.bodies["since"] = np.inf
    tables.counters[_COUNTERS] = memory.counters[_COUNTERS]
    tables.counters[ASKED] = 0
    lost = used & ((pairs["a"] < 0) | (pairs["b"] < 0))
    for p in np.flatnonzero(lost):  # one of its shapes is gone
        end_pair(tables, int(p))
    rehash(tables)
    _take_arbiters(store, space)
    awake = _body_rows(store, space)[memory.awake]
    tables.bodies["awake"][awake] = 1
    tables.awake[: len(awake)] = awake
    tables.counters[AWAKE] = len(awake)
    drop_pairs(tables, -2)
    tables.counters[ANEW] = int(memory.counters[ANEW] or lost.any() or not known.all())
    for body, values in zip(space.bodies, memory.bodies):
        row = tables.bodies[store.row_of(address_of(body._body))]
        for name, value in zip(_BODY, values):
            row[name] = value
    store.state["before"] = memory.before
    for joint, impulse in zip(space.constraints, memory.joints):
        joint_impulse(joint)[:] = impulse
    _keep_apart(store, space)


def _take_arbiters(store: Store, space: pymunk.Space) -> None:
    """Pairs have the arbiters of the copy, not those of its original."""
    pairs = store.tables.pairs
    pairs["arbiter"] = 0
    used = np.flatnonzero(pairs["a"] >= 0)
    found = dict(zip(zip(pairs["a"][used].tolist(), pairs["b"][used].tolist()), used))
    one, other = ffi.new("cpShape *[1]"), ffi.new("cpShape *[1]")
    for arbiter in space._get_arbiters():
        lib.cpArbiterGetShapes(arbiter, one, other)
        a, b = (int(store.slots[lib.cpShapeGetHashID(shape[0])]) for shape in (one, other))
        p = found.get((a, b), found.get((b, a)))
        if p is not None:
            pairs[p]["arbiter"] = address_of(arbiter)


def _keep_apart(store: Store, space: pymunk.Space) -> None:
    """The bodies that joints keep from colliding, as `joints.take_joints` lists them: else pairs are searched anew."""
    store.grow_joints(len(space.constraints) + 1)
    tables, n = store.tables, 0
    for joint in space.constraints:
        rows = [store.row_of(address_of(body._body)) for body in (joint.a, joint.b)]
        if not joint.collide_bodies and min(rows) >= 0:
            tables.apart[n] = rows
            tables.bodies["joined"][rows] = 1
            n += 1
    tables.counters[APART] = n
    store.sync()
