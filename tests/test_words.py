"""The field's words: identifiers that docs/glossary.md lists as former ones stand nowhere in the package."""

from __future__ import annotations

import io
import re
import tokenize
from pathlib import Path

import pytest

import rigidarea

PACKAGE = Path(rigidarea.__file__).parent
GLOSSARY = (Path(__file__).parents[1] / "docs" / "glossary.md").read_text()


def former() -> set[str]:
    """Identifiers of the glossary's second table, left."""
    lines = GLOSSARY.partition("## Renamed")[2].splitlines()
    return {
        name
        for line in lines
        if line.startswith("| `")
        for name in re.findall(r"`(\w+)`", line.split("|")[1])
    }


def identifiers(text: str) -> set[str]:
    """Whole identifiers of a source: words of its prose are not among them."""
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    return {token.string for token in tokens if token.type == tokenize.NAME}


def test_a_former_word_is_found():
    assert identifiers("def somebody_touches(a):\n    # everybody\n    return a\n") & former() == {
        "somebody_touches"
    }


@pytest.mark.parametrize(
    "path", sorted(PACKAGE.rglob("*.py")), ids=lambda path: str(path.relative_to(PACKAGE))
)
def test_no_former_word_is_an_identifier(path):
    assert identifiers(path.read_text()) & former() == set()
