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
from numba.core import caching, types
from numba.core.registry import CPUDispatcher, cpu_target

from . import cache, whole


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
            if at_once:
                with whole.compiling(cpu_target.target_context, part=False):
                    made = cache.notice.eagerly(decorate)
            else:
                made = decorate()
        finally:
            numba.config.CACHE_DIR, caching.IndexDataCacheFile = before
        if isinstance(made, CPUDispatcher):
            made.__class__ = Whole
        return made

    return compile_cached


def _general(kind: Any) -> Any:
    """The type for which one is compiled, where numba would compile one for each constant and size of integer."""
    kind = types.unliteral(kind)  # type: ignore[attr-defined]
    return types.int64 if kind in (types.int32, types.uint8) else kind


class Whole(CPUDispatcher):  # type: ignore[misc]
    """What runs for itself, though a part may be what calls it first."""

    part = False

    def compile(self, sig: Any) -> Any:
        with whole.compiling(self.targetctx, self.part):
            return super().compile(sig)

    def get_call_template(self, args: Any, kws: Any) -> Any:
        return super().get_call_template(tuple(map(_general, args)), kws)


#: `@njit` for functions that may allocate.
njit: Any = cached(functools.partial(numba.njit, error_model="numpy"))
#: Decorator for kernels that Python too calls. They look at arrays that somebody else keeps alive; counting references
#: to them would cost more than clipping two boxes. The price: a kernel cannot allocate.
entry: Any = functools.partial(njit, _nrt=False)


class _Part(Whole):
    """A kernel that is compiled into those that call it, and not for itself (`whole`)."""

    part = True

    def __call__(self, *arguments: Any) -> Any:
        if "way_in" not in self.__dict__:
            inner = self

            def way_in(*given: Any) -> Any:
                return inner(*given)

            self.way_in = entry(way_in)
        return self.way_in(*arguments)


def kernel(function: Any = None, **options: Any) -> Any:
    """Decorator for kernels that kernels call: `@kernel`, `@kernel(forceinline=True)`. As `entry`, but quicker made."""
    if function is None:
        return functools.partial(kernel, **options)
    if numba.config.DISABLE_JIT:
        return function
    made = numba.njit(
        _nrt=False, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True, **options
    )(function)
    made.__class__ = _Part
    return made


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
