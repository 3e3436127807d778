"""Direction of a region's force: along the chord's normal, or the paper's weighted nodal normals (theory 2)."""

from __future__ import annotations

import math

import numpy as np

from ..compile.jit import entry, kernel
from .overlap import A_EDGE, B_EDGE

#: A chord below this fraction of sqrt(area) is rounding: the direction is then taken from memory, or anew.
NO_CHORD = 1e-6


@kernel
def _ray(
    polygon: np.ndarray, label: np.ndarray, start: int, stop: int, i: int, nx: float, ny: float
) -> float:
    """Distance from vertex i along n to the nearest edge of the other outline in the region (Eq. 9); 0 if none."""
    px = polygon[i, 0]
    py = polygon[i, 1]
    own = label[i]
    best = np.inf
    j = stop - 1
    for k in range(start, stop):
        if label[j] != own:
            ux = polygon[j, 0] - px
            uy = polygon[j, 1] - py
            vx = polygon[k, 0] - px
            vy = polygon[k, 1] - py
            cu = nx * uy - ny * ux
            cv = nx * vy - ny * vx
            if (cu > 0.0) != (cv > 0.0):
                s = cu / (cu - cv)
                d = nx * (ux + s * (vx - ux)) + ny * (uy + s * (vy - uy))
                if 0.0 <= d < best:
                    best = d
        j = k
    return best if best < np.inf else 0.0


@kernel
def nodal_direction(
    polygon: np.ndarray, label: np.ndarray, start: int, stop: int, exponent: float
) -> tuple[float, float]:
    """Unit direction A to B by the paper's Alg. 2, lines 6-14 (Eq. 8-15), in the polygon's frame; (0, 0) if none.

    Nodes are the vertices of an arc that are no crossings. Where one outline has no node in the region the other's
    direction stands alone (the paper then sees no contact, Fig. 1b).
    """
    total_x = 0.0
    total_y = 0.0
    for own in (A_EDGE, B_EDGE):
        sum_x = 0.0
        sum_y = 0.0
        before = stop - 1
        for i in range(start, stop):
            after = i + 1 if i + 1 < stop else start
            if label[i] == own and label[before] == own:
                dx = polygon[after, 0] - polygon[before, 0]
                dy = polygon[after, 1] - polygon[before, 1]
                length = math.sqrt(dx * dx + dy * dy)
                if length > 0.0:
                    nx = (
                        -dy / length
                    )  # Eq. 8; counter-clockwise: into the region, towards the other's boundary
                    ny = dx / length
                    depth = _ray(polygon, label, start, stop, i, nx, ny)  # Eq. 9
                    tributary = 0.5 * (
                        math.hypot(polygon[i, 0] - polygon[before, 0], polygon[i, 1] - polygon[before, 1])
                        + math.hypot(polygon[after, 0] - polygon[i, 0], polygon[after, 1] - polygon[i, 1])
                    )  # Eq. 11
                    weight = tributary * depth**exponent  # Eq. 10 and 12, without the common factor
                    sum_x += weight * nx
                    sum_y += weight * ny
            before = i
        length = math.sqrt(sum_x * sum_x + sum_y * sum_y)
        if length > 0.0:
            sign = -1.0 if own == A_EDGE else 1.0  # Eq. 13, 14, then 15: n points from A to B
            total_x += sign * sum_x / length
            total_y += sign * sum_y / length
    length = math.sqrt(total_x * total_x + total_y * total_y)
    if length == 0.0:
        return 0.0, 0.0
    return total_x / length, total_y / length


@entry
def chord_direction(chord_x: float, chord_y: float, area: float) -> tuple[float, float]:
    """Unit direction A to B: A's outward normal integrated over its arcs is the chord turned by -90 degrees.

    (0, 0) where the chord is nothing: one outline inside the other, or two bars crossed.
    """
    length = math.sqrt(chord_x * chord_x + chord_y * chord_y)
    if length <= NO_CHORD * math.sqrt(area):
        return 0.0, 0.0
    return chord_y / length, -chord_x / length
