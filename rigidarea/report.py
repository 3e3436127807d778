"""The JSON object that a command writes, and how it is written; tables; how far long work has come."""

from __future__ import annotations

import argparse
import hashlib
import importlib
import json
import math
import os
import platform
import sys
import time
from collections.abc import Mapping, Sequence
from importlib import metadata
from pathlib import Path
from typing import Any

PACKAGES = ("rigidarea", "pymunk", "numpy", "numba", "shapely", "scipy", "matplotlib", "pygame-ce", "pyb2d3")
"""Packages that bear on a number or on a picture."""


def versions() -> dict[str, str]:
    """Versions of Python and of the installed ones of `PACKAGES`."""
    found = {"python": platform.python_version()}
    for package in PACKAGES:
        try:
            found[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            continue
    return found


def machine() -> dict[str, Any]:
    """Processor, cores, system, and how busy the machine is at this moment."""
    model = platform.processor()
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        lines = cpuinfo.read_text().splitlines()
        model = next(
            (line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), model
        )
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else math.nan
    return {
        "processor": model,
        "cores": os.cpu_count(),
        "system": f"{platform.system()} {platform.machine()}",
        "load_1min": round(load, 2),
    }


def solver() -> str:
    """Twelve digits that say on which solver a result was measured: a hash of the sources of what solves."""
    package = Path(__file__).parent
    sources = sorted(
        path for room in ("geometry", "contact", "chipmunk") for path in (package / room).glob("*.py")
    )
    return hashlib.sha256(b"\0".join(path.read_bytes() for path in sources)).hexdigest()[:12]


def envelope(command: str, settings: Mapping[str, Any], results: Any, **more: Any) -> dict[str, Any]:
    """The object: `command`, `settings`, `versions` (the solver too), `machine`, `results`, and what else there is."""
    return {
        "command": command,
        "settings": dict(settings),
        "versions": {**versions(), "solver": solver()},
        "machine": machine(),
        "results": results,
        **more,
    }


def plain(value: Any) -> Any:
    """The value as JSON knows it: NumPy scalars and arrays as numbers and lists, NaN and infinity as null."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, Path):
        return str(value)
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def write_json(value: Any, file: str | Path | None) -> None:
    """Write to `file`, its folder made; to standard output for "-"; nothing for None.

    A file is replaced as a whole: an interrupt leaves the one before, never half a file.
    """
    if file is None:
        return
    text = json.dumps(plain(value), indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    if str(file) == "-":
        sys.stdout.write(text)
        return
    path = Path(file)
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.exists() and not path.is_file():  # a device or a pipe
        path.write_text(text)
        return
    part = path.with_name(path.name + ".part")
    part.write_text(text)
    part.replace(path)


def check_writable(file: str | Path) -> None:
    """OSError for a file that cannot be written: before the work for it, not after. Makes its folder, leaves no file.

    A device or a pipe is left to who writes to it.
    """
    path = Path(file)
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.exists() and not path.is_file() and not path.is_dir():
        return
    new = not path.exists()
    with path.open("ab"):
        pass
    if new:
        path.unlink()


def needed(*modules: str) -> None:
    """ModuleNotFoundError for one of these that is not installed: before the work that ends in it, not after."""
    for name in modules:
        importlib.import_module(name)


def output_arguments(parser: argparse.ArgumentParser, out: Path) -> None:
    """The two arguments of every command: `--out` (a folder, default `out`) and `--json`."""
    parser.add_argument("--out", type=Path, default=out, metavar="DIR", help="where files go (%(default)s)")
    parser.add_argument(
        "--json", metavar="FILE", help="also write the numbers here; - for JSON alone on standard output"
    )


class Progress:
    """One line on standard error that says how far long work has come; lines instead if it is no terminal."""

    def __init__(self, title: str, total: int) -> None:
        self.title, self.total, self.done = title, total, 0
        self.started = time.perf_counter()
        self.tty = sys.stderr.isatty()
        self.every_s = 0.2 if self.tty else 5.0
        self.last = -math.inf

    def step(self, note: str = "", count: int = 1) -> None:
        """`count` more parts are done; `note` says what is being worked on."""
        self.done += count
        now = time.perf_counter()
        if now - self.last < self.every_s and self.done < self.total:
            return
        self.last = now
        text = f"{self.title} {self.done}/{self.total}, {now - self.started:.0f} s  {note}"
        if self.tty:
            print(f"\r{text[:100]:100}", end="", file=sys.stderr, flush=True)
        else:
            print(text, file=sys.stderr, flush=True)
        if self.done >= self.total and self.tty:
            print(file=sys.stderr)


def at_least_one(text: str) -> int:
    """An argument that counts something; argparse.ArgumentTypeError for what is no whole number of at least 1."""
    return _at_least(1, text)


def at_least_zero(text: str) -> int:
    """As `at_least_one`, where there may be none."""
    return _at_least(0, text)


def _at_least(least: int, text: str) -> int:
    value = int(text) if text.isdecimal() else -1
    if value < least:
        raise argparse.ArgumentTypeError(f"expected a whole number of at least {least}, got {text!r}")
    return value


def lines(results: Any) -> list[str]:
    """Results for reading: a mapping as a line an entry, rows as a table."""
    if isinstance(results, Mapping):
        return align([(key, _short(value)) for key, value in results.items()])
    columns = list(dict.fromkeys(key for row in results for key in row))
    cells = [[_short(row[key]) if key in row else "" for key in columns] for row in results]
    return align([columns, *cells])


def align(rows: Sequence[Sequence[str]], left: Sequence[int] = (0,)) -> list[str]:
    """Cells in columns, those in `left` to the left, the others to the right."""
    widths = [max(map(len, column)) for column in zip(*rows)]
    return [
        "  ".join(
            c.ljust(w) if i in left else c.rjust(w) for i, (c, w) in enumerate(zip(row, widths))
        ).rstrip()
        for row in rows
    ]


def _short(value: Any) -> str:
    value = plain(value)
    if isinstance(value, float):
        return f"{value:.6g}"
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) < 60 else f"{text[:56]} ..."
