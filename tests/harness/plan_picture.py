"""What docs/plan.md shows: predicted beside measured errors, costs beside the cheapest adequate setting's, and the
tables."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rigidarea.study.draw import pyplot
from rigidarea.study.records import Row

from .page import markdown, number

FLOOR = 1e-7
"""Errors below are drawn there."""
COLOURS = {0.1: "#0072b2", 0.01: "#d55e00", 0.001: "#009e73"}


def costs_and_errors(rows: Sequence[Row], target: Path) -> Path:
    """One point a scene and tolerance: left its measured error over the predicted one, right its cost ratio."""
    plt = pyplot()
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 5.2), layout="constrained")
    judged = [row for row in rows if row["verdict"] != "no reference"]
    for tolerance in sorted({row["tolerance"] for row in judged}, reverse=True):
        colour = COLOURS.get(tolerance, "#666666")
        for varied, marker in ((False, "o"), (True, "x")):
            here = [row for row in judged if row["tolerance"] == tolerance and row["varied"] == varied]
            if not here:
                continue
            label = f"{100 * tolerance:g} %{', variations' if varied else ''}"
            x = [max(row["predicted_error"], FLOOR) for row in here]
            y = [max(row["error"], FLOOR) if row["error"] is not None else 10.0 for row in here]
            left.plot(x, y, marker, color=colour, ms=5, mew=1.2, mfc="none", label=label)
            ratios = sorted(row["cost_ratio"] for row in here if row["cost_ratio"] is not None)
            share = [100.0 * (i + 1) / len(here) for i in range(len(ratios))]
            right.step(ratios, share, "--" if varied else "-", where="post", color=colour, label=label)
        left.axhline(tolerance, color=colour, lw=0.8, ls=":")
    ends = (FLOOR, 10.0)
    left.plot(ends, ends, color="#999999", lw=0.8)
    left.set(
        xscale="log",
        yscale="log",
        xlabel=f"predicted error (below {FLOOR:g}: drawn there)",
        ylabel="measured error of the planned run",
    )
    left.legend(fontsize=8, loc="lower right")
    right.axvline(1.5, color="#999999", lw=0.8, ls=":")
    right.axvline(5.0, color="#999999", lw=0.8, ls=":")
    right.set(
        xscale="log",
        xlabel="cost over the cheapest adequate setting's",
        ylabel="share of all that is planned (%)",
    )
    right.legend(fontsize=8, loc="lower right")
    ticks = (1.0, 1.5, 2.0, 3.0, 5.0)
    right.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    right.set_xticks([], minor=True)
    right.set_ylim(0.0, 100.0)
    target.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(target, dpi=110)
    plt.close(figure)
    return target


def summaries(report: Row) -> str:
    """The table of how often plans are right and what they cost."""
    kinds = {
        "the study's scenes": report["summary"]["scenes"],
        **{f"… at {100 * float(t):g} %": found for t, found in report["summary"]["by_tolerance"].items()},
        "seeded variations": report["summary"]["variations"],
        "scenes that no estimate was found on": report["summary"]["unseen"],
    }
    if "judged" in report["summary"]:
        kinds["scenes written after the planner"] = report["summary"]["judged"]
    columns = (
        *("", "cells", "some setting is within", "planned within", "outside, and said so"),
        *("cost ratio, median", "worst"),
        *("none is within", "said so"),
    )
    rows = []
    for name, found in kinds.items():
        rows.append(
            (
                *(name, str(found["cells"]), str(found["reachable"])),
                f"{found['within_tolerance_percent']:.0f} %" if found["reachable"] else "–",
                str(found["outside_said"]),
                *(
                    number(found["cost_ratio_median"]),
                    number(found["cost_ratio_worst"]),
                    str(found["unreachable"]),
                ),
                f"{found['unreachable_said_percent']:.0f} %" if found["unreachable"] else "–",
            )
        )
    shown = "![predicted and measured errors; costs over the cheapest adequate setting's](plan.png)"
    return f"{markdown(columns, rows)}\n{shown}\n"


def outside(report: Row) -> str:
    """The table of plans whose run was outside the tolerance though a setting is within it."""
    rows = [
        (
            *(
                row["scene"],
                f"{100 * row['tolerance']:g} %",
                number(row["error"]),
                number(row["predicted_error"]),
            ),
            *(row["decided_by"], f"{row['level']} {row['steps']} x {row['sweeps']}", row["cheapest"]),
        )
        for row in report["rows"]
        if row["verdict"].startswith("outside")
    ]
    table = markdown(
        ("scene", "tolerance", "error", "predicted", "decided by", "planned", "cheapest within"), rows
    )
    return f"Outside their tolerance, though a setting of the sweep is within it:\n\n{table}" if rows else ""
