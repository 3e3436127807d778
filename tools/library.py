"""Makes the library of machine code that a wheel has, in minutes: `python tools/library.py FOLDER`.

Needs numba, scipy (what is flexible is in it too), and a C compiler: ziglang from PyPI, or `cc`.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
from pathlib import Path


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="where the library and its list of contents are written")
    folder: Path = parser.parse_args().folder
    since = time.monotonic()
    with (
        tempfile.TemporaryDirectory() as cache
    ):  # what is on disk is machine code already: all is compiled here
        os.environ |= {"RIGIDAREA_BACKEND": "compiled", "RIGIDAREA_AHEAD": "1", "NUMBA_CACHE_DIR": cache}
        from machine_code import ahead, rehearsal

        made = ahead.make(folder, rehearsal.rehearse)
    size = sum(path.stat().st_size for path in made)
    print(f"{folder}: {size / 1e6:.1f} MB in {time.monotonic() - since:.0f} s", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
