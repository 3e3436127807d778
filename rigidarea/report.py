"""The JSON object that a command writes, and how it is written."""

from __future__ import annotations

import json
import math
import os
import platform
import sys
from collections.abc import Mapping
from importlib import metadata
from pathlib import Path
from typing import Any

PACKAGES = (
    "rigidarea",
    "pymunk",
    "numpy",
    "numba",
    "shapely",
    "scipy",
    "matplotlib",
    "pygame-ce",
    "pyb2d3",
)
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


def envelope(command: str, settings: Mapping[str, Any], results: Any, **more: Any) -> dict[str, Any]:
    """The object: `command`, `settings`, `versions`, `machine`, `results`, and what else the command has."""
    return {
        "command": command,
        "settings": dict(settings),
        "versions": versions(),
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
    """Write to `file`, its folder made; to standard output for "-"; nothing for None."""
    if file is None:
        return
    text = json.dumps(plain(value), indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    if str(file) == "-":
        sys.stdout.write(text)
        return
    path = Path(file)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
