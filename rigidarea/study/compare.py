"""Rigid, compliant and modal on the same scene: traces over each other, what each leaves out, what each
costs.

The mechanisms are those of `rigidarea.cases`; a cantilever hit by a ball is added, whose first mode is slower than
the contact, so that statics cannot be enough: the compliant level's beam has no mass to throw the ball back
with, and returns all that it got. How fast the flexible levels converge is in `convergence`.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..flexible.body import elastic_body
from ..flexible.element import Material
from ..flexible.integrate import Simulation
from ..report import Progress, envelope
from .convergence import ring_energy, studies
from .records import Row
from .scene import Array, check_known, full_circle
from .timing import one_core

LEVELS = ("rigid", "compliant", "modal")

Made = tuple[Any, float, float]
"""(simulation, duration (s), step (s))."""


@dataclass(frozen=True)
class Comparison:
    """A scene at three levels.

    `make(level, cache)` builds it; `trace(record)` is the quantity drawn (with `label`), over `window` (s);
    `exact(record)` is an error against an exact answer, or a finer one, called `exact_name`.
    """

    name: str
    title: str
    label: str
    make: Callable[[str, Path | None], Made]
    trace: Callable[[Any], Array]
    window: tuple[float, float]
    exact_name: str
    exact: Callable[[Any], float]


def _pin_joint() -> Comparison:
    from ..cases import pin_joint as case

    def period(record: Any) -> float:
        y, force = record.x[:, 0, 1], -record.force[:, 1]
        level = y + record.v[:, 0, 1] ** 2 / (2 * case.GRAVITY)
        return float(
            abs(case.measure(record.t, y, force, level)["period_ms"] / case.exact()["period_ms"] - 1)
        )

    fall = math.sqrt(2 * (case.JOURNAL - case.PIN) / case.GRAVITY)
    return Comparison(
        "pin_joint",
        "pin dropped in its journal",
        "contact force (N)",
        lambda level, cache: (case.simulation(1.0, level, "area", cache=cache), 0.3, case.STEP),
        lambda record: -record.force[:, 1],
        (fall - 5e-4, fall + 2.5e-3),
        "period against the rigid bodies' exact one, relative",
        period,
    )


def _geneva() -> Comparison:
    from ..cases import geneva_case as case

    start: dict[str, float] = {}

    def make(level: str, cache: Path | None) -> Made:
        simulation, start["angle"] = case.simulation(level, cache=cache)
        return simulation, 1.0, case.STEP

    def off(record: Any) -> Array:
        crank = start["angle"] + case.SPEED * record.t
        entry = np.pi / 2 - np.pi / 6
        exact = case.ideal(6, np.clip(crank, case.first_touch(6), entry)) + np.pi / 6
        return np.degrees(-(record.hub[:, 1] - record.hub[0, 1]) - exact)

    return Comparison(
        "geneva",
        "Geneva drive, first index",
        "error of the wheel's angle (degrees)",
        make,
        off,
        (0.0, 0.8),
        "rms angle error in engagement / index angle",
        lambda record: case.measure(record, start["angle"], 6)["rms_percent"] / 100,
    )


def _gearbox() -> Comparison:
    from ..cases import gearbox as case

    def transmission(record: Any) -> Array:
        turned = record.hub - record.hub[0]
        radius = 0.5 * case.MODULE * case.TEETH[1]
        return 1e6 * radius * (turned[:, 1] + turned[:, 0] * case.IDEAL)

    return Comparison(
        "gearbox",
        "gearbox 23 : 57",
        "transmission error (µm)",
        lambda level, cache: (case.simulation(level, 0.6, cache=cache), 0.3, case.STEP),
        transmission,
        (0.27, 0.28),
        "rms error of the ratio, relative",
        lambda record: case.measure(record)["ratio_rmse_percent"] / 100,
    )


LENGTH, HEIGHT, THICK, BALL, SPEED, GAP = 0.15, 0.006, 0.005, 0.008, 1.0, 1e-4
"""Cantilever's length, height and thickness, ball's radius (m); the ball's speed (m/s) and way to the beam (m)."""

IMPACT, IMPACT_STEP = 8e-3, 2e-6
"""Simulated time and step of the cantilever (s)."""


def cantilever(level: str, cache: Path | None, modes: int = 30) -> Any:
    """A steel ball falls on the tip of a steel beam that is held in its root's hole: the simulation."""
    steel = Material(207e9, 0.29, 7800.0, THICK)
    size, block, half = 1e-3, 0.03, HEIGHT / 2
    corners = [(-block, -0.015), (0, -0.015), (0, -half), (LENGTH, -half)]
    outer = np.array(corners + [(x, -y) for x, y in reversed(corners)])
    hole = full_circle(0.008, 1e-6)[::-1] - (0.015, 0.0)
    beam, _ = elastic_body([outer, hole], size, steel, level, clamped=1, modes=modes, cache=cache)
    at = (LENGTH - BALL, half + BALL + GAP)
    ball, _ = elastic_body(
        [full_circle(BALL, 1e-6)], size, steel, level, refine=8, modes=10, position=at, velocity=(0.0, -SPEED, 0.0),
        cache=cache,
    )  # fmt: skip
    return Simulation([ball, beam], k=1e10, margin=2e-4, rho=0.8)


def _cantilever() -> Comparison:
    found: dict[str, Array] = {}

    def make(level: str, cache: Path | None) -> Made:
        if not found:  # the reference: more modes, finer in time; every fourth row is a row of the levels
            fine = cantilever("modal", cache, 120).run(IMPACT, IMPACT_STEP / 4, every=4)
            found["speed"] = fine.v[:, 0, 1]
        return cantilever(level, cache), IMPACT, IMPACT_STEP

    return Comparison(
        "cantilever",
        "ball on a cantilever's tip",
        "speed of the ball (m/s)",
        make,
        lambda record: record.v[:, 0, 1],
        (0.0, 3e-3),
        "rms error of the ball's speed against 120 modes at a quarter of the step, over the speed",
        lambda record: float(np.sqrt(np.mean((record.v[:, 0, 1] - found["speed"]) ** 2))) / SPEED,
    )


COMPARISONS: dict[str, Callable[[], Comparison]] = {
    "pin_joint": _pin_joint,
    "geneva": _geneva,
    "gearbox": _gearbox,
    "cantilever": _cantilever,
}


def compare(names: Sequence[str] = (), cache: Path | None = None, repeats: int = 3) -> tuple[Row, Row]:
    """Run every scene at every level: (report, traces).

    Rows: scene, level, cost_s_per_s, setup_s, failed (why a run stopped early), departure (rms difference of
    the trace from the modal level's in the window, over the rms of that trace), error and error_name (against
    an exact answer or a finer one), first_mode_hz (the slowest elastic mode of any body: where it is not far above
    what moves the contact, statics will not do). Traces: what the picture needs, by scene. With all scenes, the
    report's ``convergence`` has a row for every `convergence.Study`, and the energy that a spinning ring loses.
    """
    chosen = list(names) or list(COMPARISONS)
    check_known(chosen, COMPARISONS, "scene")
    rows: list[Row] = []
    traces: Row = {}
    progress = Progress("compare", len(chosen) * len(LEVELS))
    for name in chosen:
        described = COMPARISONS[name]()
        found: dict[str, tuple[Array, Array]] = {}
        here = []
        for level in LEVELS:
            row, record, frequencies = _level(described, level, cache, repeats)
            found[level] = (record.t, described.trace(record))
            here.append(row)
            progress.step(f"{name} {level}")
        inside = (found["modal"][0] >= described.window[0]) & (found["modal"][0] <= described.window[1])
        reference = found["modal"][1][inside]
        scale = float(np.sqrt(np.mean(reference**2))) or 1.0
        slowest = min(float(f.min()) for f in frequencies if len(f)) / (2 * np.pi)
        for row in here:
            row["first_mode_hz"] = slowest
            values = found[row["level"]][1]
            row["departure"] = None
            if not row["failed"]:
                row["departure"] = float(np.sqrt(np.mean((values[inside] - reference) ** 2))) / scale
        rows += here
        traces[name] = {
            "title": described.title,
            "label": described.label,
            "window": described.window,
            "levels": found,
        }
    report = envelope("compare", {"scenes": chosen, "repeats": repeats}, rows)
    if not names:
        report["convergence"] = [
            study.row() for study in studies(lambda: cantilever("modal", cache), IMPACT / 4, IMPACT_STEP)
        ]
        report["ring_energy_change"] = ring_energy()
    return report, traces


def _level(
    described: Comparison, level: str, cache: Path | None, repeats: int
) -> tuple[Row, Any, list[Array]]:
    """One level: its row without the departure, the record of the run, the bodies' angular frequencies."""
    begin = time.perf_counter()
    simulation, duration, step = described.make(level, cache)
    setup = time.perf_counter() - begin
    seconds: list[float] = []
    failed = ""
    with one_core():
        for _ in range(1 + repeats):  # the first compiles, or loads what was compiled
            begin = time.thread_time()  # of this core: a busy machine does not lengthen it
            try:
                record = simulation.run(duration, step)
            except RuntimeError as error:  # it did not converge: what was computed until then is kept
                record, failed = simulation.record, str(error)
                break
            seconds.append(time.thread_time() - begin)
            simulation, duration, step = described.make(level, cache)
    row = {
        "scene": described.name,
        "level": level,
        "cost_s_per_s": None if failed else float(np.median(seconds[1:])) / duration,
        "setup_s": setup,
        "error": None if failed else described.exact(record),
        "error_name": described.exact_name,
        "failed": failed,
    }
    return row, record, [body.frequency for body in simulation.bodies]
