"""Kernels that only kernels call: without entry points from Python and C, which take long to compile."""

from __future__ import annotations

import functools
from typing import Any

from rigidarea.kernel.jit import kernel

#: ``kernel`` for functions that Python never calls.
inner: Any = functools.partial(kernel, no_cpython_wrapper=True, no_cfunc_wrapper=True)
