"""What outlives a frame is one list (`store.LASTING`): copies and snapshots bring all of it, number for number."""

from __future__ import annotations

import pickle
import random

import numpy as np
import pymunk
import pytest

import rigidarea as ra
from rigidarea.chipmunk import memory, moved
from rigidarea.chipmunk.structs import address_of
from rigidarea.contact.space_record import LASTING, LASTING_STATE
from rigidarea.contact.tables import (
    ASKED,
    AWAKE,
    BOXED,
    COUNTED,
    FREE_PAIRS,
    FREE_REGIONS,
    MOVERS,
    USED_PAIRS,
    USED_REGIONS,
    Tables,
)
from test_snapshots import SCENES, attached, steps

#: What no frame starts from: made anew in each, or from the others (`table`).
SCRATCH = ("rows", "factors", "mobility", "islands", "queue", "members", "told", "table")
#: Of pairs, who Chipmunk's arbiter is; of shapes, where they are in lists and trees that are compared themselves.
OWN = {"bodies": memory._OWN, "shapes": {*memory._OWN, "asked"}, "pairs": {"arbiter"}, "near": {"a", "b"}}
#: Numbers of frames: a space goes on counting after a restore.
FRAMES = {
    *(("bodies", name) for name in ("stamp", "disturbed")),
    ("shapes", "seen"),
    *(("pairs", name) for name in ("stamp", "lasting", "waiting")),
}


def test_every_table_is_in_the_list_or_named_as_scratch():
    assert {*LASTING, "counters"}.isdisjoint(SCRATCH)
    assert {*LASTING, "counters", *SCRATCH} == set(Tables._fields)
    assert set(LASTING_STATE) <= set(moved.HEAD.names)


def lasting(space: pymunk.Space) -> dict[tuple[str, str], np.ndarray]:
    """All of it by table and field; bodies, shapes by their places in the space."""
    store = ra.attached(space)._store
    tables, counters = store.tables, store.tables.counters
    bodies = [store.row_of(address_of(body._body)) for body in space.bodies]
    shapes = [int(store.slots[shape._hashid]) for shape in space.shapes]
    body, shape = (
        np.array([rows.index(r) if r in rows else -1 for r in range(-1, size)])
        for rows, size in ((bodies, len(tables.bodies)), (shapes, len(tables.shapes)))
    )
    used = {"bodies": bodies, "shapes": shapes, "pairs": slice(counters[USED_PAIRS])}
    used |= {"regions": slice(counters[USED_REGIONS]), "near": slice(counters[BOXED]), "nodes": slice(None)}
    found = {
        (name, field): getattr(tables, name)[field][rows].copy()
        for name, rows in used.items()
        for field in getattr(tables, name).dtype.names
        if field not in OWN.get(name, ())
    }
    free = (found["pairs", "a"] < 0, tables.regions["stamp"][used["regions"]] < 0)
    for name, gone in zip(("pairs", "regions"), free):
        for field in getattr(tables, name).dtype.names:
            if (name, field) in found and field not in ("a", "stamp", "next"):
                found[name, field][gone] = 0
    found["pairs", "a"], found["pairs", "b"] = (shape[1 + found["pairs", x]] for x in "ab")
    leaf = (found["nodes", "left"] < 0) & (found["nodes", "owner"] >= 0)
    found["nodes", "owner"][leaf] = shape[1 + found["nodes", "owner"][leaf]]
    for name, count, place in (("movers", MOVERS, shape), ("asked", ASKED, shape), ("awake", AWAKE, body)):
        found[name, ""] = place[1 + getattr(tables, name)[: counters[count]]]
    kept = [i for i in memory._COUNTERS if i not in (COUNTED, FREE_PAIRS, FREE_REGIONS)]
    found["counters", ""], found["roots", ""] = counters[kept], tables.roots.copy()
    found["state", ""] = np.array([store.state[name][0] for name in LASTING_STATE if name != "frame"])
    return found


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("seed", range(5))
def test_a_pickle_has_all_that_outlives_a_frame(scene, seed):
    space, _ = attached(SCENES[scene], 4000 + seed)
    other = pickle.loads(pickle.dumps(space))
    copied = lasting(other)
    for name, values in lasting(space).items():
        np.testing.assert_array_equal(copied[name], values, str(name))
    assert ra.attached(other)._store.state["frame"] == ra.attached(space)._store.state["frame"]


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("seed", range(5))
def test_a_restored_space_has_all_that_outlives_a_frame(scene, seed):
    space, contact = attached(SCENES[scene], 4100 + seed)
    snapshot, then, frame = contact.snapshot(), lasting(space), contact._store.state["frame"].copy()
    steps(space, random.Random(seed).randrange(1, 100))
    contact.restore(snapshot)
    now, late = lasting(space), contact._store.state["frame"] - frame
    for name, values in then.items():
        moved_on = np.where(values >= 0, values + late, values) if name in FRAMES else values
        if name in FRAMES and name[0] == "pairs":  # free rows have none
            moved_on[then["pairs", "a"] < 0] = now[name][then["pairs", "a"] < 0]
        np.testing.assert_array_equal(now[name], moved_on, str(name))
