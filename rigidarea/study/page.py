"""What README.md and docs/study.md show: pictures copied, tables of the page renewed between their markers.

A table called `name` stands between the lines `<!-- name -->` and `<!-- /name -->`; everything else is written by hand.
"""

from __future__ import annotations

import math
import re
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..report import write_json
from . import atlas, front
from .causes import CAUSES
from .chart import points
from .peers import KNOWN_WELL
from .records import Row

NAME = "study.md"


def renew(
    docs: Path, tables: Mapping[str, str], pictures: Mapping[str, Path], name_of_page: str = NAME
) -> None:
    """Put `pictures` (name in `docs`: file) and `tables` (name: Markdown, in that page) into the folder `docs`.

    Raises ValueError for a table that the page has no place for.
    """
    docs.mkdir(parents=True, exist_ok=True)
    for name, picture in pictures.items():
        shutil.copyfile(picture, docs / name)
    if not tables:
        return
    target = docs / name_of_page
    text = (
        target.read_text() if target.exists() else "".join(f"<!-- {n} -->\n<!-- /{n} -->\n" for n in tables)
    )
    for name, table in tables.items():
        marked = re.compile(f"(<!-- {name} -->\n).*?(<!-- /{name} -->)", re.DOTALL)
        if not marked.search(text):
            raise ValueError(f"{target} has no place for the table {name!r}: expected a line <!-- {name} -->")
        text = marked.sub(lambda found, table=table: found[1] + table + found[2], text)  # type: ignore[misc]
    target.write_text(text)


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
    counted = [
        f"- {row['peer']}: our whole front is no dearer than its front on {row['front_even']} of {row['scenes']} "
        f"scenes; our default than its front on {row['default_even']} of {row['scenes_default']}, than its default on "
        f"{row['no_dearer']}, no less exact on {row['no_worse']}, both on {row['both']}; ours fails on "
        f"{row['default_failed']}, its own on {row['peer_default_failed']}.\n"
        for row in report["summary_defaults"]
    ]
    return markdown(columns, rows) + "\n" + "".join(counted)


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


def keep(docs: Path, name: str, report: Row) -> None:
    """Keep what a command has measured, from which the pages' tables are made: `docs/results/name.json`."""
    write_json(report, docs / "results" / f"{name}.json")


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
    """A line a map: what is asked, theory, and the share passed by each engine."""
    shares = {(row["map"], row["peer"]): row for row in atlas.passed(report["results"])}
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
    return markdown(["map", "knobs", "theory", "passed (how the others failed)"], rows)
