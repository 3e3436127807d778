"""What spin and the hub's force do to the static flexibility of a compliant body: tension stiffens, centrifugal
forces grow outwards.

With K the stiffness, S the geometric stiffness of the stress by centrifugal forces of unit angular velocity, S_x and
S_y by unit forces on the hub, and M the mass, a body that turns at ω under a hub force F (body frame) is at rest where

    (K + ω² (S − M) + F_x S_x + F_y S_y) u = f + ω² M x,

as the modal level has it without inertia (``frame``). All but K act on what bends most: on the body's first modes,
scaled so that Ψᵀ K Ψ = I. With G the rest of the matrix there, C becomes C + Ψ D Ψᵀ, where

    D = (I + G)⁻¹ − I = −(I + G)⁻¹ G.

D is that of the spin and the hub's force at the step's start: within a step the flexibility is constant.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidarea.compile.jit import entry, kernel
from rigidarea.flexible.boundary import Boundary, Work
from rigidarea.flexible.dense import dot, eliminate

Array = NDArray[np.float64]

SLACK = 1e-5  # largest part of the stiffness that is left out: a hundredth of what a mesh is off by


@entry(forceinline=False)
def matrix(tension: Array, spin: float, fx: float, fy: float, out: Array) -> bool:
    """D (r, r) in the right half of ``out`` (r, 2 r); whether G is more than SLACK, else D is not made.

    tension (3, r, r): S − M, S_x and S_y in the basis Ψ; spin: the squared angular velocity.
    """
    r = tension.shape[1]
    most = 0.0
    for i in range(r):
        for j in range(i + 1):  # they are symmetric
            g = spin * tension[0, i, j] + fx * tension[1, i, j] + fy * tension[2, i, j]
            most = max(most, abs(g))
            out[i, j] = out[j, i] = g
    if most <= SLACK:
        return False
    for i in range(r):
        for j in range(r):
            out[i, r + j] = -out[i, j]
        out[i, i] += 1.0
    eliminate(out, r, r)
    return True


def tense(body: Any) -> Array:
    """The most (3,) that S − M, S_x and S_y change in the stiffness of a body (``integrate.Body``): their largest
    entry, over the frequencies of a modal body's modes or in a compliant body's basis; zeros where it has neither."""
    if body.geometric is not None and body.geometric.size > 0:
        omega = np.asarray(body.frequency, float)
        return np.asarray(np.abs(body.geometric / np.outer(omega, omega)).max((1, 2)))
    stiff = body.boundary.tension
    return np.asarray(np.abs(stiff).max((1, 2))) if stiff.size > 0 else np.zeros(3)


@kernel(forceinline=True)
def slack(most: Array, spin: float, fx: float, fy: float) -> bool:
    """Whether tension by spin (squared angular velocity) and the hub's force is less than SLACK of a body's stiffness;
    most (3,): see ``tense``."""
    return spin * most[0] + abs(fx) * most[1] + abs(fy) * most[2] < SLACK


@kernel(forceinline=True)
def tighten(b: Boundary, w: Work, most: Array) -> None:
    """Takes D from ``w.spin`` and ``w.hub_load``, at the start of a step; most (3,): see ``tense``."""
    fx, fy = w.hub_load[0], w.hub_load[1]
    w.tight[0] = (
        len(b.tension) > 0
        and not slack(most, w.spin[0], fx, fy)
        and matrix(b.tension, w.spin[0], fx, fy, w.yielding)
    )


@kernel
def draw(b: Boundary, w: Work) -> None:
    """What the present loads and spin move: coordinates D (Ψᵀ f + ω² h) in ``w.drawn[0]``, those of hub and spin alone
    in ``w.drawn[1]``. For a body that is tight."""
    r = b.soft.shape[1]
    d, rest, total = w.yielding[:, r:], w.drawn[1], w.drawn[2]
    for k in range(r):
        total[k] = w.spin[0] * b.soft_stretch[k]
    for i in range(3):
        row, f = b.soft[len(b.soft) - 3 + i], w.hub_load[i]
        for k in range(r):
            total[k] += row[k] * f
    for k in range(r):
        rest[k] = dot(d[k], total)
    for n in range(w.loaded[-1]):
        node = w.loaded[n]
        fx, fy = w.node_load[node, 0], w.node_load[node, 1]
        for k in range(r):
            total[k] += b.soft[2 * node, k] * fx + b.soft[2 * node + 1, k] * fy
    for k in range(r):
        w.drawn[0, k] = dot(d[k], total)


@kernel
def pull(b: Boundary, w: Work, row: int, ex: float, ey: float) -> None:
    """D Ψᵀ of a unit force along (ex, ey) on the node of ``row`` and ``row`` + 1, into ``w.drawn[2]``."""
    r = b.soft.shape[1]
    top, low = b.soft[row], b.soft[row + 1]
    for k in range(r):
        d, s = w.yielding[k, r:], 0.0
        for j in range(r):
            s += d[j] * (ex * top[j] + ey * low[j])
        w.drawn[2, k] = s


@kernel
def follow(b: Boundary, w: Work, which: int, row: int, ex: float, ey: float) -> float:
    """Along (ex, ey) at the node of ``row`` and ``row`` + 1, what the coordinates ``w.drawn[which]`` move."""
    return ex * dot(b.soft[row], w.drawn[which]) + ey * dot(b.soft[row + 1], w.drawn[which])


@kernel
def between(b: Boundary, w: Work, row: int, column: int) -> float:
    """The entry of Ψ D Ψᵀ at two rows of the interface."""
    r, out = b.soft.shape[1], 0.0
    for k in range(r):
        out += b.soft[row, k] * dot(w.yielding[k, r:], b.soft[column])
    return out
