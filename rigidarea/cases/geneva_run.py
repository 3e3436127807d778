"""The case `geneva`: its run and its sweeps, beside the numbers of the paper."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from rigidarea.cases import case_report
from rigidarea.cases.mechanism import main_run, step_sweep
from rigidarea.flexible.integrate import Simulation

from .geneva_case import (
    DAMPER,
    DUE,
    MESH,
    PAPER,
    PLAY_S,
    REFINE,
    RHO,
    SPEED,
    STEP,
    STEPS,
    K,
    first_touch,
    measure,
    simulation,
    through_hook,
)


def run(
    mode: str = "compliant",
    mesh_mm: float = MESH,
    contact: str = "area",
    out: Path | None = None,
    cache: Path | None = None,
    duration: float = 10.0,
    sweeps: bool = True,
) -> dict[str, Any]:
    """Six slots over 10 s; then 4, 5 and 8 slots, stiffer contacts, and the sweep of steps (1 s each)."""

    def make(slots: int = 6, **keys: Any) -> tuple[Simulation, float]:
        return simulation(mode, mesh_mm, contact, slots, cache=cache, **keys)

    start = first_touch(6) - SPEED * DUE
    settings = {
        "mode": mode,
        "mesh_mm": mesh_mm,
        "contact": contact,
        "k": K,
        "damper": DAMPER,
        "step_s": STEP,
        "rho": RHO,
        "start_angle_deg": float(np.degrees(start)),
        "refine": REFINE,
    }
    case = case_report.Case("geneva", settings, PAPER, duration, out)
    make()
    case.clock.setup()
    hook = through_hook if mode == "rigid" and contact == "area" else None
    r, seconds = main_run(lambda: make()[0], hook, duration, STEP)
    case.keep(**measure(r, start, 6), **seconds)
    records = {}
    if sweeps:
        case_report.say("geneva: other numbers of slots")
        rows: list[dict[str, Any]] = []
        for n in (4, 5, 6, 8):
            s, a = make(n)
            rows.append(measure(s.run(4.4, STEP), a, n))
            case.keep(slot_numbers=rows)
        case_report.say("geneva: stiffness, steps")
        stiffness: list[dict[str, Any]] = []
        for k in (K / 4, K, 4 * K):
            s, a = make(k=k)
            stiffness.append({"k": k, **measure(s.run(1.0, STEP), a, 6)})
            case.keep(stiffness=stiffness)
        steps: list[dict[str, Any]] = []
        for row, record in step_sweep(lambda: make()[0], lambda r: measure(r, start, 6), STEPS, 1.0, PLAY_S):
            steps.append(row)
            records[row["step_s"]] = record
            case.keep(steps=steps)
    if out is not None:
        from rigidarea.cases import geneva_figures

        geneva_figures.draw(out, r, start, case.results, records, cache)
    return case.finish()
