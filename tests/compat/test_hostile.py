"""Hostile calls, changes from within callbacks, a run without end; as commands: `compat fuzz`, `compat soak`."""

import pytest

from harness.hostile import fuzz
from harness.meddling import ACTIONS, CALLBACKS, meddle, run_kind
from harness.soak import soak


@pytest.mark.slow
def test_calls_with_hostile_values():
    rows = fuzz(400, seed=1)
    assert sum(row["calls"] for row in rows) == 400 and sum(row["refused"] for row in rows) > 100
    assert [text for row in rows for text in row["wrong"]] == []


@pytest.mark.slow
def test_fifty_thousand_calls():
    assert [text for row in fuzz(50_000) for text in row["wrong"]] == []


@pytest.mark.slow
@pytest.mark.parametrize("callback", ["begin", "post_solve", "velocity_func", "joint post_solve"])
@pytest.mark.parametrize("action", ["remove a body", "add an outline", "sensor", "detach, step"])
def test_changes_from_within_callbacks(callback, action):
    told = run_kind(callback, action, "area")
    assert told["error"] == "" and told["finite"] and told["calls"] > 0


@pytest.mark.slow
def test_every_change_from_within_every_callback():
    rows = meddle()
    assert len(rows) == len(CALLBACKS) * len(ACTIONS) >= 70
    assert [(row["callback"], row["action"], row["wrong"]) for row in rows if row["wrong"]] == []


@pytest.mark.slow
def test_memory_of_a_fountain_is_flat():
    """After a first tenth of the run no more than 2 MB are added: a numpy array or two that doubles once."""
    rows = soak(100_000)
    assert rows[-1]["resident_mb"] - rows[0]["resident_mb"] < 2
    assert 20 < rows[-1]["bodies"] < 60
