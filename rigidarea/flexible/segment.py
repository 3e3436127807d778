"""Segment-to-segment penalty contact (STS), the baseline the paper holds its method against.

Every edge of the slave (body A) is cut by the projections of the master's (body B) edge ends along its normal; on
each part, two Gauss points carry p = ε ⟨−g⟩ (exact for the linear gap times a linear shape function, except where
the gap changes sign within a part), and shape functions hand the force to the nodes of both bodies. Cf. P. Wriggers,
Computational Contact Mechanics, 2nd ed., section 10.3, doi:10.1007/978-3-540-32609-0. ε is a force per area in 2-D,
as k is for the area method; on flat faces both give the same resultant. The signature is that of
``nodal.contact``: search, stepping and constraints are shared, only the evaluation differs.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rigidarea.flexible.boundary import Boundary, Work, add_load, place_leaves
from rigidarea.flexible.nodal import Scratch
from rigidarea.flexible.region import MANY
from rigidarea.kernel.jit import kernel

Array = NDArray[np.float64]

GAUSS = (0.5 - 0.5 / 3.0**0.5, 0.5 + 0.5 / 3.0**0.5)


@kernel
def contact(
    a: Boundary, wa: Work, pose_a: Array, qa: Array, b: Boundary, wb: Work, pose_b: Array, qb: Array,
    n_pairs: int, stamp: int, k: float, reach: float, spread: bool, s: Scratch,
) -> int:  # fmt: skip
    """STS for one pair: each slave leaf in contact leaves one resultant in ``s.regions`` (force, point, direction).

    k: the penalty ε. reach: length, the deepest penetration looked at (the other side of a thin body is no contact).
    Returns the number of resultants, or MANY.
    """
    # arrays out of the tuples once: inside the loops every access would count references
    next_a, first_a, size_a, at_a = a.next, a.right, a.left, wa.position
    next_b, first_b, size_b, at_b = b.next, b.right, b.left, wb.position
    place_leaves(a, wa, pose_a, qa, s.pairs, n_pairs, 0, stamp)
    place_leaves(b, wb, pose_b, qb, s.pairs, n_pairs, 1, stamp)
    load_a, flag_a, touched_a = wa.point_load, wa.point_flag, wa.touched
    load_b, flag_b, touched_b = wb.point_load, wb.point_flag, wb.touched
    pairs, regions = s.pairs, s.regions
    count = 0
    last = -1
    fx = fy = moment = stiff = 0.0
    for m in range(n_pairs + 1):
        leaf_a = pairs[m, 0] if m < n_pairs else -2
        if (
            leaf_a != last
        ):  # pairs come grouped by the slave's leaf or not: a group is whatever is consecutive
            if stiff > 0.0:
                if count == len(regions):
                    return MANY
                r = regions[count]
                f = np.hypot(fx, fy)
                r["force"], r["nx"], r["ny"] = f, fx / f, fy / f
                # the point of the line of action nearest to A's origin: the moment about that origin is kept
                r["x"], r["y"] = pose_a[0] + r["ny"] * moment / f, pose_a[1] - r["nx"] * moment / f
                r["x_chord"], r["y_chord"], r["chord"], r["area"] = r["x"], r["y"], stiff / k, f / k
                r["give"] = 1.0
                count += 1
            fx = fy = moment = stiff = 0.0
            last = leaf_a
        if m == n_pairs:
            break
        leaf_b = pairs[m, 1]
        for i in range(first_a[leaf_a], first_a[leaf_a] - size_a[leaf_a]):
            i1 = next_a[i]
            px, py = at_a[i, 0], at_a[i, 1]
            tx, ty = at_a[i1, 0] - px, at_a[i1, 1] - py
            length = np.hypot(tx, ty)
            tx, ty = tx / length, ty / length
            nx, ny = ty, -tx  # outward
            for j in range(first_b[leaf_b], first_b[leaf_b] - size_b[leaf_b]):
                j1 = next_b[j]
                rx, ry = at_b[j, 0] - px, at_b[j, 1] - py
                sx, sy = at_b[j1, 0] - px, at_b[j1, 1] - py
                x_r, x_s = rx * tx + ry * ty, sx * tx + sy * ty
                if x_s >= x_r:  # facing the same way: no contact
                    continue
                lo, hi = max(0.0, x_s), min(length, x_r)
                if hi <= lo:
                    continue
                g_r, g_s = rx * nx + ry * ny, sx * nx + sy * ny
                if min(g_r, g_s) >= 0.0 or max(g_r, g_s) < -reach:
                    continue
                for g in range(2):
                    x = lo + GAUSS[g] * (hi - lo)
                    eta = (x_r - x) / (x_r - x_s)
                    gap = g_r + eta * (g_s - g_r)
                    if gap >= 0.0 or gap < -reach:
                        continue
                    w = 0.5 * (hi - lo) * k
                    f = -gap * w
                    xi = x / length
                    if spread:
                        add_load(load_a, flag_a, touched_a, i, -(1.0 - xi) * f * nx, -(1.0 - xi) * f * ny)
                        add_load(load_a, flag_a, touched_a, i1, -xi * f * nx, -xi * f * ny)
                        add_load(load_b, flag_b, touched_b, j, (1.0 - eta) * f * nx, (1.0 - eta) * f * ny)
                        add_load(load_b, flag_b, touched_b, j1, eta * f * nx, eta * f * ny)
                    fx += f * nx
                    fy += f * ny
                    hx, hy = px + x * tx - pose_a[0], py + x * ty - pose_a[1]
                    moment += (hx * ny - hy * nx) * f
                    stiff += w
    return count
