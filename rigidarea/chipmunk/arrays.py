"""The tables of one attached space: numpy arrays that grow by doubling, and the record by which they are found.

Nothing here knows pymunk's objects: shapes are Chipmunk's integer ids, bodies are addresses.

Tables grow by transactions: new arrays in a copy of the store are filled, then put in the place of the old ones
(`publish`) by two stores between which Python calls nothing. What is raised on the way, a MemoryError or an interrupt,
leaves the old ones as they were.
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from typing import Any

import numpy as np
from pymunk._chipmunk_cffi import ffi

from ..contact.active import ISLAND, QUEUED
from ..contact.dtypes import BODY, NEIGHBOURS, PAIR, REGION, ROW, SHAPE
from ..contact.joint_record import JOINT
from ..contact.preconditioner import FACTOR, MOBILITY
from ..contact.space_record import _ARRAYS as ARRAYS
from ..contact.space_record import LASTING, OFFSETS, STATE, enter_bodies
from ..contact.tables import (
    COUNTERS,
    FREE_BODY,
    FREE_PAIR,
    FREE_REGION,
    FREE_SHAPE,
    MORE_BODIES,
    MORE_JOINTS,
    MORE_KEPT,
    MORE_PAIRS,
    MORE_REGIONS,
    MORE_SHAPES,
    MORE_SLOTS,
    MORE_WORK,
    SHAPES,
    Tables,
    append_free,
    rehash,
)
from ..contact.tree import FREE, NODE
from ..geometry.overlap import enlarged, new_work
from ..geometry.pool import HEAD, HasRings, Pool
from .chipmunk_outlines import Forms
from .structs import address_of

#: Joints for which there is room from the start, and in `apart`, where any of them may be: whose bodies do not collide.
JOINTS = 8

#: Arrays of a `Store` itself that the record has.
_OWN = ("slots", "body_keys", "body_rows", "heard_alone", "heard_pairs")


class Store:
    """Growing tables of one space, and `state`, the record (1,) STATE of where they are."""

    def __init__(self, bodies: int = 16, shapes: int = 16, pairs: int = 64, regions: int = 32) -> None:
        """For how many there is room from the start."""
        self.state = np.zeros(1, STATE)
        self._words = self.state.view(np.int64)  # field by field a record takes ten times as long
        self.at = int(self.state.ctypes.data)
        self.state["own_at"] = self.at
        self._listed: Sequence[np.ndarray | None] = [None] * len(ARRAYS)  # whose addresses it has
        self.pool = Pool(
            np.zeros((256, 2)),
            np.zeros(256, np.int32),
            np.zeros(256, np.int32),
            np.zeros((64, 2), np.int32),
            np.zeros((512, 4)),
            np.zeros((256, 4)),
            np.zeros(64, HEAD),
        )
        self.forms = Forms(
            np.zeros((64, 3)),
            np.zeros(64, np.int32),
            np.zeros(64, np.int32),
            np.zeros((64, 2), np.int32),
            np.zeros(512),
            np.full(256, -1, np.int32),
            np.zeros(5, np.int64),
        )
        self.work = new_work()
        self.tables = Tables(
            np.zeros(bodies, BODY),
            np.zeros(shapes, SHAPE),
            np.zeros(0, PAIR),
            np.zeros(0, REGION),
            np.zeros(0, ROW),
            np.zeros(0, FACTOR),
            np.zeros(bodies, MOBILITY),
            np.zeros(bodies, ISLAND),
            np.zeros(0, QUEUED),
            np.zeros(bodies, np.int32),
            np.zeros(bodies, np.int32),
            np.zeros(2 * bodies, np.int32),
            np.zeros(shapes, np.int32),
            np.zeros(shapes, np.int32),
            np.zeros(0, np.int32),
            np.zeros(0, NODE),
            np.array([-1, -1, -1], np.int32),
            np.zeros(1, NEIGHBOURS),
            np.zeros((JOINTS, 2), np.int32),
            np.zeros(JOINTS, JOINT),
            np.full(64, -1, np.int32),
            np.zeros(COUNTERS, np.int64),
        )
        self.tables.counters[[FREE_REGION, FREE_PAIR, FREE_SHAPE, FREE_BODY]] = -1
        self.slots = np.full(64, -1, np.int32)  # Chipmunk's shape id -> row of tables.shapes
        size = max(64, power_above(2 * bodies))
        self.body_keys = np.zeros(size, np.uint64)  # hash table: Chipmunk's body -> row of tables.bodies
        self.body_rows = np.zeros(size, np.int32)
        self.heard_alone = np.zeros(0, np.uint64)  # collision types that have callbacks with any other
        self.heard_pairs = np.zeros(0, np.uint64)  # and with one other
        # room for a copy of what a frame changes, and for places: made when a frame asks for it (`MORE_KEPT`)
        self._kept: dict[str, np.ndarray] = {"kept": np.zeros(0, np.uint8), "seen": np.zeros((0, 3))}
        self._keeps = False
        self._outlines: dict[int, tuple[int, HasRings]] = {}  # by id: number, and what keeps the id
        self._most = (0, 0)  # points and rings of the largest outline
        self._used = 0  # how many outlines had a shape, or might have, when that was last asked
        self._grow_nodes(shapes)
        self.grow_pairs(pairs)
        self.grow_regions(regions)
        self.sync()

    def sizes(self) -> dict[str, int]:
        """What each array takes (bytes)."""
        arrays = {**self.pool._asdict(), **self.work._asdict(), **self.tables._asdict(), **self._kept}
        own = {name: getattr(self, name) for name in ("state", *_OWN)}
        return {name: array.nbytes for name, array in {**arrays, **own, **self._named_forms()}.items()}

    def _named_forms(self) -> dict[str, np.ndarray]:
        return {f"form_{name}": array for name, array in self.forms._asdict().items()}

    def note_layout(self, offsets: dict[str, int]) -> None:
        """Write Chipmunk's layout (`chipmunk.layout`) into the state record."""
        first = 2 * len(ARRAYS)
        self._words[first : first + len(OFFSETS)] = [offsets[name] for name in OFFSETS]

    def publish(self, new: Store, **facts: int) -> None:
        """Put a changed draft in the place of what there is. facts: fields of the state record that change with it."""
        own, words = self._words, new._record()
        for name, value in facts.items():
            words.view(STATE)[name] = value
        own[:], self.__dict__ = words, new.__dict__

    def sync(self) -> None:
        """Write the arrays' addresses and sizes into the state record."""
        self._words[:] = self._record()

    def _record(self) -> np.ndarray:
        """The words of the state record of these arrays."""
        tables = self.tables._asdict()
        if self._keeps:
            room = room_to_keep({name: array.nbytes for name, array in tables.items()})
            if self._kept["kept"].size != room:
                self._kept = {
                    "kept": np.zeros(room, np.uint8),
                    "seen": np.zeros((len(self.tables.bodies), 3)),
                }
        own = {name: getattr(self, name) for name in _OWN} | self._named_forms()
        arrays = {**self.pool._asdict(), **self.work._asdict(), **tables, **own, **self._kept}
        words, known = self._words.copy(), self._listed
        self._listed = listed = [arrays[name] for name in ARRAYS]
        for i, (array, before) in enumerate(zip(listed, known)):
            if array is not before:  # (numpy itself takes three times as long to say where an array is)
                words[i], words[len(ARRAYS) + i] = address_of(ffi.from_buffer(array)), len(array)
        return words

    def grow(self) -> None:
        """Make the room that machine code has asked for (counters MORE_...), all of it or none; of pairs and regions
        an eighth more."""
        new, counters = copy.copy(self), self.tables.counters.copy()
        new.tables = self.tables._replace(counters=counters)  # what grows is a new array
        wanted = [MORE_PAIRS, MORE_REGIONS, MORE_JOINTS, MORE_WORK, MORE_KEPT]
        wanted += [MORE_SHAPES, MORE_BODIES, MORE_SLOTS]
        pairs, regions, joints, work, kept, shapes, bodies, slots = counters[wanted].tolist()
        counters[wanted] = 0
        new._keeps = self._keeps or kept > 0
        if pairs > 0:
            new.grow_pairs((len(new.tables.pairs) + pairs) * 9 // 8)
        if regions > 0:
            new.grow_regions((len(new.tables.regions) + regions) * 9 // 8)
        if joints > 0:
            new.grow_joints(len(new.tables.joints) + joints)
        if work > 0:
            new.grow_work()
        if shapes > 0:
            new.grow_shapes(max(len(new.tables.shapes) + shapes, 2 * len(new.tables.shapes)))
        if bodies > 0:
            new.grow_bodies(max(len(new.tables.bodies) + bodies, 2 * len(new.tables.bodies)))
        if slots > 0:
            new.slots = longer(new.slots, max(len(new.slots) + slots, 2 * len(new.slots)), -1)
        self.publish(new)

    def grow_pairs(self, n: int) -> None:
        """Room for n pairs, the new ones free and the last to be taken."""
        old, counters = self.tables.pairs, self.tables.counters
        new = np.zeros(n, PAIR)
        new[: len(old)] = old
        new["a"][len(old) :] = -1
        append_free(new["next"], counters, FREE_PAIR, len(old))
        size = 64
        while size < 2 * len(new):  # at most half full
            size *= 2
        near = np.zeros(2 * len(new) + 1, NEIGHBOURS)
        near[: len(self.tables.near)] = self.tables.near
        told = np.zeros(len(new), np.int32)
        told[: len(old)] = self.tables.told
        self.tables = self.tables._replace(pairs=new, near=near, told=told, table=np.full(size, -1, np.int32))
        if len(old):  # (handing all tables over takes longer than making them)
            rehash(self.tables)

    def grow_regions(self, n: int) -> None:
        """Room for n regions, the new ones free and the last to be taken."""
        old, counters = self.tables.regions, self.tables.counters
        new = np.zeros(n, REGION)
        new[: len(old)] = old
        new["stamp"][len(old) :] = -1
        append_free(new["next"], counters, FREE_REGION, len(old))
        self.tables = self.tables._replace(regions=new)
        self.renew_rows()

    def renew_rows(self) -> None:
        """A row for every region and every joint: no frame remembers them."""
        size = len(self.tables.regions) + len(self.tables.joints)
        rows, factors, queue = np.zeros(size, ROW), np.zeros(size, FACTOR), np.zeros(size, QUEUED)
        self.tables = self.tables._replace(rows=rows, factors=factors, queue=queue)

    def grow_joints(self, n: int) -> None:
        """Room for n joints."""
        if n > len(self.tables.joints):
            apart = longer(self.tables.apart, 2 * n)
            self.tables = self.tables._replace(apart=apart, joints=longer(self.tables.joints, 2 * n))
            self.renew_rows()

    def grow_work(self) -> None:
        """Twice the room for crossings."""
        points, rings = self._most
        self.work = enlarged(self.work, 2 * points, 2 * rings)

    def grow_shapes(self, n: int) -> None:
        """Room for n shapes."""
        grown = {name: longer(getattr(self.tables, name), n) for name in ("shapes", "movers", "asked")}
        self.tables = self.tables._replace(**grown)
        self._grow_nodes(n)

    def grow_bodies(self, n: int) -> None:
        """Room for n bodies."""
        grown = {name: longer(getattr(self.tables, name), n) for name in ("bodies", "live")}
        grown["awake"] = longer(self.tables.awake, 2 * n)
        mobility, islands, members = np.zeros(n, MOBILITY), np.zeros(n, ISLAND), np.zeros(n, np.int32)
        self.tables = self.tables._replace(**grown, mobility=mobility, islands=islands, members=members)
        used, keys, rows = self.body_keys != 0, self.body_keys, self.body_rows
        self.body_keys, self.body_rows = (
            np.zeros(power_above(2 * n), np.uint64),
            np.zeros(power_above(2 * n), np.int32),
        )
        enter_bodies(self.body_keys, self.body_rows, keys[used], rows[used])

    def _grow_nodes(self, shapes: int) -> None:
        """Room for so many shapes in the trees."""
        old, roots = self.tables.nodes, self.tables.roots.copy()
        new = longer(old, 2 * shapes)
        new["parent"][len(old) :] = np.arange(len(old) + 1, len(new) + 1)
        new["parent"][-1] = roots[FREE]
        roots[FREE] = len(old)
        self.tables = self.tables._replace(nodes=new, roots=roots)

    def knows(self, ident: int) -> bool:
        """Whether shape `ident` has an outline here."""
        return 0 <= ident < len(self.slots) and bool(self.slots[ident] >= 0)

    def row_of(self, address: int) -> int:
        """The row of Chipmunk's body at `address`; -1: not known."""
        mask = len(self.body_keys) - 1
        i = (address >> 4) & mask
        while (key := int(self.body_keys[i])) != 0:
            if key == address:
                return int(self.body_rows[i])
            i = (i + 1) & mask
        return -1

    @property
    def known_shapes(self) -> np.ndarray:
        """The rows of tables.shapes in use (outline -1: free again)."""
        return self.tables.shapes[: int(self.tables.counters[SHAPES])]


def load_growth() -> None:
    """Load what makes room: else the first frame that asks for it would wait for the disk."""
    store = Store()
    store.tables.counters[[MORE_PAIRS, MORE_REGIONS, MORE_SHAPES, MORE_BODIES, MORE_SLOTS]] = 1
    store.grow()


def room_to_keep(sizes: dict[str, int]) -> int:
    """How many bytes `store.keep_tables` wants at the most of tables of these sizes (bytes)."""
    return sum(-(-sizes[name] // 8) * 8 for name in (*LASTING, "counters"))


def longer(array: np.ndarray, n: int, value: int = 0) -> Any:
    """An array of n rows that begins as this one."""
    new = (
        np.full((n, *array.shape[1:]), value, array.dtype)
        if value
        else np.zeros((n, *array.shape[1:]), array.dtype)
    )
    new[: len(array)] = array
    return new


def power_above(n: int) -> int:
    """The smallest power of two that is no less than n."""
    return 1 << (n - 1).bit_length()
