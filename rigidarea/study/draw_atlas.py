"""The atlas drawn: one strip of panels a map, an engine a panel; and an overview of all maps."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .atlas import PASS, Axis, Map, get_map
from .draw import _pyplot, save
from .records import Row
from .scene import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PASS_COLOUR = "#BFE3F7"
FAIL_COLOURS = ("#D55E00", "#E69F00", "#CC79A7", "#F0E442", "#009E73", "#000000")


def edges(axis: Axis, values: Sequence[float]) -> Array:
    """Cell edges around the values: halfway between them, on a logarithmic axis in the logarithm."""
    if axis.names:
        return np.arange(len(values) + 1, dtype=np.float64) - 0.5
    points = [math.log10(value) if axis.log else value for value in values]
    inner = [(one + other) / 2 for one, other in itertools.pairwise(points)]
    first, last = (inner[0], inner[-1]) if inner else (points[0] - 0.5, points[0] + 0.5)
    found = [2 * points[0] - first, *inner, 2 * points[-1] - last]
    return np.array([10**value if axis.log else value for value in found], dtype=np.float64)


def atlas_maps(report: Row, out: Path) -> list[Path]:
    """PNG and SVG of every map in the report."""
    paths = []
    for described in report["maps"]:
        rows = [row for row in report["results"] if row["map"] == described["map"]]
        if rows:
            paths += _one(get_map(described["map"]), rows, out)
    return paths


def _one(chart: Map, rows: Sequence[Row], out: Path) -> list[Path]:
    plt = _pyplot()
    names = list(dict.fromkeys(row["peer"] for row in rows))
    xs, ys = (sorted({row[key] for row in rows}) for key in ("x", "y"))
    verdicts = [PASS, *sorted({row["verdict"] for row in rows} - {PASS})]
    colours = [PASS_COLOUR, *(FAIL_COLOURS[i % len(FAIL_COLOURS)] for i in range(len(verdicts) - 1))]
    columns = 3 if len(names) > 4 else len(names)
    lines = -(-len(names) // columns)
    figure, axes = plt.subplots(
        lines,
        columns,
        figsize=(10, 1.0 + 2.9 * lines),
        sharex=True,
        sharey=True,
        squeeze=False,
        layout="constrained",
    )
    for ax, name in zip(axes.flat, names, strict=False):
        _cells(ax, chart, [row for row in rows if row["peer"] == name], (xs, ys), verdicts, colours)
        ax.set_title(name)
    for ax in axes.flat[len(names) :]:
        ax.set_axis_off()
    handles = [
        plt.Rectangle((0, 0), 1, 1, fc=c, ec="#888888", label=v)
        for v, c in zip(verdicts, colours, strict=True)
    ]
    handles += axes[0, 0].get_legend_handles_labels()[0]
    figure.legend(handles=handles, loc="outside lower center", ncols=min(len(handles), 5), fontsize=8.5)
    figure.suptitle(chart.title, fontsize=11)
    for ax in axes[-1]:
        ax.set_xlabel(chart.x.label if columns < 4 else chart.x.label.replace(" / ", "\n/ "), fontsize=9)
    figure.supylabel(chart.y.label, fontsize=9.5)
    return save(figure, out, f"atlas-{chart.name}")


def _cells(
    ax: Axes,
    chart: Map,
    rows: Sequence[Row],
    places: tuple[list[float], list[float]],
    verdicts: Sequence[str],
    colours: Sequence[str],
) -> None:
    from matplotlib.colors import ListedColormap

    xs, ys = places
    grid = np.full((len(ys), len(xs)), np.nan)
    for row in rows:
        grid[ys.index(row["y"]), xs.index(row["x"])] = verdicts.index(row["verdict"])
    x, y = edges(chart.x, xs), edges(chart.y, ys)
    ax.pcolormesh(
        x, y, grid, cmap=ListedColormap(list(colours)), vmin=-0.5, vmax=len(colours) - 0.5, ec="w", lw=0.4
    )
    for (label, tx, ty), style in zip(chart.theory(), ("-", "--", ":"), strict=False):
        ax.plot(tx, ty, color="k", lw=1.5, ls=style, label=label)
    ax.set_xscale("log" if chart.x.log else "linear")
    ax.set_yscale("log" if chart.y.log else "linear")
    ax.set_xlim(x[0], x[-1])
    ax.set_ylim(y[0], y[-1])
    ax.grid(False)
    if chart.y.names:
        ax.set_yticks(range(len(ys)), [chart.y.names[round(v)] for v in ys])


def overview(report: Row, out: Path) -> list[Path]:
    """The share of points passed, a line a map, a column an engine."""
    plt = _pyplot()
    rows = report["results"]
    names = [
        name for name in ("rigidarea", "pymunk", "box2d", "literal") if any(r["peer"] == name for r in rows)
    ]
    charts = [described for described in report["maps"] if any(r["map"] == described["map"] for r in rows)]
    share = np.full((len(charts), len(names)), np.nan)
    for i, described in enumerate(charts):
        for j, name in enumerate(names):
            here = [r["verdict"] == PASS for r in rows if r["map"] == described["map"] and r["peer"] == name]
            if here:
                share[i, j] = float(np.mean(here))
    figure, ax = plt.subplots(figsize=(10, 1.2 + 0.42 * len(charts)), layout="constrained")
    image = ax.imshow(share, cmap="cividis", vmin=0, vmax=1, aspect="auto")
    for i, j in np.ndindex(*share.shape):
        text = "–" if np.isnan(share[i, j]) else f"{100 * share[i, j]:.0f} %"
        dark = not np.isnan(share[i, j]) and share[i, j] < 0.5
        ax.text(j, i, text, ha="center", va="center", color="w" if dark else "k", fontsize=9)
    ax.set_xticks(range(len(names)), names)
    ax.set_yticks(range(len(charts)), [described["title"] for described in charts])
    ax.xaxis.tick_top()
    ax.grid(False)
    figure.colorbar(image, ax=ax, label="share of the map's points passed", shrink=0.8)
    return save(figure, out, "atlas")
