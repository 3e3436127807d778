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

LOOKS = {
    "rigidarea": ("#0072B2", "o"),
    "rigidarea-default": ("#56B4E9", "*"),
    "rigidarea-explicit": ("#999999", "."),
    "rigidarea-implicit": ("#000000", "X"),
    "compliant": ("#CC79A7", "v"),
    "modal": ("#E69F00", "D"),
    "pymunk": ("#D55E00", "s"),
    "box2d": ("#009E73", "^"),
    "literal": ("#CC79A7", "x"),
}
"""Colour and marker of a peer, the same in every picture."""
RANGE = (1e-3, 1e3)
"""Ratios that the summary shows; beyond, an arrow at its edge."""
PAGE = (3, 3)
"""Rows and columns of panels on a page of 1000 pixels width."""


def pyplot() -> Any:
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


def panels(count: int, across: int, tall: float, head: float = 0.0, **more: Any) -> tuple[Figure, Any]:
    """A figure of `count` panels, `across` on a line of `tall` inches, and its axes (lines, across)."""
    lines = -(-count // across)
    size = (10, head + tall * lines)
    figure, axes = pyplot().subplots(lines, across, figsize=size, squeeze=False, layout="constrained", **more)
    for ax in axes.flat[count:]:
        ax.set_axis_off()
    return figure, axes


def mark(peer: str, label: str = "", **look: Any) -> Any:
    """A legend's handle: the peer's mark; without a peer, as `look` says."""
    if peer:
        look = {"color": colour(peer), "marker": marker(peer), **look}
    return pyplot().Line2D([], [], **{"label": label or peer, "ls": "", **look})


def colour(peer: str) -> str:
    """The colour of a peer."""
    return LOOKS[peer][0]


def marker(peer: str) -> str:
    """The marker of a peer."""
    return LOOKS[peer][1]


def save(figure: Figure, out: Path, name: str) -> list[Path]:
    """PNG (1000 pixels for a figure 10 inches wide) and SVG."""
    out.mkdir(parents=True, exist_ok=True)
    paths = [out / f"{name}.png", out / f"{name}.svg"]
    figure.savefig(paths[0], dpi=100)
    figure.savefig(paths[1], metadata={"Date": None})
    pyplot().close(figure)
    return paths


def chart_pages(report: Row, out: Path) -> list[Path]:
    """Error against cost, one panel a scene, nine panels a page, each peer's front as a stepped line."""
    plt = pyplot()
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
        handles = [mark(name, ls="-", ms=5) for name in names]
        handles.append(mark("", "at the defaults", color="#111111", marker="o", mfc="none", ms=9))
        figure.legend(handles=handles, loc="outside upper center", ncols=min(len(handles), 5))
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
    here = [row for row in rows if row["scene"] == scene["scene"]]
    top = max((row["error"] for row in here if row["error"]), default=1.0)
    most = 8 * min(top, 10.0)  # room for the words at the top
    for row in here:
        if row.get("default"):
            # at the edge: failed, or further off than the panel shows
            error = most / 6 if row["error"] is None else min(max(row["error"], floor / 3), most / 6)
            at, peer, mine = (row["cost_s_per_s"], error), row["peer"], get_peer(row["peer"]).ours
            ax.plot(*at, marker=marker(peer), ms=10 if mine else 5, color=colour(peer), ls="", zorder=4)
            ax.plot(*at, marker="o", ms=15 if mine else 9, mfc="none", mec="#111111", ls="", zorder=5)
    ax.set(xscale="log", yscale="log")
    ax.set_ylim(floor / 4, most)
    ax.axhspan(floor / 4, floor, color="#f3f3f3", zorder=0)
    ax.set_title(scene["title"], loc="left")
    look: dict[str, Any] = {
        "fontsize": 7.5,
        "color": "#444444",
        "ha": "right",
        "va": "top",
        "transform": ax.transAxes,
    }
    paper = {"fc": "white", "ec": "none", "pad": 1, "alpha": 0.75}
    ax.text(0.98, 0.97, scene["error_name"], **look, bbox=paper)


def _ratio_axes(report: Row, summary: Sequence[Row], key: str, labels: Sequence[str], **size: Any) -> Any:
    """Two axes for ratios, ours over theirs, a line a scene, where the mean of `key` is largest first.

    Returns the figure, the axes, and a function that says at which height a row of the summary is drawn.
    """
    titles = {scene["scene"]: scene["title"] for scene in report["scenes"]}
    names = list(dict.fromkeys(row["scene"] for row in summary))
    names.sort(key=lambda name: -_mean_log(summary, name, key))
    peers = list(dict.fromkeys(row["peer"] for row in summary))
    tall = size.pop("above") + 0.26 * len(names)
    figure, axes = pyplot().subplots(1, 2, figsize=(10, tall), sharey=True, layout="constrained", **size)
    low, high = RANGE
    for ax, label in zip(axes, labels, strict=True):
        ax.set(xscale="log", xlim=(low / 1.5, high * 1.5), xlabel=label)
        ax.axvspan(low / 1.5, 1, color="#eaf3fa", zorder=0)
        ax.axvline(1, color="#666666", lw=1)
        ax.text(0.01, 1.005, "rigidarea better", transform=ax.transAxes, fontsize=8, color="#0072B2")
        ax.text(0.99, 1.005, "peer better", transform=ax.transAxes, fontsize=8, color="#666666", ha="right")
    axes[0].set_yticks(range(len(names)), [titles[name] for name in names])
    axes[0].set_ylim(-0.7, len(names) - 0.3)

    def height(row: Row) -> float:
        share = peers.index(row["peer"]) / max(len(peers) - 1, 1)
        return names.index(row["scene"]) + 0.34 * (0.5 - share)

    return figure, axes, height


def _mark(ax: Axes, ratio: float, y: float, peer: str, **look: Any) -> None:
    """A mark at a ratio; where it is beyond RANGE, one at its end and an arrow."""
    low, high = RANGE
    shown = min(max(ratio, low), high)
    ax.plot(shown, y, marker=marker(peer), color=colour(peer), ms=5.5, ls="", **look)
    if shown != ratio:
        edge, arrow = (high * 1.25, 5) if ratio > high else (low / 1.25, 4)
        ax.plot(edge, y, marker=arrow, color=colour(peer))


def _marks_legend(figure: Figure, summary: Sequence[Row], *kinds: tuple[str, dict[str, Any]]) -> None:
    """A legend of each peer's mark, in each of the kinds (label with {}, look), and of what is beyond RANGE."""
    peers = dict.fromkeys(row["peer"] for row in summary)
    handles = [mark(peer, label.format(peer), **look) for label, look in kinds for peer in peers]
    handles.append(mark("", "beyond the edge", color="#666666", marker=5))
    figure.legend(handles=handles, loc="outside upper center", ncols=len(handles))


def chart_summary(report: Row, out: Path) -> list[Path]:
    """Both ratios for every scene and peer, ours over theirs, one line a scene.

    A thin bar spans the cost ratios at all errors from the smallest that both reach up to a tenth.
    """
    summary = report["summary"]
    if not summary:
        return []
    keys = ("cost_ratio_at_matched_error", "error_ratio_at_matched_cost")
    kinds = ("cost ratio at matched error (bar: at coarser errors)", "error ratio at matched cost")
    labels = [f"{kind}\nrigidarea / peer" for kind in kinds]
    figure, axes, height = _ratio_axes(report, summary, keys[0], labels, above=1.7, width_ratios=(1.2, 1))
    low, high = RANGE
    for ax, key in zip(axes, keys, strict=True):
        for row in summary:
            if row[key] is None or math.isnan(row[key]):
                continue
            y, peer = height(row), row["peer"]
            if key.startswith("cost"):
                span = [min(max(row[key], low), high) for key in ("cost_ratio_low", "cost_ratio_high")]
                ax.plot(span, (y, y), color=colour(peer), lw=1.4, alpha=0.45, solid_capstyle="butt")
            _mark(ax, row[key], y, peer)
    _marks_legend(figure, summary, ("against {}", {}))
    return save(figure, out, "chart-summary")


def chart_defaults(report: Row, out: Path) -> list[Path]:
    """Our default alone, one line a scene: against the peer's whole front, and against the peer's own default.

    Left: its cost over that with which the peer does as well. Right: cost (filled) and error (hollow) of our default
    over those of the peer's. What fails is at the right edge.
    """
    summary = [row for row in report["summary"] if "default_error" in row]
    if not summary:
        return []
    labels = ("cost ratio at our default's error\nour default / peer's front", "our default / peer's default")
    key = "default_cost_ratio"
    figure, axes, height = _ratio_axes(report, summary, key, labels, above=1.9, width_ratios=(1, 1.2))
    hollow = {"mfc": "white"}
    looks: dict[str, tuple[Any, dict[str, Any]]] = {
        key: (axes[0], {}),
        "defaults_cost_ratio": (axes[1], {}),
        "defaults_error_ratio": (axes[1], hollow),
    }
    for row in summary:
        for kind, (ax, look) in looks.items():
            value = row.get(kind)
            if value is None:  # infinite, or no number: in JSON both are null
                value = math.inf if row["default_error"] in (None, math.inf) else math.nan
            if not math.isnan(value):
                _mark(ax, value, height(row), row["peer"], **look)
    _marks_legend(figure, summary, ("against {}: cost", {}), ("{}: error", hollow))
    return save(figure, out, "chart-defaults")


def _mean_log(summary: Sequence[Row], scene: str, key: str) -> float:
    values = [row[key] for row in summary if row["scene"] == scene]
    logs = [math.log10(v) if v and math.isfinite(v) else 9.0 for v in values]
    return sum(logs) / len(logs)


def kernel_times(report: Row, out: Path) -> list[Path]:
    """One overlap query beside shapely's intersection, for every pair of outlines."""
    plt = pyplot()
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
    figure.legend(
        handles=[mark("rigidarea"), mark("", "shapely", marker="s", color="#E69F00")],
        loc="outside upper center",
        ncols=2,
    )
    return save(figure, out, "bench-kernels")
