"""Contacts at rest that are stiffer than a step can follow: all their springs at the end of the step, at once."""

from __future__ import annotations

from typing import Any, NamedTuple

from .jit import kernel
from .region import Motion


class Arms(NamedTuple):
    """Arms of the normal force and of the friction about the two bodies' centres (length)."""

    arm_a: float
    lean_a: float
    arm_b: float
    lean_b: float


class Rest(NamedTuple):
    """Normal force, friction and couple of a contact at rest."""

    force: float
    friction: float
    couple: float


@kernel(inline="always")
def _capped(a11: float, a12: float, a22: float, b1: float, b2: float, friction: float) -> tuple[float, float]:
    """(force, friction) of the two equations a x = b, no pulling and none beyond Coulomb's cone."""
    det = a11 * a22 - a12 * a12
    force = (b1 * a22 - a12 * b2) / det
    tangential = (a11 * b2 - a12 * b1) / det
    if abs(tangential) > friction * force:
        slope = friction if tangential > 0.0 else -friction
        force = b1 / (a11 + slope * a12)
        tangential = slope * force
    if force <= 0.0:
        return 0.0, 0.0
    return force, tangential


@kernel
def implicit_rest(
    r: Any, a: Motion, b: Motion, elastic: float, c: float, ct: float, friction: float, coming: float,
    sliding: float, turning: float, arms: Arms, inverse: float, inverse_t: float, dt: float,
) -> Rest:  # fmt: skip
    """A contact at rest whose springs are taken at the end of the step: all three of its forces at once.

    Each is F0 + c v', v' the velocity at the end of the step, v* - h W x of all three x: so (1/c + h W) x = F0/c + v*
    with the 3 x 3 inverse mass W of the two bodies in closing, sliding and turning. One after the other they would
    undo each other, the more the stiffer.
    """
    ia = a.inverse_moment
    ib = b.inverse_moment
    a11 = 1.0 / c + dt * inverse
    a22 = 1.0 / ct + dt * inverse_t
    a12 = dt * (ia * arms.arm_a * arms.lean_a + ib * arms.arm_b * arms.lean_b) if friction > 0.0 else 0.0
    b1 = elastic / c + coming
    b2 = r.spring / ct + sliding if friction > 0.0 else 0.0
    bed = c * r.straight**3 / (12.0 * r.chord)
    if bed == 0.0:
        force, tangential = _capped(a11, a12, a22, b1, b2, friction)
        return Rest(force, tangential, 0.0)
    a13 = dt * (ia * arms.arm_a + ib * arms.arm_b)
    a23 = dt * (ia * arms.lean_a + ib * arms.lean_b) if friction > 0.0 else 0.0
    a33 = 1.0 / bed + dt * (ia + ib)
    force, tangential = _capped(
        a11 - a13 * a13 / a33, a12 - a13 * a23 / a33, a22 - a23 * a23 / a33,
        b1 - a13 * turning / a33, b2 - a23 * turning / a33, friction,
    )  # fmt: skip
    couple = (turning - a13 * force - a23 * tangential) / a33
    most = force * r.chord / 3.0  # the point of application may be L/6 off the middle, the resultant L/2
    if abs(couple) > most:
        couple = min(most, max(-most, couple))
        force, tangential = _capped(a11, a12, a22, b1 - a13 * couple, b2 - a23 * couple, friction)
        most = force * r.chord / 3.0
        couple = min(most, max(-most, couple))
    return Rest(force, tangential, couple)
