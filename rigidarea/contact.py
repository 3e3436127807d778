"""`attach(space)`: a pymunk space whose contacts are area contacts, until `detach()`."""

from __future__ import annotations

import itertools
import math
import warnings
import weakref
from typing import Any

import numpy as np
import pymunk
from numba import config
from pymunk._chipmunk_cffi import ffi, lib

from . import hook, stepping
from .chipmunk import LayoutError, address_of, layout
from .energy import stored_energy
from .kernel.region import CHORD, FOLLOWED, LAW_AREA, LAW_ENERGY, NODAL
from .outline import Outline, positive
from .pairs import Memory, Pairs
from .store import Store, load_law

LAWS = {"area": LAW_AREA, "energy": LAW_ENERGY}
DIRECTIONS = {"chord": CHORD, "nodal": NODAL}
INTEGRATIONS = {"implicit": FOLLOWED, "explicit": math.inf}
HOOKS = ("auto", "compiled", "python")

#: One row a contact region, as `AreaContact.regions` gives them.
REGIONS = np.dtype(
    [
        ("shape_a", "O"),
        ("shape_b", "O"),
        ("body_a", "O"),
        ("body_b", "O"),
        ("area", "f8"),  # (length^2)
        ("centroid", "f8", 2),  # where the force acts, world (length)
        ("direction", "f8", 2),  # unit, from A to B
        ("chord", "f8"),  # (length)
        ("force", "f8"),  # normal force on B along direction (force); on A the opposite
        ("friction", "f8"),  # force on B along direction turned by +90 degrees
        ("speed", "f8"),  # closing speed (length/time)
        ("slip", "f8"),  # tangential speed of A relative to B, surface velocity included (length/time)
    ]
)

_epochs = itertools.count(1)


class SimulationError(RuntimeError):
    """A step went wrong for a reason that the message names (body and step)."""


class StepLimitWarning(UserWarning):
    """A frame needs more steps than `max_steps` allows."""


class AreaContact:
    """Area contact of one space: what `attach` returns.

    Attributes that may be set at any time: `stiffness`, `rest_speed`, `max_steps`, `phase`.
    """

    def __init__(self, space: pymunk.Space, settings: dict[str, Any]) -> None:
        self._settings = settings
        self._error: BaseException | None = None
        self._warned = False
        self._memory: Memory = {}
        self._limits: dict[str, float] = {"max_steps": 1000, "phase": stepping.PHASE}
        self._install(space)

    # --- attaching ---

    def _install(self, space: pymunk.Space) -> None:
        if lib.cpSpaceGetUserData(space._space) != ffi.NULL:
            raise ValueError(
                "expected a space that nothing is attached to; its user data is taken: detach() that contact first"
            )
        self._space: pymunk.Space | None = space
        self._store = Store()
        self._pairs = Pairs(space, self._store, self._memory)
        self._shapes: dict[int, pymunk.Shape] = {}
        self._seen_ids = -1
        self._watch = stepping.Watch(space)
        self._state = state = self._store.state[0]
        settings = self._settings
        state["law"] = LAWS[settings["law"]]
        state["direction"] = DIRECTIONS[settings["direction"]]
        state["exponent"] = settings["exponent"]
        state["length"] = settings["length"] or 0.0
        state["stiffness"] = settings["stiffness"] or 0.0
        state["rest_speed"] = settings["rest_speed"] or 0.0
        state["followed"] = INTEGRATIONS[settings["integration"]]
        state["epoch"] = next(_epochs)
        state["restoring"] = bool(self._memory)
        state["touched"] = -1
        for name, value in self._limits.items():
            state[name] = value
        self.compiled = self._choose_hook(settings["hook"])
        self._register_shapes()
        self._hook = Hook(self)
        space.on_collision(pre_solve=self._hook, separate=self._hook.separate)
        self._handler = space._handlers[None, None]
        self._state["global_handler"] = address_of(self._handler._handler)
        if self.compiled:
            from . import frames, machine

            self._state["shift_at"] = frames.shift_body.address
            self._advance = ffi.cast(
                "long long(*)(void *, double, long long, long long, long long)", frames.advance.address
            )
            self._handler._handler.preSolveFunc = ffi.cast(
                "cpCollisionPreSolveFunc", machine.pre_solve.address
            )
            self._handler._handler.separateFunc = ffi.cast(
                "cpCollisionSeparateFunc", machine.separate.address
            )
        lib.cpSpaceSetUserData(space._space, ffi.cast("void *", self._store.state.ctypes.data))
        # Chipmunk calls separate once more for what touches when the space goes: not into freed tables.
        self._end = _finalize(space)
        self._frequency()  # compiled now, not in the first frame
        stored_energy(self._store, self._shapes, -2)  # the same: no region is of that step

    def _choose_hook(self, wanted: str) -> bool:
        if wanted == "python":
            return False
        try:
            if config.DISABLE_JIT:
                raise LayoutError("numba does not compile (NUMBA_DISABLE_JIT is set)")
            for name, offset in layout().items():
                self._state[name] = offset
        except LayoutError:
            if wanted == "compiled":
                raise
            return False
        return True

    @property
    def space(self) -> pymunk.Space:
        """The attached space. RuntimeError after `detach`."""
        if self._space is None:
            raise RuntimeError("this contact is detached: attach the space again")
        return self._space

    def detach(self) -> None:
        """Give the space Chipmunk's own response back, as if nothing had been. Does nothing when called again."""
        space = self._space
        if space is None:
            return
        self._check_hooked()
        self._end.detach()
        lib.cpSpaceSetUserData(space._space, ffi.NULL)
        space.on_collision(pre_solve=pymunk.empty_callback, separate=pymunk.empty_callback)
        for arbiter in space._get_arbiters():
            arbiter.data = ffi.NULL
            if arbiter.state == lib.CP_ARBITER_STATE_IGNORE:
                arbiter.state = lib.CP_ARBITER_STATE_NORMAL
        self._space = None

    def _check_hooked(self) -> None:
        assert self.space is not None  # says so if detached
        own = self._hook
        if self._handler.pre_solve == own and self._handler.separate == own.separate:
            return
        raise RuntimeError(
            "the space's global pre_solve or separate was replaced after attach(): area contact needs them. Register "
            "callbacks for a collision type (on_collision(type, None, ...)) instead of for all"
        )

    def _adopt(self, space: pymunk.Space) -> None:
        """Take over a copy of the attached space, with what its contacts remembered."""
        self._install(space)

    # --- shapes ---

    def _register_shapes(self) -> None:
        """Give every shape of the space that has none yet its outline; choose what was left to be chosen."""
        space = self.space
        counter = lib.cpSpaceGetShapeIDCounter(space._space)
        if counter == self._seen_ids and len(space.shapes) == len(self._shapes):
            return
        present = {shape._hashid: shape for shape in space.shapes}
        gone = self._shapes.keys() - present.keys()
        self._store.forget(gone)
        for ident in gone:
            del self._shapes[ident]
        for ident, shape in present.items():
            if ident not in self._shapes:
                self._register(shape)
        self._seen_ids = counter
        self._store.sync()
        self._choose()

    def _register(self, shape: pymunk.Shape) -> None:
        outline = Outline.from_pymunk(shape)
        body = shape.body
        assert body is not None
        inverse_mass = inverse_moment = 0.0
        if body.body_type == pymunk.Body.DYNAMIC and not shape.sensor:
            inverse_mass = 1.0 / body.mass if body.mass > 0 else 0.0
            inverse_moment = 1.0 / body.moment if body.moment > 0 else 0.0
        self._store.shape(
            shape._hashid,
            address_of(shape._shape),
            outline,
            outline.mirror,
            body.id,
            inverse_mass,
            inverse_moment,
        )
        self._shapes[shape._hashid] = shape

    def refresh(self, shape: pymunk.Shape) -> None:
        """Read a shape's geometry again, after `unsafe_set_vertices` and the like."""
        self._shapes.pop(shape._hashid, None)
        self._register(shape)
        self._store.sync()

    def _sizes(self) -> dict[pymunk.Body, float]:
        """The chord on which each dynamic body would lie (length)."""
        sizes: dict[pymunk.Body, float] = {}
        tables, pool = self._store.tables, self._store.pool
        for ident, shape in self._shapes.items():
            body = shape.body
            if body is None or body.body_type != pymunk.Body.DYNAMIC or shape.sensor:
                continue
            flat = float(pool.heads[tables.shapes[self._store.slots[ident]]["outline"]]["face"])
            sizes[body] = max(sizes.get(body, 0.0), flat)
        return sizes

    def _choose(self) -> None:
        sizes: dict[pymunk.Body, float] | None = None
        if self._state["stiffness"] == 0.0:
            sizes = self._sizes()
            if not sizes:
                return  # nothing that could touch yet
            self._state["stiffness"] = stepping.choose_stiffness(
                self.space, sizes, self._settings["penetration"]
            )
        if self._settings["length"] is None:
            sizes = sizes or self._sizes()
            self._state["length"] = max(sizes.values(), default=1.0)
        if self._settings["rest_speed"] is None:
            sizes = sizes or self._sizes()
            self._state["rest_speed"] = stepping.choose_rest_speed(
                self.space, sizes, float(self._state["stiffness"])
            )

    @property
    def stiffness(self) -> float:
        """k of F = k A (force/length^2). 0 while it waits to be chosen: no dynamic body was there yet."""
        return float(self._state["stiffness"])

    @stiffness.setter
    def stiffness(self, value: float) -> None:
        self._state["stiffness"] = self._settings["stiffness"] = positive(value, "stiffness")

    @property
    def rest_speed(self) -> float:
        """First touch slower than this (length/time) is no impact: no restitution, a dashpot instead."""
        return float(self._state["rest_speed"])

    @rest_speed.setter
    def rest_speed(self, value: float) -> None:
        self._state["rest_speed"] = self._settings["rest_speed"] = _not_negative(value, "rest_speed")

    @property
    def max_steps(self) -> int:
        """Most steps of one frame (default 1000); where it binds, a StepLimitWarning is given, once."""
        return int(self._state["max_steps"])

    @max_steps.setter
    def max_steps(self, value: int) -> None:
        self._state["max_steps"] = self._limits["max_steps"] = _count(value, "max_steps")

    @property
    def phase(self) -> float:
        """Largest phase of the stiffest contact in one step (radians); smaller is finer. See `stepping.PHASE`."""
        return float(self._state["phase"])

    @phase.setter
    def phase(self, value: float) -> None:
        self._state["phase"] = self._limits["phase"] = positive(value, "phase")

    # --- stepping ---

    def step(self, dt: float, frames: int = 1, steps: int | None = None) -> int:
        """Advance the space by `frames` frames of dt (time) each, every one in as many steps as it needs.

        A frame is cut into the steps that its stiffest contact asks for (`steps(dt)`), or into `steps` if given.
        Second order in time (leapfrog), whatever the number of frames. Where nothing touches, for as long as nothing
        can, one long step takes the place of many (in spaces without joints and damping, and where no callback of
        the user's waits for every step).

        Returns the number of steps taken. Raises ValueError for arguments out of range, SimulationError (naming body
        and step) when a body's position stops being finite; the state is then that of the last good step.
        """
        positive(dt, "dt")
        _count(frames, "frames")
        if steps is not None:
            _count(steps, "steps")
        self._check_hooked()
        self._register_shapes()
        if self.space._bodies_to_check:
            self.space.step(0.0)  # pymunk's check of new bodies
        if not self.compiled or self.space.threaded or len(self.space._handlers) > 1:
            return self._step_by_step(dt, frames, steps)
        self._watch.take()
        taken = self._run(dt, frames, steps or 0)
        if self._state["broken"]:
            self._watch.take()
            self._watch.put_back()
            self._step_by_step(dt, frames, steps)  # once more, to find the step
            raise SimulationError(f"the state is not finite after {taken} steps")
        return taken

    def _run(self, dt: float, frames: int, steps: int) -> int:
        """All frames in machine code: see `frames.advance`."""
        space = self.space
        state = self._state
        state["ballistic"] = not space._constraints and space.damping == 1.0
        state["stop"] = state["wanted"] = state["broken"] = 0
        space._locked = True
        try:
            taken = self._advance(space._space, dt, frames, steps, self._store.rows)
        finally:
            space._locked = False
        if self._error is not None:
            _raise(space, _post_step_key(self), self)
        if space._add_later or space._remove_later:
            space.step(0.0)  # what a velocity function added or removed: pymunk's own way
        if state["wanted"]:
            self._warn(int(state["wanted"]), dt)
        return int(taken)

    def _step_by_step(self, dt: float, frames: int, steps: int | None) -> int:
        """The same in Python, in equal steps through pymunk, for whom every step counts."""
        space = self.space
        total = 0
        for _ in range(frames):
            n = steps or self.steps(dt)
            h = dt / n
            self._watch.look()
            self._shift(-0.5 * h, settle=False)
            for i in range(n):
                space.step(h)
                if not self._watch.look():
                    raise SimulationError(
                        f"{self._watch.put_back()}, after step {i + 1} of {n} of this frame"
                    )
            self._shift(0.5 * h, settle=True)
            total += n
        return total

    def _shift(self, time: float, settle: bool) -> None:
        """Drift all bodies by `time`; settle: for good, so that queries see them there (a step does that itself)."""
        space = self.space
        if self.compiled:
            self._state["shift"], self._state["settle"] = time, settle
            lib.cpSpaceEachBody(
                space._space,
                ffi.cast("cpSpaceBodyIteratorFunc", int(self._state["shift_at"])),
                ffi.cast("void *", self._store.state.ctypes.data),
            )
            for shape in self._shapes.values() if settle else ():
                if shape.body is not None and not shape.body.is_sleeping:
                    lib.cpSpaceReindexShape(space._space, shape._shape)
            return
        for body in space.bodies:
            if body.body_type != pymunk.Body.STATIC and not body.is_sleeping and body._position_func is None:
                body.position += time * body.velocity
                body.angle += time * body.angular_velocity
                if settle:
                    space.reindex_shapes_for_body(body)

    def steps(self, dt: float) -> int:
        """The number of steps that `step(dt)` would take, with contact. Raises ValueError for dt not positive."""
        positive(dt, "dt")
        self._check_hooked()
        self._register_shapes()
        n = max(1, math.ceil(dt * self._frequency() / self.phase))
        if n > self.max_steps:
            self._warn(n, dt)
            n = self.max_steps
        return n

    def _warn(self, wanted: int, dt: float) -> None:
        if not self._warned:
            self._warned = True
            warnings.warn(
                f"a frame of {dt:g} needs {wanted} steps (stiffest contact {self._frequency():.4g} rad per unit "
                f"time) and max_steps allows {self.max_steps}: contacts may be inaccurate. Lower the stiffness, or "
                "raise max_steps",
                StepLimitWarning,
                stacklevel=4,
            )

    def _frequency(self) -> float:
        store = self._store
        stamp = lib.cpSpaceGetTimestamp(self.space._space)
        shapes = len(store.known_shapes)
        return stepping.highest_frequency(store.pool, store.tables, shapes, load_law(self._state), stamp)

    # --- what it shows ---

    @property
    def regions(self) -> np.ndarray:
        """The contact regions of the last step, one REGIONS row each; the order is the tables' and means nothing."""
        stamp = lib.cpSpaceGetTimestamp(self.space._space)
        tables = self._store.tables
        live = tables.regions[tables.regions["stamp"] == stamp]
        out = np.zeros(len(live), REGIONS)
        row: Any
        for row, region, pair in zip(out, live, tables.pairs[live["pair"]]):
            a = self._shapes[int(pair["shape_a"])]
            b = self._shapes[int(pair["shape_b"])]
            row["shape_a"], row["shape_b"], row["body_a"], row["body_b"] = a, b, a.body, b.body
            row["centroid"] = region["x"], region["y"]
            row["direction"] = region["nx"], region["ny"]
        for name in ("area", "chord", "force", "friction", "speed", "slip"):
            out[name] = live[name]
        return out

    def energy(self) -> float:
        """Kinetic energy, plus potential in the space's gravity, plus what the contacts store (force length)."""
        space = self.space
        total = 0.0
        for body in space.bodies:
            if body.body_type == pymunk.Body.DYNAMIC:
                center = body.local_to_world(body.center_of_gravity)
                total += 0.5 * body.mass * body.velocity.dot(body.velocity) - body.mass * space.gravity.dot(
                    center
                )
                if math.isfinite(body.moment):
                    total += 0.5 * body.moment * body.angular_velocity**2
        return total + stored_energy(self._store, self._shapes, lib.cpSpaceGetTimestamp(space._space))

    # --- what machine code asks for ---

    def _serve(self, request: int, arbiter: pymunk.Arbiter) -> None:
        if request == hook.NEW_SHAPE:
            self._register_shapes()
        elif request == hook.NEW_PAIR:
            self._pairs.prepare(arbiter)
        elif request == hook.MORE_WORK:
            self._store.grow_work()
        elif request == hook.MORE_REGIONS:
            self._store.grow_regions()
        elif request == hook.BAD_STATE:
            space = self.space
            known = list(space.bodies)
            where = [
                f"bodies[{known.index(body)}]" if body in known else "the static body"
                for body in (shape.body for shape in arbiter.shapes)
            ]
            raise SimulationError(
                f"the contact force between {where[0]} and {where[1]} is not finite in step "
                f"{lib.cpSpaceGetTimestamp(space._space)} of the space; it was not applied"
            )

    # --- copies ---

    def __getstate__(self) -> dict[str, Any]:
        settings, memory = dict(self._settings), self._memory
        if self._space is not None:
            memory = self._pairs.remember()
            if self.stiffness > 0.0:  # what was chosen stays chosen
                settings |= {name: float(self._state[name]) for name in ("stiffness", "rest_speed", "length")}
        return {
            "_settings": settings,
            "_limits": dict(self._limits),
            "_memory": memory,
        }

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._space = None
        self._error = None
        self._warned = False


class Hook:
    """The Python side of the hook: pymunk calls it; it serves machine code, or is the hook itself."""

    def __init__(self, contact: AreaContact) -> None:
        self.contact = contact

    def __call__(self, arbiter: pymunk.Arbiter, space: pymunk.Space, data: Any) -> None:
        contact = self.contact
        try:
            if contact._space is not space:  # a copy, stepped for the first time
                contact._adopt(space)
            request = int(contact._state["request"])
            if contact.compiled and request != hook.NOTHING:
                contact._serve(request, arbiter)
                contact._state["request"] = hook.NOTHING
            else:
                hook.pre_solve(arbiter, space, contact._store, contact._pairs.of, contact._serve)
        except Exception as error:  # cffi would print it and go on: keep it, raise it after the step
            if contact._error is None:
                contact._error = error
                contact._state["stop"] = 1
                space.add_post_step_callback(_raise, _post_step_key(contact), contact)

    def separate(self, arbiter: pymunk.Arbiter, space: pymunk.Space, data: Any) -> None:
        if self.contact._space is space:
            self.contact._pairs.end(arbiter)


def _post_step_key(contact: AreaContact) -> tuple[str, int]:
    return "rigidarea", id(contact)


def _raise(space: pymunk.Space, key: Any, contact: AreaContact) -> None:
    space._post_step_callbacks.pop(key)
    error, contact._error = contact._error, None
    if error is not None:
        raise error


def _finalize(space: pymunk.Space) -> weakref.finalize:
    # Chipmunk calls separate once more for what touches when the space goes: not into tables that are gone
    return weakref.finalize(space, lib.cpSpaceSetUserData, space._space, ffi.NULL)


def _not_negative(value: float, name: str) -> float:
    if not (isinstance(value, int | float | np.number) and math.isfinite(value) and value >= 0):
        raise ValueError(f"{name} must be a finite number >= 0, got {value!r}")
    return float(value)


def _count(value: int, name: str) -> int:
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < 1:
        raise ValueError(f"{name} must be a whole number >= 1, got {value!r}")
    return int(value)


def _one_of(value: str, name: str, known: Any) -> str:
    if value not in known:
        raise ValueError(f"{name} must be one of {', '.join(map(repr, known))}, got {value!r}")
    return value


def attach(
    space: pymunk.Space,
    stiffness: float | None = None,
    *,
    penetration: float = stepping.PENETRATION,
    law: str = "area",
    length: float | None = None,
    direction: str = "chord",
    exponent: float = 1.0,
    rest_speed: float | None = None,
    integration: str = "implicit",
    hook: str = "auto",
) -> AreaContact:
    """Replace the collision response of `space` by area contact; `AreaContact.detach` undoes it.

    stiffness: k of F = k A (force/length^2). None: chosen so that no body sinks deeper than `penetration` (a
        fraction of its size) under its own weight; where no body is there yet, when the first one is.
    law: "area" (F = k A at the centroid, Eq. 5 and 7), or "energy" (F = k A L / length along the gradient of
        k A^2 / (2 length), conservative between any two outlines; length None: the largest body's size).
    direction: "chord" (exact and independent of the sampling), or "nodal" (Eq. 8-15, weights depth^exponent).
    rest_speed: first touch slower than this (length/time) rests instead of bouncing. None: from gravity.
    integration: what becomes of a contact too stiff for the step (phase w h above 1/2). "implicit": an impact becomes
        an impulse, a curved contact's spring is taken at the end of the step, a flat one's as stiff as the step can
        follow; stable at any step. "explicit": F = k A at the step's place, stable up to w h = 2 (in a stack 1).
    hook: "compiled" (machine code), "python" (the same, readable and slow), "auto" (compiled where it can run).

    Restitution, friction and surface velocity are pymunk's: of a pair the product of the shapes' `elasticity` and of
    their `friction`, callbacks' overrides included.

    Raises ValueError for settings out of range, for a space that is attached already, and where another global
    pre_solve or separate is set (nothing is overwritten).
    """
    if not isinstance(space, pymunk.Space):
        raise ValueError(f"space must be a pymunk.Space, got {type(space).__name__}")
    settings = {
        "stiffness": None if stiffness is None else positive(stiffness, "stiffness"),
        "penetration": positive(penetration, "penetration"),
        "law": _one_of(law, "law", LAWS),
        "length": None if length is None else positive(length, "length"),
        "direction": _one_of(direction, "direction", DIRECTIONS),
        "exponent": _not_negative(exponent, "exponent"),
        "rest_speed": None if rest_speed is None else _not_negative(rest_speed, "rest_speed"),
        "integration": _one_of(integration, "integration", INTEGRATIONS),
        "hook": _one_of(hook, "hook", HOOKS),
    }
    handler = space._handlers.get((None, None))
    if handler is not None:
        if isinstance(handler.pre_solve, Hook):
            raise ValueError("this space is attached already; use attached(space), or detach() it first")
        for phase in ("pre_solve", "separate"):
            if getattr(handler, phase) is not None:
                raise ValueError(
                    f"the space already has a global {phase} callback, which attach() would overwrite: register it "
                    "for its collision types (on_collision(type, None, ...)), or remove it with "
                    f"on_collision({phase}=pymunk.empty_callback)"
                )
    return AreaContact(space, settings)


def attached(space: pymunk.Space) -> AreaContact | None:
    """The area contact of a space, None if it has none. Of a copied or unpickled space too."""
    handler = space._handlers.get((None, None))
    if handler is None or not isinstance(handler.pre_solve, Hook):
        return None
    contact = handler.pre_solve.contact
    if contact._space is not space:
        contact._adopt(space)
    return contact
