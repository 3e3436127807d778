"""The struct through which machine code finds the tables of one attached space (`chipmunk/arrays.py` makes them).

It is one record of addresses and settings; its own address is the space's user data, so that two attached spaces never
meet. `load_*` are the other direction: from that record back to the named tuples of arrays that the kernels take (as
views without reference counting, which alone would cost as much as clipping two boxes).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..compile.jit import copy_memory, entry, kernel
from ..compile.raw_memory import array_at, record
from ..geometry.overlap import LOOP, Work
from ..geometry.place import Pose, overlap_of_outlines
from ..geometry.pool import HEAD, Pool
from .active import ISLAND, QUEUED
from .dtypes import BODY, NEIGHBOURS, PAIR, REGION, ROW, SHAPE
from .joint_record import JOINT
from .preconditioner import FACTOR, MOBILITY
from .tables import (
    APART,
    ASKED,
    AWAKE,
    BODIES,
    BOXED,
    COUNTED,
    COUNTERS,
    JOINTS,
    LIVE,
    MORE_KEPT,
    MORE_PAIRS,
    MOVERS,
    SHAPES,
    USED_PAIRS,
    USED_REGIONS,
    Law,
    Tables,
    never_used,
    rehash,
)
from .tree import NODE

BODY_WORDS, SHAPE_WORDS = BODY.itemsize // 8, SHAPE.itemsize // 8
#: The tables that outlive a frame, and the counters beside them: what it starts from where it is run again, and what
#: snapshots, copies and worlds begin with. The counter says how many rows are in use (-1: all of them).
LASTING: dict[str, tuple[Any, int]] = {
    "bodies": (BODY, BODIES),
    "shapes": (SHAPE, SHAPES),
    "pairs": (PAIR, USED_PAIRS),
    "regions": (REGION, USED_REGIONS),
    "nodes": (NODE, -1),
    "roots": ("i4", -1),
    "near": (NEIGHBOURS, BOXED),
    "live": ("i4", LIVE),
    "awake": ("i4", AWAKE),
    "movers": ("i4", MOVERS),
    "asked": ("i4", ASKED),
    "apart": (("i4", 2), APART),
    "joints": (JOINT, JOINTS),
}
#: Of the state record, what outlives a frame.
LASTING_STATE = ("before", "frame", "taken", "contacts", "asleep", "rested_with")
#: What `move` does.
OUT, BACK, SIZE = range(3)
#: Numbers this large, or their inverses this small, may overflow in a product of ten (largest float: 1e308).
EXTREME = 1e30
#: Arrays by the named tuple that they belong to.
_ARRAYS = [
    *("points", "following", "ring_of", "rings", "boxes", "arcs", "heads"),
    *("stack", "cross", "param", "spot", "order", "done", "hit", "polygon", "label", "bows", "loops"),
    *("bodies", "shapes", "pairs", "regions", "rows", "factors", "mobility"),
    *("islands", "queue", "members", "live", "awake"),
    *("movers", "asked", "told", "nodes", "roots", "near", "apart", "joints", "table", "counters"),
    *("slots", "body_keys", "body_rows", "heard_alone", "heard_pairs"),
    *("form_extent", "form_mirror", "form_users", "form_span", "form_raw", "form_table", "form_fill"),
    "kept",
    "seen",
]
_N_ARRAYS = len(_ARRAYS)
#: Of each of LASTING: which array it is, bytes of a row, the counter of those in use.
_PLACES = tuple((_ARRAYS.index(name), np.dtype(kind).itemsize, n) for name, (kind, n) in LASTING.items())
#: Offsets in Chipmunk's structs (bytes), see `chipmunk.py`.
OFFSETS = [
    *("body_position", "body_angle", "body_cog", "body_transform", "body_velocity", "body_spin"),
    *("body_force", "body_torque", "body_inverse_mass", "body_inverse_moment"),
    *("body_position_func", "body_velocity_func", "body_shapes"),
    *("position_func", "velocity_func", "position_func_again", "velocity_func_again"),
    *("shape_surface_velocity", "shape_elasticity", "shape_sensor", "shape_type", "shape_filter"),
    *("shape_next", "shape_hashid", "shape_body"),
    *("circle_centre", "circle_radius", "segment_ends", "segment_radius"),
    *("poly_radius", "poly_count", "poly_planes"),
    *("arbiter_elasticity", "arbiter_friction", "arbiter_surface", "arbiter_shape_a", "arbiter_count"),
    *("arbiter_contacts", "arbiter_normal", "arbiter_process", "arbiter_handlers", "arbiter_stamp"),
    *("contact_normal_impulse", "contact_tangent_impulse", "contact_size"),
    *("handler_pre_solve", "no_pre_solve", "pythons_pre_solve", "pythons_begin", "space_contacts"),
    *("space_gravity", "space_bodies", "space_constraints", "space_handlers", "space_sleeping"),
    *("constraint_a", "constraint_collide", "constraint_pre_solve", "constraint_post_solve"),
]

STATE = record(
    [(f"{name}_at", "u8") for name in _ARRAYS]
    + [(f"{name}_n", "i8") for name in _ARRAYS]
    + [(name, "i8") for name in OFFSETS]
    + [(name, (Law.__annotations__[name] == "int" and "i8") or "f8") for name in Law._fields]
    + [
        ("own_at", "u8"),  # this record
        ("stiffness_given", "i8"),
        ("explicit", "i8"),  # 1: one symplectic Euler step a frame, Chipmunk's own positions and joints
        ("substeps", "i8"),  # of a frame
        ("steps_given", "i8"),  # 1: just so many, whatever moves
        ("tolerance", "f8"),  # error of place allowed in a frame, of a body's smallest extent; 0: none asked
        ("taken", "i8"),  # substeps of the last frame
        ("sweeps", "i8"),  # the space's iterations, while a frame has taken them
        ("asleep", "i8"),  # 1: somebody was, when the last frame began
        ("broken", "i8"),  # row of the body whose state stopped being finite, -1: none
        ("failed", "i8"),  # 1: Python could not do what it was asked for
        ("begun", "i8"),  # 1: the frame has changed regions; where it ends too soon they are forgotten, but
        ("kept", "i8"),  # 1: it was kept what it started from
        ("fragile", "i8"),  # 1: it may fail: it is kept from the beginning what it starts from
        ("asked_arbiter", "u8"),  # the arbiter whose normal Chipmunk is to find again, and what it is
        ("asked_x", "f8"),
        ("asked_y", "f8"),
        ("ask_at", "u8"),  # Python's ear
        ("hold_at", "u8"),
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
        ("pending", "i8"),  # 1: shapes or bodies have come or gone that Python has yet to enter
        ("heard_all", "i8"),  # 1: a callback of the user's for all types
        ("heard_epoch", "i8"),  # how often that and those by type have changed
        ("joint_count", "i8"),
        ("contacts", "i8"),  # regions of the last substep
        ("joint_cursor", "i8"),
        ("rested_with", "f8"),  # the settings of the last frame, added up: others act on who is at rest
        ("before", "f8"),  # length of the last frame (time); 0: there was none
        # where the times of a frame's phases are summed up (`chipmunk/phases.py`); 0: nowhere
        ("phases_at", "u8"),
        ("scratch_at", "u8"),  # room for what nobody reads
        ("shown_at", "u8"),  # what arbiters of outlines are made to say (`chipmunk/shown.py`)
        ("kinds_at", "u8"),  # what `joint_structs.kinds_of_joints` has found
    ],
)


@kernel
def clear(at: int, size: int) -> None:
    """So many words of nothing."""
    there = array_at(at, (size,), np.uint64)
    for i in range(size):
        there[i] = np.uint64(0)


@kernel
def move(back: int, block: int, at: int, address: int, size: int) -> int:
    """So many bytes from memory into the block (OUT), or back (BACK), or neither (SIZE); where the block goes on."""
    if back == BACK:
        copy_memory(np.uint64(address), np.uint64(np.int64(block) + at), np.uint64(size))
    elif back == OUT:
        copy_memory(np.uint64(np.int64(block) + at), np.uint64(address), np.uint64(size))
    return int(at + (size + 7) // 8 * 8)


@kernel
def move_tables(s: Any, n: np.ndarray, back: int, block: int, at: int) -> int:
    """All that outlives a frame of our tables (`LASTING`), as far as the counters n say that it is in use."""
    words = array_at(s.own_at, (2 * _N_ARRAYS,), np.int64)
    for k in range(len(_PLACES)):
        array, size, counter = _PLACES[k]
        rows = n[counter] if counter >= 0 else words[_N_ARRAYS + array]
        at = move(back, block, at, words[array], rows * size)
    return int(at)


@kernel
def keep_tables(s: Any) -> bool:
    """Take down what a frame that may have to be run again starts from. Whether there was room for it."""
    counters = array_at(s.counters_at, (COUNTERS,), np.int64)
    if s.kept_n < move_tables(s, counters, SIZE, 0, 8 * COUNTERS):
        counters[MORE_KEPT] = 1
        return False
    s.kept = 1
    move(OUT, s.kept_at, 0, s.counters_at, 8 * COUNTERS)
    move_tables(s, counters, OUT, s.kept_at, 8 * COUNTERS)
    return True


@kernel
def put_tables_back(s: Any, tables: Tables) -> None:
    """The tables as they were kept, but for how much more room the frame has wanted."""
    counters = tables.counters
    kept = array_at(s.kept_at, (COUNTERS,), np.int64)
    for i in range(MORE_PAIRS, COUNTED + 1):
        kept[i] = counters[i]
    pairs = counters[USED_PAIRS]
    regions = counters[USED_REGIONS]
    move(BACK, s.kept_at, 0, s.counters_at, 8 * COUNTERS)
    move_tables(s, counters, BACK, s.kept_at, 8 * COUNTERS)
    never_used(tables, pairs, regions)
    rehash(tables)


@entry
def enter_bodies(keys: np.ndarray, rows: np.ndarray, addresses: np.ndarray, values: np.ndarray) -> None:
    """Fill the hash table of bodies."""
    for k in range(len(addresses)):
        _enter(keys, rows, addresses[k], values[k])


@kernel
def enter_body(s: Any, address: int, row: int) -> None:
    """Have a body found by its address."""
    rows = array_at(s.body_rows_at, (s.body_rows_n,), np.int32)
    _enter(array_at(s.body_keys_at, (s.body_keys_n,), np.uint64), rows, address, row)


@kernel
def _enter(keys: np.ndarray, rows: np.ndarray, address: int, row: int) -> None:
    mask = len(keys) - 1
    i = int(address >> np.uint64(4)) & mask
    while keys[i] != 0:
        i = (i + 1) & mask
    keys[i] = address
    rows[i] = row


@kernel
def drop_body(s: Any, address: int) -> None:
    """It is found no more; those that would be found by it move up."""
    keys = array_at(s.body_keys_at, (s.body_keys_n,), np.uint64)
    rows = array_at(s.body_rows_at, (s.body_rows_n,), np.int32)
    mask = len(keys) - 1
    i = int(address >> np.uint64(4)) & mask
    while keys[i] != address:
        if keys[i] == 0:
            return
        i = (i + 1) & mask
    k = (i + 1) & mask
    while keys[k] != 0:
        home = int(keys[k] >> np.uint64(4)) & mask
        if ((k - home) & mask) >= ((k - i) & mask):
            keys[i] = keys[k]
            rows[i] = rows[k]
            i = k
        k = (k + 1) & mask
    keys[i] = np.uint64(0)


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


@kernel(forceinline=True)
def next_row_of_body(s: Any, bodies: np.ndarray, before: int, address: int) -> int:
    """`row_of_body`, in a walk along Chipmunk's list, after the row `before`: mostly the next one, as they came."""
    i = before + 1
    if i < len(bodies) and bodies[i].address == address:
        return i
    return int(row_of_body(s, address))


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
        array_at(s.islands_at, (s.islands_n,), ISLAND),
        array_at(s.queue_at, (s.queue_n,), QUEUED),
        array_at(s.members_at, (s.members_n,), np.int32),
        array_at(s.live_at, (s.live_n,), np.int32),
        array_at(s.awake_at, (s.awake_n,), np.int32),
        array_at(s.movers_at, (s.movers_n,), np.int32),
        array_at(s.asked_at, (s.asked_n,), np.int32),
        array_at(s.told_at, (s.told_n,), np.int32),
        array_at(s.nodes_at, (s.nodes_n,), NODE),
        array_at(s.roots_at, (s.roots_n,), np.int32),
        array_at(s.near_at, (s.near_n,), NEIGHBOURS),
        array_at(s.apart_at, (s.apart_n, 2), np.int32),
        array_at(s.joints_at, (s.joints_n,), JOINT),
        array_at(s.table_at, (s.table_n,), np.int32),
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
        s.followed if s.explicit or s.stiffness_given else 0.0,
        s.frame,
    )
