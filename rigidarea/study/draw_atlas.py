"""The atlas drawn: a strip of panels a map, an engine a panel; an overview of all; a page of the telling ones."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .atlas import PASS, Axis, Map, get_map
from .draw import panels, pyplot, save
from .records import Row
from .scene import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PASS_COLOUR = "#BFE3F7"
FAIL_COLOURS = ("#D55E00", "#E69F00", "#CC79A7", "#F0E442", "#009E73", "#000000")
ENGINES = ("rigidarea", "explicit", "pymunk", "box2d", "literal")
"""Columns of the overview and of the page."""
CORNERS = "literal, corners"
TITLES = {"explicit": "rigidarea, explicit", "literal": "paper, mesh nodes", CORNERS: "paper, corner nodes"}
"""What the page calls the engines."""
PAGE = ("step_size", "buckling", "corner", "mass_ratio", "overlap_depth", "tunnel")
"""Maps of the page."""
TICKS = 6
"""Most labelled values of an axis."""


def places(axis: Axis, values: Sequence[float], at: Array) -> Array:
    """Where `at` lies along an axis whose `values` are drawn as equal cells with centres 0, 1, 2, …

    Between the values linearly, on a logarithmic axis in the logarithm; beyond them as in the last cell.
    """
    known, wanted = np.array(values, dtype=np.float64), np.array(at, dtype=np.float64)
    if axis.log:
        known, wanted = np.log(known), np.log(wanted)
    cell = np.clip(np.searchsorted(known, wanted) - 1, 0, max(len(known) - 2, 0))
    step = np.diff(known)[cell] if len(known) > 1 else np.ones(len(wanted))
    return np.asarray(cell + (wanted - known[cell]) / step, dtype=np.float64)


def _label(axis: Axis, value: float) -> str:
    if axis.names:
        return axis.names[round(value)]
    if axis.log and (value >= 1e3 or value < 1e-2):
        power = math.floor(math.log10(value) + 1e-9)
        factor = value / 10**power
        return f"$10^{{{power}}}$" if abs(factor - 1) < 1e-6 else f"{factor:.0f}e{power}"
    return f"{value:.3g}"


def _ticks(axis: Axis, values: Sequence[float], most: int = TICKS) -> tuple[list[int], list[str]]:
    every = 1 if axis.names else -(-len(values) // most)
    chosen = list(range(0, len(values), every))
    return chosen, [_label(axis, values[i]) for i in chosen]


def atlas_maps(report: Row, out: Path) -> list[Path]:
    """PNG and SVG of every map in the report."""
    paths = []
    for described in report["maps"]:
        rows = [row for row in report["results"] if row["map"] == described["map"]]
        if rows:
            paths += _one(get_map(described["map"]), rows, out)
    return paths


def _one(chart: Map, rows: Sequence[Row], out: Path) -> list[Path]:
    names = list(dict.fromkeys(row["peer"] for row in rows))
    figure, axes = panels(len(names), 3 if len(names) > 4 else len(names), 2.9, 1.0, sharex=True, sharey=True)
    colours = _colours(rows)
    for ax, name in zip(axes.flat, names, strict=False):
        _cells(ax, chart, rows, name, colours)
        ax.set_title(name)
    handles = _swatches(colours) + _lines(axes)
    figure.legend(handles=handles, loc="outside lower center", ncols=min(len(handles), 5), fontsize=8.5)
    figure.suptitle(chart.title, fontsize=11)
    for ax in axes[-1]:  # constrained layout puts a common label under the legend
        wrapped = chart.x.label.replace(" / ", "\n/ ") if len(axes[0]) > 3 else chart.x.label
        ax.set_xlabel(wrapped, fontsize=9)
    figure.supylabel(chart.y.label, fontsize=9.5)
    return save(figure, out, f"atlas-{chart.name}")


def _colours(rows: Sequence[Row]) -> dict[str, str]:
    """A colour for every verdict in the rows."""
    failed = sorted({row["verdict"] for row in rows} - {PASS})
    return {PASS: PASS_COLOUR} | {v: FAIL_COLOURS[i % len(FAIL_COLOURS)] for i, v in enumerate(failed)}


def _swatches(colours: dict[str, str]) -> list[Any]:
    plt = pyplot()
    return [plt.Rectangle((0, 0), 1, 1, fc=c, ec="#888888", label=v) for v, c in colours.items()]


def _lines(axes: Any) -> list[Any]:
    """Legend handles of theory, once each."""
    found: dict[str, Any] = {}
    for ax in np.ravel(axes):
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True):
            found.setdefault(label, handle)
    return list(found.values())


def _cells(
    ax: Axes, chart: Map, rows: Sequence[Row], name: str, colours: dict[str, str], ticks: int = TICKS
) -> None:
    """One engine's panel: equal cells, coloured by verdict, theory over them."""
    from matplotlib.colors import ListedColormap

    xs, ys = (sorted({row[key] for row in rows}) for key in ("x", "y"))
    verdicts = list(colours)
    grid = np.full((len(ys), len(xs)), np.nan)
    for row in rows:
        if row["peer"] == name:
            grid[ys.index(row["y"]), xs.index(row["x"])] = verdicts.index(row["verdict"])
    edges = (np.arange(len(values) + 1) - 0.5 for values in (xs, ys))
    shades = ListedColormap(list(colours.values()))
    ax.pcolormesh(*edges, grid, cmap=shades, vmin=-0.5, vmax=len(colours) - 0.5, ec="w", lw=0.4)
    if not chart.theory_of or name in chart.theory_of:
        for (label, tx, ty), style in zip(chart.theory(), ("-", "--", ":"), strict=False):
            at = places(chart.x, xs, tx), places(chart.y, ys, ty)
            ax.plot(*at, color="k", lw=1.5, ls=style, label=label)
    ax.set_xlim(-0.5, len(xs) - 0.5)
    ax.set_ylim(-0.5, len(ys) - 0.5)
    ax.grid(False)
    ax.set_xticks(*_ticks(chart.x, xs, ticks))
    ax.set_yticks(*_ticks(chart.y, ys, ticks))
    ax.tick_params(labelsize=8)


def page(report: Row, out: Path) -> list[Path]:
    """The telling maps on one page: a line a map, a column an engine, theory's boundary where it speaks."""
    plt = pyplot()
    charts = [get_map(name) for name in PAGE if any(row["map"] == name for row in report["results"])]
    if not charts:
        return []
    figure = plt.figure(figsize=(10, 0.2 + 2.05 * len(charts)))
    strips = figure.subfigures(len(charts), 1, squeeze=False)[:, 0]
    for strip, chart in zip(strips, charts, strict=True):
        rows = [row for row in report["results"] if row["map"] == chart.name]
        axes = strip.subplots(1, len(ENGINES) + 1, width_ratios=(*[1.0] * len(ENGINES), 1.12))
        strip.subplots_adjust(left=0.085, right=0.98, bottom=0.25, top=0.77, wspace=0.12)
        corners = any(row["peer"] == CORNERS for row in rows)
        names = [CORNERS if name == "literal" and corners else name for name in ENGINES]
        colours = _colours([row for row in rows if row["peer"] in names])
        for ax, name in zip(axes, names, strict=False):
            if any(row["peer"] == name for row in rows):
                _cells(ax, chart, rows, name, colours, 5)
                ax.set_title(TITLES.get(name, name), fontsize=8.5)
            else:
                ax.set_axis_off()
            if ax is not axes[0]:
                ax.set_yticklabels([])
        axes[-1].set_axis_off()
        axes[-1].legend(
            handles=_swatches(colours) + _lines(axes), loc="center left", fontsize=8, handlelength=1.4,
            bbox_to_anchor=(-0.1, 0.5),
        )  # fmt: skip
        strip.suptitle(chart.title, fontsize=10, fontweight="bold", x=0.01, ha="left")
        strip.supxlabel(chart.x.label, fontsize=8.5, x=0.45)
        axes[0].set_ylabel(chart.y.label, fontsize=8.5)
    return save(figure, out, "atlas-page")


def overview(report: Row, out: Path) -> list[Path]:
    """The share of points passed, a line a map, a column an engine."""
    plt = pyplot()
    rows = report["results"]
    names = [name for name in ENGINES if any(r["peer"] == name for r in rows)]
    charts = [described for described in report["maps"] if any(r["map"] == described["map"] for r in rows)]
    share = np.full((len(charts), len(names)), np.nan)
    for (i, described), (j, name) in itertools.product(enumerate(charts), enumerate(names)):
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
