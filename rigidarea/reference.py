"""The command `reference`: docs/api.md, every public name with its signature and its docstring."""

from __future__ import annotations

import argparse
import functools
import importlib
import inspect
import re
import sys
import textwrap
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

#: Columns of a block of code.
WIDTH = 110
#: What a user may import, in the order of the page.
MODULES = ("rigidarea", "rigidarea.shapes", "rigidarea.bring", "rigidarea.gym", "rigidarea.flexible")

HEAD = """# API reference

Written from the docstrings by `python -m rigidarea reference --docs docs`; what each name is for is in the
[README](../README.md), what changes for a pymunk program in [from-pymunk.md](from-pymunk.md).
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of `rigidarea reference`."""
    parser.add_argument(
        "--docs", type=Path, metavar="DIR", help="rewrite api.md here (default: standard output)"
    )


def run(arguments: argparse.Namespace) -> int:
    """Run `rigidarea reference`."""
    text = page()
    if arguments.docs is None:
        sys.stdout.write(text)
        return 0
    file = arguments.docs / "api.md"
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text)
    print(f"written: {file}", file=sys.stderr)
    return 0


def page() -> str:
    """The whole page. A module whose extra is not installed is named, without its content."""
    parts = [HEAD]
    for name in MODULES:
        try:
            module = importlib.import_module(name)
        except ModuleNotFoundError as error:
            if (error.name or "").split(".")[0] == "rigidarea":
                raise
            parts.append(
                f"## `{name}`\n\nNeeds {error.name}, which was not installed when this page was written.\n"
            )
            continue
        parts.append(_module(module))
    return "\n".join(parts)


def public(module: ModuleType) -> dict[str, Any]:
    """The module's public names that have a docstring of their own: classes, functions, submodules left out."""
    names = getattr(module, "__all__", None)
    if names is None:
        names = [
            name
            for name, value in vars(module).items()
            if not name.startswith("_") and getattr(value, "__module__", "").startswith("rigidarea")
        ]
    found = {name: getattr(module, name) for name in names}
    return {name: value for name, value in found.items() if not inspect.ismodule(value)}


def _module(module: ModuleType) -> str:
    lines = [f"## `{module.__name__}`", "", _text(module), ""]
    for name, value in public(module).items():
        if inspect.isclass(value):
            lines += _class(name, value)
        elif callable(value):
            lines += [f"### `{name}`", "", *_fenced(name, value), _text(value), ""]
        elif isinstance(value, np.dtype):
            lines += [
                f"### `{name}`",
                "",
                f"A dtype: {', '.join(f'`{key}`' for key in value.names or ())}.",
                "",
            ]
        else:
            lines += [f"### `{name}`", "", f"A {type(value).__name__}: `{_short(value)}`", ""]
    return "\n".join(lines)


def _class(name: str, made: type) -> list[str]:
    lines = [f"### class `{name}`", "", *_fenced(name, made), _text(made), ""]
    for member, value in vars(made).items():
        if member.startswith("_"):
            continue
        plain = value.__func__ if isinstance(value, classmethod | staticmethod) else value
        if isinstance(plain, property | functools.cached_property):
            settable = ", may be set" if getattr(plain, "fset", None) else ""
            lines += [f"- **`.{member}`**{settable}: {_line(_text(plain))}"]
        elif inspect.isfunction(plain):
            lines += [f"- **`.{member}{_signature(plain)}`**: {_line(_text(plain))}"]
    return [*lines, ""]


def _fenced(name: str, value: Any) -> list[str]:
    """How it is called, as a block of code; nothing for what has no signature."""
    signature = _signature(value)
    if not signature:
        return []
    return ["```python", *textwrap.wrap(name + signature, WIDTH, subsequent_indent="    "), "```", ""]


def _signature(value: Any) -> str:
    try:
        text = str(inspect.signature(value))
    except (TypeError, ValueError):
        return ""
    text = re.sub(r"\(self(, )?", "(", text)
    text = re.sub(r"\bcls(, )?", "", text, count=1) if text.startswith("(cls") else text
    text = re.sub(r"ForwardRef\(('[^']*')\)", r"\1", text)  # annotations of a named tuple
    text = re.sub(r"\d+\.\d{6,}", lambda m: f"{float(m.group()):.4g}", text)
    # annotations are text (from __future__ import annotations): strip their quotes and the modules' paths
    return re.sub(r"'([^']*)'", lambda m: m.group(1) if m.group(1) not in WORDS else m.group(), text)


#: Defaults that are words, and so keep their quotes.
WORDS = {
    "area",
    "energy",
    "chord",
    "nodal",
    "implicit",
    "explicit",
    "auto",
    "compiled",
    "python",
    "both",
    "json",
    "toml",
}


def _text(value: Any) -> str:
    """The docstring; what it says of arguments ("name: ...") as a list."""
    text = inspect.getdoc(value) or "(no docstring)"
    text = re.sub(r"(?<!\n)\n(Returns|Raises) ", r"\n\n\1 ", text)  # no part of the list before it
    return re.sub(r"^([a-z_]\w*(?:, [a-z_]\w*)*): ", r"- `\1`: ", text, flags=re.MULTILINE)


def _line(text: str) -> str:
    """A docstring inside a list: its lines indented."""
    return text.replace("\n", "\n  ")


def _short(value: Any) -> str:
    text = repr(value).replace("\n", " ")
    return text if len(text) <= 100 else text[:97] + "..."
