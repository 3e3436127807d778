"""A body's hub: where it is, how it turns, and how it is driven.

Its angle is θ + Φ_h q + φ: the frame's, the modes', and that by static flexibility. Of all three the rate is the
scheme's, so the hub's rate is B times the rates of the unknowns with the same B that takes the hub's moment to them: a
damper takes the power that it should, whatever the step. (With φ left out of the rate a damper drives a hub that is
not at the centre of mass; with its difference over the step for a rate it still does, where ρ∞ > 0.) A force on the hub
stiffens a modal body by S_x and S_y (``frame``), so the hub moves by −½ qᵀ S q more than linearly: a beam that bends is
shorter. (A compliant body's hub has no such place: it would follow the hub's own force at once.)
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rigidarea.compile.jit import kernel
from rigidarea.flexible.boundary import Boundary, Work
from rigidarea.flexible.dense import dot
from rigidarea.flexible.tension import draw

Array = NDArray[np.float64]


@kernel
def prescribed(drive: Array, t: float) -> float:
    """Hub angle at time t: the angular velocity grows linearly over the ramp time, then stays."""
    if t < drive[2]:
        return drive[0] + 0.5 * drive[1] * t * t / drive[2]
    return drive[0] + drive[1] * (t - 0.5 * drive[2])


@kernel
def static_displacement(b: Boundary, w: Work, row: int) -> float:
    """Hub displacement (row 0, 1: body frame; 2: rotation) by static flexibility and spin (drawn)."""
    n = b.modes.shape[0] - 3 + row
    u = 0.0
    if b.flexibility.shape[0] > 0:
        c = b.flexibility[n]
        for k in range(w.loaded[-1]):
            j = w.loaded[k]
            u += c[2 * j] * w.node_load[j, 0] + c[2 * j + 1] * w.node_load[j, 1]
        for k in range(3):
            u += c[len(c) - 3 + k] * w.hub_load[k]
    if len(b.swell) > 0:
        u += b.swell[n] * w.spin[0]
    if w.tight[0]:
        u += dot(b.soft[n], w.drawn[0])
    return u


@kernel
def keep_turn(state, scheme, b, turn):  # type: ignore[no-untyped-def]
    """The static rotation of body b's hub in this step, and its rates by the scheme."""
    own = state.turn[b]
    d = turn - own[0]
    own[0] += d
    own[1] += scheme.vel * d
    own[2] += scheme.acc * d
    own[3] += scheme.correction * scheme.acc * d


@kernel
def hub_angle(body, sy, state, b):  # type: ignore[no-untyped-def]
    """World angle of body b's hub, and its rate."""
    turn, lo, hi = body.modes[len(body.modes) - 1], sy.first[b], sy.first[b + 1]
    angle = state.x[b, 2] + state.turn[b, 0] + dot(turn, state.q[lo:hi])
    return angle, state.v[b, 2] + state.turn[b, 1] + dot(turn, state.dq[lo:hi])


class Hub(NamedTuple):
    """A body's hub: arm from the frame's origin (world), rotation of its own, moment of motor, damper and torque."""

    x: float
    y: float
    turn: float
    moment: float


@kernel
def _shorter(stiff: Array, q: Array) -> float:
    """½ qᵀ S q."""
    out = 0.0
    for i in range(len(q)):
        out += 0.5 * q[i] * dot(stiff[i], q)
    return out


@kernel
def second_order(stiff, q, out):  # type: ignore[no-untyped-def]
    """What the hub moves by squares of a modal body's deformation, the predicted one, so that within a step it is a
    constant and Newton's iteration need not know its gradient. Into out (2,), body frame.

    stiff (3, m, m): of the body's modes q (m,), (0, m, m) where that is left out.
    """
    out[0] = out[1] = 0.0
    if len(stiff) > 0:
        out[0], out[1] = -_shorter(stiff[1], q), -_shorter(stiff[2], q)


@kernel
def hub_of(body, w, sy, buf, state, scheme, b):  # type: ignore[no-untyped-def]
    """The hub of body b in the present state."""
    n, q, c, s = len(body.modes), state.q[sy.first[b] : sy.first[b + 1]], buf.pose[b, 2], buf.pose[b, 3]
    if w.tight[0]:
        draw(body, w)
    x = buf.hubs[b, 6] + sy.hub[b, 0] + static_displacement(body, w, 0) + dot(body.modes[n - 3], q)
    y = buf.hubs[b, 7] + sy.hub[b, 1] + static_displacement(body, w, 1) + dot(body.modes[n - 2], q)
    keep_turn(state, scheme, b, static_displacement(body, w, 2))
    turn = state.turn[b, 0] + dot(body.modes[n - 1], q)
    return Hub(c * x - s * y, s * x + c * y, turn, state.mu[b, 2] + sy.torque[b])


@kernel
def hub_of_mode(body: Boundary, j: int, x: float, y: float, turn: float) -> float:
    """The hub's part in mode j, along (x, y, turn) in the body frame."""
    k = len(body.modes) - 3
    return float(x * body.modes[k, j] + y * body.modes[k + 1, j] + turn * body.modes[k + 2, j])


@kernel
def direction(kind: int, c: float, s: float) -> tuple[float, float, float]:
    """Hub component ``kind`` (0, 1: world displacement, 2: rotation) in the body frame."""
    if kind == 0:
        return c, -s, 0.0
    if kind == 1:
        return s, c, 0.0
    return 0.0, 0.0, 1.0
