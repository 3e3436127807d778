"""How fast Newton's iteration of ``step`` goes: what a correction will leave."""

from __future__ import annotations

from rigidarea.compile.jit import kernel

PACE = 2.0  # the first correction of a step is taken to leave this many times what it left in the step before (after E.
# Hairer and G. Wanner, Solving Ordinary Differential Equations II, 2nd ed., section IV.8)
LOOK = 8  # but for one step in so many, which is looked at again


@kernel
def pace(buf, worst):  # type: ignore[no-untyped-def]
    """The part of the residual that the first correction will leave, by what it left in steps before; 1: not known,
    or nothing touches, and looking costs little.

    ``buf.pace``: the slowest of the last step in which that was seen, its first residual, contact regions, and the
    steps since.
    """
    if buf.counts[0] == 0 or buf.pace[1] == 0.0 or buf.pace[3] >= LOOK:
        return 1.0
    return PACE * buf.pace[0] * max(1.0, worst / buf.pace[1])
