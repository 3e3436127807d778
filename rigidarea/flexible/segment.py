"""Segment-to-segment penalty contact (STS), the baseline the paper holds its method against.

Every edge of the slave (body A) is cut by the projections of the master's (body B) edge ends along its normal; on
each part, two Gauss points carry p = ε ⟨−g⟩ (exact for the linear gap times a linear shape function, except where
the gap changes sign within a part), and shape functions hand the force to the nodes of both bodies. Cf. P. Wriggers,
Computational Contact Mechanics, 2nd ed., section 10.3, doi:10.1007/978-3-540-32609-0. ε is a force per area in 2-D,
as k is for the area method; on flat faces both give the same resultant. The signature is that of
``nodal.contact``: search, stepping and constraints are shared, only the evaluation differs. As there the loads are
unknowns of Newton's iteration where ``s`` has room for them (``condense``).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rigidarea.compile.jit import entry, kernel
from rigidarea.flexible.boundary import Boundary, Work, edges_of, span, strip
from rigidarea.flexible.boundary_places import add_load, place_leaves
from rigidarea.flexible.condense import begin_vectors, enter_vector, gather_vectors
from rigidarea.flexible.scratch import FULL, MANY, Scratch

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

GAUSS = (0.5 - 0.5 / 3.0**0.5, 0.5 + 0.5 / 3.0**0.5)


@kernel(forceinline=True)
def _facing(
    at_a: Array, next_a: NDArray[np.int32], low: int, high: int, b: Boundary, at_b: Array, pairs: Ints, start: int,
    end: int, reach: float, out: Ints,
) -> int:  # fmt: skip
    """Of the leaves of B paired with one of A, those not wholly outside A's leaf or deeper than ``reach``."""
    ox, oy, ux, uy, above, below = strip(at_a, next_a, low, high)
    above += reach * np.sqrt(ux * ux + uy * uy)
    count = 0
    for m in range(start, end):
        low_b, high_b = edges_of(b, pairs[m, 1])
        lowest, highest = span(at_b, b.following, low_b, high_b, ox, oy, ux, uy)
        if lowest <= above and highest >= below:
            out[count] = pairs[m, 1]
            count += 1
    return count


@entry
def contact(
    a: Boundary, wa: Work, pose_a: Array, qa: Array, b: Boundary, wb: Work, pose_b: Array, qb: Array,
    n_pairs: int, stamp: int, k: float, reach: float, spread: bool, s: Scratch,
) -> int:  # fmt: skip
    """STS for one pair: each slave leaf in contact leaves one resultant in ``s.regions`` (force, point, direction).

    k: the penalty ε. reach: length, the deepest penetration looked at (the other side of a thin body is no contact).
    Returns the number of resultants, or an error code of ``scratch``.
    """
    place_leaves(a, wa, pose_a, qa, s.pairs, n_pairs, 0, stamp)
    place_leaves(b, wb, pose_b, qb, s.pairs, n_pairs, 1, stamp)
    next_a, at_a, next_b, at_b = a.following, wa.position, b.following, wb.position
    load_a, flag_a, touched_a = wa.point_load, wa.point_flag, wa.touched
    load_b, flag_b, touched_b = wb.point_load, wb.point_flag, wb.touched
    pairs, regions, leaves = s.pairs, s.regions, s.edge[0]
    count = end = 0
    answers, rigid_a, rigid_b, before = spread and len(s.load.force) > 0, -1, -1, s.load.made[0]
    if answers:
        if s.load.made[0] + 6 > len(s.load.force):
            return FULL
        rigid_a, rigid_b = begin_vectors(a, wa, pose_a, b, wb, pose_b, s.load)
    while end < n_pairs:
        # a group of pairs with one leaf of the slave
        start, leaf_a = end, pairs[end, 0]
        while end < n_pairs and pairs[end, 0] == leaf_a:
            end += 1
        low, high = edges_of(a, leaf_a)
        facing = _facing(at_a, next_a, low, high, b, at_b, pairs, start, end, reach, leaves)
        fx = fy = moment = stiff = 0.0
        for i in range(low, high if facing > 0 else low):
            i1 = next_a[i]
            px, py = at_a[i, 0], at_a[i, 1]
            tx, ty = at_a[i1, 0] - px, at_a[i1, 1] - py
            length = np.sqrt(tx * tx + ty * ty)
            tx, ty = tx / length, ty / length
            nx, ny = ty, -tx  # outward
            total = first = 0.0  # force on the edge, and its moment about the edge's start
            for m in range(facing):
                j, stop = edges_of(b, leaves[m])
                rx, ry = at_b[j, 0] - px, at_b[j, 1] - py
                x_s, g_s = rx * tx + ry * ty, rx * nx + ry * ny
                carry = 0.0
                while j < stop:
                    j1 = next_b[j]
                    x_r, g_r = x_s, g_s
                    rx, ry = at_b[j1, 0] - px, at_b[j1, 1] - py
                    x_s, g_s = rx * tx + ry * ty, rx * nx + ry * ny
                    at_low, at_high = carry, 0.0
                    # the master's edge faces the slave's, over it, and penetrates, no deeper than reach
                    if (
                        x_s < x_r
                        and x_s < length
                        and x_r > 0.0
                        and min(g_r, g_s) < 0.0
                        and max(g_r, g_s) >= -reach
                    ):
                        lo, hi = max(0.0, x_s), min(length, x_r)
                        w, inverse = 0.5 * (hi - lo) * k, 1.0 / (x_r - x_s)
                        for g in range(2):
                            x = lo + GAUSS[g] * (hi - lo)
                            eta = (x_r - x) * inverse
                            gap = g_r + eta * (g_s - g_r)
                            if -reach <= gap < 0.0:
                                f = -gap * w
                                at_low += f - eta * f
                                at_high += eta * f
                                total += f
                                first += x * f
                                stiff += w
                                if answers:
                                    if s.load.made[0] + 8 > len(s.load.force):
                                        return FULL
                                    at_x, at_y = px + x * tx, py + x * ty
                                    n = enter_vector(
                                        a,
                                        wa,
                                        pose_a,
                                        s.load,
                                        0,
                                        i,
                                        x / length,
                                        rigid_a,
                                        at_x,
                                        at_y,
                                        nx,
                                        ny,
                                        0,
                                    )
                                    n = enter_vector(
                                        b, wb, pose_b, s.load, 1, j, eta, rigid_b, at_x, at_y, nx, ny, n
                                    )
                                    gather_vectors(s.load, n, f, w)
                    if spread and at_low != 0.0:
                        add_load(load_b, flag_b, touched_b, j, at_low * nx, at_low * ny)
                    carry = at_high
                    j += 1
                    if j1 != j:  # the last one, or a ring ends
                        if spread and carry != 0.0:
                            add_load(load_b, flag_b, touched_b, j1, carry * nx, carry * ny)
                        carry = 0.0
                        if j < stop:
                            rx, ry = at_b[j, 0] - px, at_b[j, 1] - py
                            x_s, g_s = rx * tx + ry * ty, rx * nx + ry * ny
                if spread and carry != 0.0:
                    add_load(load_b, flag_b, touched_b, stop, carry * nx, carry * ny)
            if total != 0.0:
                if spread:
                    end_load = first / length
                    f = end_load - total
                    add_load(load_a, flag_a, touched_a, i, f * nx, f * ny)
                    add_load(load_a, flag_a, touched_a, i1, -end_load * nx, -end_load * ny)
                fx += total * nx
                fy += total * ny
                moment += ((px - pose_a[0]) * ny - (py - pose_a[1]) * nx) * total - first
        if stiff > 0.0:
            if count == len(regions):
                return MANY
            r = regions[count]
            f = np.sqrt(fx * fx + fy * fy)
            r["force"], r["nx"], r["ny"] = f, fx / f, fy / f
            # the point of the line of action nearest to A's origin: the moment about that origin is kept
            r["x"], r["y"] = pose_a[0] + r["ny"] * moment / f, pose_a[1] - r["nx"] * moment / f
            r["x_chord"], r["y_chord"], r["chord"], r["area"] = r["x"], r["y"], stiff / k, f / k
            r["serial"] = s.load.made[1]
            count += 1
    if count == 0:
        s.load.made[0] = before
    return count
