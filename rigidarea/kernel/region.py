"""What is known of one contact region: its record, the law it obeys, and the two bodies as it sees them."""

from __future__ import annotations

from typing import NamedTuple

from .memory import record

LAW_AREA, LAW_ENERGY = 0, 1
CHORD, NODAL = 0, 1

#: (w h)^2 above which a step h is too long to follow a contact of frequency w: its spring is then taken implicitly,
#: its impact as an impulse. (Symplectic Euler is stable up to 4, and in a stack up to 1.)
FOLLOWED = 0.25

#: One region, remembered while it lives. Also the record of what it did in the last step.
REGION = record(
    [
        ("stamp", "i8"),  # space step in which it was last there
        ("pair", "i4"),
        ("next", "i4"),  # next region of the pair, or of the free list; -1: none
        ("resting", "i4"),  # 0: impact, 1: rest
        ("opened", "i4"),  # 1 once the bodies have moved apart within this contact
        ("sudden", "i4"),  # 1: an impact too short for the step
        ("inside", "i4"),  # 1: put there, so deep at first touch that it has not come there by moving
        ("past", "i4"),  # 1: past the middle of a body, the direction is kept
        ("area", "f8"),  # (length^2)
        ("x", "f8"),  # point of application, world (length)
        ("y", "f8"),
        ("nx", "f8"),  # direction, A to B
        ("ny", "f8"),
        ("chord", "f8"),  # (length)
        ("force", "f8"),  # normal force, never negative (force)
        ("friction", "f8"),  # tangential force on B along t (force)
        ("couple", "f8"),  # moment on B of the resting pressure's damping (force length)
        ("spring", "f8"),  # tangential force of the friction spring (force)
        ("tangent_stiffness", "f8"),  # its stiffness when last loaded (force/length)
        ("damping", "f8"),  # a of F = k A (1 + a speed) (time/length)
        ("elastic", "f8"),  # what of the force is elastic (force)
        ("excess", "f8"),  # what is damping (force)
        ("work", "f8"),  # done on the spring while closing (force length)
        ("loss", "f8"),  # energy lost to damping while closing (force length)
        ("slowed", "f8"),  # closing speed that its force has taken while closing (length/time)
        ("lasted", "f8"),  # time since first touch was noticed, while closing
        ("late", "f8"),  # time from the middle of the step of first touch to first touch
        ("withheld", "f8"),  # fraction of the spring's force that is missing while opening
        ("depth", "f8"),  # its extent along n at first touch (length)
        ("beyond", "f8"),  # A's surface beyond the point of application, along n, then (length)
        ("straight", "f8"),  # longest straight stretch of both boundaries in it (length)
        ("crowd", "f8"),  # of the two bodies' sums of rate2 over their contacts the larger (1/time^2)
        ("curved", "i4"),  # 1: one of the two boundaries is a curve
        ("alone", "i4"),  # 1: between what cannot move and a body that nothing movable touches
        ("phase", "f8"),  # radians of natural motion since first touch
        ("first_speed", "f8"),  # closing speed at first touch (length/time)
        ("speed", "f8"),  # closing speed (length/time)
        ("rate2", "f8"),  # its natural frequency squared, on these two bodies alone (1/time^2)
        ("slip", "f8"),  # tangential speed of A relative to B (length/time)
    ],
)


class Law(NamedTuple):
    """What the user chose for every region of a space."""

    stiffness: float  # k (force/length^2: a pressure per unit depth of the plane, Eq. 5 and 6)
    law: int  # LAW_AREA or LAW_ENERGY
    length: float  # l of the energy law (length)
    direction: int  # CHORD or NODAL
    exponent: float  # q of Eq. 12, for NODAL
    rest_speed: float  # first touch slower than this: rest from the start (length/time)
    followed: float = FOLLOWED  # (w h)^2 up to which a step follows a contact; infinity: always


class Motion(NamedTuple):
    """A rigid body as a region sees it, world axes."""

    x: float  # centre of gravity (length)
    y: float
    vx: float  # (length/time)
    vy: float
    w: float  # (1/time)
    inverse_mass: float
    inverse_moment: float
    ax: float = 0.0  # what everything but this region does to it in this step (length/time^2)
    ay: float = 0.0
    aw: float = 0.0  # (1/time^2)


class Pull(NamedTuple):
    """Force and moment on B, about its centre; and the moment on A. A's force is the opposite."""

    fx: float
    fy: float
    moment_a: float
    moment_b: float
