"""SIGINTs at random times of steps, growth, sweeps, callbacks: raised once each, and the frame whole or not at all.

Each is sent from outside to a process of its own, which steps a space, catches what is raised, and steps on. The bits
of all bodies and joints are those of the undisturbed course at one of its frames when it is caught, and at its end.
"""

from __future__ import annotations

import gc
import os
import random
import signal
import struct
import subprocess
import sys
import tempfile
import time
import traceback
from collections.abc import Callable
from types import FrameType
from typing import Any, NamedTuple

import pymunk

from rigidarea import AreaContact, attach

from . import environment
from .lives import DT

FRAMES = 40
INTERRUPT = [signal.SIGINT]
#: A process that takes longer hangs (s).
PATIENCE = 60


class Course(NamedTuple):
    """A space, and how it is stepped on: one frame, or as many as are left."""

    space: pymunk.Space
    step: Callable[[int], object]


def pile(n: int, native: bool, iterations: int = 10) -> tuple[pymunk.Space, AreaContact | None]:
    """n bodies in a row of columns on a floor, the first of them hinged: they come to touch one after the other."""
    space = pymunk.Space()
    space.gravity = 0, -10
    space.iterations = iterations
    floor = pymunk.Segment(space.static_body, (-40, 0), (40, 0), 0.1)
    floor.friction = 0.5
    space.add(floor)
    draw = random.Random(n)
    for i in range(n):
        body = pymunk.Body(1, 0.2)
        body.position = 1.05 * (i % 8) + draw.uniform(0, 0.1), 0.7 + 1.02 * (i // 8)
        shape = pymunk.Circle(body, 0.5) if i % 3 == 0 else pymunk.Poly.create_box(body, (1, 1))
        shape.friction, shape.elasticity = 0.5, 0.3
        space.add(body, shape)
    a, b = list(space.bodies)[:2]
    space.add(pymunk.PivotJoint(a, b, (a.position + b.position) / 2))
    return space, None if native else attach(space)


def _steps(native: bool, n: int = 24, iterations: int = 10) -> Course:
    space, _ = pile(n, native, iterations)
    return Course(space, lambda left: space.step(DT))


def _called(native: bool) -> Course:
    space, _ = pile(24, native)
    space.on_collision(pre_solve=lambda *given: None, separate=lambda *given: None)
    return Course(space, lambda left: space.step(DT))


def _on_end(native: bool) -> Course:
    space, contact = pile(24, native)
    return Course(space, lambda left: contact.step(DT, left) if contact else space.step(DT))


def _tolerance(native: bool) -> Course:
    space, contact = pile(6, native)
    return Course(space, lambda left: contact.step(DT, tolerance=1e-2) if contact else space.step(DT))


#: What is interrupted: steps; tables that grow; many sweeps; frames on end; substeps to a tolerance; callbacks.
COURSES: dict[str, Callable[[bool], Course]] = {
    "steps": _steps,
    "growth": lambda native: _steps(native, 80),
    "sweeps": lambda native: _steps(native, 40, 300),
    "frames on end": _on_end,
    "tolerance": _tolerance,
    "callbacks": _called,
}


def _bits(space: pymunk.Space) -> bytes:
    """All that a frame changes of bodies and joints."""
    numbers: list[float] = []
    for body in space.bodies:
        numbers += [
            *body.position,
            body.angle,
            *body.velocity,
            body.angular_velocity,
            *body.force,
            body.torque,
        ]
    numbers += [joint.impulse for joint in space.constraints]
    return struct.pack(f"{len(numbers)}d", *numbers)


def undisturbed(name: str, native: bool) -> tuple[list[bytes], float]:
    """The bits at the start and after each frame of a course; how long it takes (s)."""
    course = COURSES[name](native)
    bits = [_bits(course.space)]
    start = time.perf_counter()
    for _ in range(FRAMES):
        course.step(1)
        bits.append(_bits(course.space))
    taken = time.perf_counter() - start
    del course
    gc.collect()  # else the processes to come do that in their steps: what is raised in a finalizer is lost
    return bits, taken


def _child(name: str, native: bool, known: list[bytes], ready: int, sent: int) -> str:
    """Step a course while it is interrupted: what is wrong, "" if nothing, "swallowed" if nothing was raised."""
    done = caught = 0
    course = COURSES[name](native)
    signal.pthread_sigmask(signal.SIG_BLOCK, INTERRUPT)  # it comes in steps, not in what looks at them
    os.write(ready, b".")
    while done < FRAMES:
        before, raised = done, False
        try:
            signal.pthread_sigmask(signal.SIG_UNBLOCK, INTERRUPT)
            course.step(FRAMES - done)
            signal.pthread_sigmask(signal.SIG_BLOCK, INTERRUPT)
        except KeyboardInterrupt:
            signal.pthread_sigmask(signal.SIG_BLOCK, INTERRUPT)
            caught, raised = caught + 1, True
        bits = _bits(course.space)
        if bits not in known[before:]:
            return f"after frame {before} it is at none of the course's{', interrupted' if raised else ''}"
        done = known.index(bits, before)
    try:
        os.read(sent, 1)  # it may be late: until it has been sent
        signal.pthread_sigmask(signal.SIG_UNBLOCK, INTERRUPT)
    except KeyboardInterrupt:
        caught += 1
    if caught > 1:
        return f"raised {caught} times"
    return "" if caught else "swallowed"


def _interrupted(number: int, frame: FrameType | None) -> None:
    """As Python's own handler; it says where it came."""
    if frame is not None:
        os.write(2, f"KeyboardInterrupt at {frame.f_code.co_filename}:{frame.f_lineno}\n".encode())
    raise KeyboardInterrupt


def interrupt(name: str, after: float, known: list[bytes], native: bool = False) -> tuple[str, str]:
    """One process, and one SIGINT so long (s) after its course has begun.

    Returns what is wrong ("": nothing; "swallowed": nothing was raised), and what the process said.
    """
    (ready, tell), (told, sent) = os.pipe(), os.pipe()
    with tempfile.TemporaryFile() as said:
        child = os.fork()
        if child == 0:
            os.dup2(said.fileno(), 2)
            signal.signal(signal.SIGINT, _interrupted)
            signal.alarm(PATIENCE)
            os.close(sent)
            wrong = "an error of another kind"
            try:
                wrong = _child(name, native, known, tell, told)
            except BaseException:
                traceback.print_exc()
            finally:
                os.write(2, b"\n" + wrong.encode())
                os._exit(0)
        os.close(tell)
        os.close(told)
        os.read(ready, 1)
        time.sleep(after)
        os.kill(child, signal.SIGINT)
        os.close(sent)
        os.close(ready)
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        said.seek(0)
        words, _, wrong = said.read().decode(errors="replace").rpartition("\n")
    return (f"ended with {code}" if code else wrong), words


def of_pymunk(words: str) -> bool:
    """Whether a callback, or a finalizer, of pymunk's own has swallowed it, as it does natively."""
    return "callback <function ext_" in words or "callback for ffi.gc" in words


def sweep(count: int, seed: int, native: bool = False) -> dict[str, dict[str, Any]]:
    """So many SIGINTs, course by course: how many were raised, swallowed by pymunk's own callbacks, what was wrong."""
    draw = random.Random(seed)
    told: dict[str, dict[str, Any]] = {}
    for k, name in enumerate(COURSES):
        known, seconds = undisturbed(name, native)
        here: dict[str, Any] = {"sent": 0, "raised": 0, "swallowed": 0, "wrong": []}
        for _ in range(k, count, len(COURSES)):
            wrong, words = interrupt(name, draw.uniform(0, seconds), known, native)
            here["sent"] += 1
            if not wrong:
                here["raised"] += 1
            elif wrong == "swallowed" and of_pymunk(words):
                here["swallowed"] += 1
            else:
                here["wrong"].append(f"{wrong}: {words[-800:]}")
        told[name] = here
    return told


#: A process that compiles everything, is interrupted, and attaches again.
COMPILING = """
import os, pymunk
import rigidarea as ra
from harness.interrupts import pile
os.write(1, b".")
caught = 0
for k in range(2):
    try:
        space, contact = pile(6, False)
        for _ in range(9):
            space.step(1 / 60)
        break
    except KeyboardInterrupt:
        caught += 1
print(caught, list(space.bodies)[-1].position)
"""


def compiling(after: float) -> str:
    """Interrupt a process so long (s) after it begins to compile, its cache empty: what is wrong, "" if nothing."""
    with tempfile.TemporaryDirectory() as folder:
        process = subprocess.Popen(
            [sys.executable, "-c", COMPILING],
            env=environment(NUMBA_CACHE_DIR=folder),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        assert process.stdout is not None
        process.stdout.read(1)
        time.sleep(after)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate()
    space, _ = pile(6, False)
    for _ in range(9):
        space.step(DT)
    expected = f"1 {list(space.bodies)[-1].position}"
    good = process.returncode == 0 and out.strip() == expected
    return (
        ""
        if good
        else f"after {after:.2f} s: {process.returncode} {out!r}, expected {expected!r}: {err[-800:]}"
    )
