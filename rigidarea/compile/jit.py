"""The decorators of kernels, whatever runs them (`compile.chosen`): one text, three ways."""

from .chosen import BACKEND, COMPILED, INTERPRETED, LIBRARY

if BACKEND == COMPILED:
    from .compiled import (
        callback,
        clock_gettime,
        copy_memory,
        entry,
        external,
        kernel,
        lock_for_fork,
        njit,
        vectorized,
    )
    from .intrinsics import array_at, caller, floats
else:
    from .plain import (
        array_at,
        callback,
        caller,
        clock_gettime,
        copy_memory,
        entry,
        external,
        floats,
        kernel,
        lock_for_fork,
        njit,
        vectorized,
    )

__all__ = [
    "BACKEND",
    "COMPILED",
    "INTERPRETED",
    "LIBRARY",
    "array_at",
    "callback",
    "caller",
    "clock_gettime",
    "copy_memory",
    "entry",
    "external",
    "floats",
    "kernel",
    "lock_for_fork",
    "njit",
    "vectorized",
]
