"""What a frame costs, in processor time: a handful of constants, all measured in one run, all here.

Least squares over 1 to 100 boxes, lying on a floor and in free flight, 1 and 8 substeps, 5 and 20 sweeps, on a shared
core of an Intel Xeon: within 12 % in the middle, 57 % at worst. A plan chooses by their ratios, so a faster machine
changes nothing; a faster solve does, and then they are to be measured again.
"""

from __future__ import annotations

from collections.abc import Iterable

#: A frame, whatever is in it (s).
FRAME_S = 4.7e-6
#: A body's share of what is done once a frame: Chipmunk's own pass, boxes, reports (s).
FRAME_BODY_S = 0.2e-6
#: A substep (s).
SUBSTEP_S = 0.2e-6
#: A body's share of a substep: drift (s).
SUBSTEP_BODY_S = 0.03e-6
#: The overlap of one pair that touches, a substep (s).
SUBSTEP_PAIR_S = 0.8e-6
#: A sweep over one pair that touches (s).
SWEEP_PAIR_S = 0.02e-6
#: A corner's share of a substep, of outlines of their own (s).
SUBSTEP_POINT_S = 0.003e-6
#: A body's share of a copy of a space, attached (s).
COPY_BODY_S = 60e-6
#: A body's share, of a space whose islands are sampled, of what is done beside the runs (s).
PART_BODY_S = 30e-6
#: A body's share of a copy's first frame, beyond the others' (s): its broad phase is built.
START_BODY_S = 12e-6
#: What a pair that touches does, read (s).
NOTE_PAIR_S = 35e-6
#: Places of a copy read, and the call that steps it (s).
SAMPLE_S = 12e-6
#: A step of Chipmunk's own, and a body's share of it; a pair's that touches, and a sweep's over it (s).
NATIVE_STEP_S, NATIVE_STEP_BODY_S = 0.5e-6, 0.08e-6
NATIVE_PAIR_S, NATIVE_SWEEP_PAIR_S = 0.3e-6, 0.05e-6


def area_frame(parts: Iterable[tuple[float, float, int]], sweeps: int, points: int = 0) -> float:
    """A frame of area contact whose islands take substeps of their own (s).

    parts: (bodies that move, pairs that touch, substeps) of each. sweeps: a substep. points: corners of outlines of
    their own.
    """
    pair = SUBSTEP_PAIR_S + SWEEP_PAIR_S * sweeps
    total, most = FRAME_S, 0
    for bodies, pairs, steps in parts:
        total += FRAME_BODY_S * bodies + steps * (SUBSTEP_BODY_S * bodies + pair * pairs)
        most = max(most, steps)
    return total + most * (SUBSTEP_S + SUBSTEP_POINT_S * points)


def native_frame(bodies: int, pairs: float, steps: int, sweeps: int) -> float:
    """A frame of Chipmunk's own response (s): bodies that move, pairs that touch, steps a frame, sweeps a step."""
    pair = NATIVE_PAIR_S + NATIVE_SWEEP_PAIR_S * sweeps
    return steps * (NATIVE_STEP_S + NATIVE_STEP_BODY_S * bodies + pair * pairs)
