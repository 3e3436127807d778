"""What the driven mechanisms (Geneva, gearbox) share: timed runs, and the sweep over time steps."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from rigidarea.cases.case_report import Case
from rigidarea.flexible.integrate import Record, Simulation

RESOLVING = 10  # steps that the shortest event of a contact must last to count as resolved
SHORT_S = 0.2  # runs shorter than this are timed three times, the best counts


def timed(run: Callable[[], Record]) -> tuple[Record, dict[str, float]]:
    """A run, its wall seconds and its processor seconds (a busy machine has more of the former)."""
    wall, cpu = time.perf_counter(), time.process_time()
    r = run()
    return r, {"run_s": time.perf_counter() - wall, "run_cpu_s": time.process_time() - cpu}


def main_run(
    make: Callable[[], Simulation], hook: Callable[[float], Record] | None, duration: float, h: float
) -> tuple[Record, dict[str, float]]:
    """The run of a case at its own step, timed: through ``hook`` (a duration -> a record) if there is one, else of what
    ``make`` builds. A step before it compiles, or loads from the cache."""
    if hook is not None:
        hook(h)
        return timed(lambda: hook(duration))
    make().run(h, h)
    sim = make()
    return timed(lambda: sim.run(duration, h))


def step_sweep(
    make: Callable[[], Simulation],
    measure: Callable[[Record], dict[str, Any]],
    steps: Sequence[float],
    duration: float,
    event: float,
) -> Iterator[tuple[dict[str, Any], Record]]:
    """One row and record a time step: what the run cost, and what it measured.

    Costs hold all that a large step brings with it: more Newton iterations, and attempts given up because they did
    not converge before the step was halved (``evaluations_a_step`` counts every evaluation of the contact).
    ``event`` is the time that the shortest event of a contact lasts: a step longer than its RESOLVINGth part is
    marked as not resolving it. A run that fails has the reason in ``failed`` and no measurements.
    """
    for h in steps:
        seconds: list[float] = []
        failed = ""
        while not seconds or (sum(seconds) < SHORT_S and len(seconds) < 3):
            sim = make()
            start = time.process_time()
            try:
                r = sim.run(duration, h)
            except RuntimeError as error:
                r, failed = sim.record, str(error)
            seconds.append(time.process_time() - start)
        row: dict[str, Any] = {
            "step_s": h,
            "run_cpu_s": min(seconds),
            "under_resolved": bool(RESOLVING * h > event),
            "evaluations": r.evaluations,
            "evaluations_a_step": r.evaluations / max(len(r.t), 1),
            "steps_halved": int(r.halved.sum()),
        }
        yield row | ({"failed": failed} if failed else measure(r)), r


def kept_steps(case: Case, *sweep: Any) -> dict[float, Record]:
    """The records of a `step_sweep`, by step; its rows are the case's results ``steps``, kept as they come."""
    records: dict[float, Record] = {}
    rows: list[dict[str, Any]] = []
    for row, record in step_sweep(*sweep):
        rows.append(row)
        records[row["step_s"]] = record
        case.keep(steps=rows)
    return records
