"""How finely an outline is toothed: the width of what others may get into."""

from __future__ import annotations

import math

import numpy as np

from ..compile.jit import njit

#: What is less deep than this part of its width holds nobody.
SHALLOW = 0.05


@njit
def _hull(ring: np.ndarray) -> np.ndarray:
    """Which of a ring's points lie on its convex hull, but for rounding (Andrew 1979: monotone chains)."""
    n = len(ring)
    rounding = 1e-12 * np.abs(ring).max() ** 2
    by_y = np.argsort(ring[:, 1], kind="mergesort")
    order = by_y[np.argsort(ring[by_y, 0], kind="mergesort")]
    on = np.zeros(n, np.bool_)
    chain = np.empty(n, np.int64)
    for sense in range(2):
        m = 0
        for k in range(n):
            i = order[k] if sense == 0 else order[n - 1 - k]
            while m > 1:
                p = ring[chain[m - 2]]
                q = ring[chain[m - 1]]
                if (q[0] - p[0]) * (ring[i, 1] - p[1]) - (q[1] - p[1]) * (ring[i, 0] - p[0]) >= -rounding:
                    break
                m -= 1
            chain[m] = i
            m += 1
        for k in range(m):
            on[chain[k]] = True
    return on


@njit
def mouth_of(ring: np.ndarray) -> float:
    """Width, at the hull, of the slots between a ring's teeth (length); infinity: it has none.

    Of a hole its teeth are what has this width. The harmonic mean of all, by the squares of their depths: a few deep
    slots count for more than many scratches.
    """
    n = len(ring)
    on = _hull(ring)
    first = 0
    while not on[first]:
        first += 1
    weights = 0.0
    total = 0.0
    p = first
    while p < first + n:
        q = p + 1
        while not on[q % n]:
            q += 1
        if q > p + 1:
            ex = ring[q % n, 0] - ring[p % n, 0]
            ey = ring[q % n, 1] - ring[p % n, 1]
            width = math.hypot(ex, ey)
            depth = 0.0
            for k in range(p + 1, q):
                out = ex * (ring[k % n, 1] - ring[p % n, 1]) - ey * (ring[k % n, 0] - ring[p % n, 0])
                depth = max(depth, abs(out) / width)
            if depth > SHALLOW * width:
                weights += depth * depth
                total += depth * depth / width
        p = q
    return weights / total if total > 0.0 else math.inf
