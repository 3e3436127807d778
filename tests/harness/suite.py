"""pymunk's own tests, natively and with area contact attached to every space that they make.

The tests come with the installed pymunk and are run from there (doctests left out). A test that kills its process
counts as failed, and the rest is run in a new one.
"""

from __future__ import annotations

import gc
import json
import re
import subprocess
import sys
import unittest
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pymunk

from rigidarea.chipmunk import attach, attached

from . import environment

MODES = ("pymunk", "area", "area frames")
"""Native; attached, stepped by `Space.step`; attached, every `Space.step` turned into a `contact.step`."""

#: Seconds after which a process is given up.
TIME_LIMIT = 300.0

#: Why another answer than pymunk's is right: test (class.method) -> reason. What is not in here is not explained.
REASONS: dict[str, str] = {
    "UnitTestArbiter.testFriction": "a ball comes down on a ball in steps of 0.1 s: the blow is placed within its "
    "frame, natively at the frame's end, and what follows is another way down",
    "UnitTestArbiter.testImpulse": "two discs put 14 deep into each other: each solver lets them out at its own speed",
    "UnitTestSpace.testRemoveInSeparateWithinStep": "three discs in one place are taken apart until they touch, "
    "and stay so",
    "UnitTestArbiter.testRestitution": "the tenth step ends within the second blow, of which a callback is asked in "
    "the next (exact: 21.49, natively 22.42)",
    "UnitTestArbiter.testTotalKE": "two discs put into each other, as in testImpulse",
    "UnitTestSpace.testPickleCachedArbiters": "the test steps the copy once more than the original: natively a copy "
    "has forgotten its contacts' pseudo-velocities and is a step late; with area contact it is in step",
}


def _attach_everywhere(frames: bool) -> None:
    """From now on every space of this process is attached when it is made; frames: and stepped by contact.step."""
    Space: Any = pymunk.Space
    make, step = Space.__init__, Space.step
    inside: set[int] = set()

    def made(space: pymunk.Space, *arguments: Any, **named: Any) -> None:
        make(space, *arguments, **named)
        if not inside:
            inside.add(0)  # area contact makes spaces of its own, to find its way about pymunk's memory
            try:
                attach(space)
            finally:
                inside.discard(0)

    def stepped(space: pymunk.Space, dt: float) -> None:
        contact = attached(space) if frames and dt > 0 and id(space) not in inside else None
        if contact is None:
            step(space, dt)
            return
        inside.add(id(space))
        try:
            contact.step(dt)
        finally:
            inside.discard(id(space))

    Space.__init__ = made
    Space.step = stepped


def modules() -> list[str]:
    """pymunk's test modules."""
    folder = Path(pymunk.__file__).parent / "tests"
    return [f"pymunk.tests.{path.stem}" for path in sorted(folder.glob("test_*.py"))]


def _tests(names: Sequence[str]) -> list[unittest.TestCase]:
    """Every test of the modules, in a fixed order."""
    found: list[unittest.TestCase] = []

    def walk(suite: Any) -> None:
        for test in suite:
            if isinstance(test, unittest.TestSuite):
                walk(test)
            else:
                found.append(test)

    walk(unittest.TestLoader().loadTestsFromNames(names))
    return found


def name_of(test: unittest.TestCase) -> str:
    """class.method, by which a test is listed."""
    return ".".join(test.id().split(".")[-2:])


def work(mode: str, names: Sequence[str], first: int, file: str) -> None:
    """Run the tests from number `first` on in this process; a line of JSON to `file` before and after each."""
    if mode != "pymunk":
        attach(pymunk.Space())
        gc.freeze()  # not to be gone through in each of the collections that tests ask for: it is none of their objects
        _attach_everywhere(frames=mode == "area frames")
    with open(file, "a") as out:

        def say(**told: Any) -> None:
            out.write(json.dumps(told) + "\n")
            out.flush()

        for number, test in enumerate(_tests(names)):
            if number < first:
                continue
            say(number=number, name=name_of(test))
            result = unittest.TestResult()
            test.run(result)
            trouble = [text for _, text in result.failures + result.errors]
            say(
                number=number,
                passed=not trouble,
                skipped=bool(result.skipped),
                # without addresses, which differ from run to run
                message=re.sub(r" at 0x[0-9a-f]+", "", trouble[0].strip().splitlines()[-1])[:200]
                if trouble
                else "",
            )
        say(number=-1)


def run_suite(mode: str, folder: str | Path, names: Sequence[str] | None = None) -> list[dict[str, Any]]:
    """One row a test: `test`, `passed`, `skipped`, `message`.

    folder: where notes may be kept. names: test modules, all of pymunk's by default.

    Raises ValueError for an unknown mode.
    """
    if mode not in MODES:
        raise ValueError(f"mode must be one of {', '.join(MODES)}, got {mode!r}")
    rows: list[dict[str, Any]] = []
    names = list(modules() if names is None else names)
    first = 0
    while True:
        file = Path(folder) / f"suite-{mode.replace(' ', '-')}-{first}.jsonl"
        file.unlink(missing_ok=True)
        program = f"from harness.suite import work; work({mode!r}, {names!r}, {first}, {str(file)!r})"
        try:
            ended = subprocess.run(
                [sys.executable, "-W", "ignore", "-c", program],
                cwd=folder,
                env=environment(),
                capture_output=True,
                text=True,
                timeout=TIME_LIMIT,
            ).returncode
            how = f"the process ended with {ended}"
        except subprocess.TimeoutExpired:
            how = f"not finished after {TIME_LIMIT:g} s"
        told = [json.loads(line) for line in file.read_text().splitlines()] if file.exists() else []
        file.unlink(missing_ok=True)
        if not told:
            raise RuntimeError(f"pymunk's tests could not be started: {how}")
        called = {line["number"]: line["name"] for line in told if "name" in line}
        for line in told:
            if "passed" in line:
                kept = {key: line[key] for key in ("passed", "skipped", "message")}
                rows.append({"test": called[line["number"]], **kept})
        if told[-1]["number"] == -1:
            return rows
        number = told[-1]["number"]
        rows.append({"test": called[number], "passed": False, "skipped": False, "message": how})
        first = number + 1
