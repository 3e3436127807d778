"""JSON and TOML, asked how deep and how much they are before a parser sees them: in a few passes of linear time."""

from __future__ import annotations

import json
import re
import tomllib
from typing import Any

import numpy as np

from .limits import Limits, check

#: TOML's parser is Python: a file of the largest size would take it minutes.
TOML_BYTES = 2**20
#: Names in a dotted key: what tomllib does goes with their square.
NAMES = 4

# Strings, a last one that never ends included; no part of a pattern is ever tried twice (possessive: *+).
_JSON_STRING = re.compile(r'"[^"\\]*+(?:\\.[^"\\]*+)*+(?:"|\Z)', re.DOTALL)
_TOML_STRING = re.compile(
    r'"""(?:[^"\\]|\\.|"(?!""))*+(?:"{3,5}+|\Z)'
    r"|'''(?:[^']|'(?!''))*+(?:'{3,5}+|\Z)"
    r'|"(?:[^"\\\n]|\\.)*+"?+'
    r"|'[^'\n]*+'?+"
    r"|#[^\n]*+",
    re.DOTALL,
)
_DOTTED = re.compile(rf"(?:\.[ \t]*+[\w-]++[ \t]*+){{{NAMES}}}")

_STEPS = np.zeros(256, np.int8)
_STEPS[list(b"[{")] = 1
_STEPS[list(b"]}")] = -1


def parse_json(content: str, what: str, depth: int, limits: Limits) -> Any:
    """The value of a JSON text, in which NaN and Infinity are not allowed.

    Raises ValueError for anything else, for more than `limits` allow, and for more than `depth` lists and
    objects within each other; what: where it comes from, for the message.
    """
    check(len(content), limits.bytes, "characters")
    _bounded(_JSON_STRING.sub("_", content), ":", what, depth, limits)

    def refuse(name: str) -> None:
        raise _NotFinite(f"{what}: expected finite numbers, got {name}")

    try:
        return json.loads(content, parse_constant=refuse)
    except _NotFinite:
        raise
    except (ValueError, RecursionError) as error:  # JSONDecodeError, too many digits; a deep stack's end
        raise ValueError(f"{what}: expected JSON: {error}") from None


class _NotFinite(ValueError):
    pass


def parse_toml(content: str, what: str, limits: Limits) -> dict[str, Any]:
    """The tables of a TOML text; ValueError for anything else, and for more than `limits` allow."""
    check(len(content), min(limits.bytes, TOML_BYTES), "characters of TOML")
    plain = _TOML_STRING.sub("_", content)
    if _DOTTED.search(plain):
        raise ValueError(f"{what}: expected keys of at most {NAMES} names, got {NAMES + 1}")
    _bounded(plain, "=", what, limits.depth, limits)
    try:
        return tomllib.loads(content)
    except (ValueError, RecursionError) as error:  # TOMLDecodeError, a number of too many digits
        raise ValueError(f"{what}: expected TOML: {error}") from None


def _bounded(plain: str, entry: str, what: str, depth: int, limits: Limits) -> None:
    """ValueError for too much in a text without strings and comments; entry: what stands between key and value."""
    steps = _STEPS[np.frombuffer(plain.encode("utf-8", "replace"), np.uint8)]
    deepest = int(steps.cumsum(dtype=np.int32).max(initial=0))
    if deepest > depth:
        raise ValueError(
            f"{what}: expected at most {depth} lists and tables within each other, got {deepest}"
        )
    parts = 40 * limits.parts  # keys and values that a body with its shapes and joints may have
    check(plain.count(entry), parts, "keys")
    check(plain.count("[") + plain.count("{"), limits.points + parts, "lists and tables")
    check(plain.count(","), 4 * limits.points + parts, "values")
