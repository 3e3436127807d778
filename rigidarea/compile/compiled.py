"""How this package compiles with numba: cached on disk by the content of its sources; kernels without reference counts.

numba's cache notices when the file of a function changes, not when a file that it calls into does. So the machine code
of a module lives in a folder named after a hash of its source and of all of ours that it imports, directly or not: a
new version never runs an old version's machine code, what has not changed is not compiled again, and an install that
cannot be written to needs no writing. What is in the folder, and whose it is: `cache`.
"""

from __future__ import annotations

import functools
import hashlib
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
from llvmlite import binding
from numba.core import caching, types
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import CPUDispatcher, cpu_target
from numba.core.sigutils import normalize_signature

from . import cache, whole

_ROOT = Path(__file__).resolve().parent.parent
#: What has no part in what numba compiles, though what is compiled imports it.
_ELSEWHERE = {
    _ROOT / "__init__.py",
    *(_ROOT / f"compile/{name}.py" for name in ("cache", "chosen", "interrupts", "plain")),
}

#: An import from this package (nothing in it imports another way): dots, module, names. Reading syntax trees takes 1 s.
_IMPORT = re.compile(rf"^ *from (\.+|{_ROOT.name}\.?)([\w.]*) import (\([^)]*\)|.*)", re.MULTILINE)


@functools.cache
def _imports(source: Path) -> tuple[bytes, tuple[Path, ...]]:
    """A source's text, and the sources of this package that it imports, at its top or in functions."""
    text = source.read_bytes()
    found: set[Path] = set()
    for dots, module, names in _IMPORT.findall(text.decode()):
        folder = source.parents[len(dots) - 1] if dots[0] == "." else _ROOT
        folder = folder.joinpath(*module.split("."))
        inner = [folder / f"{name}.py" for name in re.findall(r"\w+", names)]
        found.update(
            path for path in (*inner, folder.with_suffix(".py"), folder / "__init__.py") if path.is_file()
        )
    return text, tuple(sorted(found - _ELSEWHERE))


@functools.cache
def cache_folder(source: Path) -> str:
    """Where the machine code of a source's functions is kept: see `cache.folder`."""
    met, left = {source}, [source]
    while left:
        new = set(_imports(left.pop())[1]) - met
        met |= new
        left += new
    digest = hashlib.sha256(numba.__version__.encode() + cache.FORMAT)
    for path in sorted(met):
        name = path.relative_to(_ROOT) if _ROOT in path.parents else Path(path.name)
        digest.update(name.as_posix().encode() + _imports(path)[0])
    found = cache.folder(digest.hexdigest()[:16])
    cache.notice.folder = str(Path(found).parent)
    return found


class _Locator(caching._CacheLocator):  # type: ignore[misc]
    """Tells numba where a function's machine code is kept: by content alone, so that all environments share it."""

    def __init__(self, source: Path, line: int) -> None:
        self._folder, self._line = cache_folder(source), line

    @classmethod
    def from_function(cls, py_func: Any, py_file: str) -> _Locator:
        return cls(Path(py_file).resolve(), py_func.__code__.co_firstlineno)

    def get_cache_path(self) -> str:
        return self._folder

    def get_source_stamp(self) -> str:
        return self._folder

    def get_disambiguator(self) -> str:
        return str(self._line)


def cached(compiler: Callable[..., Any], at_once: bool = False) -> Callable[..., Any]:
    """`compiler` (numba.njit, numba.cfunc(signature)) with cache=True, kept in `cache_folder` in checked files.

    at_once: it compiles when it decorates, not at the first call.
    """

    def compile_cached(function: Any = None, **options: Any) -> Any:
        if function is None:
            return functools.partial(compile_cached, **options)
        before = caching.CacheImpl._locator_classes, caching.IndexDataCacheFile
        caching.CacheImpl._locator_classes = [_Locator]
        caching.IndexDataCacheFile = cache.CheckedFile
        try:
            decorate = functools.partial(compiler(cache=True, **options), function)
            if at_once:
                with whole.compiling(cpu_target.target_context, part=False):
                    made = cache.notice.eagerly(decorate)
            else:
                made = decorate()
        finally:
            caching.CacheImpl._locator_classes, caching.IndexDataCacheFile = before
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


#: What the names of Chipmunk's functions begin with, as kernels call them, and their signatures.
PREFIX = "rigidarea_"
externals: dict[str, Any] = {}

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
    made = numba.njit(
        _nrt=False, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True, **options
    )(function)
    made.__class__ = _Part
    return made


def vectorized(signatures: Any, **options: Any) -> Any:
    """Decorator: compiled for ``signatures`` with loops vectorized, which kernels otherwise are not (``whole``)."""
    return cached(functools.partial(numba.njit, signatures, error_model="numpy", _nrt=False, **options))


def callback(signature: str) -> Any:
    """Decorator for C callbacks made of kernels; `.address` is where C finds them. signature: numba's."""
    compiler = cached(functools.partial(numba.cfunc, signature), at_once=True)
    return functools.partial(compiler, _nrt=False, error_model="numpy")


def external(name: str, signature: str, address: int) -> Any:
    """The C function `name` at an address, to be called by kernels."""
    arguments, result = normalize_signature(signature)
    externals[f"{PREFIX}{name}"] = result(*arguments)
    binding.add_symbol(f"{PREFIX}{name}", address)
    return types.ExternalFunction(f"{PREFIX}{name}", result(*arguments))


copy_memory: Any = types.ExternalFunction("memcpy", types.uintp(types.uintp, types.uintp, types.uintp))
clock_gettime: Any = types.ExternalFunction("clock_gettime", types.int32(types.int32, types.uintp))


def lock_for_fork() -> tuple[Callable[[], Any], Callable[[], Any]]:
    """What to call before a fork, and after it: a child in which a thread that it has not would compile for ever."""
    return global_compiler_lock.acquire, global_compiler_lock.release
