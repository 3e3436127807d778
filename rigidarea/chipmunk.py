"""Chipmunk's memory: where in its structs the numbers lie that a contact step reads and writes.

Arbiters are declared to cffi, which knows their layout. Bodies and shapes are not: their offsets are found by setting
every quantity of a probe to a value of its own and looking for it. A layout in which anything is missing or
ambiguous is refused (`LayoutError`), and the plain Python hook is used instead. Why memory and not functions: every
force setter of Chipmunk wakes the body, so a body at rest on another could never fall asleep; and a read costs a
load instead of a call.
"""

from __future__ import annotations

import math
from functools import lru_cache

import llvmlite.binding as llvm
import numpy as np
import pymunk
from pymunk._chipmunk_cffi import ffi, lib

#: Functions that machine code calls, all on pointers and scalars.
FUNCTIONS = [
    "cpSpaceGetUserData",
    "cpSpaceGetSleepTimeThreshold",
    "cpSpaceGetTimestamp",
    "cpSpaceGetCurrentTimeStep",
    "cpShapeGetHashID",
    "cpShapeGetSensor",
    "cpShapeGetBody",
    "cpBodyGetType",
    "cpBodyIsSleeping",
    "cpSpaceEachBody",
    "cpSpaceReindexShape",
    "cpSpaceStep",
    "ext_cpCollisionPreSolveFunc",
]
#: Bytes of a struct that are looked at; all are longer.
_WINDOW = {"body": 208, "shape": 136, "space": 64}


class LayoutError(RuntimeError):
    """Chipmunk's structs are not as expected: machine code must not touch them."""


def register_symbols() -> None:
    """Make pymunk's functions callable by name from compiled code (as rigidarea_<name>)."""
    for name in FUNCTIONS:
        address = int(ffi.cast("uintptr_t", ffi.addressof(lib, name)))
        llvm.add_symbol(f"rigidarea_{name}", address)


def address_of(cdata: object) -> int:
    """Address of a cffi pointer."""
    return int(ffi.cast("uintptr_t", cdata))


def _find(memory: np.ndarray, what: str, values: list[float]) -> int:
    n = len(values)
    hits = [
        i for i in range(len(memory) - n + 1) if np.allclose(memory[i : i + n], values, rtol=1e-15, atol=0)
    ]
    if len(hits) != 1:
        raise LayoutError(f"{what}: expected one place in Chipmunk's struct, found {len(hits)}")
    return 8 * hits[0]


@lru_cache(maxsize=1)
def layout() -> dict[str, int]:
    """Byte offsets by the names of `store.OFFSETS`. Raises LayoutError if any cannot be told for sure."""
    body = pymunk.Body(3.0, 7.0)
    body.center_of_gravity = (0.53, 0.29)
    body.angle = 0.75
    body.position = (101.25, 202.5)
    body.velocity = (31.5, 32.5)
    body.angular_velocity = 33.5
    body.force = (34.5, 35.5)
    body.torque = 36.5
    shape = pymunk.Circle(body, 1.0)
    shape.surface_velocity = (41.5, 42.5)

    def window(pointer: object, kind: str) -> np.ndarray:
        return np.frombuffer(ffi.buffer(ffi.cast("char *", pointer), _WINDOW[kind]), dtype=np.float64).copy()

    memory = window(body._body, "body")
    c, s = math.cos(0.75), math.sin(0.75)
    place = body.local_to_world(body.center_of_gravity)
    found = {
        "body_position": _find(memory, "body position", list(place)),
        "body_transform": _find(memory, "body transform", [c, s, -s, c, *body.position]),
        "body_velocity": _find(memory, "body velocity", [31.5, 32.5]),
        "body_spin": _find(memory, "angular velocity", [33.5]),
        "body_force": _find(memory, "force", [34.5, 35.5]),
        "body_torque": _find(memory, "torque", [36.5]),
        "body_inverse_mass": _find(memory, "inverse mass", [3.0, 1 / 3.0]) + 8,
        "body_inverse_moment": _find(memory, "inverse moment", [7.0, 1 / 7.0]) + 8,
        "shape_surface_velocity": _find(window(shape._shape, "shape"), "surface velocity", [41.5, 42.5]),
    }
    arbiter = {
        "arbiter_elasticity": "e",
        "arbiter_friction": "u",
        "arbiter_surface": "surface_vr",
        "arbiter_data": "data",
        "arbiter_shape_a": "a",
        "arbiter_body_a": "body_a",
        "arbiter_count": "count",
        "arbiter_normal": "n",
        "arbiter_process": "processCollision",
        "arbiter_state": "state",
        "arbiter_handlers": "handlerAB",
    }
    found["body_angle"] = _find(memory, "body angle", [0.75])
    # functions of the user's in the place of Chipmunk's own
    for name in ("position_func", "velocity_func"):
        own = np.frombuffer(
            ffi.buffer(ffi.cast("char *", body._body), _WINDOW["body"]), dtype=np.uint64
        ).copy()
        setattr(body, name, lambda *arguments: None)
        changed = np.frombuffer(ffi.buffer(ffi.cast("char *", body._body), _WINDOW["body"]), dtype=np.uint64)
        places = np.flatnonzero(own != changed)
        if len(places) != 1:
            raise LayoutError(f"{name}: expected one place in Chipmunk's body, found {len(places)}")
        found[f"body_{name}"], found[name] = 8 * int(places[0]), int(own[places[0]])
    found |= {name: ffi.offsetof("struct cpArbiter", field) for name, field in arbiter.items()}
    found["handler_post_solve"] = ffi.offsetof("struct cpCollisionHandler", "postSolveFunc")
    # what a handler's post_solve is that pymunk has cleared, and one that nobody ever set
    found["unset_post_solve"] = address_of(ffi.addressof(lib, "DoNothing"))
    space = pymunk.Space()
    space.gravity = (51.5, 52.5)
    found["space_gravity"] = _find(window(space._space, "space"), "gravity", [51.5, 52.5])
    space.on_collision(1, 2)
    found["no_post_solve"] = address_of(space._handlers[1, 2]._handler.postSolveFunc)
    for i, name in enumerate(("handlerAB", "handlerBA", "handlerA", "handlerB")):
        if ffi.offsetof("struct cpArbiter", name) != found["arbiter_handlers"] + 8 * i:
            raise LayoutError(f"arbiter {name}: the four handlers do not follow each other")
    for pair in ("a", "body_a"):  # B's pointer follows A's
        if ffi.offsetof("struct cpArbiter", pair.replace("a", "b") if pair == "a" else "body_b") != (
            ffi.offsetof("struct cpArbiter", pair) + 8
        ):
            raise LayoutError(f"arbiter {pair}: B's pointer does not follow A's")
    return found
