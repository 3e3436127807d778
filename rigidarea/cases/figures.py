"""Drawings that the mechanisms share: placed bodies, nodal forces close up, costs and iterations over the step."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from rigidarea.cases.case_report import BLACK, BLUE, FRAMED, ORANGE, PURPLE, RED, Array, figure, save
from rigidarea.flexible.boundary import Work
from rigidarea.flexible.integrate import Record, Simulation


def placed(points: Array, frame: Array) -> Array:
    """Points (n, 2) of a body frame at (x, y, angle), in millimetres."""
    c, s = np.cos(frame[2]), np.sin(frame[2])
    return 1e3 * (points @ np.array([[c, s], [-s, c]]) + frame[:2])


def perimeter(sim: Simulation, i: int) -> Array:
    """The outer contact perimeter of body ``i`` where it is now, closed, in millimetres."""
    b = sim.boundaries[i]
    ring = np.flatnonzero(b.ring_of == 0)
    return placed(b.points[np.append(ring, ring[0])], sim.state.x[i])


def equal(ax: Any) -> None:
    """Axes in millimetres, undistorted."""
    ax.set(aspect="equal", xlabel="x (mm)", ylabel="y (mm)")


def bore(ax: Any, centre: tuple[float, float], radius: float, colour: str) -> None:
    """A circle, in metres."""
    t = np.linspace(0, 2 * np.pi, 200)
    x, y = centre[0] + radius * np.cos(t), centre[1] + radius * np.sin(t)
    ax.plot(1e3 * x, 1e3 * y, color=colour, lw=1.2)


#: Arrows as long as a scale (force a millimetre) says.
TO_SCALE: dict[str, Any] = {"width": 0.004, "angles": "xy", "scale_units": "xy"}


def loads(w: Work) -> tuple[Array, Array]:
    """The points of a body that contacts load (n, 2), mm, and the forces on them (n, 2)."""
    on = w.touched[: w.touched[-1]]
    return 1e3 * w.position[on], w.point_load[on]


def arrows(ax: Any, w: Work, **keys: Any) -> Any:
    """Those forces drawn at their points."""
    at, forces = loads(w)
    return ax.quiver(*at.T, *forces.T, **keys)


def nodal_forces(ax: Any, sim: Simulation, names: tuple[str, str], middle: Array, half: float) -> None:
    """Both perimeters with their points, and the forces on them, ``half`` mm around ``middle`` (2,), mm."""
    largest = max(float(np.hypot(*loads(w)[1].T).max()) for w in sim.works)
    for i, (w, name, colour) in enumerate(zip(sim.works, names, (RED, BLUE), strict=True)):
        ax.plot(*perimeter(sim, i).T, ".-", ms=5, lw=1, color=colour)
        at, f = loads(w)
        near = np.abs(at - middle).max(1) < half
        label = f"on the {name}: Σ = {np.hypot(*f[near].sum(0)):.3g} N"
        drawn = arrows(ax, w, color=colour, **TO_SCALE, scale=largest / (0.3 * half), zorder=3, label=label)
    step = float(f"{0.5 * largest:.1g}")
    ax.quiverkey(drawn, 0.88, 0.06, step, f"{step:g} N", labelpos="N", coordinates="axes", color="#000000")
    ax.set(xlim=(middle[0] - half, middle[0] + half), ylim=(middle[1] - half, middle[1] + half))
    equal(ax)
    ax.legend(loc="upper left", **FRAMED)


def step_cost(
    out: Path,
    name: str,
    rows: list[dict[str, Any]],
    duration: float,
    event: tuple[str, float],
    error: tuple[str, str],
    limits: tuple[float, float],
    paper: float | None = None,
) -> None:
    """The paper's Fig. 19: cost and iterations over the time step; below, an error of the run.

    event: the shortest contact event, in words and seconds. error: key of the rows and label, drawn between
    ``limits``. paper: its cheapest step.
    """
    fig, axes = figure(10, 6.6, 2, 1, sharex=True, height_ratios=(3, 2))
    top, bottom = axes
    ok = [r for r in rows if "failed" not in r]
    h = [r["step_s"] for r in ok]
    top.loglog(h, [r["run_cpu_s"] for r in ok], "o-", color=BLUE, label="processor time")
    halved = [r for r in ok if r["steps_halved"]]
    failed = [r for r in rows if "failed" in r]
    for some, mark, colour, label in (
        (halved, "s", PURPLE, "some steps halved"),
        (failed, "X", RED, "given up: no convergence"),
    ):
        if some:
            x, y = [r["step_s"] for r in some], [r["run_cpu_s"] for r in some]
            top.loglog(x, y, mark, ms=11, fillstyle="none", color=colour, label=label)
    twin = top.twinx()
    twin.plot(h, [r["evaluations_a_step"] for r in ok], "^--", color=ORANGE)
    twin.set_ylim(0, None)
    twin.set_ylabel("contact evaluations a step\n(Newton iterations, all attempts)", color=ORANGE)
    twin.grid(False)
    top.set_ylabel(f"processor time of {duration:g} s (s)")
    bottom.plot(h, [r[error[0]] for r in ok], "o-", color=BLUE)
    bottom.set(xlabel="time step (s)", ylabel=error[1], ylim=limits)
    right = max(r["step_s"] for r in rows) * 1.4
    coarse = f"fewer than ten steps for {event[0]}"
    for ax in axes:
        ax.axvspan(0.1 * event[1], right, color=ORANGE, alpha=0.12, lw=0, label=coarse)
        if paper is not None:
            ax.axvline(paper, color=BLACK, ls=":", label=f"the paper's optimum, {paper:g} s")
    top.set_xlim(min(h) / 1.4, right)
    fig.legend(*top.get_legend_handles_labels(), loc="outside upper center", ncol=3, fontsize=9)
    save(fig, out, name)


def iteration_history(out: Path, name: str, records: dict[float, Record], until: float) -> None:
    """The paper's Fig. 20 and 28: Newton iterations over time, a panel a step."""
    fig, axes = figure(10, 1 + 2 * len(records), len(records), 1, sharex=True, sharey=True)
    top = max(r.iterations[r.t <= until].max() for r in records.values())
    for ax, (h, r) in zip(axes, records.items(), strict=True):
        keep = r.t <= until
        ax.plot(r.t[keep], r.iterations[keep], ".", ms=3, color=BLUE)
        mean = r.iterations[keep].mean()
        ax.axhline(mean, color=ORANGE, label=f"mean {mean:.2f}")
        ax.set(ylabel="Newton\niterations", title=f"h = {1e6 * h:g} µs", ylim=(0, top + 1))
        ax.legend(loc="upper right", **FRAMED)
        ax.yaxis.get_major_locator().set_params(integer=True)
    axes[-1].set_xlabel("time (s)")
    save(fig, out, name)
