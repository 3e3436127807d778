"""How kernels are compiled: cached on disk, and without reference counts.

Kernels only look at arrays that somebody else keeps alive; counting references to them costs more than clipping two
boxes does. The price: a kernel cannot allocate, which it must not do anyway.
"""

from __future__ import annotations

import functools
from typing import Any

import numba

#: Decorator for kernels: `@kernel`, `@kernel(inline="always")`.
kernel: Any = functools.partial(numba.njit, cache=True, _nrt=False)
