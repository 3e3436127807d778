"""The decorators of kernels, whatever runs them (`compile.chosen`): one text, three ways."""

from ..compile.chosen import BACKEND, COMPILED, INTERPRETED, LIBRARY

if BACKEND == COMPILED:
    from ..compile.compiled import (
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
    from ..compile.intrinsics import array_at, caller, floats
else:
    from ..compile.plain import (
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
