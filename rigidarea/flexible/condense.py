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
def beneath(
    b: Boundary, w: Work, pose: Array, nx: float, ny: float, edge: Ints, n: int, foremost: int, middle: int
) -> tuple[float, float]:
    """Compliance of a body at node ``middle`` (length/force), and the resultant that its present displacement under
    the region came from.

    (nx, ny): direction of the force on this body, world. edge (n,): the contact edges of its arc, ``foremost`` the
    one that comes last along the perimeter.
    """
    n_modes, static = b.modes.shape[1], b.flexibility.shape[0] > 0
    if n_modes == 0 and not static:
        return 0.0, 0.0
    ex, ey = pose[2] * nx + pose[3] * ny, -pose[3] * nx + pose[2] * ny
    c = 0.0
    i = 2 * middle
    if static:
        c += ex * ex * b.flexibility[i, i] + ey * ey * b.flexibility[i + 1, i + 1]
        c += 2.0 * ex * ey * b.flexibility[i, i + 1]
    for k in range(n_modes):
        e = ex * b.modes[i, k] + ey * b.modes[i + 1, k]
        c += e * e * w.mobility[k]
    # the arc's finite-element nodes: the low end of each edge, and the high end of the foremost
    node = b.high[foremost]
    force = ex * w.node_load[node, 0] + ey * w.node_load[node, 1]
    for k in range(n):
        if b.low[edge[k]] != node:
            node = b.low[edge[k]]
            force += ex * w.node_load[node, 0] + ey * w.node_load[node, 1]
    return c, force


@kernel
def resultant(
    a: Boundary, wa: Work, pose_a: Array, b: Boundary, wb: Work, pose_b: Array, r: Any, edge: Ints, n_a: int, n_b: int,
    stiffness: float,
) -> None:  # fmt: skip
    """Turns a region's force from k A into F and notes 1/(1 + κ) as ``give``; ``stiffness`` is k L."""
    nx, ny = r["nx"], r["ny"]
    r["node_a"], r["node_b"] = a.low[edge[0, n_a // 2]], b.low[edge[1, n_b // 2]]
    c_a, before_a = beneath(a, wa, pose_a, -nx, -ny, edge[0], n_a, edge[0, n_a - 1], r["node_a"])
    c_b, before_b = beneath(b, wb, pose_b, nx, ny, edge[1], n_b, edge[1, 0], r["node_b"])
    r["give"] = 1.0 / (1.0 + stiffness * (c_a + c_b))
    r["force"] = r["give"] * (r["force"] + stiffness * (c_a * before_a + c_b * before_b))


@kernel
def hub_row(b: Boundary, w: Work, pose: Array, nx: float, ny: float, node: int, row: Array) -> None:
    """What loads on the hub move ``node`` along the world direction (nx, ny): row (3,), force x, y and moment, world.

    By reciprocity also what a force on the node in that direction moves the hub.
    """
    ex, ey = pose[2] * nx + pose[3] * ny, -pose[3] * nx + pose[2] * ny
    row[:] = 0.0
    i, h = 2 * node, b.modes.shape[0] - 3
    for k in range(3):
        if b.flexibility.shape[0] > 0:
            row[k] += ex * b.flexibility[i, h + k] + ey * b.flexibility[i + 1, h + k]
        for m in range(b.modes.shape[1]):
            row[k] += (ex * b.modes[i, m] + ey * b.modes[i + 1, m]) * w.mobility[m] * b.modes[h + k, m]
    x, y = row[0], row[1]
    row[0], row[1] = pose[2] * x - pose[3] * y, pose[3] * x + pose[2] * y
