"""The paper's Fig. 21–28 and Table 6 redrawn from the gearbox's runs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse.linalg as spl

from rigidarea.cases import figures, gear_statics
from rigidarea.cases import gearbox as gb
from rigidarea.cases.case_report import (
    BLACK,
    BLUE,
    FRAMED,
    GREEN,
    ORANGE,
    RED,
    SKY,
    YELLOW,
    Array,
    figure,
    save,
)
from rigidarea.flexible.element import stiffness
from rigidarea.flexible.integrate import Record, Simulation
from rigidarea.flexible.mesh import Mesh
from rigidarea.flexible.modes import carriers, hub_rows

NAMES = ("pinion", "wheel")


def draw(
    out: Path, results: dict[str, Any], records: dict[str, Record], steps: dict[float, Record], mesh_mm: float,
    cache: Path | None,
) -> None:  # fmt: skip
    """All figures; ``results``, ``records`` and those of its sweep of ``steps`` are ``gearbox_run.run``'s."""
    made = gb.bodies("compliant", mesh_mm, cache=cache)
    sim = gb.simulation("compliant", mesh_mm, cache=cache)
    _configuration(out, sim)
    _speeds(out, records["main"], results)
    _pressure_angle(out, records, results)
    _load_sharing(out)
    r = _three_pairs(sim)
    _displacements(out, sim, (made[0][1], made[1][1]), r)
    fig, ax = figure(8.4, 8)
    figures.nodal_forces(ax, sim, NAMES, 1e3 * r[r[:, 0].argmax(), 3:5], 1.2)
    ax.set_title(f"nodal forces of the pair that carries most, t = {sim.time:.3f} s, mesh {mesh_mm:g} mm")
    save(fig, out, "gearbox_fig24")
    _dampers(out, results["dampers"])
    _meshes(out, results)
    _variants(out, results["variants"])
    figures.step_cost(
        out,
        "gearbox_step_cost",
        results["steps"],
        0.5,
        ("a tooth to mesh", gb.MESHING),
        ("ratio_rmse_percent", "RMSE of the ratio (%)"),
        (0, 0.8),
    )
    figures.iteration_history(out, "gearbox_fig28", {h: steps[h] for h in (5e-5, 8e-5)}, 0.5)


def _configuration(out: Path, sim: Simulation) -> None:
    """Fig. 21."""
    fig, ax = figure(10, 7.4)
    for i, (colour, at) in enumerate(((GREEN, 0.0), (BLACK, gb.CENTRES))):
        ax.fill(*figures.perimeter(sim, i).T, facecolor=colour, alpha=0.12)
        label = f"{NAMES[i]}, {gb.TEETH[i]} teeth, pitch radius {1e3 * gb.PITCHES[i]:g} mm"
        ax.plot(*figures.perimeter(sim, i).T, color=colour, lw=1.3, label=label)
        figures.bore(ax, (at, 0.0), gb.BORES[i], colour)
        ax.plot(1e3 * at, 0, "+", color=colour, ms=9)
    ax.set_title(f"t = 0; module {1e3 * gb.MODULE:g} mm, addendum {gb.ADDENDUM:.4f} modules")
    figures.equal(ax)
    fig.legend(loc="outside lower center", ncol=2)
    save(fig, out, "gearbox_fig21")


def _speeds(out: Path, r: Record, results: dict[str, Any]) -> None:
    """Fig. 25, and the ratio in its steady state."""
    fig, (top, bottom) = figure(10, 6.4, 2, 1, height_ratios=(3, 2))
    top.plot(r.t, r.hub_rate[:, 0], color=BLUE, label="pinion")
    top.plot(r.t, -r.hub_rate[:, 1], color=RED, label="wheel (turns the other way)")
    top.set(xlabel="time (s)", ylabel="angular velocity (rad/s)")
    top.legend(loc="lower right")
    steady = r.t >= gb.RAMP
    ratio = -r.hub_rate[steady, 1] / r.hub_rate[steady, 0]
    ours = f"ours: mean {results['mean_ratio']:.6f}, RMSE {results['ratio_rmse_percent']:.4f} %"
    ideal = f"23/57 = {gb.IDEAL:.6f} (the paper: mean 0.4035, RMSE 0.3137 %)"
    bottom.plot(r.t[steady], ratio, color=BLUE, lw=0.8, label=ours)
    bottom.axhline(gb.IDEAL, color=BLACK, ls="--", label=ideal)
    bottom.set(xlabel="time (s)", ylabel="ratio of speeds")
    bottom.set(xlim=(0.2, 0.5), ylim=(gb.IDEAL - 0.004, gb.IDEAL + 0.006))
    bottom.legend(loc="upper left", ncol=2, fontsize=9)
    save(fig, out, "gearbox_fig25")


def _pressure_angle(out: Path, records: dict[str, Record], results: dict[str, Any]) -> None:
    """Fig. 26, for both readings of the teeth."""
    fig, axes = figure(10, 7, 2, 1, sharex=True, sharey=True)
    rows = (
        ("main", results, f"contact ratio {results['contact_ratio_analytic']:.2f}, the paper's"),
        ("standard", results["standard_teeth"], "standard teeth, contact ratio 1.68"),
    )
    for ax, (key, row, title) in zip(axes, rows, strict=True):
        r = records[key]
        on = np.hypot(*r.force.T) > 0
        resultant = np.degrees(np.arctan2(r.force[on, 0], r.force[on, 1]))
        for values, colour, name, mark in (
            (resultant, ORANGE, "resultant", "_resultant"),
            (gb.leading_pair(r.regions[on]), BLUE, "leading pair", ""),
        ):
            mean, std = (row[f"pressure_angle{mark}_{k}_deg"] for k in ("mean", "std"))
            label = f"{name}: {mean:.2f} ± {std:.2f}° from 0.2 s"
            ax.plot(r.t[on], values, ".", ms=1.5, color=colour, label=label)
        ax.axhline(20, ls="--", color=BLACK, label="nominal")
        ax.set(ylabel="pressure angle (°)", ylim=(15, 25), title=title)
        ax.legend(loc="lower right", ncol=3, markerscale=6, **FRAMED, fontsize=9)
    axes[1].set_xlabel("time (s)")
    save(fig, out, "gearbox_fig26")


def _load_sharing(out: Path) -> None:
    fig, axes = figure(10, 6.6, 2, 1, sharex=True, sharey=True)
    for ax, addendum in zip(axes, (gb.ADDENDUM, gb.STANDARD), strict=True):
        row, light = gear_statics.light_load(addendum)
        x = np.array(light["angle"]) * gb.TEETH[0] / (2 * np.pi)
        ax.step(x, light["pairs"], where="mid", color=BLUE, label="pairs in contact")
        ax.plot(x, light["share_analytic"], "-", lw=4, color=YELLOW, label="largest share, analytic")
        ax.plot(x, light["share"], ".", ms=4, color=BLACK, label="largest share of the load")
        ax.set(
            ylabel="pairs, share",
            ylim=(0, 2.6),
            title=f"addendum {addendum:.5g} modules, vanishing load: contact ratio {row['contact_ratio']:.3f},"
            f" analytic {row['contact_ratio_analytic']:.4f}",
        )
        ax.legend(ncol=3, loc="upper center", fontsize=9)
    axes[1].set_xlabel("pinion angle (pitches)")
    save(fig, out, "gearbox_load_sharing")


def _three_pairs(sim: Simulation) -> Array:
    """Runs into the steady state, to an instant with three pairs in contact; its regions, the loaded ones."""
    r = sim.run(0.3, gb.STEP)
    for _ in range(200):
        force = np.sort(r.regions[-1, :, 0])[::-1]
        # a record has room for the most that it saw at once
        if len(force) > 2 and force[2] > 0.15 * force[0]:
            break
        r = sim.run(gb.STEP, gb.STEP)
    now = r.regions[-1]
    return np.asarray(now[now[:, 0] > 0])


def displacement(mesh: Mesh, loads: Array) -> Array:
    """Displacement (n, 2) under forces on the boundary nodes (f, 2), the hub's mean motion (RBE3) taken out.

    The hub carries their resultant, shared over its nodes by the same weights; inertia is left out.
    """
    n = 2 * len(mesh.points)
    ring = mesh.rings[1]
    rows = hub_rows(mesh.points, ring)
    arm = mesh.points - mesh.points[ring].mean(0)
    rigid = np.zeros((n, 3))
    rigid[0::2, 0] = rigid[1::2, 1] = 1.0
    rigid[0::2, 2], rigid[1::2, 2] = -arm[:, 1], arm[:, 0]
    f = np.zeros(n)
    f[: 2 * len(loads)] = loads.ravel()
    f -= rows @ np.linalg.solve(rigid.T @ rows, rigid.T @ f)
    i, j = ring[0], ring[len(ring) // 2]  # three supports, which carry nothing
    across = np.abs(mesh.points[i] - mesh.points[j]).argmin()
    free = np.setdiff1d(np.arange(n), [2 * i, 2 * i + 1, 2 * j + across])
    u = np.zeros(n)
    k = stiffness(mesh, gb.STEEL)
    u[free] = spl.spsolve(k[free][:, free].tocsc(), f[free])
    u -= rigid @ np.linalg.solve(rows.T @ rigid, rows.T @ u)
    return u.reshape(-1, 2)


def _displacements(out: Path, sim: Simulation, meshes: tuple[Mesh, Mesh], regions: Array) -> None:
    """Fig. 23."""
    fig, ax = figure(11, 8)
    ax.grid(False)
    sides = (("viridis", "left"), ("plasma", "right"))
    for i, ((colours, side), mesh) in enumerate(zip(sides, meshes, strict=True)):
        shape = sim.bodies[i].shape
        spread = carriers(mesh, shape.contact_rings, shape.sides)[: 2 * len(mesh.rings[0])]
        u = displacement(mesh, (spread @ sim.works[i].node_load.ravel()).reshape(-1, 2))
        centre = mesh.points[0] - sim.boundaries[i].points[0]
        p = figures.placed(mesh.points - centre, sim.state.x[i])
        size = 1e6 * np.hypot(*u.T)
        drawn = ax.tripcolor(*p.T, mesh.triangles, size, cmap=colours, shading="gouraud", rasterized=True)
        ax.triplot(*p.T, mesh.triangles, color="#ffffff", lw=0.25, alpha=0.6)
        bar = fig.colorbar(drawn, ax=ax, location=side, fraction=0.04, pad=0.02)
        bar.set_label(f"displacement of the {NAMES[i]} relative to its hub (µm)")
    longest = regions[:, 0].max()
    for f, nx, ny, x, y in regions:
        at = 1e3 * np.array([x, y])
        for sign, colour in ((-1, RED), (1, GREEN)):
            tip = at + sign * 5 * f / longest * np.array([nx, ny])
            arrow = {"arrowstyle": "-|>", "color": colour, "lw": 2.5, "shrinkA": 0, "shrinkB": 0}
            ax.annotate("", tip, at, arrowprops=arrow, zorder=4)
        text = f"{f:.0f} N, {np.degrees(np.arctan2(nx, ny)):.1f}°"
        paper = {"boxstyle": "round,pad=0.15", "fc": "#ffffff", "ec": "none", "alpha": 0.85}
        ax.annotate(text, at, (34, -3), textcoords="offset points", fontsize=9, bbox=paper, zorder=5)
    told = "contact forces (red: on the pinion, green: on the wheel) and pressure angles"
    ax.set(xlim=(9, 37), ylim=(-13, 13), title=f"{told}, t = {sim.time:.3f} s")
    figures.equal(ax)
    save(fig, out, "gearbox_fig23")


def _dampers(out: Path, rows: list[dict[str, Any]]) -> None:
    """Fig. 22: the paper's two means, for both definitions of the angle."""
    fig, axes = figure(10, 4.6, 1, 2, sharex=True)
    for ax, mark, name in ((axes[0], "", "leading pair"), (axes[1], "_resultant", "resultant")):
        x = [d["mean_ratio"] for d in rows]
        y = [d[f"pressure_angle{mark}_mean_deg"] for d in rows]
        ax.plot(x, y, "o-", color=BLUE, lw=1)
        for d, a, b in zip(rows, x, y, strict=True):
            ax.annotate(f"{d['damper']:g}", (a, b), xytext=(6, 4), textcoords="offset points")
            if d["damper"] == gb.DAMPER:
                label = "the paper's choice (numbers: damper in N m s/rad)"
                ax.plot(a, b, "*", ms=16, color=RED, label=label)
        ax.axhline(20, ls="--", color=BLACK)
        ax.axvline(gb.IDEAL, ls="--", color=BLACK)
        ax.ticklabel_format(useOffset=False)
        ax.locator_params(axis="x", nbins=4)
        ax.margins(0.15)
        ax.set(xlabel="mean transmission ratio", ylabel="mean pressure angle (°)")
        ax.set_title(f"angle of the {name}")
    fig.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center")
    save(fig, out, "gearbox_fig22")


def _meshes(out: Path, results: dict[str, Any]) -> None:
    """Fig. 27 and Table 6."""
    fig, (ax, cost) = figure(12, 5.4, 1, 2, width_ratios=(3, 2))
    ratio = results["contact_ratio_analytic"]
    for rows, style, colour, label in (
        (results["meshes"], "o-", BLUE, f"ours, contact ratio {ratio:.2f}, fine flanks on edges"),
        (results["meshes_node_perimeter"], "^-", SKY, f"ours, {ratio:.2f}, mesh nodes as perimeter"),
        (results["standard_teeth"]["meshes"], "v-", ORANGE, "ours, standard teeth (1.68)"),
    ):  # fmt: skip
        x = [m["mesh_mm"] for m in rows]
        ax.semilogy(x, [m["ratio_rmse_percent"] for m in rows], style, color=colour, label=label)
        cost.semilogy(x, [m["run_cpu_s"] for m in rows], style, color=colour)
    table = gb.PAPER["table_6"]
    ax.semilogy(gb.MESHES, table["rmse_percent"], "s--", color=BLACK, label="the paper, Table 6")
    cost.semilogy(gb.MESHES, table["wall_s"], "s--", color=BLACK)
    cost.axhline(0.5, color=RED, ls=":")
    cost.annotate("real time", (1.2, 0.5), xytext=(0, 4), textcoords="offset points", color=RED, ha="right")
    ax.set(xlabel="mesh size (mm)", ylabel="RMSE of the transmission ratio (%)")
    ax.set_yticks([0.2, 0.3, 0.5, 1.0, 1.5], ["0.2", "0.3", "0.5", "1", "1.5"])
    ax.minorticks_off()
    cost.set(xlabel="mesh size (mm)", ylabel="processor time of 0.5 s (s)")
    fig.legend(*ax.get_legend_handles_labels(), loc="outside upper center", ncol=2, fontsize=9)
    save(fig, out, "gearbox_fig27")


def _variants(out: Path, rows: list[dict[str, Any]]) -> None:
    """What the ripple and the pressure angle depend on: everything the paper leaves open."""
    fig, (left, right) = figure(11, 5, 1, 2, sharey=True)
    y = np.arange(len(rows))[::-1]
    left.barh(y, [v["ratio_rmse_percent"] for v in rows], color=BLUE)
    left.axvline(0.2753, color=BLACK, ls="--", label="the paper's finest mesh")
    left.set_yticks(y, [v["variant"] for v in rows])
    left.set(xlabel="RMSE of the ratio (%)")
    left.legend(loc="lower right", **FRAMED)
    for mark, colour, shape, name in (
        ("", BLUE, "o", "leading pair"),
        ("_on_path", GREEN, "^", "pairs on the path of contact"),
        ("_resultant", ORANGE, "s", "resultant"),
        ("_all_pairs", RED, "x", "all pairs"),
    ):
        means = [v[f"pressure_angle{mark}_mean_deg"] for v in rows]
        right.plot(means, y, shape, color=colour, fillstyle="none", label=name)
    right.axvspan(19.9, 20.1, color=BLACK, alpha=0.1, lw=0)
    right.set(xlabel="mean pressure angle (°); grey: 20 ± 0.1", xlim=(19.5, 23.5))
    fig.legend(*right.get_legend_handles_labels(), loc="outside upper right", ncol=4, fontsize=9)
    for ax in (left, right):
        ax.grid(axis="y", visible=False)
    save(fig, out, "gearbox_variants")
