"""Large sweeps on a `concurrent.futures` executor: results written as they come, resumed by the same command.

Local processes by default; with the address of a scheduler, a Dask cluster through its own
`Client.get_executor()` (which runs a task again when the worker that had it dies).
"""

from __future__ import annotations

import json
import multiprocessing
import os
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, Future, ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ..report import Progress
from .records import Row, append_rows, read_rows

Task = dict[str, Any]
"""Arguments of one call, plain values only: they are the key under which its result is kept."""


def key(task: Task) -> str:
    """The task as text, independent of the order of its keys."""
    return json.dumps(task, sort_keys=True)


@contextmanager
def open_executor(scheduler: str | None = None, workers: int | None = None) -> Iterator[Executor]:
    """A Dask cluster at `scheduler` ("tcp://host:port"), or `workers` local processes (default: one a core)."""
    if scheduler:
        from dask.distributed import Client

        with Client(scheduler) as client:
            executor = client.get_executor(retries=3)
            yield executor
            executor.shutdown()
        return
    context = multiprocessing.get_context("spawn")  # a fork would copy compiled code and locks
    others = set(multiprocessing.active_children())
    with ProcessPoolExecutor(
        workers or os.cpu_count(), mp_context=context, initializer=_leave_interrupts_to_the_parent
    ) as executor:
        try:
            yield executor
        except KeyboardInterrupt:  # nobody waits for what has been begun
            for worker in set(multiprocessing.active_children()) - others:
                worker.terminate()
            raise


def _leave_interrupts_to_the_parent() -> None:
    """In a worker: Ctrl-C goes to all processes of a terminal, but one of them is enough to say that it was."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


@contextmanager
def _interrupts_wait() -> Iterator[None]:
    """Ctrl-C comes at the end, and to no worker that is started meanwhile (blocked, until it leaves them to us)."""
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def run_tasks(
    function: Callable[..., Row],
    tasks: Sequence[Task],
    store: Path | None,
    scheduler: str | None = None,
    workers: int | None = None,
    title: str = "tasks",
) -> list[Row]:
    """Results `function(**task)` for every task, in the order of the tasks.

    store: JSON-lines file that gets each result as it comes; tasks found there are not run again. None keeps
        nothing.
    workers: local processes; 0 runs everything in this process.
    An exception in a task is raised here after the results that were ready have been written.
    """
    known: dict[str, Row] = {}
    if store is not None:
        known = {key(row["task"]): row["result"] for row in read_rows(store)}
    wanted = {key(task): task for task in tasks}
    missing = [task for text, task in wanted.items() if text not in known]
    progress = Progress(title, len(wanted))
    if len(wanted) > len(missing):
        progress.step("already done", len(wanted) - len(missing))

    def keep(task: Task, result: Row) -> None:
        known[key(task)] = result
        if store is not None:
            append_rows(store, [{"task": task, "result": result}])
        progress.step(" ".join(str(value) for value in task.values())[:60])

    if missing and workers == 0 and not scheduler:
        for task in missing:
            keep(task, function(**task))
    elif missing:
        with open_executor(scheduler, workers) as executor:
            with _interrupts_wait():
                futures: dict[Future[Row], Task] = {
                    executor.submit(function, **task): task for task in missing
                }
            try:
                for future in as_completed(futures):  # Dask's are futures of `concurrent.futures` as well
                    keep(futures[future], future.result())
            except BaseException as error:
                # an interrupt, or one that failed: what others have finished is kept. At an interrupt our own workers
                # are ended, which tells all futures so: one that is cancelled cannot be told
                stopped = isinstance(error, KeyboardInterrupt) and not scheduler
                for future, task in futures.items():
                    off = not stopped and future.cancel()
                    if not off and future.done() and future.exception() is None:
                        if key(task) not in known:
                            keep(task, future.result())
                raise
    return [known[key(task)] for task in tasks]
