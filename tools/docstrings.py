"""Docstrings as Markdown, for the site's reference: what one says of its arguments ("name: ...") becomes a list."""

from __future__ import annotations

import re
from typing import Any

from griffe import Extension, Object

ARGUMENT = re.compile(r"^([a-z_]\w*(?:, [a-z_]\w*)*): ", re.MULTILINE)


class Arguments(Extension):
    """Changes the text of every docstring; raises nothing."""

    def on_object(self, *, obj: Object, **more: Any) -> None:
        """One object has been read."""
        if obj.docstring is not None:
            text = re.sub(r"(?<!\n)\n(Returns|Raises) ", r"\n\n\1 ", obj.docstring.value)
            first = ARGUMENT.search(text)
            if first and not text[: first.start()].endswith("\n\n") and first.start() > 0:
                text = text[: first.start()] + "\n" + text[first.start() :]
            obj.docstring.value = ARGUMENT.sub(r"- `\1`: ", text)
