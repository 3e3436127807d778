"""The tables of one attached space, and the struct through which machine code finds them.

All arrays live here, as numpy arrays that grow by doubling. `Store.state` is one record of addresses and settings;
its own address is the space's user data, so that two attached spaces never meet. `load_*` are the other direction:
from that record back to the named tuples of arrays that the kernels take (as views without reference counting,
which alone would cost as much as clipping two boxes).
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from .kernel.jit import kernel
from .kernel.memory import array_at, record
from .kernel.overlap import LOOP, Work, enlarged, fits, new_work
from .kernel.pool import HEAD, HasRings, Pool, pack
from .kernel.region import REGION, Law
from .kernel.tables import (
    BODY,
    COUNTERS,
    FREE_PAIR,
    FREE_PAIRS,
    FREE_REGION,
    FREE_REGIONS,
    PAIR,
    SHAPE,
    Tables,
)

_ARRAYS = [
    *("points", "following", "ring_of", "rings", "boxes", "arcs", "heads"),
    *("stack", "cross", "param", "spot", "order", "done", "hit", "polygon", "label", "bows", "loops"),
    *("shapes", "bodies", "pairs", "regions", "counters", "slots"),
]
#: Offsets in Chipmunk's structs (bytes), see `chipmunk.py`.
OFFSETS = [
    *("body_position", "body_transform", "body_velocity", "body_spin", "body_force", "body_torque"),
    *("body_inverse_mass", "body_inverse_moment", "shape_surface_velocity"),
    *("arbiter_elasticity", "arbiter_friction", "arbiter_surface", "arbiter_data", "arbiter_shape_a"),
    *("arbiter_body_a", "arbiter_count", "arbiter_normal", "arbiter_process", "arbiter_state"),
    *("arbiter_handlers", "handler_post_solve", "no_post_solve", "unset_post_solve"),
    *("space_gravity", "body_angle", "body_position_func", "body_velocity_func", "position_func"),
    "velocity_func",
]
STATE = record(
    [(f"{name}_at", "u8") for name in _ARRAYS]
    + [(f"{name}_n", "i8") for name in _ARRAYS]
    + [(name, "i8") for name in OFFSETS]
    + [
        ("stiffness", "f8"),
        ("length", "f8"),
        ("exponent", "f8"),
        ("rest_speed", "f8"),
        ("followed", "f8"),
        ("law", "i8"),
        ("direction", "i8"),
        ("request", "i8"),  # what machine code asks Python for
        ("restoring", "i8"),  # pairs are to be looked up in a copied space's memory
        ("global_handler", "u8"),  # address of Chipmunk's global handler
        ("epoch", "u8"),  # upper half of what is kept in arbiters: whose pairs they are
        ("touched", "i8"),  # the last step in which anything touched
        # a run of frames (`frames.py`)
        ("phase", "f8"),
        ("max_steps", "i8"),
        ("shift_at", "u8"),  # address of `frames.shift_body`
        ("shift", "f8"),  # time by which it moves bodies
        ("settle", "i8"),  # 1: for good, so that everything sees it
        ("broken", "i8"),  # 1: a body was not finite when it settled
        ("ballistic", "i8"),  # 1: between contacts only gravity acts
        ("wanted", "i8"),  # steps that a frame would have needed, where max_steps was less; else 0
        ("stop", "i8"),  # 1: an error waits in Python
    ],
)


@kernel(inline="always")
def load_pool(s: Any) -> Pool:
    """The outlines of the space whose state record is s."""
    return Pool(
        array_at(s.points_at, (s.points_n, 2), np.float64),
        array_at(s.following_at, (s.following_n,), np.int32),
        array_at(s.ring_of_at, (s.ring_of_n,), np.int32),
        array_at(s.rings_at, (s.rings_n, 2), np.int32),
        array_at(s.boxes_at, (s.boxes_n, 4), np.float64),
        array_at(s.arcs_at, (s.arcs_n, 4), np.float64),
        array_at(s.heads_at, (s.heads_n,), HEAD),
    )


@kernel(inline="always")
def load_work(s: Any) -> Work:
    """The scratch of the space whose state record is s."""
    return Work(
        array_at(s.stack_at, (s.stack_n, 2), np.int32),
        array_at(s.cross_at, (s.cross_n, 3), np.int32),
        array_at(s.param_at, (s.param_n, 2), np.float64),
        array_at(s.spot_at, (s.spot_n, 2), np.float64),
        array_at(s.order_at, (s.order_n, s.cross_n), np.int32),
        array_at(s.done_at, (s.done_n,), np.uint8),
        array_at(s.hit_at, (s.hit_n,), np.uint8),
        array_at(s.polygon_at, (s.polygon_n, 2), np.float64),
        array_at(s.label_at, (s.label_n,), np.uint8),
        array_at(s.bows_at, (s.bows_n, 3), np.float64),
        array_at(s.loops_at, (s.loops_n,), LOOP),
    )


@kernel(inline="always")
def load_tables(s: Any) -> Tables:
    """The shapes, pairs and regions of the space whose state record is s."""
    return Tables(
        array_at(s.shapes_at, (s.shapes_n,), SHAPE),
        array_at(s.bodies_at, (s.bodies_n,), BODY),
        array_at(s.pairs_at, (s.pairs_n,), PAIR),
        array_at(s.regions_at, (s.regions_n,), REGION),
        array_at(s.counters_at, (s.counters_n,), np.int64),
    )


@kernel(inline="always")
def load_law(s: Any) -> Law:
    """The force law of the space whose state record is s."""
    return Law(s.stiffness, s.law, s.length, s.direction, s.exponent, s.rest_speed, s.followed)


class Store:
    """Growing tables of one space. Nothing here knows pymunk: shapes are Chipmunk's integer ids."""

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
            np.zeros(16, SHAPE),
            np.zeros(16, BODY),
            np.zeros(0, PAIR),
            np.zeros(0, REGION),
            np.zeros(COUNTERS, np.int64),
        )
        self.tables.counters[[FREE_REGION, FREE_PAIR]] = -1
        self.slots = np.full(64, -1, np.int32)  # Chipmunk's shape id -> row of tables.shapes
        self._outlines: dict[
            int, tuple[int, HasRings]
        ] = {}  # by id: number, and the object that keeps the id
        self._free: list[int] = []  # rows of shapes that are gone
        self._bodies: dict[int, tuple[int, int]] = {}  # by key: row, and how many shapes
        self._free_bodies: list[int] = []
        self._body_of: dict[int, int] = {}
        self._most = (0, 0)  # points and rings of the largest outline
        self.grow_pairs(64)
        self.grow_regions(64)
        self.sync()

    def sync(self) -> None:
        """Write the arrays' addresses and sizes into the state record."""
        arrays = {**self.pool._asdict(), **self.work._asdict(), **self.tables._asdict(), "slots": self.slots}
        state = self.state[0]
        for name in _ARRAYS:
            state[f"{name}_at"] = arrays[name].ctypes.data
            state[f"{name}_n"] = len(arrays[name])

    def grow_pairs(self, least: int = 0) -> None:
        """Twice the pairs (at least `least`), the new ones free."""
        old = self.tables.pairs
        new = np.zeros(max(least, 2 * len(old)), PAIR)
        new[: len(old)] = old
        new["next"][len(old) :] = np.arange(len(old) + 1, len(new) + 1)
        new["shape_a"][len(old) :] = -1
        new["next"][-1] = self.tables.counters[FREE_PAIR]
        self.tables.counters[FREE_PAIR] = len(old)
        self.tables.counters[FREE_PAIRS] += len(new) - len(old)
        self.tables = self.tables._replace(pairs=new)
        self.sync()

    def grow_regions(self, least: int = 0) -> None:
        """Twice the regions (at least `least`), the new ones free."""
        old = self.tables.regions
        new = np.zeros(max(least, 2 * len(old)), REGION)
        new[: len(old)] = old
        new["next"][len(old) :] = np.arange(len(old) + 1, len(new) + 1)
        new["stamp"][len(old) :] = -1
        new["next"][-1] = self.tables.counters[FREE_REGION]
        self.tables.counters[FREE_REGION] = len(old)
        self.tables.counters[FREE_REGIONS] += len(new) - len(old)
        self.tables = self.tables._replace(regions=new)
        self.sync()

    def grow_work(self) -> None:
        """Twice the room for crossings."""
        points, rings = self._most
        self.work = enlarged(self.work, 2 * points, 2 * rings)
        self.sync()

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
        if not fits(self.work, 2 * self._most[0], 2 * self._most[1]):
            self.work = new_work(2 * self._most[0], len(self.work.cross), 2 * self._most[1])
        self._outlines[id(outline)] = h, outline
        return h

    def shape(
        self,
        ident: int,
        address: int,
        outline: HasRings,
        mirror: HasRings | None,
        body: int,
        inverse_mass: float,
        inverse_moment: float,
    ) -> None:
        """Tell the tables which outline Chipmunk's shape `ident` has, on which body. Call `sync` after the last."""
        number = self.outline(outline)
        other = -1 if mirror is None else self.outline(mirror)
        if ident >= len(self.slots):
            slots = np.full(max(ident + 1, 2 * len(self.slots)), -1, np.int32)
            slots[: len(self.slots)] = self.slots
            self.slots = slots
        if self.knows(ident):
            self.forget([ident])
        row = self._free.pop() if self._free else self._fill["shapes"]
        if row == len(self.tables.shapes):
            self.tables = self.tables._replace(shapes=np.resize(self.tables.shapes, 2 * row))
        self._fill["shapes"] = max(self._fill["shapes"], row + 1)
        self.slots[ident] = row
        body_row, shapes = self._bodies.get(body, (-1, 0))
        if body_row < 0:
            body_row = self._free_bodies.pop() if self._free_bodies else len(self._bodies)
            if body_row >= len(self.tables.bodies):
                self.tables = self.tables._replace(bodies=np.resize(self.tables.bodies, 2 * body_row))
            self.tables.bodies[body_row] = np.zeros((), BODY)
            self.tables.bodies[body_row]["stamp"] = -1
        self._bodies[body] = body_row, shapes + 1
        self._body_of[ident] = body
        self.tables.shapes[row] = (address, number, other, inverse_mass, inverse_moment, body_row)

    def forget(self, idents: Iterable[int]) -> None:
        """Free what the tables hold of shapes that are gone; outlines nobody has any more go with them in time."""
        for ident in idents:
            if not self.knows(ident):
                continue
            row = int(self.slots[ident])
            self.slots[ident] = -1
            self.tables.shapes[row] = (0, -1, -1, 0.0, 0.0, -1)
            self._free.append(row)
            body = self._body_of.pop(ident)
            body_row, shapes = self._bodies[body]
            if shapes > 1:
                self._bodies[body] = body_row, shapes - 1
            else:
                del self._bodies[body]
                self._free_bodies.append(body_row)
        rows = self.known_shapes
        used = np.union1d(rows["outline"], rows["mirror"])
        used = used[used >= 0]
        if len(self._outlines) > 2 * len(used) + 64:
            self._repack(used)

    def _repack(self, used: np.ndarray) -> None:
        """Only the outlines of these numbers stay, with new numbers."""
        kept = {number: outline for number, outline in self._outlines.values()}
        self._outlines = {}
        self._fill |= {"points": 0, "rings": 0, "boxes": 0, "heads": 0}
        renumbered = np.full(len(self.pool.heads) + 1, -1)  # the last for "none"
        for number in used:
            renumbered[number] = self.outline(kept[int(number)])
        rows = self.known_shapes
        for name in ("outline", "mirror"):
            rows[name] = renumbered[rows[name]]

    def knows(self, ident: int) -> bool:
        """Whether shape `ident` has an outline here."""
        return 0 <= ident < len(self.slots) and bool(self.slots[ident] >= 0)

    @property
    def rows(self) -> int:
        """How many rows of tables.shapes are in use."""
        return self._fill["shapes"]

    @property
    def known_shapes(self) -> np.ndarray:
        """The rows of tables.shapes in use (outline -1: free again)."""
        return self.tables.shapes[: self._fill["shapes"]]
