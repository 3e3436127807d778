"""Forward and back substitution with the factors of a sparse matrix, many right-hand sides at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rigidarea.kernel.jit import entry

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@entry
def substitute(lp: Ints, li: Ints, lx: Array, up: Ints, ui: Ints, ux: Array, x: Array) -> None:
    """Solves L U x = b in place: L, U as compressed columns, right-hand sides (n, m) the columns of x."""
    n, m = x.shape
    for j in range(n):
        for p in range(lp[j], lp[j + 1]):
            if li[p] > j:
                for k in range(m):
                    x[li[p], k] -= lx[p] * x[j, k]
    for j in range(n - 1, -1, -1):
        for p in range(up[j], up[j + 1]):
            if ui[p] == j:
                for k in range(m):
                    x[j, k] /= ux[p]
        for p in range(up[j], up[j + 1]):
            if ui[p] < j:
                for k in range(m):
                    x[ui[p], k] -= ux[p] * x[j, k]
