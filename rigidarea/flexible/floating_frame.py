"""Planar floating frame of reference (FFRF) with lumped masses and free-free modes.

A. A. Shabana, Dynamics of Multibody Systems, 5th ed., chapter 5. A node is at r = R + A(θ)(x + Φ q), so
ṙ = Ṙ + A(J (x + Φ q) θ̇ + Φ q̇), J the quarter turn. Free-free modes about the centre of mass have no linear and
no angular momentum at rest, which leaves of LᵀML

    M_RR = m I,  M_θθ = J₀ + 2 hᵀq + qᵀq,  M_θq = (G q)ᵀ,  M_qq = I,  M_Rθ = 0,  M_Rq = 0

and of −LᵀML̇ the quadratic velocity forces Q_θ = −2 θ̇ (h + q)ᵀq̇, Q_q = θ̇² (h + q) − 2 θ̇ G q̇. (M_Rθ and M_Rq
are zero because the modes have no net momentum in any orientation.)

A body under tension is stiffer than a linear one: points that move across it also come nearer to each other, by
squares of the modes, and so nearer to the axis (A. K. Banerjee and J. M. Dickens, J. Guidance 13, 1990,
doi:10.2514/3.20527: motion stiffness). With S the geometric stiffness of the stress that centrifugal forces of unit
angular velocity cause, that takes ½ θ̇² qᵀ S q from the kinetic energy: q becomes (I − S) q wherever θ̇² or M_θθ
multiplies it. What the hub's force F, body frame, adds to the stress is in the modal stiffness: F_x S_x + F_y S_y.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rigidarea.compile.jit import entry, kernel
from rigidarea.flexible.dense import dot

Array = NDArray[np.float64]


@entry
def inertia_forces(
    j0: float, h: Array, g: Array, stiff: Array, fx: float, fy: float, q: Array, dq: Array, ddq: Array, omega: float,
    alpha: float, out: Array, work: Array,
) -> float:  # fmt: skip
    """M q̈ − Q_v of one body: returns the row of θ (a moment), writes the modal rows (m,) to ``out``.

    j0: moment of inertia of the undeformed body; h, g, stiff: ``stretch``, ``coupling`` and ``geometric`` (3, m, m, or
    none: (0, m, m)) of ``modes.Reduced``; fx, fy: force on the hub, body frame; omega, alpha: angular velocity and
    acceleration of the frame. work (4, m): G q, G q̇, (I − S) q are left in it. The rows of R are m R̈.
    """
    m = len(q)
    if m == 0:
        return j0 * alpha
    gq, gd, free, tension = work[0], work[1], work[2], work[3]
    for i in range(m):
        gq[i] = gd[i] = tension[i] = 0.0
        free[i] = q[i]
    # by rows, which lie in memory as they are used: G is antisymmetric, S symmetric
    for k in range(m):
        row, x, y = g[k], q[k], dq[k]
        for i in range(m):
            gq[i] -= row[i] * x
            gd[i] -= row[i] * y
    for k in range(m if len(stiff) > 0 else 0):
        spin, along, across, x = stiff[0, k], stiff[1, k], stiff[2, k], q[k]
        for i in range(m):
            free[i] -= spin[i] * x
            tension[i] += (fx * along[i] + fy * across[i]) * x
    moment, j = 0.0, j0
    for i in range(m):
        j += 2.0 * h[i] * q[i] + q[i] * free[i]
        moment += gq[i] * ddq[i] + 2.0 * omega * (h[i] + free[i]) * dq[i]
        out[i] = gq[i] * alpha + ddq[i] - omega * omega * (h[i] + free[i]) + 2.0 * omega * gd[i] + tension[i]
    return moment + j * alpha


@kernel
def momentum_of_modes(h: Array, g: Array, stiff: Array, q: Array, dq: Array) -> tuple[float, float]:
    """What modes add to the moment of inertia, 2 hᵀq + qᵀ(I − S) q, and their own moment of momentum, (G q)ᵀ q̇."""
    inertia = momentum = 0.0
    for i in range(len(q)):
        inertia += q[i] * (2.0 * h[i] + q[i])
        if len(stiff) > 0:
            inertia -= q[i] * dot(stiff[0, i], q)
        momentum += dot(g[i], q) * dq[i]
    return inertia, momentum


@kernel
def turning_rows(
    h: Array, q: Array, dq: Array, j0: float, acc: float, vel: float, work: Array, out: Array
) -> float:
    """Gradient of ``inertia_forces``, whose ``work`` is read, by the frame's angle: of the row of θ, returned, and of
    the modes' (m,) into ``out``; that of the row of θ by the modes is the same. Left out is a step times a rate of it.

    acc, vel: change of an acceleration, and of a velocity, by that of its position.
    """
    gq, free = work[0], work[2]
    inertia, moving = j0, 0.0
    for i in range(len(q)):
        out[i] = acc * gq[i]
        inertia += (2.0 * h[i] + free[i]) * q[i]
        moving += 2.0 * (h[i] + free[i]) * dq[i]
    return inertia * acc + moving * vel
