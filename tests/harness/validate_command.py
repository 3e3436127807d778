"""The command `plan --validate`: files, a picture, a table."""

from __future__ import annotations

import argparse

from rigidarea.report import lines, needed, write_json
from rigidarea.study.records import write_csv

from . import page, plan_picture, validate

TOLD = (
    *("scene", "tolerance", "verdict", "error", "predicted_error", "decided_by", "level", "steps", "sweeps"),
    *("penetration", "cost_ratio", "cheapest"),
)
"""Columns of the table; the files have all."""


def run(arguments: argparse.Namespace) -> int:
    """Run `rigidarea plan --validate`: files, and a table of how often plans are right."""
    needed("matplotlib")
    report = validate.validate(arguments.out, arguments.what, arguments.variations, fresh=arguments.fresh)
    write_json(report, arguments.out / "plan-validate.json")
    write_csv(arguments.out / "plan-validate.csv", report["rows"])
    shown = plan_picture.costs_and_errors(report["rows"], arguments.out / "plan.png")
    if arguments.docs:
        page.keep(arguments.docs, "plan", report, {"plan.png": shown})
    write_json(report, arguments.json)
    if arguments.json != "-":
        print("\n".join(lines([{k: row.get(k) for k in TOLD} for row in report["rows"]])))
        for kind, found in report["summary"].items():
            print(f"\n{kind}")
            print("\n".join(lines(found)))
        print(f"\nFiles: {arguments.out}/")
    return 0
