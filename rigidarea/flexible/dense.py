"""Small dense algebra of the kernels."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rigidarea.compile.jit import kernel, vectorized

Array = NDArray[np.float64]

#: Sums in any order, so that several terms go at once.
_SUMS = {"reassoc", "contract"}


@vectorized(
    [f"f8(f8[{a}], f8[{b}])" for a in (":", "::1") for b in (":", "::1")],
    fastmath=_SUMS,
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


SINGULAR = 1e-12  # of a diagonal: what rounding leaves of one that other rows have taken up


@vectorized("void(f8[:, ::1], f8[:, ::1], i8, f8[:, :, ::1], i8[::1])", fastmath=_SUMS)
def factor(k: Array, c: Array, n: int, work: Array, last: NDArray[np.int64]) -> None:
    """Of I + K C, for ``yielded``: into work (3, n, n) and last (n,). K, C (n, n) symmetric, K ≥ 0.

    With K = Uᵀ U, (I + K C)⁻¹ K = Uᵀ (I + U C Uᵀ)⁻¹ U: symmetric, so without pivots, half the work. U keeps to the
    band of K, whose rows are those of neighbours.
    """
    u, t, a = work[0], work[1], work[2]
    end = 0
    for j in range(n):
        for i in range(j, n):
            u[j, i] = k[j, i]
            if k[j, i] != 0.0:
                end = max(end, i + 1)
        last[j] = end  # of what fills in, too
    for j in range(n):
        end = last[j]
        if u[j, j] <= SINGULAR * k[j, j]:
            u[j, j:end] = 0.0
            continue
        scale = 1.0 / np.sqrt(u[j, j])
        for i in range(j, end):
            u[j, i] *= scale
        for i in range(j + 1, end):
            f = u[j, i]
            for m in range(i, end):
                u[i, m] -= f * u[j, m]
    for j in range(n):  # U C, and I + U C Uᵀ
        row = t[j]
        for m in range(n):
            row[m] = 0.0
        for i in range(j, last[j]):
            f = u[j, i]
            if f != 0.0:
                for m in range(n):
                    row[m] += f * c[i, m]
        for i in range(j + 1):
            total = 0.0
            for m in range(i, last[i]):
                total += row[m] * u[i, m]
            a[j, i] = total
        a[j, j] += 1.0
    for i in range(n):  # G D Gᵀ: G D in a, G in t; D may be negative, where a body is about to buckle
        for j in range(i):
            total = a[i, j]
            for m in range(j):
                total -= a[i, m] * t[j, m]
            a[i, j] = total
        for j in range(i):
            t[i, j] = a[i, j] / a[j, j]
            a[i, i] -= a[i, j] * t[i, j]


@vectorized("void(f8[:, ::1], i8, i8, f8[:, :, ::1], i8[::1])", fastmath=_SUMS)
def yielded(right: Array, n: int, columns: int, work: Array, last: NDArray[np.int64]) -> None:
    """Solves (I + K C) y = −K r for the first ``columns`` rows r of ``right``, in place, after ``factor``."""
    u, t, a = work[0], work[1], work[2]
    for r in range(columns):
        x = right[r]
        for j in range(n):
            total = 0.0
            for m in range(j, last[j]):
                total += u[j, m] * x[m]
            x[j] = total
        for i in range(n):
            total = x[i]
            for m in range(i):
                total -= t[i, m] * x[m]
            x[i] = total
        for i in range(n):
            x[i] /= a[i, i]
        for i in range(n - 1, -1, -1):
            f = x[i]
            for m in range(i):
                x[m] -= f * t[i, m]
        for j in range(n - 1, -1, -1):
            f, x[j] = x[j], 0.0
            for m in range(j, last[j]):
                x[m] -= f * u[j, m]
