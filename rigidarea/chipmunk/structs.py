"""Chipmunk's memory: where in its structs the numbers lie that a contact step reads and writes, and what it calls.

Arbiters are declared to cffi, which knows their layout. Bodies, shapes, constraints and spaces are not: their offsets
are found by setting every quantity of a probe to a value of its own and looking for it. A layout in which anything is
missing or ambiguous is refused (`LayoutError`). Why memory and not functions: every setter of Chipmunk wakes the
body, so a body at rest on another could never fall asleep; and a read costs a load instead of a call.

Everything here works interpreted too (NUMBA_DISABLE_JIT=1): memory through ctypes, functions through ctypes.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

import numpy as np
import pymunk
from pymunk._chipmunk_cffi import ffi, lib

from ..compile.jit import external

#: Bytes of a struct that are looked at; all are longer.
_WINDOW = {
    "body": 248,
    "shape": 192,
    "circle": 232,
    "segment": 296,
    "poly": 216,
    "space": 200,
    "constraint": 104,
}


class LayoutError(RuntimeError):
    """Chipmunk's structs are not as expected: machine code must not touch them."""


def address_of(cdata: object) -> int:
    """Address of a cffi pointer."""
    return int(ffi.cast("uintptr_t", cdata))


def function(name: str, signature: str) -> Any:
    """The function `name` of pymunk's C library, callable from kernels.

    signature: as numba writes it, of pointers (`uintp`) and scalars.
    """
    return external(name, signature, address_of(ffi.addressof(lib, name)))


def _bytes(pointer: object, kind: str, dtype: Any) -> np.ndarray:
    memory = ffi.buffer(ffi.cast("char *", pointer), _WINDOW[kind])
    return np.frombuffer(memory, dtype=dtype).copy()


def _find(memory: np.ndarray, what: str, values: list[float]) -> int:
    n = len(values)
    hits = [
        i for i in range(len(memory) - n + 1) if np.allclose(memory[i : i + n], values, rtol=1e-15, atol=0)
    ]
    if len(hits) != 1:
        raise LayoutError(f"{what}: expected one place in Chipmunk's struct, found {len(hits)}")
    return 8 * hits[0]


def _find_pointer(pointer: object, kind: str, what: str, value: int) -> int:
    hits = np.flatnonzero(_bytes(pointer, kind, np.uint64) == np.uint64(value))
    if len(hits) != 1:
        raise LayoutError(f"{what}: expected one place in Chipmunk's struct, found {len(hits)}")
    return 8 * int(hits[0])


def _find_array(space: Any, what: str, members: list[int]) -> int:
    """Where the space keeps the cpArray {int num, max; void **arr} of just these pointers."""
    hits = []
    for i, value in enumerate(_bytes(space, "space", np.uint64)):
        if not 4096 < value < 2**47 or value % 8:
            continue
        if int(value) not in _heap_pointers(space):
            continue
        n = int(ffi.cast("int *", int(value))[0])
        if n == len(members):
            arr = ffi.cast("uintptr_t *", ffi.cast("uintptr_t *", int(value))[1])
            if [int(arr[k]) for k in range(n)] == members:
                hits.append(8 * i)
    if len(hits) != 1:
        raise LayoutError(f"{what}: expected one array in Chipmunk's space, found {len(hits)}")
    return hits[0]


def _heap_pointers(space: Any) -> set[int]:
    """The words of the space's struct between its time step and its lock: all of them pointers or counters."""
    words = _bytes(space, "space", np.uint64)
    step = _find(words.view(np.float64), "time step", [0.125]) // 8
    return {int(w) for w in words[step + 1 : step + 16] if w > 2**16}


def _changed(pointer: object, kind: str, what: str, change: Any) -> tuple[int, int]:
    """(offset, old value) of the one pointer that `change()` changes."""
    own = _bytes(pointer, kind, np.uint64)
    change()
    places = np.flatnonzero(own != _bytes(pointer, kind, np.uint64))
    if len(places) != 1:
        raise LayoutError(f"{what}: expected one place in Chipmunk's struct, found {len(places)}")
    return 8 * int(places[0]), int(own[places[0]])


@lru_cache(maxsize=1)
def layout() -> dict[str, int]:
    """Byte offsets by the names of `store.OFFSETS`. Raises LayoutError if any cannot be told for sure."""
    return _body_and_shape() | _geometry() | _arbiter() | _space_and_constraint()


def _body_and_shape() -> dict[str, int]:
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
    shape.elasticity, shape.friction = 0.375, 0.625
    shape.collision_type = 0x51525354
    shape.filter = pymunk.ShapeFilter(0x61626364, 0x71727374, 0x75767778)
    memory = _bytes(body._body, "body", np.float64)
    c, s = math.cos(0.75), math.sin(0.75)
    place = body.local_to_world(body.center_of_gravity)
    found = {
        "body_position": _find(memory, "body position", list(place)),
        "body_angle": _find(memory, "body angle", [0.75]),
        "body_cog": _find(memory, "centre of gravity", [0.53, 0.29]),
        "body_transform": _find(memory, "body transform", [c, s, -s, c, *body.position]),
        "body_velocity": _find(memory, "body velocity", [31.5, 32.5]),
        "body_spin": _find(memory, "angular velocity", [33.5]),
        "body_force": _find(memory, "force", [34.5, 35.5]),
        "body_torque": _find(memory, "torque", [36.5]),
        "body_inverse_mass": _find(memory, "inverse mass", [3.0, 1 / 3.0]) + 8,
        "body_inverse_moment": _find(memory, "inverse moment", [7.0, 1 / 7.0]) + 8,
    }
    for name in ("position_func", "velocity_func"):
        found[f"body_{name}"], found[name] = _changed(
            body._body, "body", name, lambda name=name: setattr(body, name, lambda *arguments: None)
        )
    # Set back, they are not those addresses: what cffi gives for a function is a way into it.
    body.position_func, body.velocity_func = pymunk.Body.update_position, pymunk.Body.update_velocity
    for name in ("position_func", "velocity_func"):
        found[f"{name}_again"] = word_at(body._body, found[f"body_{name}"])
    memory = _bytes(shape._shape, "shape", np.float64)
    found["shape_surface_velocity"] = _find(memory, "surface velocity", [41.5, 42.5])
    found["shape_elasticity"] = _find(memory, "elasticity and friction", [0.375, 0.625])
    found["shape_type"] = _find_pointer(shape._shape, "shape", "collision type", 0x51525354)
    found["shape_filter"] = _find_pointer(shape._shape, "shape", "filter group", 0x61626364)
    plain = _bytes(shape._shape, "shape", np.uint8)
    shape.sensor = True
    places = np.flatnonzero(plain != _bytes(shape._shape, "shape", np.uint8))
    if len(places) != 1:
        raise LayoutError(f"sensor: expected one place in Chipmunk's struct, found {len(places)}")
    found["shape_sensor"] = int(places[0])
    words = _bytes(shape._shape, "shape", np.uint32)
    at = (found["shape_filter"] + 8) // 4
    if list(words[at : at + 2]) != [0x71727374, 0x75767778]:
        raise LayoutError("filter: categories and mask do not follow the group")
    space = pymunk.Space()
    space.add(body, shape)
    found["body_shapes"] = _find_pointer(body._body, "body", "shapes", address_of(shape._shape))
    other = pymunk.Circle(body, 2.0)
    space.add(other)  # the body's list of shapes starts with the latest
    found["shape_next"] = _find_pointer(other._shape, "shape", "next shape", address_of(shape._shape))
    return found


def _geometry() -> dict[str, int]:
    """Where shapes keep their numbers, in their body's coordinates. A number that starts their class tells the kind."""
    space = pymunk.Space()
    body = pymunk.Body(1, 1)
    body.position = 11.25, 12.5  # what Chipmunk keeps of where they are is something else
    circle = pymunk.Circle(body, 81.25, (82.5, 83.5))
    segment = pymunk.Segment(body, (84.5, 85.5), (86.5, 88.5), 89.25)
    corners = [(91.5, 92.5), (94.5, 93.5), (95.5, 98.5)]
    poly = pymunk.Poly(body, corners, radius=99.25)
    space.add(body, circle, segment, poly)
    found = {
        "shape_hashid": _find_pointer(poly._shape, "shape", "hash id", poly._hashid),
        "shape_body": _find_pointer(poly._shape, "shape", "body", address_of(body._body)),
    }
    for kind, shape in enumerate((circle, segment, poly)):
        if int(ffi.cast("int *", word_at(shape._shape, 0))[0]) != kind:
            raise LayoutError(f"shapes: expected a class that starts with {kind}")
    own = found["shape_hashid"] + 8  # what is a circle's alone
    memory = _bytes(circle._shape, "circle", np.float64)[own // 8 :]
    found["circle_centre"] = own + _find(memory, "circle's centre", [82.5, 83.5])
    found["circle_radius"] = own + _find(memory, "circle's radius", [81.25])
    memory = _bytes(segment._shape, "segment", np.float64)
    found["segment_ends"] = _find(memory, "segment's ends", [84.5, 85.5, 86.5, 88.5])
    found["segment_radius"] = _find(memory, "segment's radius", [89.25])
    found["poly_radius"] = _find(_bytes(poly._shape, "poly", np.float64), "polygon's radius", [99.25])
    found["poly_count"] = found["poly_radius"] + 8
    found["poly_planes"] = found["poly_radius"] + 16
    words = _bytes(poly._shape, "poly", np.int32)
    planes = np.frombuffer(
        ffi.buffer(ffi.cast("void *", word_at(poly._shape, found["poly_planes"])), 8 * 4 * 6), np.float64
    )
    # (v0, n) of each edge where it is, and then as it was given
    given = [tuple(vertex) for vertex in poly.get_vertices()]
    if words[found["poly_count"] // 4] != 3 or [tuple(v) for v in planes.reshape(6, 4)[3:, :2]] != given:
        raise LayoutError("polygon: its vertices are not where they were expected")
    return found


def _arbiter() -> dict[str, int]:
    arbiter = {
        "arbiter_elasticity": "e",
        "arbiter_friction": "u",
        "arbiter_surface": "surface_vr",
        "arbiter_shape_a": "a",
        "arbiter_count": "count",
        "arbiter_contacts": "contacts",
        "arbiter_normal": "n",
        "arbiter_handlers": "handlerAB",
        "arbiter_process": "processCollision",
        "arbiter_stamp": "stamp",
    }
    found = {name: int(ffi.offsetof("struct cpArbiter", field)) for name, field in arbiter.items()}
    for pair in (("a", "b"), ("handlerAB", "handlerBA")):  # B's pointer follows A's
        at, after = (int(ffi.offsetof("struct cpArbiter", field)) for field in pair)
        if after != at + 8:
            raise LayoutError(f"arbiter {pair[0]}: B's pointer does not follow A's")
    contact = {"contact_normal_impulse": "jnAcc", "contact_tangent_impulse": "jtAcc"}
    found |= {name: int(ffi.offsetof("struct cpContact", field)) for name, field in contact.items()}
    found["contact_size"] = int(ffi.sizeof("struct cpContact"))
    return found


def normal_of(arbiter: int) -> tuple[float, float]:
    """The normal of the arbiter at that address as Chipmunk finds it, whatever a callback has made of it."""
    own = ffi.cast("struct cpArbiter *", arbiter)
    normal = lib.cpShapesCollide(own.a, own.b).normal
    return normal.x, normal.y


def centre_of(body: pymunk.Body) -> np.ndarray:
    """Where a body's centre of gravity is in the world, in place: float64 (2,) of Chipmunk's memory (length)."""
    at = layout()["body_position"]
    return np.frombuffer(ffi.buffer(ffi.cast("char *", body._body) + at, 16))


def put_centre(body: pymunk.Body, x: float, y: float) -> None:
    """Put a body's centre of gravity there, its angle kept, without waking it."""
    centre_of(body)[:] = x, y
    transform = np.frombuffer(ffi.buffer(ffi.cast("char *", body._body) + layout()["body_transform"], 48))
    c, s = math.cos(body.angle), math.sin(body.angle)
    off = body.center_of_gravity
    transform[:] = c, s, -s, c, x - (c * off.x - s * off.y), y - (s * off.x + c * off.y)


def _space_and_constraint() -> dict[str, int]:
    space = pymunk.Space()
    space.gravity = (51.5, 52.5)
    space.sleep_time_threshold = 53.5
    one, two = pymunk.Body(1, 1), pymunk.Body(1, 1)
    joint = pymunk.PivotJoint(one, two, (0, 0), (0, 0))
    joint.max_force, joint.error_bias, joint.max_bias = 61.5, 62.5, 63.5
    space.add(one, two, joint)
    lib.cpSpaceStep(space._space, 0.125)  # not space.step, which somebody may have wrapped
    space.iterations = 0x1234567
    memory = _bytes(space._space, "space", np.float64)
    if _bytes(space._space, "space", np.int32)[0] != 0x1234567:
        raise LayoutError("iterations: expected at the start of Chipmunk's space")
    found = {
        "space_gravity": _find(memory, "gravity", [51.5, 52.5]),
        "space_bodies": _find_array(space._space, "bodies", [address_of(one._body), address_of(two._body)]),
        "space_constraints": _find_array(space._space, "constraints", [address_of(joint._constraint)]),
    }
    handler = pymunk.Space.on_collision
    handler(space, begin=lambda *arguments: None, pre_solve=lambda *arguments: None)
    own = space._handlers[None, None]._handler
    found["pythons_begin"] = address_of(own.beginFunc)
    found["handler_pre_solve"] = int(ffi.offsetof("struct cpCollisionHandler", "preSolveFunc"))
    found["pythons_pre_solve"] = address_of(own.preSolveFunc)
    space.on_collision(begin=pymunk.empty_callback, pre_solve=pymunk.empty_callback)
    found["no_pre_solve"] = address_of(own.preSolveFunc)
    globally = address_of(own)
    found["space_handlers"] = globally - address_of(space._space) - 8
    entries = ffi.cast("unsigned int *", word_at(space._space, found["space_handlers"]))
    before = int(entries[0])
    handler(space, 1, 2)
    if int(entries[0]) != before + 1:
        raise LayoutError("handlers: their number is not where it was expected")
    constraint = joint._constraint
    memory = _bytes(constraint, "constraint", np.float64)
    found["constraint_a"] = _find_pointer(constraint, "constraint", "body a", address_of(one._body))
    if _find_pointer(constraint, "constraint", "body b", address_of(two._body)) != found["constraint_a"] + 8:
        raise LayoutError("constraint: body b does not follow body a")
    found["constraint_collide"] = _find(memory, "limits", [61.5, 62.5, 63.5]) + 24
    for name in ("pre_solve", "post_solve"):
        found[f"constraint_{name}"], _ = _changed(
            constraint, "constraint", name, lambda name=name: setattr(joint, name, lambda *arguments: None)
        )
    space.iterations = 10
    found["space_contacts"] = _contact_buffers(found["space_constraints"])
    two.sleep()
    found["space_sleeping"] = _find_array(space._space, "components that sleep", [address_of(two._body)])
    return found


def _contact_buffers(constraints: int) -> int:
    """Where a space keeps the head of its contact buffers, whose count of contacts is 16 bytes on, and its indices:
    static, dynamic, joints, arbiters, buffers. constraints: where its joints are (bytes).
    """
    space = pymunk.Space()
    body = pymunk.Body(1, 1)
    space.add(body, pymunk.Circle(body, 1), pymunk.Circle(space.static_body, 1))
    lib.cpSpaceStep(space._space, 0.125)
    (arbiter,) = space._get_arbiters()
    head = word_at(space._space, constraints + 16)
    first = address_of(ffi.cast("struct cpArbiter *", arbiter).contacts)
    if head + 24 != first or int(ffi.cast("unsigned int *", head + 16)[0]) != 1:
        raise LayoutError("contacts: a space's buffer of them is not where it was expected")
    still, moving = (word_at(space._space, constraints - offset) for offset in (16, 8))
    if word_at(ffi.cast("void *", moving), 16) != still or word_at(ffi.cast("void *", still), 24) != moving:
        raise LayoutError("indices: a space's dynamic index does not know its static one")
    return constraints + 16


def word_at(pointer: object, offset: int) -> int:
    return int(ffi.cast("uintptr_t *", address_of(pointer) + offset)[0])
