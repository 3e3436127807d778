"""Fewer points for a ring: in one pass, however the ring winds (Douglas and Peucker's way takes n^2 for a saw)."""

from __future__ import annotations

import math

import numpy as np

from ..compile.jit import njit


@njit
def thinned(ring: np.ndarray, tolerance: float) -> np.ndarray:
    """Which points (n,) of a ring (n, 2) to keep, so that what is dropped is within `tolerance` (length) of a chord.

    A chord begins at a kept point and goes on to the last point before one that no chord may reach (Williams 1978,
    Sklansky and Gonzalez 1980): directions within `tolerance` of all points passed make a cone, and the next point must
    lie in it, no nearer than the farthest one passed. Point 0 is always kept.
    """
    n = len(ring)
    keep = np.zeros(n, np.bool_)
    keep[0] = True
    anchor = 0
    far = 0.0
    wide = True  # no point farther than `tolerance` passed: every direction will do
    low_x, low_y, high_x, high_y = 0.0, 0.0, 0.0, 0.0
    i = 1
    while i <= n:
        x = ring[i % n, 0] - ring[anchor, 0]
        y = ring[i % n, 1] - ring[anchor, 1]
        d = math.hypot(x, y)
        within = wide or (low_x * y - low_y * x >= 0.0 and x * high_y - y * high_x >= 0.0)
        if i > anchor + 1 and not (within and d >= far):
            anchor = i - 1
            keep[anchor] = True
            far = 0.0
            wide = True
            continue
        far = max(far, d)
        if d > tolerance:
            s = tolerance / d
            c = math.sqrt((1.0 - s) * (1.0 + s))
            ax, ay = x * c + y * s, y * c - x * s  # turned to the right, and to the left
            bx, by = x * c - y * s, y * c + x * s
            if wide or low_x * ay - low_y * ax > 0.0:
                low_x, low_y = ax / d, ay / d
            if wide or bx * high_y - by * high_x > 0.0:
                high_x, high_y = bx / d, by / d
            wide = False
        i += 1
    return keep
