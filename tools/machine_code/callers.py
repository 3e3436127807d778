"""Which kernels Python calls, found in the code of the package: nothing is listed by hand.

`ahead` makes ways in for them, and an installed wheel can be asked whether its library has them all.
"""

from __future__ import annotations

import dis
import functools
import importlib.util
import inspect
import pkgutil
from collections.abc import Callable, Iterator
from types import CodeType, FunctionType, ModuleType
from typing import Any

#: Rooms whose functions judge the package, or show it, and need numba where they call kernels of their own.
BESIDE = (
    "study", "programs", "draw", "demos", "compile", "gym", "gallery", "__main__",
    "pygame_util", "pyglet_util", "matplotlib_util",
)  # fmt: skip


def modules() -> list[ModuleType]:
    """All modules of the package whose users' calls are machine code."""
    package = importlib.import_module("rigidarea")
    names = [m.name for m in pkgutil.walk_packages(package.__path__, f"{package.__name__}.")]
    return [importlib.import_module(name) for name in names if name.split(".")[1] not in BESIDE]


def name_of(function: Any) -> str:
    """Of a kernel or a callback: its module, and its name in it."""
    python = getattr(function, "py_func", None) or getattr(function, "__wrapped__", function)
    return f"{python.__module__}.{python.__qualname__}"


def called_from_python(is_kernel: Callable[[Any], bool], among: list[ModuleType]) -> dict[str, Any]:
    """The kernels that functions of modules name which are none, by their names."""
    found = {}
    for module in among:
        for thing in list(vars(module).values()):
            if getattr(thing, "__module__", None) != module.__name__ or is_kernel(thing):
                continue
            for code in _codes(thing):
                for kernel in filter(is_kernel, _named(code, vars(module), {})):
                    found[name_of(kernel)] = kernel
    return found


def _codes(thing: Any) -> Iterator[CodeType]:
    """The code of a function, or of a class's functions."""
    if isinstance(thing, FunctionType):
        yield inspect.unwrap(thing).__code__
    elif isinstance(thing, (staticmethod, classmethod)):
        yield from _codes(thing.__func__)
    elif isinstance(thing, property):
        yield from (code for f in (thing.fget, thing.fset) if f for code in _codes(f))
    elif isinstance(getattr(thing, "func", None), FunctionType):  # a cached property
        yield from _codes(thing.func)
    elif isinstance(thing, functools._lru_cache_wrapper):
        yield from _codes(thing.__wrapped__)
    elif inspect.isclass(thing):
        yield from (code for member in vars(thing).values() for code in _codes(member))


def _named(code: CodeType, own: dict[str, Any], local: dict[str, Any]) -> Iterator[Any]:
    """What code and the code within names of its module's globals, of modules that are among them, and of what it
    imports itself (`local`, by name)."""
    there: Any = None
    imported: Any = None
    constants: list[Any] = [0, None]  # an import's level, and its names
    for step in dis.get_instructions(code):
        name, before = step.argval, there
        there = None
        if step.opname in ("LOAD_GLOBAL", "LOAD_NAME"):
            there = own.get(name)
        elif step.opname in ("LOAD_ATTR", "LOAD_METHOD"):
            there = vars(before).get(name) if isinstance(before, ModuleType) else None
        elif step.opname in ("LOAD_CONST", "LOAD_SMALL_INT"):
            constants = [constants[-1], name]
        elif step.opname == "IMPORT_NAME":
            there = imported = _imported("." * constants[0] + name, own["__package__"])
        elif step.opname == "IMPORT_FROM":
            there = vars(imported).get(name) if imported else None
        elif step.opname.startswith(("LOAD_", "STORE_")) and "_GLOBAL" not in step.opname:
            first, *last = name if isinstance(name, tuple) else (name,)  # two in one, from Python 3.13 on
            if step.opname.startswith("STORE_"):
                local[first] = before
            there = local.get(last[0] if last else first)
        yield there
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _named(constant, own, dict(local))


def _imported(name: str, package: str) -> ModuleType | None:
    """A module of ours; None: of others."""
    name = importlib.util.resolve_name(name, package)
    return importlib.import_module(name) if name.split(".")[0] == package.split(".")[0] else None
