"""Interrupts wait while numba compiles or loads: whose a module of LLVM is, and a lock, take it two lines to say.

An interrupt between the two (Ctrl-C, an alarm whose handler raises) has the module freed twice, or lost; so has an
end of Python's stack.
"""

from __future__ import annotations

import contextlib
import signal
import sys
import threading
from collections.abc import Iterator
from typing import Any

#: Calls within one another that numba and llvmlite take for a function, those that it calls left out: less than half.
DEEP = 200

_handlers: dict[int, Any] = {}  # the program's own, while they wait
_came: list[int] = []


def _note(number: int, frame: Any) -> None:
    _came.append(number)


@contextlib.contextmanager
def put_off() -> Iterator[None]:
    """Signals of the program's handlers are handled at its end, or where it is entered once more within itself.

    There numba is about to compile what a function calls, and may be left by an exception as by a wrong type.
    RecursionError where that would come to the end of Python's stack.
    """
    if _depth() + DEEP > sys.getrecursionlimit():
        raise RecursionError("machine code cannot be compiled or loaded: too many calls within one another")
    if threading.current_thread() is not threading.main_thread():
        yield  # handlers run in the main thread alone
        return
    if _handlers:
        while _came:
            number = _came.pop(0)
            _handlers[number](number, sys._getframe())
        yield
        return
    with contextlib.ExitStack() as stack:  # what is raised in one of its calls keeps none of the others
        stack.callback(_hand_on)
        for number in sorted(signal.valid_signals()):
            handler = signal.getsignal(number)
            if callable(handler):
                _handlers[number] = handler
                stack.callback(signal.signal, number, handler)
                signal.signal(number, _note)
        stack.callback(_handlers.clear)
        yield


def _depth() -> int:
    frame, n = sys._getframe(), 0
    while frame.f_back is not None:
        frame, n = frame.f_back, n + 1
    return n


def _hand_on() -> None:
    """What came meanwhile comes now."""
    with contextlib.ExitStack() as stack:
        for number in set(_came):
            stack.callback(signal.raise_signal, number)
        _came.clear()
