"""All bodies of a system for the kernels: a table of addresses, so that machine code knows no number of bodies.

A tuple of bodies is a type of its own for every length, and compiled anew. Here a body is a row: its sizes, then where
its arrays are. ``boundary_at`` and ``work_at`` make the named tuples again, which costs a few dozen instructions.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidarea.compile.jit import kernel
from rigidarea.compile.raw_memory import array_at
from rigidarea.flexible.blocks import WIDE
from rigidarea.flexible.boundary import Boundary, Work

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

SIZES = 11  # points, FE nodes, boxes of the hierarchy, modes, rows of flexibility and swelling, geometric stiffnesses,
# coordinates of ``tension``, pieces of the flexibility, rows of their paths, terms beside them
WORK = SIZES + len(Boundary._fields)  # first column of the work arrays
COUPLING = WORK + len(Work._fields)
GEOMETRIC = COUPLING + 1


def table(
    boundaries: Sequence[Boundary],
    works: Sequence[Work],
    couplings: Sequence[Array],
    geometric: Sequence[Array],
) -> Ints:
    """A row a body. The arrays must be C-contiguous and outlive the table: nobody counts references to them.

    Raises ValueError for an array that is not contiguous.
    """
    out = np.zeros((len(boundaries), GEOMETRIC + 1), np.int64)
    for row, b, w, g, s in zip(out, boundaries, works, couplings, geometric, strict=True):
        arrays: tuple[NDArray[Any], ...] = (*b, *w, g, s)
        for name, array in zip((*b._fields, *w._fields, "coupling", "geometric"), arrays, strict=True):
            if not array.flags.c_contiguous:
                raise ValueError(f"{name} must be contiguous, got strides {array.strides}")
        row[:SIZES] = (
            len(b.points), len(b.nodes), len(b.boxes), b.modes.shape[1], len(b.flexibility), len(b.swell), len(s),
            b.soft.shape[1], len(b.ready), len(b.path), b.relief_left.shape[1],
        )  # fmt: skip
        row[SIZES:] = [array.ctypes.data for array in arrays]
    return out


@kernel(forceinline=True)  # nobody needs all of it
def boundary_at(bodies: Ints, i: int) -> Boundary:
    """Body i's boundary."""
    row = bodies[i]
    n, f, t, m, c, s, r = row[0], row[1], row[2], row[3], row[4], row[5], row[7]
    p, v, k = row[8], row[9], row[10]
    own = c if p > 0 else 0
    return Boundary(
        array_at(row[SIZES], (n, 2), np.float64),
        array_at(row[SIZES + 1], (n,), np.int32),
        array_at(row[SIZES + 2], (n,), np.int32),
        array_at(row[SIZES + 3], (t, 4), np.float64),
        array_at(row[SIZES + 4], (n,), np.int64),
        array_at(row[SIZES + 5], (n,), np.int64),
        array_at(row[SIZES + 6], (n,), np.float64),
        array_at(row[SIZES + 7], (2 * f + 3, m), np.float64),
        array_at(row[SIZES + 8], (c, c), np.float64),
        array_at(row[SIZES + 9], (f, 2), np.float64),
        array_at(row[SIZES + 10], (s,), np.float64),
        array_at(row[SIZES + 11], (2 * f + 3, r), np.float64),
        array_at(row[SIZES + 12], (r,), np.float64),
        array_at(row[SIZES + 13], (3 if r > 0 else 0, r, r), np.float64),
        array_at(row[SIZES + 14], (p, p), np.bool_),
        array_at(row[SIZES + 15], (p + 1,), np.int64),
        array_at(row[SIZES + 16], (v,), np.int64),
        array_at(row[SIZES + 17], (v, WIDE), np.float64),
        array_at(row[SIZES + 18], (own, k), np.float64),
        array_at(row[SIZES + 19], (own, k), np.float64),
    )


@kernel(forceinline=True)
def work_at(bodies: Ints, i: int) -> Work:
    """Body i's work arrays."""
    row = bodies[i]
    n, f, m, r = row[0], row[1], row[3], row[7]
    return Work(
        array_at(row[WORK], (n, 2), np.float64),
        array_at(row[WORK + 1], (n,), np.int64),
        array_at(row[WORK + 2], (f, 2), np.float64),
        array_at(row[WORK + 3], (f,), np.int64),
        array_at(row[WORK + 4], (n, 2), np.float64),
        array_at(row[WORK + 5], (n,), np.float64),
        array_at(row[WORK + 6], (n,), np.bool_),
        array_at(row[WORK + 7], (n + 1,), np.int64),
        array_at(row[WORK + 8], (f, 2), np.float64),
        array_at(row[WORK + 9], (f,), np.bool_),
        array_at(row[WORK + 10], (3,), np.float64),
        array_at(row[WORK + 11], (f + 1,), np.int64),
        array_at(row[WORK + 12], (m,), np.float64),
        array_at(row[WORK + 13], (1,), np.float64),
        array_at(row[WORK + 14], (f,), np.int64),
        array_at(row[WORK + 15], (f,), np.int64),
        array_at(row[WORK + 16], (2,), np.bool_),
        array_at(row[WORK + 17], (r, 2 * r), np.float64),
        array_at(row[WORK + 18], (3, r), np.float64),
        array_at(row[WORK + 19], (1,), np.bool_),
    )


@kernel(inline="always")  # numba returns no array that was not passed in
def coupling_at(bodies: Ints, i: int) -> Array:
    """Body i's ``modes.Reduced.coupling`` (m, m)."""
    m = bodies[i, 3]
    return array_at(bodies[i, COUPLING], (m, m), np.float64)


@kernel(inline="always")
def geometric_at(bodies: Ints, i: int) -> Array:
    """Body i's ``modes.Reduced.geometric`` (3, m, m), or (0, m, m)."""
    m = bodies[i, 3]
    return array_at(bodies[i, GEOMETRIC], (bodies[i, 6], m, m), np.float64)
