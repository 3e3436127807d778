"""The command `compat`: pymunk's own examples and tests with area contact, as tables; hostile calls; a long run."""

from __future__ import annotations

import argparse
import random
import sys
import tempfile
from pathlib import Path
from statistics import median
from typing import Any

import pymunk

from rigidarea.report import envelope, output_arguments, write_json

from . import interrupts, lives, suite
from .examples import EXAMPLES, FRAMES, GAMES, compare
from .hostile import fuzz
from .meddling import meddle
from .soak import soak


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of `rigidarea compat`."""
    parser.add_argument(
        "what",
        choices=("examples", "tests", "fuzz", "soak", "lives", "interrupts"),
        help="pymunk's examples, its tests, calls with hostile values and changes from within callbacks, a fountain, "
        "random programs (lifetimes, copies, signals, threads), SIGINTs at random times, each a process",
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help="some of the examples (default: all)")
    parser.add_argument(
        "--docs",
        type=Path,
        metavar="DIR",
        help="keep the results here, and renew pages",
    )
    parser.add_argument(
        "--calls", type=int, default=50_000, metavar="N", help="of fuzz (default: %(default)s)"
    )
    parser.add_argument(
        "--steps", type=int, default=1_000_000, metavar="N", help="of soak (default: %(default)s)"
    )
    parser.add_argument(
        "--every",
        type=int,
        default=5,
        metavar="N",
        help="of soak: frames between two bodies, each of which lives for 150 (default: %(default)s)",
    )
    parser.add_argument(
        "--programs", type=int, default=200, metavar="N", help="of lives, interrupts (default: %(default)s)"
    )
    parser.add_argument(
        "--compiling",
        type=int,
        default=0,
        metavar="N",
        help="of interrupts: so many more while all machine code compiles, a minute or two each (default: %(default)s)",
    )
    parser.add_argument(
        "--seed",
        type=int,
        default=0,
        metavar="N",
        help="of fuzz, soak and interrupts, of the first of lives (default: %(default)s)",
    )
    output_arguments(parser, Path("out") / "compat")


def run(arguments: argparse.Namespace) -> int:
    """Run `rigidarea compat`; exit code 1 if anything is wrong natively (the table means nothing then) or in a fuzz."""
    if arguments.what != "examples" and arguments.names:
        raise ValueError(
            f"compat {arguments.what} takes no names: expected none, got {' '.join(arguments.names)}"
        )
    if arguments.what == "tests":
        return _tests(arguments)
    if arguments.what == "fuzz":
        return _fuzz(arguments)
    if arguments.what == "soak":
        return _soak(arguments)
    if arguments.what == "lives":
        return _lives(arguments)
    if arguments.what == "interrupts":
        return _interrupts(arguments)
    unknown = [name for name in arguments.names if name not in EXAMPLES]
    if unknown:
        raise ValueError(f"unknown example {unknown[0]!r}; expected one of {', '.join(EXAMPLES)}")
    if arguments.names and arguments.docs:
        raise ValueError("--docs wants all examples: leave the names out")
    rows = []
    names = arguments.names or list(EXAMPLES)
    for i, name in enumerate(names):
        print(f"[{i + 1}/{len(names)}] {name}", file=sys.stderr, flush=True)
        rows.append(compare(name))
    told = {"frames": FRAMES, "names": names, "pymunk": pymunk.version, "games": len(GAMES)}
    report = envelope("compat examples", told, rows, summary=summary(rows))
    write_json(report, arguments.json)
    if arguments.json != "-":
        print("\n".join(examples_table(rows)))
        print(_sentence(summary(rows)))
    if arguments.docs:
        _keep(arguments.docs, "pymunk-examples", report)
    return int(any(row["native_wrong"] for row in rows))


def summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """How many behave as meant, and the ratios of frame times: median and worst."""
    stepping = [row for row in rows if row["steps_time"]]
    told: dict[str, Any] = {
        "examples": len(rows),
        "that_step": len(stepping),
        "as_meant": sum(row["right"] for row in stepping),
    }
    for key in ("step_over_native", "frame_over_native"):
        ratios = [row[key] for row in stepping if row[key] is not None]
        told[f"{key}_median"] = median(ratios) if ratios else None
        told[f"{key}_worst"] = max(ratios) if ratios else None
    return told


def _sentence(told: dict[str, Any]) -> str:
    def number(key: str) -> str:
        return "-" if told[key] is None else f"{told[key]:.2f}"

    return (
        f"{told['as_meant']} of the {told['that_step']} that step a space behave as their authors meant. Time over "
        f"native: `space.step` median {number('step_over_native_median')}, worst {number('step_over_native_worst')}; "
        f"whole frames median {number('frame_over_native_median')}, worst {number('frame_over_native_worst')}."
    )


def examples_table(rows: list[dict[str, Any]]) -> list[str]:
    """Markdown lines, one an example."""

    def number(value: float | None) -> str:
        return "" if value is None else f"{value:.2f}"

    lines = [
        "| example | bodies | as meant | step, ms | step over native | frame over native | what is not |",
        "|---|---:|---|---:|---:|---:|---|",
    ]
    for row in rows:
        meant = "yes" if row["right"] else "no"
        if not row["steps_time"]:
            meant = "draws only" if row["right"] else "no"
        wrong = "; ".join([*row["wrong"], *(f"NATIVELY: {text}" for text in row["native_wrong"])])
        lines.append(
            f"| {row['example']} | {row['bodies'] or 0} | {meant} | {number(row['step_ms'])} | "
            f"{number(row['step_over_native'])} | {number(row['frame_over_native'])} | {_cell(wrong)} |"
        )
    return lines


def examples_page(report: dict[str, Any]) -> str:
    """docs/pymunk-examples.md, of what `compat examples` has measured."""
    rows, asked = report["results"], report["settings"]
    head = f"""# pymunk's examples, unedited

Each example of pymunk {asked["pymunk"]} is run from where pymunk installed it, headless, for {asked["frames"]} frames
with scripted input and seeded `random`: natively, and with `rigidarea.attach` on every space before its first
`space.step`. The steps are the example's own. `python -m rigidarea compat examples --docs docs` renews this page.

An example behaves *as meant* if two to five facts written down from reading it hold (`tests/harness/facts.py`:
the tower stands, the arrow sticks, the ball stays in the court; all hold natively), and if beside the native run
nothing is raised or printed on standard error, no body is farther out than the native run's box by its diagonal,
none is faster than 1.5 times the native fastest (plus a fall through a tenth of the scene), joints are no farther
off than twice natively plus a pixel, of the bodies that came two seconds before the end as many rest (up to a
tenth; who sleeps rests), and callbacks come as often (up to a factor of two). Crowds have no one course: where
something of that is not so, {asked["games"]} games count, each with its own random numbers and with the hand a pixel
further to the right: the widest and fastest of the native ones, and of both the median share that rests. Facts of
chance (whether a flipper meets the ball) are to hold in more than half of them, natively and attached. Times are
processor time, median over frames: `space.step` alone, and the example's whole frame with its drawing.

{_sentence(report["summary"])}
"""
    return head + "\n" + "\n".join(examples_table(rows)) + "\n"


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")


def _tests(arguments: argparse.Namespace) -> int:
    results = {}
    with tempfile.TemporaryDirectory(prefix="rigidarea-suite-") as folder:
        for mode in suite.MODES:
            print(f"pymunk's tests, {mode}", file=sys.stderr, flush=True)
            results[mode] = suite.run_suite(mode, folder)
    counts = {
        mode: {"tests": len(rows), "passed": sum(row["passed"] for row in rows)}
        for mode, rows in results.items()
    }
    failed = failures(results)
    report = envelope("compat tests", {"pymunk": pymunk.version}, failed, summary=counts)
    write_json(report, arguments.json)
    if arguments.json != "-":
        print(tests_page(report))
    if arguments.docs:
        _keep(arguments.docs, "pymunk-tests", report)
    return 0


def _fuzz(arguments: argparse.Namespace) -> int:
    if arguments.calls < 1:
        raise ValueError(f"calls must be at least 1, got {arguments.calls}")
    print(f"{arguments.calls} calls with hostile values", file=sys.stderr, flush=True)
    calls = fuzz(arguments.calls, arguments.seed)
    print("changes from within callbacks", file=sys.stderr, flush=True)
    changes = meddle()
    wrong = [row for row in calls if row["wrong"]] + [row for row in changes if row["wrong"]]
    settings = {"calls": arguments.calls, "seed": arguments.seed}
    write_json(
        envelope("compat fuzz", settings, calls, changes=changes, summary={"wrong": len(wrong)}),
        arguments.json,
    )
    if arguments.json != "-":
        for row in calls:
            print(
                f"{row['call']:28} {row['calls']:6} calls, {row['refused']:6} refused, {len(row['wrong'])} wrong"
            )
            for text in row["wrong"][:3]:
                print(f"    {text}")
        print(
            f"{len(changes)} kinds of change from within callbacks, {sum(bool(r['wrong']) for r in changes)} wrong"
        )
        for row in changes:
            if row["wrong"]:
                print(f"    {row['action']} in {row['callback']}: {row['wrong']}")
    return int(bool(wrong))


def _lives(arguments: argparse.Namespace) -> int:
    if arguments.programs < 1:
        raise ValueError(f"programs must be at least 1, got {arguments.programs}")
    lives.warm()
    wrong, natively = [], []
    for seed in range(arguments.seed, arguments.seed + arguments.programs):
        text = lives.run(seed)
        if text and (lives.of_pymunk(text) or lives.run(seed, native=True)):
            natively.append(seed)
        elif text:
            wrong.append({"seed": seed, "wrong": text})
            print(text, file=sys.stderr, flush=True)
    settings = {"programs": arguments.programs, "seed": arguments.seed}
    told = {"wrong": len(wrong), "natively": natively}
    write_json(envelope("compat lives", settings, wrong, summary=told), arguments.json)
    if arguments.json != "-":
        print(f"{arguments.programs} programs, {len(wrong)} wrong, natively too: {natively or 'none'}")
    return int(bool(wrong))


def _interrupts(arguments: argparse.Namespace) -> int:
    if arguments.programs < 1 or arguments.compiling < 0:
        raise ValueError(
            f"programs must be at least 1, compiling at least 0, got {arguments.programs}, {arguments.compiling}"
        )
    lives.warm()
    rows = [
        {"mode": mode, "course": name, **row}
        for mode in ("native", "area")
        for name, row in interrupts.sweep(arguments.programs, arguments.seed, mode == "native").items()
    ]
    draw = random.Random(arguments.seed)
    wrong = [interrupts.compiling(draw.uniform(0, 60)) for _ in range(arguments.compiling)]
    bad = list(filter(None, wrong))
    raised = len(wrong) - len(bad)
    rows.append(
        {
            "mode": "area",
            "course": "compilation",
            "sent": len(wrong),
            "raised": raised,
            "swallowed": 0,
            "wrong": bad,
        }
    )
    settings = {"programs": arguments.programs, "compiling": arguments.compiling, "seed": arguments.seed}
    failed = sum(len(row["wrong"]) for row in rows if row["mode"] == "area")
    write_json(envelope("compat interrupts", settings, rows, summary={"wrong": failed}), arguments.json)
    if arguments.json != "-":
        for row in rows:
            counts = ", ".join(f"{row[key]} {key}" for key in ("sent", "raised", "swallowed"))
            print(f"{row['mode']:6} {row['course']:14} {counts}, {len(row['wrong'])} wrong")
            for text in row["wrong"][:3]:
                print(f"    {text}", file=sys.stderr)
    return int(failed > 0)


def _soak(arguments: argparse.Namespace) -> int:
    if arguments.steps < 10:
        raise ValueError(f"steps must be at least 10, got {arguments.steps}")
    if arguments.every < 1:
        raise ValueError(f"every must be at least 1, got {arguments.every}")

    def tell(row: dict[str, Any]) -> None:
        if arguments.json != "-":
            text = f"{row['steps']:9} steps, {row['bodies']:4} bodies, {row['resident_mb']:8.1f} MB"
            print(text, flush=True)

    rows = soak(arguments.steps, arguments.seed, tell=tell, every=arguments.every)
    grown = rows[-1]["resident_mb"] - rows[0]["resident_mb"]
    settings = {"steps": arguments.steps, "seed": arguments.seed, "every": arguments.every}
    write_json(envelope("compat soak", settings, rows, summary={"grown_mb": grown}), arguments.json)
    if arguments.json != "-":
        print(f"grown since the first {rows[0]['steps']}: {grown:+.1f} MB")
    return 0


def failures(results: dict[str, list[dict[str, Any]]]) -> list[dict[str, Any]]:
    """A row for every test that fails in any mode: `test`, `reason`, each mode's message ("" if it passed)."""
    messages: dict[str, dict[str, str]] = {}
    for mode, rows in results.items():
        for row in rows:
            if not row["passed"]:
                messages.setdefault(row["test"], {})[mode] = row["message"] or "failed"
    return [
        {
            "test": test,
            "reason": suite.REASONS.get(test, ""),
            **{mode.replace(" ", "_"): found.get(mode, "") for mode in results},
        }
        for test, found in sorted(messages.items())
    ]


def tests_page(report: dict[str, Any]) -> str:
    """docs/pymunk-tests.md, of what `compat tests` has measured."""
    counts, failed = report["summary"], report["results"]
    names = {
        "pymunk": "natively",
        "area": "attached, stepped by `Space.step`",
        "area frames": "attached, every `Space.step` a `contact.step`",
    }
    lines = [
        "# pymunk's own tests",
        "",
        f"The tests of pymunk {report['settings']['pymunk']} (doctests left out), natively and with area contact",
        "attached to every space when it is made. `python -m rigidarea compat tests --docs docs` renews this page.",
        "",
        "| how | passed | of |",
        "|---|---:|---:|",
        *(f"| {names[mode]} | {c['passed']} | {c['tests']} |" for mode, c in counts.items()),
        "",
        "Every test that fails in one of them, and why another answer than pymunk's is right, where it is:",
        "",
        "| test | natively | `Space.step` | `contact.step` | why |",
        "|---|---|---|---|---|",
    ]
    for row in failed:
        cells = [_cell(row[key]) for key in ("pymunk", "area", "area_frames", "reason")]
        lines.append(f"| {row['test']} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def _keep(docs: Path, name: str, report: dict[str, Any]) -> None:
    from . import page

    page.keep(docs, name, report)
    print(f"written: {docs}", file=sys.stderr)
