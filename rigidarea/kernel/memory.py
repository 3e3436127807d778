"""Memory without reference counts: by address (Chipmunk's structs, a space's tables), and a few floats of scratch."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
from llvmlite import ir
from numba import config, types
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np import arrayobj


def record(fields: Any) -> np.dtype:
    """An aligned record type whose fields are attributes, in machine code and in Python.

    Raises ValueError for a field named as something that every record of numpy's has: in Python that would be read.
    """
    taken = [name for name, *_ in fields if hasattr(np.record, name)]
    if taken:
        raise ValueError(f"fields must have names that numpy.record leaves free, got {', '.join(taken)}")
    return np.dtype((np.record, np.dtype(fields, align=True)))


@intrinsic
def _array_at(typingctx: Any, address: Any, shape: Any, dtype: Any) -> Any:
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


def _interpreted_array_at(address: int, shape: tuple[int, ...], dtype: Any) -> np.ndarray:
    size = int(np.prod(shape)) * np.dtype(dtype).itemsize
    memory = (ctypes.c_char * size).from_address(int(address))
    return np.frombuffer(memory, dtype=dtype).reshape(shape)


#: array_at(address, shape, dtype): the memory there as a C-contiguous array that nobody counts or frees.
array_at: Any = _interpreted_array_at if config.DISABLE_JIT else _array_at

_CTYPES = {
    types.uintp: ctypes.c_size_t,
    types.float64: ctypes.c_double,
    types.int32: ctypes.c_int32,
    types.uint32: ctypes.c_uint32,
    types.int64: ctypes.c_int64,
    types.void: None,
}


def prototype(signature: Any) -> Any:
    """The ctypes function type of a numba signature of pointers and scalars."""
    kinds: list[Any] = [_CTYPES[kind] for kind in (signature.return_type, *signature.args)]
    return ctypes.CFUNCTYPE(*kinds)


def caller(signature: Any) -> Any:
    """f(address, *arguments): a call of the C function of that signature at an address."""
    if config.DISABLE_JIT:
        kind = prototype(signature)
        return lambda address, *arguments: kind(int(address))(*arguments)

    @intrinsic
    def call(typingctx: Any, address: Any, *arguments: Any) -> Any:
        def codegen(context: Any, builder: Any, typed: Any, args: Any) -> Any:
            kind = ir.FunctionType(
                ir.VoidType()
                if signature.return_type == types.void
                else context.get_value_type(signature.return_type),
                [context.get_value_type(a) for a in signature.args],
            )
            pointer = builder.inttoptr(args[0], kind.as_pointer())
            values = args[1]
            given = [
                context.cast(builder, builder.extract_value(values, i), source, target)
                for i, (source, target) in enumerate(zip(typed.args[1].types, signature.args))
            ]
            result = builder.call(pointer, given)
            return context.get_dummy_value() if signature.return_type == types.void else result

        kinds = (
            arguments[0].types
            if len(arguments) == 1 and isinstance(arguments[0], types.BaseTuple)
            else arguments
        )
        return signature.return_type(types.uintp, types.StarArgTuple.from_types(tuple(kinds))), codegen

    return call


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
