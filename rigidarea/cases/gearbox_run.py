"""The case `gearbox`: its run and its sweeps, beside the numbers of the paper."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rigidarea.cases import case_report
from rigidarea.cases.mechanism import main_run, step_sweep
from rigidarea.flexible.integrate import Record, Simulation

from .gearbox import (
    ADDENDUM,
    BORES,
    DAMPER,
    DAMPERS,
    MESHING,
    PAPER,
    REFINE,
    RHO,
    ROOT,
    STANDARD,
    STEP,
    STEPS,
    VARIANTS,
    K,
    measure,
    mesh_sweep,
    simulation,
    through_hook,
    variant,
)


def run(
    mode: str = "compliant",
    mesh_mm: float = 0.6,
    contact: str = "area",
    out: Path | None = None,
    cache: Path | None = None,
    duration: float = 0.5,
    sweeps: bool = True,
) -> dict[str, Any]:
    """One gearbox run and its contact ratio; then standard teeth, and the paper's sweeps over mesh, step and
    damper, each beside the paper's numbers."""
    from rigidarea.cases import gear_statics

    settings = {
        "mode": mode,
        "mesh_mm": mesh_mm,
        "contact": contact,
        "k": K,
        "damper": DAMPER,
        "step_s": STEP,
        "rho": RHO,
        "addendum_modules": ADDENDUM,
        "dedendum_modules": ADDENDUM + ROOT,
        "root_radius_modules": ROOT,
        "bores_m": BORES,
        "refine": REFINE,
        "pressure_angle": "of the pair that carries most, at each instant",
    }
    case = case_report.Case("gearbox", settings, PAPER, duration, out)

    def make(addendum: float = ADDENDUM, damper: float = DAMPER) -> Simulation:
        return simulation(mode, mesh_mm, contact, addendum=addendum, damper=damper, cache=cache)

    def one(addendum: float) -> tuple[Record, dict[str, Any]]:
        """A run, timed, with its contact ratio and load sharing beside the analytic ones."""
        hook = (lambda t: through_hook(t, addendum)) if mode == "rigid" and contact == "area" else None
        r, seconds = main_run(lambda: make(addendum), hook, duration, STEP)
        return r, {
            "addendum_modules": addendum,
            "mesh_mm": mesh_mm,
            **measure(r, addendum),
            **seconds,
            **gear_statics.light_load(addendum)[0],
        }

    make()
    case.clock.setup()
    r, results = one(ADDENDUM)
    case.keep(**results)
    records = {"main": r}
    case_report.say("gearbox: standard teeth")
    records["standard"], standard = one(STANDARD)
    case.keep(standard_teeth=standard)
    if sweeps:
        for key, addendum, refine in (("meshes", ADDENDUM, REFINE), ("meshes_node_perimeter", ADDENDUM, 1)):
            case_report.say(f"gearbox: {key}")
            rows: list[dict[str, Any]] = []
            for row in mesh_sweep(mode, contact, duration, addendum, refine, cache):
                rows.append(row)
                case.keep(**{key: rows})
        case_report.say("gearbox: standard teeth, meshes")
        standard["meshes"] = []
        for row in mesh_sweep(mode, contact, duration, STANDARD, REFINE, cache):
            standard["meshes"].append(row)
            case.keep(standard_teeth=standard)
        case_report.say("gearbox: variants, dampers, steps")
        variants: list[dict[str, Any]] = []
        for name, keys in VARIANTS:
            variants.append(variant(name, keys, contact, duration))
            case.keep(variants=variants)
        dampers: list[dict[str, Any]] = []
        for d in DAMPERS:
            dampers.append({"damper": d, **measure(make(damper=d).run(duration, STEP))})
            case.keep(dampers=dampers)
        steps: list[dict[str, Any]] = []
        for row, record in step_sweep(make, measure, STEPS, duration, MESHING):
            steps.append(row)
            records[f"step {row['step_s']:g}"] = record
            case.keep(steps=steps)
        case_report.say("gearbox: mesh stiffness by FE statics")
        case.keep(mesh_stiffness=gear_statics.mesh_stiffness(cache=cache))
        standard["mesh_stiffness"] = gear_statics.mesh_stiffness(STANDARD, cache=cache)
        case.keep(standard_teeth=standard, tooth_compliance=gear_statics.tooth_compliance(cache))
    if out is not None:
        from rigidarea.cases import gearbox_figures

        gearbox_figures.draw(out, case.results, records, mesh_mm, cache)
    return case.finish()
