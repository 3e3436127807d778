"""An ordinary gearbox of two involute spur gears (the paper's section 3.5, Fig. 21–28, Table 6).

**Two readings of the teeth.** The paper gives numbers of teeth, module and pressure angle, but no addendum. It prints
a contact ratio of 1.9818 (the limit of infinitely many teeth; standard teeth, addendum 1 module, have 1.6841 here),
says that two pairs carry 98.18 % of the time, and draws three pairs in contact. So the case's gears are those
*with the contact ratio that the paper prints*, addendum 1.2048 modules; ``standard_teeth`` in the results is the
same sweep with standard ones. The ripple of the ratio tells the readings apart: with the mesh nodes as perimeter, as
the paper has them, gears of its contact ratio give 0.535, 0.431, 0.309, 0.279, 0.258 % from 1.2 to 0.3 mm
(``meshes_node_perimeter``; its Table 6: 1.139, 0.621, 0.314, 0.277, 0.275), with flanks carried by the mesh edges
0.225, 0.247, 0.251, 0.252, 0.252 %. Standard teeth give 1.1 to 1.2 % whatever the mesh, the scheme, or the code path
(the pymunk hook gives the same).

The reason is the penalty. With this k teeth overlap by 0.1 to 0.2 mm, a hundred times what steel would yield, so
pairs touch before and after the path of contact, and the ripple is that of the contact spring, excited by the
number of pairs that share the load; k, inertia and addendum decide it much more than the mesh (``variants``).

**Pressure angle.** The paper gives an angle to each pair's global force, stable in the middle of the engagement and
off where tips enter and leave, and draws one curve (Fig. 26): ``pressure_angle_mean_deg`` is that of the pair that
carries most at each instant. The others are beside it: of the resultant of all pairs, and over all pairs. They lie
above 20° because tips dig into the mate's flank outside the path of contact, where the direction is no longer the
line of action: an error of the penalty that goes as k grows (``variants``), and not with finer sampling.

Also left open and chosen here: root (clearance and rounding 0.25 modules, ISO 53 profile C; tips dig into rounder
fillets earlier: on fine profiles 0.253 % so, 0.265 % with a sharp root, 0.274 % with the roundest), bores (16 and
30 mm), no backlash, no structural damping, step 80 µs (its Fig. 28), ρ∞ = 0.8. k = 6×10⁸ N/m² without the thickness:
F = k A. E is 207×10⁹ Pa as its Table 5 prints. Contact ratio and load sharing are also measured nearly without load,
where they must be the analytic ones, and the stiffness of the mesh by FE statics (``gear_statics``).
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from rigidarea.cases.case_report import Array
from rigidarea.cases.mechanism import timed
from rigidarea.cases.rigid_level import turn
from rigidarea.flexible.body import elastic_body
from rigidarea.flexible.element import Material
from rigidarea.flexible.integrate import Body, Record, Simulation
from rigidarea.flexible.mesh import Mesh
from rigidarea.shapes import involute_gear

TEETH, MODULE, ANGLE, THICKNESS = (23, 57), 2e-3, np.radians(20), 0.050
STEEL = Material(207e9, 0.29, 7800.0, THICKNESS)
K, DAMPER, SPEED, RAMP, STEP, RHO = 6e8, 0.4, 2 * np.pi * 10, 0.2, 8e-5, 0.8
ADDENDUM = 1.204778  # modules: the contact ratio is then the 1.9818 that the paper prints
STANDARD = 1.0  # modules, ISO 53
ROOT = 0.25  # modules: clearance below the mate's tip, and rounding of the rack's tip, ISO 53 profile C
REFINE = 2  # contact points a mesh edge: halves the step in slope where two edges meet
BORES = (8e-3, 15e-3)
CENTRES = MODULE * sum(TEETH) / 2
IDEAL = TEETH[0] / TEETH[1]
PITCHES = tuple(0.5 * MODULE * z for z in TEETH)  # radii
MESHES = (1.2, 0.9, 0.6, 0.45, 0.3)
STEPS = (1e-5, 2e-5, 5e-5, 8e-5, 2e-4, 4e-4, 8e-4, 1.6e-3, 3.2e-3, 6.4e-3, 1.28e-2)
DAMPERS = (0.15, 0.25, 0.4, 0.6, 1.0, 1.5, 2.0)
SETTLED = RAMP + 0.2  # s: swings decay with 2 J / damper = 33 ms
MESHED = np.pi + np.pi / TEETH[1]  # the wheel's angle, its teeth centred in mesh with the pinion's at 0
MESHING = 1 / (TEETH[0] * SPEED / (2 * np.pi))  # s, the period of the teeth: 4.35 ms
PAPER: dict[str, Any] = {
    "mean_ratio": 0.4035,
    "table_6": {
        "mesh_mm": MESHES,
        "rmse_percent": [1.1388, 0.6208, 0.3137, 0.2767, 0.2753],
        "wall_s": [48.89, 62.32, 100.28, 146.67, 219.66],
    },
    "pressure_angle_deg": 20.0,
    "contact_ratio": 1.9818,
    "damper_best": 0.4,
}


def path_of_contact(addendum: float = ADDENDUM) -> tuple[float, float]:
    """Lengths of approach and recess: from the pitch point to where the mate's, and the pinion's, tip circle ends
    the line of action."""
    recess, approach = (
        float(np.sqrt((r + addendum * MODULE) ** 2 - (r * np.cos(ANGLE)) ** 2) - r * np.sin(ANGLE))
        for r in PITCHES
    )
    return approach, recess


def analytic_contact_ratio(addendum: float = ADDENDUM) -> float:
    """Path of contact over base pitch."""
    return float(sum(path_of_contact(addendum)) / (np.pi * MODULE * np.cos(ANGLE)))


def outlines(addendum: float = ADDENDUM, tolerance: float = 1e-7, root: float = ROOT) -> tuple[Any, Any]:
    """Pinion and wheel, each about its own centre. ``root`` (modules): clearance 0.25, and this rounding."""
    pinion, wheel = (
        involute_gear(
            MODULE, z, ANGLE, addendum, addendum + ROOT, bore=b, tolerance=tolerance, rack_tip_radius=root
        )
        for z, b in zip(TEETH, BORES, strict=True)
    )
    return pinion, wheel


def bodies(
    mode: str,
    mesh_mm: float,
    *,
    damper: float = DAMPER,
    addendum: float = ADDENDUM,
    root: float = ROOT,
    refine: int = REFINE,
    modes: int = 40,
    sides: int = 2,
    cache: Path | None = None,
) -> tuple[tuple[Body, Mesh], tuple[Body, Mesh]]:
    """Pinion and wheel, teeth centred in mesh at rest, and their meshes."""
    pinion, wheel = outlines(addendum, root=root)
    keys: dict[str, Any] = {"hub": 1, "refine": refine, "modes": modes, "sides": sides, "cache": cache}
    size, at = 1e-3 * mesh_mm, (CENTRES, 0.0)
    driven: dict[str, Any] = {"anchor": at, "position": at, "angle": MESHED, "damper": damper}
    return (
        elastic_body(pinion.rings, size, STEEL, mode, anchor=(0.0, 0.0), drive=(0.0, SPEED, RAMP), **keys),
        elastic_body(wheel.rings, size, STEEL, mode, **driven, **keys),
    )


def simulation(
    mode: str, mesh_mm: float, contact: str = "area", *, k: float = K, q: float = 1.0, **keys: Any
) -> Simulation:
    """The gearbox; ``keys`` go to ``bodies``."""
    (a, _), (b, _) = bodies(mode, mesh_mm, **keys)
    scheme: dict[str, Any] = {"reach": 5e-4, "margin": 5e-5, "rho": RHO, "depth_limit": 0.25 * MODULE}
    return Simulation([a, b], [(0, 1)], k=k, q=q, contact=contact, **scheme)


def through_hook(duration: float, addendum: float = ADDENDUM) -> Record:
    """The rigid level: exact flanks, through the pymunk hook."""

    def speed(t: float) -> float:
        return SPEED * min(t / RAMP, 1.0)

    density = STEEL.density * THICKNESS
    gears, at, angles = outlines(addendum), (CENTRES, 0.0), (0.0, MESHED)
    return turn(*gears, at, density, angles, speed, K, DAMPER, duration, STEP)


def measure(r: Record, addendum: float = ADDENDUM) -> dict[str, Any]:
    """From the end of the ramp: ratio (Eq. 42), pressure angle, pairs in contact, transmission error, peak to peak
    along the line of action; and that error from SETTLED on, without what the ramp's end has set swinging."""
    steady = r.t >= RAMP
    ratio = -r.hub_rate[steady, 1] / r.hub_rate[steady, 0]
    force = r.force[steady]
    turned = r.hub[steady] - r.hub[0]
    error = (turned[:, 1] + turned[:, 0] * IDEAL) * 0.5 * MODULE * TEETH[1]
    settled = r.t[steady] >= SETTLED

    def along(way: Array) -> float:
        return 1e6 * float(np.ptp(way) * np.cos(ANGLE))

    return {
        "mean_ratio": float(ratio.mean()),
        "ratio_rmse_percent": 100 * float(np.sqrt(np.mean((ratio - IDEAL) ** 2))) / IDEAL,
        **pressure_angles(r.regions[steady], force, addendum),
        "pairs_in_contact_loaded": float((r.regions[steady, :, 0] > 0).sum(1).mean()),
        "transmission_error_um": along(error),
        "transmission_error_settled_um": along(error[settled]) if settled.any() else None,
        "force_mean_n": float(np.hypot(*force.T).mean()),
        "newton_iterations_mean": float(r.iterations.mean()),
        "steps_halved": int(r.halved.sum()),
    }


def leading_pair(regions: Array) -> Array:
    """Pressure angle (degrees) of the pair that carries most, each instant (n,); not a number without contact."""
    most = regions[np.arange(len(regions)), regions[:, :, 0].argmax(1)]
    return np.where(most[:, 0] > 0, np.degrees(np.arctan2(most[:, 1], most[:, 2])), np.nan)


def pressure_angles(regions: Array, resultant: Array, addendum: float = ADDENDUM) -> dict[str, Any]:
    """Means by every definition: of the leading pair, of the resultant, and over pairs (all, weighted by force,
    those between the ends of the path of contact, those that carry more than 0.4 of the load)."""
    force = regions[:, :, 0]
    angle = np.degrees(np.arctan2(regions[:, :, 1], regions[:, :, 2]))
    along = (regions[:, :, 3] - PITCHES[0]) * np.sin(ANGLE) + regions[:, :, 4] * np.cos(ANGLE)
    approach, recess = path_of_contact(addendum)
    on = force > 0
    inside = on & (along > -approach) & (along < recess)
    carrying = force > 0.4 * np.maximum(force.sum(1, keepdims=True), 1e-300)
    touching = on.any(1)
    whole = np.degrees(np.arctan2(*resultant[touching].T))
    out: dict[str, Any] = {}
    for name, values in (
        ("", leading_pair(regions[touching])),
        ("_resultant", whole),
        ("_all_pairs", angle[on]),
        ("_on_path", angle[inside]),
        ("_carrying_pairs", angle[carrying]),
    ):
        out[f"pressure_angle{name}_mean_deg"] = float(values.mean()) if len(values) else None
        out[f"pressure_angle{name}_std_deg"] = float(values.std()) if len(values) else None
    if on.any():
        out["pressure_angle_force_weighted_mean_deg"] = float((angle * force)[on].sum() / force.sum())
    return out


def mesh_sweep(
    mode: str, contact: str, duration: float, addendum: float, refine: int, cache: Path | None
) -> Iterator[dict[str, Any]]:
    """One row a mesh of Table 6."""
    for m in MESHES:
        start = time.perf_counter()
        sim = simulation(mode, m, contact, addendum=addendum, refine=refine, cache=cache)
        seconds = time.perf_counter() - start
        record, run = timed(partial(sim.run, duration, STEP))
        yield {"mesh_mm": m, **measure(record, addendum), **run, "setup_s": seconds}


# name, settings of the simulation
VARIANTS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("fine profile", {}),
    ("chord direction (q = 0)", {"q": 0.0}),
    ("q = 2", {"q": 2.0}),
    ("k / 4", {"k": K / 4}),
    ("4 k", {"k": 4 * K}),
    ("16 k", {"k": 16 * K}),
    ("256 k", {"k": 256 * K}),
    ("addendum 1.0", {"addendum": 1.0}),
    ("addendum 1.1", {"addendum": 1.1}),
    ("sharp root", {"root": 0.05}),
    ("round root", {"root": 0.36}),
    ("damper / 2", {"damper": DAMPER / 2}),
)


def variant(name: str, keys: dict[str, Any], contact: str, duration: float) -> dict[str, Any]:
    """One change of what the paper leaves open, on flanks sampled ten points a mesh edge; rigid, as no figure
    here depends on the steel's flexibility. Stiff contacts get steps in proportion to their period."""
    h = STEP / max(1.0, np.sqrt(keys.get("k", K) / K) / 4)
    record = simulation("rigid", 0.6, contact, refine=10, **keys).run(duration, h)
    addendum = keys.get("addendum", ADDENDUM)
    return {
        "variant": name,
        "contact_ratio_analytic": analytic_contact_ratio(addendum),
        "step_s": h,
        **measure(record, addendum),
    }
