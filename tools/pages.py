"""The site's pages: their snippets run, and the pictures that snippets draw.

`python tools/pages.py` runs all snippets, draws their pictures anew, makes all figures anew from `docs/results`
(`tests/harness/page.py`), and says which of those were measured on another solver. `make docs` does so before it
builds.
A Python block is run where it stands, in one namespace a page. Where an image of `pictures/` follows it, the block's
`screen` (a pygame surface) is that picture.
"""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
BLOCK = re.compile(
    r"^```python\n(?P<code>.*?)^```\n(?:\s*!\[[^\]]*\]\((?:docs/)?pictures/(?P<picture>[\w-]+)\.png\))?",
    re.MULTILINE | re.DOTALL,
)


class Block(NamedTuple):
    """A snippet."""

    code: str
    picture: str | None
    line: int


def blocks(page: Path) -> Iterator[Block]:
    """The Python blocks of a page."""
    text = page.read_text()
    for found in BLOCK.finditer(text):
        yield Block(found["code"], found["picture"], text.count("\n", 0, found.start()) + 1)


def pages() -> list[Path]:
    """README and all pages that have snippets."""
    every = [ROOT / "README.md", *sorted(DOCS.rglob("*.md"))]
    return [page for page in every if next(blocks(page), None) is not None]


def run(page: Path, pictures: Path | None = None) -> dict[str, Any]:
    """Run a page's snippets; pictures: the folder for what they draw. Returns the page's names.

    Raises what a snippet raises, with the page and the line in its traceback.
    """
    os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
    names: dict[str, Any] = {"__name__": "page"}
    for block in blocks(page):
        # a traceback's line is the page's
        exec(compile("\n" * block.line + block.code, str(page), "exec"), names)
        if block.picture is not None and pictures is not None:
            import pygame

            pictures.mkdir(parents=True, exist_ok=True)
            pygame.image.save(names["screen"], pictures / f"{block.picture}.png")
    return names


def on_page_markdown(markdown: str, page: Any, **more: Any) -> str:
    """MkDocs: a link to a file of the repository that is no page becomes text."""
    up = "../" * (page.file.src_uri.count("/") + 1)
    return re.sub(rf"\[([^\]]*)\]\({re.escape(up)}[^)]*\)", r"\1", markdown)


if __name__ == "__main__":
    from rigidarea.checkout import harness

    page = harness("page", "tools/pages.py")

    for path in page.renew(DOCS):
        print(f"renewed: {path.relative_to(ROOT)}", file=sys.stderr)
    if old := page.older(DOCS):
        print(f"measured on another solver (make studies): {', '.join(old)}", file=sys.stderr)
    os.chdir(ROOT / "docs")
    for each in pages():
        print(each.relative_to(ROOT), file=sys.stderr)
        run(each, DOCS / "pictures")
