"""Small dense algebra of the kernels."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rigidarea.compile.jit import kernel, vectorized

Array = NDArray[np.float64]

#: Sums in any order, so that several terms go at once.
SUMS = {"reassoc", "contract"}


@vectorized(
    [f"f8(f8[{a}], f8[{b}])" for a in (":", "::1") for b in (":", "::1")],
    fastmath=SUMS,
)
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


@vectorized("void(f8[:, ::1], i8, i8, i8[::1])", fastmath=SUMS)
def factor(a: Array, n: int, end: int, pivot: NDArray[np.int64]) -> None:
    """``eliminate`` of columns n … ``end`` - 1, of a regular matrix; leaves what ``again`` needs."""
    for i in range(n):
        p, most = i, abs(a[i, i])
        for r in range(i + 1, n):
            if abs(a[r, i]) > most:
                p, most = r, abs(a[r, i])
        pivot[i] = p
        if p != i:
            for c in range(end):
                a[i, c], a[p, c] = a[p, c], a[i, c]
        inverse, row = 1.0 / a[i, i], a[i, i + 1 : end]
        for r in range(i + 1, n):
            f = a[r, i] * inverse
            a[r, i] = f
            if f != 0.0:
                below = a[r, i + 1 : end]
                for c in range(len(row)):
                    below[c] -= f * row[c]
    for i in range(n - 1, -1, -1):
        inverse, row = 1.0 / a[i, i], a[i, n:end]
        for c in range(len(row)):
            row[c] *= inverse
        for r in range(i):
            f = a[r, i]
            if f != 0.0:
                above = a[r, n:end]
                for c in range(len(row)):
                    above[c] -= f * row[c]


@vectorized("void(f8[:, ::1], i8, i8[::1], f8[::1])", fastmath=SUMS)
def again(a: Array, n: int, pivot: NDArray[np.int64], x: Array) -> None:
    """One more right-hand side x (n,) after ``factor``: the solution, in its place."""
    for i in range(n):
        p = pivot[i]
        x[i], x[p] = x[p], x[i]
    for i in range(n):
        total = x[i]
        for m in range(i):
            total -= a[i, m] * x[m]
        x[i] = total
    for i in range(n - 1, -1, -1):
        total = x[i]
        for m in range(i + 1, n):
            total -= a[i, m] * x[m]
        x[i] = total / a[i, i]
