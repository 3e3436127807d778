"""`python -m rigidarea.compile FOLDER`: makes the library of machine code that a wheel has, in one to four minutes.

Needs numba, scipy (what is flexible is in it too), and a C compiler: ziglang from PyPI, or `cc`.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
from pathlib import Path


def main(arguments: list[str] | None = None) -> int:
    """The command."""
    parser = argparse.ArgumentParser(prog="python -m rigidarea.compile", description=__doc__)
    parser.add_argument("folder", type=Path, help="where the library and its list of contents are written")
    folder: Path = parser.parse_args(arguments).folder
    os.environ["RIGIDAREA_BACKEND"] = "compiled"
    with (
        tempfile.TemporaryDirectory() as cache
    ):  # what comes from a cache is machine code, which is of no use here
        os.environ["NUMBA_CACHE_DIR"] = cache
        return _make(folder)


def _make(folder: Path) -> int:
    from . import ahead, rehearsal

    since = time.monotonic()
    made = ahead.make(folder, rehearsal.rehearse)
    size = sum(path.stat().st_size for path in made)
    print(f"{folder}: {size / 1e6:.1f} MB in {time.monotonic() - since:.0f} s", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
