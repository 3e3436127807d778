"""Forward and back substitution with the factors of a sparse matrix, many right-hand sides at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rigidarea.kernel.jit import entry

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@entry
def substitute(
    lp: Ints, li: Ints, lx: Array, up: Ints, ui: Ints, ux: Array, wanted: NDArray[np.bool_], x: Array
) -> None:
    """Solves L U x = b in place: L, U as compressed columns, right-hand sides (n, m) the columns of x.

    Where b is zero but for a few rows, forward substitution passes by what these do not reach. wanted (n,): the rows of
    x that are asked for, and all that these depend on (``needed``); others are left unsolved.
    """
    n, m = x.shape
    for j in range(n):
        k = 0
        while k < m and x[j, k] == 0.0:
            k += 1
        if k == m:
            continue
        for p in range(lp[j], lp[j + 1]):
            if li[p] > j:
                for k in range(m):
                    x[li[p], k] -= lx[p] * x[j, k]
    for j in range(n - 1, -1, -1):
        if not wanted[j]:
            continue
        for p in range(up[j], up[j + 1]):
            if ui[p] == j:
                for k in range(m):
                    x[j, k] /= ux[p]
        for p in range(up[j], up[j + 1]):
            if ui[p] < j:
                for k in range(m):
                    x[ui[p], k] -= ux[p] * x[j, k]


@entry
def needed(rp: Ints, ri: Ints, wanted: NDArray[np.bool_]) -> None:
    """Adds to the ``wanted`` rows (n,) those that back substitution takes them from; U as compressed rows."""
    for i in range(len(wanted)):
        if wanted[i]:
            for p in range(rp[i], rp[i + 1]):
                wanted[ri[p]] = True
