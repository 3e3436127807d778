"""What a copy of an attached space is told, so that it goes on as its original does.

All that outlives a frame in our tables, but for what says whose row it is, and what pymunk's copies forget: impulses
of joints, who sleeps. Pairs keep their numbers: what comes first where two are equally high is decided by them. The
trees of boxes keep their form: in which order new pairs are found is decided by that.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pymunk
from pymunk._chipmunk_cffi import ffi, lib

from ..contact.broad import ask_about, drop_gone, put_in_tree
from ..contact.dtypes import BODY, SHAPE
from ..contact.space_record import LASTING, LASTING_STATE
from ..contact.tables import (
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
    JOINTS,
    MOVERS,
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
from .snapshots import idle_of, joint_numbers, listed, put_to_sleep, who_sleeps
from .structs import address_of, centre_of, put_centre


class Memory(NamedTuple):
    """Arrays of a `Store`; shapes and joints by their places in the space's lists."""

    tables: dict[str, np.ndarray]
    """`store.LASTING`, and the counters."""
    rows: np.ndarray
    """(n,) int: each shape's row; -1: it has come since the last frame."""
    bodies: np.ndarray
    """(n,) int: each body's row, the static one's last."""
    state: dict[str, float]
    """`store.LASTING_STATE`."""
    joints: list[np.ndarray]
    """Impulses, and what they are made of: pymunk's copies measure a pin's length and a ratchet's angle anew."""
    held: np.ndarray
    """(n,) bool: whether the solve moves it; who is new is moved by Chipmunk in the first frame."""
    centres: np.ndarray
    """(n, 2) where each body's centre of gravity is: pymunk restores a body's place before its centre of gravity, and
    leaves one elsewhere whose centre is not its origin."""
    idle: np.ndarray
    """(n,) for how long each body has idled (time)."""
    sleepers: list[list[int]]
    """The groups that sleep, by the bodies' places in the space's list: pymunk's copies wake them."""
    listed: list[int]
    """The bodies that do not, as Chipmunk lists them."""
    joint_order: list[int]
    """The joints as Chipmunk lists them (not sleepers'), by their places in the space's list; -1: our own."""


_COUNTERS = [FREE_REGION, FREE_REGIONS, FREE_PAIR, FREE_PAIRS, SEARCH, SUBSTEP, NEAR, BOXED]
_COUNTERS += [UNSORTED, TURNED, COUNTED, USED_PAIRS, USED_REGIONS]
#: What of a row is the copy's own: whose it is, and what is made anew.
_OWN = {
    *(
        "address",
        "listed",
        "entered",
        "held",
        "island",
        "joined",
        "joints",
        "sum_of_joints",
        "unmeasured",
        "awake",
    ),
    *("ident", "outline", "mirror", "body", "heard", "epoch", "proxy"),
}
_COPIED = {
    "bodies": [name for name in BODY.names or () if name not in _OWN],
    "shapes": [
        name for name in SHAPE.names or () if name not in _OWN and name not in ("asked", "leaf", "tree")
    ],
}


def remember(store: Store, space: pymunk.Space) -> Memory:
    """What of a space's tables, and of its bodies and joints, the next frame starts from."""
    rows = [int(store.slots[s._hashid]) if store.knows(s._hashid) else -1 for s in space.shapes]
    tables = store.tables
    return Memory(
        {name: getattr(tables, name).copy() for name in (*LASTING, "counters")},
        np.array(rows, np.int64),
        _body_rows(store, space),
        {name: store.state[name][0].item() for name in LASTING_STATE},
        [np.concatenate(joint_numbers(joint)) for joint in space.constraints],
        np.array([_is_held(store, body) for body in space.bodies], bool),
        np.array([centre_of(b).copy() for b in space.bodies]),
        *_who_sleeps(space),
        _joint_order(space),
    )


def _who_sleeps(space: pymunk.Space) -> tuple[np.ndarray, list[list[int]], list[int]]:
    """`Memory.idle`, `sleepers`, `listed`."""
    place = {address_of(body._body): i for i, body in enumerate(space.bodies)}
    groups = [[place[address] for address in group] for group in who_sleeps(space)]
    order = [place[address] for address in listed(space, "space_bodies").tolist()]
    return np.array([idle_of(body)[0] for body in space.bodies]), groups, order


def _joint_order(space: pymunk.Space) -> list[int]:
    """`Memory.joint_order`."""
    place = {address_of(joint._constraint): i for i, joint in enumerate(space.constraints)}
    return [place.get(address, -1) for address in listed(space, "space_constraints").tolist()]


def _put_to_sleep(space: pymunk.Space, memory: Memory) -> None:
    addresses = [address_of(body._body) for body in space.bodies]
    put_to_sleep([[addresses[i] for i in group] for group in memory.sleepers])
    for body, idle in zip(space.bodies, memory.idle):
        idle_of(body)[0] = idle
    listed(space, "space_bodies")[:] = [addresses[i] for i in memory.listed]
    joints, order = listed(space, "space_constraints"), _joint_order(space)
    if sorted(order) == sorted(memory.joint_order):
        now = dict(zip(order, joints.tolist()))
        joints[:] = [now[i] for i in memory.joint_order]


def _body_rows(store: Store, space: pymunk.Space) -> np.ndarray:
    """The row of every body of the space's list, and of its static one; -1: it has none."""
    bodies = [*space.bodies, space.static_body]
    return np.array([store.row_of(address_of(body._body)) for body in bodies], np.int64)


def _is_held(store: Store, body: pymunk.Body) -> bool:
    off = store.state[0]
    return bool(ffi.cast("uintptr_t *", body._body)[int(off["body_position_func"]) // 8] == off["hold_at"])


def recall(store: Store, space: pymunk.Space, memory: Memory) -> None:
    """Give the tables of a copied space what its original remembers. Its bodies and shapes are entered already."""
    for body, centre in zip(space.bodies, memory.centres):
        if not np.array_equal(centre_of(body), centre):
            put_centre(body, *centre)
            space.reindex_shapes_for_body(body)
    mine = np.array([store.slots[shape._hashid] for shape in space.shapes], np.int64)
    known, there = memory.rows >= 0, memory.tables
    row_of = _numbers(len(there["shapes"]), memory.rows[known], mine[known])
    store.grow_shapes(max(len(there["shapes"]), len(store.tables.shapes)))
    bodies, shapes = _body_rows(store, space), store.tables.shapes
    both = (bodies >= 0) & (memory.bodies >= 0)
    body_of = _numbers(len(there["bodies"]), memory.bodies[both], bodies[both])
    for name in _COPIED["bodies"]:
        store.tables.bodies[name][bodies[both]] = there["bodies"][name][memory.bodies[both]]
    for name in _COPIED["shapes"]:
        shapes[name][mine[known]] = there["shapes"][name][memory.rows[known]]
    if len(there["pairs"]) > len(store.tables.pairs):
        store.grow_pairs(len(there["pairs"]))
    if len(there["regions"]) > len(store.tables.regions):
        store.grow_regions(len(there["regions"]))
    pairs, regions, near = (there[name].copy() for name in ("pairs", "regions", "near"))
    used = pairs["a"] >= 0
    for name in ("a", "b"):
        pairs[name][used] = row_of[pairs[name][used]]
    listed = near[: there["counters"][NEAR]]
    for name in ("a", "b"):
        listed[name] = shapes["body"][pairs[name][listed["pair"]]]
    # as many of each as there, which may be fewer than here: what goes with them is of their size
    told = np.zeros(len(pairs), np.int32)
    store.tables = store.tables._replace(pairs=pairs, regions=regions, near=near, told=told)
    nodes = there["nodes"].copy()
    leaves = (nodes["left"] < 0) & (nodes["owner"] >= 0)
    nodes["owner"][leaves] = row_of[nodes["owner"][leaves]]
    if known.all():
        store.tables = store.tables._replace(nodes=nodes, roots=there["roots"].copy())
        for name in ("leaf", "tree"):
            shapes[name][mine] = there["shapes"][name][memory.rows]
    store.renew_rows()
    store.sync()
    tables = store.tables
    if not known.all():  # copied within a step in which some have come
        for i, row in zip(mine[known], memory.rows[known]):
            put_in_tree(tables, int(i), int(there["shapes"]["tree"][row]))
    counters = there["counters"]
    tables.counters[_COUNTERS] = counters[_COUNTERS]
    movers = row_of[there["movers"][: counters[MOVERS]]]
    movers = movers[movers >= 0]
    tables.movers[: len(movers)], tables.counters[MOVERS] = movers, len(movers)
    tables.counters[ASKED] = 0
    asked = row_of[there["asked"][: counters[ASKED]]]
    for row in asked[asked >= 0].tolist():
        ask_about(tables, row)
    lost = used & ((pairs["a"] < 0) | (pairs["b"] < 0))
    for p in np.flatnonzero(lost):  # one of its shapes is gone
        end_pair(tables, int(p))
    rehash(tables)
    take_arbiters(store, space)
    awake = body_of[there["awake"][: counters[AWAKE]]]
    awake = awake[awake >= 0]
    tables.bodies["awake"][awake] = 1
    tables.awake[: len(awake)] = awake
    tables.counters[AWAKE] = len(awake)
    drop_gone(tables)
    tables.counters[ANEW] = int(counters[ANEW] or lost.any() or not known.all())
    for name, value in memory.state.items():
        store.state[name] = value
    off = store.state[0]
    for body in (body for body, held in zip(space.bodies, memory.held) if not held):
        words = ffi.cast("uintptr_t *", body._body)
        if words[int(off["body_position_func"]) // 8] == off["hold_at"]:
            words[int(off["body_position_func"]) // 8] = int(off["position_func"])
    for joint, impulse in zip(space.constraints, memory.joints):
        made_of, did = joint_numbers(joint)
        made_of[:], did[:] = impulse[: len(made_of)], impulse[len(made_of) :]
    _keep_apart(store, space, memory)
    _put_to_sleep(space, memory)
    if _joint_order(space) == memory.joint_order:  # else they are read as new ones
        n = int(counters[JOINTS])
        joints = store.tables.joints
        joints[:n] = there["joints"][:n]
        for name in ("a", "b"):
            joints[name][:n] = body_of[there["joints"][name][:n]]
        store.tables.counters[JOINTS] = n


def _numbers(n: int, there: np.ndarray, here: np.ndarray) -> np.ndarray:
    """(n + 1,): the row here of each of n rows there; -1 for none, which is also the last."""
    rows = np.full(n + 1, -1)
    rows[there] = here
    return rows


def take_arbiters(store: Store, space: pymunk.Space) -> None:
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


def _keep_apart(store: Store, space: pymunk.Space, memory: Memory) -> None:
    """The bodies that joints keep from colliding, as `joints.take_joints` lists them: else pairs are sorted anew."""
    store.grow_joints(len(space.constraints) + 1)
    tables, n, joints = store.tables, 0, list(space.constraints)
    for joint in (joints[i] for i in memory.joint_order if i >= 0):
        rows = [store.row_of(address_of(body._body)) for body in (joint.a, joint.b)]
        if not joint.collide_bodies and min(rows) >= 0:
            tables.apart[n] = rows
            tables.bodies["joined"][rows] = 1
            n += 1
    tables.counters[APART] = n
    store.sync()
