"""How this package compiles: cached on disk by the content of its sources; kernels without reference counts.

numba's cache notices when the file of a function changes, not when a file that it calls into does. So the cache
lives in a folder named after a hash of all our sources that compile anything: a new version never runs an old
version's machine code, and an install that cannot be written to needs no writing. What is in the folder, and whose it
is: `cache`.
"""

from __future__ import annotations

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
        if b"jit import" in text:  # the others hold no machine code
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
njit: Any = cached(numba.njit)
#: Decorator for kernels, `@kernel` or `@kernel(inline="always")`. They look at arrays that somebody else keeps
#: alive; counting references to them would cost more than clipping two boxes. The price: a kernel cannot allocate.
kernel: Any = functools.partial(njit, _nrt=False)


def callback(signature: Any) -> Any:
    """Decorator for C callbacks made of kernels."""
    return functools.partial(cached(functools.partial(numba.cfunc, signature), at_once=True), _nrt=False)
