"""The command `run`: an existing pymunk program, unedited, with area contact attached to every space that it makes."""

from __future__ import annotations

import argparse
import contextlib
import sys
import threading
import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ..report import at_least_one, envelope, lines, output_arguments, write_json
from .host import ENGINES, Host

#: Frames of a headless run that says no number.
FRAMES = 600


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of `rigidarea run`. What follows the script is the script's own."""
    parser.usage = "rigidarea run [options] SCRIPT.py [ARGS ...]"
    add = parser.add_argument
    add("script", metavar="SCRIPT.py", help="the program; what follows it is passed on to it")
    own = add("arguments", nargs=argparse.REMAINDER, metavar="ARGS", help="its arguments")
    own.required = False  # else argparse says so where SCRIPT.py is missing
    add(
        "--engine",
        choices=ENGINES,
        default="area",
        help="area contact (default), or pymunk's own, for comparison",
    )
    add("--frames", type=at_least_one, metavar="N", help=f"end after N frames (default: headless {FRAMES})")
    add(
        "--film",
        type=Path,
        metavar="FILE",
        help="write what it shows, or what moves, as a film: .mp4 or .gif (no suffix: what can be made here)",
    )
    add("--window", action="store_true", help="let the program open its own window, in real time")
    output_arguments(parser, Path("out") / "run")


def run(arguments: argparse.Namespace) -> int:
    """Run `rigidarea run`: the program, then a table of what it did."""
    if arguments.window and arguments.film:
        raise ValueError("--film is made without a window: leave --window out")
    script = Path(arguments.script)
    if not script.is_file():
        raise ValueError(f"expected a Python file, got {arguments.script!r}, which is none")
    frames = arguments.frames or (None if arguments.window else FRAMES)
    host = Host(arguments.engine, frames, headless=not arguments.window)
    with contextlib.ExitStack() as stack:
        if not arguments.window:
            stack.enter_context(frames_told(host, script))
        movie = None
        if arguments.film:
            from .filming import Filming

            movie = stack.enter_context(Filming(host, arguments.film))
        # what the program prints must not mix with JSON
        out = sys.stderr if arguments.json == "-" else sys.stdout
        stack.enter_context(contextlib.redirect_stdout(out))
        try:
            host.run(script, arguments.arguments)
        except Exception:  # the program's own: told as Python would tell it
            traceback.print_exc()
            return 1
    row = summary(host)
    settings = {
        "script": str(script),
        "arguments": arguments.arguments,
        "engine": arguments.engine,
        "frames": frames,
        "window": arguments.window,
    }
    if movie is not None:
        row["film"] = str(movie.path)
    write_json(envelope("run", settings, row), arguments.json)
    if arguments.json != "-":
        print("\n".join(lines(row)))
    if not host.spaces:
        print(f"{script}: it stepped no pymunk space; there was nothing to attach to", file=sys.stderr)
    return 0


@contextlib.contextmanager
def frames_told(host: Host, script: Path, seconds: float = 1.0) -> Iterator[None]:
    """Say on standard error what runs, and as often as that at which frame it is; nothing while code is compiled."""
    print(f"rigidarea run: {script}, {host.engine}", file=sys.stderr, flush=True)
    over = threading.Event()

    def tell() -> None:
        told = 0
        while not over.wait(seconds):
            if host.frame > told:
                told = host.frame
                print(f"rigidarea run: frame {told}", file=sys.stderr, flush=True)

    teller = threading.Thread(target=tell, daemon=True)
    teller.start()
    try:
        yield
    finally:
        over.set()
        teller.join()


def summary(host: Host) -> dict[str, Any]:
    """The numbers of a run, keys in snake_case with the unit last."""
    ms = 1e3 * np.array(host.frame_cpu or [0.0])
    return {
        "engine": host.engine,
        "spaces": len(host.spaces),
        "bodies": sum(len(space.bodies) for space in host.spaces),
        "frames": host.frame,
        "steps": host.steps,
        "step_ms_median": float(np.median(ms)),
        "step_ms_p99": float(np.percentile(ms, 99)),
        "step_ms_worst": float(ms.max()),
        "regions": sum(len(contact.regions) for contact in host.contacts),
        "callbacks": sum(host.calls.values()),
    }
