"""Energy stored in contacts: what the regions' springs would give back."""

from __future__ import annotations

import numpy as np
import pymunk

from .kernel.bed import stored
from .store import Store, load_law


def stored_energy(store: Store, shapes: dict[int, pymunk.Shape], stamp: int) -> float:
    """Elastic energy of all regions of step `stamp`, friction springs included (force length)."""
    regions = store.tables.regions
    live = np.unique(regions["pair"][regions["stamp"] == stamp])
    rows = np.empty((len(live), 2), np.int64)
    poses = np.empty((len(live), 8))
    for i, pair in enumerate(store.tables.pairs[live]):
        for side, key in enumerate(("shape_a", "shape_b")):
            body = shapes[int(pair[key])].body
            assert body is not None
            rows[i, side] = store.slots[pair[key]]
            poses[i, 4 * side : 4 * side + 4] = (*body.position, *body.rotation_vector)
    return float(stored(store.pool, store.tables, store.work, load_law(store.state[0]), live, rows, poses))
