"""The site: every snippet runs, pictures are what snippets draw, nothing warns, questions find their answers."""

import importlib
import inspect
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pymunk
import pytest
import shapely

import rigidarea as ra
from harness import page as study_page
from rigidarea.__main__ import COMMANDS
from rigidarea.gallery import NAMES

ROOT = Path(__file__).parent.parent
DOCS = ROOT / "docs"
FROM_PYMUNK = DOCS / "from-pymunk.md"
sys.path.insert(0, str(ROOT / "tools"))
pages = importlib.import_module("pages")


@pytest.mark.parametrize("page", pages.pages(), ids=lambda page: page.stem)
def test_every_python_block_runs_and_draws_its_picture(page, tmp_path, monkeypatch):
    """In their order, in one namespace: each goes on from the one before. `python tools/pages.py` draws anew."""
    pygame = pytest.importorskip("pygame")
    if page.stem in ("learning", "worlds"):
        pytest.importorskip("gymnasium")
    if page.stem == "worlds":
        pytest.importorskip("distributed")
    monkeypatch.chdir(tmp_path)
    pages.run(page, tmp_path)
    for block in pages.blocks(page):
        if block.picture is not None:
            drawn, kept = (
                pygame.surfarray.array3d(pygame.image.load(folder / f"{block.picture}.png")).astype(int)
                for folder in (tmp_path, DOCS / "pictures")
            )
            off = np.abs(drawn - kept).max(axis=2) > 30 if drawn.shape == kept.shape else np.ones(1)
            assert off.mean() < 0.01, f"{block.picture}: python tools/pages.py"


def test_snippets_are_found():
    found = {page.stem: len(list(pages.blocks(page))) for page in pages.pages()}
    assert found["tutorial"] >= 8 and found["questions"] == 13 and found["README"] >= 1 and len(found) >= 9


def test_every_picture_of_a_page_is_there_and_every_file_is_shown():
    text = {page: page.read_text() for page in [ROOT / "README.md", *DOCS.rglob("*.md")]}
    shown = {
        (page.parent / name).resolve()
        for page, words in text.items()
        for name in re.findall(r"!\[[^\]]*\]\(([^)]+\.png)\)", words)
    }
    assert all(path.is_file() for path in shown), [path for path in shown if not path.is_file()]
    drawn = {DOCS / "pictures" / f"{b.picture}.png" for page in text for b in pages.blocks(page) if b.picture}
    assert set((DOCS / "pictures").glob("*.png")) == drawn


#: Carries digits and is no result: names, the paper's equations, code, addresses, headings, what a picture shows.
NO_RESULT = re.compile(
    r"Box2D(?: v3)?|2-D|Python 3\.11|rigidarea 0\.\d|ES-FEM-T3|(?:Eq\.|Alg\.) \d+(?:(?:, | to | and )\d+)*"
    r"|^#+ .*$|^```[\s\S]*?^```|^ {4}.*$|`[^`]*`|!\[[^\]]*|\]\([^)]*\)",
    re.MULTILINE,
)
#: Derivations, not results: equations, constants of the law.
DERIVED = {"theory", "architecture", "contact"}


def typed_figures(text: str) -> list[str]:
    """Paragraphs, list items and rows with a number that is neither made from results nor marked as given.

    `<!-- given: what -->` in it says what the number is: an input, a setting, what theory says, somebody else's figure.
    """
    text = study_page.MARK.sub("", text)
    units = re.split(r"\n\s*\n|\n(?=\s*[-|] ?)", NO_RESULT.sub("", text))
    return [unit.strip() for unit in units if re.search(r"\d", unit) and "<!-- given: " not in unit]


def test_the_gallery_shows_every_demo_and_its_source():
    """Each demo's still, and a mark by which the site puts its source there: `--8<-- "file"`, spaces as here."""
    text = (DOCS / "gallery.md").read_text()
    marks = re.findall(r'^ *--8<-- "(.+)"$', text, re.MULTILINE)
    assert sorted(marks) == sorted(f"rigidarea/demos/{name}.py" for name in NAMES)
    assert sorted(re.findall(r"!\[.*\]\((\w+)\.png\)", text)) == sorted(NAMES)
    for page in DOCS.rglob("*.md"):  # a formatter of code spreads it: 8 < --
        assert not re.search(r"8 *< +--|-- +8 *<", page.read_text()), page


def test_a_typed_figure_is_found():
    """In a paragraph, an item, a row; not in code, a heading, an equation's number, a mark, or where it is given."""
    text = (
        "# 1\n\nEq. 4 and 7 of `a 3`.\n\nIt takes\n12 ms.\n\n- one\n- 2 of them\n\n| a | 0.5 |\n|---|---|\n"
    )
    text += (
        "| b | <!-- figure x y -->7<!-- /figure --> |\n\n```python\n5\n```\n\nOf 40 <!-- given: thrown -->\n"
    )
    assert typed_figures(text) == ["It takes\n12 ms.", "- 2 of them", "| a | 0.5 |"]


@pytest.mark.parametrize("shown", study_page.pages(DOCS), ids=lambda path: path.stem)
def test_no_figure_is_typed(shown):
    """All figures come from `docs/results`, or say what they are (`typed_figures`)."""
    assert shown.stem in DERIVED or typed_figures(shown.read_text()) == []


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The site, built; its folder."""
    pytest.importorskip("mkdocs")
    pytest.importorskip("material")
    folder = tmp_path_factory.mktemp("site")
    built = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "-d", str(folder)],
        env={**os.environ, "NO_MKDOCS_2_WARNING": "1"},  # the theme's own, of a MkDocs to come
        capture_output=True,
        text=True,
        cwd=ROOT,
        timeout=300,
    )
    assert built.returncode == 0, built.stderr
    assert "WARNING" not in built.stderr and "built in" in built.stderr
    assert (folder / "gallery.html").read_text().count("Headline") >= len(NAMES)  # the demos' sources
    return folder


def test_the_site_is_built_without_a_warning_and_has_every_public_name(site):
    for module, page in REFERENCE.items():
        text = (site / "reference" / f"{page}.html").read_text()
        for name in public(importlib.import_module(module)):
            assert re.search(rf'id="[\w.]*\b{name}"', text), f"{module}.{name}"


#: In a game author's words, written before the answers, and the section that answers.
ASKED = {
    "player on the ground can jump": "how-do-i-know-the-player-stands-on-the-ground",
    "body sinks into the floor": "why-does-it-sink",
    "draw a gear": "how-do-i-draw-a-gear",
    "jump through a platform from below": "how-does-one-jump-through-a-platform-from-below",
    "pinball bumper elasticity": "how-do-i-make-a-bumper-that-gives-back-more",
    "level from svg inkscape": "how-do-i-get-a-level-out-of-a-drawing",
    "damage how hard hit impulse": "how-hard-was-it-hit",
    "mouse click shape": "what-is-under-the-mouse",
    "gears drive each other": "how-do-i-make-gears-drive-each-other",
    "frame slow": "why-is-a-frame-slow-and-what-does-it-cost",
    "fly apart first frame": "why-does-everything-fly-apart-in-the-first-frame",
    "save game pickle": "how-do-i-save-the-game",
}


def test_the_search_finds_the_answers(site):
    """Among the first three; by the engine of the site's own search, titles counting as there."""
    lunr = pytest.importorskip("lunr")
    documents = json.loads((site / "search" / "search_index.json").read_text())["docs"]
    fields = [{"field_name": "title", "boost": 1000}, {"field_name": "text"}]
    index = lunr.lunr(ref="location", fields=fields, documents=documents)
    for question, section in ASKED.items():
        first = [hit["ref"] for hit in index.search(question)[:3]]
        assert f"questions.html#{section}" in first, (question, first)


def test_every_row_names_a_test_that_is_there():
    rows = [
        line
        for line in FROM_PYMUNK.read_text().splitlines()
        if line.startswith("| ") and "checked by" not in line
    ]
    assert len(rows) > 15
    there = "\n".join(path.read_text() for path in (ROOT / "tests").rglob("*.py"))
    for row in rows:
        (name,) = re.findall(r"`(test_\w+)`", row)
        assert f"def {name}(" in there, row


def test_every_command_shown_is_there():
    every = [ROOT / "README.md", *sorted(DOCS.rglob("*.md"))]
    assert len(every) > 15
    for page in every:
        for command in re.findall(r"python -m rigidarea\s+(\w+)", page.read_text()):
            assert command in COMMANDS, (page, command)


def test_docs_refresh():
    space = pymunk.Space()
    space.gravity = 0, -900
    body = pymunk.Body(1, 100)
    body.position = 0, 60
    disc = pymunk.Circle(body, 10)
    space.add(body, disc, pymunk.Segment(space.static_body, (-50, 0), (50, 0), 5))
    contact = ra.attach(space)
    contact.step(1 / 60)
    disc.unsafe_set_radius(12)  # in the air: what grows into another is pushed out of it
    contact.refresh(disc)
    for _ in range(120):
        contact.step(1 / 60)
    assert body.position.y == pytest.approx(17, abs=0.2)  # 5 of the segment, 12 of the disc


def test_docs_queries_see_the_proxy():
    space = pymunk.Space()
    ell = ra.Outline([(0, 0), (4, 0), (4, 1), (1, 1), (1, 4), (0, 4)])
    body = ell.body(density=1)
    space.add(body, ell.add_to(body))
    assert space.point_query((1.5, 1.5), 0, pymunk.ShapeFilter())  # in the hull, not in the solid
    assert not ell.polygon.contains(shapely.Point(1.5, 1.5))


# --- the reference ---

REFERENCE = {
    f"rigidarea{name}": page for name, page in (("", "rigidarea"), (".shapes", "shapes"), (".bring", "bring"))
}


def public(module: ModuleType) -> dict[str, object]:
    """The names that a module offers, submodules left out."""
    found = {name: getattr(module, name) for name in module.__all__}
    return {name: value for name, value in found.items() if not inspect.ismodule(value)}


@pytest.mark.parametrize("module", REFERENCE)
def test_everything_public_is_documented(module):
    for name, value in public(importlib.import_module(module)).items():
        if inspect.isclass(value) or inspect.isfunction(value):
            assert inspect.getdoc(value), name
        if inspect.isclass(value):
            for member, inner in vars(value).items():
                if not member.startswith("_") and (inspect.isfunction(inner) or isinstance(inner, property)):
                    assert inspect.getdoc(inner), f"{name}.{member}"


def test_theory_cites_what_is_there():
    """Every file that docs/theory.md names exists, and every function is defined in one of them."""
    text = (ROOT / "docs" / "theory.md").read_text()
    files = {path for path in re.findall(r"`(rigidarea/[\w/]+\.py)`", text)}
    assert len(files) > 10
    code = "\n".join((Path(ra.__file__).parents[1] / path).read_text() for path in files)
    for name in re.findall(r"`(_?[a-z]\w*_\w+)`", text):
        assert f"def {name}(" in code, name
    assert all(1 <= int(number) <= 42 for number in re.findall(r"Eq\. (\d+)", text))
