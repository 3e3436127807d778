"""Random scenes with every index checked, and every table between pages that nobody may touch.

    python tests/bounds.py [--scenes 2000] [--seed 0] [--cache DIR]

Machine code is compiled with numba's boundscheck, in a cache of its own. All that machine code reaches by its address
lies in pages of its own, at their end or at their beginning, between two that are closed. First it is shown that both
see a planted error: a table that is said to be shorter than it is, and one that is said to lie further on. Exit code 1,
and what was said, if either does not, or a scene does what they must not.
"""

from __future__ import annotations

import argparse
import ctypes
import math
import mmap
import os
import random
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pymunk

import rigidarea as ra
from rigidarea.chipmunk import arrays

DT = 1 / 60
PAGE = mmap.PAGESIZE
_protect = ctypes.CDLL(None, use_errno=True).mprotect
_protect.argtypes = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int
_at_end = True
said: list[str] = []


def guard(array: np.ndarray) -> np.ndarray:
    """A copy of an array between two closed pages: it ends (or begins) where one of them does."""
    base = array.base
    if isinstance(base, mmap.mmap) or array.nbytes == 0:
        return array
    pages = -(-array.nbytes // PAGE)
    memory = mmap.mmap(-1, (pages + 2) * PAGE)
    start = ctypes.addressof(ctypes.c_char.from_buffer(memory))
    offset = PAGE + (pages * PAGE - array.nbytes if _at_end else 0)
    new = np.frombuffer(memory, array.dtype, array.size, offset).reshape(array.shape)
    new[...] = array
    for closed in (start, start + (pages + 1) * PAGE):
        if _protect(closed, PAGE, 0) != 0:
            raise OSError(ctypes.get_errno(), "mprotect")
    return new


def put_between_guards(store: Any) -> None:
    """All arrays whose addresses machine code gets."""
    for name in ("pool", "work", "tables", "forms"):
        old = getattr(store, name)
        setattr(store, name, type(old)._make(map(guard, old)))
    for name in arrays._OWN:
        setattr(store, name, guard(getattr(store, name)))
    store._kept = {name: guard(array) for name, array in store._kept.items()}


def install() -> None:
    """From now on every set of tables is published between guards."""
    record = arrays.Store._record

    def guarded(store: Any) -> Any:
        record(store)  # makes what is kept
        put_between_guards(store)
        return record(store)

    arrays.Store._record = guarded  # type: ignore[method-assign]


def outline(draw: random.Random) -> ra.Outline:
    """A star, a disc, or a capsule."""
    kind = draw.randrange(3)
    if kind == 0:
        n = draw.randrange(3, 9)
        radius = [draw.uniform(0.2, 0.7) for _ in range(n)]
        return ra.Outline(
            [
                (r * math.cos(2 * math.pi * k / n), r * math.sin(2 * math.pi * k / n))
                for k, r in enumerate(radius)
            ]
        )
    if kind == 1:
        return ra.Outline.circle(draw.uniform(0.1, 0.6))
    return ra.Outline.from_bulges([(0, 0, 0), (0.6, 0, 1), (0.6, 0.3, 0), (0, 0.3, 1)])


def add(space: pymunk.Space, draw: random.Random) -> None:
    """A body with one or two shapes, or none."""
    body = pymunk.Body(draw.choice([1, 0.1, 20]), draw.choice([1, 0.1, 1e-2]))
    if draw.random() < 0.2:
        body = pymunk.Body(body_type=pymunk.Body.STATIC)
    body.position = draw.uniform(-4, 4), draw.uniform(0.5, 8)
    body.velocity = draw.uniform(-9, 9), draw.uniform(-30, 9)
    shapes: list[pymunk.Shape] = []
    for _ in range(draw.choice([0, 1, 1, 1, 2])):
        kind = draw.randrange(3)
        if kind == 0:
            shapes.append(pymunk.Poly.create_box(body, (draw.uniform(0.2, 1), 0.5)))
        elif kind == 1:
            shapes.append(pymunk.Circle(body, 0.3, (draw.choice([0, 0.3]), 0)))
        else:
            shapes.append(outline(draw).add_to(body))
    for shape in shapes:
        shape.friction, shape.elasticity = 0.5, draw.choice([0, 0.5])
    space.add(body, *shapes)


def join(space: pymunk.Space, draw: random.Random) -> None:
    """One of pymunk's joints between two bodies."""
    bodies = [b for b in space.bodies if b.body_type == pymunk.Body.DYNAMIC]
    if len(bodies) < 2:
        return
    a, b = draw.sample(bodies, 2)
    joints: list[Any] = [
        lambda: pymunk.PivotJoint(a, b, a.position),
        lambda: pymunk.PinJoint(a, b),
        lambda: pymunk.SlideJoint(a, b, (0, 0), (0, 0), 0, 2),
        lambda: pymunk.GrooveJoint(a, b, (-1, 0), (1, 0), (0, 0)),
        lambda: pymunk.DampedSpring(a, b, (0, 0), (0, 0), 1, 9, 1),
        lambda: pymunk.DampedRotarySpring(a, b, 0, 9, 1),
        lambda: pymunk.RotaryLimitJoint(a, b, -0.1, 0.1),
        lambda: pymunk.RatchetJoint(a, b, 0, 0.2),
        lambda: pymunk.GearJoint(a, b, 0, 2),
        lambda: pymunk.SimpleMotor(a, b, 1),
    ]
    joint = draw.choice(joints)()
    joint.collide_bodies = draw.random() < 0.5
    space.add(joint)


def remove(space: pymunk.Space, draw: random.Random) -> None:
    """A body and all that is its own, or a joint."""
    things: list[Any] = [*space.bodies, *space.constraints]
    if things:
        thing = draw.choice(things)
        if isinstance(thing, pymunk.Body):
            joints = [joint for joint in thing.constraints if joint in space.constraints]
            space.remove(*joints, thing, *thing.shapes)
        else:
            space.remove(thing)


def scene(seed: int) -> None:
    """A space in which things come, are joined, and go, for some frames; some before there is one."""
    global _at_end
    _at_end = seed % 2 == 0
    draw = random.Random(seed)
    space = pymunk.Space()
    space.gravity = 0, -10
    space.sleep_time_threshold = draw.choice([math.inf, 0.2])
    space.add(pymunk.Segment(space.static_body, (-9, 0), (9, 0), draw.choice([0, 0.1])))
    for _ in range(draw.choice([3, 10, 40])):
        add(space, draw)
    contact = ra.attach(space)
    for _ in range(12):
        draw.choice([add, add, join, remove])(space, draw)
        for _ in range(draw.choice([0, 0, 60])):
            tile = pymunk.Poly(space.static_body, [(0, -1), (1, -1), (0, 0)])
            space.add(tile)
            space.remove(tile)
        try:
            contact.step(DT, 2, steps=draw.choice([None, 1, 5]))
        except ra.SimulationError:
            return
        contact.energy()
    if draw.random() < 0.3:
        space.copy().step(DT)
    contact.detach()


def planted(what: str) -> int:
    """How a process ends in which the table of bodies is said to be shorter, or to lie further on, than it does."""
    child = os.fork()
    if child == 0:
        space = pymunk.Space()
        for k in range(9):
            body = pymunk.Body(1, 1)
            body.position = k, 0
            space.add(body, pymunk.Circle(body, 0.6))
        contact = ra.attach(space)
        space.step(DT)
        if what == "index":
            contact._state["bodies_n"] = 3
        else:
            contact._state["bodies_at"] += contact._store.tables.bodies.nbytes
        space.step(DT)
        os._exit(1 if said else 0)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def check(scenes: int, seed: int) -> int:
    """In a process whose machine code is checked: the planted errors, then the scenes."""
    sys.unraisablehook = lambda given: said.append(
        repr(given.exc_value)
    )  # of a callback it is printed, and goes on
    install()
    scene(seed)
    if said:
        print("\n".join(said))
        return 1
    found = planted("index"), planted("address")
    if found != (1, -signal.SIGSEGV):
        print(f"planted errors were not seen: {found}")
        return 1
    for k in range(seed, seed + scenes):
        scene(k)
        if said:
            print(f"scene {k}: {said[:3]}")
            return 1
    print(f"{scenes} scenes, nothing")
    return 0


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--scenes", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=0, help="of the first")
    parser.add_argument("--cache", type=Path, default=Path.home() / ".cache" / "rigidarea-bounds")
    given = parser.parse_args()
    if os.environ.get("NUMBA_BOUNDSCHECK") == "1":
        return check(given.scenes, given.seed)
    checked = {**os.environ, "NUMBA_BOUNDSCHECK": "1", "NUMBA_CACHE_DIR": str(given.cache)}
    return subprocess.run([sys.executable, *sys.argv], env=checked).returncode


if __name__ == "__main__":
    sys.exit(main())
