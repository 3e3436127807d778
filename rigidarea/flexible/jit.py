"""Kernels that only kernels call: without the entry points from Python and C, which cost more to compile than they do."""

from __future__ import annotations

import functools
from typing import Any

from rigidarea.kernel.jit import kernel

#: ``kernel`` for functions that Python never calls.
inner: Any = functools.partial(kernel, no_cpython_wrapper=True, no_cfunc_wrapper=True)
