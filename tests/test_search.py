"""Pairs: the search against brute force, the hash table against a dictionary, tables that grow."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import rigidarea as ra
from rigidarea.contact.arrays import Store
from rigidarea.kernel import broad, tables
from rigidarea.kernel.place import place

SQUARE = ra.Outline([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
BLADE = ra.Outline([(-1.5, -0.1), (1.5, -0.1), (1.5, 0.1), (-1.5, 0.1)])


def scattered(rng: np.random.Generator, n: int, room: float) -> Store:
    """n bodies of one shape each, every tenth fixed, anywhere in a square."""
    store = Store()
    for i in range(n):
        outline = SQUARE if rng.random() < 0.7 else BLADE
        left, bottom, right, top = outline.bounds
        half = 0.5 * (right - left), 0.5 * (top - bottom)
        store.shape(i, 64 * (i + 1), outline, None, 16 * (i + 1), False, outline.smallest_extent, half)
    store.settle()
    for i, body in enumerate(store.tables.bodies[:n]):
        body["x"], body["y"] = rng.uniform(0, room, 2)
        body["angle"] = rng.uniform(0, 6.3)
        body["vx"], body["vy"] = rng.normal(0, 3, 2)
        body["mobile"] = i % 10 != 0
        place(body)
    shapes = store.tables.shapes[:n]
    shapes["categories"], shapes["mask"] = 1, 0xFFFFFFFF
    return store


def searched(store: Store, time: float) -> set[tuple[int, int]]:
    while not broad.search(store.pool, store.tables, time, -1):
        assert store.tables.counters[tables.MORE_PAIRS] > 0
        store.grow()
    t = store.tables
    near = t.pairs[t.near["pair"][: t.counters[tables.NEAR]]]
    found = {(min(a, b), max(a, b)) for a, b in zip(near["a"].tolist(), near["b"].tolist())}
    assert len(found) == len(near)  # none twice
    return found


def corners(store: Store, i: int) -> np.ndarray:
    t = store.tables
    body = t.bodies[t.shapes[i]["body"]]
    half = np.array([t.shapes[i]["half_x"], t.shapes[i]["half_y"]])
    points = half * [(1, 1), (-1, 1), (-1, -1), (1, -1)]
    turn = np.array([[body["c"], body["s"]], [-body["s"], body["c"]]])
    return points @ turn + [body["x"], body["y"]]


def brute_force(store: Store, n: int, time: float, margin: float) -> set[tuple[int, int]]:
    """Pairs whose boxes, widened by the motion and `margin` smallest extents, meet."""
    t = store.tables
    low, high = np.zeros((n, 2)), np.zeros((n, 2))
    for i in range(n):
        body = t.bodies[t.shapes[i]["body"]]
        reach = time * np.abs([body["vx"], body["vy"]]) + margin * t.shapes[i]["extent"]
        points = corners(store, i)
        low[i], high[i] = points.min(axis=0) - reach, points.max(axis=0) + reach
    moves = t.bodies["mobile"][t.shapes["body"][:n]]
    return {
        (i, j)
        for i in range(n)
        for j in range(i + 1, n)
        if (moves[i] or moves[j]) and (low[i] <= high[j]).all() and (low[j] <= high[i]).all()
    }


@pytest.mark.parametrize("n, room", [(2, 1.0), (30, 8.0), (200, 25.0), (60, 2.0)])
def test_search_finds_what_brute_force_finds(kernel: Any, n: int, room: float) -> None:
    """Anew, and from the order of the search before, the bodies moved on; more pairs than there was room for."""
    rng = np.random.default_rng([5, n])
    store = scattered(rng, n, room)
    for _ in range(4):
        expected = brute_force(store, n, 0.02, kernel.constants.MARGIN)
        assert searched(store, 0.02) == expected
        for body in store.tables.bodies[:n]:
            if body["mobile"]:
                body["x"] += rng.normal(0, 0.5)
                body["y"] += rng.normal(0, 0.5)
                body["angle"] += rng.normal()
                place(body)
    free = store.tables.counters[tables.FREE_PAIRS]
    assert free + (store.tables.pairs["a"] >= 0).sum() == len(store.tables.pairs)  # none is lost


def test_search_leaves_out_what_may_not_touch(kernel: Any) -> None:
    """Sensors, groups, masks, bodies held apart by a joint; each of them alone."""
    for what in ("none", "sensor", "group", "mask", "joint"):
        store = scattered(np.random.default_rng(1), 2, 0.1)
        t = store.tables
        t.bodies["mobile"][:2] = 1
        if what == "sensor":
            t.shapes["sensor"][1] = 1
        elif what == "group":
            t.shapes["group"][:2] = 4
        elif what == "mask":
            t.shapes["mask"][0] = 2
        elif what == "joint":
            t.bodies["joined"][:2] = 1
            t.apart[0] = 1, 0
            t.counters[tables.APART] = 1
        assert searched(store, 0.0) == ({(0, 1)} if what == "none" else set()), what


def test_nobody_has_left_until_somebody_has(kernel: Any) -> None:
    """The boxes of the last search hold for as long as all stay within their room."""
    store = scattered(np.random.default_rng(2), 20, 10.0)
    t = store.tables
    t.bodies["vx"] = t.bodies["vy"] = 0.0
    searched(store, 0.0)
    t.bodies["stamp"][:20] = 7
    assert not broad.somebody_left(store.pool, t, 7, 0.01)
    room = kernel.constants.MARGIN * t.shapes[3]["extent"]
    body = t.bodies[t.shapes[3]["body"]]
    for share, left in ((0.9, False), (1.1, True)):
        x = body["x"]
        body["x"] = x + share * room
        place(body)
        assert broad.somebody_left(store.pool, t, 7, 0.01) is left
        body["x"] = x
        place(body)


def test_the_hash_table_is_a_dictionary() -> None:
    """Random pairs come and go; the table is asked for all of them and for others, and grows on the way."""
    rng = np.random.default_rng(3)
    store = Store()
    store.tables = store.tables._replace(shapes=np.zeros(200, tables.SHAPE), bodies=np.zeros(1, tables.BODY))
    size = len(store.tables.pairs)
    known: dict[tuple[int, int], int] = {}
    for _ in range(3000):
        a, b = (int(i) for i in rng.choice(200, 2, replace=False))
        key = (min(a, b), max(a, b))
        assert tables.find_pair(store.tables, a, b) == known.get(key, -1)
        assert tables.find_pair(store.tables, b, a) == known.get(key, -1)
        if key not in known:
            if store.tables.counters[tables.FREE_PAIRS] == 0:
                assert tables.new_pair(store.tables, a, b) == -1
                store.grow_pairs()
                for (p, q), number in known.items():  # numbers stay
                    assert tables.find_pair(store.tables, p, q) == number
            known[key] = tables.new_pair(store.tables, a, b)
            assert len(set(known.values())) == len(known)
        elif rng.random() < 0.5:
            tables.end_pair(store.tables, known.pop(key))
            tables.rehash(store.tables)
    assert len(store.tables.pairs) > size
    assert len(store.tables.keys) >= 2 * len(store.tables.pairs)
    assert store.tables.counters[tables.FREE_PAIRS] == len(store.tables.pairs) - len(known)


def test_regions_grow_and_keep_what_they_hold() -> None:
    store = Store()
    store.tables.regions["area"] = np.arange(len(store.tables.regions))
    before = len(store.tables.regions)
    store.grow_regions()
    store.sync()
    t = store.tables
    assert len(t.regions) == len(t.rows) == 2 * before
    assert (t.regions["area"][:before] == np.arange(before)).all()
    seen, r = set(), int(t.counters[tables.FREE_REGION])
    while r >= 0:
        assert r not in seen
        seen.add(r)
        r = int(t.regions[r]["next"])
    assert len(seen) == t.counters[tables.FREE_REGIONS] == 2 * before
    assert store.state[0]["regions_at"] == t.regions.ctypes.data and store.state[0]["regions_n"] == 2 * before


def test_shapes_and_bodies_that_go_make_room() -> None:
    """A thousand come and go, twenty at a time: rows and outlines are used again."""
    store = Store()
    for i in range(1000):
        outline = ra.Outline(np.array([(0, 0), (1, 0), (0, 1 + 1e-3 * i)]))
        store.shape(i, 64 * (i + 1), outline, None, 16 * (i + 1), False, 0.5, (0.5, 0.5))
        if i >= 20:
            store.forget([i - 20], [16 * (i - 19)])
    store.settle()
    assert len(store.tables.shapes) <= 64 and len(store.tables.bodies) <= 64
    assert len(store.pool.heads) <= 256
    for i in range(980, 1000):
        row = store.tables.shapes[store.slots[i]]
        assert row["ident"] == i and store.tables.bodies[row["body"]]["address"] == 16 * (i + 1)
    assert not store.knows(0) and store.knows(999)
