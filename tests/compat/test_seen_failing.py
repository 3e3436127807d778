"""What was seen failing before existing games ran unchanged: each as it was seen, in the order of that list."""

import copy
import math
import os
import pickle
import signal
import subprocess
import sys
import time
import tomllib
from pathlib import Path

import numpy as np
import pymunk
import pytest

import rigidarea as ra
from harness.suite import MODES, REASONS, run_suite

ROOT = Path(__file__).parents[2]
DT = 1 / 60
COPIES = {
    "copy": pymunk.Space.copy,
    "deepcopy": copy.deepcopy,
    "pickle": lambda s: pickle.loads(pickle.dumps(s)),
}


@pytest.mark.parametrize("ends", [((100, 250), (500, 250)), ((500, 250), (100, 250))])
def test_a_segment_without_radius_holds_from_both_sides(ends):
    for start, gravity, up in ((500, -900, 1), (0, 900, -1)):
        space = pymunk.Space()
        space.gravity = 0, gravity
        space.add(pymunk.Segment(space.static_body, *ends, 0))
        body = pymunk.Body(1, 100)
        body.position = 300, start
        space.add(body, pymunk.Circle(body, 20))
        ra.attach(space)
        for _ in range(240):
            space.step(DT)
        # it comes down at 640 a second without restitution and is let out of the floor slowly
        assert up * (body.position.y - 250) == pytest.approx(20, abs=1)


def off_centre():
    space = pymunk.Space()
    body = ra.Outline([(0, 0), (60, 0), (60, 20), (20, 20), (20, 60), (0, 60)]).body(mass=1)
    assert body.center_of_gravity.length > 10
    body.position, body.angle = (100, 50), 0.7
    space.add(body)
    ra.attach(space)
    return space


@pytest.mark.parametrize("how", COPIES)
@pytest.mark.parametrize("before", [0, 3])
def test_a_body_off_its_centre_of_gravity_stays_in_a_copys_first_step(how, before):
    space = off_centre()
    for _ in range(before):
        space.step(DT)
    twin = COPIES[how](space)
    twin.step(DT)
    (own,), (body,) = space.bodies, twin.bodies
    assert body.position == pytest.approx(own.position, abs=1e-12) and body.angle == own.angle == 0.7


@pytest.mark.parametrize("how", COPIES)
def test_a_copy_made_in_mid_contact_goes_on_in_step(how):
    space = pymunk.Space()
    space.gravity = 0, -10
    space.add(pymunk.Segment(space.static_body, (-9, 0), (9, 0), 0.1))
    for i in range(3):
        body = pymunk.Body(1, 1 / 6)
        body.position = 0.1 * i, 0.59 + 0.99 * i
        shape = pymunk.Poly.create_box(body, (1, 1))
        shape.friction = 0.5
        space.add(body, shape)
    ra.attach(space)
    for _ in range(5):
        space.step(DT)
    twin = COPIES[how](space)
    for _ in range(60):
        space.step(DT)
        twin.step(DT)
    assert [(*b.position, b.angle) for b in twin.bodies] == [(*b.position, b.angle) for b in space.bodies]


def in_a_program(text, **options):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), str(ROOT / "tests" / "compat")])}
    return subprocess.Popen(
        [sys.executable, "-u", "-c", text], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        env=environment, **options,
    )  # fmt: skip


def _slow_or_not(number, seconds):  # a task of the sweep below, in other processes
    time.sleep(seconds)
    return {"number": number}


SWEEP = """
import sys
from pathlib import Path
from rigidarea.study.sweep import run_tasks
import test_seen_failing
if __name__ == "__main__":
    tasks = [{"number": i, "seconds": 0.0 if i < 4 else 60.0} for i in range(40)]
    run_tasks(test_seen_failing._slow_or_not, tasks, Path(sys.argv[1]), workers=2)
"""


@pytest.mark.slow
def test_ctrl_c_in_a_sweep_stops_and_keeps_what_is_finished(tmp_path):
    """To the whole group, as a terminal sends it, while two of 36 tasks of a minute run."""
    program, store = tmp_path / "sweep.py", tmp_path / "rows.jsonl"
    program.write_text(SWEEP)
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), str(ROOT / "tests" / "compat")])}
    child = subprocess.Popen(
        [sys.executable, str(program), str(store)],
        stderr=subprocess.DEVNULL,
        env=environment,
        start_new_session=True,
    )
    try:
        deadline = time.monotonic() + 120
        while (not store.exists() or len(store.read_text().splitlines()) < 4) and time.monotonic() < deadline:
            time.sleep(0.1)
        began = time.monotonic()
        os.killpg(child.pid, signal.SIGINT)
        code = child.wait(30)
        # a second on a machine that has nothing else to do, and a minute and more if it waits for what runs
        assert time.monotonic() - began < 15 and code != 0
        assert len(store.read_text().splitlines()) == 4
    finally:
        child.kill()


def test_frames_on_end_can_be_interrupted():
    """By a signal that comes within a million of them."""
    space = pymunk.Space()
    space.gravity = 0, -10
    body = pymunk.Body(1, 1)
    space.add(body, pymunk.Circle(body, 1), pymunk.Segment(space.static_body, (-9, -3), (9, -3), 1))
    contact = ra.attach(space)
    before = signal.signal(signal.SIGALRM, signal.default_int_handler)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        began = time.monotonic()
        with pytest.raises(KeyboardInterrupt):
            contact.step(DT, frames=2_000_000_000)  # an hour at the least
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    assert time.monotonic() - began < 20
    contact.step(DT)  # and goes on
    assert body.position.y == pytest.approx(-1, abs=0.1)


@pytest.mark.parametrize("callback", ["begin", "pre_solve", "post_solve", "velocity_func"])
def test_a_step_within_a_step_is_refused(callback):
    space = pymunk.Space()
    body = pymunk.Body(1, 1)
    space.add(body, pymunk.Circle(body, 1), pymunk.Circle(space.static_body, 1, (0, 1.5)))
    contact = ra.attach(space)
    said = []

    def again(*_):
        with pytest.raises(RuntimeError, match="within a step") as error:
            contact.step(DT)
        said.append(str(error.value))

    if callback == "velocity_func":
        body.velocity_func = again
    else:
        space.on_collision(0, 0, **{callback: again})
    space.step(DT)
    assert said


@pytest.mark.parametrize("name", ["elasticity", "friction"])
@pytest.mark.parametrize("value", [-1, math.nan, math.inf, "much"])
def test_materials_that_make_no_sense_are_refused(name, value):
    outline = ra.shapes.box(1, 1)
    body = outline.body(mass=1)
    with pytest.raises((ValueError, TypeError), match=name):
        outline.add_to(body, **{name: value})
    assert not body.shapes


def test_vertices_that_cross_are_no_end_of_memory():
    """pymunk takes the hull of what a Poly is given, but not of what `unsafe_set_vertices` is given."""
    space = pymunk.Space()
    space.gravity = 0, -10
    body = pymunk.Body(1, 1)
    shape = pymunk.Poly(body, [(-1, -1), (1, -1), (1, 1), (-1, 1)])
    space.add(body, shape, pymunk.Segment(space.static_body, (-9, -2), (9, -2), 1))
    contact = ra.attach(space)
    space.step(DT)
    rng = np.random.default_rng(5)
    for _ in range(20):
        shape.unsafe_set_vertices([tuple(p) for p in rng.normal(size=(30, 2))])
        try:
            contact.refresh(shape)
        except ValueError as error:
            assert "cross" in str(error) or "area" in str(error) or "itself" in str(error)
        for _ in range(3):
            contact.step(DT)
    assert all(map(math.isfinite, (*body.position, body.angle)))
    work = [getattr(contact._store.work, name) for name in contact._store.work._fields]
    assert sum(array.nbytes for array in work) < 1 << 24


@pytest.mark.parametrize(
    "call",
    [
        lambda: ra.shapes.circle(1e-200),
        lambda: ra.Outline.circle(1).sample(1e-17),
        lambda: ra.shapes.capsule(1e300, 1.0),
        lambda: ra.Outline.circle(1e200),
    ],
)
def test_sizes_beyond_what_numbers_can_tell(call):
    """An outline whose measures are finite and not zero, or a ValueError, and no other library's error."""
    try:
        made = call()
    except ValueError as error:
        assert len(str(error)) > 20
        return
    assert math.isfinite(made.area) and made.area > 0 and np.isfinite(made.bounds).all()


def test_a_step_beyond_what_numbers_can_tell():
    space = pymunk.Space()
    space.gravity = 0, -10
    body = pymunk.Body(1, 1)
    space.add(body, pymunk.Circle(body, 1))
    contact = ra.attach(space)
    for argument in ({"steps": 2**70}, {"frames": 2**70}, {"tolerance": 0}):
        with pytest.raises(ValueError):
            contact.step(DT, **argument)
    with pytest.raises(ra.SimulationError, match="not finite"):
        contact.step(1e300)
    assert body.position == (0, 0) and body.velocity == (0, 0)


def test_machine_code_does_not_mutter():
    """Nothing on standard error where a step divides by zero."""
    child = in_a_program(
        "import pymunk, rigidarea as ra\n"
        "for law in ('area', 'energy'):\n"
        "    space = pymunk.Space()\n"
        "    contact = ra.attach(space, law=law)\n"  # before anything is there
        "    contact.step(1 / 60)\n"
        "    for place in ((0, 0), (0, 0), (1e-300, 0)):\n"
        "        body = pymunk.Body(1, 1)\n"
        "        body.position = place\n"
        "        space.add(body, pymunk.Circle(body, 1))\n"
        "    contact.step(1 / 60, frames=3)\n"
    )
    said = child.communicate(timeout=600)[1]
    lines = [line for line in said.splitlines() if not line.startswith("rigidarea: compiling")]
    assert lines == [] and child.returncode == 0


#: Tests of pymunk's that ended in an error or differed.
NAMED = (
    *(
        "testCollisionHandlerRemoveAfterSeparate",
        "testFriction",
        "testRestitution",
        "testImpulse",
        "testTotalKE",
    ),
    *("test_each_arbiters", "testCollisionHandlerPostSolve", "testReindexStaticCollision"),
    "testWildcardCollisionHandler",
)


@pytest.mark.parametrize("mode", MODES[1:])
def test_those_of_pymunks_tests(mode, tmp_path):
    """Each passes, or its reason is written down."""
    modules = [f"pymunk.tests.test_{name}" for name in ("arbiter", "body", "space")]
    found = {name: [] for name in NAMED}
    for row in run_suite(mode, tmp_path, modules):
        name = row["test"].split(".")[1]
        if name in found:
            found[name].append(row["passed"] or row["test"] in REASONS)
    assert all(found.values()) and all(all(good) for good in found.values()), found


def test_a_missing_library_is_said_before_anything_is_measured(tmp_path):
    child = in_a_program(
        "import sys; sys.modules['matplotlib'] = None\n"
        "from rigidarea.__main__ import main\n"
        "main(['bench', 'step'])\n",
        cwd=tmp_path,
    )
    began = time.process_time()
    out, said = child.communicate(timeout=300)
    assert child.returncode == 2 and "matplotlib is not installed" in said and out == ""
    assert time.process_time() - began < 13


def test_many_places_at_once_are_each_at_its_own():
    a, b = ra.Outline([(0, 0), (4, 0), (4, 3), (3, 3), (3, 1), (1, 1), (1, 3), (0, 3)]), ra.shapes.box(6, 0.5)
    rng = np.random.default_rng(3)
    places_a, places_b = rng.uniform(-2, 2, (2, 400, 3))
    found = ra.overlaps(a, places_a, b, places_b)
    # a bar across a cup has two regions
    assert len(found) > len(np.unique(found["place"])) > 200 and (np.diff(found["place"]) >= 0).all()
    for i in range(400):
        one = ra.overlap(a, places_a[i], b, places_b[i])
        own = found[found["place"] == i]
        for name in ("area", "centroid", "direction", "chord"):
            assert own[name] == pytest.approx(one[name], rel=1e-13, abs=1e-13)
    one_of_them = ra.overlaps(a, (0, 0, 0), b, places_b)  # one place for all
    assert np.array_equal(
        one_of_them[one_of_them["place"] == 7]["area"], ra.overlap(a, (0, 0, 0), b, places_b[7])["area"]
    )
    assert len(ra.overlaps(a, places_a[:0], b, places_b[:0])) == 0
    for wrong in (places_a[:5], places_a[:, :2], [[0, 0, math.nan]], "here"):
        with pytest.raises(ValueError, match="place"):
            ra.overlaps(a, wrong, b, places_b)


def test_the_wheel_has_one_package():
    built = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["hatch"]["build"]["targets"]["wheel"]
    assert built["packages"] == ["rigidarea"] and set(built) == {"packages", "hooks"}
