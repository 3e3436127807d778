"""What a copy of an attached space is told, so that it goes on as its original does: near pairs, regions, boxes."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pymunk

from ..kernel.tables import ANEW, FREE_PAIRS, FREE_REGION, FREE_REGIONS, NEAR, SUBSTEP, new_pair
from ..store import Store


class Memory(NamedTuple):
    """Pairs in the order of the sweeps, by the places of their two shapes in space.shapes; a record a shape."""

    pairs: list[tuple[int, int, Any, list[Any]]]
    shapes: list[Any]


#: What a pair and a shape keep.
_PAIR = (
    *("side_a", "side_b", "verdict", "friction", "elasticity", "surface_x", "surface_y"),
    *("stiffness", "load", "least", "order", "beside"),
)
_SHAPE = ("group", "categories", "mask", "low_x", "low_y", "high_x", "high_y")


def remember(store: Store, space: pymunk.Space) -> Memory | None:
    """All near pairs and their regions; None where they are to be searched anew anyway."""
    shapes = list(space.shapes)
    tables = store.tables
    if tables.counters[ANEW] or not all(store.knows(shape._hashid) for shape in shapes):
        return None
    place = {int(store.slots[shape._hashid]): i for i, shape in enumerate(shapes)}
    pairs = []
    for p in tables.near[: tables.counters[NEAR]]:
        pair = tables.pairs[p]
        if int(pair["a"]) not in place or int(pair["b"]) not in place:
            return None
        rows = []
        r = int(pair["head"])
        while r >= 0:
            rows.append(np.array(tables.regions[r], copy=True))
            r = int(tables.regions[r]["next"])
        pairs.append((place[int(pair["a"])], place[int(pair["b"])], np.array(pair, copy=True), rows))
    records = [np.array(tables.shapes[store.slots[shape._hashid]], copy=True) for shape in shapes]
    return Memory(pairs, records)


def recall(store: Store, space: pymunk.Space, memory: Memory) -> None:
    """Give a copy what its original remembers."""
    slots = [int(store.slots[shape._hashid]) for shape in space.shapes]
    for row, old in zip(slots, memory.shapes):
        for name in _SHAPE:
            store.tables.shapes[row][name] = old[name]
    while len(memory.pairs) > store.tables.counters[FREE_PAIRS]:
        store.grow_pairs()
    while sum(len(rows) for *_, rows in memory.pairs) > store.tables.counters[FREE_REGIONS]:
        store.grow_regions()
    tables = store.tables
    tables.counters[SUBSTEP] += 1
    for i, (a, b, old, rows) in enumerate(memory.pairs):
        number = int(new_pair(tables, slots[a], slots[b]))
        tables.near[i] = number
        pair = tables.pairs[number]
        for name in _PAIR:
            pair[name] = old[name]
        for row in reversed(rows):
            r = int(tables.counters[FREE_REGION])
            tables.counters[FREE_REGION] = tables.regions[r]["next"]
            tables.counters[FREE_REGIONS] -= 1
            tables.regions[r] = row
            tables.regions[r]["pair"], tables.regions[r]["next"] = number, pair["head"]
            tables.regions[r]["stamp"] = tables.counters[SUBSTEP]
            pair["head"] = r
    tables.counters[NEAR], tables.counters[ANEW] = len(memory.pairs), 0
