"""What a copy of an attached space is told: its pairs' sides, stiffness and regions, by the shapes' places."""

from __future__ import annotations

from typing import Any

import numpy as np
import pymunk

from ..kernel.tables import FREE_PAIRS, FREE_REGION, FREE_REGIONS, SUBSTEP, new_pair
from ..store import Store

#: By the places of two shapes in space.shapes: (pair record, region records).
Memory = dict[tuple[int, int], tuple[Any, list[Any]]]


def remember(store: Store, space: pymunk.Space) -> Memory:
    """All pairs that touch and their regions."""
    place = {shape._hashid: i for i, shape in enumerate(space.shapes)}
    tables = store.tables
    memory: Memory = {}
    for pair in tables.pairs[(tables.pairs["a"] >= 0) & (tables.pairs["head"] >= 0)]:
        a, b = (place.get(int(tables.shapes[pair[side]]["ident"])) for side in ("a", "b"))
        if a is None or b is None:
            continue
        rows = []
        r = int(pair["head"])
        while r >= 0:
            rows.append(np.array(tables.regions[r], copy=True))
            r = int(tables.regions[r]["next"])
        memory[a, b] = np.array(pair, copy=True), rows
    return memory


def recall(store: Store, space: pymunk.Space, memory: Memory) -> None:
    """Give a copy the pairs of its original."""
    shapes = list(space.shapes)
    for (a, b), (old, rows) in memory.items():
        if store.tables.counters[FREE_PAIRS] == 0:
            store.grow_pairs()
        while len(rows) > store.tables.counters[FREE_REGIONS]:
            store.grow_regions()
        tables = store.tables
        number = int(
            new_pair(tables, int(store.slots[shapes[a]._hashid]), int(store.slots[shapes[b]._hashid]))
        )
        pair = tables.pairs[number]
        for name in ("side_a", "side_b", "stiffness", "friction", "elasticity", "verdict"):
            pair[name] = old[name]
        for row in reversed(rows):
            r = int(tables.counters[FREE_REGION])
            tables.counters[FREE_REGION] = tables.regions[r]["next"]
            tables.counters[FREE_REGIONS] -= 1
            tables.regions[r] = row
            tables.regions[r]["pair"], tables.regions[r]["next"] = number, pair["head"]
            tables.regions[r]["stamp"] = tables.counters[SUBSTEP]
            pair["head"] = r
