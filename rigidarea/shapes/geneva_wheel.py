"""The external Geneva drive: a driver's pin indexes a slotted wheel, a locking disc holds it in between.

With n slots and centre distance C the crank radius is r = C sin(π/n) (the paper's Eq. 36): the pin then
enters and leaves along a slot, without a jerk in velocity. It does so at the distance C cos(π/n) from the
wheel's centre, so the straight walls of a slot end there, on the circle of radius sqrt((C cos(π/n))² +
(b/2)²), b the slot's width.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..geometry.arcs import circle_ring
from ..geometry.gate import not_negative, positive, size, whole
from ..geometry.outline import Outline


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
    tolerance: length; if given, the arcs are sampled to it. Keep it well below the clearance: a 64-sided pin of
        8 mm is off by the whole 0.01 mm.

    Raises ValueError, with the number concerned, for parameters out of range, slots that run into each
    other, into the bore or past the wheel's centre, locking arcs that cut slots, and a driver's disc that
    the wheel leaves no room for.
    """
    whole(slots, "slots", 3, 12)
    c, pin_radius = size(center_distance, "center_distance"), size(pin_diameter, "pin_diameter") / 2
    if locking_clearance is None:
        locking_clearance = clearance
    for name, value in (("clearance", clearance), ("locking_clearance", locking_clearance), ("bore", bore)):
        if not_negative(value, name) > c:
            raise ValueError(f"{name} must be below center_distance = {c:.6g}, got {value:.6g}")
    if tolerance is not None:
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
    locking_radius = 0.8 * reach if locking_radius is None else size(locking_radius, "locking_radius")
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
    ring, arcs = [], []
    for k in range(slots):
        slot, lock = 2 * half_index * k, 2 * half_index * k + half_index
        x, y = math.cos(slot), math.sin(slot)
        straight, rim = (0.0, 0.0, 0.0), (0.0, 0.0, wheel_radius)
        for along, across, arc in (
            (mouth, -half_width, straight),
            (bottom, -half_width, (bottom * x, bottom * y, -half_width)),
            (bottom, half_width, straight),
            (mouth, half_width, rim),
        ):
            ring.append((along * x - across * y, along * y + across * x))
            arcs.append(arc)
        for angle, arc in (
            (lock - gamma, (c * math.cos(lock), c * math.sin(lock), -arc_radius)),
            (lock + gamma, rim),
        ):
            ring.append((wheel_radius * math.cos(angle), wheel_radius * math.sin(angle)))
            arcs.append(arc)
    rings = [(np.array(ring), np.array(arcs))]
    if bore > 0:
        rings.append(circle_ring((0.0, 0.0), bore))

    # the disc: full outside the entry angles, relieved within
    entry = math.pi / 2 - half_index
    full, hollow = (0.0, 0.0, locking_radius), (0.0, 0.0, relief)
    x, y = math.cos(entry), math.sin(entry)
    disc = [
        (locking_radius * x, locking_radius * y),
        (-locking_radius, 0.0),
        (locking_radius * x, -locking_radius * y),
        (relief * x, -relief * y),
        (relief * x, relief * y),
    ]
    disc_arcs = np.array([full, full, (0.0, 0.0, 0.0), hollow, (0.0, 0.0, 0.0)])
    return Geneva(
        wheel=_checked(rings, tolerance),
        pin=_checked([circle_ring((r, 0.0), pin_radius)], tolerance),
        locking_disc=_checked([(np.array(disc), disc_arcs)], tolerance),
        slots=int(slots),
        center_distance=c,
        crank_radius=r,
        slot_width=2 * half_width,
        locking_radius=locking_radius,
        entry_angle=entry,
    )


def _checked(rings: list[tuple[np.ndarray, np.ndarray]], tolerance: float | None) -> Outline:
    """The outline of rings of points and arcs, sampled if asked; ValueError if it crosses itself."""
    outline = Outline.from_curve([ring for ring, _ in rings], arcs=[arcs for _, arcs in rings])
    outer, *holes = outline.polygon_rings
    Outline(outer, holes)
    return outline if tolerance is None else outline.sample(tolerance)


def _meeting_angle(own: float, distance: float, other: float) -> float:
    """Angle at the centre of a circle of radius `own` between the line of centres and where the two circles meet."""
    return math.acos((own**2 + distance**2 - other**2) / (2 * own * distance))
