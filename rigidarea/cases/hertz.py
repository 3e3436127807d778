"""Two cylinders pressed together (the paper's section 3.1, Fig. 4 and 5), and what it does not do: predict them.

Calibrated, as in the paper: rigid discs overlap until their intersection is 2 a wide, k = F/A, q = 1/2, and the
pressure comes from Alg. 3. Both readings of the paper's numbers are run: its Eq. 27–29 as written (R* = R/2,
a = 0.6808 m) and the a = 0.97 m it prints (R* = R). "Nodes" are taken as boundary nodes of a disc.

Predicted: elastic discs (plane strain), stiff contact, no calibration; half-width and peak come from a fit of
p² = p₀² (1 − x²/a²) to the contact pressure. Hertz neglects tangential displacements, which at these loads
(p₀/E = 4.7 %) narrow the contact by 2 %: the comparison uses his kinematics (``along`` in ``statics.solve``), the
full kinematics stand beside it.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from rigidarea.cases.case_report import BLACK, BLUE, GREEN, ORANGE, RED, SKY, Array, Case, figure, save, say
from rigidarea.flexible import nodal
from rigidarea.flexible.boundary import Boundary, build, workspace
from rigidarea.flexible.boundary_regions import arcs
from rigidarea.flexible.element import Material
from rigidarea.flexible.mesh import triangulate
from rigidarea.flexible.modes import reduce
from rigidarea.flexible.recover import Shape, State
from rigidarea.flexible.statics import solve

RADIUS, YOUNG, POISSON, FORCE = 8.0, 200.0, 0.3, 10.0
MODULUS = YOUNG / (2 * (1 - POISSON**2))  # Eq. 28
STIFF = 1e2 * MODULUS  # predicted: penetration p/k is 1/200 of the approach; 10 times more changes a by 0.1 %
PAPER: dict[str, Any] = {
    "p_max_pa": 6.59,
    "p_max_theory_pa": 6.61,
    "half_width_m": 0.97,
    "p_max_error_percent": 0.37,
}


def half_width(radius: float) -> float:
    """Eq. 29 for an equivalent radius R*."""
    return float(np.sqrt(4 * FORCE * radius / (np.pi * MODULUS)))


def calibrated(nodes: int, a: float) -> dict[str, Any]:
    """The paper's benchmark for discs of ``nodes`` boundary nodes: pressures of its Alg. 3 and of the balanced one."""
    t = 2 * np.pi * np.arange(nodes) / nodes
    ring = RADIUS * np.column_stack([np.cos(t), np.sin(t)])
    disc = build([ring])
    wa, wb = workspace(disc), workspace(disc)
    s = nodal.scratch(2 * nodes)
    none = np.zeros(0)
    # a node of each disc on the line of centres
    pose_a = np.array([0.0, 0.0, 0.0, 1.0])
    pose_b = np.array([0.0, 2 * np.sqrt(RADIUS**2 - a**2), 0.0, -1.0])
    pairs = nodal.search(disc, pose_a, disc, pose_b, 0.0, s)
    nodal.contact(disc, wa, pose_a, none, disc, wb, pose_b, none, pairs, 1, 1.0, 0.5, True, s)
    region = s.regions[0].copy()
    k = FORCE / region["area"]  # Eq. 33
    n_a, n_b = arcs(region, s)
    arc = np.column_stack([s.x[0, : n_a + 1], s.y[0, : n_a + 1]])
    other = np.column_stack([s.x[1, : n_b + 1], s.y[1, : n_b + 1]])
    normal, distance, _, weight = nodal.literal(arc, other, 0.5)
    centroid = np.array([0.5 * region["chord"], 0.0])
    # in the chord frame the force on A points to +y
    normal_a = -normal * np.sign(normal[:, 1:2]) * -1.0
    alpha = nodal.literal_alpha(normal_a, weight, arc[1:-1], centroid, np.array([0.0, k * region["area"]]))
    inside = wa.pressure > 0
    return {
        "nodes": nodes,
        "half_width_m": 0.5 * float(region["chord"]),
        "force_n": k * float(region["area"]),
        "x": arc[1:-1, 0] - 0.5 * region["chord"],
        "pressure": alpha * np.sqrt(distance),
        "x_balanced": wa.position[inside, 0],
        "pressure_balanced": k * wa.pressure[inside],
    }


def graded_ring(fine: float, shift: float, top: bool) -> Array:
    """A disc's boundary, spacing ``fine`` around the contact point (top or bottom) and coarser away from it."""
    angle, step = [shift * fine / RADIUS], fine / RADIUS
    while angle[-1] < 1.5 * half_width(0.5 * RADIUS) / RADIUS:
        angle.append(angle[-1] + step)
    while angle[-1] + 0.5 * step < np.pi - 0.5 * step:
        step = min(step * 1.1, 0.12)
        angle.append(angle[-1] + step)
    half = np.array(angle[:-1])
    t = np.concatenate([-half[:0:-1] if shift == 0 else -half[::-1], half]) + (0.5 if top else -0.5) * np.pi
    return RADIUS * np.column_stack([np.cos(t), np.sin(t)])


def discs(division: int, cache: Path | None = None) -> tuple[tuple[Shape, Boundary], tuple[Shape, Boundary]]:
    """Two elastic discs, a/division the node spacing in the contact, meshes not matching."""
    made = []
    for shift, top in ((0.0, True), (0.5, False)):
        ring = graded_ring(half_width(0.5 * RADIUS) / division, shift, top)
        mesh = triangulate([ring], growth=0.12, max_size=1.0)
        material = Material(YOUNG, POISSON, 1.0, 1.0, "strain")
        reduced = reduce(mesh, material, cache=cache)
        boundary = build([ring - reduced.centre], flexibility=reduced.how_it_yields)
        made.append((Shape(mesh, material, (0,), None, None, reduced), boundary))
    return made[0], made[1]


def pressed(
    division: int, approach: float, cache: Path | None = None
) -> tuple[tuple[State, State], tuple[Array, Array]]:
    """Both discs of ``predicted`` at an approach (length): their states, stresses among them, and contact loads."""
    (shape_a, a), (shape_b, b) = discs(division, cache)
    solution = solve(a, (0, 0, 0), b, (0, 2 * RADIUS - approach, 0), STIFF, (0.0, 1.0))
    states, loads = [], []
    for shape, at, force in zip(
        (shape_a, shape_b), (0.0, 2 * RADIUS - approach), solution.loads, strict=True
    ):
        on = np.flatnonzero(np.hypot(*force.T))
        load = np.column_stack([on, force[on]])
        u = shape.displacement(np.zeros(0), load)
        states.append(State(shape, np.array([0.0, at, 0.0]), u, shape.stress(u)))
        loads.append(load)
    return (states[0], states[1]), (loads[0], loads[1])


def predicted(division: int, full: bool = False, cache: Path | None = None) -> dict[str, Any]:
    """Full FE statics under the force F; half-width and peak pressure against Hertz."""
    (_, a), (shape, b) = discs(division, cache)
    along = None if full else (0.0, 1.0)

    def press(approach: float):  # type: ignore[no-untyped-def]
        return solve(a, (0, 0, 0), b, (0, 2 * RADIUS - approach, 0), STIFF, along)

    # secant on the approach; the force is smooth and nearly linear in it
    d0, d1 = 0.17, 0.19
    f0, s = press(d0).force[1] - FORCE, press(d1)
    while abs(s.force[1] - FORCE) > 1e-6 * FORCE:
        f1 = s.force[1] - FORCE
        d0, d1, f0 = d1, d1 - f1 * (d1 - d0) / (f1 - f0), f1
        s = press(d1)
    theory = half_width(0.5 * RADIUS)
    peak = 2 * FORCE / (np.pi * theory)
    x, keep = s.position[:, 0], s.pressure > 0.3 * peak  # the rim of the contact is blurred by the mesh
    slope, square = np.polyfit(x[keep] ** 2, s.pressure[keep] ** 2, 1, w=np.sqrt(s.weight[keep]))
    width, top = np.sqrt(-square / slope), np.sqrt(square)
    exact = peak * np.sqrt(np.maximum(1 - (x / theory) ** 2, 0))
    off = np.sqrt((s.weight @ (s.pressure - exact) ** 2) / (s.weight @ exact**2))
    return {
        "division": division,
        "nodes": len(shape.mesh.points),
        "approach_m": float(d1),
        "half_width_m": float(width),
        "p_max_pa": float(top),
        "half_width_error_percent": 100 * float(width / theory - 1),
        "p_max_error_percent": 100 * float(top / peak - 1),
        "pressure_error_percent": 100 * float(off),  # root mean square over the contact
        "x": x,
        "pressure": s.pressure,
    }


COUNTS = (250, 500, 1000, 2000, 5000, 10000)  # boundary nodes of a disc; the paper: 500, 1000, 5000


def mesh_study(a: float) -> tuple[dict[str, Any], dict[int, dict[str, Any]]]:
    """The calibrated benchmark on all meshes for one half-width (Fig. 5), with fitted orders; and its curves."""
    peak = 2 * FORCE / (np.pi * a)  # Eq. 31
    curves = {n: calibrated(n, a) for n in COUNTS}
    rows = [
        {
            "nodes": n,
            "element_m": 2 * RADIUS * np.sin(np.pi / n),
            "half_width_m": c["half_width_m"],
            "force_n": c["force_n"],
            "p_max_pa": float(c["pressure_balanced"].max()),
            "p_max_error_percent": 100 * abs(float(c["pressure_balanced"].max()) / peak - 1),
            "p_max_pa_literal": float(c["pressure"].max()),
            "p_max_error_percent_literal": 100 * abs(float(c["pressure"].max()) / peak - 1),
        }
        for n, c in curves.items()
    ]
    # circles are no parabolas: the error has a floor of order (a/R)², so orders are fitted to each one's own limit
    order = {}
    for kind in ("", "_literal"):
        value = np.array([r["p_max_pa" + kind] for r in rows])
        h = np.array([r["element_m"] for r in rows[:4]])
        order["order" + kind] = float(np.polyfit(np.log(h), np.log(np.abs(value[:4] - value[-1])), 1)[0])
    return {"half_width_theory_m": a, "p_max_theory_pa": peak, "meshes": rows, **order}, curves


def predicted_order(studies: list[dict[str, Any]]) -> float:
    """Fitted order, in the element size, of the error of the FE statics' whole pressure profile."""
    h = np.log([1.0 / s["division"] for s in studies])
    return float(np.polyfit(h, np.log([s["pressure_error_percent"] for s in studies]), 1)[0])


def run(
    out: Path | None = None, divisions: tuple[int, ...] = (4, 8, 16, 32), cache: Path | None = None
) -> dict[str, Any]:
    """Both readings, calibrated and predicted; figures 4 and 5 redrawn into ``out``."""
    settings = {
        "radius_m": RADIUS,
        "young_pa": YOUNG,
        "poisson": POISSON,
        "force_n": FORCE,
        "q": 0.5,
        "stiffness_predicted_pa_per_m": STIFF,
        "divisions": list(divisions),
    }
    case = Case("hertz", settings, PAPER, 0.0, out)
    readings: dict[str, Any] = {}
    curves: dict[Any, Any] = {}
    for name, radius in (("equations", 0.5 * RADIUS), ("printed", RADIUS)):
        readings[name], found = mesh_study(half_width(radius))
        curves |= {(name, n): c for n, c in found.items()}
    at = readings["equations"]["meshes"][COUNTS.index(5000)]
    case.keep(**{key: at[key] for key in at if key != "element_m"}, readings=readings)
    case.set_up()
    say("hertz: predicted, full FE statics")
    studies = []
    for d in divisions:
        studies.append(predicted(d, cache=cache))
        case.keep(predicted=[_numbers(s) for s in studies])
    full = predicted(divisions[min(1, len(divisions) - 1)], True, cache)
    best = studies[-1]
    case.keep(
        predicted_half_width_error_percent=best["half_width_error_percent"],
        predicted_p_max_error_percent=best["p_max_error_percent"],
        predicted_full_kinematics=_numbers(full),
        predicted_order=predicted_order(studies),
    )
    if out is not None:
        _figures(out, readings, curves, studies, case.results["predicted_order"])
    return case.finish()


def _numbers(study: dict[str, Any]) -> dict[str, Any]:
    return {k: v for k, v in study.items() if k not in ("x", "pressure")}


def _figures(
    out: Path, readings: dict[str, Any], curves: dict[Any, Any], studies: list[dict[str, Any]], order: float
) -> None:
    """Fig. 4, both readings and the prediction; Fig. 5, and the prediction's convergence."""
    fig, axes = figure(10, 4.6, 1, 2)
    x = np.linspace(-1, 1, 400)
    titles = {
        "equations": "R* = R/2, as Eq. 27 says: p_max",
        "printed": "R* = R, as the paper prints (6.61 and 6.59 Pa): p_max",
    }
    for ax, name in zip(axes, titles, strict=True):
        a, peak = readings[name]["half_width_theory_m"], readings[name]["p_max_theory_pa"]
        ax.plot(a * x, peak * np.sqrt(1 - x**2), color=SKY, lw=4, label=f"Hertz: {peak:.3f} Pa")
        for n, marker, colour, every in ((500, "o", RED, 1), (1000, "s", GREEN, 1), (5000, ".", BLACK, 3)):
            c = curves[name, n]
            look = {"color": colour, "markevery": every, "fillstyle": "none" if marker != "." else "full"}
            label = f"Alg. 3, {n} nodes: {c['pressure'].max():.3f} Pa"
            ax.plot(c["x"], c["pressure"], marker, ms=5, **look, label=label)
        ax.set(xlabel="x (m)", ylabel="contact pressure (Pa)")
        ax.set_title(titles[name], fontsize=10)
    best = studies[-1]
    label = f"predicted, FE statics: {best['p_max_pa']:.3f} Pa"
    axes[0].plot(best["x"], best["pressure"], "-", color=ORANGE, lw=1, label=label)
    for ax in axes:
        ax.legend(loc="lower center", fontsize=9)
    save(fig, out, "hertz_fig4")
    fig, (left, right) = figure(11, 5.2, 1, 2, width_ratios=(3, 2))
    for name, colour in (("equations", BLUE), ("printed", RED)):
        study = readings[name]
        h = [r["element_m"] for r in study["meshes"]]
        for kind, style, text in (("_literal", "o--", "Alg. 3 literally"), ("", "s-", "balanced")):
            errors = [r["p_max_error_percent" + kind] for r in study["meshes"]]
            label = f"{text}, a = {study['half_width_theory_m']:.3f} m, order {study['order' + kind]:.2f}"
            left.loglog(h, errors, style, color=colour, fillstyle="none" if kind else "full", label=label)
    left.axhline(0.37, color=BLACK, ls=":", label="the paper, 5000 nodes: 0.37 %")
    left.set(xlabel="element size (m)", ylabel="error of the maximum pressure (%)")
    left.set_title("calibrated; orders towards each one's own limit (circles are no parabolas)", fontsize=10)
    size = half_width(0.5 * RADIUS) / np.array([s["division"] for s in studies])
    error = np.array([s["pressure_error_percent"] for s in studies])
    right.loglog(size, error, "o-", color=BLUE, label=f"order {order:.2f}")
    right.set(xlabel="element size (m)", ylabel="RMS error of the pressure profile (%)")
    right.set_title("predicted, FE statics", fontsize=10)
    right.set_xticks(size, [f"{x:.3f}" for x in size])
    right.set_yticks([0.5, 1, 2, 5], ["0.5", "1", "2", "5"])
    right.minorticks_off()
    right.legend()
    fig.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncol=2, fontsize=9)
    save(fig, out, "hertz_fig5")
