"""Memory without reference counts, as numba compiles it: see `compile.raw_memory`."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core import cgutils
from numba.core import types as numba_types
from numba.core.sigutils import normalize_signature
from numba.extending import intrinsic
from numba.np import arrayobj

types: Any = numba_types  # mypy knows some of it


@intrinsic
def array_at(typingctx: Any, address: Any, shape: Any, dtype: Any) -> Any:
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


def caller(signature: str) -> Any:
    """`kernel.memory.caller`."""
    kinds_given, returned = normalize_signature(signature)

    @intrinsic
    def call(typingctx: Any, address: Any, *arguments: Any) -> Any:
        def codegen(context: Any, builder: Any, typed: Any, args: Any) -> Any:
            kind = ir.FunctionType(
                ir.VoidType() if returned == types.void else context.get_value_type(returned),
                [context.get_value_type(a) for a in kinds_given],
            )
            pointer = builder.inttoptr(args[0], kind.as_pointer())
            values = args[1]
            given = [
                context.cast(builder, builder.extract_value(values, i), source, target)
                for i, (source, target) in enumerate(zip(typed.args[1].types, kinds_given))
            ]
            result = builder.call(pointer, given)
            return context.get_dummy_value() if returned == types.void else result

        kinds = (
            arguments[0].types
            if len(arguments) == 1 and isinstance(arguments[0], types.BaseTuple)
            else arguments
        )
        return returned(types.uintp, types.StarArgTuple.from_types(tuple(kinds))), codegen

    return call


@intrinsic(prefer_literal=True)
def floats(typingctx: Any, n: Any) -> Any:
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
