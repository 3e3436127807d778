"""Pairs: the search against brute force, the hash table against a dictionary, tables that grow."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import rigidarea as ra
from rigidarea.chipmunk.arrays import Store
from rigidarea.chipmunk.outline_pool import enter_outline
from rigidarea.contact import broad, dtypes, order, tables, tree
from rigidarea.geometry.place import place

SQUARE = ra.Outline([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
BLADE = ra.Outline([(-1.5, -0.1), (1.5, -0.1), (1.5, 0.1), (-1.5, 0.1)])


def scattered(rng: np.random.Generator, n: int, room: float) -> Store:
    """n bodies of one shape each, every tenth static, anywhere in a square."""
    store = Store()
    heads = [enter_outline(store, outline, outline.smallest_extent) for outline in (SQUARE, BLADE)]
    store.grow_shapes(n + 16)
    store.grow_bodies(n + 16)
    store.sync()
    t, counters = store.tables, store.tables.counters
    counters[tables.SHAPES] = counters[tables.BODIES] = n
    for i in range(n):
        body, shape = t.bodies[i], t.shapes[i]
        body["x"], body["y"] = rng.uniform(0, room, 2)
        body["angle"] = rng.uniform(0, 6.3)
        place(body)
        body["old_x"], body["old_y"] = body["x"], body["y"]
        head = heads[int(rng.random() > 0.7)]
        shape["body"], shape["ident"], shape["outline"], shape["mirror"] = i, i, head, -1
        shape["extent"], shape["half_x"], shape["half_y"] = store.forms.extent[head]
        shape["categories"], shape["mask"] = 1, 0xFFFFFFFF
        shape["leaf"] = -1
        shape["low_x"], shape["high_x"] = np.inf, -np.inf
        if i % 10 == 0:
            box = broad.box_of(store.pool, shape, body)
            for names in (("left", "bottom", "right", "top"), ("low_x", "low_y", "high_x", "high_y")):
                for name, value in zip(names, box):
                    shape[name] = value
            broad.put_in_tree(t, i, tree.STILL)
        else:
            body["mobile"] = body["awake"] = 1
            body["kind"] = tables.DRIFTS
            body["vx"], body["vy"] = rng.normal(0, 3, 2)
            t.movers[counters[tables.MOVERS]] = i
            counters[tables.MOVERS] += 1
    counters[tables.ANEW] = 1
    return store


def searched(store: Store, h: float, time: float) -> set[tuple[int, int]]:
    while not order.find_near(store.pool, store.tables, 7, h, time):
        store.grow()
    t = store.tables
    order.sieve(t, 7)
    near = t.pairs[t.near["pair"][: t.counters[tables.BOXED]]]
    found = {(min(a, b), max(a, b)) for a, b in zip(near["a"].tolist(), near["b"].tolist())}
    assert len(found) == len(near)  # none twice
    assert len(found) == (t.pairs["a"] >= 0).sum()  # none but these
    return found


def brute_force(store: Store, n: int, h: float) -> set[tuple[int, int]]:
    """Pairs whose boxes meet, one of them mobile; and every box has where its shape is, and will be within h."""
    t = store.tables
    low = np.array([t.shapes["low_x"][:n], t.shapes["low_y"][:n]]).T
    high = np.array([t.shapes["high_x"][:n], t.shapes["high_y"][:n]]).T
    for i in range(n):
        shape, body = t.shapes[i], t.bodies[i]
        half = np.array([shape["half_x"], shape["half_y"]])
        points = half * [(1, 1), (-1, 1), (-1, -1), (1, -1)]
        turn = np.array([[body["c"], body["s"]], [-body["s"], body["c"]]])
        points = points @ turn + [body["x"], body["y"]]
        for ahead in (0.0, h):
            where = points + ahead * np.array([body["vx"], body["vy"]])
            assert (low[i] <= where.min(axis=0) + 1e-9).all() and (high[i] >= where.max(axis=0) - 1e-9).all()
    moves = t.bodies["mobile"][:n]
    return {
        (i, j)
        for i in range(n)
        for j in range(i + 1, n)
        if (moves[i] or moves[j]) and (low[i] <= high[j]).all() and (low[j] <= high[i]).all()
    }


@pytest.mark.parametrize("n, room", [(2, 1.0), (30, 8.0), (200, 25.0), (60, 2.0)])
def test_search_finds_what_brute_force_finds(kernel: Any, n: int, room: float) -> None:
    """At first, and as bodies move on, some of them out of their boxes; more pairs than there was room for."""
    rng = np.random.default_rng([5, n])
    store = scattered(rng, n, room)
    for step in range(6):
        assert searched(store, 0.02, 0.04) == brute_force(store, n, 0.02)
        for body in store.tables.bodies[:n]:
            if body["mobile"] and rng.random() < (0.3 if step < 3 else 1.0):
                body["x"] += rng.normal(0, 0.5)
                body["y"] += rng.normal(0, 0.5)
                body["angle"] += rng.normal()
                place(body)
                body["old_x"], body["old_y"] = body["x"], body["y"]
    free = store.tables.counters[tables.FREE_PAIRS]
    assert free + (store.tables.pairs["a"] >= 0).sum() == len(store.tables.pairs)  # none is lost


def test_what_may_not_touch_is_not_near(kernel: Any) -> None:
    """Sensors, groups, masks, bodies held apart by a joint; each of them alone, of two that move and of one."""
    for what in ("none", "sensor", "group", "mask", "joint"):
        for still in (False, True):
            store = scattered(np.random.default_rng(1), 2 if still else 3, 0.1)
            t, (i, j) = store.tables, (0, 1) if still else (1, 2)
            if not still:
                t.shapes["categories"][0] = t.shapes["mask"][0] = 0
            if what == "sensor":
                t.shapes["sensor"][i] = 1
            elif what == "group":
                t.shapes["group"][[i, j]] = 4
            elif what == "mask":
                t.shapes["mask"][i] = 2
            elif what == "joint":
                t.bodies["joined"][[i, j]] = 1
                t.apart[0] = j, i
                t.counters[tables.APART] = 1
            searched(store, 0.0, 0.0)
            order.sieve(t, 7)
            order.arrange(t, 0.0, -1.0)
            near = t.pairs[t.near["pair"][: t.counters[tables.NEAR]]]
            assert len(near) == (what == "none"), (what, still)


def test_nobody_is_asked_about_until_somebody_has_left(kernel: Any) -> None:
    """The boxes hold for as long as all stay within their room; who leaves its own is asked about alone."""
    store = scattered(np.random.default_rng(2), 20, 10.0)
    t = store.tables
    t.bodies["vx"] = t.bodies["vy"] = 0.0
    searched(store, 0.01, 0.01)
    room = kernel.constants.MARGIN * t.shapes[3]["extent"]
    body = t.bodies[3]
    for share, left in ((0.9, []), (1.1, [3])):
        x = body["x"]
        body["x"] = x + share * room
        place(body)
        broad.renew_boxes(store.pool, t, 0.01, 0.01)
        assert t.asked[: t.counters[tables.ASKED]].tolist() == left
        body["x"] = x
        place(body)


def test_the_hash_table_is_a_dictionary() -> None:
    """Random pairs come and go; the table is asked for all of them and for others, and grows on the way."""
    rng = np.random.default_rng(3)
    store = Store()
    store.tables = store.tables._replace(shapes=np.zeros(200, dtypes.SHAPE), bodies=np.zeros(1, dtypes.BODY))
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
                store.grow_pairs(2 * len(store.tables.pairs))
                for (p, q), number in known.items():  # numbers stay
                    assert tables.find_pair(store.tables, p, q) == number
            known[key] = tables.new_pair(store.tables, a, b)
            assert len(set(known.values())) == len(known)
        elif rng.random() < 0.5:
            tables.end_pair(store.tables, known.pop(key))
    assert len(store.tables.pairs) > size
    assert len(store.tables.table) >= 2 * len(store.tables.pairs)
    assert store.tables.counters[tables.FREE_PAIRS] == len(store.tables.pairs) - len(known)


def test_regions_grow_and_keep_what_they_hold() -> None:
    store = Store()
    store.tables.regions["area"] = np.arange(len(store.tables.regions))
    before = len(store.tables.regions)
    store.grow_regions(2 * len(store.tables.regions))
    store.sync()
    t = store.tables
    assert len(t.regions) == 2 * before and len(t.rows) == len(t.regions) + len(t.joints)
    assert (t.regions["area"][:before] == np.arange(before)).all()
    seen, r = set(), int(t.counters[tables.FREE_REGION])
    while r >= 0:
        assert r not in seen
        seen.add(r)
        r = int(t.regions[r]["next"])
    assert len(seen) == t.counters[tables.FREE_REGIONS] == 2 * before
    assert store.state[0]["regions_at"] == t.regions.ctypes.data and store.state[0]["regions_n"] == 2 * before
