"""Elastic energy of contact regions. Not for a step: these may allocate."""

from __future__ import annotations

import math

import numpy as np

from .jit import njit
from .meet import pose_of
from .place import overlap_of_outlines
from .pool import Pool
from .tables import LAW_AREA, SUBSTEP, Law, Tables
from .work import Work


@njit
def bed_energy(polygon: np.ndarray, start: int, stop: int, nx: float, ny: float) -> float:
    """Half the integral of thickness^2 across the polygon, thickness measured along n (length^3).

    k times this is what a bed of springs of pressure k per length stores when two outlines press their overlap out
    of it along n: the potential of F = k A wherever that has one (against one straight edge, k A times the depth of
    the centroid). The thickness is piecewise linear between the vertices' places across n.
    """
    n = stop - start
    s = np.empty(n)
    y = np.empty(n)
    for i in range(n):
        s[i] = -ny * polygon[start + i, 0] + nx * polygon[start + i, 1]
        y[i] = nx * polygon[start + i, 0] + ny * polygon[start + i, 1]
    cuts = np.sort(s)
    total = 0.0
    for c in range(n - 1):
        low = cuts[c]
        high = cuts[c + 1]
        if high <= low:
            continue
        g0 = 0.0
        g1 = 0.0
        j = n - 1
        for i in range(n):
            if s[i] != s[j] and min(s[i], s[j]) <= low and max(s[i], s[j]) >= high:
                slope = (y[i] - y[j]) / (s[i] - s[j])
                sign = 1.0 if s[i] > s[j] else -1.0
                g0 += sign * (y[j] + slope * (low - s[j]))
                g1 += sign * (y[j] + slope * (high - s[j]))
            j = i
        total += (high - low) * (g0 * g0 + g0 * g1 + g1 * g1) / 6.0
    return total


@njit
def stored(pool: Pool, tables: Tables, work: Work, law: Law) -> float:
    """Elastic energy of all pairs that had a region in the last substep, friction springs included (force length).

    Where the bodies of the tables are now: the overlap is made anew.
    """
    total = 0.0
    for p in range(len(tables.pairs)):
        pair = tables.pairs[p]
        if pair.a < 0 or pair.head < 0 or tables.regions[pair.head].stamp != tables.counters[SUBSTEP]:
            continue
        sa = tables.shapes[pair.a]
        sb = tables.shapes[pair.b]
        a = pose_of(tables.bodies[sa.body])
        b = pose_of(tables.bodies[sb.body])
        ia = sa.outline if pair.side_a >= 0 else sa.mirror
        ib = sb.outline if pair.side_b >= 0 else sb.mirror
        n, _ = overlap_of_outlines(pool, ia, a, ib, b, work)
        r = pair.head
        while r >= 0:
            region = tables.regions[r]
            if region.tangent_stiffness > 0.0:
                total += 0.5 * region.spring * region.spring / region.tangent_stiffness
            best = -1
            least = np.inf
            for k in range(n):
                lx = work.loops[k].x + pool.heads[ia].x
                ly = work.loops[k].y + pool.heads[ia].y
                x = a.x + a.c * lx - a.s * ly
                y = a.y + a.s * lx + a.c * ly
                d = math.hypot(x - region.x, y - region.y)
                if d < least:
                    least = d
                    best = k
            if best >= 0:
                loop = work.loops[best]
                if law.law != LAW_AREA:
                    total += 0.5 * region.stiffness * loop.area * loop.area / law.length
                else:
                    nx = a.c * region.nx + a.s * region.ny
                    ny = a.c * region.ny - a.s * region.nx
                    total += region.stiffness * bed_energy(work.polygon, loop.start, loop.stop, nx, ny)
            r = region.next
    return total
