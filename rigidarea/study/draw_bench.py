"""The pictures of `bench frames` and `bench everyday`."""

from __future__ import annotations

from pathlib import Path

from .draw import colour, marker, panels, pyplot, save
from .growing_scenes import GROWING
from .records import Row


def frame_times(report: Row, out: Path) -> list[Path]:
    """Median frame time (a line to the 99th percentile) over the number of bodies, one panel a scene."""
    rows = report["results"]
    scenes = list(dict.fromkeys(row["scene"] for row in rows))
    figure, axes = panels(len(scenes), len(scenes), 4.2, sharey=True)
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
            look = {"color": colour(peer), "marker": marker(peer), "ms": 5, "lw": 1.6}
            ax.plot(x, y, style if steps else "-", label=label, **look)
            ax.vlines(x, y, [row["frame_ms_p99"] for row in group], color=colour(peer), lw=1)
        ax.axhline(1e3 / 60, color="#666666", lw=1, ls=":")
        ax.text(0.02, 1e3 / 60 * 1.1, "60 frames a second", transform=ax.get_yaxis_transform(), fontsize=7.5)
        ax.set(xscale="log", yscale="log", xlabel="bodies", title=scene)
    axes[0, 0].set_ylabel("frame time (ms): median, bar to 99th percentile")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return save(figure, out, "bench-frames")


def everyday_times(report: Row, out: Path) -> list[Path]:
    """Median frame of every game scene over that of pymunk's one step, a line a scene."""
    plt = pyplot()
    rows = list(reversed([row for row in report["results"] if row["native_1_ms"]]))
    if not rows:
        return []
    figure, ax = plt.subplots(figsize=(10, 1.6 + 0.34 * len(rows)), layout="constrained")
    kinds = (
        ("frame_ms_median", "rigidarea-default", "rigidarea, the default", {"ms": 11, "zorder": 3}),
        ("native_1_ms", "pymunk", "pymunk, one step a frame", {"ms": 8}),
        ("native_4_ms", "pymunk", "pymunk, four", {"ms": 8, "mfc": "white"}),
        ("box2d_ms", "box2d", "Box2D v3, four substeps", {"ms": 8}),
    )
    for key, peer, label, look in kinds:
        found = [(row[key] / row["native_1_ms"], y) for y, row in enumerate(rows) if row[key]]
        ax.plot(*zip(*found), ls="", marker=marker(peer), color=colour(peer), label=label, **look)
    beside = {"transform": ax.get_yaxis_transform(), "va": "center", "fontsize": 8}
    for y, row in enumerate(rows):
        ax.text(1.01, y, f"{row['native_1_ms']:.3g} ms", **beside)
    names = [f"{row['title']}{'' if row['judged'] else ' *'}" for row in rows]
    ax.set_yticks(range(len(rows)), names)
    ax.set(xscale="log", xlabel="frame time over that of pymunk's one step, which stands on the right")
    ax.xaxis.set_major_formatter("{x:g}")
    ax.xaxis.set_minor_formatter("{x:.1g}")
    ax.axvline(1, color="#666666", lw=1)
    note = {"xycoords": "axes fraction", "textcoords": "offset points", "ha": "right", "va": "center"}
    ax.annotate("* shown, not counted in the summary", (0, 0), (-8, -30), fontsize=8, **note)
    figure.legend(*ax.get_legend_handles_labels(), loc="outside upper center", ncols=4)
    return save(figure, out, "bench-everyday")


GROWN = ("tiles", "sleepers", "come", "rolling discs 0", "rolling boxes 0", "flight")
"""Families of `bench growth` that the picture shows."""


def growth(report: Row, out: Path) -> list[Path]:
    """Mean frame time of the three engines over the size of what there is, a panel a family (to the slowest tenth)."""
    rows = report["results"]
    grown = [name for name in GROWN if sum(row["scene"] == name and row["size"] > 0 for row in rows) > 1]
    if not grown:
        return []
    figure, axes = panels(len(grown), min(3, len(grown)), 2.8, 0.8, sharey=True)
    engines = (
        ("frame_us_mean", "frame_us_worst_tenth", "rigidarea-default", "rigidarea, the default"),
        ("native_1_us", "native_1_us_worst_tenth", "pymunk", "pymunk, one step a frame"),
        ("box2d_us", "box2d_us_worst_tenth", "box2d", "Box2D v3, four substeps"),
    )
    for ax, name in zip(axes.flat, grown):
        own = [row for row in rows if row["scene"] == name and row["size"] > 0]
        for k, (mean, worst, peer, label) in enumerate(engines):
            found = [row for row in own if row[mean]]
            x = [row["size"] * 1.04 ** (k - 1) for row in found]  # bars beside each other
            y = [row[mean] for row in found]
            ax.plot(x, y, color=colour(peer), marker=marker(peer), ms=6, lw=1.6, label=label)
            ax.vlines(x, y, [row[worst] for row in found], color=colour(peer), lw=1)
        ax.set(xscale="log", yscale="log", title=GROWING[name].title)
        ax.title.set_fontsize(10)
        sizes = [row["size"] for row in own]
        ax.set_xticks(sizes, [f"{size:,}" for size in sizes])
        ax.minorticks_off()
        ax.yaxis.set_major_formatter("{x:,g}")
    for ax in axes[:, 0]:
        ax.set_ylabel("µs a frame, bar: worst tenth")
    what = "how many: pieces of level or terrain (radius 0: lines without thickness), bodies"
    figure.supxlabel(what, fontsize=9)
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return save(figure, out, "bench-growth")


def phases(report: Row, out: Path) -> list[Path]:
    """Where a frame's time goes: a stacked bar a scene."""
    plt = pyplot()
    rows = list(reversed(report["phases"]))
    names = [key for key in rows[0] if key.endswith("_us") and key != "frame_us"]
    figure, ax = plt.subplots(figsize=(10, 1.4 + 0.55 * len(rows)), layout="constrained")
    left = [0.0] * len(rows)
    own = plt.get_cmap("viridis")([i / (len(names) - 2) for i in range(len(names) - 1)])
    for name, shade in zip(names, [colour("pymunk"), *own]):
        values, label = [max(0.0, row[name]) for row in rows], name.removesuffix("_us").replace("_", " ")
        ax.barh(range(len(rows)), values, left=left, color=shade, label=label)
        left = [a + b for a, b in zip(left, values)]
    ax.set_yticks(range(len(rows)), [row["scene"] for row in rows])
    ax.set_xlabel("processor time of a frame (µs)")
    figure.legend(*ax.get_legend_handles_labels(), loc="outside upper center", ncols=4)
    return save(figure, out, "bench-phases")
