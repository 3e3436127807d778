"""A frame's way through the calls, followed in the code from `whole_frame`: down only, one room after the other."""

from __future__ import annotations

import ast
from functools import cache

import pytest

from tests.test_layers import MODULES, circle, imported_from

Function = tuple[str, str]  # module, name
START = ("rigidarea.chipmunk.frame", "whole_frame")
ROOMS = (
    "chipmunk",
    "contact",
    "geometry",
    "compile",
)  # docs/architecture.md: a call goes to the right, or stays
TREES = {
    m: ast.parse(p.read_text()) for m, p in MODULES.items() if m.split(".")[1:2] and m.split(".")[1] in ROOMS
}
FUNCTIONS = {(m, n.name): n for m, tree in TREES.items() for n in tree.body if isinstance(n, ast.FunctionDef)}


@cache
def names(module: str) -> dict[str, Function]:
    """What the names in a module stand for: functions of its own, and those that it imports."""
    found = {name: (m, name) for m, name in FUNCTIONS if m == module}
    for node in ast.walk(TREES[module]):
        if isinstance(node, ast.ImportFrom):
            base = imported_from(node, module, MODULES[module])
            found |= {a.asname or a.name: (base, a.name) for a in node.names if (base, a.name) in FUNCTIONS}
    return found


@cache
def calls(function: Function) -> tuple[Function, ...]:
    """Whom it calls, in the order in which they are named."""
    known = names(function[0])
    there = [n for n in ast.walk(FUNCTIONS[function]) if isinstance(n, ast.Name) and n.id in known]
    there.sort(key=lambda n: (n.lineno, n.col_offset))
    return tuple(dict.fromkeys(known[n.id] for n in there))


def walk(function: Function, seen: dict[Function, None]) -> dict[Function, None]:
    """All that is called on the way, in the order of the first call."""
    if function not in seen:
        seen[function] = None
        for called in calls(function):
            walk(called, seen)
    return seen


FRAME = walk(START, {})


def room(function: Function) -> int:
    return ROOMS.index(function[0].split(".")[1])


def test_the_walk_gets_there() -> None:
    assert {"substeps", "join", "make_row", "visit", "overlap_kernel", "finish_frame"} <= {
        n for _, n in FRAME
    }
    assert {room(f) for f in FRAME} >= {0, 1, 2}


def test_calls_go_down_only() -> None:
    """From room to room, and from file to file: none is come back to on a way that has left it."""
    ways = [(caller, called) for caller in FRAME for called in calls(caller)]
    assert [(a, b) for a, b in ways if room(a) > room(b)] == []
    graph: dict[str, set[str]] = {module: set() for module, _ in FRAME}
    for (a, _), (b, _) in ways:
        graph[a] |= {b} - {a}
    assert circle(graph) == []


def test_no_way_passes_many_rooms() -> None:
    @cache
    def passed(function: Function) -> int:
        further = (passed(f) + (room(f) != room(function)) for f in calls(function) if f != function)
        return max(further, default=1)

    assert passed(START) <= 10


def test_a_frame_is_read_from_top_to_bottom() -> None:
    """In one file of at most 150 lines, whose functions are called by those above them alone."""
    module = START[0]
    assert MODULES[module].read_text().count("\n") <= 150
    order = [name for m, name in FUNCTIONS if m == module]
    assert order[0] == START[1]
    for name in order:
        after = [called for m, called in calls((module, name)) if m == module]
        assert all(order.index(called) > order.index(name) for called in after), (name, after)


@pytest.mark.parametrize("name", ["silence", "report", "begin", "undo_frame", "explicit_frame"])
def test_what_is_beside_the_frame_is_in_files_of_its_own(name: str) -> None:
    assert (START[0], name) not in FUNCTIONS
    assert [m for m, n in FUNCTIONS if n == name and ".chipmunk." in m]
