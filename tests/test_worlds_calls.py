"""Calls of many worlds: of none of them, from several threads of Python, on other systems."""

from __future__ import annotations

import os
import threading
import time

import numpy as np
import pytest

from test_worlds import different, worlds_of
from world_scenes import DT, pile


@pytest.mark.parametrize("none", [[], (), np.zeros(0), np.flatnonzero([0, 0])])
@pytest.mark.parametrize("make", [lambda: worlds_of(pile, 31)[1], lambda: different(n=6)[1]])
def test_of_none_there_is_nothing_to_do(make, none):
    worlds = make()
    before, snapshot = worlds.states, worlds.snapshot(0)
    worlds.reset(none)
    worlds.restore(snapshot, none)
    worlds.put(np.zeros((0, worlds.bodies, 6)), none)
    worlds.set_mass(np.zeros((0, worlds.bodies)), np.zeros((0, worlds.bodies)), none)
    assert worlds.step(DT, which=none).shape == (0, worlds.bodies, 6)
    assert worlds.step(DT, np.zeros((0, worlds.bodies, 3)), which=none).shape == (0, worlds.bodies, 6)
    assert len(worlds.contacts(none)) == 0
    np.testing.assert_array_equal(worlds.states, before)


def test_threads_where_the_system_does_not_say_which_processors(monkeypatch):
    """As on macOS and Windows: as many as there are."""
    monkeypatch.delattr(os, "sched_getaffinity", raising=False)
    assert worlds_of(pile, 32)[1].threads == os.cpu_count()


def test_one_call_at_a_time():
    """From another thread while one steps: refused, and the steps are as without it."""
    _, worlds = worlds_of(pile, 30, 4, threads=2)
    _, alone = worlds_of(pile, 30, 4)
    stepping = threading.Thread(target=worlds.step, args=(DT, None, 2000))  # some tenths of a second
    stepping.start()
    while not worlds._free.locked():
        time.sleep(1e-4)
    for call in (lambda: worlds.states, lambda: worlds.step(DT), worlds.reset, lambda: worlds.gravity):
        with pytest.raises(RuntimeError, match="one call of these worlds at a time"):
            call()
    stepping.join()
    np.testing.assert_array_equal(worlds.states, alone.step(DT, frames=2000))
