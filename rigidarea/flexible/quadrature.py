"""Gauss points of a region with one arc a body, for statics with a consistent tangent (``statics``)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rigidarea.compile.jit import entry, kernel
from rigidarea.flexible.boundary import Boundary
from rigidarea.flexible.slabs import GAUSS_W, GAUSS_X

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@kernel
def _straighten(x: Array, side: int, n: int, chord: float) -> bool:
    """Makes x grow along an arc; overhanging parts get no width, so no load. True if there were any."""
    bent = False
    top = 0.0
    for k in range(1, n + 1):
        if x[side, k] < top - 1e-12 * chord or x[side, k] > chord * (1.0 + 1e-12):
            bent = True
        top = min(max(x[side, k], top), chord)
        x[side, k] = top
    return bent


@entry
def quadrature(
    a: Boundary, b: Boundary, x: Array, y: Array, edge: Ints, t: Array, n_a: int, n_b: int, chord: float,
    point: Ints, value: Array,
) -> int:  # fmt: skip
    """Gauss points of the merged arcs, for statics with a consistent tangent: their number.

    point (g, 4): low and high point on A, low and high on B. value (g, 5): weight (length), share of A's high point,
    of B's, thickness d, and x along the chord.
    """
    _straighten(x, 0, n_a, chord)
    _straighten(x, 1, n_b, chord)
    i = j = count = 0
    lo = 0.0
    while i < n_a and j < n_b:
        hi = min(x[0, i + 1], x[1, j + 1])
        if hi > lo:
            wa, wb = x[0, i + 1] - x[0, i], x[1, j + 1] - x[1, j]
            for g in range(3):
                z = lo + GAUSS_X[g] * (hi - lo)
                ra, rb = (z - x[0, i]) / wa, (z - x[1, j]) / wb
                point[count, 0], point[count, 1] = edge[0, i], a.following[edge[0, i]]
                point[count, 2], point[count, 3] = edge[1, j], b.following[edge[1, j]]
                value[count, 0] = GAUSS_W[g] * (hi - lo)
                value[count, 1] = t[0, i, 0] + ra * (t[0, i, 1] - t[0, i, 0])
                value[count, 2] = t[1, j, 0] + rb * (t[1, j, 1] - t[1, j, 0])
                value[count, 3] = (y[1, j] + rb * (y[1, j + 1] - y[1, j])) - (
                    y[0, i] + ra * (y[0, i + 1] - y[0, i])
                )
                value[count, 4] = z
                count += 1
            lo = hi
        if x[0, i + 1] <= lo:
            i += 1
        else:
            j += 1
    return count
