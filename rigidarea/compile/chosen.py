"""Which of the three ways kernels run in this process. It is chosen once, when the package is imported."""

from __future__ import annotations

import importlib.util
import os
import sys
from itertools import pairwise
from pathlib import Path

#: Machine code made ahead of time, which a wheel has beside this file; by numba, here; the kernels' text as Python.
LIBRARY, COMPILED, INTERPRETED = "library", "compiled", "interpreted"
_NAME = {"win32": "kernels.dll", "darwin": "kernels.dylib"}.get(sys.platform, "kernels.so")
#: Where a wheel has its machine code, and what is in it.
FILES = Path(__file__).with_name(_NAME), Path(__file__).with_name("kernels.json")


def _chosen() -> str:
    asked = os.environ.get("RIGIDAREA_BACKEND", "")
    if not asked and os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"):
        return INTERPRETED
    there = {
        LIBRARY: all(path.is_file() for path in FILES),
        COMPILED: importlib.util.find_spec("numba") is not None,
        INTERPRETED: True,
    }
    if asked and asked not in there:
        raise ValueError(f"RIGIDAREA_BACKEND must be one of {', '.join(there)}, got {asked!r}")
    for way in [asked] if asked else [LIBRARY, COMPILED]:
        if there[way]:
            return way
    wanted = (
        f"RIGIDAREA_BACKEND={asked}" if asked else "this build of rigidarea, which has no machine code in it,"
    )
    needs = (
        "a wheel that has machine code in it"
        if asked == LIBRARY
        else "numba: pip install 'rigidarea[compile]'"
    )
    raise ImportError(f"{wanted} needs {needs}")


def _is_the_command(program: str, words: list[str]) -> bool:
    """Whether these, `sys.argv[0]` and `sys.orig_argv`, are of `python -m rigidarea` or `rigidarea`."""
    return Path(program).stem == "rigidarea" or (program == "-m" and ("-m", "rigidarea") in pairwise(words))


try:
    BACKEND = _chosen()
except (ImportError, ValueError) as error:
    if not _is_the_command(sys.argv[0] if sys.argv else "", sys.orig_argv):
        raise
    print(f"rigidarea: {error}", file=sys.stderr)  # the package is imported before its command line
    raise SystemExit(2) from None


def backend() -> str:
    """What runs the kernels: "library" (machine code from the wheel), "compiled" (here, by numba), "interpreted".

    The library where there is one, else numba; RIGIDAREA_BACKEND=... in the environment chooses another.
    """
    return BACKEND
