"""How this package compiles: cached on disk by the content of its sources; kernels without reference counts.

numba's cache notices when the file of a function changes, not when a file that it calls into does. So the cache
lives in a folder named after a hash of all our sources that compile anything: a new version never runs an old
version's machine code, and an install that cannot be written to needs no writing.
"""

from __future__ import annotations

import ctypes
import functools
import hashlib
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba


@functools.lru_cache(maxsize=1)
def cache_folder() -> str:
    """Where the machine code is kept: under NUMBA_CACHE_DIR, the user's cache folder, or the temporary one."""
    digest = hashlib.sha256(numba.__version__.encode())
    root = Path(__file__).parent.parent
    for source in sorted(root.rglob("*.py")):
        text = source.read_bytes()
        if b"jit import" in text:  # the others hold no machine code
            digest.update(source.relative_to(root).as_posix().encode() + text)
    homes = [
        numba.config.CACHE_DIR,
        os.environ.get("XDG_CACHE_HOME"),
        os.path.join(os.path.expanduser("~"), ".cache"),
        os.path.join(tempfile.gettempdir(), f"rigidarea-{os.getuid() if hasattr(os, 'getuid') else 'user'}"),
    ]
    for home in filter(None, homes):
        folder = os.path.join(home, "rigidarea", digest.hexdigest()[:16])
        try:
            os.makedirs(folder, exist_ok=True)
        except OSError:
            continue
        if os.access(folder, os.W_OK):
            return folder
    return tempfile.mkdtemp(prefix="rigidarea-")  # nothing can be kept


def cached(compiler: Callable[..., Any]) -> Callable[..., Any]:
    """`compiler` (numba.njit, numba.cfunc(signature)) with cache=True, kept in `cache_folder`."""

    def compile_cached(function: Any = None, **options: Any) -> Any:
        if function is None:
            return functools.partial(compile_cached, **options)
        before = numba.config.CACHE_DIR
        numba.config.CACHE_DIR = cache_folder()
        try:
            return compiler(cache=True, **options)(function)
        finally:
            numba.config.CACHE_DIR = before

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
    return functools.partial(cached(functools.partial(numba.cfunc, signature)), _nrt=False, error_model="numpy")
