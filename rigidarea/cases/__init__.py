"""The paper's numerical examples: each case builds, runs, measures, and holds its figures against the paper's.

``add_arguments`` and ``run`` serve the command line's ``case NAME``; each module's own ``run`` is the Python entry.
"""

from __future__ import annotations

import argparse
import importlib
import json
import os
import sys
from pathlib import Path
from typing import Any

from ..report import needed, write_json

MODULES = {
    "hertz": "hertz",
    "pin-joint": "pin_joint",
    "patch": "patch_case",
    "geneva": "geneva_run",
    "gearbox": "gearbox_run",
}
NAMES = tuple(MODULES)
MODES = ("rigid", "compliant", "modal")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of ``case``; ``--out`` and ``--json`` belong to every command and are added by the caller."""
    parser.add_argument(
        "name", choices=NAMES, metavar="NAME", help=f"which of the paper's examples: {', '.join(NAMES)}"
    )
    parser.add_argument(
        "--mode", choices=MODES, help="level of model (default: rigid for pin-joint, else compliant)"
    )
    parser.add_argument(
        "--mesh", type=float, metavar="MM", help="mesh size in millimetres (pin-joint, geneva, gearbox)"
    )
    parser.add_argument("--contact", choices=("area", "sts"), default="area", help="contact evaluation")
    parser.add_argument(
        "--film", action="store_true", help="also a still and a film of the stresses (compliant and modal)"
    )


def cache_directory() -> Path:
    """Where reductions are kept: $RIGIDAREA_CACHE, else the user's cache directory."""
    own = os.environ.get("RIGIDAREA_CACHE")
    return Path(own) if own else Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "rigidarea"


def run(args: argparse.Namespace) -> dict[str, Any]:
    """Runs ``args.name`` and returns its JSON object; figures go to ``args.out`` (none if it is missing or None).

    The object is also kept in ``args.out``/NAME.json while it grows: an interrupted run leaves there, and in
    ``args.json`` if that was asked for, what was computed until then. Raises ValueError for options the case has
    no use for, and for mesh sizes it cannot mesh; ModuleNotFoundError, before the work, without what draws.
    """
    out = getattr(args, "out", None)
    wanted = getattr(args, "film", False)
    if wanted and (args.name == "patch" or args.mode == "rigid" or out is None):
        raise ValueError(
            "--film draws stresses that change: expected --out, a case that moves and --mode compliant or modal, got"
            f" {args.name}, --mode {args.mode}, --out {out}"
        )
    if out is None:
        return _run(args, None)
    needed("matplotlib", *(("pygame", "imageio") if wanted else ()))
    file = Path(out) / f"{args.name}.json"
    file.unlink(missing_ok=True)
    try:
        told = _run(args, Path(out))
    except KeyboardInterrupt:
        if file.exists():
            print(f"interrupted: what was computed is in {file}", file=sys.stderr)
            write_json(json.loads(file.read_text()), getattr(args, "json", None))
        raise
    if wanted:
        from rigidarea.cases import stress_film

        given = args.mode, args.mesh, args.contact
        told["film"] = str(stress_film.make(args.name, *given, Path(out), cache_directory()))
    write_json(told, file)
    return told


def _run(args: argparse.Namespace, out: Path | None) -> dict[str, Any]:
    name, given = args.name, {"mode": args.mode, "mesh_mm": args.mesh}
    given = {key: value for key, value in given.items() if value is not None}
    if name in ("hertz", "patch"):
        if given or args.contact != "area":
            raise ValueError(
                f"case {name} runs all its variants at once: expected no --mode, --mesh or --contact"
            )
    else:
        given["contact"] = args.contact
    if args.mesh is not None and not args.mesh > 0:
        raise ValueError(f"--mesh must be positive (millimetres), got {args.mesh}")
    case = importlib.import_module(f"rigidarea.cases.{MODULES[name]}")
    told: dict[str, Any] = case.run(out=out, cache=cache_directory(), **given)
    return told
