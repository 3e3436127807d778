"""How fast Newton's iteration of ``step`` goes: what a correction will leave, and how much of the next to take."""

from __future__ import annotations

from rigidarea.compile.jit import kernel

PACE = 2.0  # the first correction of a step is taken to leave this many times what it left in the step before (after E.
# Hairer and G. Wanner, Solving Ordinary Differential Equations II, 2nd ed., section IV.8)
LOOK = 8  # but for one step in so many, which is looked at again
ALIKE = 0.9  # cosine, squared, of two changes that go on by a factor
SWAY = 0.8  # the largest factor of an error that creeps on: beyond it, 1 / (1 - r) is mostly the error of r


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


@kernel
def part_of_next(buf, full):  # type: ignore[no-untyped-def]
    """The part of the next correction to take: 1, but where the last two, full ones, left the same error times r.

    The tangent leaves out that directions turn with the loads. Where contacts are far stiffer than bodies the error
    then swings to and fro by a factor r near -1, or below, while all other errors go at once. 1 / (1 - r) of a
    correction takes this one error off, after A. C. Aitken (Proc. R. Soc. Edinburgh 46, 1926). ``buf.sway``
    (2, REGIONS): the regions' forces in the evaluation before, and how they changed in it; full: full corrections
    in a row with as many regions.
    """
    before, change = buf.sway[0], buf.sway[1]
    along = old = new = 0.0
    for i in range(buf.counts[0]):
        force = buf.regions[i, 1]
        d = force - before[i]
        along += d * change[i]
        old += change[i] * change[i]
        new += d * d
        before[i], change[i] = force, d
    if full < 2 or along * along <= ALIKE * old * new:
        return 1.0
    return 1.0 / (1.0 - min(along / old, SWAY))
