"""The external Geneva drive: a driver's pin indexes a slotted wheel, a locking disc holds it in between.

With n slots and centre distance C the crank radius is r = C sin(π/n) (the paper's Eq. 36): the pin then
enters and leaves along a slot, without a jerk in velocity. It does so at the distance C cos(π/n) from the
wheel's centre, so the straight walls of a slot end there, on the circle of radius sqrt((C cos(π/n))² +
(b/2)²), b the slot's width.
"""

from __future__ import annotations

import math
from functools import partial
from typing import NamedTuple

import numpy as np

from ..outline import DEFAULT_TOLERANCE, Outline, arc_points, circle_points, positive


class Geneva(NamedTuple):
    """The parts of an external Geneva drive, from `geneva`.

    Pin and locking disc turn together, on one body, about the driver's centre; the wheel turns about its
    own, at `center_distance` from it in direction x. At crank angle 0 the pin is on the line of centres,
    deepest in the wheel's slot 0, and `wheel_angle` tells where the wheel stands then and at any other
    crank angle.
    """

    wheel: Outline
    """The driven wheel in its own coordinates, slot 0 along +x."""
    pin: Outline
    """The pin in the driver's coordinates, on the x axis at `crank_radius`."""
    locking_disc: Outline
    """The locking disc with its relief, in the driver's coordinates."""
    slots: int
    center_distance: float
    """Length."""
    crank_radius: float
    """Length."""
    slot_width: float
    """Length."""
    locking_radius: float
    """Radius of the locking disc (length)."""
    entry_angle: float
    """The pin is in a slot for crank angles within ± this (radians): π/2 − π/n."""

    def wheel_angle(self, crank_angle: float) -> float:
        """Angle of the wheel (radians) for a crank angle, without play; continuous over any number of turns.

        In engagement the paper's Eq. 38, tan φ = r sin θ/(C − r cos θ), taken from the wheel's position π
        at θ = 0.
        """
        turns = round(crank_angle / (2 * math.pi))
        theta = crank_angle - turns * 2 * math.pi
        theta = max(-self.entry_angle, min(self.entry_angle, theta))  # locked outside
        r, c = self.crank_radius, self.center_distance
        phi = math.atan2(r * math.sin(theta), c - r * math.cos(theta))
        return math.pi - phi - turns * 2 * math.pi / self.slots


def geneva(
    slots: int = 6,
    center_distance: float = 0.05,
    pin_diameter: float = 0.008,
    clearance: float = 1e-5,
    *,
    locking_radius: float | None = None,
    locking_clearance: float | None = None,
    bore: float = 0.0,
    tolerance: float | None = None,
) -> Geneva:
    """An external Geneva drive with one pin; the defaults are the paper's (Section 3.4, Table 3).

    slots: 3 … 12. center_distance, pin_diameter: length. clearance: slot width less pin diameter (length).
    locking_radius: of the driver's disc (length), default 0.8 of the r − b/2 that would reach the slots'
        mouths.
    locking_clearance: radial play of the wheel's locking arcs (length), default `clearance`.
    bore: radius of the wheel's central hole (length), 0 for none.
    tolerance: largest sagitta (length), default a tenth of the clearance, at most a thousandth of the pin's
        radius: a 64-sided pin of 8 mm is off by the whole clearance of 0.01 mm.

    Raises ValueError, with the number concerned, for parameters out of range, slots that run into each
    other, into the bore or past the wheel's centre, locking arcs that cut slots, and a driver's disc that
    the wheel leaves no room for.
    """
    if not (isinstance(slots, int | np.integer) and 3 <= slots <= 12):
        raise ValueError(f"slots must be a whole number from 3 to 12, got {slots!r}")
    c, pin_radius = positive(center_distance, "center_distance"), positive(pin_diameter, "pin_diameter") / 2
    if locking_clearance is None:
        locking_clearance = clearance
    for name, value in (("clearance", clearance), ("locking_clearance", locking_clearance), ("bore", bore)):
        if not (math.isfinite(value) and value >= 0):
            raise ValueError(f"{name} must be finite and not negative, got {value!r}")
    if tolerance is None:
        tolerance = DEFAULT_TOLERANCE * pin_radius
        tolerance = min(tolerance, clearance / 10) if clearance > 0 else tolerance
    positive(tolerance, "tolerance")

    half_index = math.pi / slots
    r, mouth = c * math.sin(half_index), c * math.cos(half_index)
    half_width = pin_radius + clearance / 2
    wheel_radius = math.hypot(mouth, half_width)
    bottom = c - r - clearance  # where the slot's round bottom has its centre: the pin turns back at C − r
    if bottom <= 0 or bottom * math.sin(half_index) <= half_width:
        raise ValueError(
            f"slots must be apart at their bottoms: pin_diameter + clearance must be below "
            f"{2 * max(bottom, 0) * math.sin(half_index):.6g} for {slots} slots at {c:.6g}, "
            f"got {2 * half_width:.6g}"
        )
    if bore >= bottom - half_width:
        raise ValueError(f"bore must end before the slots, below {bottom - half_width:.6g}, got {bore!r}")

    reach = r - half_width  # from the driver's centre, abreast of the slot's mouth, to the mouth's corner
    if locking_radius is None:
        locking_radius = 0.8 * reach
    lowest, highest = c - wheel_radius, reach - locking_clearance
    if not lowest < locking_radius < highest:
        raise ValueError(
            f"locking_radius must lie between {lowest:.6g} (to reach into the wheel) and {highest:.6g} "
            f"(to leave its slots whole), got {locking_radius:.6g}"
        )
    # no part of the wheel ever comes nearer to the driver's axis
    relief = c - wheel_radius - locking_clearance
    if relief <= 0:
        raise ValueError(
            f"the wheel, of radius {wheel_radius:.6g}, must leave the driver's axis free at {c:.6g}"
        )

    # the wheel: slot, rim, locking arc, rim, and so on
    arc_radius = locking_radius + locking_clearance
    # of the arc's ends from its middle, seen from the wheel
    gamma = _meeting_angle(wheel_radius, c, arc_radius)
    delta = _meeting_angle(arc_radius, c, wheel_radius)  # the same, seen from the driver
    mouth_angle = math.asin(half_width / wheel_radius)
    parts = []
    for k in range(slots):
        slot, lock = 2 * half_index * k, 2 * half_index * k + half_index
        sweep = half_index - gamma - mouth_angle
        x, y = math.cos(slot), math.sin(slot)
        parts += [
            arc_points((0, 0), wheel_radius, slot - mouth_angle - sweep, sweep, tolerance),
            arc_points((bottom * x, bottom * y), half_width, slot - math.pi / 2, -math.pi, tolerance),
            arc_points((0, 0), wheel_radius, slot + mouth_angle, sweep, tolerance)[:-1],
            arc_points(
                (c * math.cos(lock), c * math.sin(lock)),
                arc_radius,
                lock + math.pi + delta,
                -2 * delta,
                tolerance,
            )[:-1],
        ]
    holes = [circle_points((0, 0), bore, tolerance)] if bore > 0 else []
    wheel = np.concatenate(parts)

    # the disc: full outside the entry angles, relieved within
    entry = math.pi / 2 - half_index
    disc = np.concatenate(
        (
            arc_points((0, 0), locking_radius, entry, 2 * (math.pi - entry), tolerance),
            arc_points((0, 0), relief, -entry, 2 * entry, tolerance),
        )
    )
    again = partial(_part, slots, center_distance, pin_diameter, clearance)
    again = partial(again, locking_radius=locking_radius, locking_clearance=locking_clearance, bore=bore)
    return Geneva(
        wheel=Outline(wheel, holes).with_curve(partial(again, "wheel")),
        pin=Outline.from_curve([circle_points((r, 0), pin_radius, tolerance)], partial(again, "pin")),
        locking_disc=Outline(disc).with_curve(partial(again, "locking_disc")),
        slots=int(slots),
        center_distance=c,
        crank_radius=r,
        slot_width=2 * half_width,
        locking_radius=locking_radius,
        entry_angle=entry,
    )


def _part(
    slots: int, center_distance: float, pin_diameter: float, clearance: float, name: str, **settings: float
) -> Outline:
    """One part of a drive, made anew: `Outline.sample` calls it."""
    part: Outline = getattr(geneva(slots, center_distance, pin_diameter, clearance, **settings), name)
    return part


def _meeting_angle(own: float, distance: float, other: float) -> float:
    """Angle at the centre of a circle of radius `own` between the line of centres and where the two circles
    meet."""
    return math.acos((own**2 + distance**2 - other**2) / (2 * own * distance))
