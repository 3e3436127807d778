"""Sweeps: resumed where they were stopped, in the order of the tasks, on any executor."""

import json
import os
import subprocess
import sys
import time

import pytest

from rigidarea.report import plain
from rigidarea.study.atlas import get_map
from rigidarea.study.records import append_rows, read_rows
from rigidarea.study.sweep import key, run_tasks


def square(x, log):
    """A task that leaves a trace of having run."""
    with open(log, "a") as file:
        file.write(f"{x}\n")
    return {"y": x * x}


def fails_at(x, bad):
    """A task that fails for one argument."""
    if x == bad:
        raise ValueError(f"x must not be {bad}, got {x}")
    return {"y": x}


def slow_pid(x):
    """Which process did it, slowly."""
    time.sleep(0.3)
    return {"y": x * x, "pid": os.getpid()}


def test_what_is_of_other_code_is_made_anew(tmp_path):
    """A store that is older than the package was left by other code."""
    log, store = str(tmp_path / "log"), tmp_path / "rows.jsonl"
    tasks = [{"x": 3, "log": log}]
    run_tasks(square, tasks, store, workers=0)
    os.utime(store, (0, 0))
    assert [row["y"] for row in run_tasks(square, tasks, store, workers=0)] == [9]
    assert (tmp_path / "log").read_text().split() == ["3", "3"]
    assert len(read_rows(store)) == 1


def test_resumes(tmp_path):
    """Results found are not computed again; a line cut short is computed again; order is that of the
    tasks.
    """
    log, store = str(tmp_path / "log"), tmp_path / "rows.jsonl"
    tasks = [{"x": x, "log": log} for x in (3, 1, 2)]
    assert [row["y"] for row in run_tasks(square, tasks[:2], store, workers=0)] == [9, 1]
    text = store.read_text()
    store.write_text(text[: len(text) - 5])  # the kill came while the second row was written
    assert [row["y"] for row in run_tasks(square, tasks, store, workers=0)] == [9, 1, 4]
    assert (tmp_path / "log").read_text().split() == ["3", "1", "1", "2"]
    assert len(read_rows(store)) == 3


def test_failure_keeps_what_was_done(tmp_path):
    """The exception comes through, and the same command goes on from there."""
    store = tmp_path / "rows.jsonl"
    tasks = [{"x": x, "bad": 2} for x in (1, 2, 3)]
    with pytest.raises(ValueError, match="got 2"):
        run_tasks(fails_at, tasks, store, workers=0)
    assert [row["result"] for row in read_rows(store)] == [{"y": 1}]


def test_local_processes(tmp_path):
    """Two processes share the work; results are written under the tasks' keys."""
    store = tmp_path / "rows.jsonl"
    rows = run_tasks(slow_pid, [{"x": x} for x in range(4)], store, workers=2)
    assert [row["y"] for row in rows] == [0, 1, 4, 9]
    assert os.getpid() not in {row["pid"] for row in rows}
    assert {key(row["task"]) for row in read_rows(store)} == {key({"x": x}) for x in range(4)}


@pytest.mark.slow
def test_killed_command_is_resumed(tmp_path):
    """`atlas` killed halfway: the same command keeps every finished row as it was and adds the others."""
    command = [sys.executable, "-m", "rigidarea", "atlas", "--map", "seams", "--quick", "--workers", "0"]
    command += ["--out", str(tmp_path)]
    store = tmp_path / "atlas.jsonl"
    running = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    started = time.monotonic()
    while len(read_rows(store)) < 5 and time.monotonic() - started < 300:  # the first run may have to compile
        time.sleep(0.01)
    running.kill()
    running.wait()
    before = read_rows(store)
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    after = read_rows(store)
    seams = get_map("seams")
    points = len(seams.variants) * len(seams.x.quick) * len(seams.y.quick)
    assert 5 <= len(before) < len(after) == points
    assert after[: len(before)] == before
    assert len(json.loads((tmp_path / "atlas.json").read_text())["results"]) == points


@pytest.mark.slow
def test_dask_cluster_loses_a_worker(tmp_path):
    """Two workers, one killed halfway: every result comes all the same, and is right."""
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, host="127.0.0.1"
    ) as cluster:
        from threading import Timer

        victim = next(iter(cluster.workers.values()))
        killer = Timer(1.5, lambda: os.kill(victim.pid, 9))
        killer.start()
        tasks = [{"x": x} for x in range(20)]
        rows = run_tasks(slow_pid, tasks, tmp_path / "rows.jsonl", scheduler=cluster.scheduler_address)
        killer.join()
    assert [row["y"] for row in rows] == [x * x for x in range(20)]
    assert len({row["pid"] for row in rows}) >= 2


def test_plain_json(tmp_path):
    """What JSON cannot say becomes null; tuples become lists; rows survive a round trip."""
    assert plain({"a": float("inf"), "b": (1, 2.5)}) == {"a": None, "b": [1, 2.5]}
    json.dumps(plain({"x": float("nan")}), allow_nan=False)
    append_rows(tmp_path / "x.jsonl", [{"a": 1}])
    append_rows(tmp_path / "x.jsonl", [{"a": 2}])
    assert [row["a"] for row in read_rows(tmp_path / "x.jsonl")] == [1, 2]
