"""How far a region reaches: what its polygon says, and its arcs."""

from __future__ import annotations

import numpy as np

from ..compile.jit import kernel
from .arc import on_arc


@kernel
def extent(
    polygon: np.ndarray, bows: np.ndarray, start: int, stop: int, arcs: bool, nx: float, ny: float
) -> tuple[float, float]:
    """(lowest, highest) of n . p over the loop polygon[start:stop] of a `Work` (length); n a unit vector, A's frame.

    arcs: the loop's `arcs`. Without it the same of the polygon alone, whose vertices are an arc's ends and middle.
    """
    low = np.inf
    high = -np.inf
    j = stop - 1
    for i in range(start, stop):
        x = polygon[i, 0]
        y = polygon[i, 1]
        h = nx * x + ny * y
        low = min(low, h)
        high = max(high, h)
        r = bows[j, 2] if arcs else 0.0
        if (
            r != 0.0
        ):  # no more than half a turn: it reaches furthest on the side to which it bulges, or at its ends
            px = polygon[j, 0]
            py = polygon[j, 1]
            reach = r if nx * (y - py) - ny * (x - px) > 0.0 else -r
            fx = bows[j, 0] + reach * nx
            fy = bows[j, 1] + reach * ny
            if on_arc(px, py, x, y, r, fx, fy):
                low = min(low, nx * fx + ny * fy)
                high = max(high, nx * fx + ny * fy)
        j = i
    return low, high
