"""The command `plan`: a plan for a program's space or a scene of the studies; with --validate, how often plans are
right."""

from __future__ import annotations

import argparse
import contextlib
import sys
import traceback
from pathlib import Path
from typing import Any

import pymunk

from ..checkout import harness, pages
from ..plan.plan import Plan, plan
from ..report import envelope, output_arguments, write_json
from .scene import get_scene
from .user_space import space_of


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of `rigidarea plan`."""
    add = parser.add_argument
    add(
        "what",
        nargs="*",
        metavar="SCENE|SCRIPT.py",
        help="a scene of the studies, or a program: its first space is planned",
    )
    add(
        "--tolerance",
        default="1%",
        metavar="T",
        help="relative error allowed, 0.01 or 1%% (default %(default)s)",
    )
    add(
        "--seconds",
        type=float,
        metavar="S",
        help="simulated time that is planned for (default: a scene's own, else 10)",
    )
    add(
        "--validate",
        action="store_true",
        help="plans against a brute-force sweep: all scenes, or those named (in a checkout)",
    )
    add(
        "--variations",
        type=int,
        default=100,
        metavar="N",
        help="of --validate: seeded variations (default %(default)s)",
    )
    add("--fresh", action="store_true", help="of --validate: forget what an earlier run left in DIR")
    add("--docs", type=pages, metavar="DIR", help="of --validate: renew there what docs/plan.md shows")
    output_arguments(parser, Path("out") / "plan")


def run(arguments: argparse.Namespace) -> int:
    """Run `rigidarea plan`."""
    if arguments.validate:
        code: int = harness("validate_command", "plan --validate").run(arguments)
        return code
    if len(arguments.what) != 1:
        raise ValueError(f"expected one scene or program (or --validate), got {len(arguments.what)}")
    what = arguments.what[0]
    # what the program prints must not mix with JSON
    out = sys.stderr if arguments.json == "-" else sys.stdout
    with contextlib.redirect_stdout(out):
        made = of_script(what, arguments) if what.endswith(".py") else of_scene(what, arguments)
    settings = {"what": what, "tolerance": made.tolerance, "seconds": made.seconds}
    write_json(envelope("plan", settings, told(made)), arguments.json)
    if arguments.json != "-":
        print(made)
    return 0


def told(made: Plan) -> dict[str, Any]:
    """A plan's numbers, keys in snake_case with the unit last."""
    return {
        "level": made.level,
        "steps": made.steps,
        "sweeps": made.sweeps,
        "penetration": made.penetration,
        "stiffness": made.stiffness,
        "reachable": made.reachable,
        "unpromised": made.unpromised,
        "error": made.error,
        "looked_s": made.looked,
        "predicted_cost_s_per_s": made.cost_s_per_s,
        "lines": [
            {"what": line.what, "choice": line.choice, "decided_by": line.decided_by, "error": line.error}
            for line in made.lines
        ],
    }


def of_scene(name: str, arguments: argparse.Namespace) -> Plan:
    """The plan of a scene's space. ValueError lists the known scenes."""
    scene = get_scene(name)
    space, _ = space_of(scene)
    return plan(space, arguments.tolerance, arguments.seconds or scene.duration, frame=scene.frame)


class _Found(BaseException):
    """A program has come to its first step. Not an Exception: its own `except Exception` must not swallow it."""


def of_script(name: str, arguments: argparse.Namespace) -> Plan:
    """The plan of the first space that a program steps, before that step; the program ends there.

    What its bodies are made of it says by `body.material = rigidarea.flexible.Material(...)`.
    Raises ValueError for what is no Python file, or steps no space; SystemExit of 1 for what ends in an error before
    its first step, told as Python does.
    """
    from ..programs.host import Host

    if not Path(name).is_file():
        raise ValueError(f"expected a scene or a Python file, got {name!r}, which is none")
    spaces: list[tuple[pymunk.Space, float]] = []
    step = pymunk.Space.step

    def found(space: pymunk.Space, dt: float) -> None:
        spaces.append((space, dt))
        raise _Found

    pymunk.Space.step = found  # type: ignore[method-assign, assignment]
    try:
        Host("pymunk", None).run(name)
    except _Found:
        pass
    except Exception:  # the program's own: told as Python would tell it
        traceback.print_exc()
        raise SystemExit(1) from None
    finally:
        pymunk.Space.step = step  # type: ignore[method-assign]
    if not spaces:
        raise ValueError(f"{name} stepped no pymunk space: there is nothing to plan")
    space, dt = spaces[0]
    frame = dt if dt > 0.0 else 1.0 / 60.0
    return plan(space, arguments.tolerance, arguments.seconds, frame=frame)
