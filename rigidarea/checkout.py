"""What judges the project is beside the tests of a checkout (`tests/harness`), and not in an installed package."""

from __future__ import annotations

import argparse
import importlib
import importlib.util
import sys
from pathlib import Path
from types import ModuleType

HARNESS = Path(__file__).resolve().parents[1] / "tests" / "harness"


def harness(name: str, asked: str) -> ModuleType:
    """The module `name` of the harness, which `asked` (a command, an option) needs.

    Raises FileNotFoundError where this package is not a checkout's.
    """
    if "harness" not in sys.modules:
        spec = importlib.util.spec_from_file_location(
            "harness", HARNESS / "__init__.py", submodule_search_locations=[str(HARNESS)]
        )
        if spec is None or spec.loader is None or not HARNESS.is_dir():
            raise FileNotFoundError(
                f"{asked} judges the project and needs a checkout of it: expected {HARNESS}, which is not there"
            )
        module = importlib.util.module_from_spec(spec)
        sys.modules["harness"] = module
        spec.loader.exec_module(module)
    return importlib.import_module(f"harness.{name}")


def pages(text: str) -> Path:
    """The argument of `--docs`: a folder of pages. argparse.ArgumentTypeError in an installed package, before hours of
    measuring."""
    if not HARNESS.is_dir():
        raise argparse.ArgumentTypeError(f"renews the project's pages, and needs a checkout: no {HARNESS}")
    return Path(text)
