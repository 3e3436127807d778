"""What machine code asks Python for within a step; what is raised by that is kept, and raised after the step.

Nothing can be raised through Chipmunk's frames. `contact` is an `AreaContact`.
"""

from __future__ import annotations

import weakref
from types import TracebackType
from typing import Any

import pymunk
from pymunk._chipmunk_cffi import lib

from .structs import address_of, normal_of


class SimulationError(RuntimeError):
    """A step went wrong for a reason that the message names (body and step)."""


def serve(own: weakref.ref[Any], request: int) -> None:
    """Machine code asks for something. What is raised goes to `keep`; until the last line it counts as not done."""
    contact = own()
    if contact is not None and contact._space is not None:
        _answer(contact, request)
        contact._state["failed"] = 0


def _answer(contact: Any, request: int) -> None:
    """Do what machine code asks for (`record.REGISTER`, ...)."""
    from . import record

    store = contact._store
    if request == record.REGISTER:
        contact._update()
    elif request == record.GROW:
        store.grow()
    elif request == record.NORMAL:
        contact._state["asked_x"], contact._state["asked_y"] = normal_of(int(contact._state["asked_arbiter"]))
    elif request == record.BROKEN:
        space = contact.space
        address = int(store.tables.bodies[int(contact._state["broken"])]["address"])
        names = [f"bodies[{i}]" for i, b in enumerate(space.bodies) if address_of(b._body) == address]
        raise SimulationError(
            f"the state of {names[0] if names else 'a body'} is not finite in frame "
            f"{lib.cpSpaceGetTimestamp(space._space)} of the space: all bodies are as they were before it"
        )


def keep(own: weakref.ref[Any], error: BaseException, trace: TracebackType, registering: int) -> None:
    """Keep what was raised while machine code was at work, to be raised after the step: nothing can be raised in it.

    trace: it begins in the function that was called with the `request`. Where that was to register what has come, no
    frame has begun, but Chipmunk goes on with its step: bodies are put back after it.
    """
    contact = own()
    if contact is not None and contact._space is not None:
        contact._error = contact._error or error
        if trace.tb_frame.f_locals["request"] == registering:
            contact._before = [(body, _state_of(body)) for body in contact._space.bodies]
        if not contact._stepping:  # a step of pymunk's that has gone past the attached space's own
            contact._space.add_post_step_callback(_raise, ("rigidarea", id(contact)), contact)


def _state_of(body: pymunk.Body) -> tuple[float, ...]:
    place, motion = (*body.position, body.angle), (*body.velocity, body.angular_velocity)
    return (*place, *motion, *body.force, body.torque)


def raise_kept(contact: Any) -> None:
    """Raise what was noted in the step, once; where it was before a frame had begun, bodies are put back first."""
    error, contact._error = contact._error, None
    if contact._state["failed"]:
        contact._state["failed"] = 0
        error = error or RecursionError("a step cannot ask Python: too many calls within one another")
    before, contact._before = contact._before, []
    for body, (x, y, angle, vx, vy, w, fx, fy, torque) in before:
        if (*body.position, body.angle) != (x, y, angle):
            body.position, body.angle = (x, y), angle
        body.velocity, body.angular_velocity = (vx, vy), w
        body.force, body.torque = (fx, fy), torque
    if error is not None:
        raise error


def _raise(space: pymunk.Space, key: Any, contact: Any) -> None:
    raise_kept(contact)
