"""Memory without reference counts: by address (Chipmunk's structs, a space's tables), and a few floats of scratch.

array_at(address, shape, dtype): the memory there as a C-contiguous array that nobody counts or frees.
caller(signature): f(address, *arguments), a call of the C function of that signature at an address.
floats(n): n floats of scratch on the stack (n a literal), valid until the calling kernel returns.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .jit import array_at, caller, floats

__all__ = ["array_at", "caller", "floats", "record"]


def record(fields: Any) -> np.dtype:
    """An aligned record type whose fields are attributes, in machine code and in Python.

    Raises ValueError for a field named as something that every record of numpy's has: in Python that would be read.
    """
    taken = [name for name, *_ in fields if hasattr(np.record, name)]
    if taken:
        raise ValueError(f"fields must have names that numpy.record leaves free, got {', '.join(taken)}")
    return np.dtype((np.record, np.dtype(fields, align=True)))
