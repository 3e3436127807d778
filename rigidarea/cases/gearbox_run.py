"""The case `gearbox`: its run and its sweeps, beside the numbers of the paper."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rigidarea.cases import gear_statics, gearbox_figures
from rigidarea.cases import gearbox as gb
from rigidarea.cases.case_report import Case, say
from rigidarea.cases.mechanism import kept_steps, main_run
from rigidarea.flexible.integrate import Record, Simulation

DURATION = 0.5  # s


def run(
    mode: str = "compliant",
    mesh_mm: float = 0.6,
    contact: str = "area",
    out: Path | None = None,
    cache: Path | None = None,
) -> dict[str, Any]:
    """One gearbox run and its contact ratio; then standard teeth, and the paper's sweeps over mesh, step and
    damper, each beside the paper's numbers."""
    settings = {
        "mode": mode,
        "mesh_mm": mesh_mm,
        "contact": contact,
        "k": gb.K,
        "damper": gb.DAMPER,
        "step_s": gb.STEP,
        "rho": gb.RHO,
        "addendum_modules": gb.ADDENDUM,
        "dedendum_modules": gb.ADDENDUM + gb.ROOT,
        "root_radius_modules": gb.ROOT,
        "bores_m": gb.BORES,
        "refine": gb.REFINE,
        "pressure_angle": "of the pair that carries most, at each instant",
    }
    case = Case("gearbox", settings, gb.PAPER, DURATION, out)

    def make(addendum: float = gb.ADDENDUM, damper: float = gb.DAMPER) -> Simulation:
        return gb.simulation(mode, mesh_mm, contact, addendum=addendum, damper=damper, cache=cache)

    def one(addendum: float) -> tuple[Record, dict[str, Any]]:
        """A run, timed, with its contact ratio and load sharing beside the analytic ones."""
        hook = (lambda t: gb.through_hook(t, addendum)) if mode == "rigid" and contact == "area" else None
        r, seconds = main_run(lambda: make(addendum), hook, DURATION, gb.STEP)
        return r, {
            "addendum_modules": addendum,
            "mesh_mm": mesh_mm,
            **gb.measure(r, addendum),
            **seconds,
            **gear_statics.light_load(addendum)[0],
        }

    make()
    case.set_up()
    r, results = one(gb.ADDENDUM)
    case.keep(**results)
    records = {"main": r}
    say("gearbox: standard teeth")
    records["standard"], standard = one(gb.STANDARD)
    case.keep(standard_teeth=standard)
    for key, refine in (("meshes", gb.REFINE), ("meshes_node_perimeter", 1)):
        say(f"gearbox: {key}")
        case.grow(case.results, key, gb.mesh_sweep(mode, contact, DURATION, gb.ADDENDUM, refine, cache))
    say("gearbox: standard teeth, meshes")
    case.grow(standard, "meshes", gb.mesh_sweep(mode, contact, DURATION, gb.STANDARD, gb.REFINE, cache))
    say("gearbox: variants, dampers, steps")
    case.grow(case.results, "variants", (gb.variant(*each, contact, DURATION) for each in gb.VARIANTS))
    dampers = ({"damper": d, **gb.measure(make(damper=d).run(DURATION, gb.STEP))} for d in gb.DAMPERS)
    case.grow(case.results, "dampers", dampers)
    steps = kept_steps(case, make, gb.measure, gb.STEPS, DURATION, gb.MESHING)
    say("gearbox: mesh stiffness by FE statics")
    case.keep(mesh_stiffness=gear_statics.mesh_stiffness(cache=cache))
    standard["mesh_stiffness"] = gear_statics.mesh_stiffness(gb.STANDARD, cache=cache)
    case.keep(standard_teeth=standard, tooth_compliance=gear_statics.tooth_compliance(cache))
    if out is not None:
        gearbox_figures.draw(out, case.results, records, steps, mesh_mm, cache)
    return case.finish()
