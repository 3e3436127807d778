"""A kernel that runs is optimized as a whole, once, together with all that it calls.

numba makes every function ready to run: optimizes it together with what it calls, and turns that into machine code.
Of a chain of ten calls the last one is so made ten times; and each may still be called from elsewhere, so that it
takes all of its arguments, a hundred words for a handful of arrays. Here a kernel that only kernels call stays a
part, as it was written, until one that runs links it in; and that one keeps it to itself.

And an index is what it says: numba asks each whether it is negative and counts from the end, a tenth of what a frame
costs. Kernels count from the beginning, as in C, but for a literal alone (`a[-1]`, not `a[-1, j]`, which a test
looks for; for all others `tests/bounds.py` does).
"""

from __future__ import annotations

import contextlib
import copy
import os
from collections.abc import Iterator
from typing import Any

from llvmlite import binding, ir
from numba.core import config, types
from numba.core.codegen import JITCodeLibrary, JITCPUCodegen
from numba.core.compiler_lock import global_compiler_lock
from numba.np import arrayobj

from .interrupts import put_off

#: Where code that runs is kept as it is before it is optimized (LLVM's bitcode), by the names of its functions:
#: `ahead` makes machine code for others of it. None: nowhere. Callbacks are compiled as the package is imported, so the
#: environment says it.
kept: dict[str, bytes] | None = {} if os.environ.get("RIGIDAREA_AHEAD") else None


class _Part(JITCodeLibrary):  # type: ignore[misc]
    """Code to be linked into other code."""

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        return 0


class _Whole(JITCodeLibrary):  # type: ignore[misc]
    """Code that runs, and what it calls, which nobody else does."""

    def finalize(self) -> None:
        self._own = {f.name for f in self._final_module.functions if not f.is_declaration}
        super().finalize()

    def _optimize_final_module(self) -> None:
        for f in self._final_module.functions:
            if not f.is_declaration and f.name not in self._own:
                f.linkage = "internal"
        if kept is not None:
            kept.update(dict.fromkeys(self._own, self._final_module.as_bitcode()))
        super()._optimize_final_module()


class Codegen(JITCPUCodegen):  # type: ignore[misc]
    """numba's own, with a library class that `compiling` sets.

    Loops are left as they are: they go over a handful of points, and vectorized and unrolled the code is half as long
    again, and cold in every frame of a game.
    """

    def _pass_builder(self, **kwargs: Any) -> Any:
        tuning = binding.create_pipeline_tuning_options(kwargs.get("opt", config.OPT))
        tuning.loop_vectorization = tuning.slp_vectorization = False
        tuning.loop_unrolling = tuning.loop_interleaving = False
        return binding.create_pass_builder(self._tm, tuning)

    def set_env(self, env_name: str, env: Any) -> None:
        if self._library_class is not _Part:
            super().set_env(env_name, env)


_index_of_numba = arrayobj.fix_integer_index


def _index(context: Any, builder: Any, kind: Any, index: Any, size: Any) -> Any:
    """An index as it is, in kernels; a literal, and where numba's own functions may be called, as numba has it."""
    if context.enable_nrt or isinstance(index, ir.Constant):
        return _index_of_numba(context, builder, kind, index, size)
    return context.cast(builder, index, kind, types.intp)


@contextlib.contextmanager
def compiling(context: Any, part: bool) -> Iterator[None]:
    """Within, numba's target context compiles parts, or what runs; interrupts wait (`interrupts`)."""
    with put_off(), global_compiler_lock:
        before = context._internal_codegen, arrayobj.fix_integer_index
        arrayobj.fix_integer_index = _index
        context._internal_codegen = copy.copy(before[0])
        context._internal_codegen.__class__ = Codegen
        context._internal_codegen._library_class = _Part if part else _Whole
        try:
            yield
        finally:
            context._internal_codegen, arrayobj.fix_integer_index = before
