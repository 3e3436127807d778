"""A command that is busy shows it: a dot on standard error for every moment in which it has said nothing."""

from __future__ import annotations

import contextlib
import os
import sys
import threading
import time
from collections.abc import Iterator
from typing import Any

#: How long a command may say nothing (s).
SILENCE = 1.5


@contextlib.contextmanager
def alive(silence: float = SILENCE, since: float = 0.0) -> Iterator[None]:
    """Within, dots are put on standard error as often as nothing has been said for `silence` seconds.

    since: for how long nothing has been said already (s).
    What is written by way of `sys.stdout` and `sys.stderr` counts; what comes after dots begins a line of its own.
    """
    before = sys.stdout, sys.stderr
    if before[1] is None:  # nobody can be told
        yield
        return
    hush = _Hush(before[1], silence, since)
    sys.stdout, sys.stderr = (stream and _Heard(stream, hush) for stream in before)  # type: ignore[assignment]
    teller = threading.Thread(target=hush.watch, daemon=True)
    teller.start()
    process = os.getpid()
    try:
        yield
    finally:
        sys.stdout, sys.stderr = before
        if os.getpid() == process:  # a fork has no thread, and may have a lock that the thread held
            hush.over.set()
            teller.join()
            hush.heard("")


class _Hush:
    """When something was last said, and the dots since."""

    def __init__(self, stream: Any, silence: float, since: float) -> None:
        self.over = threading.Event()
        self._stream, self._silence = stream, silence
        self._last = time.monotonic() - since
        self._line_open = self._own_line = False
        self._lock = threading.Lock()

    def watch(self) -> None:
        """Until it is over."""
        while not self.over.wait(min(0.2, self._silence / 8)):
            with self._lock:
                if time.monotonic() - self._last >= self._silence:
                    self._own_line = self._own_line or not self._line_open
                    self._put(".")
                    self._last = time.monotonic()

    def heard(self, text: str) -> None:
        """That is about to be said."""
        with self._lock:
            self._last = time.monotonic()
            if self._own_line:
                self._put("\n")
                self._own_line = False
            if text:
                self._line_open = not text.endswith("\n")

    def _put(self, text: str) -> None:
        with contextlib.suppress(OSError, ValueError):  # closed: nobody reads it
            self._stream.write(text)
            self._stream.flush()


class _Heard:
    """A stream that tells of what it is given."""

    def __init__(self, stream: Any, hush: _Hush) -> None:
        self._stream, self._hush = stream, hush

    def write(self, text: str) -> int:
        self._hush.heard(text)
        written: int = self._stream.write(text)
        return written

    def writelines(self, lines: Any) -> None:
        for line in lines:
            self.write(line)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)
