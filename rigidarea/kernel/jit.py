"""How this package compiles: cached on disk by the content of its sources; kernels without reference counts.

numba's cache notices when the file of a function changes, not when a file that it calls into does. So the cache
lives in a folder named after a hash of all our sources that compile anything: a new version never runs an old
version's machine code, and an install that cannot be written to needs no writing. What is in the folder, and whose it
is: `cache`.
"""

from __future__ import annotations

import ctypes
import functools
import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
from numba.core import caching

from . import cache


@functools.lru_cache(maxsize=1)
def cache_folder() -> str:
    """Where the machine code is kept: see `cache.folder`."""
    digest = hashlib.sha256(numba.__version__.encode() + cache.FORMAT)
    root = Path(__file__).parent.parent
    for source in sorted(root.rglob("*.py")):
        text = source.read_bytes()
        if source.parent.name == "kernel" or b"jit import" in text:  # numbers too are compiled in
            digest.update(source.relative_to(root).as_posix().encode() + text)
    cache.notice.folder = cache.folder(digest.hexdigest()[:16])
    return cache.notice.folder


def cached(compiler: Callable[..., Any], at_once: bool = False) -> Callable[..., Any]:
    """`compiler` (numba.njit, numba.cfunc(signature)) with cache=True, kept in `cache_folder` in checked files.

    at_once: it compiles when it decorates, not at the first call.
    """

    def compile_cached(function: Any = None, **options: Any) -> Any:
        if function is None:
            return functools.partial(compile_cached, **options)
        before = numba.config.CACHE_DIR, caching.IndexDataCacheFile
        numba.config.CACHE_DIR, caching.IndexDataCacheFile = cache_folder(), cache.CheckedFile
        try:
            decorate = functools.partial(compiler(cache=True, **options), function)
            return cache.notice.eagerly(decorate) if at_once else decorate()
        finally:
            numba.config.CACHE_DIR, caching.IndexDataCacheFile = before

    return compile_cached


#: `@njit` for functions that may allocate.
njit: Any = cached(functools.partial(numba.njit, error_model="numpy"))
#: Decorator for kernels, `@kernel` or `@kernel(inline="always")`. They look at arrays that somebody else keeps
#: alive; counting references to them would cost more than clipping two boxes. The price: a kernel cannot allocate.
kernel: Any = functools.partial(njit, _nrt=False)


class _Interpreted:
    """A C callback that is interpreted: what numba's cfunc is with NUMBA_DISABLE_JIT."""

    def __init__(self, function: Any, kind: Any) -> None:
        self._keep = kind(function)
        self.address = ctypes.cast(self._keep, ctypes.c_void_p).value


def callback(signature: Any) -> Any:
    """Decorator for C callbacks made of kernels; `.address` is where C finds them."""
    if numba.config.DISABLE_JIT:
        from .memory import prototype

        return lambda function: _Interpreted(function, prototype(signature))
    compiler = cached(functools.partial(numba.cfunc, signature), at_once=True)
    return functools.partial(compiler, _nrt=False, error_model="numpy")
