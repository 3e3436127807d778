"""The bodies that an assembly moves, parts first, then what joints tie to them; and those joints through a frame."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pymunk
from pymunk._chipmunk_cffi import ffi

from rigidarea.chipmunk.asked import SimulationError
from rigidarea.chipmunk.joint_structs import kinds_of_joints
from rigidarea.chipmunk.structs import address_of, layout
from rigidarea.contact.space_record import OFFSETS
from rigidarea.flexible.inspace import LINK, MEMBER, PLACES
from rigidarea.flexible.integrate import Body

Pair = tuple[float, float]

#: What members keep from frame to frame: of the space's own frame (``inspace.note_rest``).
_NOTED = [f"{what}_{axis}" for what in ("bear", "rest", "mend") for axis in "xyw"]
_SPRINGS = pymunk.DampedSpring, pymunk.DampedRotarySpring  # joints whose force max_force does not bound


def _stay(body: pymunk.Body, *_: Any) -> None:
    """Position and velocity function of a body that the assembly moves."""


def _functions(body: pymunk.Body) -> tuple[Any, Any]:
    """Position and velocity function, None where they are pymunk's own."""
    return body._position_func, body._velocity_func


class Tied:
    """Parts (shapes and their flexible bodies), bodies that joints tie to them through bodies that forces move, and
    these joints. ``before``: the same with the constraints of the frame before, whose impulses are taken over.

    members (MEMBER), links (LINK): tables for ``inspace``; offsets: of Chipmunk's body, as it wants them.
    """

    def __init__(
        self,
        parts: Sequence[tuple[pymunk.Shape, Body]],
        constraints: tuple[pymunk.Constraint, ...],
        before: Tied | None = None,
    ) -> None:
        self.constraints, self._parts = constraints, len(parts)
        bodies: list[pymunk.Body] = [shape.body for shape, _ in parts if shape.body is not None]
        places = {id(b): i for i, b in enumerate(bodies)}
        moved = set(places)
        joints: list[pymunk.Constraint] = []
        grown = True
        while grown:
            grown = False
            for joint in constraints:
                if joint in joints or not (id(joint.a) in moved or id(joint.b) in moved):
                    continue
                joints.append(joint)
                grown = True
                for body in (joint.a, joint.b):
                    if id(body) not in places:
                        places[id(body)] = len(bodies)
                        bodies.append(body)
                        if body.body_type == pymunk.Body.DYNAMIC:
                            moved.add(id(body))
        self._joints = joints
        self._between = [
            joint for joint in joints if max(places[id(joint.a)], places[id(joint.b)]) < len(parts)
        ]
        self._led = [body for body in bodies if id(body) in moved]
        for body in self._led:
            if any(f not in (None, _stay) for f in _functions(body)):
                raise ValueError(
                    "parts, and bodies that joints tie to them, are moved by their assembly: expected no position_func"
                    f" or velocity_func, got {body!r:.80} that has one"
                )
        for body in self._led:
            body.position_func, body.velocity_func = _stay, _stay
        self.members = np.zeros(len(bodies), MEMBER)
        noted = {} if before is None else {int(r["address"]): r for r in before.members}
        row: Any
        for row, body in zip(self.members, bodies, strict=True):
            row["address"], row["led"] = address_of(body._body), id(body) not in moved
            for name in _NOTED if int(row["address"]) in noted else ():
                row[name] = noted[int(row["address"])][name]
        for row, (_, made) in zip(self.members, parts, strict=False):
            # from the body's origin, where its centre of gravity is taken to be so far
            row["off_x"], row["off_y"] = made.position
            row["hub_x"], row["hub_y"] = np.add(made.position, made.hub)
            row["hub"] = made.shape is not None and made.shape.hub is not None
        #: Impulse of each joint in the last second half of a frame, by its address.
        self._rest: dict[int, Pair] = {} if before is None else before._rest
        kinds = {kind.own_class: kind for kind in kinds_of_joints()}
        warm = {} if before is None else {int(r["address"]): (r["warm_x"], r["warm_y"]) for r in before.links}
        self.links: np.ndarray = np.zeros(len(joints), LINK)
        for row, joint in zip(self.links, joints, strict=True):
            row["address"], row["at"], row["arms"] = address_of(joint._constraint), -1, -1
            row["a"], row["b"] = places[id(joint.a)], places[id(joint.b)]
            kind = kinds.get(int(ffi.cast("uintptr_t *", joint._constraint)[0]))
            if kind is not None:
                row["at"], row["count"] = kind.impulse, kind.impulses
                if isinstance(joint, pymunk.PivotJoint):
                    row["arms"] = kind.parameters
            row["warm_x"], row["warm_y"] = warm.get(int(row["address"]), (0.0, 0.0))
        at = layout()
        self.offsets = np.zeros(1, PLACES)[0]
        for name in OFFSETS:
            self.offsets[name] = at[name]

    def holds(self) -> bool:
        """Whether all bodies are still moved by the assembly, by nobody else."""
        return all(_functions(body) == (_stay, _stay) for body in self._led)

    def stay_awake(self) -> None:
        """Nobody asleep is moved: Chipmunk's idle times begin anew, of what they touch too."""
        for body in self._led:
            body.activate()

    def check(self) -> None:
        """SimulationError for a member that is nowhere, or that no finite force or velocity moves."""
        moved = [self.members[name] for name in ("x", "y", "angle", "vx", "vy", "w", "ax", "ay", "alpha")]
        bad = np.flatnonzero(~np.isfinite(moved).all(axis=0))
        if len(bad):
            a, who = self.members[bad[0]], f"part {bad[0]}"
            if bad[0] >= self._parts:
                who = "a body that joints tie to a part"
            raise SimulationError(
                f"{who}: expected a finite place, velocity, force and torque, got the place ({a['x']:g}, {a['y']:g}),"
                f" the velocity ({a['vx']:g}, {a['vy']:g}), {a['w']:g} and the acceleration ({a['ax']:g}, {a['ay']:g}),"
                f" {a['alpha']:g}; all bodies are as they were before it"
            )

    def apart(self) -> set[frozenset[pymunk.Body]]:
        """Parts, two and two, that a joint between them keeps from touching."""
        return {frozenset((joint.a, joint.b)) for joint in self._between if not joint.collide_bodies}

    def release(self) -> None:
        """The bodies are pymunk's again; functions that the user has put there since stay."""
        for body in self._led:
            position, velocity = _functions(body)
            if position is _stay:
                body.position_func = pymunk.Body.update_position
            if velocity is _stay:
                body.velocity_func = pymunk.Body.update_velocity

    def rest_of_frame(self, dt: float, rest: Callable[[], None], idle: int) -> None:
        """The space's own frame of dt, ``rest``: joints have what is left of their force in it, springs have acted.

        Afterwards a joint's impulse is that of both halves. idle: address of the class of a joint that does nothing.
        """
        classes: dict[int, int] = {}
        limited: list[tuple[pymunk.Constraint, float]] = []
        for joint, link in zip(self._joints, self.links, strict=True):
            address = int(link["address"])
            if dt > 0 and (isinstance(joint, _SPRINGS) or link["at"] < 0):
                own = ffi.cast("uintptr_t *", address)
                classes[address] = int(own[0])
                own[0] = idle
                continue
            if dt > 0 and math.isfinite(joint.max_force):
                limited.append((joint, joint.max_force))
                joint.max_force = max(0.0, joint.max_force - math.hypot(link["x"], link["y"]) / dt)
            _set_impulse(link, self._rest.get(address, (0.0, 0.0)))
        try:
            rest()
        finally:
            for address, kind in classes.items():
                ffi.cast("uintptr_t *", address)[0] = kind
            for joint, force in limited:
                joint.max_force = force
        for link in self.links:
            address = int(link["address"])
            more = (0.0, 0.0) if address in classes else _impulse(link)
            self._rest[address] = more
            _set_impulse(link, (link["x"] + more[0], link["y"] + more[1]))

    def memory(self) -> tuple[np.ndarray, list[tuple[Pair, Pair]]]:
        """What a copy's members and joints start from."""
        joints = [
            ((float(r["warm_x"]), float(r["warm_y"])), self._rest.get(int(r["address"]), (0.0, 0.0)))
            for r in self.links
        ]
        return self.members[_NOTED].copy(), joints

    def recall(self, memory: tuple[np.ndarray, list[tuple[Pair, Pair]]]) -> None:
        """Give a copy what its original remembers."""
        self.members[_NOTED] = memory[0]
        for link, (warm, rest) in zip(self.links, memory[1], strict=True):
            link["warm_x"], link["warm_y"] = warm
            self._rest[int(link["address"])] = rest


def _impulse(link: Any) -> Pair:
    if link["count"] == 0:
        return 0.0, 0.0
    memory = ffi.cast("double *", int(link["address"]) + int(link["at"]))
    return float(memory[0]), float(memory[1]) if link["count"] > 1 else 0.0


def _set_impulse(link: Any, value: Pair) -> None:
    if link["count"] > 0:
        memory = ffi.cast("double *", int(link["address"]) + int(link["at"]))
        memory[0] = value[0]
        if link["count"] > 1:
            memory[1] = value[1]
