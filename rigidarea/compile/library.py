"""Machine code from a wheel: loads what `tools/machine_code/ahead.py` has made, and calls it."""

from __future__ import annotations

import ctypes
import functools
import importlib
import inspect
import json
import operator
import pickle
import struct
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

#: Takes the addresses of arguments and results, whose types are not declared: that takes twice as long. The
#: interpreter's lock is kept, as numba does.
_WAY_IN = ctypes.PYFUNCTYPE(ctypes.c_int)


_PLACE = ctypes.c_void_p.from_address


def _where(array: np.ndarray) -> int | None:
    """The address of an array's items: what numpy's arrays begin with, after what all objects begin with (its ABI)."""
    return _PLACE(id(array) + object.__basicsize__).value


#: Asking numpy takes 25 times as long, and as long as clipping two boxes.
_address: Callable[[np.ndarray], int | None] = _where
if _where(_PROBE := np.zeros(1)) != _PROBE.ctypes.data:
    _address = lambda array: array.ctypes.data  # noqa: E731


class _Other(Exception):
    """The arguments are not those of this function of the library."""


def _taker(kind: Any) -> tuple[str, Callable[[Any, list[Any]], None]]:
    """(format of its words, what adds them to a list) of an argument as `ahead.describe` has it."""
    if kind == "d":

        def put(value: Any, words: list[Any]) -> None:
            if not isinstance(value, (float, int, np.floating, np.integer)):
                raise _Other
            words.append(value)

        return "d", put
    if kind == "?":

        def put(value: Any, words: list[Any]) -> None:
            if not isinstance(value, (bool, np.bool_)):
                raise _Other
            words.append(value)

        return "q", put
    if isinstance(kind, str):

        def put(value: Any, words: list[Any]) -> None:
            if not isinstance(value, (int, np.integer)):
                raise _Other
            words.append(value)

        return kind, put
    if "record" in kind:
        size = kind["record"]

        def put(value: Any, words: list[Any]) -> None:
            if not isinstance(value, np.void) or value.dtype.itemsize != size:
                raise _Other
            words.append(_address(np.frombuffer(value, np.uint8)))

        return "Q", put
    if "of" in kind:
        inner = [_taker(one) for one in kind["of"]]
        takers = [taker for _, taker in inner]

        def put(value: Any, words: list[Any]) -> None:
            if not isinstance(value, tuple) or len(value) != len(takers):
                raise _Other
            for taker, item in zip(takers, value):
                taker(item, words)

        return "".join(code for code, _ in inner), put
    code, ndim, strides, written = kind["array"], kind["ndim"], kind["strides"], kind["written"]
    seen: list[np.dtype] = [np.dtype(code)]

    def put_array(value: Any, words: list[Any]) -> None:
        if not isinstance(value, np.ndarray) or value.ndim != ndim:
            raise _Other
        dtype, flags = value.dtype, value.flags
        if dtype is not seen[0]:
            if dtype.str != code:
                raise _Other
            seen[0] = dtype
        if not (strides or flags.c_contiguous) or (written and not flags.writeable):
            raise _Other
        words.append(_address(value))
        words.extend(value.shape)
        if strides:
            words.extend(value.strides)

    return "Q" + (2 if strides else 1) * ndim * "q", put_array


def _giver(kind: Any, release: Callable[[int], None]) -> tuple[str, Callable[[Any], Any]]:
    """(format of its words, what makes a value of an iterator over them) of a result."""
    if kind is None:
        return "", lambda words: None
    if kind == "?":
        return "q", lambda words: bool(next(words))
    if isinstance(kind, str):
        return kind, next
    if "of" in kind:
        inner = [_giver(one, release) for one in kind["of"]]
        givers = [giver for _, giver in inner]
        made: Any = tuple
        if "named" in kind:
            module, _, name = kind["named"].partition(":")

            def made(values: Any) -> Any:
                return getattr(importlib.import_module(module), name)(*values)

        return "".join(code for code, _ in inner), lambda words: made([giver(words) for giver in givers])
    ndim, dtype = kind["ndim"], np.dtype(kind["array"])

    def array(words: Any) -> np.ndarray:
        owner, address = next(words), next(words)
        shape = [next(words) for _ in range(ndim)]
        strides = [next(words) for _ in range(ndim)]
        size = dtype.itemsize + sum((n - 1) * s for n, s in zip(shape, strides, strict=True))
        if 0 in shape:
            out = np.empty(shape, dtype)
        else:
            memory = (ctypes.c_char * size).from_address(address)
            out = np.ndarray(shape, dtype, memory, strides=strides).copy()
        if owner:
            release(owner)
        return out

    return "QQ" + 2 * ndim * "q", array


def _overload(library: Library, described: dict[str, Any]) -> Callable[..., Any]:
    """One function of the library, for arguments of certain types; it raises _Other for others.

    What clips two boxes takes less than a microsecond, as does a call here: `struct` looks at numbers itself, and what
    a call needs is at hand.
    """
    takes, returns = described["takes"], described["returns"]
    takers = [_taker(kind) for kind in takes]
    pack = struct.Struct("=" + "".join(code for code, _ in takers)).pack
    puts = [put for _, put in takers]
    code, give_of = _giver(returns, library.release)
    out_of = struct.Struct("=" + code)
    unpack, room = out_of.unpack_from, ctypes.c_char * max(out_of.size, 8)
    way_in = _WAY_IN(library.address(described["symbol"]))

    def words_of(arguments: tuple[Any, ...]) -> Any:
        if len(arguments) != len(puts):
            raise _Other
        words: list[Any] = []
        for put, value in zip(puts, arguments):
            put(value, words)
        return words

    give: Callable[[tuple[Any, ...]], Any] = lambda words: give_of(iter(words))  # noqa: E731
    if _numbers(returns):
        give = operator.itemgetter(0)
    elif returns and set(returns) == {"of"} and all(map(_numbers, returns["of"])):
        give = tuple
    plain = all(map(_numbers, takes))

    def call(*arguments: Any) -> Any:
        try:
            words = pack(*(arguments if plain else words_of(arguments)))
        except struct.error:  # no numbers, or too large
            raise _Other from None
        out = room()
        status = way_in(words, out)
        if status != 0:
            raise _raised(status, out)
        return give(unpack(out))

    return call


def _numbers(kind: Any) -> bool:
    return kind in ("d", "q", "Q")


def _raised(status: int, out: Any) -> BaseException:
    """What a function has raised: numba keeps the class and its arguments, pickled, in the machine code."""
    if status > 0:
        where = struct.unpack_from("=Q", out)[0]
        at = ctypes.c_void_p.from_address(where).value
        size = ctypes.c_int32.from_address(where + 8).value
        kind, arguments, *_ = pickle.loads(ctypes.string_at(at, size))  # type: ignore[arg-type]
        if kind is not None:
            made: BaseException = kind(*(arguments or ()))
            return made
    return MemoryError("a function of the library of machine code has failed")


class Function:
    """A kernel that Python calls, in machine code."""

    def __init__(self, library: Library, function: Any, described: list[dict[str, Any]]) -> None:
        functools.update_wrapper(self, function)
        self.py_func = function
        self._library = library
        self._described = described

    @functools.cached_property
    def _overloads(self) -> list[Callable[..., Any]]:
        return [_overload(self._library, one) for one in self._described]

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        if named:
            arguments = self._in_order(arguments, named)
        for overload in self._overloads:
            try:
                return overload(*arguments)
            except _Other:
                pass
        expected = " or ".join(json.dumps(one["takes"]) for one in self._described)
        given = ", ".join(_said(value) for value in arguments)
        raise TypeError(
            f"{self.py_func.__qualname__} of the library of machine code takes {expected}, got {given}"
        )

    def _in_order(self, arguments: tuple[Any, ...], named: dict[str, Any]) -> tuple[Any, ...]:
        return inspect.signature(self.py_func).bind(*arguments, **named).args


def _said(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f"{value.dtype.str}{list(value.shape)}"
    return f"({', '.join(map(_said, value))})" if isinstance(value, tuple) else type(value).__name__


class Text:
    """A kernel that only kernels call, which have it in their machine code: called from Python it is interpreted."""

    _within = False

    def __init__(self, function: Any) -> None:
        functools.update_wrapper(self, function)
        self.py_func = function

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        if Text._within:  # what is interpreted calls the text of others
            return self.py_func(*arguments, **named)
        warnings.warn(
            f"{self.py_func.__qualname__} is not in the library of machine code: it is interpreted, which is slow"
            " (RIGIDAREA_BACKEND=compiled has numba compile it)",
            RuntimeWarning,
            stacklevel=2,
        )
        Text._within = True
        try:
            return self.py_func(*arguments, **named)
        finally:
            Text._within = False


class Callback:
    """What C calls, in machine code."""

    def __init__(self, function: Any, address: int) -> None:
        functools.update_wrapper(self, function)
        self.address = address

    def __call__(self, *arguments: Any) -> Any:
        return self.__wrapped__(*arguments)  # type: ignore[attr-defined]


class Library:
    """The library that a wheel has."""

    def __init__(self, library: Path, contents: Path) -> None:
        self._library = ctypes.CDLL(str(library))
        self._contents: dict[str, Any] = json.loads(contents.read_text())
        release = self._library.rigidarea_release
        release.argtypes, release.restype = [ctypes.c_void_p], None
        self.release: Callable[[int], None] = release
        self._level = min(int(self._library.rigidarea_level()), len(self._contents["levels"]) - 1)
        externals: list[str] = self._contents["externals"]
        self._slots = {name: i for i, name in enumerate(externals)}
        self._table = (ctypes.c_void_p * len(externals)).in_dll(self._library, "rigidarea_externals")

    @property
    def level(self) -> str:
        """The instruction set that is used."""
        return str(self._contents["levels"][self._level])

    def address(self, symbol: str) -> int:
        """Where a function is."""
        found = ctypes.cast(getattr(self._library, f"{symbol}_{self._level}"), ctypes.c_void_p).value
        return int(found or 0)

    def bind(self, name: str, address: int) -> None:
        """Where Chipmunk has a function, which machine code calls."""
        if name in self._slots:
            self._table[self._slots[name]] = address

    def function(self, function: Any) -> Any:
        """A kernel: machine code, if the package's Python calls it, else its text, which says so when it runs."""
        described = self._contents["functions"].get(f"{function.__module__}.{function.__qualname__}")
        return Function(self, function, described) if described else Text(function)

    def callback(self, function: Any) -> Callback:
        """A callback, which all are in the library."""
        symbol = self._contents["callbacks"][f"{function.__module__}.{function.__qualname__}"]
        return Callback(function, self.address(symbol))
