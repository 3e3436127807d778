"""Small dense algebra of the kernels."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rigidarea.kernel.jit import kernel

Array = NDArray[np.float64]


@kernel(fastmath={"reassoc", "contract"})
def dot(a: Array, b: Array) -> float:
    """Σ a b, several terms at once: one after another each would wait for the sum so far."""
    out = 0.0
    for i in range(len(a)):
        out += a[i] * b[i]
    return out


@kernel
def eliminate(a: Array, n: int, columns: int) -> None:
    """Gaussian elimination with partial pivoting of n equations; right-hand sides are the ``columns`` after the n of
    the matrix, and become the solutions. An unknown that no equation has is zero. n is at most a few dozen.
    """
    end = n + columns
    for i in range(n):
        p, most = i, abs(a[i, i])
        for r in range(i + 1, n):
            if abs(a[r, i]) > most:
                p, most = r, abs(a[r, i])
        if most == 0.0:
            continue
        if p != i:
            for c in range(i, end):
                a[i, c], a[p, c] = a[p, c], a[i, c]
        pivot, row = 1.0 / a[i, i], a[i, i + 1 : end]
        for r in range(i + 1, n):
            f = a[r, i] * pivot
            if f != 0.0:
                below = a[r, i + 1 : end]
                for c in range(len(row)):
                    below[c] -= f * row[c]
    for i in range(n - 1, -1, -1):
        pivot = 1.0 / a[i, i] if a[i, i] != 0.0 else 0.0
        for c in range(n, end):
            a[i, c] *= pivot
        for r in range(i):
            f = a[r, i]
            if f != 0.0:
                for c in range(n, end):
                    a[r, c] -= f * a[i, c]
