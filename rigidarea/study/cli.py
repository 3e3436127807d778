"""The studies' sub-commands: `bench`, `chart`, `atlas`, `compare`.

Light to import: a command imports its work when it is run.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any


def _common(parser: argparse.ArgumentParser, name: str) -> None:
    out = Path("out") / name
    parser.add_argument("--out", type=Path, default=out, metavar="DIR", help="where files go (%(default)s)")
    parser.add_argument(
        "--json", metavar="FILE", help="also write the JSON here; - for standard output alone"
    )


def _sweep(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    add("--quick", action="store_true", help="few settings, at most two minutes")
    add("--peer", action="append", default=[], metavar="NAME", help="only this engine (repeatable)")
    add("--workers", type=int, metavar="N", help="local processes; 0: none (default: one a core)")
    add("--scheduler", metavar="ADDRESS", help="a Dask scheduler, such as tcp://host:8786")
    add("--fresh", action="store_true", help="forget what an earlier run left in DIR")


def add_commands(subparsers: Any) -> None:
    """Add the studies' commands to `argparse` sub-parsers; each sets `run(arguments) -> int`."""
    bench = subparsers.add_parser("bench", help="speed and memory, beside shapely, pymunk's solver and Box2D")
    bench.add_argument("what", choices=("frames", "kernels", "memory", "step", "start"))
    bench.add_argument("scene", nargs="*", metavar="SCENE", help="scenes or pairs (default: all)")
    _common(bench, "bench")
    bench.add_argument("--quick", action="store_true", help="up to 1,000 bodies")
    bench.add_argument("--bodies", type=int, action="append", metavar="N", help="this many (repeatable)")
    bench.add_argument(
        "--peer", action="append", default=[], metavar="NAME", help="only this engine (repeatable)"
    )
    bench.set_defaults(run=_bench)
    chart = subparsers.add_parser("chart", help="accuracy against speed, beside pymunk's solver and Box2D")
    _common(chart, "chart")
    _sweep(chart)
    chart.add_argument("--scene", action="append", default=[], metavar="NAME", help="only this (repeatable)")
    chart.add_argument("--repeats", type=int, metavar="N", help="rounds of timing (default 5, quick 3)")
    chart.set_defaults(run=_chart)

    atlas = subparsers.add_parser("atlas", help="where methods fail: maps over two knobs")
    _common(atlas, "atlas")
    _sweep(atlas)
    atlas.add_argument("--map", action="append", default=[], metavar="NAME", help="only this (repeatable)")
    atlas.set_defaults(run=_atlas)
    compare = subparsers.add_parser("compare", help="rigid, compliant and modal on the same scenes")
    compare.add_argument("scene", nargs="*", metavar="SCENE", help="scenes (default: all)")
    _common(compare, "compare")
    compare.set_defaults(run=_compare)


def _compare(arguments: argparse.Namespace) -> int:
    from . import compare, draw_compare
    from .records import write_csv, write_json

    report, traces = compare.compare(arguments.scene, arguments.out / "cache")
    write_json(arguments.out / "compare.json", report)
    write_csv(arguments.out / "compare.csv", report["results"])
    draw_compare.levels(report, traces, arguments.out)
    write_json(arguments.json, report)
    return 0


def _atlas(arguments: argparse.Namespace) -> int:
    from . import atlas, draw_atlas
    from .records import write_csv, write_json

    report = atlas.atlas(
        arguments.out,
        quick=arguments.quick,
        map_names=arguments.map,
        peer_names=arguments.peer,
        scheduler=arguments.scheduler,
        workers=arguments.workers,
        resume=not arguments.fresh,
    )
    write_json(arguments.out / "atlas.json", report)
    write_csv(arguments.out / "atlas.csv", report["results"])
    draw_atlas.atlas_maps(report, arguments.out)
    draw_atlas.overview(report, arguments.out)
    write_json(arguments.json, report)
    return 0


def _bench(arguments: argparse.Namespace) -> int:
    from . import bench, draw, start
    from .records import write_csv, write_json

    if arguments.what == "frames":
        sizes = arguments.bodies or (bench.QUICK_SIZES if arguments.quick else bench.SIZES)
        report = bench.frames(arguments.scene, sizes, arguments.peer)
        draw.frame_times(report, arguments.out)
    elif arguments.what == "kernels":
        report = bench.kernels(arguments.scene)
        draw.kernel_times(report, arguments.out)
    elif arguments.what == "step":
        report = start.step()
    elif arguments.what == "start":
        report = start.start()
    else:
        report = bench.memory(arguments.scene, (arguments.bodies or [1000])[0], arguments.peer)
    write_json(arguments.out / f"bench-{arguments.what}.json", report)
    write_csv(arguments.out / f"bench-{arguments.what}.csv", report["results"])
    write_json(arguments.json, report)
    return 0


def _chart(arguments: argparse.Namespace) -> int:
    from . import chart, draw
    from .records import write_csv, write_json

    report = chart.chart(
        arguments.out,
        quick=arguments.quick,
        scene_names=arguments.scene,
        peer_names=arguments.peer,
        repeats=arguments.repeats,
        scheduler=arguments.scheduler,
        workers=arguments.workers,
        resume=not arguments.fresh,
    )
    write_json(arguments.out / "chart.json", report)
    write_csv(arguments.out / "chart.csv", report["results"])
    write_csv(arguments.out / "chart-summary.csv", report["summary"])
    draw.chart_pages(report, arguments.out)
    draw.chart_summary(report, arguments.out)
    write_json(arguments.json, report)
    return 0
