"""What judges the project: pymunk's own examples and tests, hostile calls, long runs, plans against sweeps, the pages.

It lies beside the tests and not in the package. `rigidarea compat`, `rigidarea plan --validate` and `--docs` find it
where the package is a checkout's (`rigidarea.checkout`).
"""

from __future__ import annotations

import os
from pathlib import Path

_TESTS = Path(__file__).resolve().parents[1]


def environment(**more: str) -> dict[str, str]:
    """The environment of a process that imports this package's rigidarea and the harness, wherever it runs."""
    paths = [str(_TESTS.parent), str(_TESTS), os.environ.get("PYTHONPATH", "")]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, paths)), **more}
