"""Which pair of the tables an arbiter belongs to: kept in the arbiter itself, and carried over to copies of a space.

An arbiter's user data (pymunk leaves it alone) holds the pair's number, and above it the epoch of the attachment, so
that what an earlier attachment left there is never taken for ours.
"""

from __future__ import annotations

from typing import Any

import pymunk
from pymunk._chipmunk_cffi import ffi

from .chipmunk import address_of
from .hook import pair_of_shapes
from .kernel.tables import FREE_PAIRS, FREE_REGION, FREE_REGIONS, end_pair, new_pair
from .store import Store

#: What a copy of a space is told: by the two shapes' places in space.shapes, the pair's sides and its regions.
Memory = dict[tuple[int, int], tuple[int, int, list[Any]]]


class Pairs:
    """The pairs of one attached space, for Python: machine code does the same in `machine.pre_solve`."""

    def __init__(self, space: pymunk.Space, store: Store, memory: Memory) -> None:
        self._space = space
        self._store = store
        self._memory = memory

    def of(self, arbiter: pymunk.Arbiter) -> int:
        """The arbiter's pair, made if there is none yet."""
        if not self._known(arbiter):
            self.prepare(arbiter)
        if not self._known(arbiter):
            self._new(arbiter)
        return address_of(arbiter._arbiter.data) & 0xFFFFFFFF

    def prepare(self, arbiter: pymunk.Arbiter) -> None:
        """Make room for a pair; in a copied space give the arbiter the pair that the original had."""
        if self._store.tables.counters[FREE_PAIRS] == 0:
            self._store.grow_pairs()
        if not self._memory:
            self._store.state[0]["restoring"] = 0
            return
        shapes = list(self._space.shapes)
        a, b = pair_of_shapes(arbiter)
        found = self._memory.pop((shapes.index(a), shapes.index(b)), None)
        if found is not None:
            self._fill(self._new(arbiter), *found)

    def end(self, arbiter: pymunk.Arbiter) -> None:
        """The shapes have separated: free what the pair held."""
        if self._known(arbiter):
            end_pair(self._store.tables, address_of(arbiter._arbiter.data) & 0xFFFFFFFF)
        arbiter._arbiter.data = ffi.NULL

    def remember(self) -> Memory:
        """All pairs and their regions, for a copy of the space."""
        place = {shape._hashid: i for i, shape in enumerate(self._space.shapes)}
        tables = self._store.tables
        memory: Memory = dict(self._memory)
        for pair in tables.pairs:
            a, b = place.get(int(pair["shape_a"])), place.get(int(pair["shape_b"]))
            if a is None or b is None:
                continue
            rows = []
            r = int(pair["head"])
            while r >= 0:
                rows.append(tables.regions[r].copy())
                r = int(tables.regions[r]["next"])
            memory[a, b] = int(pair["side_a"]), int(pair["side_b"]), rows
        return memory

    def _known(self, arbiter: pymunk.Arbiter) -> bool:
        return address_of(arbiter._arbiter.data) >> 32 == int(self._store.state[0]["epoch"])

    def _new(self, arbiter: pymunk.Arbiter) -> int:
        a, b = pair_of_shapes(arbiter)
        number = int(new_pair(self._store.tables, a._hashid, b._hashid))
        arbiter._arbiter.data = ffi.cast("void *", (int(self._store.state[0]["epoch"]) << 32) | number)
        return number

    def _fill(self, number: int, side_a: int, side_b: int, rows: list[Any]) -> None:
        while len(rows) > self._store.tables.counters[FREE_REGIONS]:
            self._store.grow_regions()
        tables = self._store.tables
        pair = tables.pairs[number]
        pair["side_a"], pair["side_b"] = side_a, side_b
        for row in reversed(rows):
            r = int(tables.counters[FREE_REGION])
            tables.counters[FREE_REGION] = tables.regions[r]["next"]
            tables.counters[FREE_REGIONS] -= 1
            tables.regions[r] = row
            tables.regions[r]["pair"] = number
            tables.regions[r]["next"] = pair["head"]
            pair["head"] = r
