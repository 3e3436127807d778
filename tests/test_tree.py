"""The dynamic tree of boxes against brute force: built at once, and as shapes come, move and go."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rigidarea.contact import tree

N = 60


def fresh(n: int = N) -> tuple[np.ndarray, np.ndarray]:
    nodes = np.zeros(2 * n, tree.NODE)  # all free, the first one first
    nodes["parent"] = np.arange(1, 2 * n + 1)
    nodes["parent"][-1:] = -1
    return nodes, np.array([-1, -1, 0], np.int32)


def found(nodes: np.ndarray, root: int, box: tuple[float, ...]) -> list[int]:
    hits, at = [], -1
    while (at := tree.next_met(nodes, root, at, *box)) >= 0:
        hits.append(int(nodes[at]["owner"]))
    return hits


def found_beside(nodes: np.ndarray, leaf: int, box: tuple[float, ...]) -> list[int]:
    hits = []
    top, at = tree.next_beside(nodes, leaf, -1, *box)
    while at >= 0:
        hits.append(int(nodes[at]["owner"]))
        top, at = tree.next_beside(nodes, top, at, *box)
    return hits


def meeting(boxes: dict[int, tuple[float, ...]], box: tuple[float, ...]) -> set[int]:
    return {
        i for i, b in boxes.items() if b[0] <= box[2] and b[2] >= box[0] and b[1] <= box[3] and b[3] >= box[1]
    }


def check(nodes: np.ndarray, root: int, leaves: dict[int, int]) -> None:
    """Every leaf once, boxes about children's, heights right, no branch higher than the other by two; none lost."""
    seen = set()

    def below(i: int, parent: int) -> int:
        node = nodes[i]
        assert node["parent"] == parent
        if node["left"] < 0:
            seen.add(int(node["owner"]))
            assert leaves[int(node["owner"])] == i
            return 0
        heights = [below(int(node[side]), i) for side in ("left", "right")]
        for side in ("left", "right"):
            child = nodes[int(node[side])]
            assert node["low_x"] <= child["low_x"] and node["low_y"] <= child["low_y"]
            assert node["high_x"] >= child["high_x"] and node["high_y"] >= child["high_y"]
        assert node["height"] == 1 + max(heights)
        return int(node["height"])

    if root >= 0:
        below(root, -1)
    assert seen == set(leaves)


numbers = st.floats(-100, 100, allow_nan=False, width=32)
sizes = st.sampled_from([0.0, 0.5, 1.0, 3.0, 200.0])


@st.composite
def a_box(draw: Any) -> tuple[float, float, float, float]:
    x, y = draw(numbers), draw(numbers)
    return x, y, x + draw(sizes), y + draw(sizes)


@given(st.lists(st.tuples(st.sampled_from("imr"), st.integers(0, N - 1), a_box()), max_size=150), a_box())
@settings(max_examples=60, deadline=None)
def test_what_comes_moves_and_goes_is_found(acts: list[Any], asked: tuple[float, ...]) -> None:
    nodes, roots = fresh()
    leaves: dict[int, int] = {}
    boxes: dict[int, tuple[float, ...]] = {}
    for act, i, box in acts:
        if act == "r" and i in leaves:
            tree.remove(nodes, roots, tree.MOVING, leaves.pop(i))
            del boxes[i]
        elif i in leaves:
            tree.move(nodes, roots, tree.MOVING, leaves[i], *box)
            boxes[i] = box
        elif act != "r":
            leaves[i] = tree.insert(nodes, roots, tree.MOVING, i, *box)
            boxes[i] = box
    check(nodes, int(roots[tree.MOVING]), leaves)
    assert roots[tree.STILL] == -1
    hits = found(nodes, int(roots[tree.MOVING]), asked)
    assert len(hits) == len(set(hits)) and set(hits) == meeting(boxes, asked)
    for i, leaf in leaves.items():
        assert sorted(found_beside(nodes, leaf, asked)) == sorted(meeting(boxes, asked) - {i})


@given(st.lists(a_box(), max_size=N), a_box())
@settings(max_examples=60, deadline=None)
def test_what_is_built_at_once_is_found(given_boxes: list[Any], asked: tuple[float, ...]) -> None:
    """Also where many lie in one place; what comes later and goes is the same tree's."""
    nodes, roots = fresh(N + 1)
    leaves = {}
    for i, box in enumerate(given_boxes):
        leaf = int(roots[tree.FREE])
        roots[tree.FREE] = nodes[leaf]["parent"]
        nodes[leaf] = (*box, -1, -1, -1, i, 0)
        leaves[i] = leaf
    boxes = dict(enumerate(given_boxes))
    tree.build(nodes, roots, tree.STILL, np.array(list(leaves.values()), np.int32))
    check(nodes, int(roots[tree.STILL]), leaves)
    assert set(found(nodes, int(roots[tree.STILL]), asked)) == meeting(boxes, asked)
    leaves[N] = tree.insert(nodes, roots, tree.STILL, N, *asked)
    boxes[N] = asked
    check(nodes, int(roots[tree.STILL]), leaves)
    assert set(found(nodes, int(roots[tree.STILL]), asked)) == meeting(boxes, asked)
    for i in list(leaves):
        tree.remove(nodes, roots, tree.STILL, leaves.pop(i))
    assert roots[tree.STILL] == -1
    free, n = int(roots[tree.FREE]), 0
    while free >= 0:
        free, n = int(nodes[free]["parent"]), n + 1
    assert n == len(nodes)


@pytest.mark.parametrize("n", [100, 2000])
def test_a_tree_is_flat(n: int) -> None:
    """Built of a grid's tiles it is as flat as can be; grown one by one, within AVL's bound of 1.44 log2 n + 1."""
    rng = np.random.default_rng(n)
    nodes, roots = fresh(2 * n)
    places = rng.permutation(n)
    for i in places:
        x, y = 10.0 * (i % 100), 10.0 * (i // 100)
        tree.insert(nodes, roots, tree.MOVING, i, x, y, x + 10.0, y + 10.0)
    assert nodes[roots[tree.MOVING]]["height"] <= 1.44 * np.log2(n) + 1
    leaves = np.zeros(n, np.int32)
    for i in range(n):
        leaf = leaves[i] = roots[tree.FREE]
        roots[tree.FREE] = nodes[leaf]["parent"]
        x, y = 10.0 * (i % 100), 10.0 * (i // 100)
        nodes[leaf] = (x, y, x + 10.0, y + 10.0, -1, -1, -1, i, 0)
    tree.build(nodes, roots, tree.STILL, leaves)
    assert nodes[roots[tree.STILL]]["height"] == np.ceil(np.log2(n))
