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
    chart = subparsers.add_parser("chart", help="accuracy against speed, beside pymunk's solver and Box2D")
    _common(chart, "chart")
    _sweep(chart)
    chart.add_argument("--scene", action="append", default=[], metavar="NAME", help="only this (repeatable)")
    chart.add_argument("--repeats", type=int, metavar="N", help="rounds of timing (default 5, quick 3)")
    chart.set_defaults(run=_chart)


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
