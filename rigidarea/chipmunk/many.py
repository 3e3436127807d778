"""The memory of many worlds: one block a world, geometry shared; how they grow, begin anew, and are looked at."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import lru_cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk._chipmunk_cffi import ffi

from ..contact.tables import MORE_PAIRS, MORE_REGIONS, MORE_WORK
from .arrays import Store
from .structs import address_of
from .world_image import Image, image_of, move_over, rows_of


class Many:
    """n worlds, in turn copies of several spaces, of which each has a `Store`; scratch for each thread."""

    def __init__(self, spaces: Sequence[pymunk.Space], stores: Sequence[Store], n: int, threads: int) -> None:
        self.n, self.threads = n, threads
        self._call = _functions()
        self._outlines = stores  # shared: kept alive
        most = np.max([rows_of(store, one) for store, one in zip(stores, spaces)], axis=0).tolist()
        made = [image_of(store, one, most) for store, one in zip(stores, spaces)]
        self._images = [image for image, _ in made]
        self._make_room()
        for first, (_, memory) in enumerate(made):
            self._put(np.arange(first, len(self._at), len(made)), memory, 0)

    @property
    def nbytes(self) -> int:
        """The memory that one world takes (bytes); what is shared, and the threads' scratch, is not in it."""
        return max(image.size for image in self._images)

    def _make_room(self) -> None:
        """Memory for all worlds, and behind them how those of each space begin; scratch for each thread."""
        images, rows, size = self._images, self.n + len(self._images), self.nbytes
        room = np.zeros(rows * size + 64, np.uint8)
        first = -address_of(ffi.from_buffer(room)) % 64
        self._memory = room[first : first + rows * size].reshape(rows, size)
        self._at = address_of(ffi.from_buffer(self._memory)) + size * np.arange(rows, dtype=np.uint64)
        lengths = {name: max(image.lengths[name] for image in images) for name in images[0].lengths}
        work = type(images[0].work)(*(max(same, key=len) for same in zip(*(image.work for image in images))))
        largest = replace(images[0], lengths=lengths, work=work)
        self._scratches = [largest.scratch() for _ in range(self.threads)]

    def _by_space(self, numbers: NDArray[np.int64]) -> Iterator[tuple[int, NDArray[np.int64]]]:
        """The number of each space, and those of the worlds that are copies of it."""
        if len(self._images) == 1:
            yield 0, numbers
            return
        whose = numbers % len(self._images)
        for first in np.unique(whose).tolist():
            yield first, numbers[whose == first]

    def _grow(self, numbers: NDArray[np.int64]) -> None:
        """All worlds have as much more room as these want (`Store.grow`), and begin with it when they are reset."""
        old, memory, homes, every = self._images, self._memory, self._at, len(self._images)
        short = [self._table(old[first], "counters")[own] for first, own in self._by_space(numbers)]
        want = np.concatenate(short)[:, [MORE_PAIRS, MORE_REGIONS, MORE_WORK]].max(axis=0)
        self._images = [image.larger(*want.tolist()) for image in old]
        self._make_room()
        for k, (image, larger) in enumerate(zip(old, self._images)):
            own = slice(k, None, every)
            move_over(image, memory[own], homes[own], larger, self._memory[own], self._at[own], self._call)

    def _brought_over(self, snapshot: WorldSnapshot, image: Image) -> tuple[Any, int]:
        """A snapshot's memory and its address, in the form that worlds have now: they may have more room since."""
        if snapshot.image is image:
            return snapshot.memory, snapshot.home
        memory = np.zeros((1, image.size), np.uint8)
        home, old_home = address_of(ffi.from_buffer(memory)), np.array([snapshot.home], np.uint64)
        at = np.array([home], np.uint64)
        move_over(snapshot.image, snapshot.memory[None], old_home, image, memory, at, self._call)
        return memory, home

    def _put(self, numbers: NDArray[np.int64], memory: Any, home: int, kept: Any = None) -> None:
        """Worlds that are copies of one space."""
        if not len(numbers):
            return
        image = self._images[numbers[0] % len(self._images)]
        at, words, size = self._at[numbers], image.fixups, image.size
        own = ffi.NULL if kept is None else ffi.from_buffer(kept)
        self._call.put(
            ffi.from_buffer(at),
            len(at),
            ffi.from_buffer(memory),
            home,
            size,
            ffi.from_buffer(words),
            len(words),
            own,
        )

    def _field(self, kind: Any, name: str) -> Any:
        """A field of WORLD, of all worlds, in place."""
        return self._view(kind.fields[name][1], (), (), kind.fields[name][0])

    def _view(
        self, first: int, shape: tuple[int, ...], strides: tuple[int, ...], dtype: Any = np.float64
    ) -> Any:
        """Numbers of all worlds, in place: from the byte `first` of each world on."""
        return np.ndarray((self.n, *shape), dtype, self._memory, first, (self.nbytes, *strides))

    def _table(self, image: Image, name: str) -> Any:
        """(n, rows): a table of all worlds, in place; it is one where a world is of this image."""
        kind = image.kinds[name]
        return self._view(image.offsets[name], (image.lengths[name],), (kind.itemsize,), kind)


class WorldSnapshot:
    """A world as it was: `Worlds.snapshot`."""

    def __init__(self, memory: Any, home: int, image: Image) -> None:
        self.memory, self.home, self.image = memory, home, image


@lru_cache(maxsize=1)
def _functions() -> Any:
    from . import alone

    kinds = {
        "step": "long long(*)(void *, void *, long long, long long, void *, double, long long, void *)",
        "read": "void(*)(void *, long long, long long, void *)",
        "write": "void(*)(void *, long long, long long, void *)",
        "put": "void(*)(void *, long long, void *, long long, long long, void *, long long, void *)",
        "enlarged": "void(*)(void *, long long, void *)",
    }
    return SimpleNamespace(
        **{name: ffi.cast(kind, getattr(alone, name).address) for name, kind in kinds.items()}
    )
