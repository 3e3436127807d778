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

from .kernel.broad import extents
from .kernel.conjugate import FACTOR, MOBILITY
from .kernel.jit import entry, kernel
from .kernel.memory import array_at, record
from .kernel.overlap import LOOP, Work, enlarged, fits, new_work
from .kernel.place import Pose, overlap_of_outlines
from .kernel.pool import HEAD, HasRings, Pool, pack
from .kernel.row import ROW
from .kernel.tables import (
    ANEW,
    BODIES,
    BODY,
    COUNTERS,
    FREE_PAIR,
    FREE_PAIRS,
    FREE_REGION,
    FREE_REGIONS,
    NEAR,
    PAIR,
    REGION,
    SHAPE,
    SHAPES,
    Law,
    Tables,
    end_pair,
    new_pair,
    rehash,
)

BODY_WORDS, PAIR_WORDS, REGION_WORDS = BODY.itemsize // 8, PAIR.itemsize // 8, REGION.itemsize // 8
#: Arrays by the named tuple that they belong to.
_ARRAYS = [
    *("points", "following", "ring_of", "rings", "boxes", "arcs", "heads"),
    *("stack", "cross", "param", "spot", "order", "done", "hit", "polygon", "label", "bows", "loops"),
    *("bodies", "shapes", "pairs", "regions", "rows", "factors", "mobility", "live"),
    *("near", "apart", "sorted", "keys", "values", "counters", "slots", "body_keys", "body_rows", "joints"),
    *("kept_bodies", "kept_pairs", "kept_regions", "kept_counters"),
]
#: Offsets in Chipmunk's structs (bytes), see `chipmunk.py`.
OFFSETS = [
    *(
        "body_position",
        "body_angle",
        "body_cog",
        "body_transform",
        "body_velocity",
        "body_spin",
        "body_force",
    ),
    *("body_torque", "body_inverse_mass", "body_inverse_moment", "body_position_func", "body_velocity_func"),
    *("position_func", "velocity_func", "position_func_again", "velocity_func_again", "body_shapes"),
    *(
        "shape_surface_velocity",
        "shape_elasticity",
        "shape_sensor",
        "shape_type",
        "shape_filter",
        "shape_body",
    ),
    "shape_next",
    *("arbiter_elasticity", "arbiter_friction", "arbiter_surface", "arbiter_shape_a", "arbiter_body_a"),
    *("arbiter_count", "arbiter_contacts", "arbiter_normal", "arbiter_process", "arbiter_state"),
    "arbiter_handlers",
    *("contact_normal_impulse", "contact_tangent_impulse", "contact_size"),
    *(
        "handler_pre_solve",
        "no_pre_solve",
        "pythons_pre_solve",
        "space_gravity",
        "space_bodies",
        "space_constraints",
        "space_handlers",
    ),
    *("constraint_a", "constraint_collide", "constraint_pre_solve", "constraint_post_solve"),
]

#: A joint of the space while a frame has it.
JOINT = record(
    [
        ("address", "u8"),
        ("kind", "u8"),  # its class, a struct of Chipmunk's of four functions
        ("pre_solve", "u8"),  # the user's callback; 0: none
        ("taken", "i4"),  # 1: since that, until the report, we run it
        ("mine", "i4"),  # 1: taken, and of the turn that is being solved
        ("a", "i4"),  # rows of its bodies; -1: not ours
        ("b", "i4"),
        ("at", "i4"),  # where it keeps its impulse (bytes), and how many numbers that is; -1: unknown
        ("count", "i4"),
        ("x", "f8"),  # impulse summed over the frame
        ("y", "f8"),
        ("force_at", "i4"),  # where a spring keeps its force function, if that is the user's; 0: it has none
        ("asked", "i4"),  # 1: that has been asked in this frame
        ("force_func", "u8"),
        ("force", "f8"),  # what it has said
        ("start_x", "f8"),  # what it started from
        ("start_y", "f8"),
    ]
)
#: Kinds of joints.
KINDS = 10

STATE = record(
    [(f"{name}_at", "u8") for name in _ARRAYS]
    + [(f"{name}_n", "i8") for name in _ARRAYS]
    + [(name, "i8") for name in OFFSETS]
    + [(name, (Law.__annotations__[name] == "int" and "i8") or "f8") for name in Law._fields]
    + [
        ("stiffness_given", "i8"),
        ("explicit", "i8"),  # 1: one symplectic Euler step a frame, Chipmunk's own positions and joints
        ("substeps", "i8"),  # of a frame
        ("steps_given", "i8"),  # 1: just so many, whatever moves
        (
            "tolerance",
            "f8",
        ),  # error of place allowed in a frame, over a body's smallest extent; 0: none asked
        ("taken", "i8"),  # substeps of the last frame
        ("sweeps", "i8"),  # the space's iterations, while a frame has taken them
        ("frame", "i8"),  # Chipmunk's number of the step that has begun
        ("held", "i8"),  # the step in which a position function of ours was last called
        ("asleep", "i8"),  # 1: somebody was, when the last frame began
        ("broken", "i8"),  # row of the body whose state stopped being finite, -1: none
        ("failed", "i8"),  # 1: Python could not do what it was asked for
        ("request", "i8"),
        ("asked_arbiter", "u8"),  # of it: the normal that Chipmunk has found
        ("asked_x", "f8"),
        ("asked_y", "f8"),
        ("ask_at", "u8"),  # Python's ear
        ("hold_at", "u8"),
        ("springs_at", "u8"),  # what `chipmunk.springs` has found, and our own force function
        ("spring_at", "u8"),
        ("seize_at", "u8"),
        ("idle_kind", "u8"),  # the class of a joint that we run
        ("seized_kind", "u8"),  # the same, of one that Chipmunk is to prepare
        ("hidden", "u8"),  # our own constraint
        ("global_handler", "u8"),  # Chipmunk's global handler
        ("pre_solve_at", "u8"),  # our pre_solve, and the user's global one that comes before it; 0: none
        ("user_pre_solve", "u8"),
        ("global_begin", "u8"),  # the other functions of the global handler, when last looked at
        ("global_post_solve", "u8"),
        ("global_separate", "u8"),
        ("shape_counter", "u8"),  # what was last registered: Chipmunk's counter, shapes, handlers
        ("shape_count", "i8"),
        ("handler_count", "i8"),
        ("joint_count", "i8"),
        ("contacts", "i8"),  # regions of the last substep
        ("joint_cursor", "i8"),
        ("stop", "i8"),  # 1: something waits in Python
        ("seen_at", "u8"),  # room for every body's place
        ("scratch_at", "u8"),  # room for what nobody reads
        ("kinds_at", "u8"),  # joints' classes, where they keep their impulse, and how many numbers that is
    ],
)


@kernel
def _copy(to: int, source: int, size: int) -> None:
    """Copy so many words."""
    there = array_at(to, (size,), np.uint64)
    here = array_at(source, (size,), np.uint64)
    for i in range(size):
        there[i] = here[i]


@kernel
def keep_tables(s: Any, back: bool) -> bool:
    """Take down what a frame that may have to be run again starts from, or put it back.

    False: the tables have grown since there was room made for it.
    """
    fits = s.kept_bodies_n == s.bodies_n and s.kept_pairs_n == s.pairs_n and s.kept_regions_n == s.regions_n
    if fits:
        if back:
            _copy(s.bodies_at, s.kept_bodies_at, s.bodies_n * BODY_WORDS)
            _copy(s.pairs_at, s.kept_pairs_at, s.pairs_n * PAIR_WORDS)
            _copy(s.regions_at, s.kept_regions_at, s.regions_n * REGION_WORDS)
            _copy(s.counters_at, s.kept_counters_at, s.counters_n)
        else:
            _copy(s.kept_bodies_at, s.bodies_at, s.bodies_n * BODY_WORDS)
            _copy(s.kept_pairs_at, s.pairs_at, s.pairs_n * PAIR_WORDS)
            _copy(s.kept_regions_at, s.regions_at, s.regions_n * REGION_WORDS)
            _copy(s.kept_counters_at, s.counters_at, s.counters_n)
    return bool(fits)


@entry
def enter_bodies(keys: np.ndarray, rows: np.ndarray, addresses: np.ndarray, values: np.ndarray) -> None:
    """Fill the hash table of bodies."""
    mask = len(keys) - 1
    for k in range(len(addresses)):
        i = int(addresses[k] >> np.uint64(4)) & mask
        while keys[i] != 0:
            i = (i + 1) & mask
        keys[i] = addresses[k]
        rows[i] = values[k]


@kernel(forceinline=True)
def row_of_body(s: Any, address: int) -> int:
    """The row of Chipmunk's body at `address`; -1: not known."""
    keys = array_at(s.body_keys_at, (s.body_keys_n,), np.uint64)
    rows = array_at(s.body_rows_at, (s.body_rows_n,), np.int32)
    mask = len(keys) - 1
    i = int(address >> np.uint64(4)) & mask
    while keys[i] != 0:
        if keys[i] == address:
            return int(rows[i])
        i = (i + 1) & mask
    return -1


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


@entry
def overlap_by_address(
    address: int, ax: float, ay: float, ac: float, as_: float, bx: float, by: float, bc: float, bs: float
) -> tuple[int, float, float, float, float]:
    """`overlap_of_outlines` of the first two outlines of the state record there: what it returns, one by one.

    Handing over two tuples of arrays takes a hundred times as long as clipping two boxes.
    """
    s = array_at(address, (1,), STATE)[0]
    n, rel = overlap_of_outlines(
        load_pool(s), 0, Pose(ax, ay, ac, as_), 1, Pose(bx, by, bc, bs), load_work(s)
    )
    return n, rel.c, rel.s, rel.tx, rel.ty


def state_of_arrays(*tuples: Any) -> np.ndarray:
    """A state record (1,) that has nothing but these named tuples of arrays, which the caller keeps alive."""
    state = np.zeros(1, STATE)
    for arrays in tuples:
        for name, array in arrays._asdict().items():
            state[f"{name}_at"], state[f"{name}_n"] = array.ctypes.data, len(array)
    return state


@kernel(inline="always")
def load_tables(s: Any) -> Tables:
    """The bodies, shapes, pairs and regions of the space whose state record is s."""
    return Tables(
        array_at(s.bodies_at, (s.bodies_n,), BODY),
        array_at(s.shapes_at, (s.shapes_n,), SHAPE),
        array_at(s.pairs_at, (s.pairs_n,), PAIR),
        array_at(s.regions_at, (s.regions_n,), REGION),
        array_at(s.rows_at, (s.rows_n,), ROW),
        array_at(s.factors_at, (s.factors_n,), FACTOR),
        array_at(s.mobility_at, (s.mobility_n,), MOBILITY),
        array_at(s.live_at, (s.live_n,), np.int32),
        array_at(s.near_at, (s.near_n,), np.int32),
        array_at(s.apart_at, (s.apart_n, 2), np.int32),
        array_at(s.sorted_at, (s.sorted_n,), np.int32),
        array_at(s.keys_at, (s.keys_n,), np.int64),
        array_at(s.values_at, (s.values_n,), np.int32),
        array_at(s.counters_at, (s.counters_n,), np.int64),
    )


@entry(inline="always")
def load_law(s: Any) -> Law:
    """The force law of the space whose state record is s."""
    return Law(
        s.stiffness,
        s.penetration,
        s.gravity,
        s.law,
        s.length,
        s.direction,
        s.exponent,
        s.rest_speed,
        s.followed,
    )


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
            np.zeros(16, BODY),
            np.zeros(16, SHAPE),
            np.zeros(0, PAIR),
            np.zeros(0, REGION),
            np.zeros(0, ROW),
            np.zeros(0, FACTOR),
            np.zeros(16, MOBILITY),
            np.zeros(16, np.int32),
            np.zeros(0, np.int32),
            np.zeros((4, 2), np.int32),
            np.zeros(0, np.int32),
            np.full(64, -1, np.int64),
            np.zeros(64, np.int32),
            np.zeros(COUNTERS, np.int64),
        )
        self.tables.counters[[FREE_REGION, FREE_PAIR]] = -1
        self.slots = np.full(64, -1, np.int32)  # Chipmunk's shape id -> row of tables.shapes
        self.body_keys = np.zeros(64, np.uint64)  # hash table: Chipmunk's body -> row of tables.bodies
        self.body_rows = np.zeros(64, np.int32)
        self.joints = np.zeros(8, JOINT)
        self._kept: dict[str, np.ndarray] = {}
        self._outlines: dict[int, tuple[int, HasRings]] = {}  # by id: number, and what keeps the id
        self._free: list[int] = []  # rows of shapes that are gone
        self._bodies: dict[int, int] = {}  # Chipmunk's body -> row
        self._free_bodies: list[int] = []
        self._most = (0, 0)  # points and rings of the largest outline
        self.keep()
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

    def keep(self) -> None:
        """Room for a copy of what a frame changes."""
        tables = self.tables
        arrays = {"bodies": tables.bodies, "pairs": tables.pairs, "regions": tables.regions}
        self._kept = {f"kept_{name}": np.zeros_like(array) for name, array in arrays.items()}
        self._kept["kept_counters"] = np.zeros_like(tables.counters)
        self.sync()

    def sync(self) -> None:
        """Write the arrays' addresses and sizes into the state record."""
        own = ("slots", "body_keys", "body_rows", "joints")
        mine = {name: getattr(self, name) for name in own} | self._kept
        arrays = {**self.pool._asdict(), **self.work._asdict(), **self.tables._asdict(), **mine}
        state = self.state[0]
        for name, array in arrays.items():
            state[f"{name}_at"] = array.ctypes.data
            state[f"{name}_n"] = len(array)

    def grow_pairs(self, least: int = 0) -> None:
        """Twice the pairs (at least `least`), the new ones free."""
        old = self.tables.pairs
        new = np.zeros(max(least, 2 * len(old)), PAIR)
        new[: len(old)] = old
        new["next"][len(old) :] = np.arange(len(old) + 1, len(new) + 1)
        new["a"][len(old) :] = -1
        new["next"][-1] = self.tables.counters[FREE_PAIR]
        self.tables.counters[FREE_PAIR] = len(old)
        self.tables.counters[FREE_PAIRS] += len(new) - len(old)
        size = 64
        while size < 2 * len(new):  # at most half full
            size *= 2
        near = np.zeros(len(new), np.int32)
        near[: len(self.tables.near)] = self.tables.near
        self.tables = self.tables._replace(
            pairs=new, near=near, keys=np.full(size, -1, np.int64), values=np.zeros(size, np.int32)
        )
        rehash(self.tables)
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
        rows = np.zeros(len(new), ROW)
        rows[: len(self.tables.rows)] = self.tables.rows
        self.tables = self.tables._replace(regions=new, rows=rows, factors=np.zeros(len(new), FACTOR))
        self.sync()

    def grow_joints(self, n: int) -> None:
        """Room for n joints."""
        if n > len(self.joints):
            self.joints = np.zeros(2 * n, JOINT)
            self.tables = self.tables._replace(apart=np.zeros((2 * n, 2), np.int32))
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
        """Tell the tables which outline Chipmunk's shape `ident` has, on which body. Call `settle` after the last."""
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
        self.sync()

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
        near = near[tables.pairs["a"][near] >= 0]
        tables.near[: len(near)] = near
        tables.counters[NEAR] = len(near)

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
