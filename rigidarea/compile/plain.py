"""Kernels without numba: machine code from the library where it has a function, else their text as Python.

What Python calls is in the library (`tools/machine_code` finds it); what only kernels call is compiled into those, and
is Python text here.
"""

from __future__ import annotations

import ctypes
import functools
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from .chosen import BACKEND, FILES, LIBRARY
from .library import Library

#: None: interpreted.
library = Library(*FILES) if BACKEND == LIBRARY else None

_CTYPES = {
    "uintp": ctypes.c_size_t,
    "float64": ctypes.c_double,
    "int32": ctypes.c_int32,
    "uint32": ctypes.c_uint32,
    "int64": ctypes.c_int64,
    "void": None,
}


def prototype(signature: str) -> Any:
    """The ctypes function type of a signature of pointers and scalars, "result(argument, ...)" with numba's names."""
    result, _, arguments = signature.rstrip(")").partition("(")
    kinds: list[Any] = [_CTYPES[kind.strip()] for kind in (result, *filter(None, arguments.split(",")))]
    return ctypes.CFUNCTYPE(*kinds)


def kernel(function: Any = None, **options: Any) -> Any:
    """As `compiled.kernel`, `compiled.entry`, `compiled.njit`."""
    if function is None:
        return functools.partial(kernel, **options)
    return library.function(function) if library else function


njit: Any = kernel
entry: Any = kernel


def vectorized(signatures: Any, **options: Any) -> Any:
    """As `compiled.vectorized`."""
    return kernel


class _Interpreted:
    """A C callback that is interpreted: what numba's cfunc is else."""

    def __init__(self, function: Any, kind: Any) -> None:
        self._keep = kind(function)
        self.address = ctypes.cast(self._keep, ctypes.c_void_p).value


def callback(signature: str) -> Any:
    """As `compiled.callback`."""

    def decorate(function: Any) -> Any:
        return library.callback(function) if library else _Interpreted(function, prototype(signature))

    return decorate


def external(name: str, signature: str, address: int) -> Any:
    """As `compiled.external`."""
    if library:
        library.bind(name, address)
    return prototype(signature)(address)


def lock_for_fork() -> tuple[Callable[[], Any], Callable[[], Any]]:
    """Nothing is locked: nothing compiles."""
    return (lambda: None), (lambda: None)


# --- memory: see `compile.raw_memory` ---


def array_at(address: int, shape: tuple[int, ...], dtype: Any) -> np.ndarray:
    """`kernel.memory.array_at`."""
    size = int(np.prod(shape)) * np.dtype(dtype).itemsize
    if size == 0:
        return np.zeros(shape, dtype)
    memory = (ctypes.c_char * size).from_address(int(address))
    return np.frombuffer(memory, dtype=dtype).reshape(shape)


def caller(signature: str) -> Any:
    """`kernel.memory.caller`."""
    kind = prototype(signature)
    return lambda address, *arguments: kind(int(address))(*arguments)


floats: Any = np.empty


def copy_memory(to: int, source: int, size: int) -> int:
    """C's memcpy: so many bytes."""
    return int(ctypes.memmove(int(to), int(source), int(size)))


def clock_gettime(clock: int, at: int) -> int:
    """C's, of the processor time of the thread: two whole numbers of 64 bits, seconds and nanoseconds."""
    array_at(at, (2,), np.int64)[:] = divmod(time.thread_time_ns(), 10**9)
    return 0
