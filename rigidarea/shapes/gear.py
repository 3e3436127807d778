"""The involute spur gear, as a rack cuts it.

Lengths of the tooth are given in modules, as in ISO 53. A rack of straight flanks rolls on the pitch
circle, r = m z/2: its flanks generate the involutes of the base circle r cos α, its rounded tip corners the
root fillets (trochoids), its tip the root circle. Where the rack reaches below the point in which the line
of action touches the base circle, the trochoid cuts into the involute (undercut), and the two are met where
they cross. (Litvin & Fuentes, *Gear Geometry and Applied Theory*, 2nd ed., chapters 5, 6 and 10.)
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..geometry.arcs import circle_points
from ..geometry.gate import finite, not_negative, positive
from ..geometry.outline import Outline
from .curve import arc, check_gear, check_modules, involute, repeated, sample_curve

STANDARD_RACK_TIP_RADIUS = 0.38
"""Rounding of the rack's tip in modules, ISO 53 profile A."""


def involute_gear(
    module: float,
    teeth: int,
    pressure_angle: float = math.radians(20),
    addendum: float = 1.0,
    dedendum: float = 1.25,
    *,
    profile_shift: float = 0.0,
    backlash: float = 0.0,
    rack_tip_radius: float | None = None,
    bore: float = 0.0,
    tolerance: float | None = None,
    spacing: float | None = None,
) -> Outline:
    """An external spur gear, tooth 0 centred on the x axis.

    module: length; the pitch circle has radius module·teeth/2.
    pressure_angle: radians. addendum, dedendum, profile_shift, rack_tip_radius: in modules (rack_tip_radius
        by default 0.38, or the full rounding where the rack's tip is narrower).
    backlash: length by which every tooth of this gear is thinner at the pitch circle. A pair has the sum of
        both, and that times cos(pressure_angle) along the line of action.
    bore: radius of a central hole (length), 0 for none.
    tolerance: largest sagitta (length), default a thousandth of the module; all points of teeth lie on the
        exact curves.
    spacing: greatest length of an edge (length), for meshes; none by default.

    Two gears of equal module and pressure angle whose profile shifts add up to zero mesh at the distance
    module·(z1 + z2)/2. With gear 1 at angle φ and gear 2 in direction x from it, gear 2 stands centred in
    mesh at the angle π + π/z2 − φ·z1/z2 (z2 counted as teeth).

    Raises ValueError, with the number concerned, for parameters out of range, teeth that come to a point
    below the tip circle, rack tips without width, an undercut that leaves no flank or cuts teeth off, a
    bore that reaches the root circle.
    """
    check_gear(module, teeth, pressure_angle)
    positive(addendum, "addendum")
    positive(dedendum, "dedendum")
    for name, value in (("backlash", backlash), ("bore", bore)):
        not_negative(value, name)
    finite(profile_shift, "profile_shift")
    if rack_tip_radius is not None:
        not_negative(rack_tip_radius, "rack_tip_radius")
    check_modules(teeth, addendum=addendum, dedendum=dedendum, profile_shift=abs(profile_shift))
    tolerance_length = 1e-3 * module if tolerance is None else positive(tolerance, "tolerance")
    if spacing is not None:
        positive(spacing, "spacing")

    rack = _rack(module, pressure_angle, dedendum, profile_shift, backlash, rack_tip_radius)
    pitch_radius = module * teeth / 2
    tip_radius = pitch_radius + module * (addendum + profile_shift)
    half_thickness = (math.pi / 4 + profile_shift * math.tan(pressure_angle)) * module - backlash / 2
    tooth = _Tooth(
        teeth, pitch_radius, pitch_radius * math.cos(pressure_angle), half_thickness / pitch_radius, rack
    )
    if tooth.root_radius <= 0:
        raise ValueError(f"dedendum must leave a root circle, got root radius {tooth.root_radius:.6g}")
    if bore >= tooth.root_radius:
        raise ValueError(f"bore must be smaller than the root radius {tooth.root_radius:.6g}, got {bore!r}")

    tip_roll = tooth.roll(tip_radius)
    fillet_end, flank_roll = tooth.junction(pressure_angle)
    if tip_roll <= flank_roll:
        raise ValueError(
            f"expected a flank between root fillet and tip, got one that starts at radius "
            f"{tooth.base_radius * math.hypot(1, flank_roll):.6g} under a tip radius of {tip_radius:.6g}"
        )
    if tooth.half_angle(tip_roll) <= 0:
        raise ValueError(
            f"teeth must be thicker than 0 at the tip, got {2 * tip_radius * tooth.half_angle(tip_roll):.6g} "
            f"at radius {tip_radius:.6g}; take a smaller addendum or profile shift, or more teeth"
        )

    # one side of a tooth, y < 0: root corner → fillet → involute → tip corner; the other is its mirror image
    fillet = sample_curve(tooth.fillet, 0.0, fillet_end, tolerance_length, spacing)
    if np.any(fillet[:, 1] >= 0):
        raise ValueError(
            f"teeth must not be cut off by the rack's tip: {teeth} teeth are too few for this rack"
        )
    flank = sample_curve(tooth.involute, flank_roll, tip_roll, tolerance_length, spacing)
    tip_angle = tooth.half_angle(tip_roll)
    tip = sample_curve(partial(arc, tip_radius), -tip_angle, tip_angle, tolerance_length, spacing)
    rising = np.concatenate((fillet, flank[1:]))
    parts = [rising, tip[1:-1], rising[::-1] * (1, -1)]
    # half the space's, at the root circle
    root_angle = math.pi / teeth + math.atan2(fillet[0, 1], fillet[0, 0])
    if root_angle <= 1e-9:  # full rounding: the next tooth's fillet begins where this one ends
        parts[-1] = parts[-1][:-1]
    else:
        half, root = math.pi / teeth, partial(arc, tooth.root_radius)
        bottom = sample_curve(root, half - root_angle, half + root_angle, tolerance_length, spacing)
        parts.append(bottom[1:-1])
    holes = []
    if bore > 0:
        sagitta = (
            math.inf if spacing is None else bore * (1 - math.cos(min(spacing / (2 * bore), math.pi / 2)))
        )
        holes.append(circle_points((0, 0), bore, min(tolerance_length, sagitta)))
    again = partial(
        involute_gear, module, teeth, pressure_angle, addendum, dedendum, profile_shift=profile_shift,
        backlash=backlash, rack_tip_radius=rack_tip_radius, bore=bore, spacing=spacing,
    )  # fmt: skip
    return Outline(repeated(np.concatenate(parts), teeth, 1), holes).with_curve(again)


class _Rack(NamedTuple):
    """The rounded corner of the generating rack's tip, from the rack tooth's centre line and the rolling
    line (lengths)."""

    across: float
    """From the centre line to the rounding's centre."""
    depth: float
    """From the rolling line down to the rounding's centre."""
    radius: float


def _rack(
    module: float, alpha: float, dedendum: float, shift: float, backlash: float, tip_radius: float | None
) -> _Rack:
    """The rack tooth is as wide as the space it cuts: backlash widens it; the shift moves it out."""
    tip_half_width = math.pi / 4 * module + backlash / 2 - dedendum * module * math.tan(alpha)
    if tip_half_width < 0:
        raise ValueError(
            f"dedendum must leave the rack's tip a width, got a half width of {tip_half_width:.6g}"
        )
    full = tip_half_width * math.cos(alpha) / (1 - math.sin(alpha))  # the rounding that takes all of the tip
    if tip_radius is None:
        radius = min(STANDARD_RACK_TIP_RADIUS * module, full)
    elif 0 <= tip_radius * module <= full * (1 + 1e-12):
        radius = tip_radius * module
    else:
        raise ValueError(
            f"rack_tip_radius must lie between 0 and {full / module:.6g} modules, got {tip_radius!r}"
        )
    depth = (dedendum - shift) * module - radius
    if depth <= 0:
        raise ValueError(
            f"profile_shift must be below dedendum − rack tip radius, {dedendum - radius / module:.6g}, "
            f"got {shift!r}"
        )
    across = max(0.0, tip_half_width - radius * (1 - math.sin(alpha)) / math.cos(alpha))
    return _Rack(across, depth, radius)


class _Tooth(NamedTuple):
    """The curves of the lower side (y < 0) of a tooth centred on the x axis."""

    teeth: int
    pitch_radius: float
    base_radius: float
    half_angle_at_pitch: float
    rack: _Rack

    @property
    def root_radius(self) -> float:
        return self.pitch_radius - self.rack.depth - self.rack.radius

    def roll(self, radius: float) -> float:
        """Roll angle t of the involute at a radius: r = r_b sqrt(1 + t²), t the tangent of the pressure angle there."""
        return math.sqrt(max(0.0, (radius / self.base_radius) ** 2 - 1))

    def half_angle(self, roll: float) -> float:
        """Half the tooth's angle at a roll angle: ψ_pitch + inv α − inv α_r, with inv α_r = t − arctan t."""
        pitch_roll = self.roll(self.pitch_radius)
        return self.half_angle_at_pitch + involute(pitch_roll) - involute(roll)

    def involute(self, roll: NDArray[np.float64]) -> NDArray[np.float64]:
        """Roll angles (n,) -> points (n, 2)."""
        base_angle = self.half_angle(0.0)
        x = self.base_radius * (np.cos(roll) + roll * np.sin(roll))
        y = self.base_radius * (np.sin(roll) - roll * np.cos(roll))
        c, s = math.cos(base_angle), math.sin(base_angle)
        return np.column_stack((c * x + s * y, c * y - s * x))

    def fillet(self, theta: NDArray[np.float64]) -> NDArray[np.float64]:
        """Angles (n,) of the rack rounding's normal from the rack's axis, 0 … π/2 − α, -> points (n, 2).

        A point of the rounding cuts when its normal passes through the pitch point, so its centre is then
        depth·tan θ past it, and the gear has turned accordingly.
        """
        past = self.rack.depth * np.tan(theta)
        x = past + self.rack.radius * np.sin(theta)
        y = self.pitch_radius - self.rack.depth - self.rack.radius * np.cos(theta)
        # with the space along y the point is (x, y) turned by (past − across)/r; the tooth is π/z clockwise
        angle = np.arctan2(x, y) - (past - self.rack.across) / self.pitch_radius
        radius = np.hypot(x, y)
        below = math.pi / self.teeth - angle  # from the tooth's axis
        return np.column_stack((radius * np.cos(below), -radius * np.sin(below)))

    def junction(self, alpha: float) -> tuple[float, float]:
        """Where fillet and involute meet: the angle θ on the one, the roll angle on the other."""
        end = math.pi / 2 - alpha
        if self.rack.depth + self.rack.radius * math.sin(alpha) <= self.pitch_radius * math.sin(alpha) ** 2:
            x, y = self.fillet(np.array((end,)))[0]
            return end, self.roll(math.hypot(x, y))  # tangent to each other, there

        def thicker(theta: float) -> float:
            """The tooth's half angle on the trochoid less that on the involute, at the trochoid's radius."""
            x, y = self.fillet(np.array((theta,)))[0]
            return math.atan2(-y, x) - self.half_angle(self.roll(math.hypot(x, y)))

        def outside_base(theta: float) -> float:
            return float(np.hypot(*self.fillet(np.array((theta,)))[0])) - self.base_radius

        low = _bisect(outside_base, 0.0, end) if self.root_radius < self.base_radius else 0.0
        theta = _bisect(thicker, low, end)
        return theta, self.roll(outside_base(theta) + self.base_radius)


def _bisect(f: Callable[[float], float], low: float, high: float) -> float:
    """The root of an increasing function, to the last bit."""
    for _ in range(200):
        middle = (low + high) / 2
        if middle in (low, high):
            break
        low, high = (middle, high) if f(middle) < 0 else (low, middle)
    return high
