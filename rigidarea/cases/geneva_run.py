"""The case `geneva`: its run and its sweeps, beside the numbers of the paper."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from rigidarea.cases import geneva_case as gv
from rigidarea.cases import geneva_figures
from rigidarea.cases.case_report import Case, say
from rigidarea.cases.mechanism import kept_steps, main_run
from rigidarea.flexible.integrate import Simulation

DURATION = 10.0  # s


def run(
    mode: str = "compliant",
    mesh_mm: float = gv.MESH,
    contact: str = "area",
    out: Path | None = None,
    cache: Path | None = None,
) -> dict[str, Any]:
    """Six slots over 10 s; then 4, 5 and 8 slots, stiffer contacts, and the sweep of steps (1 s each)."""

    def make(slots: int = 6, **keys: Any) -> tuple[Simulation, float]:
        return gv.simulation(mode, mesh_mm, contact, slots, cache=cache, **keys)

    start = gv.first_touch(6) - gv.SPEED * gv.DUE
    settings = {
        "mode": mode,
        "mesh_mm": mesh_mm,
        "contact": contact,
        "k": gv.K,
        "damper": gv.DAMPER,
        "step_s": gv.STEP,
        "rho": gv.RHO,
        "start_angle_deg": float(np.degrees(start)),
        "refine": gv.REFINE,
    }
    case = Case("geneva", settings, gv.PAPER, DURATION, out)
    make()
    case.set_up()
    hook = gv.through_hook if mode == "rigid" and contact == "area" else None
    r, seconds = main_run(lambda: make()[0], hook, DURATION, gv.STEP)
    case.keep(**gv.measure(r, start, 6), **seconds)

    def measured(duration: float, slots: int = 6, **keys: Any) -> dict[str, Any]:
        sim, angle = make(slots, **keys)
        return gv.measure(sim.run(duration, gv.STEP), angle, slots)

    say("geneva: other numbers of slots")
    case.grow(case.results, "slot_numbers", (measured(4.4, n) for n in (4, 5, 6, 8)))
    say("geneva: stiffness, steps")
    case.grow(case.results, "stiffness", ({"k": k, **measured(1.0, k=k)} for k in (gv.K / 4, gv.K, 4 * gv.K)))
    records = kept_steps(case, lambda: make()[0], lambda r: gv.measure(r, start, 6), gv.STEPS, 1.0, gv.PLAY_S)
    if out is not None:
        geneva_figures.draw(out, r, start, case.results, records, cache)
    return case.finish()
