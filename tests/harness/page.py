"""The figures of README.md and of the pages in docs/: every one is made from a file of results, none is typed.

`docs/results/NAME.json` is what a command or a test run has measured (`keep`). A page names what it shows of it:

    <!-- growth -->                              a table or sentences: one of `TABLES`, which says of which results
    ...
    <!-- /growth -->
    <!-- figure tests lens_error .0e -->2e-12<!-- /figure -->    one number: file, place in it, format

`renew` writes all that stands between such marks anew, and nothing else; `make docs` does so before it builds.
"""

from __future__ import annotations

import importlib
import json
import math
import re
import shutil
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any

from rigidarea.report import solver, write_json
from rigidarea.study import front
from rigidarea.study.chart import points
from rigidarea.study.records import Row

from .causes import CAUSES

TABLES = {
    "ratios": ("chart", "ratios"),
    "defaults": ("chart", "defaults"),
    "counts": ("chart", "counts"),
    "dominated": ("chart", "dominated"),
    "known_well": ("chart", "known_well"),
    "everyday": ("everyday", "everyday"),
    "everyday_summary": ("everyday", "everyday_summary"),
    "moving": ("everyday", "moving"),
    "growth": ("growth", "growth"),
    "levels": ("growth", "levels"),
    "maps": ("atlas", "maps"),
    "levels_compared": ("compare", "levels_compared"),
    "plan_summary": ("plan", ".plan_picture:summaries"),
    "plan_outside": ("plan", ".plan_picture:outside"),
    "pymunk_examples": ("pymunk-examples", ".command:examples_page"),
    "pymunk_tests": ("pymunk-tests", ".command:tests_page"),
}
"""Name in a page: (results, what makes it of them: a function of this module, or of another: `module:function`)."""

MARK = re.compile(
    r"<!-- (?P<name>\w+)(?P<what>(?: [^\s>]+)*) -->(?P<shown>.*?)<!-- /(?P=name) -->", re.DOTALL
)
"""What a page shows of results, between its two marks."""


def renewed(text: str, results: Path) -> str:
    """The text of a page with everything made anew from the files in the folder `results`.

    What has no file there is left as it is. Raises ValueError for a name that is none of `TABLES`, KeyError for a place
    that is not in a file.
    """

    def made(found: re.Match[str]) -> str:
        name, what = found["name"], found["what"].split()
        if name != "figure" and name not in TABLES:
            raise ValueError(f"a page shows {name!r}: expected figure or one of {', '.join(TABLES)}")
        file = results / f"{what[0] if name == 'figure' else TABLES[name][0]}.json"
        if not file.exists():
            return found[0]
        report = json.loads(file.read_text())
        shown = figure(report, *what[1:]) if name == "figure" else "\n" + _maker(name)(report)
        return found[0].replace(f"-->{found['shown']}<!--", f"-->{shown}<!--")

    return MARK.sub(made, text)


def _maker(name: str) -> Callable[[Row], str]:
    module, _, function = TABLES[name][1].rpartition(":")
    made: Callable[[Row], str] = (
        getattr(importlib.import_module(module, __package__), function) if module else globals()[function]
    )
    return made


def figure(report: Row, place: str, form: str = "") -> str:
    """The number at `place` (keys, from the outermost, with dots between), in Python's format `form` (else `number`).

    Raises KeyError for a place that is not there.
    """
    value: Any = report
    for key in place.split("."):
        value = value[int(key) if isinstance(value, list) else key]
    return format(value, form) if form else number(value)


def pages(docs: Path) -> list[Path]:
    """README.md beside the folder `docs`, and the pages in it."""
    return [docs.parent / "README.md", *sorted(docs.rglob("*.md"))]


def renew(docs: Path) -> list[Path]:
    """Renew README.md and all pages of the folder `docs` from its `results`; which have changed."""
    changed = []
    for page in pages(docs):
        if page.exists() and (new := renewed(text := page.read_text(), docs / "results")) != text:
            page.write_text(new)
            changed.append(page)
    return changed


def keep(docs: Path, name: str, report: Row, pictures: Mapping[str, Path] | None = None) -> None:
    """Keep what a command has measured as `docs`/results/`name`.json, its pictures (name in `docs`: file); renew the
    pages.
    """
    write_json(report, docs / "results" / f"{name}.json")
    for shown, picture in (pictures or {}).items():
        shutil.copyfile(picture, docs / shown)
    renew(docs)


def older(docs: Path) -> list[str]:
    """The results in `docs` that were measured on another solver than the one that is here."""
    now = solver()
    files = sorted((docs / "results").glob("*.json"))
    return [file.stem for file in files if json.loads(file.read_text())["versions"].get("solver") != now]


def markdown(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table; columns of numbers to the right."""
    right = [all(re.match(r"^[-–∞\d.]", row[i]) for row in rows) for i in range(len(columns))]
    lines = [columns, ["--:" if r else "---" for r in right], *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def number(value: float | None) -> str:
    """Two digits; ∞ for what is out of reach (JSON's null)."""
    if value is None or not math.isfinite(value):
        return "∞"
    return (
        f"{float(f'{value:.2g}'):g}"
        if value == 0 or 0.01 <= value < 1000
        else f"{value:.0e}".replace("e-0", "e-").replace("e+0", "e")
    )


def ratios(report: Row) -> str:
    """Cost ratios of all scenes against each foreign peer, at the smallest error both reach and over the range."""
    rows = []
    titles = {scene["scene"]: scene["title"] for scene in report["scenes"]}
    peers = list(dict.fromkeys(row["peer"] for row in report["summary"]))
    for name in dict.fromkeys(row["scene"] for row in report["summary"]):
        found = {row["peer"]: row for row in report["summary"] if row["scene"] == name}
        cells = [titles[name], f"`{name}`"]
        for peer in peers:
            row = found.get(peer)
            if row is None:
                cells += ["", "", "", ""]
                continue
            cells += [
                number(row["matched_error"]),
                number(row["cost_ratio_at_matched_error"]),
                number(row["cost_ratio_mean"]),
                number(row["default_cost_ratio"]) if "default_error" in row else "–",
            ]
        rows.append(cells)
    columns = ["scene", "name"]
    for peer in peers:
        columns += [
            f"{peer}: matched error",
            "cost ratio there",
            "mean ratio up to 10 %",
            "our default's ratio",
        ]
    return markdown(columns, rows)


def defaults(report: Row) -> str:
    """Our default on every scene beside each peer's: errors and costs; and a last line a peer that counts."""
    titles = {scene["scene"]: scene["title"] for scene in report["scenes"]}
    summary = [row for row in report["summary"] if "default_error" in row]
    peers = list(dict.fromkeys(row["peer"] for row in summary))
    rows = []
    for name in dict.fromkeys(row["scene"] for row in summary):
        found = {row["peer"]: row for row in summary if row["scene"] == name}
        first = next(iter(found.values()))
        cells = [titles[name], number(first["default_error"]), number(first["default_cost_s_per_s"])]
        for peer in peers:
            row = found.get(peer, {})
            keys = ("peer_default_error", "defaults_cost_ratio", "default_cost_ratio")
            cells += [number(row[key]) if key in row else "–" for key in keys]
        rows.append(cells)
    columns = ["scene", "error at our default", "cost (s/s)"]
    for peer in peers:
        columns += [f"{peer}'s default: error", "our cost over its", "our default over its front"]
    return markdown(columns, rows)


def counts(report: Row) -> str:
    """On how many scenes we are no dearer than each peer, our front and our default alone: a line a peer."""
    few = "- Few settings of each engine: `--quick`.\n" if report["settings"]["quick"] else ""
    return few + "".join(
        f"- {row['peer']}: our whole front is no dearer than its front on {row['front_even']} of {row['scenes']} "
        f"scenes; our default than its front on {row['default_even']} of {row['scenes_default']}, than its default on "
        f"{row['no_dearer']}, no less exact on {row['no_worse']}, both on {row['both']}; ours fails on "
        f"{row['default_failed']}, its own on {row['peer_default_failed']}.\n"
        for row in report["summary_defaults"]
    )


def everyday(report: Row) -> str:
    """Game scenes: frame times of all engines (ms), what still moves in the last second, and contacts a frame."""
    keys = ("frame_ms_median", "native_1_ms", "native_4_ms", "box2d_ms", "ratio", "speed_left")
    more = ("native_4_speed_left", "box2d_speed_left", "contacts", "native_contacts")
    rows = [
        [
            row["title"] + ("" if row["judged"] else " *"),
            str(row["bodies"]),
            str(row["steps_per_frame"]),
            *("–" if row[key] is None else number(row[key]) for key in (*keys, *more)),
            "yes" if row["inside"] else "no",
        ]
        for row in report["results"]
    ]
    columns = ["scene", "bodies", "substeps", "rigidarea", "pymunk, 1 step", "pymunk, 4", "Box2D", "ratio"]
    columns += ["fastest at the end", "pymunk's, 4", "Box2D's", "contacts", "pymunk's, 1", "all inside"]
    return markdown(columns, rows)


def moving(report: Row) -> str:
    """Game scenes while they move: the mean frame and the mean of the slowest tenth (ms) of each engine."""
    engines = ("", "native_1_", "native_4_", "box2d_")
    rows = []
    for row in report["results"]:
        cells = [row["title"]]
        for engine in engines:
            mean, worst = row[f"{engine}moving_ms"], row[f"{engine}moving_worst_ms"]
            cells.append("–" if mean is None else f"{number(mean)}, {number(worst)}")
        rows.append(cells)
    return markdown(["scene", "rigidarea", "pymunk, 1 step", "pymunk, 4", "Box2D v3"], rows)


SEEN = 0.05
"""px/s: what is slower moves by less than a pixel in twenty seconds."""


def everyday_summary(report: Row) -> str:
    """What the judged scenes cost over pymunk's step, and which scenes keep moving or cost more than its four steps."""
    told, rows = report["summary"], report["results"]
    dear = [
        row["title"] for row in rows if row["native_4_ms"] and row["frame_ms_median"] > row["native_4_ms"]
    ]
    restless = [
        f"{row['title']} ({number(row['speed_left'])})"
        for row in rows
        if row["scene"] in told["faster_than_native_4"] and row["speed_left"] > SEEN
    ]
    moving = {
        row["title"]: row["moving_ms"] / row["native_1_moving_ms"]
        for row in rows
        if row["native_1_moving_ms"]
    }
    settled = {row["title"]: row["ratio"] for row in rows if row["ratio"]}
    text = f"- At the defaults, over pymunk's single step, in these {len(rows)} scenes: "
    for what, ratios in (("the mean frame while they move", moving), ("the median frame of all", settled)):
        worst = max(ratios, key=lambda title: ratios[title])
        text += f"{what} {number(median(ratios.values()))} (the median scene; the worst, {worst}, "
        text += f"{number(ratios[worst])}), "
    text = text[:-2] + ".\n"
    if dear:
        text += f"- More than pymunk's four steps a frame: {', '.join(dear)}.\n"
    if restless:
        text += "- In the last second something still moves, faster than at pymunk's four steps (px/s), in: "
        text += ", ".join(restless) + ".\n"
    return text


def growth(report: Row) -> str:
    """Families of scenes at their sizes: mean frames (µs), ours over pymunk's step, and what attaching takes."""
    from rigidarea.study.growing_scenes import GROWING

    keys = ("native_1_us", "box2d_us", "frame_us_mean", "ratio_mean", "ratio_worst_tenth", "start_ms")
    rows = [
        [
            GROWING[row["scene"]].title,
            f"{row['size']:,}",
            *("–" if row[key] is None else number(row[key]) for key in keys),
        ]
        for row in report["results"]
        if row["scene"] in GROWING
    ]
    columns = ["scene", "size", "pymunk, 1 step", "Box2D", "rigidarea", "ratio", "worst tenth"]
    return markdown([*columns, "attach and first frame, ms"], rows)


def levels(report: Row) -> str:
    """What a level costs that is merely there: the same boxes on one floor and on the most tiles."""
    rows = sorted((row for row in report["results"] if row["scene"] == "tiles"), key=lambda row: row["size"])
    floor, most = rows[0], rows[-1]
    return (
        f"100 boxes cost {number(floor['frame_us_mean'])} µs a frame on one floor and {number(most['frame_us_mean'])} "
        f"on {most['size']:,} tiles (pymunk's step: {number(floor['native_1_us'])} and {number(most['native_1_us'])}); "
        f"attaching to those tiles takes {number(most['start_ms'] / 1e3)} s.\n"
    )


def levels_compared(report: Row) -> str:
    """Rigid, compliant and modal on each scene: the error where there is an exact answer, the trace's distance from the
    modal level's, and the cost."""
    rows = [
        [
            row["scene"] if row["level"] == "rigid" else "",
            row["level"],
            "–" if row.get("error") is None else number(row["error"]),
            row.get("error_name") or "",
            "–" if row["departure"] is None else number(row["departure"]),
            number(row["cost_s_per_s"]),
        ]
        for row in report["results"]
    ]
    table = markdown(["scene", "level", "error", "of what", "off modal", "cost (s/s)"], rows)
    return f"![rigid, compliant and modal](compare.png)\n\n{table}"


def concise(report: Row) -> Row:
    """The chart's report with no more of its rows than its tables show: each engine's front on each scene."""
    kept = []
    groups: dict[tuple[str, str], list[Row]] = {}
    for row in report["results"]:
        if row["error"] is not None:
            groups.setdefault((row["scene"], row["peer"]), []).append(row)
    for rows in groups.values():
        least = math.inf
        for row in sorted(rows, key=lambda row: (row["cost_s_per_s"], row["error"])):
            if row["error"] < least:
                least = row["error"]
                kept.append(row)
    return {**report, "results": kept}


def dominated(report: Row) -> str:
    """Scenes where a peer's front has a point that ours does not reach as cheaply, and why."""
    titles = {scene["scene"]: scene["title"] for scene in report["scenes"]}
    rows = []
    for name in dict.fromkeys(row["scene"] for row in report["summary"]):
        found = {row["peer"]: row for row in report["summary"] if row["scene"] == name}
        worst = {peer: row["cost_ratio_worst"] for peer, row in found.items()}
        if all(value is not None and value <= 1 for value in worst.values()):
            continue
        ours = front.front(points(report["results"], name, ours=True))
        cells = [titles[name], number(ours[-1].error if ours else None)]
        for peer in found:
            theirs = front.front(points(report["results"], name, peer=peer))
            cells += [
                number(theirs[-1].error if theirs else None),
                number(found[peer]["cost_ratio_at_matched_error"]),
            ]
        rows.append([*cells, CAUSES.get(name, "")])
    columns = ["scene", "our least error"]
    for peer in dict.fromkeys(row["peer"] for row in report["summary"]):
        columns += [f"{peer}'s", f"cost ratio, {peer}"]
    return markdown([*columns, "why"], rows)


KNOWN_WELL: dict[str, dict[str, str]] = {
    "pymunk": {
        "cradle": "elastic impacts one by one: impulses are exact",
        "off_centre_hit": "masses, moment and arm of one impulse",
        "rest": "one box, persistent contact",
        "v_groove_spin": "sliding friction on terrain",
        "conveyor": "sliding friction, a moving surface",
    },
    "box2d": {
        "cradle": "elastic impacts one by one, to single precision",
        "rest": "one box, persistent contact",
        "rocking": "rotation about a corner",
        "incline_slide": "sliding friction",
        "conveyor": "sliding friction, a moving surface",
    },
}
"""Scenes that a foreign peer is known to do well, and why: a wrong set-up would show there first."""


def known_well(report: Row) -> str:
    """Each foreign peer on the scenes it is known to do well: its least error, at which settings and cost."""
    rows = []
    for peer, names in KNOWN_WELL.items():
        for name, why in names.items():
            here = [
                row
                for row in report["results"]
                if row["scene"] == name and row["peer"] == peer and row["error"] is not None
            ]
            if here:
                best = min(here, key=lambda row: (row["error"], row["cost_s_per_s"]))
                settings = ", ".join(f"{k} {_plain(v)}" for k, v in best["settings"].items())
                rows.append(
                    [peer, f"`{name}`", why, number(best["error"]), number(best["cost_s_per_s"]), settings]
                )
    return markdown(["peer", "scene", "why it should", "least error", "cost (s/s)", "settings"], rows)


def _plain(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def maps(report: Row) -> str:
    """A line a map (`atlas.passed` of its results): what is asked, theory, and the share passed by each engine."""
    shares = {(row["map"], row["peer"]): row for row in report["results"]}
    rows = []
    for described in report["maps"]:
        cells = []
        for (name, peer), row in shares.items():
            if name == described["map"]:
                failed = f" ({row['failed']})" if row["failed"] else ""
                cells.append(f"{peer} {row['passed']}/{row['points']}{failed}")
        if cells:
            axes = f"{described['x']} × {described['y']}"
            rows.append([described["title"], axes, described["source"], "; ".join(cells)])
    table = markdown(["map", "knobs", "theory", "passed (how the others failed)"], rows)
    return f"![maps of where methods fail](atlas.png)\n\n{table}"
