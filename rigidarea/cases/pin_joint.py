"""A pin bouncing in a circular support (the paper's section 3.2, Fig. 7–10, Table 2).

Left open by the paper and chosen here: the support's outer radius (45 mm, its rim clamped), the time step (10 µs: 130
steps a contact), ρ∞ = 1 (no constraints, so no reason to dissipate), STS details (see ``flexible.segment``; the
pin is the slave). E is 207×10⁸ Pa as its Table 1 prints. k = 5×10⁷ N/m² without the thickness: F = k A.

Level "rigid" runs through the pymunk hook, pin and journal as arcs (`arcs_over_points`: beside points to 1e-8 m, whose
errors and time are measured); its exact answers (lens area, quadrature) are recomputed here. The other
levels, and STS at every level, run through ``flexible``. The comparison of costs times both methods at the paper's
three meshes, compliant, in one run. Common to both are the search, the recovery of the deformed points from the node
loads, and the way of loads from points to nodes and into Newton's matrix: about half of an evaluation by area. What
differs is crossings, area and one walk along two arcs against projections and Gauss points edge by edge, with one
resultant against one for every few slave edges.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pymunk
from scipy.integrate import quad
from scipy.optimize import brentq

import rigidarea
from rigidarea.cases import figures
from rigidarea.cases.case_report import BLUE, ORANGE, RED, Array, Case, figure, save, say
from rigidarea.cases.mechanism import timed
from rigidarea.flexible.body import elastic_body
from rigidarea.flexible.element import Material
from rigidarea.flexible.integrate import Simulation
from rigidarea.shapes import circle as disc
from rigidarea.shapes import ring

PIN, JOURNAL, RIM, THICKNESS, DENSITY, K, GRAVITY = 0.020, 0.035, 0.045, 0.005, 7800.0, 5e7, 9.81
STEEL = Material(207e8, 0.29, DENSITY, THICKNESS)
STEP = 1e-5
PAPER: dict[str, Any] = {
    "table_2_s": {"0.7": [21.61, 11.57], "1.0": [19.05, 9.29], "1.3": [16.57, 8.99]},
    "ratio": {"0.7": 0.535, "1.0": 0.488, "1.3": 0.543},
    "first_contact_s": 0.05,
}
STRETCHES = (5520, 140, 24340)  # steps of a compared run: to the first contact, through it, the rest of 0.3 s
REPEATS = 9  # of each run
POINTS_TOLERANCE = 1e-8  # m: points that are as near the exact answers as arcs are
PARTS = {"run_s": "run_ratio", "contact_phase_s": "contact_phase_ratio", "eval_us": "eval_ratio"}


class Course(NamedTuple):
    """A run: times (n,), frames (n, 2, 3), force on the support (n, 2)."""

    t: Array
    x: Array
    force: Array


def circle(radius: float, clockwise: bool = False, n: int = 7200) -> Array:
    """A finely sampled circle that starts at the bottom, where the contact will be."""
    t = 2 * np.pi * np.arange(n) / n * (-1 if clockwise else 1) - 0.5 * np.pi
    return radius * np.column_stack([np.cos(t), np.sin(t)])


def exact() -> dict[str, float]:
    """δ_max, F_max, contact time and period of the rigid bodies with F = k A, by the lens area and quadrature."""
    mass = DENSITY * THICKNESS * np.pi * PIN**2
    play = JOURNAL - PIN

    def area(depth: float) -> float:
        """Pin minus journal, centres play + depth apart: the pin's disc less the lens it shares with the bore."""
        d = play + depth
        if depth <= 0:
            return 0.0
        x = (d * d + PIN**2 - JOURNAL**2) / (2 * d)
        half_p, half_j = np.arccos(x / PIN), np.arccos((d - x) / JOURNAL)
        lens = PIN**2 * (half_p - np.sin(2 * half_p) / 2) + JOURNAL**2 * (half_j - np.sin(2 * half_j) / 2)
        return float(np.pi * PIN**2 - lens)

    def energy(depth: float) -> float:
        """Twice the kinetic energy over the mass at a depth, after a fall from the centre."""
        stored = quad(area, 0, depth, epsabs=1e-18, epsrel=1e-10)[0]  # of 1.5e-10 m³
        return 2 * GRAVITY * (play + depth) - 2 * K / mass * stored

    deepest = brentq(energy, 1e-5, 1e-3, xtol=1e-16)
    # substitution depth = deepest (1 − s²) takes the root's singularity away
    touch = 2 * quad(lambda s: 2 * s * deepest / np.sqrt(max(energy(deepest * (1 - s * s)), 1e-300)), 0, 1)[0]
    return {
        "penetration_max_mm": 1e3 * deepest,
        "force_max_n": K * area(deepest),
        "contact_ms": 1e3 * touch,
        "period_ms": 1e3 * (touch + 2 * np.sqrt(2 * play / GRAVITY)),
    }


def simulation(
    mesh_mm: float, level: str, contact: str, refine: int = 1, cache: Path | None = None
) -> Simulation:
    """Pin and support in the flexible stepper."""
    size = 1e-3 * mesh_mm
    keys: dict[str, Any] = {"refine": refine, "cache": cache}
    pin, _ = elastic_body([circle(PIN)], size, STEEL, level, **keys)
    rings = [circle(RIM), circle(JOURNAL, True)]
    support, _ = elastic_body(rings, size, STEEL, level, contact_rings=(1,), clamped=0, **keys)
    return Simulation(
        [pin, support], k=K, contact=contact, reach=5e-4, margin=2e-4, rho=1.0, gravity=(0.0, -GRAVITY)
    )


def hook_space(tolerance: float | None = None) -> tuple[Any, Any, Any]:
    """(space, pin, contact) of the rigid level: pin and journal as arcs, or as points to a tolerance (m)."""
    space = pymunk.Space()
    space.gravity = (0, -GRAVITY)
    pin_outline = disc(PIN, tolerance=tolerance)
    pin = pin_outline.body(density=DENSITY * THICKNESS)
    for outline, body in ((pin_outline, pin), (ring(JOURNAL, RIM, tolerance=tolerance), space.static_body)):
        shape = outline.add_to(body)
        shape.elasticity = 1.0
        shape.friction = 0.0
        space.add(shape) if body is space.static_body else space.add(body, shape)
    return space, pin, rigidarea.attach(space, stiffness=K)


def run_hook(duration: float, tolerance: float | None = None) -> tuple[Array, Array, Array, Array]:
    """The rigid level through the pymunk hook: time, height of the pin, upward force on it, energy as a height."""
    space, pin, contact = hook_space(tolerance)
    steps = round(duration / STEP)
    y, v, level = np.empty(steps), np.empty(steps + 1), np.empty(steps)
    v[0] = 0.0
    for i in range(steps):
        space.step(STEP)
        y[i], v[i + 1], level[i] = pin.position.y, pin.velocity.y, 0.5 * pin.velocity.length**2 / GRAVITY
    contact.detach()
    return STEP * np.arange(1.0, steps + 1.0), y, pin.mass * (np.diff(v) / STEP + GRAVITY), level + y


def beside_points() -> dict[str, Any]:
    """The rigid level as arcs beside the same as points to `POINTS_TOLERANCE`: errors of the points, ratios of time.

    Processor time of a run of 0.3 s, and of its first contact, in machine code; the median of REPEATS ratios, arcs and
    points in turn.
    """
    ratios = []
    for _ in range(REPEATS + 1):
        spent = []
        for kind in (None, POINTS_TOLERANCE):
            _, _, contact = hook_space(kind)
            spent.append([timed(partial(contact.step, STEP, n))[1]["run_cpu_s"] for n in STRETCHES])
            contact.detach()
        ratios.append((sum(spent[0]) / sum(spent[1]), spent[0][1] / spent[1][1]))
    whole, touching = np.median(ratios[1:], axis=0)
    measured = measure(*run_hook(0.3, POINTS_TOLERANCE))
    return {
        "tolerance_m": POINTS_TOLERANCE,
        "run_ratio": float(whole),
        "contact_phase_ratio": float(touching),
        "points_error_percent": {k: 100 * (measured[k] / v - 1) for k, v in exact().items()},
    }


def measure(t: Array, y: Array, force: Array, level: Array) -> dict[str, float]:
    """First contact: deepest point, largest force, duration; period; drift of the rebound height over all bounces.

    Between samples: parabolas through extremes, straight lines through the crossing of the touching height. ``level``
    is the height that the pin's mechanical energy reaches, y + v²/2g: a pin dropped from the centre of a
    bowl is on an unstable orbit (it gathers sideways motion from any asymmetry), which is no loss.
    """

    def peak(values: Array, i: int) -> tuple[float, float]:
        a, b, c = values[i - 1], values[i], values[i + 1]
        s = 0.5 * (a - c) / (a - 2 * b + c)
        return b - 0.25 * (a - c) * s, t[i] + s * (t[1] - t[0])

    play = JOURNAL - PIN
    under = y < -play
    below, above = np.flatnonzero(~under[:-1] & under[1:]), np.flatnonzero(under[:-1] & ~under[1:])

    def when(i: int) -> float:
        return float(t[i] + (t[i + 1] - t[i]) * (-play - y[i]) / (y[i + 1] - y[i]))

    first = slice(below[0], above[0] + 2)
    low = below[0] + int(np.argmin(y[first]))
    strong = below[0] + int(np.argmax(force[first]))
    top = above[0] + int(np.argmax(y[above[0] : below[1]]))
    heights = []
    for a, b in zip(above, [*below[1:], len(y)], strict=False):
        if b - a > 10:
            heights.append(float(np.median(level[a + 2 : b - 1])) + play)  # in flight it is constant
    return {
        "penetration_max_mm": 1e3 * (-peak(y, low)[0] - play),
        "force_max_n": peak(force, strong)[0],
        "contact_ms": 1e3 * (when(above[0]) - when(below[0])),
        "period_ms": 1e3 * peak(y, top)[1],
        "rebound_drift_percent": 100 * float(np.abs(np.array(heights) / play - 1).max()),
        "bounces": len(heights),
    }


def compare(mesh_mm: float, level: str, cache: Path | None) -> dict[str, Any]:
    """Area and STS on one mesh: a whole run of 0.3 s, one contact, one contact evaluation; how far the forces differ.

    ``run_ratio_of_free_contact``: a whole run over that of STS, did its contact cost nothing: what evaluations out of
    contact leave to be gained. Processor time of REPEATS runs of each in turn, and the median of their ratios: whoever
    else works on the machine slows both alike.
    """
    row: dict[str, Any] = {"mesh_mm": mesh_mm}
    curves: dict[str, Course] = {}
    spent: dict[str, list[float]] = {f"{c}_{what}": [] for c in ("area", "sts") for what in PARTS}
    for turn in range(REPEATS + 1):  # the first compiles, or loads from the cache
        for contact in ("area", "sts") if turn % 2 else ("sts", "area"):
            sim = simulation(mesh_mm, level, contact, cache=cache)
            made = [timed(partial(sim.run, n * STEP, STEP)) for n in STRETCHES]
            records, cpu = [r for r, _ in made], [s["run_cpu_s"] for _, s in made]
            touching = records[1].x[records[1].force[:, 1] != 0]
            if turn > 0:
                spent[f"{contact}_run_s"].append(sum(cpu))
                spent[f"{contact}_contact_phase_s"].append(cpu[1])
                spent[f"{contact}_eval_us"].append(1e6 * sim.contact_seconds(touching, 5))
            curves[contact] = Course(
                *(np.concatenate(c) for c in zip(*[(r.t, r.x, r.force) for r in records], strict=True))
            )
            row[f"{contact}_iterations_mean"] = float(np.concatenate([r.iterations for r in records]).mean())
            row[f"{contact}_evaluations"] = sum(r.evaluations for r in records)
            row[f"{contact}_contact_evaluations"] = records[1].evaluations
    a, s = curves["area"], curves["sts"]
    first = slice(STRETCHES[0], STRETCHES[0] + STRETCHES[1])
    row["force_rms_percent"] = 100 * float(
        np.sqrt(np.mean((a.force[first, 1] - s.force[first, 1]) ** 2)) / np.abs(s.force[first, 1]).max()
    )
    row |= {name: float(np.median(values)) for name, values in spent.items()}
    for what, name in PARTS.items():
        ratio = np.array(spent[f"area_{what}"]) / np.array(spent[f"sts_{what}"])
        row[name], row[f"{name}_range"] = float(np.median(ratio)), [float(ratio.min()), float(ratio.max())]
    share = np.array(spent["sts_contact_phase_s"]) / np.array(spent["sts_run_s"])
    row["run_ratio_of_free_contact"] = 1.0 - float(np.median(share))
    row["curves"] = curves
    return row


def run(
    mode: str = "rigid",
    mesh_mm: float = 1.0,
    contact: str = "area",
    out: Path | None = None,
    cache: Path | None = None,
    duration: float = 1.2,
) -> dict[str, Any]:
    """Ten bounces at one level, beside the exact rigid answers; then area and STS on the paper's three meshes."""
    settings = {
        "mode": mode,
        "mesh_mm": mesh_mm,
        "contact": contact,
        "step_s": STEP,
        "duration_s": duration,
        "k": K,
        "young_pa": STEEL.young,
        "rim_radius_mm": 1e3 * RIM,
    }
    case = Case("pin-joint", settings, PAPER, duration, out)
    reference = exact()
    if mode == "rigid" and contact == "area":
        case.set_up()
        t, y, force, level = run_hook(duration)
    else:
        sim = simulation(mesh_mm, mode, contact, refine=4, cache=cache)
        case.set_up()
        r = sim.run(duration, STEP)
        t, y, force = r.t, r.x[:, 0, 1], -r.force[:, 1]
        level = y + 0.5 * (r.v[:, 0, :2] ** 2).sum(1) / GRAVITY
    measured = measure(t, y, force, level)
    say("pin-joint: area and STS at 0.7, 1.0, 1.3 mm")
    rows = [compare(m, "compliant" if mode == "rigid" else mode, cache) for m in (0.7, 1.0, 1.3)]
    case.results = {
        **measured,
        "contact_eval_s": 1e-6 * rows[1]["area_eval_us"],
        "exact_rigid": reference,
        "error_percent": {k: 100 * (measured[k] / v - 1) for k, v in reference.items()},
        "arcs_over_points": beside_points(),
        "comparison": [{k: v for k, v in row.items() if k != "curves"} for row in rows],
    }
    if out is not None:
        _figures(out, rows, mode, cache)
    return case.finish()


def _figures(out: Path, rows: list[dict[str, Any]], mode: str, cache: Path | None) -> None:
    level = "compliant" if mode == "rigid" else mode
    fig, axes = figure(11, 9, 3, 2, sharex=True, sharey=True)
    for pair, row in zip(axes, rows, strict=True):
        for ax, contact in zip(pair, ("sts", "area"), strict=True):
            r = row["curves"][contact]
            deepest = int(np.argmin(r.x[:6000, 0, 1]))
            sim = simulation(row["mesh_mm"], level, contact, cache=cache)
            sim.run((deepest + 1) * STEP, STEP)
            for i, colour, name in ((0, RED, "pin"), (1, BLUE, "support")):
                w = sim.works[i]
                near = np.flatnonzero(w.position_stamp >= sim._buffers.counts[1] - 1)
                near = near[np.argsort(w.position[near, 0])]
                near = near[(np.abs(w.position[near, 0]) < 0.009) & (w.position[near, 1] < -0.025)]
                ax.plot(*(1e3 * w.position[near]).T, ".-", ms=3, lw=0.8, color=colour)
                label = f"{name}: Σ = {np.hypot(*figures.loads(w)[1].sum(0)):.2f} N"
                figures.arrows(ax, w, color=colour, scale=90, width=0.003, label=label)
            ax.set(xlim=(-8, 8), ylim=(-38, -32))
            ax.set_title(f"{'STS' if contact == 'sts' else 'area'}, {row['mesh_mm']} mm")
            ax.legend(loc="upper center", ncol=2, fontsize=8)
    for ax in axes[-1]:
        ax.set_xlabel("x (mm)")
    for ax in axes[:, 0]:
        ax.set_ylabel("y (mm)")
    fig.suptitle("Nodal forces at the deepest penetration (arrows to one scale)")
    save(fig, out, "pin_joint_fig7_8")
    area, sts = (rows[1]["curves"][c] for c in ("area", "sts"))
    fig, ax = figure()
    first = slice(5500, 5700)
    ax.plot(1e3 * area.t[first], -area.force[first, 1], color=BLUE, lw=2, label="area")
    ax.plot(1e3 * sts.t[first], -sts.force[first, 1], "--", color=ORANGE, label="STS")
    ax.set(xlabel="time (ms)", ylabel="contact force (N)", title=f"{level}, 1.0 mm")
    ax.legend()
    save(fig, out, "pin_joint_fig9")
    fig, ax = figure()
    ax.plot(area.t, 1e3 * area.x[:, 0, 1], color=BLUE, lw=2, label="area")
    ax.plot(sts.t, 1e3 * sts.x[:, 0, 1], "--", color=ORANGE, label="STS")
    ax.set(xlabel="time (s)", ylabel="height of the pin (mm)")
    ax.legend()
    save(fig, out, "pin_joint_fig10")
    fig, axes = figure(11, 4.2, 1, 3)
    x = np.arange(3)
    kinds = (
        ("run_s", "run_ratio", "whole run of 0.3 s (s)"),
        ("contact_phase_s", "contact_phase_ratio", "one contact, 1.4 ms (s)"),
        ("eval_us", "eval_ratio", "one contact evaluation (µs)"),
    )
    for ax, (key, ratio, label) in zip(axes, kinds, strict=True):
        for k, (name, colour) in enumerate((("sts", ORANGE), ("area", BLUE))):
            heights = [row[f"{name}_{key}"] for row in rows]
            ax.bar(x + 0.35 * (k - 0.5), heights, 0.33, color=colour, label=name)
        for i, row in enumerate(rows):
            top = max(row[f"area_{key}"], row[f"sts_{key}"])
            told = f"{row[ratio]:.2f}\n(paper {PAPER['ratio'][str(row['mesh_mm'])]:.2f})"
            ax.text(i, 1.02 * top, told, ha="center", fontsize=8)
        ax.set(xticks=x, xticklabels=[f"{r['mesh_mm']} mm" for r in rows], ylabel=label, xlabel="mesh")
        ax.margins(y=0.2)
    axes[1].legend(loc="upper right", bbox_to_anchor=(1.0, 0.9))
    save(fig, out, "pin_joint_table2")
