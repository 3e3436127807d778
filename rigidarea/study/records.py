"""What every output file carries, and how it is written: JSON, CSV, rows as they come."""

from __future__ import annotations

import csv
import json
import math
import os
import platform
import sys
import time
from collections.abc import Iterable, Mapping, Sequence
from importlib import metadata
from pathlib import Path
from typing import Any

Row = dict[str, Any]

PACKAGES = (
    "rigidarea",
    "pymunk",
    "pyb2d3",
    "numpy",
    "numba",
    "scipy",
    "shapely",
    "matplotlib",
    "distributed",
)


def versions() -> dict[str, str]:
    """Versions of Python and of every package that bears on a number; absent ones are left out."""
    found = {"python": platform.python_version()}
    for package in PACKAGES:
        try:
            found[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            continue
    return found


def machine() -> dict[str, Any]:
    """Processor, cores, system, and the load when asked."""
    model = platform.processor()
    info = Path("/proc/cpuinfo")
    if info.exists():
        names = [
            line.split(":", 1)[1].strip() for line in info.read_text().splitlines() if "model name" in line
        ]
        model = names[0] if names else model
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else math.nan
    return {
        "processor": model,
        "cores": os.cpu_count(),
        "system": f"{platform.system()} {platform.machine()}",
        "load_1min": round(load, 2),
    }


def report(command: str, settings: Mapping[str, Any], results: Any, **more: Any) -> Row:
    """The object that a command writes: command, settings, versions, machine, results and what else it
    has.
    """
    return {
        "command": command,
        "settings": dict(settings),
        "versions": versions(),
        "machine": machine(),
        "results": results,
        **more,
    }


def plain(value: Any) -> Any:
    """The value as JSON knows it: no NaN or infinity (null instead), no NumPy scalars, no tuples."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if hasattr(value, "item"):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def write_json(target: str | Path | None, value: Any) -> None:
    """Write to a file, or to standard output for "-"; nothing for None."""
    if target is None:
        return
    text = json.dumps(plain(value), indent=1, ensure_ascii=False)
    if str(target) == "-":
        print(text)
    else:
        Path(target).parent.mkdir(parents=True, exist_ok=True)
        Path(target).write_text(text + "\n")


def write_csv(target: Path, rows: Sequence[Row]) -> None:
    """Rows as CSV; columns in order of first appearance, settings as JSON text, infinity as `inf`."""
    columns = list(dict.fromkeys(key for row in rows for key in row))
    target.parent.mkdir(parents=True, exist_ok=True)
    with target.open("w", newline="") as file:
        writer = csv.DictWriter(file, columns)
        writer.writeheader()
        for row in rows:
            writer.writerow({k: json.dumps(v) if isinstance(v, dict | list) else v for k, v in row.items()})


class Progress:
    """One line on standard error that says how far long work has come; lines instead if it is no terminal."""

    def __init__(self, title: str, total: int, every_s: float = 5.0) -> None:
        self.title, self.total, self.done = title, total, 0
        self.started = time.perf_counter()
        self.tty = sys.stderr.isatty()
        self.every_s = 0.2 if self.tty else every_s
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


def read_rows(path: Path) -> list[Row]:
    """Rows of a JSON-lines file; a last line cut short by a kill is dropped."""
    if not path.exists():
        return []
    rows = []
    for line in path.read_text().splitlines():
        try:
            rows.append(json.loads(line))
        except json.JSONDecodeError:
            continue
    return rows


def append_rows(path: Path, rows: Iterable[Row]) -> None:
    """Append rows to a JSON-lines file and flush them to the disk."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("a+b") as file:
        if file.tell():
            file.seek(-1, os.SEEK_END)
            if file.read(1) != b"\n":  # the kill came in the middle of a line
                file.write(b"\n")
        for row in rows:
            file.write(json.dumps(row).encode() + b"\n")
        file.flush()
        os.fsync(file.fileno())
