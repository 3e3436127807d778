"""The pictures of the studies: matplotlib, Okabe-Ito colours, readable at 1000 pixels width."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import front
from .chart import RESOLUTION, points
from .peers import get_peer
from .records import Row

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLOURS = {
    "rigidarea": "#0072B2",
    "rigidarea-default": "#56B4E9",
    "pymunk": "#D55E00",
    "box2d": "#009E73",
    "literal": "#CC79A7",
    "rigidarea-explicit": "#999999",
    "rigidarea-implicit": "#000000",
    "compliant": "#CC79A7",
    "modal": "#E69F00",
}
MARKERS = {
    "rigidarea": "o",
    "rigidarea-default": "P",
    "rigidarea-explicit": ".",
    "rigidarea-implicit": "X",
    "compliant": "v",
    "modal": "D",
    "pymunk": "s",
    "box2d": "^",
    "literal": "x",
}
OTHER_COLOURS = ("#F0E442", "#666666")
RANGE = (1e-3, 1e3)
"""Ratios that the summary shows; beyond, an arrow at its edge."""
PAGE = (3, 3)
"""Rows and columns of panels on a page of 1000 pixels width."""


def _pyplot() -> Any:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    plt.rcParams.update(
        {
            "font.size": 9,
            "axes.titlesize": 9.5,
            "axes.spines.top": False,
            "axes.spines.right": False,
            "axes.grid": True,
            "grid.color": "#e4e4e4",
            "grid.linewidth": 0.6,
            "axes.axisbelow": True,
            "svg.hashsalt": "rigidarea",
            "legend.frameon": False,
        }
    )
    return plt


def colour(peer: str) -> str:
    """The colour of a peer, the same in every picture."""
    return COLOURS.get(peer) or OTHER_COLOURS[sum(map(ord, peer)) % len(OTHER_COLOURS)]


def marker(peer: str) -> str:
    """The marker of a peer, the same in every picture."""
    return MARKERS.get(peer, "D")


def save(figure: Figure, out: Path, name: str) -> list[Path]:
    """PNG (1000 pixels for a figure 10 inches wide) and SVG."""
    out.mkdir(parents=True, exist_ok=True)
    paths = [out / f"{name}.png", out / f"{name}.svg"]
    figure.savefig(paths[0], dpi=100)
    figure.savefig(paths[1], metadata={"Date": None})
    _pyplot().close(figure)
    return paths


def chart_pages(report: Row, out: Path) -> list[Path]:
    """Error against cost, one panel a scene, nine panels a page, each peer's front as a stepped line."""
    plt = _pyplot()
    rows, scenes = report["results"], report["scenes"]
    names = list(dict.fromkeys(row["peer"] for row in rows))
    per_page = PAGE[0] * PAGE[1]
    paths = []
    for page in range(math.ceil(len(scenes) / per_page)):
        figure, axes = plt.subplots(*PAGE, figsize=(10, 9.4), layout="constrained")
        here = scenes[page * per_page : (page + 1) * per_page]
        for ax, scene in zip(axes.flat, here, strict=False):
            _panel(ax, rows, scene, names)
        for ax in axes.flat[len(here) :]:
            ax.set_axis_off()
        handles = [
            plt.Line2D([], [], color=colour(name), marker=marker(name), markersize=5, label=name)
            for name in names
        ]
        figure.legend(handles=handles, loc="outside upper center", ncols=min(len(handles), 4))
        figure.supxlabel("cost: computing time on one core / simulated time", fontsize=10)
        figure.supylabel("error (dimensionless; what it is stands in each panel)", fontsize=10)
        paths += save(figure, out, f"chart-{page + 1}")
    return paths


def _panel(ax: Axes, rows: Sequence[Row], scene: Row, names: Sequence[str]) -> None:
    floor = RESOLUTION
    for name in names:
        found = [
            front.Point(p.cost, max(p.error, floor / 3)) for p in points(rows, scene["scene"], peer=name)
        ]
        if not found:
            continue
        ax.plot(*zip(*found), ls="", marker=marker(name), ms=3, color=colour(name), alpha=0.35, mew=0.6)
        line = front.front(found)
        ax.plot(*zip(*line), color=colour(name), marker=marker(name), ms=4.5, lw=1.6, drawstyle="steps-post")
    ax.set(xscale="log", yscale="log")
    top = [row["error"] for row in rows if row["scene"] == scene["scene"] and row["error"]]
    ax.set_ylim(floor / 4, 2 * min(max(top, default=1.0), 10.0))
    ax.axhspan(floor / 4, floor, color="#f3f3f3", zorder=0)
    ax.set_title(scene["title"], loc="left")
    ax.text(
        0.98,
        0.97,
        scene["error_name"],
        transform=ax.transAxes,
        ha="right",
        va="top",
        fontsize=7.5,
        color="#444444",
        bbox={"fc": "white", "ec": "none", "pad": 1, "alpha": 0.75},
    )


def chart_summary(report: Row, out: Path) -> list[Path]:
    """Both ratios for every scene and peer, ours over theirs, one line a scene.

    A thin bar spans the cost ratios at all errors from the smallest that both reach up to a tenth.
    """
    plt = _pyplot()
    summary = report["summary"]
    if not summary:
        return []
    titles = {scene["scene"]: scene["title"] for scene in report["scenes"]}
    names = list(dict.fromkeys(row["scene"] for row in summary))
    names.sort(key=lambda name: -_mean_log(summary, name))
    peers = list(dict.fromkeys(row["peer"] for row in summary))
    figure, axes = plt.subplots(
        1, 2, figsize=(10, 1.7 + 0.26 * len(names)), sharey=True, layout="constrained", width_ratios=(1.2, 1)
    )
    labels = {
        "cost_ratio_at_matched_error": "cost ratio at matched error (bar: at coarser errors)",
        "error_ratio_at_matched_cost": "error ratio at matched cost",
    }
    for ax, (which, label) in zip(axes, labels.items(), strict=True):
        low, high = RANGE
        ax.set(xscale="log", xlim=(low / 1.5, high * 1.5), xlabel=f"{label}\nrigidarea / peer")
        ax.axvspan(low / 1.5, 1, color="#eaf3fa", zorder=0)
        ax.axvline(1, color="#666666", lw=1)
        for row in summary:
            value, peer = row[which], row["peer"]
            if value is None or math.isnan(value):
                continue
            y = names.index(row["scene"]) + 0.34 * (0.5 - peers.index(row["peer"]) / max(len(peers) - 1, 1))
            if which.startswith("cost"):
                span = [min(max(row[key], low), high) for key in ("cost_ratio_low", "cost_ratio_high")]
                ax.plot(span, (y, y), color=colour(peer), lw=1.4, alpha=0.45, solid_capstyle="butt")
            shown = min(max(value, low), high)
            ax.plot(shown, y, marker=marker(peer), color=colour(peer), ms=5.5, ls="")
            if shown != value:  # beyond the edge of the picture
                ax.plot(
                    high * 1.25 if value > high else low / 1.25,
                    y,
                    marker=5 if value > high else 4,
                    color=colour(peer),
                )
        ax.text(0.01, 1.005, "rigidarea better", transform=ax.transAxes, fontsize=8, color="#0072B2")
        ax.text(0.99, 1.005, "peer better", transform=ax.transAxes, fontsize=8, color="#666666", ha="right")
    axes[0].set_yticks(range(len(names)), [titles[name] for name in names])
    axes[0].set_ylim(-0.7, len(names) - 0.3)
    handles = [
        plt.Line2D([], [], ls="", color=colour(p), marker=marker(p), label=f"against {p}") for p in peers
    ]
    figure.legend(handles=handles, loc="outside upper center", ncols=len(handles))
    return save(figure, out, "chart-summary")


def _mean_log(summary: Sequence[Row], scene: str) -> float:
    values = [row["cost_ratio_at_matched_error"] for row in summary if row["scene"] == scene]
    logs = [math.log10(v) if v and math.isfinite(v) else 9.0 for v in values]
    return sum(logs) / len(logs)


def frame_times(report: Row, out: Path) -> list[Path]:
    """Median frame time (a line to the 99th percentile) over the number of bodies, one panel a scene."""
    plt = _pyplot()
    rows = report["results"]
    scenes = list(dict.fromkeys(row["scene"] for row in rows))
    figure, axes = plt.subplots(
        1, len(scenes), figsize=(10, 4.2), sharey=True, squeeze=False, layout="constrained"
    )
    for ax, scene in zip(axes.flat, scenes, strict=True):
        groups: dict[tuple[str, int], list[Row]] = {}
        for row in rows:
            if row["scene"] == scene:  # steps: 0 where the library chooses them
                groups.setdefault((row["peer"], row["settings"].get("steps", 0)), []).append(row)
        seen: list[str] = []
        for (peer, steps), group in groups.items():
            x = [row["bodies"] for row in group]
            y = [row["frame_ms_median"] for row in group]
            label = f"{peer}, {steps} step{'s' * (steps > 1)} a frame" if steps else peer
            style = "-" if peer in seen else "--"
            seen.append(peer)
            ax.plot(
                x,
                y,
                style if steps else "-",
                color=colour(peer),
                marker=marker(peer),
                ms=5,
                lw=1.6,
                label=label,
            )
            ax.vlines(x, y, [row["frame_ms_p99"] for row in group], color=colour(peer), lw=1)
        ax.axhline(1e3 / 60, color="#666666", lw=1, ls=":")
        ax.text(0.02, 1e3 / 60 * 1.1, "60 frames a second", transform=ax.get_yaxis_transform(), fontsize=7.5)
        ax.set(xscale="log", yscale="log", xlabel="bodies", title=scene)
    axes[0, 0].set_ylabel("frame time (ms): median, bar to 99th percentile")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return save(figure, out, "bench-frames")


def everyday_times(report: Row, out: Path) -> list[Path]:
    """Median frame of every game scene over that of pymunk's one step, a line a scene."""
    plt = _pyplot()
    rows = list(reversed([row for row in report["results"] if row["native_1_ms"]]))
    if not rows:
        return []
    figure, ax = plt.subplots(figsize=(10, 1.6 + 0.34 * len(rows)), layout="constrained")
    kinds = (
        ("frame_ms_median", "rigidarea-default", "rigidarea, the default"),
        ("native_1_ms", "pymunk", "pymunk, one step a frame"),
        ("native_4_ms", "pymunk", "pymunk, four"),
        ("box2d_ms", "box2d", "Box2D v3, four substeps"),
    )
    for key, peer, label in kinds:
        found = [(row[key] / row["native_1_ms"], y) for y, row in enumerate(rows) if row[key]]
        hollow = {"mfc": "white"} if key == "native_4_ms" else {}
        ax.plot(*zip(*found), ls="", marker=marker(peer), color=colour(peer), ms=8, label=label, **hollow)
    for y, row in enumerate(rows):
        ax.text(
            1.01,
            y,
            f"{row['native_1_ms']:.3g} ms",
            transform=ax.get_yaxis_transform(),
            va="center",
            fontsize=8,
        )
    names = [f"{row['title']}{'' if row['judged'] else ' *'}" for row in rows]
    ax.set_yticks(range(len(rows)), names)
    ax.set(xscale="log", xlabel="frame time over that of pymunk's one step, which stands on the right")
    ax.xaxis.set_major_formatter("{x:g}")
    ax.axvline(1, color="#666666", lw=1)
    ax.text(0, -0.13, "* shown, not in the summary", transform=ax.transAxes, fontsize=8, ha="right", va="top")
    figure.legend(*ax.get_legend_handles_labels(), loc="outside upper center", ncols=4)
    return save(figure, out, "bench-everyday")


def kernel_times(report: Row, out: Path) -> list[Path]:
    """One overlap query beside shapely's intersection, for every pair of outlines."""
    plt = _pyplot()
    rows = report["results"]
    figure, ax = plt.subplots(figsize=(10, 1.4 + 0.42 * len(rows)), layout="constrained")
    for y, row in enumerate(reversed(rows)):
        ax.plot([row["query_us"], row["shapely_us"]], [y, y], color="#bbbbbb", lw=1.5, zorder=1)
        ax.plot(row["query_us"], y, marker="o", color=colour("rigidarea"), ms=8)
        ax.plot(row["shapely_us"], y, marker="s", color="#E69F00", ms=8)
        ratio = row["shapely_us"] / row["query_us"]
        ax.text(row["shapely_us"] * 1.15, y, f"{ratio:.0f} ×", va="center", fontsize=8.5, color="#444444")
    names = [f"{row['pair']} ({row['points_a']} and {row['points_b']} points)" for row in reversed(rows)]
    ax.set_yticks(range(len(rows)), names)
    ax.set(xscale="log", xlabel="one query: area, centroid (µs)")
    handles = [
        plt.Line2D([], [], ls="", marker="o", color=colour("rigidarea"), label="rigidarea"),
        plt.Line2D([], [], ls="", marker="s", color="#E69F00", label="shapely"),
    ]
    figure.legend(handles=handles, loc="outside upper center", ncols=2)
    return save(figure, out, "bench-kernels")


def our_name(rows: Sequence[Row]) -> list[str]:
    """Names of our own peers in rows."""
    return [name for name in dict.fromkeys(row["peer"] for row in rows) if get_peer(name).ours]
