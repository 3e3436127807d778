"""Picture files stripped to what their pixels need: Pillow never sees the rest, nor a picture that is too large.

Only five formats are read, those whose decoders are libraries of their own (a PostScript file, say, would start a
program). Text, thumbnails, profiles and further frames are left out here, where each is one step over a length: readers
join and keep them, and some in the square of their number.
"""

from __future__ import annotations

import struct
from collections.abc import Callable

from .limits import check

FORMATS = ("PNG", "JPEG", "BMP", "GIF", "WEBP")
#: Blocks of a file that are stepped over one by one; GIF's have 255 bytes at the most.
BLOCKS = 100_000
#: Passes over all pixels of a progressive JPEG, which may be of no bytes at all; writers make some ten.
SCANS = 32
#: Pillow unpacks run lengths of BMP in Python.
RUN_BYTES = 2**20

Stripped = tuple[int, int, bytes]


def stripped(data: bytes) -> tuple[str, int, int, bytes]:
    """(format, width, height, the same file with nothing but one picture in it) of a picture file.

    Raises ValueError for another format, and for what has no such parts.
    """
    for name, start, strip in _KINDS:
        if data.startswith(start) and (name != "WEBP" or data[8:12] == b"WEBP"):
            try:
                return name, *strip(data)
            except (struct.error, IndexError):
                raise ValueError(f"expected a whole {name} file, got one that is cut off") from None
    raise ValueError(f"expected one of {', '.join(FORMATS)}, got a file that begins with {data[:8]!r}")


def _png(data: bytes) -> Stripped:
    width, height = struct.unpack_from(">II", data, 16)
    kept, at = [data[:8]], 8
    for _ in range(BLOCKS):
        (length,), kind = struct.unpack_from(">I", data, at), data[at + 4 : at + 8]
        if kind in (b"IHDR", b"PLTE", b"tRNS", b"IDAT", b"IEND"):
            kept.append(data[at : at + 12 + length])
        at += 12 + length
        if kind == b"IEND" or at >= len(data):  # a missing end is Pillow's to judge
            return width, height, b"".join(kept)
    raise ValueError(f"expected at most {BLOCKS} chunks, got more")


def _jpeg(data: bytes) -> Stripped:
    kept, at, size = [data[:2]], 2, (0, 0)
    for _ in range(BLOCKS):
        marker, kind = data[at], data[at + 1]
        if marker != 0xFF:
            raise ValueError(f"expected a marker at byte {at}, got {marker:#x}")
        if kind == 0xFF:  # padding
            at += 1
            continue
        (length,) = struct.unpack_from(">H", data, at + 2)
        if kind == 0xDA:  # pixels begin
            check(data.count(b"\xff\xda", at), SCANS, "scans")
            return *size, b"".join([*kept, data[at:]])
        if kind in (0xC0, 0xC1, 0xC2):
            height, width = struct.unpack_from(">HH", data, at + 5)
            size = (width, height)
        elif 0xC3 <= kind <= 0xCF and kind != 0xC4:
            raise ValueError(f"expected a baseline or progressive JPEG, got one of kind {kind - 0xC0}")
        # frame, tables, restarts; what says how colours are meant
        if kind in (0xC0, 0xC1, 0xC2, 0xC4, 0xDB, 0xDD, 0xEE) or data[at + 4 : at + 8] == b"JFIF":
            kept.append(data[at : at + 2 + length])
        at += 2 + length
    raise ValueError(f"expected at most {BLOCKS} segments, got more")


def _bmp(data: bytes) -> Stripped:
    (header,) = struct.unpack_from("<I", data, 14)
    if header == 12:
        return *struct.unpack_from("<HH", data, 18), data
    width, height, _, _, packing = struct.unpack_from("<iiHHI", data, 18)
    if packing in (1, 2):
        check(len(data), RUN_BYTES, "bytes of run lengths")
    return width, abs(height), data


def _gif(data: bytes) -> Stripped:
    width, height, flags = struct.unpack_from("<HHB", data, 6)
    at = 13 + (3 << (flags & 7) + 1 if flags & 128 else 0)
    screen, control, left = data[:at], b"", BLOCKS
    while left > 0:
        left -= 1
        start, kind = at, data[at]
        if kind == 0x2C:
            x, y, w, h, flags = struct.unpack_from("<HHHHB", data, at + 1)
            at += 10 + (3 << (flags & 7) + 1 if flags & 128 else 0) + 1
        elif kind == 0x21:
            at += 2
        else:
            raise ValueError(f"expected an image in the GIF file, got {kind:#x} at byte {at}")
        while at < len(data) and data[at] and left > 0:
            at += 1 + data[at]
            left -= 1
        at += 1
        if kind == 0x2C:
            return max(width, x + w), max(height, y + h), screen + control + data[start:at] + b";"
        if data[start + 1] == 0xF9:
            control = data[start:at]
    raise ValueError(f"expected at most {BLOCKS} blocks, got more")


def _webp(data: bytes) -> Stripped:
    kind = data[12:16]
    if kind == b"VP8X":
        return 1 + int.from_bytes(data[24:27], "little"), 1 + int.from_bytes(data[27:30], "little"), data
    if kind == b"VP8L":
        (bits,) = struct.unpack_from("<I", data, 21)
        return 1 + (bits & 0x3FFF), 1 + (bits >> 14 & 0x3FFF), data
    if kind == b"VP8 ":
        width, height = struct.unpack_from("<HH", data, 26)
        return width & 0x3FFF, height & 0x3FFF, data
    raise ValueError(f"expected a WebP picture, got a part {kind!r}")


_KINDS: list[tuple[str, bytes, Callable[[bytes], Stripped]]] = [
    ("PNG", b"\x89PNG\r\n\x1a\n", _png),
    ("JPEG", b"\xff\xd8\xff", _jpeg),
    ("BMP", b"BM", _bmp),
    ("GIF", b"GIF8", _gif),
    ("WEBP", b"RIFF", _webp),
]
