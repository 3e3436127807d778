"""A world without Chipmunk: a frame that reads copies of its structs, in memory of its own, and calls no Python.

A world (`rigidarea.worlds`) is one block of memory: WORLD, a state record, tables, and copies of Chipmunk's structs of
the space, its bodies, shapes and joints, at which the addresses in the tables point. So `hidden_constraint.solve` runs
on it, the same machine code, as if Chipmunk had called it. What Chipmunk does in a step beside asking us is here:
velocities (cpBodyUpdateVelocity, to the bit), and nothing else, as
there are no callbacks, nobody sleeps, and pairs are found by our own broad phase. Outlines are shared, scratch is the
thread's.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..compile.jit import callback, copy_memory, kernel
from ..compile.raw_memory import array_at, caller, record
from ..contact.broad import forget_the_gone
from ..contact.join import roomy
from ..contact.space_record import STATE, clear, enter_body, load_tables
from ..contact.tables import BODIES, KNOWN, SHAPES, TOLD, Tables, rehash
from .awake import watch_bodies
from .begin import look_at_jointed
from .joints import joints_of, read_joint, take_joints
from .moved import HEAD, free_again
from .record import floats, look_at_partners, members, words

#: What a world's memory begins with; `..._at` are addresses.
WORLD = record(
    [
        ("state_at", "u8"),
        ("space_at", "u8"),  # the copies of Chipmunk's structs
        ("bodies_at", "u8"),  # one behind the other, those of the space first
        ("shapes_at", "u8"),
        ("count", "i8"),  # bodies of the space
        ("damping", "f8"),  # share of its velocity that a body keeps in a unit of time
        ("joint_at", "u8"),  # what stands for our own constraint: it knows the space
        ("solve_at", "u8"),  # `hidden_constraint.solve` and `hidden_constraint.report`
        ("report_at", "u8"),
        ("stamp_at", "i8"),  # where the space has its count of steps and its time step (bytes)
        ("step_at", "i8"),
        ("nothing_at", "i8"),  # where a body's struct has a word that is 0 (bytes)
        ("body_size", "i8"),  # from one struct to the next (bytes)
        ("shape_size", "i8"),
        ("shapes", "i8"),
        ("outcome", "i8"),  # of the last frame: DONE, or why it is not
        ("done", "i8"),  # frames of the last call
    ]
)
_call_solve = caller("void(uintp, float64)")
_call_report = caller("void(uintp, uintp)")
_STATE_WORDS = STATE.itemsize // 8

#: What came of a frame: all of it; nothing, since tables are too small; nothing, since a state is not finite.
DONE, TOO_SMALL, NOT_FINITE = range(3)


@callback("void(uintp)")
def no_answer(request: int) -> None:
    """Nobody can be asked: the frame ends as it began, and whoever stepped the world hears of it."""


@kernel
def _update_velocities(s: Any, space: int, damping: float, dt: float) -> None:
    """What cpBodyUpdateVelocity does with each body that is not kinematic."""
    g = floats(space + s.space_gravity, 2)
    keep = damping**dt
    for address in members(space, s.space_bodies):
        mass = floats(address + s.body_inverse_mass - 8, 2)
        if mass[0] == math.inf:
            continue
        v = floats(address + s.body_velocity, 2)
        f = floats(address + s.body_force, 2)
        spin = floats(address + s.body_spin, 1)
        torque = floats(address + s.body_torque, 1)
        v[0] = v[0] * keep + (g[0] + f[0] * mass[1]) * dt
        v[1] = v[1] * keep + (g[1] + f[1] * mass[1]) * dt
        spin[0] = spin[0] * keep + torque[0] * floats(address + s.body_inverse_moment, 1)[0] * dt
        f[0] = 0.0
        f[1] = 0.0
        torque[0] = 0.0


@kernel
def _begin(s: Any, space: int, world: Any, dt: float) -> bool:
    """As `begin.begin`, where nobody comes or goes and nobody is asked."""
    stamp = array_at(space + world.stamp_at, (1,), np.uint32)
    stamp[0] += np.uint32(1)
    s.frame = np.int64(stamp[0])
    g = floats(space + s.space_gravity, 2)
    s.gravity = math.sqrt(g[0] * g[0] + g[1] * g[1])
    s.failed = 0
    s.fragile = 0
    tables = load_tables(s)
    tables.counters[TOLD] = 0
    forget_the_gone(tables)
    if not watch_bodies(s, tables, space, dt):
        return False
    tables.counters[KNOWN] = 0
    look_at_partners(s, tables)
    constraints = members(space, s.space_constraints)
    take_joints(s, tables, constraints)
    look_at_jointed(s, tables)
    for joint in joints_of(s):
        joint.taken = 1
        read_joint(s, joint)
        joint.asked = 0
    return True


@kernel
def _step(s: Any, world: Any, dt: float) -> int:
    """One frame: DONE, or the world is as it was."""
    space = world.space_at
    if not _begin(s, space, world, dt):
        return TOO_SMALL
    _update_velocities(s, space, world.damping, dt)
    shapes = s.body_shapes
    s.body_shapes = world.nothing_at  # their boxes are for Chipmunk's queries
    _call_solve(world.solve_at, world.joint_at, 1.0)
    s.body_shapes = shapes
    _call_report(world.report_at, world.joint_at, space)
    if s.failed == 0:
        return DONE
    return NOT_FINITE if s.broken >= 0 else TOO_SMALL


@kernel(forceinline=True)
def _state(world: Any) -> Any:
    return array_at(world.state_at, (1,), STATE)[0]


@kernel
def _push(s: Any, world: Any, forces: np.ndarray, sign: float) -> None:
    """Forces at the centres of gravity, and torques, on top of what there is; or taken from it."""
    for i in range(world.count):
        body = world.bodies_at + i * world.body_size
        f = floats(body + s.body_force, 2)
        f[0] += sign * forces[3 * i]
        f[1] += sign * forces[3 * i + 1]
        floats(body + s.body_torque, 1)[0] += sign * forces[3 * i + 2]


@kernel
def _read(s: Any, world: Any, out: np.ndarray) -> None:
    """Where the bodies are, and how they move: x, y, angle, vx, vy, w of each."""
    for i in range(world.count):
        body = world.bodies_at + i * world.body_size
        place = floats(body + s.body_transform + 32, 2)
        v = floats(body + s.body_velocity, 2)
        k = 6 * i
        out[k] = place[0]
        out[k + 1] = place[1]
        out[k + 2] = floats(body + s.body_angle, 1)[0]
        out[k + 3] = v[0]
        out[k + 4] = v[1]
        out[k + 5] = floats(body + s.body_spin, 1)[0]


@callback("int64(uintp, uintp, int64, int64, uintp, float64, int64, uintp)")
def step(
    which: int, scratch: int, n: int, rows: int, forces: int, dt: float, frames: int, states: int
) -> int:
    """Step n worlds by so many frames each, one after the other; how many of them could not (WORLD.outcome).

    which: n addresses of worlds. scratch: its length, and as often a word of the state record and what is to be there.
    forces: (n, rows, 3), in every frame; 0: none. states: (n, rows, 6), where they are at the end; 0: not asked. Rows
    beyond those of a world's bodies are left alone.
    """
    failed = 0
    room = words(scratch, 1)[0]
    own = array_at(scratch + 8, (np.int64(room), 2), np.int64)
    addresses = words(which, n)
    for i in range(n):
        world = array_at(addresses[i], (1,), WORLD)[0]
        s = _state(world)
        fields = array_at(world.state_at, (_STATE_WORDS,), np.int64)
        for k in range(len(own)):
            fields[own[k, 0]] = own[k, 1]
        floats(world.space_at + world.step_at, 1)[0] = dt
        world.outcome = DONE
        world.done = 0
        for _ in range(frames):
            world.outcome = TOO_SMALL
            if roomy(load_tables(s), load_tables(s).counters[SHAPES], dt):
                if forces != 0:
                    _push(s, world, floats(forces + 24 * i * rows, 3 * world.count), 1.0)
                world.outcome = _step(s, world, dt)
                if world.outcome != DONE and forces != 0:
                    _push(s, world, floats(forces + 24 * i * rows, 3 * world.count), -1.0)
            if world.outcome != DONE:
                failed += 1
                break
            world.done += 1
        if states != 0:
            _read(s, world, floats(states + 48 * i * rows, 6 * world.count))
    return failed


@callback("void(uintp, int64, int64, uintp)")
def read(which: int, n: int, rows: int, states: int) -> None:
    """The states of n worlds: (n, rows, 6)."""
    addresses = words(which, n)
    for i in range(n):
        world = array_at(addresses[i], (1,), WORLD)[0]
        _read(_state(world), world, floats(states + 48 * i * rows, 6 * world.count))


@callback("void(uintp, int64, int64, uintp)")
def write(which: int, n: int, rows: int, states: int) -> None:
    """Put the bodies of n worlds there, as they are to move: (n, rows, 6)."""
    addresses = words(which, n)
    for i in range(n):
        world = array_at(addresses[i], (1,), WORLD)[0]
        s = _state(world)
        given = array_at(states + 48 * i * rows, (world.count, 6), np.float64)
        for j in range(world.count):
            body = world.bodies_at + j * world.body_size
            c = math.cos(given[j, 2])
            d = math.sin(given[j, 2])
            cog = floats(body + s.body_cog, 2)
            p = floats(body + s.body_position, 2)
            p[0] = c * cog[0] - d * cog[1] + given[j, 0]
            p[1] = d * cog[0] + c * cog[1] + given[j, 1]
            floats(body + s.body_angle, 1)[0] = given[j, 2]
            t = floats(body + s.body_transform, 6)
            t[0] = c
            t[1] = d
            t[2] = -d
            t[3] = c
            t[4] = given[j, 0]
            t[5] = given[j, 1]
            v = floats(body + s.body_velocity, 2)
            v[0] = given[j, 3]
            v[1] = given[j, 4]
            floats(body + s.body_spin, 1)[0] = given[j, 5]


@kernel
def _find_bodies(s: Any, tables: Tables) -> None:
    """The hash table of bodies by their addresses, made anew."""
    clear(s.body_keys_at, s.body_keys_n)
    for i in range(tables.counters[BODIES]):
        if tables.bodies[i].address != 0:
            enter_body(s, tables.bodies[i].address, i)


@kernel
def _swap_parameters(world: Any, s: Any, kept: np.ndarray, back: bool) -> None:
    """What may differ from world to world, and outlives a reset: masses, materials, gravity, damping."""
    k = 0
    for i in range(world.count + world.shapes + 1):
        if i < world.count:
            own = floats(world.bodies_at + i * world.body_size + s.body_inverse_mass - 8, 4)
        elif i < world.count + world.shapes:
            own = floats(world.shapes_at + (i - world.count) * world.shape_size + s.shape_elasticity, 2)
        else:
            own = floats(world.space_at + s.space_gravity, 2)
        for m in range(len(own)):
            if back:
                own[m] = kept[k]
            else:
                kept[k] = own[m]
            k += 1
    if back:
        world.damping = kept[k]
    else:
        kept[k] = world.damping


@callback("void(uintp, int64, uintp, int64, int64, uintp, int64, uintp)")
def put(which: int, n: int, image: int, home: int, size: int, fixups: int, words_n: int, kept: int) -> None:
    """Have n worlds be as `image` is, of so many bytes, whose addresses are those of a world at `home`.

    fixups: words_n int64, the words of a world that are addresses in it. kept: room for what a world keeps of its own
    parameters; 0: it takes the image's.
    """
    addresses = words(which, n)
    places = array_at(fixups, (words_n,), np.int64)
    for i in range(n):
        at = np.int64(addresses[i])
        world = array_at(at, (1,), WORLD)[0]
        if kept != 0:
            own = floats(kept, 4 * world.count + 2 * world.shapes + 3)
            _swap_parameters(world, _state(world), own, False)
        copy_memory(np.uint64(at), np.uint64(image), np.uint64(size))
        memory = array_at(at, (size // 8,), np.int64)
        for k in range(words_n):
            memory[places[k]] += at - home
        s = _state(world)
        if kept != 0:
            _swap_parameters(world, s, floats(kept, 4 * world.count + 2 * world.shapes + 3), True)
        _find_bodies(s, load_tables(s))


@callback("void(uintp, int64, uintp)")
def enlarged(which: int, n: int, head: int) -> None:
    """The tables of n worlds have more room for pairs and regions than `head` (HEAD) says: it is free, and last."""
    before = array_at(head, (1,), HEAD)[0]
    for address in words(which, n):
        s = _state(array_at(address, (1,), WORLD)[0])
        tables = load_tables(s)
        free_again(tables, before, len(tables.pairs), len(tables.regions))
        rehash(tables)
        _find_bodies(s, tables)
