"""The paper's Fig. 14–20 redrawn from the Geneva case's runs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from rigidarea.cases import figures
from rigidarea.cases import geneva_case as gv
from rigidarea.cases.case_report import BLACK, BLUE, GREEN, RED, YELLOW, figure, save
from rigidarea.flexible.integrate import Record
from rigidarea.shapes import geneva


def draw(
    out: Path,
    r: Record,
    start: float,
    results: dict[str, Any],
    records: dict[float, Record],
    cache: Path | None,
) -> None:
    """All figures; ``results`` are those of ``geneva_run.run``, ``records`` those of its sweep of steps."""
    _configuration(out, start)
    _displacement(out, r)
    _engagement(out, r, start, results)
    _force(out, r)
    sim, _ = gv.simulation("compliant", cache=cache)
    now = sim.run(0.25, gv.STEP).regions[-1]
    fig, ax = figure(8.4, 8)
    figures.nodal_forces(ax, sim, ("pin", "wheel"), 1e3 * now[now[:, 0].argmax(), 3:5], 1.4)
    ax.set_title(f"nodal forces, t = {sim.time:g} s, mesh {gv.MESH:g} mm")
    save(fig, out, "geneva_fig18")
    figures.step_cost(
        out,
        "geneva_fig19",
        results["steps"],
        1.0,
        ("the pin to cross the play", gv.PLAY_S),
        ("rms_percent", "RMS error of the angle\n(% of the index angle)"),
        (0, 2),
        gv.PAPER["cheapest_step_s"],
    )
    figures.iteration_history(out, "geneva_fig20", {h: records[h] for h in (2e-4, 5e-4, 8e-4)}, 0.8)


def _configuration(out: Path, start: float) -> None:
    """Fig. 14. The crank is drawn for the eye: pin and axis are all of it that the case has."""
    drive = geneva(6, gv.CENTRES, gv.PIN, gv.CLEARANCE, bore=0.004, tolerance=1e-6)
    wheel = figures.placed(
        drive.wheel.rings[0], np.array([gv.CENTRES, 0.0, drive.wheel_angle(-drive.entry_angle)])
    )
    pin = figures.placed(drive.pin.rings[0], np.array([0.0, 0.0, start]))
    fig, ax = figure(10, 8.4)
    ax.fill(*wheel.T, facecolor=GREEN, alpha=0.15)
    ax.plot(*np.vstack([wheel, wheel[:1]]).T, color=GREEN, label="driven wheel, six slots")
    figures.bore(ax, (gv.CENTRES, 0.0), 0.004, GREEN)
    ax.fill(*pin.T, color=BLACK, label="pin")
    r = 1e3 * drive.crank_radius
    crank = [0, r * np.cos(start)], [0, r * np.sin(start)]
    label = f"crank, {np.degrees(start):.2f}° at t = 0, turns at 30 rpm"
    ax.plot(*crank, color=BLACK, lw=6, alpha=0.35, solid_capstyle="round", label=label)
    t = np.linspace(0, 2 * np.pi, 200)
    ax.plot(r * np.cos(t), r * np.sin(t), ":", color=BLACK, lw=1, label="path of the pin")
    ax.plot([0], [0], "o", color=BLACK, ms=9)
    figures.equal(ax)
    fig.legend(loc="outside lower center", ncol=2)
    save(fig, out, "geneva_fig14")


def _displacement(out: Path, r: Record) -> None:
    """Fig. 15."""
    fig, ax = figure(10, 4.6)
    ax.plot(r.t, np.degrees(-(r.hub[:, 1] - r.hub[0, 1])), color=BLUE)
    ax.set(xlabel="time (s)", ylabel="angle of the driven wheel (°)")
    ax.set_yticks(np.arange(0, 1 + np.degrees(-(r.hub[-1, 1] - r.hub[0, 1])), 60))
    save(fig, out, "geneva_fig15")


def _engagement(out: Path, r: Record, start: float, results: dict[str, Any]) -> None:
    """Fig. 16, and the difference, which the first panel cannot show."""
    fig, (top, bottom) = figure(10, 6.6, 2, 1, sharex=True)
    first = r.t <= 1
    turned = -(r.hub[first, 1] - r.hub[0, 1])
    theta = start + gv.SPEED * r.t[first]
    touch, entry = gv.first_touch(6), np.pi / 3
    exact = np.where(theta < touch, 0, np.where(theta > entry, np.nan, gv.ideal(6, theta) + np.pi / 6))
    top.plot(r.t[first], np.degrees(exact), color=YELLOW, lw=5, label="φ_eff, Eq. 40")
    top.plot(r.t[first], np.degrees(turned), color=BLUE, label="ours")
    top.set(
        ylabel="angle (°)",
        title=f"RMS {results['rms_percent']:.3f} % (the paper: 1.13 %); contact"
        f" {results['contact_delay_ms']:.2f} ms late (the paper: 8.5 ms)",
    )
    top.legend()
    bottom.plot(r.t[first], np.degrees(turned - exact), color=RED)
    bottom.set(xlabel="time (s)", ylabel="ours − φ_eff (°)")
    save(fig, out, "geneva_fig16")


def _force(out: Path, r: Record) -> None:
    """Fig. 17: all revolutions, and the first engagement."""
    force = np.hypot(*r.force.T)
    fig, axes = figure(10, 6.6, 2, 1)
    for ax, until in zip(axes, (r.t[-1], 0.8), strict=True):
        keep = r.t <= until
        ax.plot(r.t[keep], force[keep], color=BLUE, lw=1)
        ax.set(xlabel="time (s)", ylabel="contact force (N)")
    axes[1].set_title("first engagement")
    save(fig, out, "geneva_fig17")
