"""Work arrays of one pair of bodies: what the search found, crossings, regions, and one region's arcs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

# enter_*: the crossing where A enters B (edge and parameter on each body), leave_*: where it leaves
REGION = np.dtype(
    [
        (f"{end}_{body}{what}", t)
        for end in ("enter", "leave")
        for body in "ab"
        for what, t in (("", "i8"), ("_t", "f8"))
    ]
    + [(name, "f8") for name in ("enter_x", "enter_y", "leave_x", "leave_y")]
    + [("area", "f8"), ("x", "f8"), ("y", "f8"), ("nx", "f8"), ("ny", "f8"), ("chord", "f8"), ("force", "f8")]
    + [("x_chord", "f8"), ("y_chord", "f8")]
    + [("give", "f8")]  # see ``condense``; middles of the arcs: two nodes, and the share of the second
    + [(f"{what}_{body}", t) for body in "ab" for what, t in (("low", "i8"), ("high", "i8"), ("share", "f8"))]
    + [("first", "i8"), ("arcs", "i8")]  # a crossing of it, and its arcs a body
)
CROSSING = np.dtype(
    [("a", "i8"), ("b", "i8"), ("ta", "f8"), ("tb", "f8"), ("x", "f8"), ("y", "f8"), ("enter", "i8"), ("next_a", "i8"),
     ("next_b", "i8"), ("used", "i8")]
)  # fmt: skip

MANY = -1  # more crossings, arcs or candidates than the work arrays hold
TORN = -2  # crossings that do not alternate: a boundary that crosses itself
SLICED = -3  # a region whose arcs have no common direction (a bar through a bar)


class Scratch(NamedTuple):
    """See the module; ``near`` and ``mark`` have a row for each body."""

    stack: Ints
    pairs: Ints  # (p, 2) candidate leaves
    near: Ints  # (2, r, 4) runs of points and of FE nodes near the other body: first and end of each
    runs: Ints  # (2,) their numbers
    mark: Ints  # (2, n) search that saw a point, [-1] that of the last search
    crossings: NDArray[np.void]
    regions: NDArray[np.void]
    x: Array  # (2, n)
    y: Array
    edge: Ints
    t: Array  # (2, n, 2)
    cut: Array  # (2 n,)


def scratch(points: int) -> Scratch:
    """Arrays for boundaries of up to ``points`` points in all."""
    n = points + 3
    return Scratch(
        np.zeros((256, 2), np.int64), np.zeros((16384, 2), np.int64), np.zeros((2, n, 4), np.int64),
        np.zeros(2, np.int64), np.zeros((2, n), np.int64), np.zeros(512, CROSSING), np.zeros(1024, REGION),
        np.zeros((2, n)), np.zeros((2, n)), np.zeros((2, n), np.int64), np.zeros((2, n, 2)), np.zeros(2 * n),
    )  # fmt: skip
