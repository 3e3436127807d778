"""Random piles, scenes with joints, sleepers and mixed ones: do restores, pickles, copies, worlds keep the bits?

    python tests/sweep_copies.py 3000 4000               # a thousand seeds of each family
    python tests/sweep_copies.py 3000 3100 mixed joints  # of some

Prints which seeds differ, how far it has come, and at last how many of how many. Exit status 1 where any differs.
"""

from __future__ import annotations

import argparse
import sys
import time
import warnings
from collections import Counter
from collections.abc import Callable

from test_snapshots import SCENES, check_copied, check_restored
from test_worlds import check_world


def checks(name: str, seed: int) -> dict[str, Callable[[], None]]:
    """What is asked of a seed of a family; worlds have neither sleepers nor callbacks."""
    make = SCENES[name]
    found = {
        "restore": lambda: check_restored(make, seed, 600 if seed % 10 == 0 else 60),
        "pickle": lambda: check_copied(make, seed, "pickle"),
        "copy": lambda: check_copied(make, seed, ("copy", "deepcopy")[seed % 2]),
    }
    return found | ({"world": lambda: check_world(make, seed)} if name in ("piles", "joints") else {})


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("first", type=int)
    parser.add_argument("last", type=int, help="the first seed that is not asked")
    parser.add_argument("families", nargs="*", metavar="FAMILY", help=", ".join(SCENES))
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    asked: Counter[str] = Counter()
    differ: Counter[str] = Counter()
    started = told = time.monotonic()
    for seed in range(given.first, given.last):
        for name in given.families or SCENES:
            for what, check in checks(name, seed).items():
                asked[f"{what} {name}"] += 1
                try:
                    check()
                except AssertionError:
                    differ[f"{what} {name}"] += 1
                    print(f"{what} of {name} {seed} differs", flush=True)
        if time.monotonic() - told > 60:
            told = time.monotonic()
            print(
                f"seed {seed}, {told - started:.0f} s: {sum(differ.values())} of {asked.total()}", flush=True
            )
    for what, n in asked.items():
        print(f"{what}: {differ[what]} of {n} differ")
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
