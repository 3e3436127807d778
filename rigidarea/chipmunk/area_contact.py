"""`AreaContact`: the contact of one attached space, by which it is stepped, looked at, copied, detached."""

from __future__ import annotations

import math
import os
import time
import weakref
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numpy as np
import pymunk
from pymunk._chipmunk_cffi import ffi

from ..compile.jit import lock_for_fork
from ..contact.constants import FOLLOWED, MOST_SUBSTEPS, SUBSTEPS
from ..contact.join import SPARE
from ..contact.tables import CHORD, LAW_AREA, LAW_ENERGY, NODAL
from ..geometry.gate import fraction, positive, whole
from .arrays import Store, load_growth
from .asked import keep, raise_kept, serve
from .contact_report import regions_of, total_energy
from .joint_structs import kinds_of_joints
from .memory import Memory, recall, remember, take_arbiters
from .register import Register
from .snapshots import ROOM, Snapshot
from .space import KEY, attached_class
from .structs import address_of, layout

LAWS = {"area": LAW_AREA, "energy": LAW_ENERGY}
DIRECTIONS = {"chord": CHORD, "nodal": NODAL}
#: Frames on end go through machine code for no longer than about this (s): then Python may be interrupted.
ATTENTION = 0.1


if hasattr(os, "register_at_fork"):  # a child in which a thread that it has not would compile for ever
    _before, _after = lock_for_fork()
    os.register_at_fork(before=_before, after_in_parent=_after, after_in_child=_after)


class AreaContact:
    """Area contact of one space: what `attach` returns."""

    # what is not here cannot be set: `contact.steps = 8` would do nothing
    __slots__ = (
        *("__weakref__", "_ask", "_before", "_error", "_hook", "_kinds", "_memory", "_plain", "_register"),
        *("_rouse", "_scratch", "_settings", "_snapshot_room", "_space", "_state", "_stepping", "_store"),
    )
    _compiled = False  # what measures energy, in this process

    def __init__(self, space: pymunk.Space, settings: dict[str, Any]) -> None:
        if "law" not in settings:
            raise ValueError(f"expected the settings of rigidarea.attach (which makes this), got {settings}")
        self._settings = settings
        self._memory: Memory | None = None
        self._space: pymunk.Space | None = None
        self._install(space)

    # --- attaching ---

    def _install(self, space: pymunk.Space) -> None:
        from . import joints, record, waking  # the machine code: compiled, or loaded, when first attached
        from .hook import Hook

        self._error: BaseException | None = None
        self._before: list[tuple[pymunk.Body, tuple[float, ...]]] = []
        self._stepping = False
        self._snapshot_room = ROOM
        bodies = max(16, len(space._bodies) + 1)
        # room for a contact of each body, and what a frame wants beyond (`has_room`): where there are more, a frame is
        # run again (a copy takes its original's tables)
        pairs, regions = (2 * bodies + SPARE, 3 * bodies // 2 + SPARE) if self._memory is None else (2, 1)
        self._store = Store(bodies, max(16, len(space._shapes)), pairs, regions)
        self._state = state = self._store.state[0]
        settings = self._settings
        self._store.note_layout(layout())
        state["law"] = LAWS[settings["law"]]
        state["direction"] = DIRECTIONS[settings["direction"]]
        state["exponent"] = settings["exponent"]
        state["length"] = settings["length"] or 0.0
        state["stiffness"] = settings["stiffness"] or 0.0
        state["stiffness_given"] = settings["stiffness"] is not None
        state["penetration"] = settings["penetration"]
        state["rest_speed"] = -1.0 if settings["rest_speed"] is None else settings["rest_speed"]
        state["explicit"] = settings["integration"] == "explicit"
        state["followed"] = math.inf if state["explicit"] else FOLLOWED
        state["substeps"] = SUBSTEPS
        state["frame"] = state["broken"] = -1
        state["handler_count"] = state["shape_count"] = -1
        state["pending"] = 2
        self._scratch = np.zeros(8)
        self._kinds = np.array(kinds_of_joints(), np.uint64)
        state["scratch_at"], state["kinds_at"] = self._scratch.ctypes.data, self._kinds.ctypes.data
        state["seize_at"] = joints.seize.address
        own = weakref.ref(self)  # C keeps no Python object alive
        self._ask = ffi.callback(
            "void(uintptr_t)",
            lambda request: serve(own, request),
            # an interrupt at its first line too
            onerror=lambda kind, error, trace: keep(own, error, trace, record.REGISTER),
        )
        state["ask_at"] = address_of(self._ask)
        self._space = space
        self._plain = type(space)
        space.__class__ = attached_class(self._plain)
        space.__dict__[KEY] = self
        self._rouse = ffi.cast("int (*)(void *, double)", waking.rouse.address)
        self._hook = Hook(space, self._store)
        self._register = Register(self._store, self._hook)
        try:
            self._update()
            if self._memory is not None:
                recall(self._store, space, self._memory)
                self._memory = None
            if not AreaContact._compiled:
                self.energy()  # compiled now, not when it is asked for
                load_growth()
                AreaContact._compiled = True
            if settings["flexible"] is not None:
                settings["flexible"].enter(space)
        except BaseException:  # a shape that cannot be a contact's, an interrupt
            self.detach()
            raise

    @property
    def space(self) -> pymunk.Space:
        """The attached space. RuntimeError after `detach`."""
        if self._space is None:
            raise RuntimeError("this contact is detached: attach the space again")
        return self._space

    def detach(self) -> None:
        """Give the space Chipmunk's own response back, as if nothing had been. Does nothing when called again.

        Raises RuntimeError within a step.
        """
        space = self._space
        if space is None:
            return
        if space._locked:
            raise RuntimeError("detach() within a step: call it after the step")
        if self._settings["flexible"] is not None:
            self._settings["flexible"].leave(space)
        self._hook.remove(space)
        space.__class__ = self._plain
        del space.__dict__[KEY]
        self._space = None

    # --- shapes ---

    def _update(self) -> None:
        """Bring the tables up to what the space holds: bodies, shapes, whose callbacks there are."""
        self._register.update(self.space)
        if self._settings["length"] is None and self._settings["law"] == "energy":
            self._state["length"] = self._register.largest()

    def _catch_up(self) -> None:
        """What has come or gone since the last frame is entered, or forgotten."""
        if self._state["pending"] and not self.space._locked:
            self._update()

    def refresh(self, shape: pymunk.Shape) -> None:
        """Read a shape's geometry again, after `unsafe_set_vertices` and the like; so do pymunk's `reindex_...`.

        Raises ValueError for a shape that is not in the space, or that has no area now.
        """
        assert self.space is not None  # says so if detached
        self._register.refresh(shape)

    @property
    def stiffness(self) -> float | None:
        """k of F = k A (force/length^2) for all pairs; None: each pair's by the load that it carries.

        May be set between frames; ValueError unless it is None, or positive and finite.
        """
        return float(self._state["stiffness"]) if self._state["stiffness_given"] else None

    @stiffness.setter
    def stiffness(self, value: float | None) -> None:
        given = None if value is None else positive(value, "stiffness")
        self._settings["stiffness"] = given
        self._state["stiffness"], self._state["stiffness_given"] = given or 0.0, given is not None
        self._store.tables.pairs["rate"] = 0.0

    @property
    def penetration(self) -> float:
        """How deep bodies may sink, as a fraction of the smallest extent, where no stiffness is given.

        Set between frames: pairs that touch for the first time take it at once, the others' stiffness follows by a few
        per cent a frame, so that the energy which they store does not jump. ValueError unless between 0 and 1.
        """
        return float(self._state["penetration"])

    @penetration.setter
    def penetration(self, value: float) -> None:
        self._settings["penetration"] = self._state["penetration"] = fraction(value, "penetration")

    # --- stepping ---

    def step(
        self, dt: float, frames: int = 1, steps: int | None = None, tolerance: float | None = None
    ) -> int:
        """Advance the space by `frames` frames of dt (time) each: what `space.step(dt)` does, and settings for it.

        steps: substeps of each frame, to 1,024. More are more accurate, all are stable. Default: two, one while hardly
            anything moves, more for islands where teeth or slots of a concave outline would pass each other unseen.
            `ask` has islands take more.
        tolerance: as many substeps as each frame needs for no body's place to change by more than this fraction of
            its smallest extent when they are doubled (MOST_SUBSTEPS at the most). Not together with `steps`.

        Frames on end can be interrupted (Ctrl-C) between two of them.
        Returns the substeps of the last frame, of the island that took most.
        Raises ValueError for arguments out of range, SimulationError (naming body and frame) where a body's state
        stops being finite; all bodies are then as they were before that frame.
        """
        positive(dt, "dt")
        whole(frames, "frames", 1, 2**31 - 1)
        space = self.space
        if space._locked:
            raise RuntimeError("step() within a step: call it after the step")
        if steps is not None and tolerance is not None:
            raise ValueError(f"expected steps or tolerance, got both: {steps!r} and {tolerance!r}")
        if tolerance is not None:
            positive(tolerance, "tolerance")
        if steps is not None:
            whole(steps, "steps", 1, MOST_SUBSTEPS)
        self._state["substeps"], self._state["steps_given"] = steps or SUBSTEPS, steps is not None
        self._state["tolerance"] = tolerance or 0.0
        try:
            if frames == 1:
                space.step(dt)
                return int(self._state["taken"])
            done, chunk = 0, 1
            while done < frames:
                if self._step_alone():
                    space.step(dt)
                    done += 1
                else:
                    start = time.perf_counter()
                    done += self._run(dt, min(chunk, frames - done))
                    chunk = 2 * chunk if time.perf_counter() - start < ATTENTION else max(1, chunk // 2)
        finally:
            self._state["substeps"], self._state["steps_given"], self._state["tolerance"] = SUBSTEPS, 0, 0.0
        return int(self._state["taken"])

    def ask(self, body: pymunk.Body, steps: int | None) -> None:
        """Have a body's island take at least so many substeps a frame; None takes it back.

        An island is what may touch within a frame, or is jointed, directly or through others that move: gears
        beside a pile may take sixteen while the pile takes two. Ignored where `step` is given a tolerance.
        Raises ValueError for a body that is not in the space, or steps that are no whole number from 1 to 1,024.
        """
        if not isinstance(body, pymunk.Body) or body.space is not self.space:
            raise ValueError(f"body must be one of the space's, got {body!r:.80}")
        if steps is not None:
            whole(steps, "steps", 1, MOST_SUBSTEPS)
        self._catch_up()
        self._store.tables.bodies[self._store.row_of(address_of(body._body))]["asked"] = steps or 0

    def _step_alone(self) -> bool:
        """Whether pymunk has something to do around each step."""
        space = self.space
        flexible = self._settings["flexible"] is not None
        asleep = bool(self._state["asleep"])
        proxies = bool(self._register.proxies)
        return bool(
            space.threaded or space._bodies_to_check or space._handlers or flexible or asleep or proxies
        )

    def _flexed(self, dt: float, rest: Callable[[], None]) -> None:
        """A frame of pymunk's, `rest`, after the flexible parts' own motion, if there are any."""
        space = self.space
        self._catch_up()
        if self._state["asleep"] and not space._locked:
            while not self._rouse(space._space, dt):
                self._store.grow()
        flexible = self._settings["flexible"]
        self._stepping = True
        try:
            if flexible is None:
                self._exactly(rest)
            else:
                flexible.step(dt, lambda: self._exactly(rest), int(self._state["idle_kind"]))
        finally:
            self._stepping = False
            if self._error is not None or self._state["failed"]:
                raise_kept(self)

    def _exactly(self, rest: Callable[[], None]) -> None:
        """A step of pymunk's, which hears of outlines where they touch, not where their proxies do."""
        if not self._register.proxies or self.space._locked:
            rest()
            return
        self._hook.spy.come(self.space)
        try:
            rest()
        finally:
            self._hook.spy.go(self.space)

    def _run(self, dt: float, frames: int) -> int:
        """Frames on end, in machine code."""
        from . import hidden_constraint

        space = self.space
        space._locked = self._stepping = True
        try:
            advance = ffi.cast("long long(*)(void *, double, long long)", hidden_constraint.advance.address)
            taken = int(advance(space._space, dt, frames))
        finally:
            space._locked = self._stepping = False
            if self._error is not None or self._state["failed"]:
                raise_kept(self)
        if space._add_later or space._remove_later:
            space.step(0.0)  # what a velocity function added or removed: pymunk's own way
        return max(taken, 1)

    # --- what it shows ---

    @property
    def regions(self) -> np.ndarray:
        """The contact regions of the last substep, one REGIONS row each; the order means nothing.

        Fields: `shape_a`, `shape_b`, `body_a`, `body_b` (A was added first); `area` (length^2); `centroid` (2,), where
        the force acts (length, world); `direction` (2,), unit, from A to B; `chord` (length); `stiffness`, k of F = k A
        (force/length^2); `force`, on B along `direction`, on A the opposite; `friction`, on B along `direction` turned
        by +90 degrees (force); `speed`, with which they close, and `slip`, of A along B, surface velocity included
        (length/time). Of flexible parts too: as they were at the end of their own motion, their speeds left out.
        """
        assert self.space is not None  # says so if detached
        self._catch_up()
        own, flexible = regions_of(self._store, self._register.shapes), self._settings["flexible"]
        return own if flexible is None else np.concatenate([own, flexible.rows(own.dtype)])

    def energy(self) -> float:
        """Kinetic energy, plus potential in the space's gravity, plus what the contacts store (force length).

        The potential is 0 where a centre of gravity is at the origin. Raises RuntimeError after `detach`.
        """
        assert self.space is not None  # says so if detached
        self._catch_up()
        return total_energy(self.space, self._store)

    def __repr__(self) -> str:
        if self._space is None:
            return "<AreaContact, detached>"
        bodies, shapes = len(self._space.bodies), len(self._space.shapes)
        regions, name = "", "penetration" if self.stiffness is None else "stiffness"
        # what is wrong with a shape that has come is said when the space is stepped
        with suppress(ValueError):
            regions = f"{len(self.regions)} regions, " if not self._space._locked else ""
        return f"<AreaContact of {bodies} bodies, {shapes} shapes, {regions}{name} {getattr(self, name):g}>"

    # --- snapshots, copies ---

    def snapshot(self) -> Snapshot:
        """The space as it is now, for `restore`: to go back, to try what an action leads to, to begin anew.

        What is in it: of bodies mass, place, motion, forces, who sleeps; joints' impulses; all contacts; what callbacks
        were told. After `restore` the run goes on with the same bits. Materials, filters, joints' parameters and the
        space's own settings are not: they stay as they are. Raises RuntimeError within a step, and after `detach`;
        ValueError for a space with flexible parts.
        """
        self._between_steps("snapshot")
        return Snapshot(self)

    def restore(self, snapshot: Snapshot) -> None:
        """Put the space back to where it was when the snapshot was taken, as often as you like.

        Raises ValueError, before anything has changed, for the snapshot of another space, and where bodies, shapes or
        joints have come or gone since; RuntimeError within a step, and after `detach`.
        """
        if not isinstance(snapshot, Snapshot) or snapshot._contact() is not self:
            raise ValueError(f"snapshot must be one that this contact has taken, got {snapshot!r:.80}")
        self._between_steps("restore")
        snapshot.put_back(self)

    def _between_steps(self, what: str) -> None:
        if self.space._locked:
            raise RuntimeError(f"{what}() within a step: call it after the step")
        if self._settings["flexible"] is not None:
            raise ValueError(f"{what}() of a space with flexible parts: they are not in a snapshot")
        if self._state["pending"]:
            self._update()

    def _take_arbiters(self) -> None:
        take_arbiters(self._store, self.space)

    def __getstate__(self) -> dict[str, Any]:
        if self._space is not None:
            self._catch_up()
        memory = self._memory if self._space is None else remember(self._store, self._space)
        return {"_settings": dict(self._settings), "_memory": memory}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self._settings, self._memory = state["_settings"], state["_memory"]
        self._space = None
        self._error = None
