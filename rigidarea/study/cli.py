"""The studies' sub-commands: `bench`, `chart`, `atlas`, `compare`.

Light to import: a command imports its work when it is run.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
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
SHOWN = {"everyday": "everyday.png", "growth": "growth.png", "step": "phases.png"}
"""Those that pages show, and as what."""
UNTOLD = ("tags", "error_name")
"""Columns left to the files: too wide for a table."""


def _sweep(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    add("--quick", action="store_true", help="few settings, at most two minutes")
    _peer(parser)
    add("--workers", type=at_least_zero, metavar="N", help="local processes; 0: none (default: one a core)")
    add("--scheduler", metavar="ADDRESS", help="a Dask scheduler, such as tcp://host:8786")
    add("--fresh", action="store_true", help="forget what an earlier run left in DIR")
    _docs(parser)


def _peer(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--peer", action="append", default=[], metavar="NAME", help="only this engine (repeatable)"
    )


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


def _docs(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--docs",
        type=pages,
        metavar="DIR",
        help="in a checkout: keep the results there, and renew what pages show of them",
    )


def _command(
    subparsers: Any, name: str, text: str, described: str, run: Callable[[argparse.Namespace], int]
) -> argparse.ArgumentParser:
    """A command, with the arguments that all have."""
    described = f"{text[0].upper()}{text[1:]}. {described}"
    command: argparse.ArgumentParser = subparsers.add_parser(name, help=text, description=described)
    output_arguments(command, Path("out") / name)
    command.set_defaults(run=run)
    return command


def add_commands(subparsers: Any) -> None:
    """Add the studies' commands to `argparse` sub-parsers; each sets `run(arguments) -> int`."""
    text = "speed and memory, beside shapely, pymunk's solver and Box2D"
    described = "; ".join(f"{name}: {what}" for name, what in BENCHES.items())
    bench = _command(subparsers, "bench", text, f"{described}.", _bench)
    add = bench.add_argument
    add("what", choices=tuple(BENCHES), metavar="WHAT", help=f"one of {', '.join(BENCHES)}")
    add("scene", nargs="*", metavar="SCENE", help="scenes or pairs (default: all)")
    add("--quick", action="store_true", help="up to 1,000 bodies")
    add("--bodies", type=at_least_one, action="append", metavar="N", help="this many (repeatable)")
    _peer(bench)
    add("--seeds", type=at_least_one, metavar="N", help="everyday: of each scene (default 5; large ones 1)")
    add("--seconds", type=float, metavar="S", help="everyday: simulated time (default 7; towers 2)")
    add(
        "--set",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="everyday: rigidarea at this setting (steps, iterations, penetration ...; repeatable), not its defaults",
    )
    _docs(bench)
    text = "accuracy against speed, beside pymunk's solver and Box2D"
    described = "Each engine at many settings on each scene: its error, and what it costs."
    chart = _command(subparsers, "chart", text, described, _chart)
    _sweep(chart)
    add = chart.add_argument
    add("--scene", action="append", default=[], metavar="NAME", help="only this (repeatable)")
    add("--repeats", type=at_least_one, metavar="N", help="rounds of timing (default 5, quick 2)")
    text = "where methods fail: maps over two knobs"
    described = "Every point of a map is a scene run to its end: held, or how it failed."
    atlas = _command(subparsers, "atlas", text, described, _atlas)
    _sweep(atlas)
    atlas.add_argument("--map", action="append", default=[], metavar="NAME", help="only this (repeatable)")
    text = "rigid, compliant and modal on the same scenes"
    described = "What each level of model finds, and what it costs."
    compare = _command(subparsers, "compare", text, described, _compare)
    compare.add_argument("scene", nargs="*", metavar="SCENE", help="scenes (default: all)")
    _docs(compare)


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
    needed("matplotlib")
    from . import compare, draw_compare

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
    from . import bench, draw, draw_bench, everyday, growth, island_bench, jointed, many_worlds, start_time

    what, scenes, peers, quick = arguments.what, arguments.scene, arguments.peer, arguments.quick
    draws = {
        "everyday": draw_bench.everyday_times,
        "frames": draw_bench.frame_times,
        "growth": draw_bench.growth,
        "kernels": draw.kernel_times,
        "step": draw_bench.phases,
    }
    if what in draws:
        needed("matplotlib")
    sizes, seeds = arguments.bodies or (), arguments.seeds or (1 if quick else None)
    measure: dict[str, Callable[[], dict[str, Any]]] = {
        "everyday": lambda: everyday.everyday(
            scenes, seeds, peers, dict(map(_setting, arguments.set)), arguments.seconds
        ),
        "frames": lambda: bench.frames(scenes, sizes or (bench.QUICK_SIZES if quick else bench.SIZES), peers),
        "growth": lambda: growth.growth(scenes, sizes, peers),
        "islands": island_bench.islands,
        "joints": lambda: jointed.joints(scenes),
        "kernels": lambda: bench.kernels(scenes),
        "memory": lambda: bench.memory(scenes, (sizes or [1000])[0], peers),
        "sleep": lambda: everyday.sleep(peer_names=peers),
        "start": start_time.start,
        "step": start_time.step,
        "worlds": lambda: many_worlds.worlds(128 if quick else 1024),
    }
    report = measure[what]()
    _write(arguments, f"bench-{what}", report)
    pictures = draws[what](report, arguments.out) if what in draws else []
    if arguments.docs and what in SHOWN:
        _keep(arguments.docs, what, report, {SHOWN[what]: pictures[0]} if pictures else {})
    if what == "everyday":
        _tell(arguments, report, [{k: row[k] for k in everyday.TOLD} for row in report["results"]])
        more = [f"{name}: {value}" for name, value in report["summary"].items()]
    else:
        _tell(arguments, report, report["results"])
        parts = report.get("phases") or report.get("exponents")
        more = lines(parts) if parts else []
    if more and arguments.json != "-":
        print("\n".join(more))
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
    rows = [{k: row.get(k) for k in chart.TOLD} for row in report["summary"]]
    _tell(arguments, report, rows or report["results"])
    if arguments.json != "-":
        print("\n".join(lines(report["summary_defaults"])))
    return 0
