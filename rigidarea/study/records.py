"""How the studies write rows: CSV, and JSON lines as they come."""

from __future__ import annotations

import csv
import json
import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

Row = dict[str, Any]
PACKAGE = Path(__file__).parents[1]


def write_csv(target: Path, rows: Sequence[Row]) -> None:
    """Write rows to the file `target` as CSV; columns in order of first appearance, settings as JSON text, infinity as
    `inf`.
    """
    columns = list(dict.fromkeys(key for row in rows for key in row))
    target.parent.mkdir(parents=True, exist_ok=True)
    with target.open("w", newline="") as file:
        writer = csv.DictWriter(file, columns)
        writer.writeheader()
        for row in rows:
            writer.writerow({k: json.dumps(v) if isinstance(v, dict | list) else v for k, v in row.items()})


def read_rows(path: Path) -> list[Row]:
    """Rows of a JSON-lines file; a last line cut short by a kill is dropped.

    What was written before this package last changed is of other code: it is removed.
    """
    if not path.exists():
        return []
    if path.stat().st_mtime < max(file.stat().st_mtime for file in PACKAGE.rglob("*.py")):
        path.unlink()
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
