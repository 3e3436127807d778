"""The three levels drawn over each other."""

from __future__ import annotations

import math
from pathlib import Path

from .draw import _pyplot, save
from .records import Row

STYLES = {"rigid": ("#E69F00", "-", 2.4), "compliant": ("#56B4E9", "-", 1.8), "modal": ("#000000", "--", 1.1)}


def levels(report: Row, traces: Row, out: Path) -> list[Path]:
    """One panel a scene; the legend says what each level costs and how far it is from the modal one."""
    plt = _pyplot()
    columns = min(2, len(traces))
    lines = math.ceil(len(traces) / columns)
    figure, axes = plt.subplots(
        lines, columns, figsize=(10, 3.8 * lines), squeeze=False, layout="constrained"
    )
    for ax, (name, described) in zip(axes.flat, traces.items(), strict=False):
        low, high = described["window"]
        for level, (t, values) in described["levels"].items():
            row = next(r for r in report["results"] if r["scene"] == name and r["level"] == level)
            inside = (t >= low) & (t <= high)
            tint, style, width = STYLES[level]
            label = (
                f"{level}: did not converge" if row["failed"] else f"{level}: {row['cost_s_per_s']:.2g} s/s"
            )
            if level != "modal" and not row["failed"]:
                label += f", {100 * row['departure']:.2g} % off modal"
            ax.plot(1e3 * t[inside], values[inside], color=tint, ls=style, lw=width, label=label)
        ax.set(title=described["title"], xlabel="time (ms)", ylabel=described["label"])
        ax.legend(fontsize=8, frameon=True, framealpha=0.9, edgecolor="none")
    for ax in axes.flat[len(traces) :]:
        ax.set_axis_off()
    return save(figure, out, "compare")
