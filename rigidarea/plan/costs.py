"""What a frame costs, in processor time: a handful of constants, all measured in one run, all here.

Measured 2026-11-22 on a shared core of an Intel Xeon with 1 to 100 resting boxes and discs, 1 to 8 substeps, 5 to 20
sweeps: the model is within 15 % in the middle, 57 % at worst. A plan chooses by their ratios, so a faster machine
changes nothing; a faster solve does, and then they are to be measured again.
"""

from __future__ import annotations

from collections.abc import Iterable

#: A frame, whatever is in it (s).
FRAME_S = 1.2e-6
#: A body's share of what is done once a frame: Chipmunk's own pass, boxes, reports (s).
FRAME_BODY_S = 0.5e-6
#: A substep (s).
SUBSTEP_S = 0.2e-6
#: A body's share of a substep: drift, and the overlap that it has with what it lies on (s).
SUBSTEP_BODY_S = 0.7e-6
#: A sweep over one pair that touches (s).
SWEEP_PAIR_S = 0.07e-6
#: A step of Chipmunk's own, and a body's share of it at ten iterations (s).
NATIVE_STEP_S, NATIVE_STEP_BODY_S = 1.0e-6, 1.1e-6


def area_frame(bodies: int, pairs: int, steps: int, sweeps: int) -> float:
    """A frame of area contact (s): bodies that move, pairs that touch, substeps, sweeps a substep."""
    substep = SUBSTEP_S + SUBSTEP_BODY_S * bodies + SWEEP_PAIR_S * pairs * sweeps
    return FRAME_S + FRAME_BODY_S * bodies + steps * substep


def turns_frame(parts: Iterable[tuple[int, int, int]], sweeps: int) -> float:
    """A frame of area contact whose islands take substeps of their own (s).

    parts: (bodies, pairs, substeps) of each. sweeps: a substep.
    """
    return sum(area_frame(bodies, pairs, steps, sweeps) for bodies, pairs, steps in parts)


def native_frame(bodies: int, steps: int, sweeps: int) -> float:
    """A frame of Chipmunk's own response (s): bodies that move, steps a frame, iterations (`sweeps`) a step."""
    return steps * (NATIVE_STEP_S + NATIVE_STEP_BODY_S * bodies * (0.5 + 0.05 * sweeps))
