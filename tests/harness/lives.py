"""Random programs of lifetimes, copies, callbacks, signals, growth, threads and forks, each a process.

A program draws what it does from its seed: spaces are made, attached, filled, stepped, copied, detached and dropped,
bodies move between them, callbacks meddle, interrupts and memory errors come when they come. It ends by itself; what
counts as wrong is a crash, a hang, an error that is none of ours to raise, and tables that are not one set after one:
where the same program without area contact ends well.
"""

from __future__ import annotations

import copy
import faulthandler
import gc
import math
import os
import pickle
import random
import signal
import sys
import tempfile
import threading
import time
import traceback
from collections.abc import Callable
from typing import Any

import numpy as np
import pymunk

from rigidarea import AreaContact, SimulationError, attach, attached
from rigidarea.chipmunk import arrays
from rigidarea.chipmunk.structs import address_of
from rigidarea.contact import tables

DT = 1 / 60
#: A program that takes longer hangs: processor time, and time, which others may take (s).
LONGEST, PATIENCE = 10, 60
#: Operations of a program.
OPERATIONS = 25


_native = False  # this process runs a program without area contact


def _attach(space: pymunk.Space) -> AreaContact | None:
    return None if _native else attached(space) or attach(space)


class Level(pymunk.Space):
    """A game's space, which attaches when it is made."""

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        self.contact = _attach(self)


class Restored(pymunk.Space):
    """One that attaches when it is restored."""

    def __setstate__(self, state: Any) -> None:
        super().__setstate__(state)
        _attach(self)


class Adding(pymunk.Space):
    """One that adds a body in its own step, and steps twice."""

    def step(self, dt: float) -> None:
        """Two halves, something new in each."""
        for _ in range(2):
            if len(self.bodies) < 30:
                add_body(self, random.Random(len(self.bodies)), 1)
            super().step(dt / 2)


def whole(contact: AreaContact) -> None:
    """AssertionError unless the contact's tables are one set, and their addresses those of bodies of the space."""
    store, state = contact._store, contact._store.state[0]
    for name, array in {**store.tables._asdict(), **store._kept, "slots": store.slots}.items():
        found = int(state[f"{name}_at"]), int(state[f"{name}_n"])
        assert found == (array.ctypes.data, len(array)), f"{name}: {found}"
    t = store.tables
    free = ((t.pairs, tables.FREE_PAIR), (t.regions, tables.FREE_REGION))
    for rows, head in free:
        count, r = 0, int(t.counters[head])
        while r >= 0 and count <= len(rows):  # no more: it would go round
            count, r = count + 1, int(rows[r]["next"])
        assert count == t.counters[head + 1], f"free rows: {count}, {t.counters[head + 1]}"
    used = set(t.bodies["address"].tolist()) - {0}
    space = contact.space
    held = {
        *space.bodies,
        *(shape.body for shape in space.shapes if shape.body is not None),
        space.static_body,
    }
    held |= {body for joint in space.constraints for body in (joint.a, joint.b)}
    assert used <= {address_of(body._body) for body in held}, "addresses of bodies that are not held"


def add_body(space: pymunk.Space, draw: random.Random, n: int) -> None:
    """n bodies somewhere, most with a shape or two."""
    for _ in range(n):
        body = pymunk.Body(draw.choice([1, 0.1, 20]), draw.choice([1, 0.1, 1e-3]))
        if draw.random() < 0.1:
            body = pymunk.Body(body_type=draw.choice([pymunk.Body.KINEMATIC, pymunk.Body.STATIC]))
        body.position = draw.uniform(-4, 4), draw.uniform(0.5, 8)
        shapes: list[pymunk.Shape] = []
        if draw.random() < 0.85:
            shapes.append(pymunk.Poly.create_box(body, (draw.uniform(0.3, 1), 0.5)))
        if draw.random() < 0.3:
            shapes.append(pymunk.Circle(body, 0.3, (0.2, 0)))
        for shape in shapes:
            shape.friction, shape.elasticity = 0.5, draw.choice([0, 0.5])
            shape.collision_type = draw.randrange(3)
        space.add(body, *shapes)


def slowly(body: pymunk.Body, dt: float) -> None:
    """A position function of a user's."""
    pymunk.Body.update_position(body, dt / 2)


class Program:
    """One program: `go` runs it."""

    def __init__(self, seed: int) -> None:
        self.draw = random.Random(seed)
        self.spaces: list[pymunk.Space] = []
        self.kept: list[Any] = []  # contacts and bodies that outlive their spaces
        self.threads: list[threading.Thread] = []

    def space(self) -> pymunk.Space:
        """One of the spaces, made if there is none."""
        if not self.spaces:
            self.make()
        return self.draw.choice(self.spaces)

    def make(self) -> None:
        """A new space with a floor."""
        kind: Any = self.draw.choice([pymunk.Space, pymunk.Space, Level, Restored, Adding])
        space = kind()
        space.gravity = 0, -10
        space.sleep_time_threshold = self.draw.choice([math.inf, 0.2])
        if self.draw.random() < 0.8:
            space.add(pymunk.Segment(space.static_body, (-9, 0), (9, 0), self.draw.choice([0, 0.1])))
        if kind is not Level and self.draw.random() < 0.8:
            _attach(space)
        add_body(space, self.draw, self.draw.choice([0, 3, 10, 60]))
        self.spaces = [*self.spaces[-3:], space]

    def step(self) -> None:
        """A few frames."""
        space = self.space()
        contact = attached(space)
        if contact is not None and self.draw.random() < 0.3:
            fine = (
                {"tolerance": 1e-2} if len(space.bodies) < 6 else {"steps": 8}
            )  # up to 1,024 substeps a frame
            how: dict[str, Any] = self.draw.choice([{}, {"steps": 3}, fine])
            contact.step(DT, self.draw.randrange(1, 20), **how)
        for _ in range(self.draw.randrange(1, 12)):
            space.step(DT)

    def add(self) -> None:
        """Bodies come: a few, or so many that tables grow."""
        add_body(self.space(), self.draw, self.draw.choice([1, 2, 40]))

    def joint(self) -> None:
        """Two bodies are joined."""
        space = self.space()
        bodies = [b for b in space.bodies if b.body_type == pymunk.Body.DYNAMIC]
        if len(bodies) > 1:
            a, b = self.draw.sample(bodies, 2)
            joint = self.draw.choice(
                [pymunk.PivotJoint(a, b, a.position), pymunk.DampedSpring(a, b, (0, 0), (0, 0), 1, 9, 1)]
            )
            joint.collide_bodies = self.draw.random() < 0.5
            space.add(joint)

    def remove(self) -> None:
        """Something goes: a body with all that is its own (Chipmunk wants that), only a shape, only a joint."""
        space = self.space()
        things: list[Any] = [*space.bodies, *space.shapes, *space.constraints]
        if not things:
            return
        thing = self.draw.choice(things)
        if isinstance(thing, pymunk.Body):
            joints = [joint for joint in thing.constraints if joint in space.constraints]
            own = [shape for shape in thing.shapes if shape.space is space]
            space.remove(*joints, thing, *own)
            self.kept.append(thing)
        else:
            space.remove(thing)
            if isinstance(thing, pymunk.Shape) and thing.body is not None and thing.body.space is space:
                space.reindex_shapes_for_body(thing.body)

    def move(self) -> None:
        """A body that left one space comes to another."""
        space = self.space()
        for body in [b for b in self.kept if isinstance(b, pymunk.Body) and b.space is None][:2]:
            if body in space.bodies:
                continue  # pymunk's own `add` was interrupted half-way
            space.add(body)  # its shapes may have lost it: pymunk frees a space so

    def copies(self) -> None:
        """A copy, one way or another, which goes on."""
        space = self.space()
        if any(shape.body is None or shape.body.space is not space for shape in space.shapes):
            return  # no space of pymunk's can be copied then
        ways: list[Callable[[Any], Any]] = [copy.deepcopy, lambda s: s.copy()]
        if not space._handlers:  # a callback that is nobody's global cannot be pickled
            ways.append(lambda s: pickle.loads(pickle.dumps(s)))
        way = self.draw.choice(ways)
        try:
            made = way(space)
        except KeyboardInterrupt:
            if attached(space) is None:  # else it may be ours
                print(TORN, file=sys.stderr, flush=True)
            raise
        self.spaces = [*self.spaces[-3:], made]

    def detach(self) -> None:
        """A space is detached, or attached."""
        space = self.space()
        contact = attached(space)
        if contact is None:
            _attach(space)
        else:
            contact.detach()

    def drop(self) -> None:
        """A space goes; a contact or some bodies of it may stay."""
        space = self.space()
        self.spaces.remove(space)
        self.kept += self.draw.choice([[], [attached(space)], list(space.bodies)[:3]])
        del space
        gc.collect()

    def callbacks(self) -> None:
        """Callbacks that meddle: add, remove, detach, raise, copy."""
        space, draw = self.space(), self.draw
        what = draw.choice(["add", "remove", "detach", "raise", "copy", "no"])

        def called(arbiter: Any, space: Any, data: Any) -> None:
            if what == "add" and len(space.bodies) < 80:
                add_body(space, draw, 1)
            elif what == "remove" and len(space.bodies) > 2:
                body = next(iter(space.bodies))
                if not body.constraints:
                    space.remove(body, *(shape for shape in body.shapes if shape.space is space))
            elif what == "detach" and attached(space) is not None:
                try:
                    attached(space).detach()  # type: ignore[union-attr]
                except RuntimeError:
                    pass
            elif what == "raise":
                raise LookupError("a callback's own")
            elif what == "copy":
                attached(space)
            elif what == "no":
                arbiter.process_collision = False

        kind: Any = draw.choice([(None, None), (0, None), (0, 1)])
        phase: Any = draw.choice(["begin", "pre_solve", "post_solve", "separate"])
        handlers: dict[str, Any] = {phase: called}
        space.on_collision(*kind, **handlers)

    def functions(self) -> None:
        """A body with functions of the user's."""
        for body in list(self.space().bodies)[:2]:
            if self.draw.random() < 0.5:
                body.velocity_func = pymunk.Body.update_velocity
            else:
                body.position_func = slowly

    def forks(self) -> None:
        """A child goes on with everything, and ends."""
        child = os.fork()
        if child == 0:
            _limit()
            try:
                self.step()
            except (KeyboardInterrupt, MemoryError, SimulationError):
                pass
            except BaseException:
                traceback.print_exc()
                os._exit(1)
            os._exit(0)
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        assert code == 0, f"the child ended with {code}"

    def threaded(self) -> None:
        """A thread steps a space of its own, while this one goes on; waited for, or left to the end."""
        space = pymunk.Space()
        space.gravity = 0, -10
        _attach(space)
        add_body(space, self.draw, 20)
        n, daemon = self.draw.choice([(20, False), (3000, True)])

        def go() -> None:
            for _ in range(n):
                space.step(DT)

        thread = threading.Thread(target=go, daemon=daemon)
        thread.start()
        if not daemon:
            self.threads.append(thread)

    def interrupted(self) -> None:
        """SIGINT comes at some time in the next operations."""
        delay = 10 ** self.draw.uniform(-5, -1.5)
        timer = threading.Timer(delay, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        until = time.monotonic() + delay + 0.01
        while time.monotonic() < until:
            self.draw.choice([self.step, self.add, self.step, self.copies])()
        timer.join()

    def out_of_memory(self) -> None:
        """A table cannot grow, once."""
        left, zeros = self.draw.randrange(1, 8), np.zeros

        def failing(*arguments: Any, **named: Any) -> Any:
            nonlocal left
            left -= 1
            if left == 0:
                raise MemoryError("none left")
            return zeros(*arguments, **named)

        arrays.np = type(
            "np", (), {"__getattr__": lambda _, name: failing if name == "zeros" else getattr(np, name)}
        )()
        try:
            self.add()
            self.step()
        finally:
            arrays.np = np

    def go(self) -> None:
        """Run it."""
        operations = [self.make, self.add, self.joint, self.remove, self.remove, self.move, self.copies]
        operations += [self.detach, self.drop, self.callbacks, self.functions, self.forks, self.threaded]
        operations += [self.interrupted, self.out_of_memory, *[self.step] * 6]
        for _ in range(OPERATIONS):
            try:
                self.draw.choice(operations)()
            except (KeyboardInterrupt, MemoryError, SimulationError):
                pass
            for thread in [t for t in threading.enumerate() if isinstance(t, threading.Timer)]:
                try:
                    thread.join()  # its interrupt may be late
                    time.sleep(1e-3)
                except KeyboardInterrupt:
                    pass
            for space in self.spaces:
                contact = attached(space)
                if contact is not None:
                    contact.energy()
                    whole(contact)


def warm() -> None:
    """Load, or compile, what programs run: each is a child of this process, with too little time to compile in it."""
    space = Level()
    space.add(pymunk.Segment(space.static_body, (-9, 0), (9, 0), 0.1))
    add_body(space, random.Random(0), 10)
    a, b = list(space.bodies)[:2]
    space.add(pymunk.PivotJoint(a, b, a.position), pymunk.DampedSpring(a, b, (0, 0), (0, 0), 1, 9, 1))
    contact = space.contact
    assert contact is not None
    contact.step(DT, 120)
    contact.step(DT, tolerance=1e-2)
    space.remove(a, *a.constraints, *a.shapes)
    contact.energy()
    pickle.loads(pickle.dumps(space)).step(DT)
    contact.detach()
    gc.collect()
    gc.freeze()  # what is there already is not looked through at the end of each of them: a quarter of their time


def _limit() -> None:
    """This process ends, and says where it was, if it takes too long: no limit goes on in a child."""
    faulthandler.enable()
    faulthandler.register(signal.SIGALRM, chain=True)  # no thread of its own, which a fork would lose
    signal.alarm(PATIENCE)
    signal.setitimer(signal.ITIMER_PROF, LONGEST)


#: Said where an interrupt has come while pymunk copied a space that is not attached.
TORN = "a copy was interrupted"


def of_pymunk(text: str) -> bool:
    """Whether an interrupt came within pymunk's own: at random times it does not come there again in a native run.

    While it frees a space: shapes and joints point into freed memory from then on. While it adds what callbacks have
    given it: it will add the same again after each step. While it copies a space that is
    not attached: it frees the half-made one and takes its bodies out of it afterwards, a write into freed memory that
    ends the program at some later time (valgrind shows it without area contact).
    """
    freeing = "cffi callback <function ext_cpSpace" in text and "IteratorFunc" in text
    torn = TORN in text and " ended with -" in text
    return freeing or torn or ("self.add(*self._add_later)" in text and "already added to" in text)


def run(seed: int, native: bool = False) -> str:
    """Run the program of that seed in a child of this process: what was wrong, "" if nothing.

    native: without area contact.
    """
    global _native
    with tempfile.TemporaryFile() as said:
        child = os.fork()
        if child == 0:
            os.dup2(said.fileno(), 2)
            os.dup2(said.fileno(), 1)
            sys.stdout, sys.stderr = sys.__stdout__, sys.__stderr__  # no locks of a thread that is not here
            _limit()
            code, _native = 1, native
            try:
                program = Program(seed)
                program.go()
                for thread in program.threads:
                    thread.join()
                code = 0
            except BaseException:
                traceback.print_exc()
            if code:
                os._exit(code)
            raise SystemExit(0)  # the interpreter's own end, with all that is alive
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        said.seek(0)
        text = said.read().decode(errors="replace")
    return "" if code == 0 else f"seed {seed} ended with {code}: {text[:700]} ... {text[-2500:]}"
