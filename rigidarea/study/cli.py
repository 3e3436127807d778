"""The studies' sub-commands: `bench`, `chart`, `atlas`, `compare`.

Light to import: a command imports its work when it is run.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from ..checkout import harness, pages
from ..report import at_least_one, at_least_zero, lines, needed, output_arguments, write_json

BENCHES = {
    "everyday": "game scenes at the defaults, beside pymunk at 1 and 4 steps a frame and Box2D",
    "frames": "crowds of up to 10,000 bodies",
    "growth": "levels, terrains, sleepers, comings and goings, beside pymunk and Box2D",
    "islands": "a pile, gears and balls in one level, each in its own substeps",
    "joints": "chains, bridges, cloth, ragdolls, a car, beside pymunk at 1 and 4 steps a frame",
    "kernels": "one overlap, beside shapely",
    "memory": "of a crowd, a body",
    "sleep": "a sleeping pyramid of 5,050 boxes",
    "start": "from import to the first step",
    "step": "one area step beside one native step; where a frame's time goes",
    "worlds": "many copies of a space at once, beside pymunk's own loop over as many",
}
DRAWN = ("everyday", "frames", "growth", "kernels", "step")
"""Those that end in a picture."""
UNTOLD = ("tags", "error_name")
"""Columns left to the files: too wide for a table."""


def _sweep(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    add("--quick", action="store_true", help="few settings, at most two minutes")
    add("--peer", action="append", default=[], metavar="NAME", help="only this engine (repeatable)")
    add("--workers", type=at_least_zero, metavar="N", help="local processes; 0: none (default: one a core)")
    add("--scheduler", metavar="ADDRESS", help="a Dask scheduler, such as tcp://host:8786")
    add("--fresh", action="store_true", help="forget what an earlier run left in DIR")
    _docs(parser)


def _swept(arguments: argparse.Namespace) -> dict[str, Any]:
    """What `_sweep` asks for, as the sweeps take it."""
    return {
        "out": arguments.out,
        "quick": arguments.quick,
        "peer_names": arguments.peer,
        "scheduler": arguments.scheduler,
        "workers": arguments.workers,
        "resume": not arguments.fresh,
    }


def _sentence(text: str) -> str:
    return f"{text[0].upper()}{text[1:]}."


def _docs(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--docs",
        type=pages,
        metavar="DIR",
        help="in a checkout: keep the results there, and renew what pages show of them",
    )


def add_commands(subparsers: Any) -> None:
    """Add the studies' commands to `argparse` sub-parsers; each sets `run(arguments) -> int`."""
    text = "speed and memory, beside shapely, pymunk's solver and Box2D"
    described = "; ".join(f"{name}: {what}" for name, what in BENCHES.items())
    bench = subparsers.add_parser("bench", help=text, description=f"{_sentence(text)} {described}.")
    bench.add_argument("what", choices=tuple(BENCHES), metavar="WHAT", help=f"one of {', '.join(BENCHES)}")
    bench.add_argument("scene", nargs="*", metavar="SCENE", help="scenes or pairs (default: all)")
    output_arguments(bench, Path("out") / "bench")
    bench.add_argument("--quick", action="store_true", help="up to 1,000 bodies")
    bench.add_argument(
        "--bodies", type=at_least_one, action="append", metavar="N", help="this many (repeatable)"
    )
    bench.add_argument(
        "--peer", action="append", default=[], metavar="NAME", help="only this engine (repeatable)"
    )
    bench.add_argument(
        "--seeds", type=at_least_one, metavar="N", help="everyday: of each scene (default 5; large ones 1)"
    )
    bench.add_argument(
        "--seconds", type=float, metavar="S", help="everyday: simulated time (default 7; towers 2)"
    )
    bench.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="everyday: rigidarea at this setting (steps, iterations, penetration ...; repeatable), not its defaults",
    )
    _docs(bench)
    bench.set_defaults(run=_bench)
    text = "accuracy against speed, beside pymunk's solver and Box2D"
    chart = subparsers.add_parser(
        "chart",
        help=text,
        description=f"{_sentence(text)} Each engine at many settings on each scene: its error, and what it costs.",
    )
    output_arguments(chart, Path("out") / "chart")
    _sweep(chart)
    chart.add_argument("--scene", action="append", default=[], metavar="NAME", help="only this (repeatable)")
    chart.add_argument(
        "--repeats", type=at_least_one, metavar="N", help="rounds of timing (default 5, quick 2)"
    )
    chart.set_defaults(run=_chart)

    text = "where methods fail: maps over two knobs"
    atlas = subparsers.add_parser(
        "atlas",
        help=text,
        description=f"{_sentence(text)} Every point of a map is a scene run to its end: held, or how it failed.",
    )
    output_arguments(atlas, Path("out") / "atlas")
    _sweep(atlas)
    atlas.add_argument("--map", action="append", default=[], metavar="NAME", help="only this (repeatable)")
    atlas.set_defaults(run=_atlas)
    text = "rigid, compliant and modal on the same scenes"
    compare = subparsers.add_parser(
        "compare",
        help=text,
        description=f"{_sentence(text)} What each level of model finds, and what it costs.",
    )
    compare.add_argument("scene", nargs="*", metavar="SCENE", help="scenes (default: all)")
    output_arguments(compare, Path("out") / "compare")
    _docs(compare)
    compare.set_defaults(run=_compare)


def _write(arguments: argparse.Namespace, name: str, report: dict[str, Any]) -> None:
    """The object as JSON, its rows (and those of a summary) as CSV."""
    from .records import write_csv

    write_json(report, arguments.out / f"{name}.json")
    write_csv(arguments.out / f"{name}.csv", report["results"])
    if isinstance(report.get("summary"), list) and report["summary"]:
        write_csv(arguments.out / f"{name}-summary.csv", report["summary"])


def _keep(docs: Path, name: str, report: dict[str, Any], pictures: dict[str, Path]) -> None:
    """Keep the results and renew what pages show of them: FileNotFoundError in an installed package."""
    harness("page", "--docs").keep(docs, name, report, pictures)


def _tell(arguments: argparse.Namespace, report: dict[str, Any], rows: list[dict[str, Any]]) -> int:
    """JSON where it was asked for; unless that is standard output, a table there."""
    write_json(report, arguments.json)
    if arguments.json != "-":
        print("\n".join(lines([{k: v for k, v in row.items() if k not in UNTOLD} for row in rows])))
        print(f"\nFiles: {arguments.out}/")
    return 0


def _compare(arguments: argparse.Namespace) -> int:
    from . import compare, draw_compare

    needed("matplotlib")
    report, traces = compare.compare(arguments.scene, arguments.out / "cache")
    _write(arguments, "compare", report)
    picture, *_ = draw_compare.levels(report, traces, arguments.out)
    if arguments.docs:
        _keep(arguments.docs, "compare", report, {"compare.png": picture})
    return _tell(arguments, report, report["results"])


def _atlas(arguments: argparse.Namespace) -> int:
    from . import atlas, draw_atlas

    needed("matplotlib")
    report = atlas.atlas(map_names=arguments.map, **_swept(arguments))
    _write(arguments, "atlas", report)
    draw_atlas.atlas_maps(report, arguments.out)
    draw_atlas.overview(report, arguments.out)
    pictures = draw_atlas.page(report, arguments.out)
    if arguments.docs:
        shown = {"atlas.png": pictures[0]} if pictures else {}
        _keep(arguments.docs, "atlas", {**report, "results": atlas.passed(report["results"])}, shown)
    return _tell(arguments, report, atlas.passed(report["results"]))


def _bench(arguments: argparse.Namespace) -> int:
    from . import (
        bench,
        draw,
        draw_bench,
        everyday,
        growth,
        island_bench,
        jointed,
        many_worlds,
        start_time,
    )

    if arguments.what in DRAWN:
        needed("matplotlib")
    if arguments.what == "everyday":
        report = everyday.everyday(
            arguments.scene,
            arguments.seeds or (1 if arguments.quick else None),
            arguments.peer,
            dict(_setting(text) for text in arguments.set),
            arguments.seconds,
        )
        _write(arguments, "bench-everyday", report)
        pictures = draw_bench.everyday_times(report, arguments.out)
        if arguments.docs:
            shown = {"everyday.png": pictures[0]} if pictures else {}
            _keep(arguments.docs, "everyday", report, shown)
        _tell(arguments, report, [{k: row[k] for k in everyday.TOLD} for row in report["results"]])
        if arguments.json != "-":
            print("\n".join(f"{name}: {value}" for name, value in report["summary"].items()))
        return 0
    if arguments.what == "sleep":
        report = everyday.sleep(peer_names=arguments.peer)
    elif arguments.what == "frames":
        sizes = arguments.bodies or (bench.QUICK_SIZES if arguments.quick else bench.SIZES)
        report = bench.frames(arguments.scene, sizes, arguments.peer)
        draw_bench.frame_times(report, arguments.out)
    elif arguments.what == "kernels":
        report = bench.kernels(arguments.scene)
        draw.kernel_times(report, arguments.out)
    elif arguments.what == "islands":
        report = island_bench.islands()
    elif arguments.what == "joints":
        report = jointed.joints(arguments.scene)
    elif arguments.what == "growth":
        report = growth.growth(arguments.scene, arguments.bodies or (), arguments.peer)
        pictures = draw_bench.growth(report, arguments.out)
        if arguments.docs:
            _keep(arguments.docs, "growth", report, {"growth.png": pictures[0]} if pictures else {})
    elif arguments.what == "step":
        report = start_time.step()
        pictures = draw_bench.phases(report, arguments.out)
        if arguments.docs:
            _keep(arguments.docs, "step", report, {"phases.png": pictures[0]})
    elif arguments.what == "start":
        report = start_time.start()
    elif arguments.what == "worlds":
        report = many_worlds.worlds(128 if arguments.quick else 1024)
    else:
        report = bench.memory(arguments.scene, (arguments.bodies or [1000])[0], arguments.peer)
    _write(arguments, f"bench-{arguments.what}", report)
    _tell(arguments, report, report["results"])
    more = report.get("phases") or report.get("exponents")
    if more and arguments.json != "-":
        print("\n".join(lines(more)))
    return 0


def _setting(text: str) -> tuple[str, Any]:
    """NAME=VALUE, the value as JSON has it."""
    name, _, value = text.partition("=")
    try:
        return name, json.loads(value)
    except json.JSONDecodeError:
        raise ValueError(f"--set wants NAME=VALUE with a number, got {text!r}") from None


def _chart(arguments: argparse.Namespace) -> int:
    from . import chart, draw

    needed("matplotlib")
    report = chart.chart(scene_names=arguments.scene, repeats=arguments.repeats, **_swept(arguments))
    _write(arguments, "chart", report)
    draw.chart_pages(report, arguments.out)
    pictures = draw.chart_summary(report, arguments.out)
    defaults = draw.chart_defaults(report, arguments.out)
    if arguments.docs and pictures:
        shown = {"chart.png": pictures[0]} | ({"chart-defaults.png": defaults[0]} if defaults else {})
        page = harness("page", "--docs")
        page.keep(arguments.docs, "chart", page.concise(report), shown)
    _tell(
        arguments,
        report,
        [{k: row.get(k) for k in chart.TOLD} for row in report["summary"]] or report["results"],
    )
    if arguments.json != "-":
        print("\n".join(lines(report["summary_defaults"])))
    return 0
