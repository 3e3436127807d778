"""How round surfaces turn under each other: by how much the closing speed of two bodies changes while they drift.

A row stops the closing speed along the direction of the middle of the substep. On the drift that follows a round
surface turns away (or, in a bowl, into the way): at its end a gap of h^2 g''/2 is left that nobody asked for, g'' the
gap's second derivative at constant velocities. So the speed that leaves no gap is h g''/2 (`row.t1`); the half drift
to the frame's end brings it to zero, and what slides without friction comes with as much as it goes: energy is kept.

With n from A to B, t = (-n_y, n_x), s the speed of B's material relative to A's along t, wa, wb the spins, ka, kb the
curvatures (positive: convex), and la, lb the points of contact seen from the centres, along n:

    g'' = [ka kb s^2 + 2 s (wb ka + wa kb) - (wb - wa)^2] / (ka + kb) + wa^2 la - wb^2 lb

That is the centres of curvature's own: their relative speed squared over 1/ka + 1/kb, and their centripetal
accelerations; written so that a flat (k = 0) and a corner (k infinite) are cases of it. (Signs and terms as in D. J.
Montana, Int. J. Robotics Research 7 (1988), doi:10.1177/027836498800700302, in the plane.)
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..compile.jit import kernel
from .arc import FLAT, distance2, flat_segment
from .work import A_EDGE


@kernel(forceinline=True)
def _between(x: float) -> float:
    """Area between chord and arc, no more than half a turn, over the radius squared; x: half chord over radius."""
    if x * x < FLAT:
        return flat_segment(x, x * x)[0]
    return math.asin(x) - x * math.sqrt((1.0 - x) * (1.0 + x))


@kernel
def curvatures(
    polygon: np.ndarray, label: np.ndarray, bows: np.ndarray, start: int, stop: int, area: float, chord: float
) -> tuple[float, float]:
    """Curvatures of A's and of B's side of a loop with arcs (1/length); (0, 0) if it has more than two sides.

    Those of the circles that would leave the same area between side and chord, chord^3 k / 12: a corner's is its angle
    spread over the region. Both together are the region's, 12 area / chord^3.
    """
    px = py = qx = qy = 0.0
    ox = polygon[start, 0]
    oy = polygon[start, 1]
    doubled = 0.0
    sides = 0
    j = stop - 1
    before = label[j - 1] if j > start else label[j]
    ux = polygon[j, 0] - ox
    uy = polygon[j, 1] - oy
    for i in range(start, stop):
        vx = polygon[i, 0] - ox
        vy = polygon[i, 1] - oy
        own = label[j]
        if own != before:
            sides += 1
            if own == A_EDGE:
                px = ux
                py = uy
            else:
                qx = ux
                qy = uy
        if own == A_EDGE:
            doubled += ux * vy - uy * vx
            r = bows[j, 2]
            if r != 0.0:
                x = min(1.0, 0.5 * math.sqrt(distance2(vx, vy, ux, uy)) / abs(r))
                doubled += 2.0 * _between(x) * r * abs(r)
        before = own
        ux = vx
        uy = vy
        j = i
    if sides != 2:
        return 0.0, 0.0
    doubled += qx * py - qy * px
    scale = 12.0 / (chord * chord * chord)
    of_a = 0.5 * doubled * scale
    return of_a, area * scale - of_a


@kernel(forceinline=True)
def curvature_of_disc(radius: float, chord: float) -> float:
    """The same of a disc's side alone, no more than half a turn (1/length)."""
    x = min(1.0, 0.5 * chord / radius)
    return 1.5 * _between(x) / (radius * x * x * x)


@kernel
def turning_speed(r: Any, a: Any, b: Any, h: float) -> float:
    """The closing speed that leaves no gap behind a drift of h (length/time).

    At the velocities at which the bodies come, the substep's kick taken off: what it adds, contacts may yet stop, and
    what lies still would turn for ever. Where the direction would turn by an angle p of about 1 or more (a pin in its
    journal), 2 / (1 + sqrt(1 + p^2)) of it: exact for a straight way past a round surface, and bounded by the speed.
    """
    both = r.curve_a + r.curve_b
    if both <= 0.0:
        return 0.0
    wa = a.w - a.kick_w
    wb = b.w - b.kick_w
    ux = b.vx - b.kick_x - a.vx + a.kick_x
    uy = b.vy - b.kick_y - a.vy + a.kick_y
    s = uy * r.nx - ux * r.ny + wb * r.lean_b - wa * r.lean_a
    mixed = wb * r.curve_a + wa * r.curve_b
    product = r.curve_a * r.curve_b
    bend = (product * s * s + 2.0 * s * mixed - (wb - wa) * (wb - wa)) / both
    bend += wa * wa * r.lean_a - wb * wb * r.lean_b
    angle = h * (product * s + mixed) / both
    return h * bend / (1.0 + math.sqrt(1.0 + angle * angle))


@kernel(forceinline=True)
def turning_together(r: Any, a: Any, b: Any, h: float) -> float:
    """The same of a face on a face, which have no curvature and go on turning as one: as fast as both turn at least.

    A box in a drum goes straight on for a step, while the wall under it turns into its way.
    """
    wa = a.w - a.kick_w
    wb = b.w - b.kick_w
    if wa * wb <= 0.0:
        return 0.0
    w = wa if abs(wa) < abs(wb) else wb
    ux = b.vx - b.kick_x - a.vx + a.kick_x
    uy = b.vy - b.kick_y - a.vy + a.kick_y
    s = uy * r.nx - ux * r.ny + wb * r.lean_b - wa * r.lean_a
    bend = 2.0 * s * w + w * w * (r.lean_a - r.lean_b)
    return float(h * bend / (1.0 + math.sqrt(1.0 + h * h * w * w)))
