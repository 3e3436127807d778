"""What a world of `Worlds` looks like in memory: one block, with the tables and copies of Chipmunk's structs in it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk._chipmunk_cffi import ffi, lib

from ..contact.constants import SUBSTEPS
from ..contact.space_record import _ARRAYS as ARRAYS
from ..contact.space_record import LASTING, OFFSETS
from ..contact.tables import (
    BODIES,
    COUNTERS,
    JOINTS,
    MORE_KEPT,
    MORE_PAIRS,
    MORE_REGIONS,
    MORE_WORK,
    SHAPES,
    TOLD,
)
from ..geometry.overlap import Work, enlarged
from .arrays import Store, room_to_keep
from .joint_structs import kinds_of_joints
from .structs import LayoutError, address_of

#: Bytes of Chipmunk's structs that are copied.
SPACE_BYTES, BODY_BYTES, SHAPE_BYTES = 200, 248, 192
#: Arrays that are as long as there may be rows, and bodies.
_OF_ROWS, _OF_BODIES = ("rows", "factors", "queue"), ("mobility", "islands", "members")
#: Arrays of the state record that no frame remembers: a thread's.
_SCRATCH = (
    *("stack", "cross", "param", "spot", "order", "done", "hit", "polygon", "label", "bows", "loops"),
    *_OF_ROWS,
    *_OF_BODIES,
    "kept",
    "seen",
)
#: Arrays of a world's own that grow with pairs and regions, and those whose size is known.
GROWING = ("pairs", "regions", "near", "told", "table")
_FIXED = ("counters", *(name for name in LASTING if name not in GROWING))


@dataclass(frozen=True)
class Image:
    """What a world's memory is like: where its parts begin (bytes), and which words are addresses in it."""

    family: Store  #: whose worlds they are
    offsets: dict[str, int]  #: where each table begins (bytes), and how many rows it has
    lengths: dict[str, int]
    kinds: dict[str, np.dtype[Any]]
    size: int  #: bytes of a world
    count: int  #: bodies
    shapes: int
    offsets_of: dict[str, int]  #: places in Chipmunk's structs (bytes)
    space_at: int
    bodies_at: int
    shapes_at: int
    state_at: int
    joints: list[tuple[int, int]]  #: where each joint's numbers begin, and how many it has
    fixups: NDArray[np.int64]  #: words that are addresses in the world
    place_of: NDArray[np.int32]  #: of a row of the tables' bodies, its place in `space.bodies`; -1: none
    work: Work
    most: Any  #: how many vertices two outlines have at the most

    def table(self, memory: Any, name: str) -> Any:
        """One of its tables, in place."""
        kind = self.kinds[name]
        at = self.offsets[name]
        return memory[at : at + self.lengths[name] * kind.itemsize].view(kind)

    def larger(self, pairs: int, regions: int, work: int) -> Image:
        """The same with room for so many more."""
        lengths = dict(self.lengths)
        scratch = self.work
        if work > 0:
            scratch = enlarged(self.work, *(2 * most for most in self.most))
        lengths["pairs"] += max(0, pairs)  # there is some to spare in what a frame asks for (`join.roomy`)
        lengths["regions"] += max(0, regions)
        offsets = dict(self.offsets)
        size = _lay_out(offsets, lengths, self.kinds, offsets["pairs"])
        return replace(self, offsets=offsets, lengths=lengths, size=size, work=scratch)

    def scratch(self) -> tuple[Any, list[Any]]:
        """A thread's: the words of the state record that say where it is, and the arrays."""
        lengths, kinds = self.lengths, self.kinds
        rows = lengths["regions"] + lengths["joints"]
        arrays = {name: np.zeros_like(array) for name, array in self.work._asdict().items()}
        arrays |= {name: np.zeros(rows, kinds[name]) for name in _OF_ROWS}
        arrays |= {name: np.zeros(lengths["bodies"], kinds[name]) for name in _OF_BODIES}
        room = room_to_keep({name: n * kinds[name].itemsize for name, n in lengths.items()})
        arrays |= {"kept": np.zeros(room, np.uint8), "seen": np.zeros((lengths["bodies"], 3))}
        words = [len(_SCRATCH) * 2]
        for name in _SCRATCH:
            field = ARRAYS.index(name)
            words += [field, address_of(ffi.from_buffer(arrays[name]))]
            words += [len(ARRAYS) + field, len(arrays[name])]
        return np.array(words, np.int64), [arrays]


def _lay_out(offsets: dict[str, int], lengths: dict[str, int], kinds: dict[str, Any], at: int) -> int:
    """Where the tables that grow begin, one behind the other from `at` on; how many bytes that makes."""
    lengths["near"], lengths["told"] = 2 * lengths["pairs"] + 1, lengths["pairs"]
    lengths["table"] = max(64, 1 << (2 * lengths["pairs"] - 1).bit_length())
    for name in GROWING:
        offsets[name] = at
        at += -(-lengths[name] * kinds[name].itemsize // 64) * 64
    return at


def rows_of(store: Store, space: pymunk.Space) -> tuple[int, int, int]:
    """How many bodies (those outside the space too), shapes and joints a world of the space has."""
    own = {address_of(body._body) for body in space.bodies}
    used = {int(a) for a in store.tables.bodies["address"][: store.tables.counters[BODIES]] if a}
    return len(own | used), len(space.shapes), len(space.constraints)


def image_of(store: Store, space: pymunk.Space, rows: tuple[int, int, int] = (0, 0, 0)) -> tuple[Image, Any]:
    """The form of a world of a space, and one, as if it began at address 0.

    rows: of bodies, shapes, joints, for so many of which there is a place at least (`rows_of`): so worlds of different
    spaces have theirs at the same places.
    """
    from . import alone, hidden_constraint

    state, tables = store.state[0], store.tables
    offsets_of = {name: int(state[name]) for name in (*OFFSETS, "hold_at")}
    bodies, shapes, joints = list(space.bodies), list(space.shapes), list(space.constraints)
    used = [int(a) for a in tables.bodies["address"][: tables.counters[BODIES]] if a]
    own = [address_of(body._body) for body in bodies]
    held = [*own, *(address for address in used if address not in set(own))]  # the space's first
    memory: list[tuple[int, Any]] = []
    size = 0

    def block(array: Any) -> int:
        nonlocal size
        at, size = size, size + -(-array.nbytes // 64) * 64
        memory.append((at, array))
        return at

    world = np.zeros(1, alone.WORLD)
    record = store.state.copy()
    world_at, state_at = block(world), block(record)
    space_at = block(struct := _copied(space._space, SPACE_BYTES))
    joint_at = block(hidden := np.zeros(4, np.uint64))
    lists = {
        name: block(np.zeros(2 + max(n, len(listed)), np.uint64))
        for name, listed, n in (("space_bodies", bodies, rows[0]), ("space_constraints", joints, rows[2]))
    }
    body_structs = np.zeros((max(rows[0], len(held)), BODY_BYTES), np.uint8)
    shape_structs = np.zeros((max(rows[1], len(shapes)), SHAPE_BYTES), np.uint8)
    for i, address in enumerate(held):
        body_structs[i] = _copied(ffi.cast("void *", address), BODY_BYTES)
    for i, shape in enumerate(shapes):
        shape_structs[i] = _copied(shape._shape, SHAPE_BYTES)
    bodies_at, shapes_at = block(body_structs), block(shape_structs)
    joint_structs = [_copied(joint._constraint, _size_of_joint(joint)) for joint in joints]
    joints_at = [block(one) for one in joint_structs]
    where = {address: bodies_at + i * BODY_BYTES for i, address in enumerate(held)}
    where |= {address_of(shape._shape): shapes_at + i * SHAPE_BYTES for i, shape in enumerate(shapes)}
    where |= {address_of(joint._constraint): at for joint, at in zip(joints, joints_at)}

    arrays = {name: np.array(getattr(tables, name)) for name in (*_FIXED, *GROWING)}
    arrays |= {"body_keys": store.body_keys.copy(), "body_rows": store.body_rows.copy()}
    counters = arrays["counters"]
    counters[[MORE_PAIRS, MORE_REGIONS, MORE_WORK, MORE_KEPT, TOLD]] = 0
    arrays["pairs"]["arbiter"] = 0
    kinds = {name: array.dtype for name, array in arrays.items()}
    kinds["apart"] = np.dtype(("i4", 2))
    lengths = {name: len(array) for name, array in arrays.items()}
    offsets = {name: block(arrays[name]) for name in (*_FIXED, "body_keys", "body_rows")}
    total = _lay_out(offsets, lengths, kinds, size)

    fixups: list[int] = []

    def point(array: Any, word: int, at: int, to: int) -> None:
        """A word of an array that begins at `at` is an address in the world: `to`."""
        array.reshape(-1).view(np.uint8)[8 * word : 8 * word + 8].view(np.uint64)[0] = to
        fixups.append(at // 8 + word)

    names = world.dtype.fields
    own_places = {"state_at": state_at, "space_at": space_at, "joint_at": joint_at}
    for name, to in (own_places | {"bodies_at": bodies_at, "shapes_at": shapes_at}).items():
        point(world, names[name][1] // 8, world_at, to)
    point(hidden, 1, joint_at, space_at)
    stamp_at, step_at, user_at = space_words()
    point(struct, user_at // 8, space_at, state_at)
    world["solve_at"], world["report_at"] = hidden_constraint.solve.address, hidden_constraint.report.address
    world["stamp_at"], world["step_at"], world["nothing_at"] = (
        stamp_at,
        step_at,
        offsets_of["body_shapes"] + 8,
    )
    world["count"], world["shapes"], world["damping"] = len(bodies), len(shapes), space.damping
    world["body_size"], world["shape_size"] = BODY_BYTES, SHAPE_BYTES
    for name, there in lists.items():
        point(struct, offsets_of[name] // 8, space_at, there)
        listed = next(array for at, array in memory if at == there)
        own_structs = [b._body for b in bodies] if name == "space_bodies" else [j._constraint for j in joints]
        listed[0] = len(own_structs)
        point(listed, 1, there, there + 16)
        for i, row in enumerate(own_structs):
            point(listed, 2 + i, there, where[address_of(row)])
    for i in range(len(held)):
        words = body_structs[i].view(np.uint64)
        at, first = bodies_at + i * BODY_BYTES, offsets_of["body_shapes"] // 8
        if words[first]:
            point(body_structs[i], first, at, where[int(words[first])])
        if i < len(bodies):
            words[offsets_of["body_position_func"] // 8] = offsets_of["hold_at"]
        words[first + 1] = 0
    for i in range(len(shapes)):
        at, words = shapes_at + i * SHAPE_BYTES, shape_structs[i].view(np.uint64)
        for name in ("shape_next", "shape_body"):
            k = offsets_of[name] // 8
            if words[k]:
                point(shape_structs[i], k, at, where[int(words[k])])
    for one, at in zip(joint_structs, joints_at):
        for k in (offsets_of["constraint_a"] // 8, offsets_of["constraint_a"] // 8 + 1):
            point(one, k, at, where[int(one.view(np.uint64)[k])])
    for name, n in (("bodies", counters[BODIES]), ("shapes", counters[SHAPES]), ("joints", counters[JOINTS])):
        kind = kinds[name]
        assert kind.fields is not None
        for i in range(n):
            address = int(arrays[name]["address"][i])
            if address:
                word = (i * kind.itemsize + kind.fields["address"][1]) // 8
                point(arrays[name], word, offsets[name], where[address])
    words = record.view(np.int64)
    for name in offsets:
        words[ARRAYS.index(name)] = offsets[name]
        words[len(ARRAYS) + ARRAYS.index(name)] = lengths[name]
        fixups.append(state_at // 8 + ARRAYS.index(name))
    point(record, record.dtype.fields["own_at"][1] // 8, state_at, state_at)
    record["ask_at"], record["phases_at"], record["user_pre_solve"] = alone.no_answer.address, 0, 0
    record["substeps"], record["steps_given"], record["tolerance"] = SUBSTEPS, 0, 0.0
    record["sweeps"], record["joint_count"], record["asleep"] = space.iterations, 0, 0
    image = np.zeros(total, np.uint8)
    for at, array in [*memory, *((offsets[name], arrays[name]) for name in GROWING)]:
        image[at : at + array.nbytes] = np.ascontiguousarray(array).reshape(-1).view(np.uint8)
    place_of = np.full(lengths["bodies"], -1, np.int32)
    for i, address in enumerate(own):
        place_of[store.row_of(address)] = i
    kinds |= {name: getattr(tables, name).dtype for name in (*_OF_ROWS, *_OF_BODIES)}
    made_of = [kind_of(joint) for joint in joints]
    made = Image(
        family=store,
        offsets=offsets,
        lengths=lengths,
        kinds=kinds,
        size=total,
        count=len(bodies),
        shapes=len(shapes),
        offsets_of=offsets_of,
        space_at=space_at,
        bodies_at=bodies_at,
        shapes_at=shapes_at,
        state_at=state_at,
        joints=[(at + kind.parameters, kind.numbers) for at, kind in zip(joints_at, made_of)],
        fixups=np.array(fixups, np.int64),
        place_of=place_of,
        work=store.work,
        most=store._most,
    )
    return made, image


def move_over(old: Image, memory: Any, homes: Any, new: Image, to: Any, at: Any, call: Any) -> None:
    """Worlds of one form (k, size), whose addresses are of `homes`, in the form of another that has more room."""
    from .moved import HEAD

    first = old.offsets["pairs"]
    to[:, :first] = memory[:, :first]
    for name in GROWING:
        n = old.lengths[name] * old.kinds[name].itemsize
        to[:, new.offsets[name] : new.offsets[name] + n] = memory[
            :, old.offsets[name] : old.offsets[name] + n
        ]
    words = to.view(np.int64)
    words[:, new.fixups] += (at - homes).astype(np.int64)[:, None]
    for name in GROWING:
        field = new.state_at // 8 + ARRAYS.index(name)
        words[:, field] = at.astype(np.int64) + new.offsets[name]
        words[:, field + len(ARRAYS)] = new.lengths[name]
    counters = to[:, new.offsets["counters"] :][:, : 8 * COUNTERS]
    kept = np.ascontiguousarray(counters).view(np.int64)
    kept[:, [MORE_PAIRS, MORE_REGIONS, MORE_WORK]] = 0
    counters[:] = kept.view(np.uint8)
    head = np.zeros(1, HEAD)
    head["pairs"], head["regions"] = old.lengths["pairs"], old.lengths["regions"]
    own = np.ascontiguousarray(at)
    call.enlarged(ffi.from_buffer(own), len(own), ffi.from_buffer(head))


def _copied(pointer: Any, size: int) -> Any:
    """Bytes of Chipmunk's memory."""
    return np.frombuffer(ffi.buffer(ffi.cast("char *", pointer), size), np.uint8).copy()


def _size_of_joint(joint: pymunk.Constraint) -> int:
    """What of a joint's struct a frame reads (bytes)."""
    kind = kind_of(joint)
    ends = kind.impulse + 8 * kind.impulses, kind.parameters + 8 * kind.numbers, kind.force + 8
    return max(*ends, 96)


def kind_of(joint: pymunk.Constraint) -> Any:
    own = int(ffi.cast("uintptr_t *", joint._constraint)[0])
    return next((kind for kind in kinds_of_joints() if kind.own_class == own), None)


@lru_cache(maxsize=1)
def space_words() -> tuple[int, int, int]:
    """Where a space keeps its count of steps, its time step, and its user's word (bytes)."""
    space = pymunk.Space()
    lib.cpSpaceStep(space._space, 0.125)  # not space.step, which somebody may have wrapped
    lib.cpSpaceSetUserData(space._space, ffi.cast("void *", 0x5152535455565758))
    copy = _copied(space._space, SPACE_BYTES)
    lib.cpSpaceSetUserData(space._space, ffi.NULL)
    steps = np.flatnonzero(copy.view(np.float64) == 0.125)
    users = np.flatnonzero(copy.view(np.uint64) == 0x5152535455565758)
    stamps = []
    for k in np.flatnonzero(copy.view(np.uint32) == 1):
        changed = copy.copy()
        changed.view(np.uint32)[k] = 4711
        if lib.cpSpaceGetTimestamp(ffi.cast("cpSpace *", address_of(ffi.from_buffer(changed)))) == 4711:
            stamps.append(k)
    found: dict[str, Any] = {"time step": steps, "user data": users, "count of steps": stamps}
    for name, places in found.items():
        if len(places) != 1:
            raise LayoutError(f"{name}: expected one place in Chipmunk's space, found {len(places)}")
    return 4 * int(stamps[0]), 8 * int(steps[0]), 8 * int(users[0])
