"""How much a file may hold, and how it is read so that it cannot hold more."""

from __future__ import annotations

import os
import reprlib
import stat
from pathlib import Path
from typing import Any, NamedTuple

from ..geometry.gate import whole


class Limits(NamedTuple):
    """What is read at most. Each is far above what a scene needs, and far below what a machine bears."""

    bytes: int = 16 * 2**20
    """Size of a file."""
    depth: int = 32
    """Lists and tables within each other."""
    points: int = 1_000_000
    """Points of all outlines together."""
    parts: int = 5_000
    """Bodies, shapes, joints, elements of a drawing: of each."""
    pixels: int = 8 * 2**20
    """Pixels of a picture: a screen of 3840 x 2160."""
    rings: int = 2_500
    """Rings of all outlines together: each is checked by itself."""
    arcs: int = 20_000
    """Points of all outlines with arcs together."""


LIMITS = Limits()
"""Of files from anywhere: the default."""


def read(source: str | os.PathLike[str], limits: Limits) -> bytes:
    """The content of the file at the path `source`, opened without waiting for anybody.

    Raises ValueError for one of more than `limits.bytes`, and for what is no regular file (a pipe may never end);
    OSError for one that cannot be read.
    """
    allowed(limits)
    path = file_of(source)
    _regular(path.stat(), path)  # before it is opened: opening alone sets some devices going
    # a pipe put in its place meanwhile blocks neither
    flags = (
        os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0) | getattr(os, "O_BINARY", 0)
    )
    with open(path, "rb", opener=lambda name, _: os.open(name, flags)) as file:
        state = os.fstat(file.fileno())
        _regular(state, path)
        data = file.read(limits.bytes + 1) if state.st_size <= limits.bytes else b""
    size = max(len(data), state.st_size)
    if size > limits.bytes:
        raise ValueError(f"{path}: expected at most {limits.bytes} bytes, got {size}")
    return data


def _regular(state: os.stat_result, path: Path) -> None:
    if not stat.S_ISREG(state.st_mode):
        raise ValueError(f"expected a regular file, got {str(path)!r}")


def file_of(source: object) -> Path:
    """A path; ValueError for what is none."""
    if not isinstance(source, str | os.PathLike):
        raise ValueError(f"expected the path of a file, got {source!r:.80}")
    try:
        path = Path(source)
        os.fsencode(path)
    except (TypeError, UnicodeEncodeError):  # bytes; half a character
        raise ValueError(f"expected the path of a file as text, got {source!r:.80}") from None
    if not path.name or "\0" in str(path):
        raise ValueError(f"expected the path of a file, got {source!r:.80}")
    return path


def allowed(limits: Limits) -> Limits:
    """The limits; ValueError for what are none, or no whole numbers of at least 0."""
    if not isinstance(limits, Limits):
        raise ValueError(f"limits must be bring.Limits, got {type(limits).__name__}")
    for name, value in limits._asdict().items():
        whole(value, f"limits.{name}", 0)
    return limits


def text(data: bytes, what: str) -> str:
    """The bytes as UTF-8, a byte order mark at the start dropped. ValueError, naming `what`, for anything else."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ValueError(
            f"{what}: expected UTF-8 text, got byte {data[error.start]:#x} at {error.start}"
        ) from None


def check(count: int, most: int, what: str) -> None:
    """ValueError if `count` is more than `most`; what: what is counted, for the message."""
    if count > most:
        raise ValueError(f"expected at most {most} {what}, got {count}")


class _Short(reprlib.Repr):
    """`repr`, however large the value: of lists the first items, of whole numbers beyond any use their size."""

    def repr_int(self, x: int, level: int) -> str:
        return repr(x) if x.bit_length() <= 256 else f"a whole number of {x.bit_length()} bits"


_SHORT = _Short()
_SHORT.maxlist = _SHORT.maxdict = 4
_SHORT.maxlevel = 3
_SHORT.maxstring = _SHORT.maxother = 80


def shown(value: Any, most: int = 40) -> str:
    """The start of a value as Python writes it, for messages: at most `most` characters, found in bounded time."""
    return _SHORT.repr(value)[:most]
