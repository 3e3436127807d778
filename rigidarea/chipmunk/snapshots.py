"""`AreaContact.snapshot` and `restore`: an attached space as it was, in microseconds."""

from __future__ import annotations

import math
import weakref
from functools import lru_cache
from typing import Any

import numpy as np
import pymunk
from pymunk._chipmunk_cffi import ffi, lib

from ..contact.joint_record import DIRECTION
from .joint_structs import kinds_of_joints
from .structs import LayoutError, address_of, layout

_JOINTS, _DOZED = 3, 4
_CHANGED = {1: "bodies", 2: "shapes", _JOINTS: "joints"}
_ARBITER = int(ffi.sizeof("struct cpArbiter"))
#: What of an arbiter is put back: materials, normal, and from `swapped` on what callbacks were told and have said.
_PARTS = (slice(0, 32), slice(120, 136), slice(168, _ARBITER))
_NOBODY = np.empty(0, np.uint64)
#: A block's first room (bytes).
ROOM = 2**16


class Snapshot:
    """An attached space as it was: what `AreaContact.snapshot` returns. It belongs to its space, in its process."""

    __slots__ = ("_arbiters", "_asleep", "_block", "_contact", "_groups", "_listed")

    def __init__(self, contact: Any) -> None:
        space, (save, *_) = contact.space, _functions()
        at, idle = space._space, idle_time()
        block = np.empty(contact._snapshot_room, np.uint8)
        size = save(at, idle, ffi.from_buffer(block), len(block))
        if size > len(block):
            contact._snapshot_room = size + size // 4
            block = np.empty(contact._snapshot_room, np.uint8)
            size = save(at, idle, ffi.from_buffer(block), len(block))
        self._block, self._contact = block[:size].copy(), weakref.ref(contact)
        self._arbiters = _arbiters_of(space) if space._handlers else {}
        self._groups = who_sleeps(space) if self._block[56:64].view(np.int64)[0] else []  # HEAD.sleepers
        # where bodies may sleep, joints come and go in Chipmunk's list with them
        self._listed, self._asleep = _NOBODY, []
        if (self._groups or math.isfinite(space.sleep_time_threshold)) and space.constraints:
            self._listed = listed(space, "space_constraints").copy()
            awake = set(self._listed.tolist())
            for joint in space.constraints:
                if address_of(joint._constraint) not in awake:
                    self._asleep.append((joint, _state_of(joint)))

    @property
    def nbytes(self) -> int:
        """Its size (bytes)."""
        return len(self._block)

    def put_back(self, contact: Any) -> None:
        """`AreaContact.restore`."""
        space, (_, compare, restore, reorder) = contact.space, _functions()
        at, idle, block = space._space, idle_time(), ffi.from_buffer(self._block)
        changed = compare(at, idle, block)
        if changed == _JOINTS and self._has_joints_of(contact):
            changed = _DOZED
        if changed in _CHANGED:
            raise ValueError(
                f"expected the {_CHANGED[changed]} that the space had when the snapshot was taken; "
                "some have come, gone or changed since"
            )
        if changed:
            for body in space.bodies:
                if lib.cpBodyIsSleeping(body._body):
                    lib.cpBodyActivate(body._body)
            _unthread(space)
            joints, n = listed(space, "space_constraints"), len(self._listed)
            if n:
                joints[:] = [*self._listed, *(joint for joint in joints if joint not in self._listed)]
                listed(space, "space_constraints", n)
        elsewhere = restore(at, idle, block)
        for joint, state in self._asleep:
            _put_state(joint, state)
        if changed:
            if n:
                listed(space, "space_constraints", len(joints))
            put_to_sleep(self._groups)
            if n:
                listed(space, "space_constraints", n)[:] = self._listed
        reorder(at, block)
        if elsewhere:
            lib.cpSpaceReindexStatic(at)
        if space._handlers:
            late = lib.cpSpaceGetTimestamp(at) - int(self._block[8:16].view(np.int64)[0])
            _put_arbiters_back(space, self._arbiters, late)
            contact._take_arbiters()

    def _has_joints_of(self, contact: Any) -> bool:
        """Whether the space has the joints of then, listed by Chipmunk or not."""
        then = {*self._listed.tolist(), *(address_of(joint._constraint) for joint, _ in self._asleep)}
        hidden = int(contact._state["hidden"])
        now = {hidden, *(address_of(joint._constraint) for joint in contact.space.constraints)}
        return then == now

    def __reduce__(self) -> Any:
        raise TypeError("a snapshot belongs to its space: copy or pickle the space")

    def __repr__(self) -> str:
        return f"<Snapshot, {self.nbytes} bytes>"


@lru_cache(maxsize=1)
def _functions() -> tuple[Any, ...]:
    from . import moved

    kinds = {
        "save": "long long(*)(void *, long long, void *, long long)",
        "compare": "long long(*)(void *, long long, void *)",
        "restore": "long long(*)(void *, long long, void *)",
        "reorder": "void(*)(void *, void *)",
    }
    return tuple(ffi.cast(kind, getattr(moved, name).address) for name, kind in kinds.items())


@lru_cache(maxsize=1)
def idle_time() -> int:
    """Where Chipmunk keeps for how long a body has idled (bytes); before it the first and the next of its group.

    LayoutError where it is not after all else that is known of a body.
    """
    space, one, two = pymunk.Space(), pymunk.Body(1, 1), pymunk.Body(1, 1)
    space.sleep_time_threshold, space.idle_speed_threshold = 100.0, 1.0
    space.add(one, two)
    lib.cpSpaceStep(space._space, 0.125)  # not space.step, which somebody may have wrapped
    first = layout()["body_shapes"] + 8
    memory = np.frombuffer(ffi.buffer(ffi.cast("char *", one._body) + first, 48), np.float64)
    places = np.flatnonzero(memory == 0.125)
    if len(places) != 1:
        raise LayoutError(f"idle time: expected one place in Chipmunk's struct, found {len(places)}")
    at = first + 8 * int(places[0])
    one.sleep()
    two.sleep_with_group(one)
    words = [ffi.cast("uintptr_t *", body._body)[at // 8 - k] for k in (1, 2) for body in (one, two)]
    expected = [address_of(two._body), 0, address_of(one._body), address_of(one._body)]
    if words != expected:
        raise LayoutError("sleeping: the group of a body is not where it was expected")
    return at


def put_to_sleep(groups: list[list[int]]) -> None:
    """Have groups of bodies sleep: their addresses, in the order in which they wake (Chipmunk lists the last first)."""
    for root, *others in groups:
        lib.cpBodySleep(ffi.cast("cpBody *", root))
        for address in reversed(others):
            lib.cpBodySleepWithGroup(ffi.cast("cpBody *", address), ffi.cast("cpBody *", root))


def who_sleeps(space: pymunk.Space) -> list[list[int]]:
    """The groups for `put_to_sleep`."""
    groups, word = [], idle_time() // 8 - 1
    for root in listed(space, "space_sleeping").tolist():
        group = []
        while root:
            group.append(root)
            root = int(ffi.cast("uintptr_t *", root)[word])
        groups.append(group)
    return groups


def idle_of(body: pymunk.Body) -> np.ndarray:
    """For how long Chipmunk has seen a body idle, in place: float64 (1,) (time)."""
    return np.frombuffer(ffi.buffer(ffi.cast("char *", body._body) + idle_time(), 8))


def listed(space: pymunk.Space, which: str, n: int | None = None) -> np.ndarray:
    """Addresses that Chipmunk lists, in place: uint64 (n,); which: the field of `chipmunk.layout`.

    n: there are so many of them from now on.
    """
    at = ffi.cast("uintptr_t *", address_of(space._space) + layout()[which])[0]
    count, arr = ffi.cast("int *", at), ffi.cast("uintptr_t *", at)[1]
    if n is not None:
        count[0] = n
    size = 8 * count[0]
    return (
        np.frombuffer(ffi.buffer(ffi.cast("char *", arr), size), np.uint64)
        if size
        else np.empty(0, np.uint64)
    )


def joint_numbers(joint: pymunk.Constraint) -> tuple[np.ndarray, np.ndarray]:
    """What a joint is made of, and its impulse, in place: empty of an unknown kind."""
    memory, own = ffi.cast("char *", joint._constraint), int(ffi.cast("uintptr_t *", joint._constraint)[0])
    for kind in kinds_of_joints():
        if kind.own_class == own:
            made_of = np.frombuffer(ffi.buffer(memory + kind.parameters, 8 * kind.numbers))
            return made_of, np.frombuffer(ffi.buffer(memory + kind.impulse, 8 * kind.impulses))
    return np.empty(0), np.empty(0)


def _stepped(joint: pymunk.Constraint) -> tuple[np.ndarray, np.ndarray]:
    """Of a joint's numbers what a step changes, in place: its impulse; a ratchet's angle, a pin's direction."""
    made_of, did = joint_numbers(joint)
    if isinstance(joint, pymunk.RatchetJoint):
        return did, made_of[:1]
    return did, made_of[DIRECTION:] if isinstance(joint, pymunk.PinJoint) else made_of[:0]


def _state_of(joint: pymunk.Constraint) -> list[np.ndarray]:
    return [part.copy() for part in _stepped(joint)]


def _put_state(joint: pymunk.Constraint, state: list[np.ndarray]) -> None:
    for part, then in zip(_stepped(joint), state):
        part[:] = then


def _unthread(space: pymunk.Space) -> None:
    """Bodies have no arbiters, as before Chipmunk's first step: what sleeps must have none with who is awake.

    Those that are cached find their bodies again in the next step.
    """
    off = layout()
    at = ffi.cast("uintptr_t *", address_of(space._space) + off["space_contacts"] - 8)[0]
    count, listed = ffi.cast("int *", at), ffi.cast("uintptr_t *", at)[1]
    first = int(ffi.offsetof("struct cpArbiter", "thread_a"))
    for i in range(count[0]):
        arbiter = _arbiter(ffi.cast("uintptr_t *", listed)[i])
        ffi.buffer(arbiter, _ARBITER)[first : first + 32] = bytes(32)
    count[0] = 0
    owners = {shape.body for shape in space.shapes if shape.body is not None}
    for body in {*space.bodies, *owners, space.static_body}:
        ffi.cast("uintptr_t *", body._body)[off["body_shapes"] // 8 + 1] = 0


def _arbiters_of(space: pymunk.Space) -> dict[tuple[int, int], bytes]:
    """Chipmunk's arbiters by the addresses of their shapes."""
    return {
        (address_of(arbiter.a), address_of(arbiter.b)): ffi.buffer(arbiter, _ARBITER)[:]
        for arbiter in map(_arbiter, space._get_arbiters())
    }


def _arbiter(pointer: Any) -> Any:
    return ffi.cast("struct cpArbiter *", pointer)


def _put_arbiters_back(space: pymunk.Space, kept: dict[tuple[int, int], bytes], late: int) -> None:
    """Callbacks are told what they would have been: what touched goes on touching, refused or not."""
    left = dict(kept)
    for arbiter in map(_arbiter, space._get_arbiters()):
        then = left.pop((address_of(arbiter.a), address_of(arbiter.b)), None)
        if then is None:
            arbiter.state, arbiter.count = lib.CP_ARBITER_STATE_CACHED, 0  # as if it had not been yet
        else:
            _say_again(arbiter, then, late)
    for (a, b), then in left.items():
        arbiter = _arbiter(lib.cpArbiterNew(ffi.cast("cpShape *", a), ffi.cast("cpShape *", b)))
        _say_again(arbiter, then, late)
        lib.cpSpaceAddCachedArbiter(space._space, arbiter)


def _say_again(arbiter: Any, then: bytes, late: int) -> None:
    memory = ffi.buffer(arbiter, _ARBITER)
    for part in _PARTS:
        memory[part] = then[part]
    arbiter.stamp += late
    arbiter.count = 0  # its points are in memory that has been used again
