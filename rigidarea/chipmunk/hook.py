"""What of ours Chipmunk calls in a step of its own: put into a space, and taken out of it.

A constraint that only Chipmunk knows, before all joints (`hidden_constraint`); the function of its global handler that
it calls for a touching pair (`pre_solve`); the position function of every body that has Chipmunk's own (`begin.hold`).

What is put there is taken out again when it leaves, in whatever way: a body's position function when the body is
removed, the space is detached or is garbage; the constraint in the latter two, and when the interpreter ends and no
thread is left that may be within a step.
"""

from __future__ import annotations

import threading
import weakref
from typing import Any

import numpy as np
import pymunk
from pymunk._chipmunk_cffi import ffi, lib

from . import begin, hidden_constraint, joints, pre_solve
from .arrays import Store
from .proxies import Spy
from .structs import address_of


class Hook:
    """The hooks of one attached space: until `remove`, or until the space itself goes."""

    def __init__(self, space: pymunk.Space, store: Store) -> None:
        self._state = state = store.state[0]
        idle, none = joints.idle.address, joints.no_impulse.address
        classes = np.array(
            [
                *(idle, idle, idle, none),
                *(hidden_constraint.silence.address, hidden_constraint.solve.address, idle, none),
                *(joints.prepared.address, idle, idle, none),
            ],
            np.uint64,
        )
        state["idle_kind"], state["seized_kind"] = classes.ctypes.data, classes.ctypes.data + 64
        body = lib.cpBodyNew(1.0, 1.0)  # of no space; freed with the constraint, or by the process's end
        joint = lib.cpPivotJointNew2(lib.cpSpaceGetStaticBody(space._space), body, (0, 0), (0, 0))
        words = ffi.cast("uintptr_t *", joint)
        pivot = int(words[0])
        words[0] = classes.ctypes.data + 32
        words[int(state["constraint_post_solve"]) // 8] = hidden_constraint.report.address
        lib.cpSpaceAddConstraint(space._space, joint)
        constraints = address_of(space._space) + int(state["space_constraints"])
        _roll(constraints, 1)  # before all joints: they are solved when its turn comes, and given back
        state["hidden"] = address_of(joint)
        wildcard = int(ffi.cast("uintptr_t", ~0))
        # pymunk's own way to the global handler, but for an entry of its own
        handler = lib.cpSpaceAddCollisionHandler(space._space, wildcard, wildcard)
        state["global_handler"] = address_of(handler)
        at = address_of(handler) + int(state["handler_pre_solve"]) - 8
        self._functions = ffi.cast("uintptr_t *", at)  # begin, pre_solve, post_solve, separate
        state["user_pre_solve"] = int(self._functions[1])
        state["pre_solve_at"] = self._functions[1] = pre_solve.pre_solve.address
        state["hold_at"] = begin.hold.address
        lib.cpSpaceSetUserData(space._space, ffi.cast("void *", store.state.ctypes.data))
        self.spy = Spy(state)
        self.held: weakref.WeakSet[pymunk.Body] = weakref.WeakSet()  # whose position function may be ours
        names = ("body_position_func", "hold_at", "position_func")
        self._functions_of_bodies = tuple(int(state[name]) for name in names)
        # Before Chipmunk frees the space, and with what the constraint needs until then, whatever is collected first.
        own = joint, body, pivot
        self._classes = classes  # Chipmunk looks there as long as the constraint is in the space
        self._end = weakref.finalize(
            space,
            _ended,
            weakref.ref(space),
            space._space,
            own,
            constraints,
            self.held,
            self._functions_of_bodies,
            store,
            classes,
        )

    def callbacks(self) -> dict[str, int]:
        """Which functions of its own the global handler has: `begin.begin` looks whether they are others."""
        names = ((0, "begin"), (2, "post_solve"), (3, "separate"))
        return {f"global_{name}": int(self._functions[number]) for number, name in names}

    def remove(self, space: pymunk.Space) -> None:
        """Take everything out of the space again."""
        state = self._state
        end = self._end.detach()
        if end is not None:
            _take_out(*end[2][1:])
        if int(self._functions[1]) == int(state["pre_solve_at"]):
            self._functions[1] = int(state["user_pre_solve"]) or int(state["no_pre_solve"])


def _release(body: pymunk.Body, offset: int, ours: int, own: int) -> None:
    """Give a body its `own` position function back, if it has `ours`. offset: where Chipmunk keeps it (bytes)."""
    words = ffi.cast("uintptr_t *", body._body)
    if words[offset // 8] == ours:
        words[offset // 8] = own


def _roll(constraints: int, by: int) -> None:
    """Move Chipmunk's list of joints on by so many places. constraints: where a space keeps it."""
    at = ffi.cast("uintptr_t *", int(ffi.cast("uintptr_t *", constraints)[0]))
    count = ffi.cast("int *", at)[0]
    listed = np.frombuffer(ffi.buffer(ffi.cast("void *", int(at[1])), 8 * count), np.uint64)
    listed[:] = np.roll(listed, by)


def _ended(space: Any, address: Any, *arguments: Any) -> None:
    """The space is garbage, or the interpreter ends: then a thread that nobody waits for may be within its step.

    Or was, when this process was forked: then the space is locked for ever.
    """
    if (space() is None or threading.active_count() == 1) and not lib.cpSpaceIsLocked(address):
        _take_out(address, *arguments)


def _take_out(
    space: Any,
    own: Any,
    constraints: int,
    held: Any,
    functions: tuple[int, int, int],
    store: Store,
    classes: Any,
) -> None:
    """Remove the hidden constraint from Chipmunk's space, and free it; the bodies held have their position functions
    back. own: it, its own body, its class. functions: see `_release`. store, classes: had to live until now.
    """
    joint, other, pivot = own
    for body in held:
        _release(body, *functions)
    lib.cpSpaceSetUserData(space, ffi.NULL)
    _roll(constraints, -1)  # Chipmunk puts the last in the place of one that goes: the order stays as it was
    lib.cpSpaceRemoveConstraint(space, joint)
    ffi.cast("uintptr_t *", joint)[0] = pivot
    lib.cpConstraintFree(joint)
    lib.cpBodyFree(other)
