"""A body's hub: where it is, how it turns, and how it is driven."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rigidarea.flexible.boundary import Boundary, Work
from rigidarea.flexible.dense import dot
from rigidarea.flexible.tension import draw
from rigidarea.kernel.jit import kernel

Array = NDArray[np.float64]


@kernel
def prescribed(drive: Array, t: float) -> float:
    """Hub angle at time t: the angular velocity grows linearly over the ramp time, then stays."""
    if t < drive[2]:
        return drive[0] + 0.5 * drive[1] * t * t / drive[2]
    return drive[0] + drive[1] * (t - 0.5 * drive[2])


@kernel
def hub_displacement(b: Boundary, w: Work, modal: Array, row: int) -> float:
    """Hub displacement (row 0, 1: body frame; 2: rotation) by modes, static flexibility and spin (drawn)."""
    n = b.modes.shape[0] - 3 + row
    u = dot(b.modes[n], modal)
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
def hub_rate(b: Boundary, dq: Array) -> float:
    """Angular velocity of the hub in the body frame."""
    return float(dot(b.modes[len(b.modes) - 1], dq))


class Hub(NamedTuple):
    """A body's hub: arm from the frame's origin (world), rotation of its own, moment of motor, torque and damper."""

    x: float
    y: float
    turn: float
    moment: float


@kernel
def hub_of(body, w, sy, buf, state, b):  # type: ignore[no-untyped-def]
    """The hub of body b in the present state."""
    if w.tight[0]:
        draw(body, w)
    lo, hi = sy.first[b], sy.first[b + 1]
    c, s, q = buf.pose[b, 2], buf.pose[b, 3], state.q[lo:hi]
    x, y = sy.hub[b, 0] + hub_displacement(body, w, q, 0), sy.hub[b, 1] + hub_displacement(body, w, q, 1)
    rate = state.v[b, 2] + hub_rate(body, state.dq[lo:hi])
    moment = state.mu[b, 2] + sy.torque[b] - sy.damper[b] * rate
    return Hub(c * x - s * y, s * x + c * y, hub_displacement(body, w, q, 2), moment)


@kernel
def direction(kind: int, c: float, s: float) -> tuple[float, float, float]:
    """Hub component ``kind`` (0, 1: world displacement, 2: rotation) in the body frame."""
    if kind == 0:
        return c, -s, 0.0
    if kind == 1:
        return s, c, 0.0
    return 0.0, 0.0, 1.0
