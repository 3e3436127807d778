"""Tables that grow: nothing of it is seen, and what is raised on the way leaves everything as it was."""

import itertools
import subprocess
import sys

import numpy as np
import pymunk
import pytest

import rigidarea as ra
from rigidarea.chipmunk import area_contact, arrays, asked, outline_pool, register
from rigidarea.contact import tables

DT = 1 / 60


def crowd(n: int, seed: int = 0, hinges: int = 2) -> pymunk.Space:
    """n bodies of several shapes on a floor, some of them in joints: they come to touch one after the other."""
    rng = np.random.default_rng(seed)
    space = pymunk.Space()
    space.gravity = 0, -10
    floor = pymunk.Segment(space.static_body, (-40, 0), (40, 0), 0.1)
    floor.friction = 0.5
    space.add(floor)
    for i in range(n):
        body = pymunk.Body(1, 0.2)
        body.position = 1.05 * (i % 8) + rng.uniform(0, 0.1), 0.7 + 1.02 * (i // 8)
        shape = pymunk.Circle(body, 0.5) if i % 3 == 0 else pymunk.Poly.create_box(body, (1, 1))
        shape.friction, shape.elasticity = 0.5, 0.3
        space.add(body, shape)
    bodies = list(space.bodies)
    for k in range(hinges):
        a, b = bodies[2 * k : 2 * k + 2]
        space.add(pymunk.PivotJoint(a, b, (a.position + b.position) / 2))
    return space


def place_of(space: pymunk.Space) -> np.ndarray:
    """All that a frame may change of bodies and joints."""
    bodies = [
        (*b.position, b.angle, *b.velocity, b.angular_velocity, *b.force, b.torque) for b in space.bodies
    ]
    return np.array([*itertools.chain(*bodies), *(joint.impulse for joint in space.constraints)])


@pytest.mark.parametrize("seed", range(3))
def test_growth_is_not_seen(seed):
    """The same bits as with tables that are large from the start."""
    runs = []
    for large in (False, True):
        space = crowd(80, seed)
        contact = ra.attach(space)
        if large:
            contact._store.grow_pairs(4096)
            contact._store.grow_regions(4096)
            contact._store.sync()
        before = len(contact._store.tables.pairs)
        trace = []
        for _ in range(60):
            space.step(DT)
            trace.append(place_of(space))
        assert (len(contact._store.tables.pairs) > before) is not large
        runs.append(np.array(trace))
    assert (runs[0] == runs[1]).all()


class Raise:
    """Raises once, at the k-th line that Python runs for machine code."""

    FILES = tuple(module.__file__ for module in (area_contact, asked, arrays, outline_pool, register))

    def __init__(self, k: int, error: type[BaseException]) -> None:
        self.left, self.error, self.inside = k, error, False

    def __call__(self, frame, event, argument):
        code = frame.f_code
        if code.co_filename not in self.FILES:
            return None
        if code.co_filename == self.FILES[0] and code.co_name == "<lambda>":
            self.inside = event != "return"
        if self.inside and event in ("call", "line"):
            self.left -= 1
            if self.left == 0:
                raise self.error(f"at {code.co_name}, line {frame.f_lineno}")
        return self


def whole(contact: ra.AreaContact) -> None:
    """The tables are one set: every address and length in the record is that of an array that is alive."""
    store, state = contact._store, contact._store.state[0]
    for name, array in {**store.tables._asdict(), **store._kept, "slots": store.slots}.items():
        assert (int(state[f"{name}_at"]), int(state[f"{name}_n"])) == (array.ctypes.data, len(array)), name
    t = store.tables
    for rows, head, free in (
        (t.pairs, tables.FREE_PAIR, tables.FREE_PAIRS),
        (t.regions, tables.FREE_REGION, tables.FREE_REGIONS),
    ):
        count, r = 0, int(t.counters[head])
        while r >= 0:
            count, r = count + 1, int(rows[r]["next"])
        assert count == t.counters[free]


def first_growth(make) -> int:
    """The frame in which Python is asked for the first time after the first."""
    space = make()
    contact = ra.attach(space)
    space.step(DT)
    sizes = len(contact._store.tables.pairs), len(contact._store.tables.regions)
    for frame in range(1, 100):
        space.step(DT)
        if (len(contact._store.tables.pairs), len(contact._store.tables.regions)) != sizes:
            return frame
    raise AssertionError("nothing has grown")


@pytest.mark.parametrize(
    ("error", "every"),
    [
        (KeyboardInterrupt, 31),
        *(pytest.param(e, 1, marks=pytest.mark.slow) for e in (KeyboardInterrupt, MemoryError)),
    ],
)
def test_what_is_raised_while_tables_grow(error, every):
    """At each line: raised once, after the step; bodies, joints and tables as before it; then the same bits go on."""

    def make():
        space = crowd(80)
        for i, body in enumerate(
            space.bodies
        ):  # row by row from on high: near one another only once they fall
            body.position += 0, 0.8 * (i // 8)
        return space

    grows = first_growth(make)
    undisturbed = make()
    ra.attach(undisturbed)
    for _ in range(grows + 12):
        undisturbed.step(DT)
    k = 1
    while True:
        space = make()
        contact = ra.attach(space)
        for _ in range(grows):
            space.step(DT)
        before = place_of(space)
        injected = Raise(k, error)
        sys.settrace(injected)
        try:
            space.step(DT)
        except error as raised:
            sys.settrace(None)
            assert "line" in str(raised)
            assert (place_of(space) == before).all(), raised
            whole(contact)
            space.step(DT)
        finally:
            sys.settrace(None)
        whole(contact)
        for _ in range(11):
            space.step(DT)
        assert (place_of(space) == place_of(undisturbed)).all(), k
        if injected.left > 0:
            break
        k += every
    assert k > 60


LOADS_NOTHING = """
import pymunk, rigidarea as ra
from rigidarea.compile.cache import CheckedFile

space = pymunk.Space()
space.gravity = 0, -900
space.add(pymunk.Segment(space.static_body, (-500, 0), (500, 0), 5))
ra.attach(space)
space.step(1 / 60)
CheckedFile._content = lambda self, path: 1 / 0
for i in range(400):
    body = pymunk.Body(1, 100)
    body.position = 20 * (i % 40) - 400, 15 + 20 * (i // 40)
    space.add(body, pymunk.Poly.create_box(body, (20, 20)))
for i in range(60):
    space.step(1 / 60)
"""


@pytest.mark.skipif(ra.backend() != "compiled", reason="only what is compiled here is loaded one by one")
def test_growth_loads_nothing():
    """Whatever a frame asks for is loaded with the first space: none waits for the disk."""
    subprocess.run([sys.executable, "-c", LOADS_NOTHING], check=True)
