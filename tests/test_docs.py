"""Documents that are run: every Python block, every test that a table names, the reference's names."""

import inspect
import re
from pathlib import Path

import pymunk
import pytest
import shapely

import rigidarea as ra
from rigidarea import reference
from rigidarea.__main__ import COMMANDS, main

ROOT = Path(__file__).parent.parent
FROM_PYMUNK = ROOT / "docs" / "from-pymunk.md"


def blocks(text: str) -> list[str]:
    return re.findall(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("page", ["docs/from-pymunk.md", "README.md"])
def test_every_python_block_runs(page):
    """In their order, in one namespace: each goes on from the one before."""
    found = blocks((ROOT / page).read_text())
    assert len(found) >= 2
    names: dict = {}
    for number, block in enumerate(found):
        exec(compile(block, f"{page}, block {number}", "exec"), names)


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
    pages = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
    assert len(pages) > 8
    for page in pages:
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


def test_docs_queries_see_the_stand_in():
    space = pymunk.Space()
    ell = ra.Outline([(0, 0), (4, 0), (4, 1), (1, 1), (1, 4), (0, 4)])
    body = ell.body(density=1)
    space.add(body, ell.add_to(body))
    assert space.point_query((1.5, 1.5), 0, pymunk.ShapeFilter())  # in the hull, not in the solid
    assert not ell.polygon.contains(shapely.Point(1.5, 1.5))


# --- the reference ---


@pytest.mark.parametrize("module", ["rigidarea", "rigidarea.shapes", "rigidarea.bring"])
def test_everything_public_is_documented(module):
    for name, value in reference.public(__import__(module, fromlist=["x"])).items():
        if inspect.isclass(value) or inspect.isfunction(value):
            assert inspect.getdoc(value), name
        if inspect.isclass(value):
            for member, inner in vars(value).items():
                if not member.startswith("_") and (inspect.isfunction(inner) or isinstance(inner, property)):
                    assert inspect.getdoc(inner), f"{name}.{member}"


def test_the_page_has_every_public_name():
    """Content is renewed by a command; a name that is missing is a page that nobody renewed."""
    page = (ROOT / "docs" / "api.md").read_text()
    for module in ("rigidarea", "rigidarea.shapes", "rigidarea.bring"):
        for name in reference.public(__import__(module, fromlist=["x"])):
            assert re.search(rf"^### (class )?`{name}\b", page, re.MULTILINE), f"{name}: make reference"


def test_the_command_writes_the_page(tmp_path, capsys):
    assert main(["reference", "--docs", str(tmp_path)]) == 0
    text = (tmp_path / "api.md").read_text()
    assert text == reference.page() and "### class `Outline`\n\n```python\nOutline(points: ArrayLike" in text
    assert main(["reference"]) == 0
    assert capsys.readouterr().out == text


def test_signatures_keep_their_defaults():
    def made(self, law: "str" = "area", wide: "float | None" = None) -> "int":
        return 0

    assert reference._signature(made) == "(law: str = 'area', wide: float | None = None) -> int"


def test_theory_cites_what_is_there():
    """Every file that docs/theory.md names exists, and every function is defined in one of them."""
    text = (ROOT / "docs" / "theory.md").read_text()
    files = {path for path in re.findall(r"`(rigidarea/[\w/]+\.py)`", text)}
    assert len(files) > 10
    code = "\n".join((ROOT / path).read_text() for path in files)
    for name in re.findall(r"`(_?[a-z]\w*_\w+)`", text):
        assert f"def {name}(" in code, name
    assert all(1 <= int(number) <= 42 for number in re.findall(r"Eq\. (\d+)", text))
