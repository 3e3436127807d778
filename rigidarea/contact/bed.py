"""Elastic energy of contact regions. Not for a step: these may allocate."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..compile.jit import njit
from ..geometry.arc import on_arc
from ..geometry.place import overlap_of_outlines
from ..geometry.pool import Pool
from ..geometry.work import Work
from .motion import pose_of
from .region import inverse_mass, region_stiffness
from .tables import LAW_AREA, STRUCK, SUBSTEP, Law, Tables

#: Nodes and weights of Gauss's rule for `bed_energy` between two cuts: exact to rounding there.
NODES, WEIGHTS = np.polynomial.legendre.leggauss(24)


@njit
def bed_energy(work: Work, start: int, stop: int, arcs: bool, nx: float, ny: float) -> float:
    """Half the integral of thickness^2 across a loop of `work`, thickness measured along n (length^3).

    k times this is what a bed of springs of pressure k per length stores when two outlines press their overlap out
    of it along n: the potential of F = k A wherever that has one (against one straight edge, k A times the depth of
    the centroid). Between the vertices' places across n the thickness is linear, or, of arcs, linear and a few roots
    that begin or end there; with s = middle + half sin(pi u / 2) these too are smooth in u.
    """
    n = stop - start
    s = np.empty(n)
    y = np.empty(n)
    cuts = np.empty(3 * n)
    m = n
    j = stop - 1
    for i in range(n):
        s[i] = -ny * work.polygon[start + i, 0] + nx * work.polygon[start + i, 1]
        y[i] = nx * work.polygon[start + i, 0] + ny * work.polygon[start + i, 1]
        cuts[i] = s[i]
        if arcs:  # where an arc turns round
            r = work.bows[j, 2]
            p = work.polygon[j]
            q = work.polygon[start + i]
            for reach in (-r, r):
                x0 = work.bows[j, 0] - reach * ny
                y0 = work.bows[j, 1] + reach * nx
                if r != 0.0 and on_arc(p[0], p[1], q[0], q[1], r, x0, y0):
                    cuts[m] = -ny * x0 + nx * y0
                    m += 1
            j = start + i
    cuts = np.sort(cuts[:m])
    total = 0.0
    for c in range(m - 1):
        half = 0.5 * (cuts[c + 1] - cuts[c])
        middle = 0.5 * (cuts[c + 1] + cuts[c])
        if half <= 0.0:
            continue
        for u in range(len(NODES)):
            at = middle + half * math.sin(0.5 * math.pi * NODES[u])
            weight = half * 0.5 * math.pi * math.cos(0.5 * math.pi * NODES[u]) * WEIGHTS[u]
            g = 0.0
            j = n - 1
            for i in range(n):
                r = work.bows[start + j, 2] if arcs else 0.0
                if r == 0.0:
                    if s[i] != s[j] and min(s[i], s[j]) <= at < max(s[i], s[j]):
                        height = y[j] + (y[i] - y[j]) / (s[i] - s[j]) * (at - s[j])
                        g += height if s[i] > s[j] else -height
                else:
                    cx = work.bows[start + j, 0]
                    cy = work.bows[start + j, 1]
                    off = at - (-ny * cx + nx * cy)
                    if abs(off) < abs(r):
                        root = math.sqrt((abs(r) - off) * (abs(r) + off))
                        p = work.polygon[start + j]
                        q = work.polygon[start + i]
                        for side in (1.0, -1.0):  # the upper half is walked to the right if counter-clockwise
                            height = nx * cx + ny * cy + side * root
                            if on_arc(
                                p[0], p[1], q[0], q[1], r, nx * height - ny * at, ny * height + nx * at
                            ):
                                g += height if side * r > 0.0 else -height
                j = i
            total += 0.5 * weight * g * g
    return total


@njit
def _borne(law: Law, r: Any, a: Any, b: Any) -> float:
    """The part of a region's elastic energy that comes back.

    All, where the step follows the contact. Else no more than belongs to the force that it bears (a spring's, as its
    square): a bounce shorter than the step has none, and what it leaves overlapped opens without giving speed.
    """
    if r.mode >= STRUCK:
        return 0.0
    elastic = r.stiffness * r.area if law.law == LAW_AREA else r.stiffness * r.area * r.chord / law.length
    phase2 = region_stiffness(law, r.stiffness, r.chord) * inverse_mass(r, a, b) * r.step * r.step
    if phase2 <= law.followed or r.force >= elastic:
        return 1.0
    return float((r.force / elastic) ** 2)


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
            r = region.next
            share = _borne(law, region, tables.bodies[sa.body], tables.bodies[sb.body])
            if share == 0.0:
                continue
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
                    total += share * 0.5 * region.stiffness * loop.area * loop.area / law.length
                else:
                    nx = a.c * region.nx + a.s * region.ny
                    ny = a.c * region.ny - a.s * region.nx
                    energy = bed_energy(work, loop.start, loop.stop, loop.arcs > 0, nx, ny)
                    total += share * region.stiffness * energy
    return total
