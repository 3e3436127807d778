"""The command line in a process of its own, as a user calls it: a host serves one program."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]


def command(folder: Path, *words: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """`rigidarea WORDS`, called in a folder."""
    return subprocess.run(
        [sys.executable, "-m", "rigidarea", *words],
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONPATH": str(ROOT), **environment},
        timeout=300,
        cwd=folder,
    )
