"""Many worlds at once: copies of attached spaces that step without Chipmunk, Python or one another, in threads.

    worlds = rigidarea.worlds.Worlds(space, 1024)  # or Worlds([one, another, ...], 1024)
    states = worlds.step(1 / 60, forces)

A world is one block of memory (`chipmunk/alone.py`); geometry is shared by all.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from functools import wraps
from typing import Any, Concatenate, ParamSpec, TypeVar

import numpy as np
import pymunk
from numpy.typing import ArrayLike, NDArray
from pymunk._chipmunk_cffi import ffi

from .chipmunk import attached
from .chipmunk.many import Many, WorldSnapshot
from .chipmunk.steppable import check_steppable
from .chipmunk.world_image import BODY_BYTES, SHAPE_BYTES, Image
from .contact.tables import SUBSTEP
from .geometry.gate import positive, whole

CONTACTS = np.dtype(
    [
        *((name, "i4") for name in ("world", "body_a", "body_b")),
        *((name, "f8", 2) for name in ("centroid", "direction")),
        *((name, "f8") for name in ("area", "force", "friction", "speed")),
    ]
)
"""A contact: the number of its world; the places of its bodies in `space.bodies` (-1: what is not among them); centroid
(length, world), direction (unit, A to B), area (length^2), normal force and friction (force), closing speed
(length/time)."""


_P = ParamSpec("_P")
_R = TypeVar("_R")


def _alone(call: Callable[Concatenate[Worlds, _P], _R]) -> Callable[Concatenate[Worlds, _P], _R]:
    """The call, refused while another one of the same worlds runs: two would write over each other's memory."""

    @wraps(call)
    def guarded(self: Worlds, *args: _P.args, **kwargs: _P.kwargs) -> _R:
        if not self._free.acquire(blocking=False):
            raise RuntimeError(
                f"expected one call of these worlds at a time, got {call.__name__} while another runs"
            )
        try:
            return call(self, *args, **kwargs)
        finally:
            self._free.release()

    return guarded


class Worlds(Many):
    """n copies of an attached space, or of several, each with its own state and parameters.

    They begin as the space is now, contacts included, and the space itself goes on by itself. A world's frame gives the
    same bits as the space's own would (where its tables have room), whatever the number of threads. They run
    `integration="implicit"`, without callbacks, velocity and position functions of the user's, and sleeping.

    space: an attached space, or a sequence of them: world i is a copy of number i modulo their number. Arrays have as
    many rows of bodies and shapes as the largest needs; what a world has no body for (`mask`) is 0, or ignored.
    n: a multiple of the number of spaces; None: one of each.
    threads: how many step at once (>= 1); None: as many as there are processors.
    Raises ValueError for a space that is not attached, or has something that worlds have not, which is named. A call
    raises RuntimeError while another of the same worlds runs, from another thread of Python.
    """

    def __init__(
        self, space: pymunk.Space | Sequence[pymunk.Space], n: int | None = None, threads: int | None = None
    ) -> None:
        given = [space] if isinstance(space, pymunk.Space) else space
        spaces = list(given) if isinstance(given, Iterable) else []
        if not spaces or not all(isinstance(one, pymunk.Space) for one in spaces):
            raise ValueError(f"expected a space, or a sequence of them, got {space!r:.80}")
        contacts = [contact for contact in map(attached, spaces) if contact is not None]
        if len(contacts) < len(spaces):
            raise ValueError("expected an attached space: rigidarea.attach(space) first")
        n = whole(len(spaces) if n is None else n, "n", 1)
        if n % len(spaces):
            raise ValueError(f"n must be a multiple of the number of spaces, {len(spaces)}, got {n}")
        threads = _processors() if threads is None else whole(threads, "threads", 1)
        stores = [contact._store for contact in contacts]
        for one, contact, store in zip(spaces, contacts, stores):
            contact._between_steps("Worlds")
            check_steppable(one, store)
            store.grow_joints(len(one.constraints))
            store.sync()
        super().__init__(spaces, stores, n, threads)
        self._free = threading.Lock()
        self._kept = np.zeros(4 * self.bodies + 2 * self._shapes + 3)
        self._pool = ThreadPoolExecutor(self.threads - 1) if self.threads > 1 else None

    @property
    def bodies(self) -> int:
        """How many bodies a world has, at the most: those of `space.bodies`, in their order."""
        return max(image.count for image in self._images)

    @property
    def _shapes(self) -> int:
        return max(image.shapes for image in self._images)

    @property
    def mask(self) -> NDArray[np.bool_]:
        """(n, bodies): where there is a body. All are there, unless the spaces have different numbers of bodies."""
        counts = np.resize([image.count for image in self._images], self.n)
        return np.arange(self.bodies) < counts[:, None]

    # --- stepping ---

    @_alone
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
        states = np.zeros((len(numbers), self.bodies, 6))
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
            to, rows = ffi.from_buffer(states[part]), states.shape[1]
            return int(self._call.step(ffi.from_buffer(own), table, len(own), rows, pushed, dt, frames, to))

        if not len(numbers):
            return
        running = [self._pool.submit(go, k) for k in range(1, len(parts))] if self._pool else []
        try:
            failed = go(0) + sum(future.result() for future in running)
        finally:
            wait(running)  # an interrupt may come between: nothing goes on behind the next call
        if failed:
            self._try_again(numbers, forces, dt, frames, states)

    def _try_again(self, numbers: Any, forces: Any, dt: float, frames: int, states: Any) -> None:
        """Worlds whose tables were too small get more room, and the rest of their frames."""
        from .chipmunk import SimulationError
        from .chipmunk.alone import NOT_FINITE, TOO_SMALL, WORLD

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
            ends = np.zeros((len(again), *states.shape[1:]))
            self._run(
                numbers[again], None if forces is None else forces[again], dt, frames - int(count), ends
            )
            states[again] = ends

    def _numbers(self, which: ArrayLike | None) -> NDArray[np.int64]:
        if which is None:
            return np.arange(self.n)
        given = np.atleast_1d(np.asarray(which))
        if given.dtype == bool and given.shape == (self.n,):
            return np.flatnonzero(given)
        if given.shape == (0,):  # of no list numpy makes floats
            return np.zeros(0, np.int64)
        inside = given.ndim == 1 and given.dtype.kind in "iu" and ((given >= 0) & (given < self.n)).all()
        if not (inside and len(np.unique(given)) == len(given)):
            raise ValueError(f"which must be different numbers from 0 to {self.n - 1}, got {which!r:.80}")
        return given.astype(np.int64)

    # --- states ---

    @property
    @_alone
    def states(self) -> NDArray[np.float64]:
        """(n, bodies, 6): x, y of `position`, angle, vx, vy, angular velocity of each body now."""
        out = np.zeros((self.n, self.bodies, 6))
        self._call.read(ffi.from_buffer(self._at), self.n, self.bodies, ffi.from_buffer(out))
        return out

    @_alone
    def put(self, states: ArrayLike, which: ArrayLike | None = None) -> None:
        """Put bodies there, moving so: (k, bodies, 6), of all worlds or of `which` (k,). Else ValueError."""
        numbers = self._numbers(which)
        given = _finite(states, (len(numbers), self.bodies, 6), "states")
        at = self._at[numbers]
        self._call.write(ffi.from_buffer(at), len(at), self.bodies, ffi.from_buffer(given))

    @_alone
    def reset(self, which: ArrayLike | None = None) -> None:
        """Worlds (all, or `which`) begin anew, as the space was when they were made; their parameters stay."""
        for first, own in self._by_space(self._numbers(which)):
            self._put(own, self._memory[self.n + first], int(self._at[self.n + first]), self._kept)

    @_alone
    def snapshot(self, world: int) -> WorldSnapshot:
        """A world as it is now, parameters included, for `restore`."""
        (number,) = self._numbers([world])
        image = self._images[number % len(self._images)]
        return WorldSnapshot(self._memory[number, : image.size].copy(), int(self._at[number]), image)

    @_alone
    def restore(self, snapshot: WorldSnapshot, which: ArrayLike) -> None:
        """Worlds are as the one was of which the snapshot was taken. ValueError for a snapshot of other worlds."""
        numbers = self._numbers(which)
        images = [self._images[first] for first, _ in self._by_space(numbers)]
        if not isinstance(snapshot, WorldSnapshot) or any(
            image.family is not snapshot.image.family for image in images
        ):
            raise ValueError(f"snapshot must be one that these worlds have taken, got {snapshot!r:.80}")
        for first, own in self._by_space(numbers):
            self._put(own, *self._brought_over(snapshot, self._images[first]))

    # --- parameters ---

    @property
    @_alone
    def gravity(self) -> NDArray[np.float64]:
        """(n, 2), in place: set its elements (length/time^2). A view: ask for it again after a step."""
        image = self._images[0]  # spaces, bodies and shapes are at the same places in all
        return self._view(image.space_at + image.offsets_of["space_gravity"], (2,), (8,))

    @property
    @_alone
    def damping(self) -> NDArray[np.float64]:
        """(n,), in place: the share of its velocity that a body keeps in a unit of time."""
        from .chipmunk.alone import WORLD

        return self._field(WORLD, "damping")

    @property
    @_alone
    def friction(self) -> NDArray[np.float64]:
        """(n, shapes), in place; shapes in the order of `space.shapes`."""
        return self._material(8)

    @property
    @_alone
    def elasticity(self) -> NDArray[np.float64]:
        """(n, shapes), in place."""
        return self._material(0)

    def _material(self, more: int) -> NDArray[np.float64]:
        image = self._images[0]
        first = image.shapes_at + image.offsets_of["shape_elasticity"] + more
        return self._view(first, (self._shapes,), (SHAPE_BYTES,))

    @property
    @_alone
    def mass(self) -> NDArray[np.float64]:
        """(n, bodies): a copy; `set_mass`."""
        return np.where(self.mask, self._inertia()[:, :, 0], 0.0)

    @property
    @_alone
    def moment(self) -> NDArray[np.float64]:
        """(n, bodies): a copy; `set_mass`."""
        return np.where(self.mask, self._inertia()[:, :, 2], 0.0)

    @_alone
    def set_mass(self, mass: ArrayLike, moment: ArrayLike, which: ArrayLike | None = None) -> None:
        """Masses and moments (k, bodies) of all worlds, or of `which`; kinematic bodies keep theirs.

        Raises ValueError unless masses are positive and finite, moments positive (infinite: what never turns).
        """
        numbers = self._numbers(which)
        own, there = self._inertia()[numbers], self.mask[numbers]
        moves = there & np.isfinite(own[:, :, 0])
        for given, k, name in ((mass, 0, "mass"), (moment, 2, "moment")):
            values = np.asarray(given, np.float64)
            fine = values.shape == there.shape and (values[there] > 0).all()
            if not fine or (name == "mass" and not np.isfinite(values[moves]).all()):
                wanted = "positive and finite" if name == "mass" else "positive"
                raise ValueError(f"{name} must be {wanted}, {there.shape}, got {given!r:.80}")
            own[moves, k], own[moves, k + 1] = values[moves], 1.0 / values[moves]
        self._inertia()[numbers] = own

    def _inertia(self) -> NDArray[np.float64]:
        """(n, bodies, 4), in place: mass, its inverse, moment, its inverse."""
        image = self._images[0]
        first = image.bodies_at + image.offsets_of["body_inverse_mass"] - 8
        return self._view(first, (self.bodies, 4), (BODY_BYTES, 8))

    @_alone
    def joint(self, number: int) -> NDArray[np.float64]:
        """(n, m), in place: what `space.constraints[number]` is made of, as Chipmunk keeps it (a motor: its rate).

        ValueError where there is no such joint, or where spaces have not the same kinds of joints up to it.
        """
        whole(number, "number", 0, min(len(image.joints) for image in self._images) - 1)
        places = {image.joints[number] for image in self._images}
        if len(places) > 1:
            raise ValueError(f"expected spaces with the same kinds of joints up to number {number}")
        ((first, numbers),) = places
        return self._view(first, (numbers,), (8,))

    # --- contacts ---

    @_alone
    def contacts(self, which: ArrayLike | None = None) -> NDArray[Any]:
        """The contacts of the last substep of a world, or of several, or of all: one CONTACTS row each, by worlds."""
        numbers = self._numbers(which)
        found = [self._contacts(self._images[first], own) for first, own in self._by_space(numbers)]
        out = np.concatenate(found) if found else np.zeros(0, CONTACTS)
        return out[np.argsort(out["world"], kind="stable")]

    def _contacts(self, image: Image, numbers: NDArray[np.int64]) -> NDArray[Any]:
        """Of worlds that are copies of one space."""
        regions, pairs, shapes = (self._table(image, name) for name in ("regions", "pairs", "shapes"))
        now = self._table(image, "counters")[numbers, SUBSTEP][:, None]
        row, place = np.nonzero((regions["stamp"][numbers] == now) & (now > 0))
        world = numbers[row]
        live = regions[world, place]
        touching = pairs[world, live["pair"]]
        a, b = shapes[world, touching["a"]], shapes[world, touching["b"]]
        turned = a["ident"] > b["ident"]  # A was added first; in the tables it goes by place
        sign = np.where(turned, -1.0, 1.0)
        out = np.zeros(len(live), CONTACTS)
        out["world"] = world
        out["body_a"] = image.place_of[np.where(turned, b["body"], a["body"])]
        out["body_b"] = image.place_of[np.where(turned, a["body"], b["body"])]
        out["centroid"] = np.stack([live["x"], live["y"]], 1)
        out["direction"] = sign[:, None] * np.stack([live["nx"], live["ny"]], 1)
        for name in ("area", "force", "friction", "speed"):
            out[name] = live[name]
        return out

    def __repr__(self) -> str:
        return f"<Worlds: {self.n} of {self.bodies} bodies, {self.threads} threads>"


def _processors() -> int:
    """How many this process may use, or, where the system does not say, how many there are."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _finite(given: ArrayLike, shape: tuple[int, ...], name: str) -> NDArray[np.float64]:
    """An array of just that shape."""
    try:
        values = np.ascontiguousarray(given, np.float64)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{name} must be finite numbers, {shape}, got {given!r:.80}") from None
    if values.shape != shape or not np.isfinite(values).all():
        raise ValueError(f"{name} must be finite numbers, {shape}, got {values.shape}")
    return values
