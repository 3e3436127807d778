"""Time of runs: warm, on one core, interleaved, median of repeats.

What is timed is processor time of the one thread that steps: wall time on an idle core, and on a busy one not
lengthened by other programs, which would hit long runs and spare short ones.
"""

from __future__ import annotations

import contextlib
import gc
import os
import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

from .peers import Run, Settings, get_peer
from .scene import Array, Scene

SHORT_S = 1e-3
"""Time (s) below which a run is repeated at once."""


def current_core() -> int:
    """The core that this process is on now (Linux: field 39 of /proc/self/stat)."""
    return int(Path("/proc/self/stat").read_text().rpartition(")")[2].split()[36])


@contextlib.contextmanager
def one_core() -> Iterator[None]:
    """Keep this process on the core it is on, without garbage collection, for as long as the block lasts."""
    before = os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else None
    collecting = gc.isenabled()
    if before is not None:
        os.sched_setaffinity(0, {current_core()})
    gc.collect()
    gc.disable()
    try:
        yield
    finally:
        if collecting:
            gc.enable()
        if before is not None:
            os.sched_setaffinity(0, before)


class Stopwatch:
    """A run that adds up the processor time (s) of its advances in `seconds`."""

    def __init__(self, run: Run) -> None:
        self.run, self.steps, self.seconds = run, run.steps, 0.0

    def advance(self, frames: int) -> None:
        """As the run does."""
        self.seconds += spent(self.run.advance, frames)

    def state(self) -> Array:
        """Of the run."""
        return self.run.state()


def spent(call: Callable[..., object], *arguments: object) -> float:
    """Processor time (s) that a call takes."""
    started = time.thread_time()
    call(*arguments)
    return time.thread_time() - started


def exponent(sizes: Sequence[float], values: Sequence[float]) -> float:
    """Slope of log(value) over log(size), by least squares: value ∝ size^exponent."""
    return float(np.polyfit(np.log(sizes), np.log(values), 1)[0])


def median_times(jobs: Sequence[Callable[[], float]], repeats: int, patience_s: float = 1.0) -> list[float]:
    """The median over `repeats` rounds of what each job returns (s), every round running all jobs once.

    A drift of the machine then hits all alike. A job that took longer than `patience_s` is not repeated: its
    noise is small beside it.
    """
    times: list[list[float]] = [[] for _ in jobs]
    with one_core():
        for _ in range(repeats):
            for job, found in zip(jobs, times, strict=True):
                if not found or sum(found) < patience_s:
                    found.append(job())
    return [statistics.median(found) for found in times]


def scene_time(scene: Scene, peer: str, settings: Settings) -> float:
    """Time (s) of the scene's whole duration, built anew, set-up not counted.

    Runs below a millisecond are short beside the noise of a clock interrupt: the median of five of them.
    """
    found: list[float] = []
    while not found or (found[0] < SHORT_S and len(found) < 5):
        found.append(spent(get_peer(peer).build(scene, settings).advance, scene.frames))
    return statistics.median(found)
