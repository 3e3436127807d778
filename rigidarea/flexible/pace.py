"""How fast Newton's iteration of ``step`` goes: what a correction will leave."""

from __future__ import annotations

from rigidarea.compile.jit import kernel

PACE = 2.0  # the first correction of a step is taken to leave this many times what it left in the step before (after E.
# Hairer and G. Wanner, Solving Ordinary Differential Equations II, 2nd ed., section IV.8)
WHOLE = 32.0  # steps of the whole tangent, before the other is tried again
LOOK = 8  # but for one step in so many, which is looked at again


@kernel
def pace(buf, worst):  # type: ignore[no-untyped-def]
    """The part of the residual that the first correction will leave, by what it left in steps before; 1: not known,
    or nothing touches, and looking costs little.

    ``buf.pace``: the slowest of the last step in which that was seen, its first residual, contact regions, the
    steps since, and those left of ``whole_tangent``.
    """
    if buf.counts[0] == 0 or buf.pace[1] == 0.0 or buf.pace[3] >= LOOK:
        return 1.0
    return PACE * buf.pace[0] * max(1.0, worst / buf.pace[1])


@kernel
def whole_tangent(buf):  # type: ignore[no-untyped-def]
    """Whether a step begins with the whole tangent of the loads, or leaves out what moves them across.

    Where bodies are stiff beside their contacts that is as good, and cheaper (gears, by a fifth to a quarter of a run).
    Where it left too much the whole tangent is taken for so many steps (``buf.pace[4]``), and then the other is tried
    again.
    """
    if buf.pace[4] == 0.0:
        return False
    buf.pace[4] -= 1.0
    if buf.pace[4] == 0.0:
        buf.pace[1] = 0.0  # how much the other leaves is not known
    return True
