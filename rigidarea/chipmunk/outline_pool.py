"""Outlines in the pool of one attached space: packed when they come, dropped in time when no shape has them.

Each change is a transaction of the tables' (`arrays.Store.publish`).
"""

from __future__ import annotations

import copy
from typing import Any

import numpy as np

from ..geometry.overlap import fits, new_work
from ..geometry.pool import HasRings, Pool, pack
from .arrays import Store, longer, power_above
from .chipmunk_outlines import Forms, enter_form, read_shapes

#: Crossings for which there is room from the start, where the largest outline has many points: more come with use.
MOST_CROSSINGS = 4096


def _make_room(store: Store, points: int, rings: int, boxes: int, heads: int, raw: int) -> None:
    """Room for so much more in the pool."""
    need = store.forms.fill + np.array((points, rings, boxes, heads, raw))

    def enlarged(array: np.ndarray, which: int) -> np.ndarray:
        n = int(need[which])
        return array if n <= len(array) else longer(array, max(n, 2 * len(array)))

    pool, forms, new = store.pool, store.forms, copy.copy(store)
    new.pool = Pool._make(map(enlarged, pool, (0, 0, 0, 1, 2, 0, 3)))
    new.forms = Forms._make([*map(enlarged, forms[:5], (3, 3, 3, 3, 4)), *forms[5:]])
    heads = len(new.forms.users)
    if 2 * heads > len(forms.table):
        new.forms = new.forms._replace(table=np.full(power_above(4 * heads), -1, np.int32))
        for h in np.flatnonzero(forms.span[: forms.fill[3], 1]):
            enter_form(new.forms, int(h))
    store.publish(new)


def enter_outline(store: Store, outline: HasRings, extent: float) -> int:
    """The outline's number in the pool; packed the first time it is seen, its mirror behind it.

    extent: its smallest extent (length).
    """
    found = store._outlines.get(id(outline))
    if found is not None:
        return found[0]
    one = pack([outline])
    _make_room(store, len(one.points), len(one.rings), len(one.boxes), 1, 0)
    pool, (p, r, b, h, _) = store.pool, (int(n) for n in store.forms.fill)
    pool.points[p : p + len(one.points)] = one.points
    pool.arcs[p : p + len(one.points)] = one.arcs
    pool.following[p : p + len(one.points)] = one.following + p
    pool.ring_of[p : p + len(one.points)] = one.ring_of + r
    pool.rings[r : r + len(one.rings)] = one.rings + p
    pool.boxes[b : b + len(one.boxes)] = one.boxes
    pool.heads[h] = one.heads[0]
    pool.heads[h]["point"] += p
    pool.heads[h]["ring"] += r
    pool.heads[h]["box"] += b
    store.forms.fill[:4] += len(one.points), len(one.rings), len(one.boxes), 1
    left, bottom, right, top = outline.bounds
    store.forms.extent[h] = extent, 0.5 * (right - left), 0.5 * (top - bottom)
    store.forms.mirror[h], store.forms.users[h], store.forms.span[h, 1] = -1, 0, 0
    _note_most(store, len(one.points), len(one.rings))
    store._outlines[id(outline)] = h, outline
    return h


def _note_most(store: Store, points: int, rings: int) -> None:
    """There is an outline of so many points and rings: room for two of them to meet."""
    most = (max(store._most[0], points), max(store._most[1], rings))
    crossings = max(len(store.work.cross), min(4 * most[0], MOST_CROSSINGS))
    new = copy.copy(store)
    new._most = most
    if crossings > len(store.work.cross) or not fits(store.work, 2 * most[0], 2 * most[1]):
        new.work = new_work(2 * most[0], crossings, 2 * most[1])
        store.publish(new)
    else:
        store._most = most


def read_outlines(store: Store, addresses: int, heads: int, n: int) -> int:
    """Outlines of n of Chipmunk's own shapes (`read_shapes`). Which has no area; -1: all have."""
    done, start = 0, int(store.forms.fill[3])
    while done < n:
        done, why = read_shapes(store.at, addresses, heads, done, n)
        if why < 0:
            return done
        if why > 0:
            more = n - done + why
            _make_room(store, 8 * more, 2 * more, 32 * more, 2 * more, 10 * more)
    if store.forms.fill[3] > start:
        _note_most(store, int(store.pool.heads["count"][start : store.forms.fill[3]].max()), 1)
    return -1


def drop_unused_outlines(store: Store) -> None:
    """Outlines that no shape has go, in time."""
    n = int(store.forms.fill[3])
    if n <= 2 * store._used + 64:
        return
    used = np.flatnonzero(store.forms.users[:n] > 0)
    store._used = max(len(used), (n - 64) // 2)  # asked again when there are many more
    if n <= 2 * len(used) + 64:
        return
    store._used = len(used)
    old, forms, new = store.pool, store.forms, copy.copy(store)
    renumbered = np.full(n + 1, -1, np.int32)  # the last for "none"
    renumbered[used] = np.arange(len(used))
    heads, span = old.heads[used], forms.span[used]
    points, rings, boxes, raws = heads["count"], heads["rings"], 2 * heads["leaves"], span[:, 1].copy()
    take = [_ranges(heads["point"], points), _ranges(heads["ring"], rings), _ranges(heads["box"], boxes)]
    shift = [
        _starts(points) - heads["point"],
        _starts(rings) - heads["ring"],
        _starts(boxes) - heads["box"],
    ]
    raw = forms.raw[_ranges(span[:, 0], raws)]
    span[:, 0] = _starts(raws)
    following = old.following[take[0]] + np.repeat(shift[0], points)
    ring_of = old.ring_of[take[0]] + np.repeat(shift[1], points)
    ends = old.rings[take[1]] + np.repeat(shift[0], rings)[:, None]
    for name, more in zip(("point", "ring", "box"), shift):
        heads[name] += more
    kept = old.points[take[0]], following, ring_of, ends, old.boxes[take[2]], old.arcs[take[0]], heads
    new.pool = Pool._make(map(_filled, old, kept))
    sums = np.array((points.sum(), rings.sum(), boxes.sum(), len(used), raws.sum()), np.int64)
    mirror = renumbered[forms.mirror[used]]
    told = forms.extent[used], mirror, forms.users[used], span, raw
    new.forms = Forms._make([*map(_filled, forms[:5], told), np.full_like(forms.table, -1), sums])
    for h in np.flatnonzero(raws):
        enter_form(new.forms, int(h))
    outlines = [(int(renumbered[h]), outline) for h, outline in store._outlines.values()]
    new._outlines = {id(outline): (h, outline) for h, outline in outlines if h >= 0}
    shapes = store.tables.shapes.copy()
    for name in ("outline", "mirror"):
        shapes[name] = renumbered[shapes[name]]
    new.tables = store.tables._replace(shapes=shapes)
    store.publish(new)


def _filled(array: np.ndarray, values: np.ndarray) -> Any:
    """An array as long as this one that begins with these values."""
    new = np.zeros(array.shape, array.dtype)
    new[: len(values)] = values
    return new


def _starts(counts: np.ndarray) -> np.ndarray:
    """Where ranges of these lengths begin, one behind the other."""
    return np.cumsum(counts) - counts


def _ranges(first: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """The numbers of ranges that begin at `first`, one behind the other."""
    return np.repeat(first - _starts(counts), counts) + np.arange(counts.sum())
