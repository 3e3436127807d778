"""The command line: `python -m rigidarea` (and `rigidarea`).

Every command's own module adds its arguments and does its work; it is imported when that command is asked for.
"""

from __future__ import annotations

import argparse
import contextlib
import ctypes
import importlib
import os
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from . import __version__
from .alive import alive
from .checkout import harness
from .report import check_writable, lines, output_arguments, write_json

COMMANDS = {
    "demo": "render the game scenes: stills, films, a table of frame times",
    "case": "one of the paper's examples, measured against the paper",
    "bench": "speed beside shapely, pymunk's own solver and Box2D",
    "chart": "accuracy against speed",
    "atlas": "stability, where methods fail",
    "compare": "rigid, compliant and modal beside each other",
    "plan": "the cheapest model and settings within a tolerance, and how often that is right",
    "run": "an existing pymunk program, area contact attached to every space it makes",
    "compat": "pymunk's own examples and tests with area contact attached (in a checkout)",
}
#: Where they are (`compat`'s in the harness): each module has `add_arguments(parser)` and `run(arguments)`.
MODULES = {"demo": "draw.demo", "case": "cases", "plan": "study.plan_command", "run": "programs.run_program"}
#: The extra that brings a module which commands need (README, "Set up").
EXTRAS = {
    **dict.fromkeys(("pygame", "imageio", "imageio_ffmpeg"), "demos"),
    **dict.fromkeys(("scipy", "threadpoolctl"), "flexible"),
    **dict.fromkeys(("matplotlib", "b2d", "pyb2d3", "distributed", "dask"), "studies"),
}
STUDIES = ("bench", "chart", "atlas", "compare")


def parser(command: str | None) -> argparse.ArgumentParser:
    """The parser, with the arguments of `command` (all other commands are only listed).

    A command's parser sets `run`, a function of the parsed arguments that returns the exit code (None: 0).
    """
    top = argparse.ArgumentParser(
        prog="rigidarea",
        description="Rigid-body contact by overlap area for pymunk: demos, cases and studies.",
    )
    top.add_argument("--version", action="version", version=f"rigidarea {__version__}")
    commands = top.add_subparsers(dest="command", required=True, metavar="COMMAND")
    if command in STUDIES:
        from .study import add_commands

        add_commands(commands)
    for name, text in COMMANDS.items():
        if name in commands.choices:
            continue
        own = commands.add_parser(name, help=text, description=text[0].upper() + text[1:] + ".")
        if name == command:
            if name == "compat":
                try:
                    module = harness("command", name)
                except FileNotFoundError as error:
                    top.exit(2, f"rigidarea {error}\n")
            else:
                module = importlib.import_module(f".{MODULES[name]}", __package__)
            module.add_arguments(own)
            if name == "case":
                output_arguments(own, Path("out") / "cases")
            own.set_defaults(run=_case if name == "case" else module.run)
    return top


def _case(arguments: argparse.Namespace) -> None:
    from . import cases

    told = cases.run(arguments)
    write_json(told, arguments.json)
    if arguments.json != "-":
        print(f"{told['command']}: {told['wall_s']:.1f} s")
        print("\n".join(lines(told["results"])))
        print("\nthe paper:")
        print("\n".join(lines(told["paper"])))
        print(f"\nFigures: {arguments.out}/")


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code: 2 for input that makes no sense (argparse's), 130 if stopped.

    argv None: that of this process, which ends with it and shows that it is alive.
    """
    started = time.time() - 0.02  # files have the time of a coarser clock
    given = list(sys.argv[1:] if argv is None else argv)
    top = parser(next((word for word in given if not word.startswith("-")), None))
    arguments = top.parse_args(given)
    own = argv is None
    # a program, or a window, has words of its own, or none
    quiet = not own or arguments.command == "run" or getattr(arguments, "window", False)
    try:
        with contextlib.nullcontext() if quiet else alive(since=time.process_time()):  # since it was started
            if getattr(arguments, "json", None) not in (None, "-"):
                check_writable(arguments.json)
            code = arguments.run(arguments)
    except ModuleNotFoundError as error:
        extra = EXTRAS.get((error.name or "").split(".")[0])
        if extra is None:  # nothing that one of our extras would bring
            raise
        top.exit(2, f"rigidarea: {error.name} is not installed: pip install 'rigidarea[{extra}]'\n")
    except (ValueError, OSError) as error:
        top.exit(2, f"rigidarea {arguments.command}: {error}\n")
    except KeyboardInterrupt:
        out = getattr(arguments, "out", None)
        kept = f"; what was finished is in {out}" if out is not None and written(out, started) else ""
        print(f"rigidarea {arguments.command}: stopped{kept}", file=sys.stderr)
        return 130
    finally:
        if own:
            leave_nothing_to_llvm()
    return int(code or 0)


def written(folder: Path, since: float) -> bool:
    """Whether a file in it, or in its folders, was written since (s, as `time.time`)."""
    return any(path.is_file() and path.stat().st_mtime >= since for path in folder.rglob("*"))


def leave_nothing_to_llvm() -> None:
    """Once Python has ended as ever, the process does too: glibc's `on_exit` with `_exit`, which takes its status.

    Else LLVM, which comes last, takes apart what it has compiled: 2 to 3 s after the last word, for memory that the
    system has back at once anyway. Without glibc nothing is changed.
    """
    if sys.platform.startswith("linux"):
        libc = ctypes.CDLL(None)
        if hasattr(libc, "on_exit"):
            libc.on_exit(libc._exit, None)


if __name__ == "__main__":
    # pygame greets on standard output, which may be JSON
    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
    raise SystemExit(main())
