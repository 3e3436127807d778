"""Machine code ahead of time: what goes into a library comes out of it as numba gives it; what runs is said."""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
import time
import types
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

import rigidarea
from rigidarea.compile.raw_memory import record

sys.path.insert(0, str(Path(__file__).parents[1] / "tools"))

POINT = record([("x", "f8"), ("n", "i4")])


class Pair(NamedTuple):
    """A named tuple as kernels take and return."""

    values: np.ndarray
    scale: float


def mixed(pair: Any, points: Any, one: Any, n: int, flag: bool) -> Any:
    """Arrays in a tuple, records, a number, a truth."""
    total = one.x if flag else 0.0
    for p in points:
        total += p.x * p.n
    pair.values[0] = total
    return n + 1, total * pair.scale, not flag


def slanted(a: Any) -> Any:
    """An array of any strides."""
    total = 0.0
    for i in range(a.shape[0]):
        for j in range(a.shape[1]):
            total += (i + 1) * (j + 2) * a[i, j]
    return total


def made(n: int) -> Any:
    """Arrays of its own, one not contiguous, and a named tuple."""
    a = np.arange(2 * n).astype(np.float64).reshape(n, 2)
    return a, a[:, 1], Pair(np.sort(-a[:, 0].copy()), 0.5)


def refuses(n: int) -> int:
    """An exception."""
    if n < 0:
        raise ValueError("expected n >= 0")
    return n


def several(*given: Any) -> Any:
    """Any number."""
    return given[0] * given[1]


@pytest.fixture(scope="module")
def both(tmp_path_factory: Any) -> Any:
    """(numba's functions, the library's) of those above, by name."""
    if rigidarea.backend() != "compiled":
        pytest.skip("a library is made where numba compiles")
    if importlib.util.find_spec("ziglang") is None and shutil.which("cc") is None:
        pytest.skip("nothing here links a library")
    import numba

    from machine_code import ahead
    from rigidarea.compile import compiled, whole
    from rigidarea.compile.library import Library

    functions = {}
    for function in (mixed, slanted, made, refuses, several):
        functions[function.__name__] = numba.njit(function)
        functions[function.__name__].__class__ = compiled.Whole
    whole.kept = {}
    try:
        calls = ahead.Calls()
        with calls:
            for name, arguments in given().items():
                functions[name](*arguments)
        back, called = ahead.units(calls, [], whole.kept)
    finally:
        whole.kept = None
    folder = tmp_path_factory.mktemp("library")
    ahead.write(folder, back, called)
    library = Library(*(folder / path.name for path in rigidarea.compile.chosen.FILES))
    return functions, {name: library.function(f.py_func) for name, f in functions.items()}


def given() -> dict[str, tuple[Any, ...]]:
    """Arguments for each."""
    points = np.zeros(3, POINT)
    points["x"], points["n"] = [0.5, 1.5, -2.25], [1, 2, 3]
    return {
        "mixed": (Pair(np.zeros(4), 3.0), points, points[1], 7, True),
        "slanted": (np.arange(24.0).reshape(4, 6)[::-2, 1::2],),
        "made": (5,),
        "refuses": (3,),
        "several": (2.5, 4.0),
    }


def same(a: Any, b: Any) -> bool:
    if isinstance(a, tuple):
        return type(a) is type(b) and len(a) == len(b) and all(map(same, a, b))
    if isinstance(a, np.ndarray):
        return a.dtype == b.dtype and np.array_equal(a, b)
    return type(a) is type(b) and a == b


@pytest.mark.parametrize("name", given())
def test_a_library_returns_what_numba_does(both: Any, name: str) -> None:
    ours, theirs = given()[name], given()[name]
    found, expected = both[1][name](*ours), both[0][name](*theirs)
    assert same(found, expected), (found, expected)
    assert same(ours[:1], theirs[:1])  # what they write


def test_a_call_takes_microseconds(both: Any) -> None:
    """Numbers, arrays and records in tuples: numba takes them in C, a library in Python, where asking numpy for the
    address of an array of records takes 13 us, more than clipping ten pairs of boxes."""
    extra = {}
    for name in ("several", "slanted", "mixed"):
        least = []
        for functions in both:
            function, arguments = functions[name], given()[name]
            rounds = []
            for _ in range(30):
                before = time.process_time()
                for _ in range(200):
                    function(*arguments)
                rounds.append((time.process_time() - before) / 200)
            least.append(min(rounds))
        extra[name] = 1e6 * (least[1] - least[0])
    assert extra["several"] < 2 and extra["slanted"] < 4 and extra["mixed"] < 9, extra  # 0.8, 2.2, 3.8


def test_a_library_raises_what_the_kernel_raises(both: Any) -> None:
    with pytest.raises(ValueError, match="expected n >= 0"):
        both[1]["refuses"](-1)


def test_a_library_refuses_what_it_has_no_function_for(both: Any) -> None:
    wrong = np.zeros((2, 2), np.float32)
    with pytest.raises(TypeError, match=r"slanted of the library .* got <f4\[2, 2\]"):
        both[1]["slanted"](wrong)
    with pytest.raises(TypeError, match="mixed of the library"):
        both[1]["mixed"](1)


def test_arrays_that_a_library_gives_are_freed(both: Any) -> None:
    import resource

    def peak() -> int:
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    made_there = both[1]["made"]
    made_there(50_000)
    before = peak()
    for _ in range(500):  # 1.2 MB each
        made_there(50_000)
    assert peak() - before < 50_000  # KB; all of them would be 600,000


def kernels() -> dict[str, Any]:
    """All that Python calls, in this back end, by their names."""
    from machine_code.callers import called_from_python, modules

    if rigidarea.backend() == "library":
        from rigidarea.compile.library import Function, Text

        return called_from_python(lambda thing: isinstance(thing, (Function, Text)), modules())
    if rigidarea.backend() == "compiled":
        from machine_code.ahead import is_kernel

        return called_from_python(is_kernel, modules())
    pytest.skip("kernels are functions as others")


def test_what_python_calls_is_found() -> None:
    """By the names in the code of functions that are no kernels: those that are known to be called so."""
    found = set(kernels())
    assert {
        "rigidarea.contact.space_record.overlap_by_address",
        "rigidarea.chipmunk.chipmunk_outlines.read_shapes",
        "rigidarea.contact.bed.stored",
        "rigidarea.flexible.run.run_steps",
    } <= found
    assert "rigidarea.contact.meet.meet" not in found


CALLING = """
import functools
from rigidarea import report
from rigidarea.report import align as by_name, plain as not_called
def plain(): return by_name(1)
def attribute(): return report.align(1)
def imported():
    from rigidarea.report import align as here
    return here(1)
def imported_module():
    from rigidarea import report as there
    return [there.align(x) for x in ()]
@functools.cache
def cached(): return by_name(1)
class Method:
    @functools.cached_property
    def late(self): return by_name(1)
    @property
    def asked(self): return (lambda: by_name(1))()
    @staticmethod
    def loose(): return by_name(1)
"""


@pytest.mark.parametrize("way", ["plain", "attribute", "imported", "imported_module", "cached", "Method"])
def test_callers_are_found_however_they_name_a_kernel(way: str) -> None:
    from machine_code import callers
    from rigidarea import report

    module = types.ModuleType("rigidarea.calling")
    vars(module)["__package__"] = "rigidarea"
    exec(CALLING, vars(module))
    for name in set(vars(module)) & {"plain", "attribute", "imported", "imported_module", "cached", "Method"}:
        if name != way:
            delattr(module, name)
    kernel = {report.align, report.plain}
    found = callers.called_from_python(
        lambda thing: isinstance(thing, types.FunctionType) and thing in kernel, [module]
    )
    assert set(found) == {"rigidarea.report.align"}


def test_the_library_has_all_that_python_calls() -> None:
    """A kernel that it has not is interpreted; a callback that it has not stops the import."""
    if rigidarea.backend() != "library":
        pytest.skip("there is none")
    from rigidarea.compile.library import Text

    missing = [name for name, kernel in kernels().items() if isinstance(kernel, Text)]
    assert not missing


def test_the_rehearsal_calls_all_that_python_calls() -> None:
    """So a kernel that is new is in the next library, or this says that `rehearsal` does not know it."""
    if rigidarea.backend() != "compiled":
        pytest.skip("where numba compiles")
    from machine_code import ahead, rehearsal

    calls = ahead.Calls()
    with calls:
        rehearsal.rehearse()
    assert set(kernels()) <= set(calls.noted)


def run(program: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        text=True,
        env={**os.environ, **environment},
        check=False,
    )


def test_the_backend_is_chosen_by_the_environment() -> None:
    program = "import sys, rigidarea; print(rigidarea.backend(), 'numba' in sys.modules)"
    assert run(program, RIGIDAREA_BACKEND="interpreted").stdout == "interpreted False\n"
    assert run(program, NUMBA_DISABLE_JIT="1", RIGIDAREA_BACKEND="").stdout == "interpreted False\n"
    wrong = run(program, RIGIDAREA_BACKEND="fast").stderr
    assert "RIGIDAREA_BACKEND must be one of library, compiled, interpreted, got 'fast'" in wrong


def test_what_is_not_there_is_said_in_words() -> None:
    if rigidarea.backend() == "library":
        pytest.skip("there is one")
    said = run("import rigidarea", RIGIDAREA_BACKEND="library").stderr
    assert "RIGIDAREA_BACKEND=library needs a wheel that has machine code in it" in said


def test_a_library_does_without_numba() -> None:
    if rigidarea.backend() != "library":
        pytest.skip("there is none")
    program = """
import sys
sys.modules["numba"] = sys.modules["llvmlite"] = None  # importing them fails
import pymunk, rigidarea as ra
space = pymunk.Space()
space.gravity = 0, -10
space.add(pymunk.Segment(space.static_body, (-9, 0), (9, 0), 0.1))
body = pymunk.Body(1, 1)
body.position = 0, 0.6
space.add(body, pymunk.Poly.create_box(body, (1, 1)))
contact = ra.attach(space)
for _ in range(60):
    space.step(1 / 60)
regions = ra.overlap(ra.shapes.box(1, 1), (0, 0, 0), ra.shapes.circle(1), (1, 0, 0))
print(len(contact.regions), contact.energy() != 0, regions["area"].size)
"""
    done = run(program)
    assert done.stdout == "1 True 1\n", done.stderr


FIRST = """
import time
import pymunk, rigidarea
space = pymunk.Space()
space.gravity = 0, -10
body = pymunk.Body(1, 1)
body.position = 0, 0.6
space.add(pymunk.Segment(space.static_body, (-9, 0), (9, 0), 0.1), body, pymunk.Poly.create_box(body, (1, 1)))
rigidarea.attach(space)
space.step(1 / 60)
told = dict(line.split(":", 1) for line in open("/proc/self/status"))
print(time.process_time(), int(told["VmHWM"].split()[0]) / 1e3)
"""


@pytest.mark.skipif(not os.path.exists("/proc/self/status"), reason="memory is read from Linux's /proc")
def test_the_first_frame_is_at_once() -> None:
    """A second and 80 MB from Python's start to the first frame's end: processor time, the machine has other work."""
    if rigidarea.backend() != "library":
        pytest.skip("there is no library")
    took, memory = map(float, run(FIRST).stdout.split())
    assert took <= 1.0 and memory <= 80.0


def test_what_is_not_in_a_library_says_so() -> None:
    from rigidarea.compile.library import Text

    def outer(x: float) -> Any:
        return inner(x) + 1.0

    inner, asked = Text(slanted), Text(outer)
    with pytest.warns(RuntimeWarning, match="outer is not in the library of machine code") as said:
        assert asked(np.ones((1, 1))) == 3.0
    assert len(said) == 1  # what it calls is part of it
