"""Contact force and quasi-static deformation solved together: a region's resultant condensed in Newton's iteration.

Displacements u = Φ q + C f enter an evaluation with the loads of the one before. On a soft body that alone runs
away: a force F pushes the boundary back by c F, c the compliance under the region, so the next evaluation sees less
overlap by c F, k L c times what it should. Newton on the resultant takes this in. The force that an evaluation
finds is k A; the displacement behind it came from F₀; by the time both agree

    F = k A − k L c (F − F₀)     ⇒     F = (k A + κ F₀)/(1 + κ),  κ = k L c,

a weighted mean, so it never pulls, and against the bodies' frames the contact is as stiff as spring and body in
series, k L/(1 + κ). k A grows at least in proportion to the overlap, so this Newton converges from the undeformed
side. c holds the static flexibility and what the modes give within a step, 1/(M' + C' + ω²) each, with M', C' the
scheme's multiples of inertia and damping. An estimate suffices: it sets the speed of convergence, not the result.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidarea.flexible.boundary import Boundary, Work
from rigidarea.kernel.jit import kernel

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@kernel
def _anchor(b: Boundary, x: Array, edge: Ints, t: Array, n: int, at: float) -> tuple[int, int, float]:
    """The place on an arc above ``at`` on the chord: two finite-element nodes, and the share of the second."""
    k = 0
    while k < n - 1 and x[k + 1] < at:
        k += 1
    width = x[k + 1] - x[k]
    part = min(max((at - x[k]) / width, 0.0), 1.0) if width > 0.0 else 0.5
    along = t[k, 0] + part * (t[k, 1] - t[k, 0])
    i, j = edge[k], b.next[edge[k]]
    if b.share[j] > 0.0:  # both points within one finite-element edge
        return b.low[i], b.high[j], b.share[i] + along * (b.share[j] - b.share[i])
    return b.low[i], b.low[j], b.share[i] + along * (1.0 - b.share[i])


@kernel
def by_mode(b: Boundary, low: int, high: int, share: float, ex: float, ey: float, column: int) -> float:
    """Displacement along (ex, ey), body frame, of a place between two nodes, by mode ``column``."""
    m, n = 2 * low, 2 * high
    return (1.0 - share) * (ex * b.modes[m, column] + ey * b.modes[m + 1, column]) + share * (
        ex * b.modes[n, column] + ey * b.modes[n + 1, column]
    )


@kernel
def _static(b: Boundary, low: int, high: int, share: float, ex: float, ey: float, row: int) -> float:
    """The same by a unit load on interface ``row`` and the static flexibility."""
    c = b.flexibility[row]
    m, n = 2 * low, 2 * high
    return (1.0 - share) * (ex * c[m] + ey * c[m + 1]) + share * (ex * c[n] + ey * c[n + 1])


@kernel
def _compliance(b: Boundary, w: Work, low: int, high: int, share: float, ex: float, ey: float) -> float:
    """Displacement along (ex, ey) of a place between two nodes, by a unit force there in that direction."""
    c = 0.0
    if b.flexibility.shape[0] > 0:
        for end in range(2):
            weight, i = (1.0 - share, 2 * low) if end == 0 else (share, 2 * high)
            c += weight * ex * _static(b, low, high, share, ex, ey, i)
            c += weight * ey * _static(b, low, high, share, ex, ey, i + 1)
    for k in range(b.modes.shape[1]):
        c += by_mode(b, low, high, share, ex, ey, k) ** 2 * w.mobility[k]
    return c


@kernel
def _before(b: Boundary, w: Work, edge: Ints, n: int, ex: float, ey: float) -> float:
    """Force along (ex, ey) that the nodes under an arc's edges carried in the evaluation before."""
    force = 0.0
    for k in range(n):
        for end in range(2):
            i = edge[k] if end == 0 else b.next[edge[k]]
            for side in range(2 if b.share[i] > 0.0 else 1):
                node = b.low[i] if side == 0 else b.high[i]
                if w.node_flag[node]:  # down while counting: each node once
                    w.node_flag[node] = False
                    force += ex * w.node_load[node, 0] + ey * w.node_load[node, 1]
    for k in range(w.loaded[-1]):
        w.node_flag[w.loaded[k]] = True
    return force


@kernel
def resultant(
    a: Boundary, wa: Work, pose_a: Array, b: Boundary, wb: Work, pose_b: Array, r: Any, x: Array, edge: Ints, t: Array,
    n_a: int, n_b: int, stiffness: float,
) -> None:  # fmt: skip
    """Turns a region's force from k A into F; notes 1/(1 + κ) and the arcs' middles. ``stiffness`` is k L."""
    nx, ny, middle = r["nx"], r["ny"], 0.5 * x[0, n_a]
    kappa = force = 0.0
    r["low_a"], r["high_a"], r["share_a"] = _anchor(a, x[0], edge[0], t[0], n_a, middle)
    r["low_b"], r["high_b"], r["share_b"] = _anchor(b, x[1], edge[1], t[1], n_b, middle)
    if a.modes.shape[1] > 0 or a.flexibility.shape[0] > 0:
        ex, ey = -pose_a[2] * nx - pose_a[3] * ny, pose_a[3] * nx - pose_a[2] * ny
        part = stiffness * _compliance(a, wa, r["low_a"], r["high_a"], r["share_a"], ex, ey)
        kappa += part
        force += part * _before(a, wa, edge[0], n_a, ex, ey)
    if b.modes.shape[1] > 0 or b.flexibility.shape[0] > 0:
        ex, ey = pose_b[2] * nx + pose_b[3] * ny, -pose_b[3] * nx + pose_b[2] * ny
        part = stiffness * _compliance(b, wb, r["low_b"], r["high_b"], r["share_b"], ex, ey)
        kappa += part
        force += part * _before(b, wb, edge[1], n_b, ex, ey)
    r["give"] = 1.0 / (1.0 + kappa)
    r["force"] = r["give"] * (r["force"] + force)


@kernel
def hub_row(
    b: Boundary, w: Work, pose: Array, nx: float, ny: float, low: int, high: int, share: float, row: Array
) -> None:
    """What loads on the hub move a place between two nodes along the world direction (nx, ny): row (3,), force x, y
    and moment, world.

    By reciprocity also what a force there in that direction moves the hub.
    """
    ex, ey = pose[2] * nx + pose[3] * ny, -pose[3] * nx + pose[2] * ny
    row[:] = 0.0
    h = b.modes.shape[0] - 3
    for k in range(3):
        if b.flexibility.shape[0] > 0:
            row[k] += _static(b, low, high, share, ex, ey, h + k)
        for m in range(b.modes.shape[1]):
            row[k] += by_mode(b, low, high, share, ex, ey, m) * w.mobility[m] * b.modes[h + k, m]
    x, y = row[0], row[1]
    row[0], row[1] = pose[2] * x - pose[3] * y, pose[3] * x + pose[2] * y
