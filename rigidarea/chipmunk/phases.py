"""Where a frame's time goes: what `bench step` reads. Nobody looks at a clock unless `STATE.phases_at` says so."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..compile.jit import clock_gettime, kernel
from ..compile.raw_memory import array_at

#: Where the state record's array of times (s) has each phase's; the last is when the last one ended.
PHASES = ("watching", "pairs", "overlaps", "speculative rows", "iterations", "positions", "reporting")
WATCHING, PAIRS, OVERLAPS, SPECULATIVE, ITERATIONS, POSITIONS, REPORTING = range(7)
_PROCESSOR = 3  # CLOCK_THREAD_CPUTIME_ID: of the thread that steps


@kernel
def _now(s: Any) -> float:
    clock_gettime(_PROCESSOR, s.scratch_at)
    read = array_at(s.scratch_at, (2,), np.int64)
    return float(read[0] + 1e-9 * read[1])


@kernel
def start(s: Any) -> None:
    """What has been until now was not ours."""
    if s.phases_at != 0:
        array_at(s.phases_at, (len(PHASES) + 1,), np.float64)[len(PHASES)] = _now(s)


@kernel
def lap(s: Any, phase: int) -> None:
    """A phase ends: all since the last one ended was it."""
    if s.phases_at != 0:
        times = array_at(s.phases_at, (len(PHASES) + 1,), np.float64)
        now = _now(s)
        times[phase] += now - times[len(PHASES)]
        times[len(PHASES)] = now
