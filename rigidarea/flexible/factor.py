"""Solves with the factors K = L D Lᵀ of a sparse stiffness, for whole loads and for the boundary alone.

Between boundary nodes the flexibility is P' K⁻¹ P = Vᵀ V with V = D^-1/2 L⁻¹ P, P the unit loads there. A column of V
is zero but on its path, the rows that elimination takes its load through (J. R. Gilbert, Predicting structure in sparse
matrix computations, SIAM J. Matrix Anal. Appl. 15, 1994, doi:10.1137/S0895479887139455): a thousand of
sixty thousand. So neither whole solutions nor back substitution are needed, and a pair of nodes costs what their paths
have in common. ``blocks`` keeps V and multiplies it out.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spl
from numpy.typing import NDArray

from rigidarea.compile.jit import entry

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Rows = NDArray[np.int32]


class Factors(NamedTuple):
    """L D Lᵀ of a positive matrix (n, n) whose row i is row ``place[i]`` here; L as compressed columns."""

    place: Ints
    start: Ints
    row: Rows
    value: Array
    diagonal: Array


def factorise(k: sp.csc_array) -> Factors:
    """The factors of ``k`` (n, n), symmetric. Raises ValueError where it is not positive: something is not held."""
    lu = spl.splu(k, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    diagonal = lu.U.diagonal()  # U = D Lᵀ, as pivots stay on the diagonal
    if not ((lu.perm_r == lu.perm_c).all() and diagonal.min() > 0.0):
        raise ValueError(f"the stiffness must be positive, got a pivot of {diagonal.min():.3g}")
    lower = lu.L.tocsc()
    return Factors(
        lu.perm_r.astype(np.int64), lower.indptr.astype(np.int64), lower.indices.astype(np.int32), lower.data,
        diagonal,
    )  # fmt: skip


@entry
def substitute(start: Ints, row: Rows, value: Array, diagonal: Array, x: Array) -> None:
    """Solves L D Lᵀ x = b in place, right-hand sides (n, m) the columns of x."""
    n, m = x.shape
    for j in range(n):
        k = 0
        while k < m and x[j, k] == 0.0:
            k += 1
        if k == m:
            continue
        for p in range(start[j], start[j + 1]):
            if row[p] > j:
                for k in range(m):
                    x[row[p], k] -= value[p] * x[j, k]
    for j in range(n - 1, -1, -1):
        for k in range(m):
            x[j, k] /= diagonal[j]
        for p in range(start[j], start[j + 1]):
            if row[p] > j:
                for k in range(m):
                    x[j, k] -= value[p] * x[row[p], k]


@entry
def trace(start: Ints, row: Rows, on: NDArray[np.bool_]) -> int:
    """Adds to the rows ``on`` (n,) those that forward substitution takes their loads through; their number."""
    count = 0
    for j in range(len(on)):
        if on[j]:
            count += 1
            for p in range(start[j], start[j + 1]):
                on[row[p]] = True
    return count


@entry
def forward(start: Ints, row: Rows, value: Array, path: Ints, place: Ints, x: Array) -> None:
    """Solves L x = b in place on the rows of ``path``, ascending and closed under ``trace``: x (len(path), m).

    place (n,): where in the path a row is.
    """
    m = x.shape[1]
    for i in range(len(path)):
        own, j = x[i], path[i]
        for p in range(start[j], start[j + 1]):
            if row[p] > j:
                v, other = value[p], x[place[row[p]]]
                for k in range(m):
                    other[k] -= v * own[k]
