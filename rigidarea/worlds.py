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
from pymunk._chipmunk_cffi import ffi

from .chipmunk import address_of
from .contact import attached
from .contact.arrays import Store
from .contact.image import BODY_BYTES, SHAPE_BYTES, Image, image_of, kind_of, move_over
from .gate import whole
from .kernel.tables import (
    MORE_PAIRS,
    MORE_REGIONS,
    MORE_WORK,
    SUBSTEP,
)
from .outline import positive
from .store import OFFSETS

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
        self._image, memory = image_of(contact._store, space)
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
        move_over(old, memory, homes, self._image, self._memory, self._at, self._call)

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
            move_over(
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
        return self._view(first, (image.shapes,), (SHAPE_BYTES,))

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
        return self._view(first, (image.count, 4), (BODY_BYTES, 8))

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

    def __init__(self, memory: Any, home: int, image: Image) -> None:
        self.memory, self.home, self.image = memory, home, image


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
        kind = kind_of(joint)
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
