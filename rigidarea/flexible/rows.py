"""Rows of Newton's system in ``step``: residual and matrix of frames, modes, hubs' constraints."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rigidarea.compile.jit import kernel
from rigidarea.flexible.boundary import Boundary, Work
from rigidarea.flexible.hub import direction, hub_angle, hub_of_mode, prescribed
from rigidarea.flexible.tension import between

Array = NDArray[np.float64]


class Scheme(NamedTuple):
    """Constants of generalised-α for one step length."""

    am: float
    gamma: float
    beta: float
    h: float
    acc: float  # ∂ acceleration / ∂ position
    vel: float  # ∂ velocity / ∂ position
    correction: float  # ∂ auxiliary acceleration / ∂ acceleration
    scale: float  # of the dynamic rows, inverse of the multipliers'


@kernel
def scheme_of(rho: float, h: float) -> Scheme:
    am, af = (2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0)
    gamma = 0.5 + af - am
    beta = 0.25 * (gamma + 0.5) ** 2
    acc = (1.0 - am) / (h * h * beta * (1.0 - af))
    return Scheme(am, gamma, beta, h, acc, gamma / (h * beta), (1.0 - af) / (1.0 - am), beta * h * h)


@kernel
def frame_rows(w, sy, buf, state, scheme, b, hub, moment):  # type: ignore[no-untyped-def]
    """Residual and matrix of one free frame; ``moment`` of its inertia. Returns the largest force, and residual."""
    m, rhs, k, size, mass = buf.matrix, buf.rhs, 3 * b, sy.size[b], sy.mass[b]
    mux, muy = state.mu[b, 0], state.mu[b, 1]
    weight_x, weight_y = mass * sy.gravity[0], mass * sy.gravity[1]
    rhs[k] = mass * state.acc[b, 0] - weight_x - buf.load[b, 0] - mux
    rhs[k + 1] = mass * state.acc[b, 1] - weight_y - buf.load[b, 1] - muy
    rhs[k + 2] = moment - buf.load[b, 2] - (hub.x * muy - hub.y * mux) - hub.moment
    reference = max(np.hypot(weight_x, weight_y), mass * abs(state.acc[b, 0]), mass * abs(state.acc[b, 1]),
                    abs(moment) / size, abs(buf.load[b, 2]) / size)  # fmt: skip
    worst = max(abs(rhs[k]), abs(rhs[k + 1]), abs(rhs[k + 2]) / size)
    # dynamic rows times scale, multipliers over scale
    m[k, k] = m[k + 1, k + 1] = mass * scheme.acc * scheme.scale
    turning = buf.hubs[b, 8]
    for j in range(sy.first[b], sy.first[b + 1]):  # the modes go with it, eliminated
        c = buf.swing[j] * w.mobility[j - sy.first[b]]
        turning -= c * buf.swing[j]
        rhs[k + 2] -= c * buf.modal_residual[j]
    m[k + 2, k + 2] = turning * scheme.scale
    for i in range(k, k + 3):
        for j in range(3 * len(sy.mass)):
            m[i, j] += buf.tangent[i, j] * scheme.scale
        rhs[i] = scheme.scale * (buf.push[i] - rhs[i])
    return reference, worst


@kernel
def mode_rows(body: Boundary, w: Work, sy, buf, state, b, hub):  # type: ignore[no-untyped-def]
    """Adds all but inertia to the modes' residual; returns the largest force, and residual, as nodal ones."""
    lo, hi = sy.first[b], sy.first[b + 1]
    if lo == hi:
        return 0.0, 0.0
    c, s = buf.pose[b, 2], buf.pose[b, 3]
    mux, muy = state.mu[b, 0], state.mu[b, 1]
    residual, modes = buf.modal_residual[lo:hi], body.modes
    _less(residual, modes, len(modes) - 3, c * mux + s * muy, -s * mux + c * muy)
    for j in range(hi - lo):
        residual[j] -= modes[len(modes) - 1, j] * hub.moment
    for n in range(w.loaded[-1]):
        node = w.loaded[n]
        _less(residual, modes, 2 * node, w.node_load[node, 0], w.node_load[node, 1])
    reference = worst = 0.0
    for j in range(hi - lo):
        elastic = sy.square[lo + j] * state.q[lo + j]
        residual[j] += sy.viscous[lo + j] * state.dq[lo + j] + elastic
        reference, worst = max(reference, abs(elastic)), max(worst, abs(residual[j]))
    # a modal force of φ f, made a nodal one by the largest entry a mass-orthonormal mode can have
    root = np.sqrt(sy.mass[b])
    return reference * root, worst * root


@kernel
def _less(residual: Array, modes: Array, row: int, fx: float, fy: float) -> None:
    """Takes the modal forces of a force on one node, rows ``row`` and ``row`` + 1, from the residual."""
    row_x, row_y = modes[row], modes[row + 1]
    for j in range(len(residual)):
        residual[j] -= row_x[j] * fx + row_y[j] * fy


@kernel
def constraint_rows(body: Boundary, w: Work, sy, buf, state, scheme, b, hub, t):  # type: ignore[no-untyped-def]
    """Rows of one body's pin and drive, or damper, its compliance at the hub among them: (largest violation, force).

    A damper's moment is an unknown as a drive's is: moment + c · rate = 0, over what makes the rate's part and the
    moment's of one size. Its row has a ``share`` of what moves the hub, kept in ``buf.hubs``; the force is what the
    row is off by.
    """
    m, rhs, k = buf.matrix, buf.rhs, 3 * b
    lo, hi = sy.first[b], sy.first[b + 1]
    c, s, n = buf.pose[b, 2], buf.pose[b, 3], len(body.modes)
    worst = off = 0.0
    share = buf.hubs[b, 5] = 1.0
    for kind in range(3):
        row = buf.column[k + kind]
        if row < 0:
            continue
        if kind == 0:
            g = state.x[b, 0] + hub.x - sy.anchor[b, 0]
            m[row, k], m[row, k + 2] = 1.0, -hub.y
        elif kind == 1:
            g = state.x[b, 1] + hub.y - sy.anchor[b, 1]
            m[row, k + 1], m[row, k + 2] = 1.0, hub.x
        elif sy.driven[b] == 1:
            g = state.x[b, 2] + hub.turn - prescribed(sy.drive[b], t)
            m[row, k + 2] = 1.0
        else:
            _angle, rate = hub_angle(body, sy, state, b)
            left = state.mu[b, 2] + sy.damper[b] * rate
            off = abs(left) / sy.size[b]
            whole = sy.damper[b] * scheme.vel + sy.inertia[b] * scheme.acc
            g = left / whole
            share = buf.hubs[b, 5] = sy.damper[b] * scheme.vel / whole
            m[row, k + 2], m[row, row] = 1.0, 1.0 / (whole * scheme.scale)
        if kind < 2 or sy.driven[b] == 1:
            worst = max(worst, abs(g) / (sy.size[b] if kind < 2 else 1.0))
        e = direction(kind, c, s)
        rhs[row] = -g - share * buf.push[3 * len(sy.mass) + k + kind]
        # modes move the hub by their own residual in this iteration, and as the frame turns
        for j in range(hi - lo):
            pe = hub_of_mode(body, j, e[0], e[1], e[2])
            rhs[row] += share * pe * buf.modal_residual[lo + j] * w.mobility[j]
            m[row, k + 2] -= pe * buf.swing[lo + j] * w.mobility[j]
        for i in range(k, k + 3):
            if sy.fixed[b] == 1:
                m[row, i] = 0.0
            m[i, row] = -m[row, i]
            m[row, i] *= share
        for other in range(3):
            column = buf.column[k + other]
            if column < 0:
                continue
            d = direction(other, c, s)
            value = 0.0
            if body.flexibility.shape[0] > 0:
                for i in range(3):
                    for j in range(3):
                        part = body.flexibility[n - 3 + i, n - 3 + j]
                        if w.tight[0]:
                            part += between(body, w, n - 3 + i, n - 3 + j)
                        value += e[i] * part * d[j]
            for j in range(hi - lo):
                pe = hub_of_mode(body, j, e[0], e[1], e[2])
                pd = hub_of_mode(body, j, d[0], d[1], d[2])
                value += pe * pd * w.mobility[j]
            m[row, column] += share * value / scheme.scale
    return worst, off


@kernel
def held_contacts(sy, buf, scheme):  # type: ignore[no-untyped-def]
    """The contacts' tangent of bodies that are held by their hubs."""
    m, n3 = buf.matrix, 3 * len(sy.mass)
    for i in range(n3):
        row = buf.column[i]
        if row < 0:
            continue
        share = buf.hubs[i // 3, 5] if i % 3 == 2 else 1.0
        for j in range(n3):
            if sy.fixed[j // 3] == 0:
                m[j, row] += buf.tangent[j, n3 + i]
                m[row, j] -= share * buf.tangent[n3 + i, j]
            if buf.column[j] >= 0:
                m[row, buf.column[j]] -= share * buf.tangent[n3 + i, n3 + j] / scheme.scale
