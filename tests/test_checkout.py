"""What judges the project is beside the tests: an installed package has none of it, and says so."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import rigidarea

PACKAGE = Path(rigidarea.__file__).parent


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """Runs the command line of the package alone, as a wheel has it."""
    folder = tmp_path_factory.mktemp("installed")
    shutil.copytree(PACKAGE, folder / "rigidarea", ignore=shutil.ignore_patterns("__pycache__"))

    def run(*words: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-m", "rigidarea", *words],
            cwd=folder,
            env={**os.environ, "PYTHONPATH": str(folder)},
            capture_output=True,
            text=True,
        )

    return run


@pytest.mark.parametrize(
    "words,asked",
    [
        (["compat", "examples"], "compat"),
        (["plan", "--validate"], "plan --validate"),
        (["bench", "kernels", "--docs", "docs"], "--docs"),
    ],
    ids=lambda words: " ".join(words) if isinstance(words, list) else "",
)
def test_what_judges_needs_a_checkout(installed, words, asked):
    done = installed(*words)
    assert done.returncode == 2, done.stderr
    assert asked in done.stderr and "needs a checkout" in done.stderr, done.stderr
    assert "Traceback" not in done.stderr


def test_a_plan_needs_none(installed):
    """Nor does the help, which lists what does."""
    done = installed("plan", "rest", "--tolerance", "1%")
    assert done.returncode == 0 and "decided by" in done.stdout, done.stderr
    assert "(in a checkout)" in " ".join(installed("--help").stdout.split())
