"""The kernel as tests see it: one place that knows its modules, how outlines are placed, and where the scratch grows.

Run the kernel tests without compilation by `NUMBA_DISABLE_JIT=1 PAIRS=20 pytest tests/test_overlap.py -m ...`;
`test_overlap.test_the_same_without_compilation` does so in a subprocess.
"""

from __future__ import annotations

import importlib
import json
import os
import traceback
import warnings
from collections.abc import Callable, Generator, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
import pytest
from hypothesis import settings

import rigidarea
from rigidarea.report import envelope, solver, write_json

BACKEND = rigidarea.backend()


def kernel_module(name: str) -> ModuleType:
    """A kernel module by its short name: the one place that knows where in the package kernels live."""
    room = "geometry" if (Path(rigidarea.__file__).parent / "geometry" / f"{name}.py").exists() else "contact"
    return importlib.import_module(f"rigidarea.{room}.{name}")


def _compiled(function: Callable[..., Any]) -> Any:
    """A kernel of the tests' own: as the package's that call kernels, but kept nowhere."""
    if BACKEND != "compiled":
        return function
    import numba

    from rigidarea.compile.compiled import Whole

    made = numba.njit(function)
    made.__class__ = Whole
    return made


class Found(NamedTuple):
    """Regions of many pairs, in world axes relative to the origin of A's body (n pairs, m regions)."""

    count: np.ndarray  # (n,) regions of the pair
    pair: np.ndarray  # (m,) which pair
    area: np.ndarray  # (m,)
    centroid: np.ndarray  # (m, 2)
    chord: np.ndarray  # (m, 2) sum of end - start over A's arcs
    extent: (
        np.ndarray
    )  # (m,) half perimeter of its bounding box, so area / extent is less than its mean width

    def total(self, weights: np.ndarray) -> np.ndarray:
        """(n,) sums over each pair's regions."""
        return np.bincount(self.pair, weights, minlength=len(self.count))


class Kernel:
    """Overlap of outlines by `overlap_of_outlines`, as contacts call it: tangles undone, scratch grown."""

    def __init__(self) -> None:
        self.overlap = kernel_module("overlap")
        self.place = kernel_module("place")
        self.pool = kernel_module("pool")
        self.direction = kernel_module("direction")
        self.impact = kernel_module("impact")
        self.stiffness = kernel_module("stiffness")
        self.row = kernel_module("row")
        self.tables = kernel_module("tables")
        self.dtypes = kernel_module("dtypes")
        self.broad = kernel_module("broad")
        self.constants = kernel_module("constants")
        self.predicates = kernel_module("predicates")
        regions_of = self.place.overlap_of_outlines
        Pose = self.place.Pose

        @_compiled
        def run(
            pool: Any, ia: Any, ib: Any, pa: Any, pb: Any, work: Any, begin: int, m: int,
            counts: Any, where: Any, out: Any,
        ) -> Any:  # fmt: skip
            for i in range(begin, len(ia)):
                a = Pose(pa[i, 0], pa[i, 1], pa[i, 2], pa[i, 3])
                b = Pose(pb[i, 0], pb[i, 1], pb[i, 2], pb[i, 3])
                n = regions_of(pool, ia[i], a, ib[i], b, work)[0]
                if n < 0 or m + n > len(out):
                    return i, m
                head = pool.heads[ia[i]]
                for k in range(n):
                    loop = work.loops[k]
                    x = loop.x + head.x
                    y = loop.y + head.y
                    where[m] = i
                    out[m, 0] = loop.area
                    out[m, 1] = a.c * x - a.s * y
                    out[m, 2] = a.s * x + a.c * y
                    out[m, 3] = a.c * loop.chord_x - a.s * loop.chord_y
                    out[m, 4] = a.s * loop.chord_x + a.c * loop.chord_y
                    low_x = high_x = work.polygon[loop.start, 0]
                    low_y = high_y = work.polygon[loop.start, 1]
                    for v in range(loop.start, loop.stop):
                        low_x = min(low_x, work.polygon[v, 0])
                        high_x = max(high_x, work.polygon[v, 0])
                        low_y = min(low_y, work.polygon[v, 1])
                        high_y = max(high_y, work.polygon[v, 1])
                    out[m, 5] = high_x - low_x + high_y - low_y
                    m += 1
                counts[i] = n
            return len(ia), m

        self._run = run

    def work(self, outlines: Sequence[Any]) -> Any:
        points = 2 * max(sum(map(len, o.rings)) for o in outlines)
        return self.overlap.new_work(max(points, 256), 32, 2 * max(len(o.rings) for o in outlines))

    def many(
        self,
        outlines: Sequence[Any],
        ia: np.ndarray,
        ib: np.ndarray,
        pa: np.ndarray,
        pb: np.ndarray,
        work: Any = None,
    ) -> Found:
        """Regions of outlines[ia] at poses pa and outlines[ib] at pb; poses are rows (x, y, cosine, sine)."""
        pool = self.pool.pack(outlines)
        work = work or self.work(outlines)
        points = 2 * max(sum(map(len, o.rings)) for o in outlines)
        rings = 2 * max(len(o.rings) for o in outlines)
        counts = np.full(len(ia), -1, np.int64)
        where = np.zeros(64, np.int64)
        out = np.zeros((64, 6))
        begin = m = 0
        while True:
            begin, m = self._run(pool, ia, ib, pa, pb, work, begin, m, counts, where, out)
            if begin == len(ia):
                break
            if m + len(work.loops) > len(out):
                where = np.concatenate([where, np.zeros(max(len(out), len(work.loops)), np.int64)])
                out = np.concatenate([out, np.zeros((len(where) - len(out), 6))])
            elif len(work.cross) < 1 << 16:
                work = self.overlap.enlarged(work, points, rings)
            else:  # no scratch is enough: undecided, and counted as such
                counts[begin] = -1
                begin += 1
        return Found(counts, where[:m], out[:m, 0], out[:m, 1:3], out[:m, 3:5], out[:m, 5])

    def refused(
        self, outlines: Sequence[Any], ia: np.ndarray, ib: np.ndarray, pa: np.ndarray, pb: np.ndarray
    ) -> tuple[int, int]:
        """(how many of the pairs are undecided where they are, how many results are caught as impossible): both are
        asked again, with B shifted."""
        overlap_kernel, seen_from, Pose = self.overlap.overlap_kernel, self.place.seen_from, self.place.Pose
        tangled, caught = self.overlap.TANGLED, self.overlap.CAUGHT

        @_compiled
        def count(pool: Any, ia: Any, ib: Any, pa: Any, pb: Any, work: Any, out: Any) -> None:
            for i in range(len(ia)):
                a = Pose(pa[i, 0], pa[i, 1], pa[i, 2], pa[i, 3])
                b = Pose(pb[i, 0], pb[i, 1], pb[i, 2], pb[i, 3])
                rel = seen_from(pool.heads[ia[i]], a, pool.heads[ib[i]], b)
                n = overlap_kernel(pool, ia[i], pool, ib[i], rel, work)
                if n == tangled:
                    out[0] += 1
                if n == caught:
                    out[1] += 1

        out = np.zeros(2, np.int64)
        count(self.pool.pack(outlines), ia, ib, pa, pb, self.work(outlines), out)
        return int(out[0]), int(out[1])

    def one(
        self, a: Any, pose_a: Sequence[float], b: Any, pose_b: Sequence[float], work: Any = None
    ) -> Found:
        """Regions of one pair; poses are (x, y, angle) or (x, y, cosine, sine)."""
        poses = [
            np.array([[p[0], p[1], np.cos(p[2]), np.sin(p[2])] if len(p) == 3 else p], dtype=float)
            for p in (pose_a, pose_b)
        ]
        return self.many([a, b], np.array([0]), np.array([1]), *poses, work=work)

    def counter(self, a: Any, b: Any) -> Callable[[float, float, float], int]:
        """How many regions b at (x, y, angle) has with a at the origin: asked again and again, packed once."""
        pool, work = self.pool.pack([a, b]), self.work([a, b])
        first, second, home = np.array([0]), np.array([1]), np.array([[0.0, 0.0, 1.0, 0.0]])
        where, out = np.zeros(64, np.int64), np.zeros((64, 6))

        def count(x: float, y: float, angle: float) -> int:
            pose, counts = np.array([[x, y, np.cos(angle), np.sin(angle)]]), np.full(1, -1, np.int64)
            done, _ = self._run(pool, first, second, home, pose, work, 0, 0, counts, where, out)
            return int(counts[0] if done else self.one(a, (0, 0, 0), b, (x, y, angle)).count[0])

        return count

    def polygons(
        self, a: Any, pose_a: Sequence[float], b: Any, pose_b: Sequence[float]
    ) -> list[tuple[np.ndarray, np.ndarray]]:
        """(vertices, labels) of each region, holes left out, relative to A's body, in A's axes."""
        pool = self.pool.pack([a, b])
        work = self.work([a, b])
        pose = [
            self.place.Pose(p[0], p[1], float(np.cos(p[2])), float(np.sin(p[2]))) for p in (pose_a, pose_b)
        ]
        n = self.place.overlap_of_outlines(pool, 0, pose[0], 1, pose[1], work)[0]
        while n < 0:
            work = self.overlap.enlarged(
                work, 2 * max(len(a.rings[0]), len(b.rings[0])), 2 * len(a.rings + b.rings)
            )
            n = self.place.overlap_of_outlines(pool, 0, pose[0], 1, pose[1], work)[0]
        middle = (pool.heads["x"][0], pool.heads["y"][0])
        spans = [slice(int(work.loops["start"][k]), int(work.loops["stop"][k])) for k in range(n)]
        return [(work.polygon[s] + middle, work.label[s].copy()) for s in spans]


@pytest.fixture(scope="session")
def kernel() -> Kernel:
    if BACKEND == "library":
        pytest.skip("kernels one by one: a library has what Python calls")
    return Kernel()


TESTS = Path(__file__).parent


def _without_kernels_of_others() -> Generator[None, Any, Any]:
    """A test that calls itself what only kernels call is skipped where there is a library: that has it in others.

    Where the package calls such a one the library has a hole, and the test fails.
    """
    if BACKEND != "library":
        return (yield)
    with warnings.catch_warnings():
        warnings.filterwarnings("error", ".* is not in the library of machine code", RuntimeWarning)
        try:
            return (yield)
        except RuntimeWarning as said:
            caller = traceback.extract_tb(said.__traceback__)[-2].filename
            if "not in the library" in str(said) and TESTS in Path(caller).parents:
                pytest.skip(f"builds: {str(said).split()[0]} is in the library within others alone")
            raise


@pytest.hookimpl(wrapper=True)
def pytest_runtest_setup() -> Generator[None, Any, Any]:
    return (yield from _without_kernels_of_others())


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call() -> Generator[None, Any, Any]:
    return (yield from _without_kernels_of_others())


#: Without compilation everything is a hundred times slower: fewer examples.
PURE_PYTHON = BACKEND == "interpreted"
settings.register_profile("fixed", derandomize=True, deadline=None, max_examples=8 if PURE_PYTHON else 60)
settings.load_profile("fixed")

#: What the contact solve does not meet yet: one test a line, then what it measured.
NOT_YET = Path(__file__).with_name("not_yet.txt")


@pytest.fixture
def record_property(record_property: Callable[[str, object], None]) -> Callable[[str, object], None]:
    """pytest's own; numpy's numbers go as Python's, since xdist's processes can hand on no others."""
    return lambda name, value: record_property(name, value.item() if isinstance(value, np.generic) else value)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--results", metavar="FILE", help="keep there the figures that tests have measured")


class Figures:
    """What tests have measured by `record_property(name, value)`, whatever came of them, as the file that docs/ shows.

    Of the values of one name the largest is kept, the least of `least_...`, the sum of `count_...`. The file goes on
    with what it has of the same solver.
    """

    def __init__(self, file: Path) -> None:
        before = json.loads(file.read_text()) if file.exists() else {}
        kept = before.get("results", {}) if before.get("versions", {}).get("solver") == solver() else {}
        self.file, self.kept, self.found = file, kept, dict[str, float]()

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.when == "call":
            for name, value in report.user_properties:
                how = {"least": min, "count": sum}.get(name.partition("_")[0], max)
                self.found[name] = how([self.found[name], value]) if name in self.found else value

    def pytest_sessionfinish(self) -> None:
        write_json(envelope("pytest -m shown", {}, dict(sorted((self.kept | self.found).items()))), self.file)


def pytest_configure(config: pytest.Config) -> None:
    file = config.getoption("--results")
    if file and not hasattr(config, "workerinput"):  # of xdist's processes the one that hears of all tests
        config.pluginmanager.register(Figures(Path(file)))


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Skip what needs a checkout where there is none.

    And mark as expected to fail what NOT_YET has, not strictly: a line whose test passes may go.
    """
    if Path(rigidarea.__file__).parents[1] != TESTS.parent:
        for item in items:
            if item.get_closest_marker("checkout"):
                item.add_marker(
                    pytest.mark.skip(reason="needs a checkout: the package's sources beside the tests")
                )
    if os.environ.get("SOLVE_ENGINE", "area") != "area":  # tests/solve on pymunk's own solver
        return
    lines = [line for line in NOT_YET.read_text().splitlines() if line and not line.startswith("#")]
    reasons = {node: reason for node, _, reason in (line.partition("  # ") for line in lines)}
    for item in items:
        node = item.nodeid[item.nodeid.find("tests/") :]
        if node in reasons:
            item.add_marker(pytest.mark.xfail(reason=reasons[node], strict=False))
