"""As many substeps as a tolerance needs: runs of a frame, each of twice as many as the one before, compared.

The error of n substeps falls as 1/n^2 while nothing new happens, so that two runs, of n and 2n, differ by three times
the error of the finer one (Richardson). Where something does happen it falls as 1/n, and the difference is the error
itself: that is what is compared.
"""

from __future__ import annotations

import math
from typing import Any

from ..compile.jit import kernel
from ..contact.constants import MOST_SUBSTEPS
from ..contact.space_record import keep_tables, load_tables
from ..contact.tables import AWAKE, DRIFTS
from .record import floats
from .substep import substeps
from .undo import begin_again


@kernel
def substeps_to_tolerance(s: Any, space: int, dt: float, n: int) -> int:
    """A frame of n substeps, or of 2n, 4n, ...: until places differ by no more than the tolerance from the run before.

    Returns how many the last run took; 0: there was no room.
    """
    if not keep_tables(s) or not substeps(s, space, dt, n):
        return 0
    while 2 * n <= MOST_SUBSTEPS:
        _see(s)
        begin_again(s)
        n *= 2
        s.contacts = 0
        if not substeps(s, space, dt, n):
            return 0
        if _difference(s) <= s.tolerance:
            break
    return n


@kernel
def _difference(s: Any) -> float:
    """How far the places of this run and of the one before (noted in `seen`) are apart, over the smallest extents."""
    tables = load_tables(s)
    most = 0.0
    for k in range(tables.counters[AWAKE]):
        i = tables.awake[k]
        body = tables.bodies[i]
        if body.kind == DRIFTS and body.extent > 0.0:
            seen = floats(s.seen_at + 24 * i, 3)
            dx = body.x - seen[0]
            dy = body.y - seen[1]
            most = max(most, math.sqrt(dx * dx + dy * dy) / body.extent + abs(body.angle - seen[2]))
    return most


@kernel
def _see(s: Any) -> None:
    """Note where this run has taken the bodies."""
    tables = load_tables(s)
    for k in range(tables.counters[AWAKE]):
        i = tables.awake[k]
        body = tables.bodies[i]
        seen = floats(s.seen_at + 24 * i, 3)
        seen[0] = body.x
        seen[1] = body.y
        seen[2] = body.angle
