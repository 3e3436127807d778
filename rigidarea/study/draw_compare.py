"""The three levels drawn over each other; what they cost against how wrong they are; how fast they converge."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .draw import panels, save
from .records import Row

STYLES = {"rigid": ("#E69F00", "-", 2.6), "compliant": ("#56B4E9", "-", 1.8), "modal": ("#000000", "--", 1.1)}
MARKERS = "os^Dvp"
COLOURS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#D55E00", "#000000")


def levels(report: Row, traces: Row, out: Path) -> list[Path]:
    """One panel a scene, whose legend says what each level costs and how far it is from the modal one; a panel of
    error against cost; and, where the report has them, a page of the convergence studies."""
    figure, axes = panels(len(traces) + 1, 2, 3.9)
    rows = {(row["scene"], row["level"]): row for row in report["results"]}
    for ax, (name, described) in zip(axes.flat, traces.items(), strict=False):
        low, high = described["window"]
        for level, (t, values) in described["levels"].items():
            inside = (t >= low) & (t <= high)
            tint, style, width = STYLES[level]
            label = _label(rows[name, level])
            ax.plot(1e3 * t[inside], values[inside], color=tint, ls=style, lw=width, label=label)
        ax.set(title=described["title"], xlabel="time (ms)", ylabel=described["label"])
        ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), fontsize=8)
    _cost(axes.flat[len(traces)], traces, rows)
    last = axes.flat[len(traces)]
    if len(traces) + 1 < axes.size:
        title = "scene (mark) and level (colour)"
        axes.flat[-1].legend(*last.get_legend_handles_labels(), loc="center left", title=title)
    else:
        last.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), fontsize=8, ncols=2)
    paths = save(figure, out, "compare")
    return paths + (convergence(report["convergence"], out) if "convergence" in report else [])


def _label(row: Row) -> str:
    if row["failed"]:
        return f"{row['level']}: did not converge"
    text = f"{row['level']}: {_number(row['cost_s_per_s'])} s a simulated second"
    return text if row["level"] == "modal" else text + f", {_number(100 * row['departure'])} % off modal"


def _number(value: float) -> str:
    """Two digits, without an exponent where they are read more easily so."""
    return f"{value:.2g}" if value < 100 else f"{value:.0f}"


def _cost(ax: Any, traces: Row, rows: dict[tuple[str, str], Row]) -> None:
    for (name, described), mark in zip(traces.items(), MARKERS, strict=False):
        here = [row for (scene, _), row in rows.items() if scene == name and row["error"]]
        x, y = [row["cost_s_per_s"] for row in here], [row["error"] for row in here]
        ax.plot(x, y, "-", color="#999999", lw=0.8, zorder=1)
        for row in here:
            tint = STYLES[row["level"]][0]
            ax.plot(row["cost_s_per_s"], row["error"], mark, ms=7, color=tint, mec="black", mew=0.5)
        ax.plot([], [], mark, color="#999999", ms=7, label=described["title"])
    for level, (tint, _, _) in STYLES.items():
        ax.plot([], [], "s", color=tint, ms=7, label=level)
    ax.set(xscale="log", yscale="log", title="error against cost")
    ax.set(xlabel="cost (s a simulated second)", ylabel="error against the exact or a finer answer")


def convergence(studies: Sequence[Row], out: Path) -> list[Path]:
    """One panel a study, errors over the knob with the fitted orders in the legend; dotted: the order of theory."""
    names = list(dict.fromkeys(row["study"] for row in studies))
    figure, axes = panels(len(names), min(2, len(names)), 4.2)
    for ax, name in zip(axes.flat, names, strict=False):
        here = [row for row in studies if row["study"] == name]
        knobs = list(dict.fromkeys(row["knob"] for row in here))
        for i, row in enumerate(here):
            x, error = np.array(row["x"]), np.array(row["error"])
            if len(knobs) > 1:  # on one axis as parts of the largest
                x = x / x.max()
            label = f"{row['quantity']}: order {row['order']:.2f}"
            ax.loglog(x, error, MARKERS[i] + "-", ms=5, lw=1.2, color=COLOURS[i], label=label)
            if row["expected"] is not None:
                ax.loglog(x, error[-1] * (x / x[-1]) ** row["expected"], ":", lw=1.0, color=COLOURS[i])
        knob = knobs[0] if len(knobs) == 1 else "step / largest step"
        ax.set(title=name, xlabel=knob, ylabel="relative error")
        ticks = sorted({float(t) for line in ax.lines for t in line.get_xdata()})
        ax.set_xticks(ticks, [f"{t:.3g}" for t in ticks])
        ax.set_xticks([], minor=True)
        ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), fontsize=8)
    figure.suptitle("marks: measured; dotted: the order that theory gives", fontsize=9)
    return save(figure, out, "convergence")
