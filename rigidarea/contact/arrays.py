"""The tables of one attached space: numpy arrays that grow by doubling, and the record by which they are found.

Nothing here knows pymunk: shapes are Chipmunk's integer ids, bodies are addresses.

Tables change by transactions: a copy (`draft`) is changed, then put in their place (`publish`) by two stores between
which Python calls nothing. What is raised on the way, a MemoryError or an interrupt, leaves the old ones as they were.
"""

from __future__ import annotations

import copy
from collections.abc import Iterable
from typing import Any

import numpy as np

from ..kernel.broad import extents
from ..kernel.conjugate import FACTOR, MOBILITY
from ..kernel.overlap import enlarged, fits, new_work
from ..kernel.pool import HEAD, HasRings, Pool, pack
from ..kernel.row import ROW
from ..kernel.tables import (
    ANEW,
    BODIES,
    BODY,
    COUNTERS,
    FREE_PAIR,
    FREE_PAIRS,
    FREE_REGION,
    FREE_REGIONS,
    MORE_JOINTS,
    MORE_PAIRS,
    MORE_REGIONS,
    MORE_WORK,
    NEAR,
    NEIGHBOURS,
    PAIR,
    REGION,
    SHAPE,
    SHAPES,
    Tables,
    end_pair,
    new_pair,
    rehash,
)
from ..store import JOINT, KEPT, STATE, enter_bodies

#: Joints for which there is room from the start, and in `apart`, where any of them may be: whose bodies do not collide.
JOINTS = 8
#: Crossings for which there is room from the start, where the largest outline has many points: more come with use.
MOST_CROSSINGS = 4096


def _append_free(following: np.ndarray, counters: np.ndarray, head: int, first: int) -> None:
    """Rows from `first` on at the end of a free list: who is taken next does not depend on how large the table is."""
    following[first:] = np.arange(first + 1, len(following) + 1)
    following[-1] = -1
    last = int(counters[head])
    if last < 0:
        counters[head] = first
        return
    while following[last] >= 0:
        last = int(following[last])
    following[last] = first


class Store:
    """Growing tables of one space, and `state`, the record (1,) STATE of where they are."""

    def __init__(self) -> None:
        self.state = np.zeros(1, STATE)
        self._fill = {"points": 0, "rings": 0, "boxes": 0, "heads": 0, "shapes": 0}
        self.pool = Pool(
            np.zeros((64, 2)),
            np.zeros(64, np.int32),
            np.zeros(64, np.int32),
            np.zeros((16, 2), np.int32),
            np.zeros((64, 4)),
            np.zeros((64, 4)),
            np.zeros(16, HEAD),
        )
        self.work = new_work()
        self.tables = Tables(
            np.zeros(16, BODY),
            np.zeros(16, SHAPE),
            np.zeros(0, PAIR),
            np.zeros(0, REGION),
            np.zeros(0, ROW),
            np.zeros(0, FACTOR),
            np.zeros(16, MOBILITY),
            np.zeros(16, np.int32),
            np.zeros(1, NEIGHBOURS),
            np.zeros((JOINTS, 2), np.int32),
            np.zeros(0, np.int32),
            np.full(64, -1, np.int64),
            np.zeros(64, np.int32),
            np.zeros(COUNTERS, np.int64),
        )
        self.tables.counters[[FREE_REGION, FREE_PAIR]] = -1
        self.shapes: dict[int, Any] = {}  # the caller's shapes, by Chipmunk's id
        self.forms: dict[int, Any] = {}  # and how they looked when they were entered
        self.owners: dict[int, Any] = {}  # the bodies at the addresses in the tables: they live as long
        self.slots = np.full(64, -1, np.int32)  # Chipmunk's shape id -> row of tables.shapes
        self.body_keys = np.zeros(64, np.uint64)  # hash table: Chipmunk's body -> row of tables.bodies
        self.body_rows = np.zeros(64, np.int32)
        self.joints = np.zeros(JOINTS, JOINT)
        self._kept: dict[str, np.ndarray] = {}  # room for a copy of what a frame changes, and for places
        self._outlines: dict[int, tuple[int, HasRings]] = {}  # by id: number, and what keeps the id
        self._free: list[int] = []  # rows of shapes that are gone
        self._bodies: dict[int, int] = {}  # Chipmunk's body -> row
        self._free_bodies: list[int] = []
        self._left: list[int] = []  # rows of bodies that have left, until no shape's row has their number
        self._most = (0, 0)  # points and rings of the largest outline
        self.grow_pairs(64)
        self.grow_regions(64)
        end_pair(self.tables, new_pair(self.tables, 0, 1))  # compiled now, not in a frame
        rehash(self.tables)
        self.sync()

    def sizes(self) -> dict[str, int]:
        """What each array takes (bytes)."""
        arrays = {**self.pool._asdict(), **self.work._asdict(), **self.tables._asdict(), **self._kept}
        own = {name: getattr(self, name) for name in ("state", "slots", "body_keys", "body_rows", "joints")}
        return {name: array.nbytes for name, array in {**arrays, **own}.items()}

    def draft(self) -> Store:
        """A copy, to be changed and published. Of what only grows at its end, and of scratch, there is one."""
        new = copy.copy(self)
        new.tables = Tables(*(array.copy() for array in self.tables))
        new.slots = self.slots.copy()
        for name in (
            "shapes",
            "forms",
            "_fill",
            "_outlines",
            "_free",
            "owners",
            "_bodies",
            "_free_bodies",
            "_left",
        ):
            setattr(new, name, getattr(self, name).copy())
        return new

    def publish(self, new: Store, **facts: int) -> None:
        """Put a changed draft in the place of what there is. facts: fields of the state record that change with it."""
        record = new._record()
        for name, value in facts.items():
            record[name] = value
        self.state[0], self.__dict__ = record, new.__dict__

    def sync(self) -> None:
        """Write the arrays' addresses and sizes into the state record."""
        self.state[0] = self._record()

    def _record(self) -> np.record:
        """The state record of these arrays."""
        tables = self.tables._asdict()
        for name in KEPT:
            if len(self._kept.get(f"kept_{name}", ())) != len(tables[name]):
                self._kept = {**self._kept, f"kept_{name}": np.zeros_like(tables[name])}
        if len(self._kept.get("seen", ())) != len(self.tables.bodies):
            self._kept = {**self._kept, "seen": np.zeros((len(self.tables.bodies), 3))}
        own = {name: getattr(self, name) for name in ("slots", "body_keys", "body_rows", "joints")}
        arrays = {**self.pool._asdict(), **self.work._asdict(), **tables, **own, **self._kept}
        record: np.record = self.state.copy()[0]
        for name, array in arrays.items():
            record[f"{name}_at"] = array.ctypes.data
            record[f"{name}_n"] = len(array)
        return record

    def grow(self) -> None:
        """Make the room that machine code has asked for (counters MORE_...), all of it or none."""
        new = self.draft()
        counters = new.tables.counters
        pairs, regions, joints, work = (
            int(counters[k]) for k in (MORE_PAIRS, MORE_REGIONS, MORE_JOINTS, MORE_WORK)
        )
        counters[[MORE_PAIRS, MORE_REGIONS, MORE_JOINTS, MORE_WORK]] = 0
        if pairs > 0:
            new.grow_pairs(len(new.tables.pairs) + pairs)
        if regions > 0:
            new.grow_regions(len(new.tables.regions) + regions)
        if joints > 0:
            new.grow_joints(len(new.joints) + joints)
        if work > 0:
            new.grow_work()
        self.publish(new)

    def grow_pairs(self, least: int = 0) -> None:
        """Twice the pairs (at least `least`), the new ones free and the last to be taken."""
        old, counters = self.tables.pairs, self.tables.counters
        new = np.zeros(max(least, 2 * len(old)), PAIR)
        new[: len(old)] = old
        new["a"][len(old) :] = -1
        _append_free(new["next"], counters, FREE_PAIR, len(old))
        counters[FREE_PAIRS] += len(new) - len(old)
        size = 64
        while size < 2 * len(new):  # at most half full
            size *= 2
        near = np.zeros(len(new) + 1, NEIGHBOURS)
        near[: len(self.tables.near)] = self.tables.near
        self.tables = self.tables._replace(
            pairs=new, near=near, keys=np.full(size, -1, np.int64), values=np.zeros(size, np.int32)
        )
        rehash(self.tables)

    def grow_regions(self, least: int = 0) -> None:
        """Twice the regions (at least `least`), the new ones free and the last to be taken."""
        old, counters = self.tables.regions, self.tables.counters
        new = np.zeros(max(least, 2 * len(old)), REGION)
        new[: len(old)] = old
        new["stamp"][len(old) :] = -1
        _append_free(new["next"], counters, FREE_REGION, len(old))
        counters[FREE_REGIONS] += len(new) - len(old)
        rows = np.zeros(len(new), ROW)
        rows[: len(self.tables.rows)] = self.tables.rows
        self.tables = self.tables._replace(regions=new, rows=rows, factors=np.zeros(len(new), FACTOR))

    def grow_joints(self, n: int) -> None:
        """Room for n joints."""
        if n > len(self.joints):
            self.joints = np.zeros(2 * n, JOINT)
            self.tables = self.tables._replace(apart=np.zeros((2 * n, 2), np.int32))

    def grow_work(self) -> None:
        """Twice the room for crossings."""
        points, rings = self._most
        self.work = enlarged(self.work, 2 * points, 2 * rings)

    def outline(self, outline: HasRings) -> int:
        """The outline's number in the pool; packed the first time it is seen."""
        found = self._outlines.get(id(outline))
        if found is not None:
            return found[0]
        one = pack([outline])
        fill = self._fill
        room = {}
        for name, array in self.pool._asdict().items():
            key = "points" if name in ("following", "ring_of", "arcs") else name
            need = fill[key] + len(getattr(one, name))
            if need > len(array):
                bigger = np.zeros((max(need, 2 * len(array)), *array.shape[1:]), array.dtype)
                bigger[: len(array)] = array
                array = bigger
            room[name] = array
        self.pool = pool = Pool(**room)
        p, r, b, h = fill["points"], fill["rings"], fill["boxes"], fill["heads"]
        pool.points[p : p + len(one.points)] = one.points
        pool.arcs[p : p + len(one.points)] = one.arcs
        pool.following[p : p + len(one.points)] = one.following + p
        pool.ring_of[p : p + len(one.points)] = one.ring_of + r
        pool.rings[r : r + len(one.rings)] = one.rings + p
        pool.boxes[b : b + len(one.boxes)] = one.boxes
        pool.heads[h] = one.heads[0]
        pool.heads[h]["point"] += p
        pool.heads[h]["ring"] += r
        pool.heads[h]["box"] += b
        fill["points"] += len(one.points)
        fill["rings"] += len(one.rings)
        fill["boxes"] += len(one.boxes)
        fill["heads"] += 1
        self._most = (max(self._most[0], len(one.points)), max(self._most[1], len(one.rings)))
        crossings = max(len(self.work.cross), min(4 * self._most[0], MOST_CROSSINGS))
        if crossings > len(self.work.cross) or not fits(self.work, 2 * self._most[0], 2 * self._most[1]):
            self.work = new_work(2 * self._most[0], crossings, 2 * self._most[1])
        self._outlines[id(outline)] = h, outline
        return h

    def body(self, address: int) -> int:
        """The row of Chipmunk's body at `address`, made if there is none."""
        row = self._bodies.get(address)
        if row is None:
            row = self._free_bodies.pop() if self._free_bodies else int(self.tables.counters[BODIES])
            if row >= len(self.tables.bodies):
                bodies = np.zeros(2 * len(self.tables.bodies), BODY)
                bodies[: len(self.tables.bodies)] = self.tables.bodies
                mobility = np.zeros(len(bodies), MOBILITY)
                live = np.zeros(len(bodies), np.int32)
                self.tables = self.tables._replace(bodies=bodies, mobility=mobility, live=live)
            self.tables.counters[BODIES] = max(self.tables.counters[BODIES], row + 1)
            self.tables.bodies[row] = np.zeros((), BODY)
            self.tables.bodies[row]["address"], self.tables.bodies[row]["stamp"] = address, -1
            self._bodies[address] = row
        return row

    def shape(
        self,
        ident: int,
        address: int,
        outline: HasRings,
        mirror: HasRings | None,
        body: int,
        sensor: bool,
        extent: float,
        half: tuple[float, float],
    ) -> None:
        """Tell the tables which outline Chipmunk's shape `ident` has, on which body. Call `settle` after the last.

        address, body: Chipmunk's. mirror: the outline's other side, of a segment that has two. extent: its smallest
        extent (length). half: half the width and height of its box (length).
        """
        number = self.outline(outline)
        other = -1 if mirror is None else self.outline(mirror)
        if ident >= len(self.slots):
            slots = np.full(max(ident + 1, 2 * len(self.slots)), -1, np.int32)
            slots[: len(self.slots)] = self.slots
            self.slots = slots
        if self.knows(ident):
            self.forget([ident], ())
        row = self._free.pop() if self._free else self._fill["shapes"]
        if row == len(self.tables.shapes):
            shapes = np.zeros(2 * row, SHAPE)
            shapes[:row] = self.tables.shapes
            self.tables = self.tables._replace(shapes=shapes)
        self._fill["shapes"] = max(self._fill["shapes"], row + 1)
        self.slots[ident] = row
        shape = self.tables.shapes[row]
        shape["address"], shape["ident"], shape["body"] = address, ident, self.body(body)
        shape["outline"], shape["mirror"], shape["sensor"] = number, other, sensor
        shape["extent"], (shape["half_x"], shape["half_y"]) = extent, half
        shape["low_x"], shape["high_x"] = np.inf, -np.inf

    def settle(self) -> None:
        """After shapes or bodies have come or gone: everything that machine code finds them by."""
        counters = self.tables.counters
        self._free_bodies += self._left
        self._left = []
        counters[SHAPES], counters[ANEW] = self._fill["shapes"], 1
        order = self.tables.sorted  # as it is, the new rows behind it: hardly anything to sort
        order = np.concatenate((order, np.arange(len(order), self._fill["shapes"], dtype=np.int32)))
        self.tables = self.tables._replace(sorted=order)
        size = 64
        while size < 3 * len(self._bodies):
            size *= 2
        self.body_keys = np.zeros(size, np.uint64)
        self.body_rows = np.zeros(size, np.int32)
        enter_bodies(
            self.body_keys,
            self.body_rows,
            np.fromiter(self._bodies.keys(), np.uint64, len(self._bodies)),
            np.fromiter(self._bodies.values(), np.int32, len(self._bodies)),
        )
        extents(self.pool, self.tables)

    def forget(self, idents: Iterable[int], bodies: Iterable[int]) -> None:
        """Free what the tables hold of shapes and bodies that are gone; outlines nobody has go with them in time."""
        rows = [int(self.slots[ident]) for ident in idents if self.knows(ident)]
        for ident in idents:
            if self.knows(ident):
                self.slots[ident] = -1
        if rows:
            pairs = self.tables.pairs
            for p in np.flatnonzero(
                (pairs["a"] >= 0) & (np.isin(pairs["a"], rows) | np.isin(pairs["b"], rows))
            ):
                end_pair(self.tables, int(p))
            self.drop_near()
            rehash(self.tables)
        for row in rows:
            self.tables.shapes[row] = np.zeros((), SHAPE)
            self.tables.shapes[row]["outline"] = self.tables.shapes[row]["mirror"] = -1
            self._free.append(row)
        for address in bodies:
            row = self._bodies.pop(address)
            self.tables.bodies[row] = np.zeros((), BODY)
            self.tables.bodies[row]["stamp"] = -1
            self._free_bodies.append(row)
        known = self.known_shapes
        used = np.union1d(known["outline"], known["mirror"])
        used = used[used >= 0]
        if len(self._outlines) > 2 * len(used) + 64:
            self._repack(used)

    def drop_near(self) -> None:
        """Pairs that have ended are near no more."""
        tables = self.tables
        near = tables.near[: tables.counters[NEAR]]
        near = near[tables.pairs["a"][near["pair"]] >= 0]
        tables.near[: len(near)] = near
        tables.counters[NEAR] = len(near)

    def _repack(self, used: np.ndarray) -> None:
        """Only the outlines of these numbers stay, with new numbers."""
        kept = {number: outline for number, outline in self._outlines.values()}
        self._outlines = {}
        self._fill |= {"points": 0, "rings": 0, "boxes": 0, "heads": 0}
        self.pool = Pool(*(np.zeros_like(array) for array in self.pool))  # the old one may be in use
        renumbered = np.full(len(self.pool.heads) + 1, -1)  # the last for "none"
        for number in used:
            renumbered[number] = self.outline(kept[int(number)])
        rows = self.known_shapes
        for name in ("outline", "mirror"):
            rows[name] = renumbered[rows[name]]

    def knows(self, ident: int) -> bool:
        """Whether shape `ident` has an outline here."""
        return 0 <= ident < len(self.slots) and bool(self.slots[ident] >= 0)

    def leave(self, address: int) -> None:
        """Chipmunk's body at `address` is gone: its row is cleared. `settle` comes before the next frame."""
        row = self._bodies.get(address)
        if row is not None:
            self.tables.bodies[row] = np.zeros((), BODY)
            self.tables.bodies[row]["stamp"] = -1
            self._left.append(row)
            del self._bodies[address]
            self.owners.pop(address, None)

    def row_of(self, address: int) -> int:
        """The row of Chipmunk's body at `address`; -1: not known."""
        return self._bodies.get(address, -1)

    def known_bodies(self) -> set[int]:
        """Chipmunk's bodies that have a row."""
        return set(self._bodies)

    @property
    def known_shapes(self) -> np.ndarray:
        """The rows of tables.shapes in use (outline -1: free again)."""
        return self.tables.shapes[: self._fill["shapes"]]
