"""Overlap of two discs: a lens, or the smaller one, in closed form.

A disc's boundary has no corner and no start, so that the depth alone decides; where it is small beside the radii it is
the exact difference of squares.
"""

from __future__ import annotations

import math

import numpy as np

from ..compile.jit import kernel
from .arc import segment
from .work import A_EDGE, B_EDGE, Relative, noise_of, put

#: A depth below this, over the radii, is computed from the exact difference of squares.
SHALLOW = 1e-3


@kernel(forceinline=True)
def _square(a: float) -> tuple[float, float]:
    """a^2 = high + low, exactly (Dekker)."""
    high = a * a
    t = 134217729.0 * a
    a1 = t - (t - a)
    a2 = a - a1
    return high, a2 * a2 - ((high - a1 * a1) - 2.0 * a1 * a2)


@kernel
def _shallow(ra: float, rb: float, x: float, y: float, d: float) -> float:
    """ra + rb - |(x, y)|, d being |(x, y)| rounded, without its rounding: (s^2 - x^2 - y^2) / (s + d)."""
    s = ra + rb
    rest = (ra - (s - (s - ra))) + (rb - (s - ra))  # what s lacks of ra + rb
    s2, s2_low = _square(s)
    x2, x2_low = _square(x)
    y2, y2_low = _square(y)
    # the three squares cancel: the largest two first
    if x2 < y2:
        x2, y2 = y2, x2
    t = s2 - x2
    t_low = (s2 - (t + (s2 - t - x2) + x2)) + (s2 - t - x2)  # of s2 - x2
    return ((t - y2) + (t_low + s2_low - x2_low - y2_low) + 2.0 * s * rest) / (s + d)


@kernel
def whole_disc(
    p: np.ndarray,
    label: np.ndarray,
    bows: np.ndarray,
    loops: np.ndarray,
    own: int,
    cx: float,
    cy: float,
    r: float,
) -> int:
    """The region that is all of a disc."""
    v = put(p, label, bows, 0, own, cx + r, cy, cx - r, cy, cx, cy, r)
    v = put(p, label, bows, v, own, cx - r, cy, cx + r, cy, cx, cy, r)
    loop = loops[0]
    loop.start = 0
    loop.stop = v
    loop.area = math.pi * r * r
    loop.x = cx
    loop.y = cy
    loop.chord_x = 0.0
    loop.chord_y = 0.0
    loop.lever = 0.0
    loop.straight = 0.0
    loop.region = 0
    loop.arcs = 1
    return 1


@kernel
def disc_disc(
    ra: float, rb: float, rel: Relative, p: np.ndarray, label: np.ndarray, bows: np.ndarray, loops: np.ndarray
) -> int:
    """Two discs: a lens, or the smaller one.

    With d the distance of the centres and depth = ra + rb - d, the chord's half length is Heron's
    sqrt(depth (d - ra + rb)(d + ra - rb)(d + ra + rb)) / 2d, and each side of it a segment: nothing cancels but the
    depth itself.
    """
    dx = rel.tx
    dy = rel.ty
    d = math.sqrt(dx * dx + dy * dy)
    depth = ra + rb - d
    if abs(depth) < SHALLOW * (ra + rb):
        depth = _shallow(ra, rb, dx, dy, d)
    if depth <= noise_of(ra, rb, rel):  # what rounding makes is no region
        return 0
    if d <= abs(ra - rb):
        if ra <= rb:
            return whole_disc(p, label, bows, loops, A_EDGE, 0.0, 0.0, ra)
        return whole_disc(p, label, bows, loops, B_EDGE, dx, dy, rb)
    dx /= d
    dy /= d
    half = 0.5 * math.sqrt(depth * (d - (ra - rb)) * (d + (ra - rb)) * (d + ra + rb)) / d
    bulge_a = 0.5 * depth * (d - (ra - rb)) / d  # of A's arc beyond the chord
    bulge_b = 0.5 * depth * (d + (ra - rb)) / d
    foot = ra - bulge_a
    area_a, moment_a = segment(half, foot, ra)
    area_b, moment_b = segment(half, rb - bulge_b, rb)
    fx = foot * dx
    fy = foot * dy
    hx = half * -dy
    hy = half * dx
    p[0, 0] = fx - hx
    p[0, 1] = fy - hy
    p[1, 0] = ra * dx
    p[1, 1] = ra * dy
    p[2, 0] = fx + hx
    p[2, 1] = fy + hy
    p[3, 0] = (ra - depth) * dx
    p[3, 1] = (ra - depth) * dy
    for v in range(4):
        of_a = v < 2
        label[v] = A_EDGE if of_a else B_EDGE
        bows[v, 0] = 0.0 if of_a else rel.tx
        bows[v, 1] = 0.0 if of_a else rel.ty
        bows[v, 2] = ra if of_a else rb
    area = area_a + area_b
    x = foot + (moment_a - moment_b) / area
    loop = loops[0]
    loop.start = 0
    loop.stop = 4
    loop.area = area
    loop.x = x * dx
    loop.y = x * dy
    loop.chord_x = 2.0 * hx
    loop.chord_y = 2.0 * hy
    loop.lever = 0.0
    loop.straight = 0.0
    loop.region = 0
    loop.arcs = 1
    return 1
