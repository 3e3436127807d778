"""Machine code ahead of time: what Python or Chipmunk calls, as functions of C, in one library.

Nothing is listed. Callbacks are all that are decorated so. What Python calls is found by looking at the code of all
functions of the package that are no kernels (`called_from_python`), and with which types by calling it: `rehearsal`
does with the package what its users do, and every call is noted.

numba has by then made LLVM's code of each together with all that it calls (`whole`); here it gets a way in that knows
neither Python nor numba, and is turned into machine code for the instruction sets of `LEVELS`. The way in of a
callback is the callback. That of the others takes two addresses: of its arguments, one number of 64 bits after the
other (an array is its address and its shape, and its strides if it may have any; a tuple is what is in it), and of what
it returns, likewise. It returns 0, or what numba's calling convention has for an exception, whose address is then
returned.
`rigidarea.compile.library` is the other side of it.
"""

from __future__ import annotations

import copy
import importlib.util
import inspect
import json
import platform
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from llvmlite import binding, ir
from numba.core import cgutils
from numba.core import types as numba_types
from numba.core.ccallback import CFunc
from numba.core.registry import cpu_target
from numba.np import arrayobj
from numba.np.numpy_support import as_dtype

from rigidarea.compile import compiled, whole
from rigidarea.compile.chosen import FILES

from .callers import called_from_python, modules, name_of

#: Instruction sets by processor: the first is what every one has that is worth while, `runtime.c` says which is best.
LEVELS = {"x86_64": ("x86-64-v2", "x86-64-v3")}

types: Any = numba_types  # mypy knows some of it
_WORD = ir.IntType(64)


# What is called
# ----------------------------------------------------------------------------------------------------------


def is_kernel(thing: Any) -> bool:
    """Whether it is one that numba compiles."""
    return isinstance(thing, compiled.Whole)


def callbacks() -> list[Any]:
    """All of the package."""
    found = {id(c): c for module in modules() for c in vars(module).values() if isinstance(c, CFunc)}
    return list(found.values())


class Calls:
    """Notes, while it is entered, what Python calls with which types."""

    def __init__(self) -> None:
        #: By name: types -> (the compiled function, which is numba's CompileResult; the types one by one).
        self.noted: dict[str, dict[Any, tuple[Any, tuple[Any, ...]]]] = {}

    def __enter__(self) -> Calls:
        calls, plain = self, compiled.Whole.__bases__[0].__call__

        def note(dispatcher: Any, *arguments: Any, **named: Any) -> Any:
            out = plain(dispatcher, *arguments, **named)
            python = dispatcher.py_func
            takes = inspect.signature(python)
            kinds = tuple(dispatcher.typeof_pyval(v) for v in takes.bind(*arguments, **named).args)
            spread = any(p.kind is p.VAR_POSITIONAL for p in takes.parameters.values())
            if python.__qualname__.endswith("way_in"):  # of a kernel that kernels call
                python = python.__closure__[0].cell_contents
            for compiled_for, result in dispatcher.overloads.items():
                flat = (*compiled_for[:-1], *compiled_for[-1].types) if spread else compiled_for
                if flat == kinds:
                    calls.noted.setdefault(name_of(python), {})[compiled_for] = result, flat
                    return out
            raise RuntimeError(f"expected {name_of(python)} to be compiled for {kinds}, it is not")

        compiled.Whole.__call__ = note  # type: ignore[method-assign]
        return self

    def __exit__(self, *exception: Any) -> None:
        del compiled.Whole.__call__


# A way in
# ----------------------------------------------------------------------------------------------------------


def describe(kind: Any) -> Any:
    """A type of numba's as `library` knows it."""
    if isinstance(kind, types.Boolean):
        return "?"
    if isinstance(kind, types.Integer):
        return "q" if kind.signed else "Q"
    if kind == types.float64:
        return "d"
    if isinstance(kind, types.NoneType):
        return None
    if isinstance(kind, types.Array) and kind.layout in "CA":
        return {
            "array": as_dtype(kind.dtype).str,
            "ndim": kind.ndim,
            "strides": kind.layout == "A",
            "written": kind.mutable,
        }
    if isinstance(kind, types.Record):
        return {"record": as_dtype(kind).itemsize}
    if isinstance(kind, types.BaseNamedTuple):
        made = kind.instance_class
        return {"named": f"{made.__module__}:{made.__qualname__}", "of": [describe(k) for k in kind.types]}
    if isinstance(kind, types.BaseTuple):
        return {"of": [describe(k) for k in kind.types]}
    raise TypeError(f"a library has no functions of {kind}")


class _In:
    """Arguments read from words."""

    def __init__(self, context: Any, builder: Any, words: Any) -> None:
        self._context, self._builder, self._words, self._at = context, builder, words, 0

    def _word(self) -> Any:
        place = self._builder.gep(self._words, [ir.Constant(ir.IntType(32), self._at)])
        self._at += 1
        return self._builder.load(place)

    def value(self, kind: Any) -> Any:
        """The next argument."""
        context, builder = self._context, self._builder
        if isinstance(kind, types.Boolean):
            return builder.icmp_unsigned("!=", self._word(), _WORD(0))
        if isinstance(kind, types.Integer):
            word = self._word()
            return word if kind.bitwidth == 64 else builder.trunc(word, ir.IntType(kind.bitwidth))
        if kind == types.float64:
            return builder.bitcast(self._word(), ir.DoubleType())
        if isinstance(kind, types.Record):
            return builder.inttoptr(self._word(), context.get_value_type(kind))
        if isinstance(kind, types.BaseTuple):
            return context.make_tuple(builder, kind, [self.value(k) for k in kind.types])
        item = context.get_data_type(kind.dtype)
        size = context.get_constant(types.intp, context.get_abi_sizeof(item))
        data = builder.inttoptr(self._word(), item.as_pointer())
        extents = [self._word() for _ in range(kind.ndim)]
        if kind.layout == "A":
            strides = [self._word() for _ in range(kind.ndim)]
        else:
            strides = [size]
            for extent in reversed(extents[1:]):
                strides.insert(0, builder.mul(strides[0], extent))
        view = context.make_array(kind)(context, builder)
        arrayobj.populate_array(view, data=data, shape=extents, strides=strides, itemsize=size, meminfo=None)
        return view._getvalue()


def _leaves(context: Any, builder: Any, kind: Any, value: Any) -> list[Any]:
    """What is returned, as words. Of an array: who counts it, its address, its shape, its strides."""
    if isinstance(kind, types.NoneType):
        return []
    if isinstance(kind, (types.Boolean, types.Integer)):
        if value.type.width == 64:
            return [value]
        signed = isinstance(kind, types.Integer) and kind.signed
        return [builder.sext(value, _WORD) if signed else builder.zext(value, _WORD)]
    if kind == types.float64:
        return [builder.bitcast(value, _WORD)]
    if isinstance(kind, types.BaseTuple):
        parts = [builder.extract_value(value, i) for i in range(len(kind.types))]
        return [
            w for k, part in zip(kind.types, parts, strict=True) for w in _leaves(context, builder, k, part)
        ]
    array = context.make_array(kind)(context, builder, value)
    ends = [builder.ptrtoint(array.meminfo, _WORD), builder.ptrtoint(array.data, _WORD)]
    return [*ends, *cgutils.unpack_tuple(builder, array.shape), *cgutils.unpack_tuple(builder, array.strides)]


def _way_in(context: Any, symbol: str, native: str, result: Any, kinds: Any, c: bool) -> str:
    """LLVM's text of the way in to a function of numba's of that name; c: with its own arguments, as C has them."""
    module = context.create_module(symbol)
    inner = ir.Function(module, context.call_conv.get_function_type(result, kinds), native)
    if c:
        own = ir.VoidType() if result == types.none else context.get_value_type(result)
        outer = ir.Function(module, ir.FunctionType(own, [context.get_value_type(k) for k in kinds]), symbol)
    else:
        words = _WORD.as_pointer()
        outer = ir.Function(module, ir.FunctionType(ir.IntType(32), [words, words]), symbol)
    builder = ir.IRBuilder(outer.append_basic_block())
    if c:
        given = list(outer.args)
    else:
        reader = _In(context, builder, outer.args[0])
        given = [reader.value(kind) for kind in kinds]
    status, value = context.call_conv.call_function(builder, inner, result, kinds, given)
    if c:  # kernels raise nothing
        builder.ret_void() if result == types.none else builder.ret(value)
        return str(module)

    def put(at: int, word: Any) -> None:
        builder.store(word, builder.gep(outer.args[1], [ir.Constant(ir.IntType(32), at)]))

    with builder.if_else(status.is_error) as (failed, done):
        with failed:
            put(0, builder.ptrtoint(status.excinfoptr, _WORD))
        with done:
            for at, word in enumerate(_leaves(context, builder, result, value)):
                put(at, word)
    builder.ret(builder.select(status.is_error, status.code, ir.Constant(status.code.type, 0)))
    return str(module)


# The library
# ----------------------------------------------------------------------------------------------------------


class Unit:
    """One function of the library."""

    def __init__(
        self, name: str, number: int, code: bytes, native: str, result: Any, kinds: Any, flat: Any
    ) -> None:
        """kinds: the types of its arguments; flat: of each of them, where some are one tuple; None: it is C's."""
        self.symbol = f"{name.replace('.', '_').lstrip('_')}_{number}"
        self._code, self._native, self._result = code, native, result
        self._kinds, self._flat = tuple(kinds), flat

    def described(self) -> dict[str, Any]:
        """What `library` is told."""
        return {
            "symbol": self.symbol,
            "takes": [describe(kind) for kind in self._flat],
            "returns": describe(self._result),
        }

    def object_code(self, level: int, codegen: Any) -> bytes:
        """Its machine code, for an instruction set of a number."""
        symbol = f"{self.symbol}_{level}"
        context = cpu_target.target_context
        module = binding.parse_bitcode(self._code)
        text = _way_in(context, symbol, self._native, self._result, self._kinds, self._flat is None)
        module.link_in(binding.parse_assembly(text))
        for function in module.functions:
            if not function.is_declaration and function.name != symbol:
                function.linkage = "internal"
            elif function.name == symbol and sys.platform == "win32":
                function.storage_class = "dllexport"
        for variable in module.global_variables:
            if not variable.is_declaration:
                variable.linkage = "internal"
        for options in ({"opt": codegen._opt_level, "cost": "cheap"}, {}):  # as numba's own
            passes, builder = codegen._module_pass_manager(**options)
            passes.run(module, builder)
        return codegen._tm.emit_object(module)  # type: ignore[no-any-return]


def units(
    calls: Calls, callbacks: list[Any], kept: dict[str, bytes]
) -> tuple[dict[str, Unit], dict[str, list[Unit]]]:
    """(callbacks, functions) by name."""
    back = {}
    for function in callbacks:
        native = function.native_name.removeprefix("cfunc.")
        back[name_of(function)] = Unit(
            name_of(function), 0, kept[native], native, function._sig.return_type, function._sig.args, None
        )
    called: dict[str, list[Unit]] = {}
    for name, noted in sorted(calls.noted.items()):
        for kinds, (result, flat) in noted.items():
            native, number = result.fndesc.llvm_func_name, len(called.get(name, ()))
            unit = Unit(name, number, kept[native], native, result.signature.return_type, kinds, flat)
            called.setdefault(name, []).append(unit)
    return back, called


def _codegen(cpu: str) -> Any:
    """`whole`'s code generator, for another processor than this one, and for a library."""
    made = copy.copy(cpu_target.target_context._internal_codegen)
    made.__class__ = whole.Codegen
    made._tm = binding.Target.from_default_triple().create_target_machine(
        cpu=cpu, features="", opt=3, reloc="pic", codemodel="default"
    )
    return made


def _trampolines(codegen: Any) -> bytes:
    """Chipmunk's functions, whose addresses are in a table that `library` fills."""
    context = cpu_target.target_context
    module = ir.Module("externals")
    module.triple = binding.get_process_triple()
    pointer = ir.IntType(8).as_pointer()
    table = ir.GlobalVariable(module, ir.ArrayType(pointer, len(compiled.externals)), "rigidarea_externals")
    table.initializer = ir.Constant(table.value_type, None)
    for i, (name, signature) in enumerate(compiled.externals.items()):
        result = (
            ir.VoidType()
            if signature.return_type == types.none
            else context.get_value_type(signature.return_type)
        )
        kind = ir.FunctionType(result, [context.get_value_type(k) for k in signature.args])
        function = ir.Function(module, kind, name)
        builder = ir.IRBuilder(function.append_basic_block())
        place = builder.gep(table, [ir.Constant(ir.IntType(32), 0), ir.Constant(ir.IntType(32), i)])
        target = builder.bitcast(builder.load(place), kind.as_pointer())
        value = builder.call(target, function.args, tail=True)
        builder.ret_void() if result == ir.VoidType() else builder.ret(value)
    made = binding.parse_assembly(str(module))
    if sys.platform == "win32":
        made.get_global_variable(table.name).storage_class = "dllexport"
    for function in made.functions:
        function.visibility = "hidden"
    return codegen._tm.emit_object(made)  # type: ignore[no-any-return]


def make(folder: Path, rehearse: Callable[[], None]) -> tuple[Path, Path]:
    """The library of all that `rehearse` has Python call, and of all callbacks, and the list of what is in it.

    Raises RuntimeError where `whole` has kept nothing, and for kernels that functions of the package call, and
    `rehearse` does not.
    """
    if whole.kept is None:
        raise RuntimeError(
            "expected RIGIDAREA_AHEAD in the environment when the package is imported, it was not"
        )
    calls = Calls()
    with calls:
        rehearse()
    missed = sorted(set(called_from_python(is_kernel, modules())) - set(calls.noted))
    if missed:
        raise RuntimeError(
            f"expected tools/machine_code/rehearsal.py to call {', '.join(missed)}, it does not"
        )
    back, called = units(calls, callbacks(), whole.kept)
    folder.mkdir(parents=True, exist_ok=True)
    write(folder, back, called)
    return folder / FILES[0].name, folder / FILES[1].name


def write(folder: Path, back: dict[str, Unit], called: dict[str, list[Unit]]) -> None:
    """The machine code of functions, for each instruction set, as one library."""
    every = [*back.values(), *(unit for one in called.values() for unit in one)]
    levels = LEVELS.get(platform.machine().lower().replace("amd64", "x86_64"), ("",))
    library, manifest = folder / FILES[0].name, folder / FILES[1].name
    with tempfile.TemporaryDirectory() as scratch:
        objects = []
        for level, cpu in enumerate(levels):
            codegen = _codegen(cpu)
            for unit in every:
                objects.append(Path(scratch) / f"{unit.symbol}_{level}.o")
                objects[-1].write_bytes(unit.object_code(level, codegen))
        objects.append(Path(scratch) / "externals.o")
        objects[-1].write_bytes(_trampolines(_codegen(levels[0])))
        linker, tag = _linker()
        command = ["-shared", "-O2", "-s", "-fvisibility=hidden", "-o", str(library)]
        command += [str(Path(__file__).with_name("runtime.c")), *map(str, objects)]
        if sys.platform == "linux":
            command += ["-fPIC", "-Wl,-z,defs", "-Wl,--gc-sections", "-lm", "-lc"]
        told = Path(scratch) / "told"  # a command of Windows may not be as long
        told.write_text("\n".join(f'"{word}"' for word in command).replace("\\", "/"))
        command = [*linker, f"@{told}"]
        subprocess.run(command, check=True)
    contents = {
        "library": library.name,
        "platform": tag,
        "levels": levels,
        "externals": [name.removeprefix(compiled.PREFIX) for name in compiled.externals],
        "callbacks": {name: unit.symbol for name, unit in back.items()},
        "functions": {name: [unit.described() for unit in one] for name, one in called.items()},
    }
    manifest.write_text(json.dumps(contents, separators=(",", ":")))


def _linker() -> tuple[list[str], str]:
    """(what compiles `runtime.c` and links, the platform that it links for, as wheels name it).

    zig from PyPI, which knows old C libraries too; else the system's `cc`.
    """
    machine = platform.machine().lower()
    linker = (
        ["cc"] if importlib.util.find_spec("ziglang") is None else [sys.executable, "-m", "ziglang", "cc"]
    )
    if sys.platform == "darwin":
        target = ["-target", f"{machine.replace('arm64', 'aarch64')}-macos.11.0"]
        least = ["-mmacosx-version-min=11.0"]
        return [*linker, *(least if linker == ["cc"] else target)], f"macosx_11_0_{machine}"
    if sys.platform == "linux" and linker != ["cc"]:
        # zig has sines and exponentials of its own: without them they are the system's, as numba's are
        target = ["-target", f"{machine}-linux-gnu.2.17", "-rtlib=none"]
        return [*linker, *target], f"manylinux_2_17_{machine}"
    return linker, sysconfig.get_platform().replace("-", "_").replace(".", "_")
