"""The flexibility between boundary nodes, block by block: all of it at once where it is small, else when first used.

Rows and columns of the interface come in pieces of NODES nodes, the hub's three in a piece of their own. With V the
piece's columns of ``factor``, on their common path,

    C_ij = V_iᵀ V_j + A_i B_jᵀ,

A Bᵀ what relieves rigid motion and takes the modes out. A contact is between a few pieces at a time, a wheel of
5,000 nodes has 160: ``fill`` makes a block when an evaluation first asks for it, in the array that kernels read,
whose other pages the system has not given yet. A run of any length needs the blocks of pieces that are loaded together.
"""

from __future__ import annotations

import itertools
import mmap
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rigidarea.compile.jit import entry

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

NODES = 32  # a piece: fewer keep more paths, more make blocks that are larger than a contact
WIDE = 2 * NODES


class Pieces(NamedTuple):
    """What blocks are made of; i interface rows (2 f + 3) in p pieces, r terms of A Bᵀ.

    start (p + 1,): where a piece's path begins; path (t,): rows of the factor, ascending within a piece; value (t,
    WIDE): V there; relief_left, relief_right (i, r): A and B. Without pieces p = t = i = 0.
    """

    start: Ints
    path: Ints
    value: Array
    relief_left: Array
    relief_right: Array


def no_pieces() -> Pieces:
    """The pieces of a body whose flexibility is whole."""
    return Pieces(
        np.zeros(1, np.int64), np.zeros(0, np.int64), np.zeros((0, WIDE)), np.zeros((0, 0)), np.zeros((0, 0))
    )


def spans(count: int) -> list[tuple[int, int]]:
    """Rows of each piece of an interface of ``count`` rows (2 f + 3)."""
    ends = [*range(0, count - 3, WIDE), count - 3]
    return [*itertools.pairwise(ends), (count - 3, count)]


@entry(fastmath={"contract"})
def fill(
    c: Array, ready: NDArray[np.bool_], start: Ints, path: Ints, value: Array, left: Array, right: Array, i: int, j: int
) -> None:  # fmt: skip
    """Block (i, j) of ``c`` and its transpose: the same to the last bit, whichever is asked for."""
    i, j = min(i, j), max(i, j)
    last, bound = len(start) - 2, len(c) - 3
    i0, i1 = (i * WIDE, min(i * WIDE + WIDE, bound)) if i < last else (bound, bound + 3)
    j0, j1 = (j * WIDE, min(j * WIDE + WIDE, bound)) if j < last else (bound, bound + 3)
    for a in range(i0, i1):
        row = c[a, j0:j1]
        for k in range(j1 - j0):
            s = 0.0
            for m in range(left.shape[1]):
                s += left[a, m] * right[j0 + k, m]
            row[k] = s
    p, q = start[i], start[j]
    while p < start[i + 1] and q < start[j + 1]:
        if path[p] < path[q]:
            p += 1
        elif path[p] > path[q]:
            q += 1
        else:
            for a in range(i1 - i0):
                x, y, row = value[p, a], value[q, : j1 - j0], c[i0 + a, j0:j1]
                if x != 0.0:
                    for k in range(len(row)):
                        row[k] += x * y[k]
            p += 1
            q += 1
    for a in range(i0, i1):
        for k in range(j0, j1):
            c[k, a] = c[a, k]
    ready[i, j] = ready[j, i] = True


def fill_all(c: Array, ready: NDArray[np.bool_], pieces: Pieces) -> None:
    """All blocks of ``c`` that are not ready yet."""
    for i, j in zip(*np.nonzero(np.triu(~ready)), strict=True):
        fill(c, ready, *pieces, int(i), int(j))


def whole(pieces: Pieces) -> Array:
    """The flexibility (i, i)."""
    count = len(pieces.relief_left)
    c = np.empty((count, count))
    fill_all(c, np.zeros((len(pieces.start) - 1,) * 2, bool), pieces)
    return c


def sparse(pieces: Pieces) -> tuple[Array, NDArray[np.bool_]]:
    """A flexibility (i, i) of which only the hub's rows and columns are ready, and which blocks are (p, p)."""
    count, p = len(pieces.relief_left), len(pieces.start) - 1
    memory = mmap.mmap(-1, 8 * count * count)  # zeros that take no room until they are written
    if hasattr(mmap, "MADV_NOHUGEPAGE"):  # pages of 4 KiB: one of 2 MiB is 25 of a wheel's rows
        memory.madvise(mmap.MADV_NOHUGEPAGE)
    c, ready = np.frombuffer(memory).reshape(count, count), np.zeros((p, p), bool)
    for j in range(p):
        fill(c, ready, *pieces, p - 1, j)
    return c, ready
