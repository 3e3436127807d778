"""The internal involute spur gear: a ring whose tooth spaces have the shape of an external gear's teeth.

Its flanks are the involutes of the same base circle as an external gear's of equal module, teeth and pressure angle,
with the material on the other side. (Litvin & Fuentes, *Gear Geometry and Applied Theory*, 2nd ed., chapter 11.)
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ..geometry.arcs import circle_points
from ..geometry.gate import not_negative, positive
from ..geometry.outline import Outline
from .curve import arc, check_gear, check_modules, involute, repeated, sample_curve


def internal_gear(
    module: float,
    teeth: int,
    pressure_angle: float = math.radians(20),
    addendum: float = 1.0,
    dedendum: float = 1.25,
    *,
    rim: float = 2.5,
    backlash: float = 0.0,
    tolerance: float | None = None,
) -> Outline:
    """A ring gear with teeth inwards, a tooth *space* centred on the x axis.

    module: length; the pitch circle has radius module·teeth/2. pressure_angle: radians. addendum (inwards), dedendum
    (outwards) and rim, the ring's thickness outside the tooth spaces: in modules. backlash: length by which every
    tooth is thinner at the pitch circle. tolerance: largest sagitta (length), default a thousandth of the module.

    A pinion of z teeth at the origin and angle φ is centred in mesh with a ring at (module·(z − teeth)/2, 0), to its
    left, at the angle φ·z/teeth, if tooth 0 of the pinion is centred on its x axis.

    The corners at tip and bottom are sharp. Whether a pinion's tips clear those of the ring (trimming) depends on the
    pair and is not checked; with 20° and standard teeth ten teeth of difference are enough.

    Raises ValueError, with the number concerned, for parameters out of range, tips below the base circle, and teeth or
    spaces that come to a point.
    """
    check_gear(module, teeth, pressure_angle)
    for name, value in (("addendum", addendum), ("dedendum", dedendum), ("rim", rim)):
        check_modules(teeth, **{name: positive(value, name)})
    not_negative(backlash, "backlash")
    sagitta = 1e-3 * module if tolerance is None else positive(tolerance, "tolerance")

    pitch = module * teeth / 2
    base = pitch * math.cos(pressure_angle)
    tip, root = pitch - addendum * module, pitch + dedendum * module
    if tip <= base:
        raise ValueError(
            f"tips must stay outside the base circle, expected an addendum below {(pitch - base) / module:.6g}"
            f" modules, got {addendum!r}; take more teeth"
        )
    # half the angle of a space where the pressure angle's tangent is t
    at_pitch = (math.pi * module + 2 * backlash) / (4 * pitch)

    def half_space(t: float) -> float:
        return at_pitch + involute(math.tan(pressure_angle)) - involute(t)

    def roll(radius: float) -> float:
        return math.sqrt((radius / base) ** 2 - 1)

    low, high = half_space(roll(tip)), half_space(roll(root))
    if high <= 0:
        raise ValueError(
            f"spaces must be wider than 0 at the bottom, got {2 * root * high:.6g}; take a smaller dedendum"
        )
    if low >= math.pi / teeth:
        raise ValueError(
            f"teeth must be thicker than 0 at the tip, got {2 * tip * (math.pi / teeth - low):.6g}; take a smaller"
            " addendum or backlash"
        )

    def flank(t: NDArray[np.float64]) -> NDArray[np.float64]:
        """The side y > 0 of the space on the x axis, points (n, 2) at rolls (n,)."""
        angle = at_pitch + involute(math.tan(pressure_angle)) - (t - np.arctan(t))
        return (base * np.hypot(1.0, t))[:, None] * np.column_stack((np.cos(angle), np.sin(angle)))

    out = sample_curve(flank, roll(tip), roll(root), sagitta)  # from tip to bottom
    bottom = sample_curve(partial(arc, root), high, -high, sagitta)
    top = sample_curve(partial(arc, tip), -low, low - 2 * math.pi / teeth, sagitta)
    # clockwise: down the upper flank, along the bottom, up the lower flank, along the next tooth's tip
    one = np.concatenate((out, bottom[1:-1], out[::-1] * (1, -1), top[1:-1]))
    outer = circle_points((0, 0), root + rim * module, sagitta)
    tooth = module, teeth, pressure_angle, addendum, dedendum
    again = partial(internal_gear, *tooth, rim=rim, backlash=backlash)
    return Outline(outer, [repeated(one, teeth, -1)]).with_curve(again)
