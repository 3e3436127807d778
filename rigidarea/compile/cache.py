"""Machine code on disk: files that know when they are damaged, a folder that is ours, a word while it compiles."""

from __future__ import annotations

import atexit
import hashlib
import os
import pickle
import stat
import sys
import tempfile
import threading
import time
from typing import Any

import numba
from numba.core import event
from numba.core.caching import IndexDataCacheFile

FORMAT = b"1"
"""What the files below look like: another number, another folder."""

USUALLY = "ten minutes" if os.environ.get("RIGIDAREA_AHEAD") else "two to four minutes"
"""What all of it takes: 3 minutes of one core (`bench start`); a library for a wheel compiles more."""

_DIGEST = hashlib.sha256().digest_size


class CheckedFile(IndexDataCacheFile):
    """numba's index and data files with a checksum before their content.

    A damaged one (empty, cut short, overwritten) counts as missing: it is compiled and written again. Without the
    checksum an index stops every start with an unpickling error, and a data file may run as machine code.
    """

    def _dump(self, obj: Any) -> bytes:
        data: bytes = super()._dump(obj)
        return hashlib.sha256(data).digest() + data

    def _load_index(self) -> dict[Any, str]:
        content = self._content(self._index_path)
        if content is None:
            return {}
        stamp, overloads = content
        return overloads if stamp == self._source_stamp else {}

    def _save_index(self, overloads: dict[Any, str]) -> None:
        with self._open_for_write(self._index_path) as file:
            file.write(self._dump((self._source_stamp, overloads)))

    def _load_data(self, name: str) -> Any:
        content = self._content(self._data_path(name))
        if content is None:
            raise FileNotFoundError(name)  # what numba takes for: compile it
        return content

    def _content(self, path: str) -> Any:
        """What a file holds; None if it is not there, cannot be read, or is damaged."""
        try:
            with open(path, "rb") as file:
                data = file.read()
        except OSError:
            return None
        if len(data) <= _DIGEST or hashlib.sha256(data[_DIGEST:]).digest() != data[:_DIGEST]:
            notice.say_damaged(path)
            return None
        return pickle.loads(data[_DIGEST:])

    def load(self, key: Any) -> Any:
        """The entry, or None, after which it is compiled."""
        found = super().load(key)
        if found is None:
            notice.missed()
        return found

    def save(self, key: Any, data: Any) -> None:
        """Keep an entry; where that cannot be done (a full disk), go on without."""
        try:
            super().save(key, data)
        except OSError as error:
            notice.say_once(f"compiled code cannot be kept: {error}", "not kept")


class Notice(event.Listener):
    """Says on standard error that something compiles, once, and that it is still at it, once a second."""

    def __init__(self) -> None:
        self.folder = ""
        self._lock = threading.Lock()
        self._depth = 0
        self._eager = 0
        self._ticking = False
        self._since = 0.0
        self._said: set[str] = set()

    # --- what compiles ---

    def on_start(self, happened: Any) -> None:
        """A dispatcher of this package begins to compile (numba's event)."""
        if _ours(happened):
            self.begin()

    def on_end(self, happened: Any) -> None:
        """It has, or it failed."""
        if _ours(happened):
            self.end()

    def eagerly(self, compile: Any) -> Any:
        """compile(), which is known to compile at once if it is not on disk (C callbacks send no event)."""
        depth = self._depth
        self._eager += 1
        try:
            return compile()
        finally:
            self._eager -= 1
            while self._depth > depth:
                self.end()

    def missed(self) -> None:
        """Something was not on disk."""
        if self._eager:
            self.begin()

    def begin(self) -> None:
        """One more thing compiles."""
        with self._lock:
            self._depth += 1
            if self._ticking:
                return
            self._ticking = True
            self._since = time.monotonic()
        again = "compiling" in self._said
        self._said.add("compiling")
        words = "compiling more" if again else f"compiling once (all of it: {USUALLY}), kept in {self.folder}"
        _write(f"rigidarea: {words} ")
        threading.Thread(target=self._tick, daemon=True).start()

    def end(self) -> None:
        """One thing less compiles."""
        with self._lock:
            self._depth = max(self._depth - 1, 0)

    def _tick(self) -> None:
        idle = seconds = 0
        while idle < 2:  # between two functions nothing compiles for a moment
            time.sleep(1.0)
            seconds += 1
            idle = 0 if self._depth else idle + 1
            if seconds % 10 == 0:
                _write(f" {seconds} s ")
            elif self._depth:
                _write(".")
        self.close()

    def close(self) -> None:
        """End the line, if one is open."""
        with self._lock:
            if not self._ticking:
                return
            self._ticking = False
        _write(f" {time.monotonic() - self._since:.0f} s\n")

    # --- what went wrong ---

    def say_damaged(self, path: str) -> None:
        """A file of the cache is damaged: one line a process, however many are."""
        self.say_once(f"compiled code in {os.path.dirname(path)} is damaged; compiling it again", "damaged")

    def say_once(self, text: str, about: str | None = None) -> None:
        """One line, the first time."""
        if (about or text) not in self._said:
            self._said.add(about or text)
            _write(f"rigidarea: {text}\n")


def _ours(happened: Any) -> bool:
    dispatcher = (happened.data or {}).get("dispatcher")
    module: str = getattr(getattr(dispatcher, "py_func", None), "__module__", "")
    return module.split(".")[0] == __name__.split(".")[0]


def _write(text: str) -> None:
    if sys.stderr is not None:
        try:
            sys.stderr.write(text)
            sys.stderr.flush()
        except (OSError, ValueError):
            pass  # closed: nobody reads it


notice = Notice()
event.register("numba:compile", notice)
atexit.register(notice.close)


def folder(name: str) -> str:
    """A folder of that name that can be written to, made if need be.

    Under NUMBA_CACHE_DIR, XDG_CACHE_HOME, or where the platform keeps caches; else in the temporary directory, where a
    folder that somebody else could have filled is never used, since loading runs what is in it: a private one is made
    instead, which is gone for the next process.
    """
    homes = [
        numba.config.CACHE_DIR,
        os.environ.get("XDG_CACHE_HOME"),
        os.path.join(os.path.expanduser("~"), "Library/Caches" if sys.platform == "darwin" else ".cache"),
    ]
    if sys.platform == "win32":
        homes[-1] = os.environ.get("LOCALAPPDATA")
    for home in filter(None, homes):
        found = os.path.join(home, "rigidarea", name)
        if _writable(found):
            return found
    user = os.getuid() if hasattr(os, "getuid") else "user"
    shared = os.path.join(tempfile.gettempdir(), f"rigidarea-{user}")
    try:
        os.makedirs(shared, mode=0o700, exist_ok=True)
    except OSError:
        pass
    if is_private(shared):
        found = os.path.join(shared, name)
        if _writable(found):
            return found
    return tempfile.mkdtemp(prefix="rigidarea-")


def is_private(path: str) -> bool:
    """Whether it is a folder (no link), ours, and closed to everybody else (mode 0700)."""
    try:
        state = os.lstat(path)
    except OSError:
        return False
    if not stat.S_ISDIR(state.st_mode):
        return False
    if not hasattr(os, "getuid"):
        return True  # the temporary directory is the user's own there
    return state.st_uid == os.getuid() and stat.S_IMODE(state.st_mode) & 0o077 == 0


def _writable(path: str) -> bool:
    try:
        os.makedirs(path, mode=0o700, exist_ok=True)
    except OSError:
        return False
    return os.access(path, os.W_OK | os.X_OK)
