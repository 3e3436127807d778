"""What may be done around an attached space: as natively, whatever leaves, is copied, collected, forked or ends."""

import copy
import gc
import itertools
import pickle
import subprocess
import sys
import textwrap
import weakref

import pymunk
import pytest

import rigidarea as ra
from harness import environment, lives

DT = 1 / 60


class Level(pymunk.Space):
    """A game's space, which attaches when it is made."""

    def __init__(self, *arguments) -> None:
        super().__init__(*arguments)
        self.gravity = 0, -10
        self.contact = ra.attach(self, penetration=1e-3)


class Restored(pymunk.Space):
    """One that attaches when it is restored."""

    def __setstate__(self, state) -> None:
        super().__setstate__(state)
        ra.attach(self)


def fill(space: pymunk.Space, n: int = 6) -> pymunk.Space:
    space.gravity = 0, -10
    floor = pymunk.Segment(space.static_body, (-9, 0), (9, 0), 0.1)
    floor.friction = 0.5
    space.add(floor)
    for i in range(n):
        body = pymunk.Body(1, 1 / 6)
        body.position = 0.1 * i, 0.7 + 1.02 * i
        shape = pymunk.Poly.create_box(body, (1, 1))
        shape.friction = 0.5
        space.add(body, shape)
    return space


def places(space: pymunk.Space) -> list[tuple[float, ...]]:
    return [(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in space.bodies]


def steps(space: pymunk.Space, n: int) -> list[tuple[float, ...]]:
    for _ in range(n):
        space.step(DT)
    return places(space)


COPIES = {
    "copy": lambda space: space.copy(),
    "deepcopy": copy.deepcopy,
    "pickle": lambda space: pickle.loads(pickle.dumps(space)),
    "twice": lambda space: pickle.loads(pickle.dumps(copy.deepcopy(space))),
}


@pytest.mark.parametrize("how", COPIES)
@pytest.mark.parametrize("made", [Level, Restored])
def test_a_class_that_attaches_by_itself(how, made):
    """Its copies have one contact, their original's, and go on with the same bits."""
    space = fill(made())
    if made is Restored:
        ra.attach(space, penetration=1e-3)
    steps(space, 20)
    other = COPIES[how](space)
    contact = ra.attached(other)
    assert contact.space is other and contact is not ra.attached(space) and contact.penetration == 1e-3
    assert type(other).__mro__[1] is made and type(other).__name__ == made.__name__
    if made is Level:
        assert other.contact is contact
    assert steps(other, 30) == steps(space, 30)
    contact.detach()
    assert type(other) is made and ra.attached(space) is not None
    steps(other, 5)


def test_a_copy_hears_what_its_original_hears():
    """Also of what touches still, by a hair: Chipmunk's record of that is the copy's own."""
    space, heard = fill(pymunk.Space(), 20), []

    def hear(what: str):
        return lambda arbiter, *rest: heard.append((what, *sorted(shape._hashid for shape in arbiter.shapes)))

    space.on_collision(begin=hear("begin"), separate=hear("separate"))
    ra.attach(space)
    steps(space, 20)
    copies, apart = [], set()  # not collected before the end: that is heard as well
    for _ in range(60):
        copies.append(copy.deepcopy(space))
        heard.clear()
        steps(space, 2)
        expected, before = sorted(heard), apart.copy()
        for what, *pair in heard:
            (apart.add if what == "separate" else apart.discard)(("separate", *pair))
        heard.clear()
        steps(copies[-1], 2)
        assert places(copies[-1]) == places(space)
        assert sorted(set(heard) - before) == expected  # pymunk's copies hear once more what has separated


def test_a_copy_of_what_was_detached_attaches_as_its_class_does():
    space = fill(Level())
    space.contact.detach()
    other = space.copy()
    assert ra.attached(other) is not None
    steps(other, 10)


def falls_as_natively(space: pymunk.Space, body: pymunk.Body) -> bool:
    twin = pymunk.Body(body.mass, body.moment)
    twin.position, twin.velocity = body.position, body.velocity
    native = pymunk.Space()
    native.gravity, space.gravity = (0, -10), (0, -10)
    native.add(twin)
    if ra.attached(space) is not None:
        ra.attach(native)
    for one in (space, native):
        for _ in range(10):
            one.step(DT)
    return body.position == pytest.approx(twin.position, abs=1e-9) and body.velocity.y < 0


LEAVES = ["removed", "space detached", "removed, then detached", "space collected", "attached elsewhere"]


@pytest.mark.parametrize("how", LEAVES)
@pytest.mark.parametrize("shapes", [True, False])
def test_a_body_moves_in_its_next_space(how, shapes):
    space = fill(pymunk.Space(), 2)
    body = pymunk.Body(1, 1)
    body.position = 30, 40
    space.add(body, *([pymunk.Circle(body, 0.4)] if shapes else []))
    contact = ra.attach(space)
    steps(space, 3)
    if how == "space detached":
        contact.detach()
    if how != "space collected":
        space.remove(body, *body.shapes)
    if how == "removed, then detached":
        contact.detach()
    following = pymunk.Space()
    if how == "space collected":
        gone = weakref.ref(space)
        del space, contact
        gc.collect()
        assert gone() is None
    if how == "attached elsewhere":
        ra.attach(following)
    following.add(body)
    assert falls_as_natively(following, body)


@pytest.mark.parametrize("removed", [0, 1, 2])
def test_a_body_that_comes_when_another_goes_moves_once(removed):
    """Chipmunk puts the last in the place of one that goes: it is moved before, or after, the frame begins for us."""
    space = pymunk.Space()
    bodies = [pymunk.Body(1, 1) for _ in range(4)]
    for i, body in enumerate(bodies):
        body.position, body.velocity = (50 * i, 0), (1, 0)
    first, last = bodies[:3], bodies[3]
    space.add(*first, *(pymunk.Circle(body, 0.3) for body in first))
    ra.attach(space)
    space.step(0.1)
    space.add(last, pymunk.Circle(last, 0.3))
    space.remove(first[removed], *first[removed].shapes)
    space.step(0.1)
    assert last.position.x == pytest.approx(150.1, abs=1e-12)  # 1/10 of 1, rounded
    space.step(0.1)
    assert last.position.x == pytest.approx(150.2, abs=1e-12)


def test_rows_of_what_left_are_cleared_at_once():
    """Bodies without shapes too: their memory is another's as soon as nobody holds them."""
    space = fill(pymunk.Space(), 3)
    contact = ra.attach(space)
    bare = [pymunk.Body(1, 1) for _ in range(5)]
    hinge = pymunk.PivotJoint(bare[0], bare[1], (0, 0), (0, 0))
    space.add(*bare, hinge)
    steps(space, 3)
    addresses = [int(pymunk._chipmunk_cffi.ffi.cast("uintptr_t", b._body)) for b in bare]
    assert set(addresses) <= set(contact._store.tables.bodies["address"].tolist())
    space.remove(hinge, *bare)
    assert not set(addresses) & set(contact._store.tables.bodies["address"].tolist())
    dead = [weakref.ref(b) for b in bare]
    del bare, hinge
    steps(space, 1)
    gc.collect()
    assert all(one() is None for one in dead)
    steps(space, 5)


def test_one_shape_of_a_body_is_removed_and_the_body_reindexed():
    """A removed shape's number is 0, which is the first shape's."""
    space = fill(pymunk.Space(), 3)
    body = list(space.bodies)[1]
    extra = pymunk.Circle(body, 0.3, (0, 0.6))
    space.add(extra)
    ra.attach(space)
    steps(space, 5)
    space.remove(extra)
    extra.unsafe_set_radius(0.1)
    space.reindex_shapes_for_body(body)
    steps(space, 5)


def test_a_body_that_is_collected_while_its_shape_stays():
    """pymunk's shapes do not keep their bodies alive: such a shape is no contact's."""
    space = fill(pymunk.Space(), 3)
    contact = ra.attach(space)
    body = pymunk.Body(1, 1)
    body.position = 0, 8
    shape = pymunk.Circle(body, 0.5)
    space.add(body, shape)
    steps(space, 3)
    space.remove(body)
    del body
    gc.collect()
    steps(space, 30)
    contact.energy()
    space.reindex_static()


@pytest.fixture(autouse=True, scope="module")
def _compiled() -> None:
    """What the programs call is compiled before: one that compiles says so, and takes its time."""
    space = fill(pymunk.Space())
    contact = ra.attach(space)
    steps(space, 3)
    contact.energy()
    len(contact.regions)


def run(program: str, seconds: float = 60, **variables: str) -> subprocess.CompletedProcess:
    """A program of its own."""
    text = "import pymunk, rigidarea as ra, sys, os\nfrom tests.test_ownership import *\n" + textwrap.dedent(
        program
    )
    return subprocess.run(
        [sys.executable, "-c", text],
        capture_output=True,
        text=True,
        timeout=seconds,
        env=environment(**variables),
    )


PROGRAMS = {
    "a daemon thread steps": """
        import threading, time
        space = fill(pymunk.Space(), 40)
        ra.attach(space)
        space.step(DT)
        def go():
            while True:
                space.step(DT)
        threading.Thread(target=go, daemon=True).start()
        time.sleep(0.05)
    """,
    "a thread steps, then ends": """
        import threading
        space = fill(pymunk.Space(), 10)
        ra.attach(space)
        threads = [threading.Thread(target=steps, args=(space, 20)) for _ in range(3)]
        for thread in threads:
            thread.start(); thread.join()
    """,
    "attached spaces live until the end": """
        spaces = [Level() for _ in range(20)]
        for space in spaces: steps(fill(space), 3)
        keep = [space.contact for space in spaces[:5]]
    """,
    "spaces with a separate callback live until the end": """
        spaces = [fill(Level()) for _ in range(3)]
        for space in spaces:
            space.on_collision(separate=lambda *arguments: None)
            steps(space, 5)
            space.me = space
    """,
    "forked": """
        space = fill(Level())
        steps(space, 5)
        for _ in range(5):
            child = os.fork()
            if child == 0:
                steps(space, 20)
                sys.exit(7)
            assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7
        other = space.copy()
        assert steps(space, 10) == steps(other, 10)
    """,
    "forked while a thread is within a step": """
        import threading, time
        space = fill(pymunk.Space(), 3)
        ra.attach(space)
        steps(space, 20)  # the first has landed
        inside = threading.Event()
        def wait(*arguments):
            inside.set()
            time.sleep(1)
        space.on_collision(pre_solve=wait)
        thread = threading.Thread(target=steps, args=(space, 1), daemon=True)
        thread.start()
        inside.wait()
        child = os.fork()
        if child:
            assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
            os._exit(0)
    """,
    "a heap explodes": """
        from tests.exploding import dearest
        dearest(4)
    """,
    "a body goes in a step, and the next cannot be entered": """
        class Changing(pymunk.Space):
            def step(self, dt):
                body = next(iter(self.bodies))
                self.remove(body, *body.shapes)
                del body
                gc.collect()
                body = pymunk.Body(1, 1)
                body.position = 0, 20
                self.add(body, pymunk.Circle(body, 0.3))
                super().step(dt)
        def none(*arguments): raise MemoryError
        space = fill(Changing())
        ra.attach(space)
        steps(space, 3)
        register = sys.modules["rigidarea.chipmunk.register"].Register
        before = {body: (*body.position, body.angle, *body.velocity, *body.force) for body in space.bodies}
        enter, register._enter = register._enter, none
        try:
            space.step(DT)
            raise AssertionError
        except MemoryError:
            register._enter = enter
        assert all(before.get(b, (0, 20, 0, 0, 0, 0, 0)) == (*b.position, b.angle, *b.velocity, *b.force)
            for b in space.bodies)
        steps(space, 3)
    """,
    "no memory for what a callback has added": """
        def add(arbiter, space, data):
            body = pymunk.Body(body_type=pymunk.Body.STATIC)
            space.add(body, pymunk.Circle(body, 0.3))
        def none(*arguments): raise MemoryError
        space = fill(pymunk.Space())
        ra.attach(space)
        space.on_collision(post_solve=add)
        while not space.shapes or len(space.bodies) < 10: space.step(DT)
        register = sys.modules["rigidarea.chipmunk.register"].Register
        ra.attached(space).energy()  # all is entered
        enter, register._enter = register._enter, none
        try:
            steps(space, 3)
            raise AssertionError
        except MemoryError:
            register._enter = enter
        space.on_collision(post_solve=None)
        steps(space, 3)  # pymunk's list of what is to be added is empty again
        assert {s._hashid for s in space.shapes} == set(ra.attached(space)._register.shapes)
    """,
    "static shapes come and go without a step": """
        space = fill(pymunk.Space(), 2)
        contact = ra.attach(space)
        for _ in range(1000):
            shape = pymunk.Segment(space.static_body, (0, -5), (1, -5), 0.1)
            space.add(shape)
            space.remove(shape)
        counters = contact._store.tables.counters
        tables = sys.modules["rigidarea.contact.tables"]
        assert counters[tables.ASKED] <= counters[tables.SHAPES], counters
        steps(space, 3)
    """,
    "interrupts while machine code is loaded": """
        import signal
        from llvmlite.binding import ffi
        add, count = ffi.lib.LLVMPY_AddModule, 0
        def adding(*arguments):
            global count
            add(*arguments)  # LLVM has it, and llvmlite is yet to note that
            count += 1
            if count & count - 1 == 0: signal.raise_signal(signal.SIGINT)
        ffi.lib._fntab["LLVMPY_AddModule"] = adding
        caught, space = 0, fill(pymunk.Space(), 5)
        while True:
            try:
                ra.attached(space) or ra.attach(space)
                space.step(DT)
                break
            except KeyboardInterrupt:
                caught += 1
        fill(space, 40)
        while True:
            try:
                steps(space, 5)
                ra.attached(space).energy()
                break
            except KeyboardInterrupt:
                caught += 1
        assert 4 <= caught <= count.bit_length(), (caught, count)  # two of one time are one
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    """,
    "sys.exit in a step": """
        space = fill(Level())
        class Ends(pymunk.Space):
            def step(self, dt): super().step(dt); sys.exit(0)
        space = fill(Ends()); ra.attach(space)
        space.step(DT)
    """,
}


SELDOM = ("a thread steps, then ends", "sys.exit in a step")


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[pytest.mark.slow] if n in SELDOM else []) for n in PROGRAMS]
)
def test_programs_end_as_natively(name):
    if "machine code is loaded" in name and ra.backend() != "compiled":
        pytest.skip("LLVM loads nothing")
    done = run(PROGRAMS[name])
    assert (done.returncode, done.stderr) == (0, ""), done.stderr[-800:]


def command(*words: str, seconds: float) -> None:
    """It ends well."""
    done = subprocess.run(
        [sys.executable, *words], env=environment(), capture_output=True, text=True, timeout=seconds
    )
    assert done.returncode == 0, done.stdout[-800:] + done.stderr[-3000:]


def test_pymunk_itself_cannot_be_interrupted_while_it_frees_a_space():
    """Why `compat lives` counts that as native (`lives.of_pymunk`)."""
    done = run(
        """
        space = fill(pymunk.Space(), 3)
        shapes = list(space.shapes)
        def interrupt(frame, event, argument):
            if frame.f_code.co_name == "ext_cpSpaceShapeIteratorFunc":
                sys.settrace(None)
                raise KeyboardInterrupt
        sys.settrace(interrupt)
        del space
        gc.collect()
        sys.settrace(None)
        del shapes
        gc.collect()
    """,
        MALLOC_PERTURB_="165",
    )  # what is freed is overwritten: it is seen at once
    assert done.returncode < 0 and lives.of_pymunk(done.stderr), done.stderr[-800:]


def test_pymunk_itself_cannot_be_interrupted_while_it_adds_what_a_callback_gave_it():
    """The other one that `lives.of_pymunk` knows."""
    done = run(
        """
        space = fill(pymunk.Space(), 3)
        def add(arbiter, space, data):
            body = pymunk.Body(1, 1)
            space.add(body, pymunk.Circle(body, 0.3))
        def interrupt(frame, event, argument):
            if frame.f_code.co_name == "_add_shape":
                sys.settrace(None)
                raise KeyboardInterrupt
        space.on_collision(post_solve=add)
        sys.settrace(interrupt)
        try:
            steps(space, 60)
            raise LookupError
        except KeyboardInterrupt:
            space.on_collision(post_solve=None)
        steps(space, 2)
    """
    )
    assert done.returncode == 1 and lives.of_pymunk(done.stderr), done.stderr[-800:]


@pytest.mark.parametrize("programs", [6, pytest.param(200, marks=pytest.mark.slow)])
def test_random_programs(programs):
    """Lifetimes, copies, callbacks, signals, growth, threads, forks: no crash, no hang, whole tables."""
    program = "import sys, harness, rigidarea.__main__ as m; sys.exit(m.main(sys.argv[1:]))"
    words = ("-c", program, "compat", "lives", "--programs", str(programs), "--json", "-")
    command(*words, seconds=100 * programs)


def test_no_interrupt_is_lost_where_tables_are_published():
    """Wherever it comes while the addresses are asked for. numpy describes a structured array in Python for
    `__array_interface__`, and drops what is raised there.
    """
    contact = ra.attach(fill(pymunk.Space(), 2))
    left = 0

    def interrupted(frame, event, argument):
        nonlocal left
        left -= 1
        if left == 0:
            raise KeyboardInterrupt
        return interrupted

    for n in itertools.count(1):
        contact._store._listed = [None] * len(contact._store._listed)  # as if all tables had grown
        left = n
        sys.settrace(interrupted)
        try:
            contact._store.sync()
            break
        except KeyboardInterrupt:
            assert left == 0
        finally:
            sys.settrace(None)
    assert left > 0, "an interrupt was lost"
    assert n > len(contact._store._listed)  # it came at every line


@pytest.mark.slow
def test_indices_and_addresses():
    """Every index checked, every table between closed pages; planted errors are seen first."""
    command("tests/bounds.py", "--scenes", "200", seconds=3000)
