"""Many worlds at once: copies of one attached space that step without Chipmunk, Python or one another, in threads.

    worlds = rigidarea.worlds.Worlds(space, 1024)
    states = worlds.step(1 / 60, forces)

A world is one block of memory (`contact/alone.py`); geometry is shared by all.
"""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from typing import Any

import numpy as np
import pymunk
from numpy.typing import ArrayLike, NDArray
from pymunk._chipmunk_cffi import ffi, lib

from .chipmunk import LayoutError, address_of, kinds_of_joints
from .contact import attached
from .contact.arrays import Store
from .gate import whole
from .kernel.constants import SUBSTEPS
from .kernel.overlap import enlarged
from .kernel.tables import (
    BODIES,
    COUNTERS,
    JOINTS,
    MORE_KEPT,
    MORE_PAIRS,
    MORE_REGIONS,
    MORE_WORK,
    SHAPES,
    SUBSTEP,
    TOLD,
)
from .outline import positive
from .store import _ARRAYS as ARRAYS
from .store import KEPT, OFFSETS

#: Bytes of Chipmunk's structs that are copied.
_SPACE, _BODY, _SHAPE = 200, 248, 192
#: Arrays of the state record that no frame remembers: a thread's.
_SCRATCH = (
    *("stack", "cross", "param", "spot", "order", "done", "hit", "polygon", "label", "bows", "loops"),
    *("rows", "factors", "mobility", *(f"kept_{name}" for name in KEPT), "seen"),
)
#: Arrays of a world's own whose size is known, and those that grow with pairs and regions.
_FIXED = (
    "counters",
    "bodies",
    "shapes",
    "nodes",
    "roots",
    "live",
    "awake",
    "movers",
    "asked",
    "apart",
    "joints",
)
_GROWING = ("pairs", "regions", "near", "told", "table")

CONTACTS = np.dtype(
    [
        ("body_a", "i4"),
        ("body_b", "i4"),
        ("centroid", "f8", 2),
        ("direction", "f8", 2),
        ("area", "f8"),
        ("force", "f8"),
        ("friction", "f8"),
        ("speed", "f8"),
    ]
)
"""A contact of a world: the places of its bodies in `space.bodies` (-1: what is not among them); centroid (length,
world), direction (unit, A to B), area (length^2), normal force and friction (force), closing speed (length/time)."""


class Worlds:
    """n copies of an attached space, each with its own state and parameters.

    They begin as the space is now, contacts included, and the space itself goes on by itself. A world's frame gives the
    same bits as the space's own would (where its tables have room), whatever the number of threads. They run
    `integration="implicit"`, without callbacks, velocity and position functions of the user's, and sleeping.

    threads: how many step at once (>= 1); None: as many as there are processors.
    Raises ValueError for a space that is not attached, or has something that worlds have not, which is named.
    """

    def __init__(self, space: pymunk.Space, n: int, threads: int | None = None) -> None:
        contact = attached(space)
        if contact is None:
            raise ValueError("expected an attached space: rigidarea.attach(space) first")
        self.n = whole(n, "n", 1)
        self.threads = len(os.sched_getaffinity(0)) if threads is None else whole(threads, "threads", 1)
        contact._between_steps("Worlds")
        _refuse(space, contact._store)
        self._call = _functions()
        self._outlines = contact._store  # shared: kept alive
        contact._store.grow_joints(len(space.constraints))
        contact._store.sync()
        self._image, memory = _image_of(contact._store, space)
        self._make_room()
        self._put(np.arange(self.n + 1), memory, 0)
        self._kept = np.zeros(4 * self.bodies + 2 * self._image.shapes + 3)
        self._pool = ThreadPoolExecutor(self.threads - 1) if self.threads > 1 else None

    def _make_room(self) -> None:
        """Memory for all worlds, and one behind them that is how they begin; scratch for each thread."""
        size = self._image.size
        room = np.zeros((self.n + 1) * size + 64, np.uint8)
        first = -address_of(ffi.from_buffer(room)) % 64
        self._memory = room[first : first + (self.n + 1) * size].reshape(self.n + 1, size)
        self._at = address_of(ffi.from_buffer(self._memory)) + size * np.arange(self.n + 1, dtype=np.uint64)
        self._scratches = [self._image.scratch() for _ in range(self.threads)]

    @property
    def bodies(self) -> int:
        """How many bodies a world has: those of `space.bodies`, in their order."""
        return self._image.count

    @property
    def nbytes(self) -> int:
        """The memory that one world takes (bytes); what is shared, and the threads' scratch, is not in it."""
        return self._image.size

    # --- stepping ---

    def step(
        self, dt: float, forces: ArrayLike | None = None, frames: int = 1, which: ArrayLike | None = None
    ) -> NDArray[np.float64]:
        """Step worlds by so many frames of dt each (time); their states after it, (k, bodies, 6).

        forces: (k, bodies, 3), along x and y at the centre of gravity, and torque, in each of the frames.
        which: (k,) numbers of the worlds to step; None: all, k = n.
        Raises ValueError for arguments of other shapes, and SimulationError where a body's state stops being finite:
        that world is as it was before the frame.
        """
        positive(dt, "dt")
        whole(frames, "frames", 1, 2**31 - 1)
        numbers = self._numbers(which)
        shape = (len(numbers), self.bodies, 3)
        given = None if forces is None else _finite(forces, shape, "forces")
        states = np.empty((len(numbers), self.bodies, 6))
        self._run(numbers, given, float(dt), frames, states)
        return states

    def _run(
        self, numbers: NDArray[np.int64], forces: Any, dt: float, frames: int, states: NDArray[np.float64]
    ) -> None:
        at = self._at[numbers]
        parts = np.array_split(np.arange(len(numbers)), min(self.threads, max(1, len(numbers))))

        def go(k: int) -> int:
            part = slice(parts[k][0], parts[k][-1] + 1)
            pushed = ffi.NULL if forces is None else ffi.from_buffer(forces[part])
            table = ffi.from_buffer(self._scratches[k][0])
            own = at[part]
            to = ffi.from_buffer(states[part])
            return int(self._call.step(ffi.from_buffer(own), table, len(own), pushed, dt, frames, to))

        if not len(numbers):
            return
        running = [self._pool.submit(go, k) for k in range(1, len(parts))] if self._pool else []
        failed = go(0) + sum(future.result() for future in running)
        if failed:
            self._try_again(numbers, forces, dt, frames, states)

    def _try_again(self, numbers: Any, forces: Any, dt: float, frames: int, states: Any) -> None:
        """Worlds whose tables were too small get more room, and the rest of their frames."""
        from .contact import SimulationError
        from .contact.alone import NOT_FINITE, TOO_SMALL, WORLD

        outcomes, done = self._field(WORLD, "outcome")[numbers], self._field(WORLD, "done")[numbers]
        broken = np.flatnonzero(outcomes == NOT_FINITE)
        if len(broken):
            raise SimulationError(
                f"the state of a body of world {numbers[broken[0]]} is not finite: it is as it was before that frame"
            )
        short = np.flatnonzero(outcomes == TOO_SMALL)
        self._grow(numbers[short])
        for count in np.unique(done[short]):
            again = short[done[short] == count]
            ends = np.empty((len(again), *states.shape[1:]))
            self._run(
                numbers[again], None if forces is None else forces[again], dt, frames - int(count), ends
            )
            states[again] = ends

    def _grow(self, numbers: NDArray[np.int64]) -> None:
        """All worlds have as much more room as these want (`Store.grow`), and begin with it when they are reset."""
        old, memory, homes = self._image, self._memory, self._at
        counters = old.counters_of(memory[numbers])
        want = [int(counters[:, which].max()) for which in (MORE_PAIRS, MORE_REGIONS, MORE_WORK)]
        self._image = old.larger(*want)
        self._make_room()
        _move_over(old, memory, homes, self._image, self._memory, self._at, self._call)

    def _numbers(self, which: ArrayLike | None) -> NDArray[np.int64]:
        if which is None:
            return np.arange(self.n)
        given = np.atleast_1d(np.asarray(which))
        if given.dtype == bool and given.shape == (self.n,):
            return np.flatnonzero(given)
        inside = given.ndim == 1 and given.dtype.kind in "iu" and ((given >= 0) & (given < self.n)).all()
        if not (inside and len(np.unique(given)) == len(given)):
            raise ValueError(f"which must be different numbers from 0 to {self.n - 1}, got {which!r:.80}")
        return given.astype(np.int64)

    # --- states ---

    @property
    def states(self) -> NDArray[np.float64]:
        """(n, bodies, 6): x, y of `position`, angle, vx, vy, angular velocity of each body now."""
        out = np.empty((self.n, self.bodies, 6))
        self._call.read(ffi.from_buffer(self._at), self.n, ffi.from_buffer(out))
        return out

    def put(self, states: ArrayLike, which: ArrayLike | None = None) -> None:
        """Put bodies there, moving so: (k, bodies, 6), of all worlds or of `which` (k,). Else ValueError."""
        numbers = self._numbers(which)
        given = _finite(states, (len(numbers), self.bodies, 6), "states")
        at = self._at[numbers]
        self._call.write(ffi.from_buffer(at), len(at), ffi.from_buffer(given))

    def reset(self, which: ArrayLike | None = None) -> None:
        """Worlds (all, or `which`) begin anew, as the space was when they were made; their parameters stay."""
        self._put(self._numbers(which), self._memory[-1], int(self._at[-1]), self._kept)

    def snapshot(self, world: int) -> WorldSnapshot:
        """A world as it is now, parameters included, for `restore`."""
        (number,) = self._numbers([world])
        return WorldSnapshot(self._memory[number].copy(), int(self._at[number]), self._image)

    def restore(self, snapshot: WorldSnapshot, which: ArrayLike) -> None:
        """Worlds are as the one was of which the snapshot was taken. ValueError for a snapshot of other worlds."""
        numbers = self._numbers(which)
        if not isinstance(snapshot, WorldSnapshot) or snapshot.image.family is not self._image.family:
            raise ValueError(f"snapshot must be one that these worlds have taken, got {snapshot!r:.80}")
        memory, home = snapshot.memory, snapshot.home
        if snapshot.image is not self._image:  # worlds have more room since
            memory = np.zeros((1, self._image.size), np.uint8)
            home = address_of(ffi.from_buffer(memory))
            _move_over(
                snapshot.image,
                snapshot.memory[None],
                np.array([snapshot.home], np.uint64),
                self._image,
                memory,
                np.array([home], np.uint64),
                self._call,
            )
        self._put(numbers, memory, home)

    def _put(self, numbers: NDArray[np.int64], memory: Any, home: int, kept: Any = None) -> None:
        at, words, size = self._at[numbers], self._image.fixups, self._image.size
        own = ffi.NULL if kept is None else ffi.from_buffer(kept)
        self._call.put(
            ffi.from_buffer(at),
            len(at),
            ffi.from_buffer(memory),
            home,
            size,
            ffi.from_buffer(words),
            len(words),
            own,
        )

    # --- parameters ---

    def _field(self, kind: Any, name: str) -> Any:
        """A field of WORLD, of all worlds, in place."""
        return self._view(kind.fields[name][1], (), (), kind.fields[name][0])

    def _view(
        self, first: int, shape: tuple[int, ...], strides: tuple[int, ...], dtype: Any = np.float64
    ) -> Any:
        """Numbers of all worlds, in place: from the byte `first` of each world on."""
        size = self._image.size
        return np.ndarray((self.n, *shape), dtype, self._memory, first, (size, *strides))

    @property
    def gravity(self) -> NDArray[np.float64]:
        """(n, 2), in place: set its elements (length/time^2). A view: ask for it again after a step."""
        return self._view(self._image.space_at + self._image.offsets_of["space_gravity"], (2,), (8,))

    @property
    def damping(self) -> NDArray[np.float64]:
        """(n,), in place: the share of its velocity that a body keeps in a unit of time."""
        from .contact.alone import WORLD

        return self._field(WORLD, "damping")

    @property
    def friction(self) -> NDArray[np.float64]:
        """(n, shapes), in place; shapes in the order of `space.shapes`."""
        return self._material(8)

    @property
    def elasticity(self) -> NDArray[np.float64]:
        """(n, shapes), in place."""
        return self._material(0)

    def _material(self, more: int) -> NDArray[np.float64]:
        image = self._image
        first = image.shapes_at + image.offsets_of["shape_elasticity"] + more
        return self._view(first, (image.shapes,), (_SHAPE,))

    @property
    def mass(self) -> NDArray[np.float64]:
        """(n, bodies): a copy; `set_mass`."""
        return self._inertia()[:, :, 0].copy()

    @property
    def moment(self) -> NDArray[np.float64]:
        """(n, bodies): a copy; `set_mass`."""
        return self._inertia()[:, :, 2].copy()

    def set_mass(self, mass: ArrayLike, moment: ArrayLike, which: ArrayLike | None = None) -> None:
        """Masses and moments (k, bodies) of all worlds, or of `which`: positive; kinematic bodies keep theirs."""
        numbers = self._numbers(which)
        own = self._inertia()
        moves = np.isfinite(own[0, :, 0])
        for given, k, name in ((mass, 0, "mass"), (moment, 2, "moment")):
            values = np.asarray(given, np.float64)
            if values.shape != (len(numbers), self.bodies) or not (values > 0).all():
                raise ValueError(
                    f"{name} must be positive, ({len(numbers)}, {self.bodies}), got {given!r:.80}"
                )
            there = np.ix_(numbers, np.flatnonzero(moves))
            own[:, :, k][there] = values[:, moves]
            own[:, :, k + 1][there] = 1.0 / values[:, moves]

    def _inertia(self) -> NDArray[np.float64]:
        """(n, bodies, 4), in place: mass, its inverse, moment, its inverse."""
        image = self._image
        first = image.bodies_at + image.offsets_of["body_inverse_mass"] - 8
        return self._view(first, (image.count, 4), (_BODY, 8))

    def joint(self, number: int) -> NDArray[np.float64]:
        """(n, m), in place: what `space.constraints[number]` is made of, as Chipmunk keeps it (a motor: its rate)."""
        image = self._image
        whole(number, "number", 0, len(image.joints) - 1)
        first, numbers = image.joints[number]
        return self._view(first, (numbers,), (8,))

    # --- contacts ---

    def contacts(self, world: int) -> NDArray[Any]:
        """The contacts of a world's last substep, one CONTACTS row each."""
        (number,) = self._numbers([world])
        image, memory = self._image, self._memory[number]
        counters, regions = image.table(memory, "counters"), image.table(memory, "regions")
        pairs, shapes = image.table(memory, "pairs"), image.table(memory, "shapes")
        live = regions[(regions["stamp"] == counters[SUBSTEP]) & (counters[SUBSTEP] > 0)]
        touching = pairs[live["pair"]]
        a, b = shapes[touching["a"]], shapes[touching["b"]]
        turned = a["ident"] > b["ident"]  # A was added first; in the tables it goes by place
        sign = np.where(turned, -1.0, 1.0)
        out = np.zeros(len(live), CONTACTS)
        out["body_a"] = image.place_of[np.where(turned, b["body"], a["body"])]
        out["body_b"] = image.place_of[np.where(turned, a["body"], b["body"])]
        out["centroid"] = np.stack([live["x"], live["y"]], 1)
        out["direction"] = sign[:, None] * np.stack([live["nx"], live["ny"]], 1)
        for name in ("area", "force", "friction", "speed"):
            out[name] = live[name]
        return out

    def __repr__(self) -> str:
        return f"<Worlds: {self.n} of {self.bodies} bodies, {self.threads} threads>"


class WorldSnapshot:
    """A world as it was: `Worlds.snapshot`."""

    def __init__(self, memory: Any, home: int, image: _Image) -> None:
        self.memory, self.home, self.image = memory, home, image


class _Image:
    """What a world's memory is like: where its parts begin (bytes), and which words are addresses in it."""

    def __init__(self, offsets: dict[str, int], lengths: dict[str, int], **facts: Any) -> None:
        self.offsets, self.lengths = offsets, lengths
        self.facts = facts
        self.__dict__.update(facts)

    def table(self, memory: Any, name: str) -> Any:
        """One of its tables, in place."""
        kind = self.kinds[name]
        at = self.offsets[name]
        return memory[at : at + self.lengths[name] * kind.itemsize].view(kind)

    def counters_of(self, memory: Any) -> Any:
        """(k, COUNTERS) of k worlds."""
        at = self.offsets["counters"]
        return np.ascontiguousarray(memory[:, at : at + 8 * COUNTERS]).view(np.int64)

    def larger(self, pairs: int, regions: int, work: int) -> _Image:
        """The same with room for so many more."""
        lengths = dict(self.lengths)
        facts = dict(self.facts)
        if work > 0:
            facts["work"] = enlarged(self.work, *(2 * most for most in self.most))
        if pairs > 0:
            lengths["pairs"] = (lengths["pairs"] + pairs) * 9 // 8
        if regions > 0:
            lengths["regions"] = (lengths["regions"] + regions) * 9 // 8
        offsets = dict(self.offsets)
        facts["size"] = _lay_out(offsets, lengths, self.kinds, offsets["pairs"])
        return _Image(offsets, lengths, **facts)

    def scratch(self) -> tuple[Any, list[Any]]:
        """A thread's: the words of the state record that say where it is, and the arrays."""
        lengths, kinds = self.lengths, self.kinds
        rows = lengths["regions"] + lengths["joints"]
        arrays = {name: np.zeros_like(array) for name, array in self.work._asdict().items()}
        arrays |= {"rows": np.zeros(rows, kinds["rows"]), "factors": np.zeros(rows, kinds["factors"])}
        arrays |= {"mobility": np.zeros(lengths["bodies"], kinds["mobility"])}
        arrays |= {f"kept_{name}": np.zeros(lengths[name], kinds[name]) for name in KEPT}
        arrays |= {"seen": np.zeros((lengths["bodies"], 3))}
        words = [len(_SCRATCH) * 2, 0]
        for name in _SCRATCH:
            field = ARRAYS.index(name)
            words += [field, address_of(ffi.from_buffer(arrays[name]))]
            words += [len(ARRAYS) + field, len(arrays[name])]
        table = np.array([words[0], *words[2:]], np.int64)
        return table, [arrays]


def _lay_out(offsets: dict[str, int], lengths: dict[str, int], kinds: dict[str, Any], at: int) -> int:
    """Where the tables that grow begin, one behind the other from `at` on; how many bytes that makes."""
    lengths["near"], lengths["told"] = lengths["pairs"] + 1, lengths["pairs"]
    lengths["table"] = max(64, 1 << (2 * lengths["pairs"] - 1).bit_length())
    for name in _GROWING:
        offsets[name] = at
        at += -(-lengths[name] * kinds[name].itemsize // 64) * 64
    return at


def _image_of(store: Store, space: pymunk.Space) -> tuple[_Image, Any]:
    """The form of a world of a space, and one, as if it began at address 0."""
    from .contact import alone, frame

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
    space_at = block(struct := _copied(space._space, _SPACE))
    joint_at = block(hidden := np.zeros(4, np.uint64))
    lists = {
        name: block(np.zeros(2 + len(rows), np.uint64))
        for name, rows in (("space_bodies", bodies), ("space_constraints", joints))
    }
    body_structs = np.stack([_copied(ffi.cast("void *", address), _BODY) for address in held])
    shape_structs = np.stack([_copied(shape._shape, _SHAPE) for shape in shapes])
    bodies_at, shapes_at = block(body_structs), block(shape_structs)
    joint_structs = [_copied(joint._constraint, _size_of_joint(joint)) for joint in joints]
    joints_at = [block(one) for one in joint_structs]
    where = {address: bodies_at + i * _BODY for i, address in enumerate(held)}
    where |= {address_of(shape._shape): shapes_at + i * _SHAPE for i, shape in enumerate(shapes)}
    where |= {address_of(joint._constraint): at for joint, at in zip(joints, joints_at)}

    arrays = {name: np.array(getattr(tables, name)) for name in (*_FIXED, *_GROWING)}
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
    stamp_at, step_at, user_at = _space_words()
    point(struct, user_at // 8, space_at, state_at)
    world["solve_at"], world["report_at"] = frame.solve.address, frame.report.address
    world["stamp_at"], world["step_at"], world["nothing_at"] = (
        stamp_at,
        step_at,
        offsets_of["body_shapes"] + 8,
    )
    world["count"], world["shapes"], world["damping"] = len(bodies), len(shapes), space.damping
    world["body_size"], world["shape_size"] = _BODY, _SHAPE
    for name, there in lists.items():
        point(struct, offsets_of[name] // 8, space_at, there)
        listed = next(array for at, array in memory if at == there)
        listed[0] = len(listed) - 2
        point(listed, 1, there, there + 16)
        rows = [b._body for b in bodies] if name == "space_bodies" else [j._constraint for j in joints]
        for i, row in enumerate(rows):
            point(listed, 2 + i, there, where[address_of(row)])
    for i in range(len(held)):
        words = body_structs[i].view(np.uint64)
        at, first = bodies_at + i * _BODY, offsets_of["body_shapes"] // 8
        if words[first]:
            point(body_structs[i], first, at, where[int(words[first])])
        if i < len(bodies):
            words[offsets_of["body_position_func"] // 8] = offsets_of["hold_at"]
        words[first + 1] = 0
    for i in range(len(shapes)):
        at, words = shapes_at + i * _SHAPE, shape_structs[i].view(np.uint64)
        for name, kind in (("shape_next", where), ("shape_body", where)):
            k = offsets_of[name] // 8
            if words[k]:
                point(shape_structs[i], k, at, kind[int(words[k])])
    for one, at in zip(joint_structs, joints_at):
        for k in (offsets_of["constraint_a"] // 8, offsets_of["constraint_a"] // 8 + 1):
            point(one, k, at, where[int(one.view(np.uint64)[k])])
    for name, n in (("bodies", counters[BODIES]), ("shapes", counters[SHAPES]), ("joints", counters[JOINTS])):
        kind = kinds[name]
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
    record["ask_at"], record["phases_at"], record["user_pre_solve"] = alone.no_answer.address, 0, 0
    record["substeps"], record["steps_given"], record["tolerance"] = SUBSTEPS, 0, 0.0
    record["sweeps"], record["joint_count"], record["asleep"] = space.iterations, 0, 0
    image = np.zeros(total, np.uint8)
    for at, array in [*memory, *((offsets[name], arrays[name]) for name in _GROWING)]:
        image[at : at + array.nbytes] = np.ascontiguousarray(array).reshape(-1).view(np.uint8)
    place_of = np.full(lengths["bodies"], -1, np.int32)
    for i, address in enumerate(own):
        place_of[store.row_of(address)] = i
    kinds |= {name: getattr(tables, name).dtype for name in ("rows", "factors", "mobility")}
    facts = {
        "size": total,
        "count": len(bodies),
        "shapes": len(shapes),
        "offsets_of": offsets_of,
        "kinds": kinds,
    }
    facts |= {"space_at": space_at, "bodies_at": bodies_at, "shapes_at": shapes_at, "state_at": state_at}
    made_of = [_kind_of(joint) for joint in joints]
    facts |= {"joints": [(at + kind.parameters, kind.numbers) for at, kind in zip(joints_at, made_of)]}
    facts |= {
        "fixups": np.array(fixups, np.int64),
        "place_of": place_of,
        "work": store.work,
        "most": store._most,
    }
    return _Image(offsets, lengths, family=store, **facts), image


def _move_over(old: _Image, memory: Any, homes: Any, new: _Image, to: Any, at: Any, call: Any) -> None:
    """Worlds of one form (k, size), whose addresses are of `homes`, in the form of another that has more room."""
    from .contact.moved import HEAD

    first = old.offsets["pairs"]
    to[:, :first] = memory[:, :first]
    for name in _GROWING:
        n = old.lengths[name] * old.kinds[name].itemsize
        to[:, new.offsets[name] : new.offsets[name] + n] = memory[
            :, old.offsets[name] : old.offsets[name] + n
        ]
    words = to.view(np.int64)
    words[:, new.fixups] += (at - homes).astype(np.int64)[:, None]
    for name in _GROWING:
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
    kind = _kind_of(joint)
    ends = kind.impulse + 8 * kind.impulses, kind.parameters + 8 * kind.numbers, kind.force + 8
    return max(*ends, 96)


def _kind_of(joint: pymunk.Constraint) -> Any:
    own = int(ffi.cast("uintptr_t *", joint._constraint)[0])
    return next((kind for kind in kinds_of_joints() if kind.own_class == own), None)


def _refuse(space: pymunk.Space, store: Store) -> None:
    """ValueError for what worlds have not."""
    state, off = store.state[0], {name: int(store.state[0][name]) for name in OFFSETS}
    why = []
    if state["explicit"]:
        why.append('integration="explicit"')
    if any(
        getattr(handler, f"_{phase}") not in (None, pymunk.empty_callback)
        for handler in space._handlers.values()
        for phase in ("begin", "pre_solve", "post_solve", "separate")
    ):
        why.append("collision callbacks")
    if space.sleep_time_threshold != float("inf"):
        why.append("sleeping (sleep_time_threshold)")
    ours = {
        "velocity": {off["velocity_func"], off["velocity_func_again"]},
        "position": {off["position_func"], off["position_func_again"], int(state["hold_at"])},
    }
    for kind, known in ours.items():
        words = (
            int(ffi.cast("uintptr_t *", body._body)[off[f"body_{kind}_func"] // 8]) for body in space.bodies
        )
        if any(word not in known for word in words):
            why.append(f"a {kind}_func")
    for joint in space.constraints:
        kind = _kind_of(joint)
        words = ffi.cast("uintptr_t *", joint._constraint)
        if kind is None:
            why.append(f"a {type(joint).__name__} that is none of pymunk's")
        elif kind.force and int(words[kind.force // 8]) != kind.own_force:
            why.append("a spring's own force function")
        if joint.pre_solve is not None or joint.post_solve is not None:
            why.append("callbacks of joints")
    if why:
        raise ValueError(
            f"expected a space that can be stepped without Python, got one with {', '.join(dict.fromkeys(why))}"
        )


@lru_cache(maxsize=1)
def _space_words() -> tuple[int, int, int]:
    """Where a space keeps its count of steps, its time step, and its user's word (bytes)."""
    space = pymunk.Space()
    lib.cpSpaceStep(space._space, 0.125)  # not space.step, which somebody may have wrapped
    lib.cpSpaceSetUserData(space._space, ffi.cast("void *", 0x5152535455565758))
    copy = _copied(space._space, _SPACE)
    lib.cpSpaceSetUserData(space._space, ffi.NULL)
    steps = np.flatnonzero(copy.view(np.float64) == 0.125)
    users = np.flatnonzero(copy.view(np.uint64) == 0x5152535455565758)
    stamps = []
    for k in np.flatnonzero(copy.view(np.uint32) == 1):
        changed = copy.copy()
        changed.view(np.uint32)[k] = 4711
        if lib.cpSpaceGetTimestamp(ffi.cast("cpSpace *", address_of(ffi.from_buffer(changed)))) == 4711:
            stamps.append(k)
    found = {"time step": steps, "user data": users, "count of steps": stamps}
    for name, places in found.items():
        if len(places) != 1:
            raise LayoutError(f"{name}: expected one place in Chipmunk's space, found {len(places)}")
    return 4 * int(stamps[0]), 8 * int(steps[0]), 8 * int(users[0])


@lru_cache(maxsize=1)
def _functions() -> Any:
    from types import SimpleNamespace

    from .contact import alone

    kinds = {
        "step": "long long(*)(void *, void *, long long, void *, double, long long, void *)",
        "read": "void(*)(void *, long long, void *)",
        "write": "void(*)(void *, long long, void *)",
        "put": "void(*)(void *, long long, void *, long long, long long, void *, long long, void *)",
        "enlarged": "void(*)(void *, long long, void *)",
    }
    return SimpleNamespace(
        **{name: ffi.cast(kind, getattr(alone, name).address) for name, kind in kinds.items()}
    )


def _finite(given: ArrayLike, shape: tuple[int, ...], name: str) -> NDArray[np.float64]:
    """An array of just that shape."""
    try:
        values = np.ascontiguousarray(given, np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"{name} must be finite numbers, {shape}, got {given!r:.80}") from None
    if values.shape != shape or not np.isfinite(values).all():
        raise ValueError(f"{name} must be finite numbers, {shape}, got {values.shape}")
    return values
