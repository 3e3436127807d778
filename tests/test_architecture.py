"""docs/architecture.md answers with files and names that are there; its rooms are all there are."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

import rigidarea

PACKAGE = Path(rigidarea.__file__).parent
PAGE = (Path(__file__).parents[1] / "docs" / "architecture.md").read_text()


def section(title: str) -> str:
    return PAGE.partition(f"## {title}\n")[2].partition("\n## ")[0]


def rows(title: str) -> list[list[str]]:
    """Cells of the section's table, without its head."""
    lines = [line for line in section(title).splitlines() if line.startswith("| ")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[1:]]


def defined(path: Path) -> set[str]:
    """What a file defines at its top."""
    tree = ast.parse(path.read_text())
    return {node.name for node in tree.body if isinstance(node, ast.FunctionDef | ast.ClassDef)}


def test_it_is_one_page():
    assert PAGE.count("\n") <= 100 and max(map(len, PAGE.splitlines())) < 400


@pytest.mark.parametrize("question,file,name", rows("Ten questions"), ids=lambda cell: cell[:40])
def test_each_question_is_answered_by_a_file_and_a_name(question, file, name):
    assert question.endswith("?")
    assert name.strip("`") in defined(PACKAGE / file.strip("`"))


def test_there_are_ten_questions():
    assert len(rows("Ten questions")) == 10


@pytest.mark.parametrize("what,files,names", rows("Where to change what"), ids=lambda cell: cell[:40])
def test_what_is_changed_is_where_the_page_says(what, files, names):
    paths = [PACKAGE / file for file in re.findall(r"`([\w/]+\.py)`", files)]
    assert all(path.is_file() for path in paths)
    there = set().union(*map(defined, paths or (PACKAGE / "study" / "scenes").glob("*_scene.py")))
    for name in re.findall(r"`(\w+)(?:\(\))?`", names):
        assert name in there, name


def test_few_files_are_to_be_read():
    """Issue 27's bounds for friction, a joint, an edge kind."""
    counts = {what: files.count(".py`") for what, files, _ in rows("Where to change what")}
    assert counts["friction's law"] <= 3 and counts["a joint"] <= 2 and counts["an edge kind"] <= 4


def test_a_frame_names_functions_that_are_there():
    names = re.findall(r"`(\w+)\.(\w+)`", section("A frame").replace("space.step", ""))
    files = {path.stem: path for path in PACKAGE.rglob("*.py")}
    assert len(names) > 8
    for module, name in names:
        assert name in defined(files[module]), (module, name)


def test_every_room_is_on_the_page():
    named = set(re.findall(r"`(\w+)/`", section("The rooms")))
    assert {path.parent.name for path in PACKAGE.glob("*/__init__.py")} <= named
