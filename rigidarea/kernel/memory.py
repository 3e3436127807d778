"""Memory without reference counts: by address (Chipmunk's structs, a space's tables), and a few floats of scratch."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import config, types
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np import arrayobj


def record(fields: Any) -> np.dtype:
    """An aligned record type whose fields are attributes, in machine code and in Python."""
    return np.dtype((np.record, np.dtype(fields, align=True)))


@intrinsic
def array_at(typingctx: Any, address: Any, shape: Any, dtype: Any) -> Any:
    """array_at(address, shape, dtype): the memory there as a C-contiguous array that nobody counts or frees."""
    array = types.Array(dtype.dtype, len(shape), "C")
    signature = array(types.uintp, types.UniTuple(types.intp, len(shape)), dtype)

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        item = context.get_data_type(array.dtype)
        size = context.get_constant(types.intp, context.get_abi_sizeof(item))
        extents = cgutils.unpack_tuple(builder, args[1])
        strides = [size]
        for extent in reversed(extents[1:]):
            strides.insert(0, builder.mul(strides[0], extent))
        view = context.make_array(array)(context, builder)
        arrayobj.populate_array(
            view,
            data=builder.inttoptr(args[0], item.as_pointer()),
            shape=extents,
            strides=strides,
            itemsize=size,
            meminfo=None,
        )
        return view._getvalue()

    return signature, codegen


@intrinsic(prefer_literal=True)
def _stack_floats(typingctx: Any, n: Any) -> Any:
    array = types.Array(types.float64, 1, "C")

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        item = context.get_data_type(types.float64)
        size = context.get_constant(types.intp, 8)
        view = context.make_array(array)(context, builder)
        arrayobj.populate_array(
            view,
            data=cgutils.alloca_once(builder, item, size=n.literal_value),
            shape=[context.get_constant(types.intp, n.literal_value)],
            strides=[size],
            itemsize=size,
            meminfo=None,
        )
        return view._getvalue()

    return array(n), codegen


#: floats(n): n floats of scratch on the stack (n a literal), valid until the calling kernel returns.
floats: Any = np.empty if config.DISABLE_JIT else _stack_floats
