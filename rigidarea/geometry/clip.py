"""Overlap of two small convex outlines by clipping (Sutherland & Hodgman, Commun ACM 17, 1974)."""

from __future__ import annotations

import numpy as np

from ..compile.jit import kernel
from .work import A_EDGE, B_EDGE, Relative, measure


@kernel
def clip(
    qa: np.ndarray, a0: int, na: int, qb: np.ndarray, b0: int, nb: int, rel: Relative,
    p: np.ndarray, label: np.ndarray, bows: np.ndarray, loops: np.ndarray, noise: float,
) -> int:  # fmt: skip
    """Two small convex outlines: B, points qb[b0:b0+nb], clipped by the edges of A. Labels go along with vertices."""
    n = nb
    src = 0
    dst = len(label) // 2
    for i in range(n):
        x = qb[b0 + i, 0]
        y = qb[b0 + i, 1]
        p[i, 0] = rel.c * x - rel.s * y + rel.tx
        p[i, 1] = rel.s * x + rel.c * y + rel.ty
        label[i] = B_EDGE
    ex = qa[a0 + na - 1, 0]
    ey = qa[a0 + na - 1, 1]
    for j in range(na):
        fx = qa[a0 + j, 0]
        fy = qa[a0 + j, 1]
        dx = fx - ex
        dy = fy - ey
        # one pass to see whether this edge cuts at all: most do not
        outside = 0
        for i in range(src, src + n):
            if dx * (p[i, 1] - ey) - dy * (p[i, 0] - ex) <= 0.0:
                outside += 1
        if outside == n:
            return 0
        if outside > 0:
            m = dst
            ux = p[src + n - 1, 0]
            uy = p[src + n - 1, 1]
            ulabel = label[src + n - 1]
            du = dx * (uy - ey) - dy * (ux - ex)
            for i in range(src, src + n):
                vx = p[i, 0]
                vy = p[i, 1]
                vlabel = label[i]
                dv = dx * (vy - ey) - dy * (vx - ex)
                if (du > 0.0) != (dv > 0.0):
                    t = du / (du - dv)
                    p[m, 0] = ux + t * (vx - ux)
                    p[m, 1] = uy + t * (vy - uy)
                    label[m] = A_EDGE if du > 0.0 else ulabel  # leaving: along A's edge until B comes back in
                    m += 1
                if dv > 0.0:
                    p[m, 0] = vx
                    p[m, 1] = vy
                    label[m] = vlabel
                    m += 1
                ux = vx
                uy = vy
                ulabel = vlabel
                du = dv
            n = m - dst
            src, dst = dst, src
        ex = fx
        ey = fy
    n = measure(p, label, bows, loops, 0, src, src + n, False, True, noise)
    return 0 if n == 0 or loops[0].area < 0.0 else 1  # negative: rounding
