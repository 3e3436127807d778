"""Kernels that only kernels call are optimized once, with the one that Python or C calls, and not each for itself.

numba makes every function ready to run: optimizes it together with all that it calls, and turns that into machine
code. Of a chain of ten calls the last one is so made ten times. What is compiled `for_others` stays as it was written
until somebody links it in. Where numba's insides are not as expected it is made as numba does it, only later.
"""

from __future__ import annotations

import contextlib
import copy
from collections.abc import Iterator
from typing import Any

from numba.core.codegen import JITCodeLibrary, JITCPUCodegen


class _Part(JITCodeLibrary):  # type: ignore[misc]
    """Code to be linked into other code."""

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        return 0


class _Parts(JITCPUCodegen):  # type: ignore[misc]
    """What makes parts instead of libraries that run."""

    _library_class = _Part

    def set_env(self, env_name: str, env: Any) -> None:
        pass


@contextlib.contextmanager
def compiling(context: Any, parts: bool) -> Iterator[None]:
    """Within, numba's target context compiles parts, or what runs."""
    before = context._internal_codegen
    runs = getattr(before, "runs", before)
    if parts:
        context._internal_codegen = copy.copy(runs)
        context._internal_codegen.__class__ = _Parts
        context._internal_codegen.runs = runs
    else:
        context._internal_codegen = runs
    try:
        yield
    finally:
        context._internal_codegen = before
