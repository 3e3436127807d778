"""Joints between bodies, or to the ground: revolute, slider, weld, spring and damper.

They hold points of the bodies' frames: as gravity does, what they carry acts on a body as a whole, and its deformation
answers to contacts and to its hub alone. With p the points, J the constraint's gradient and λ its multiplier, the
force on frames is Jᵀ λ; λ stands in the state after the hubs' multipliers:

    revolute  p_b − p_a = 0                                    λ: force on b
    slider    n · (p_b − p_a) = 0, θ_b − θ_a = φ               λ: force on b along n at p_b, moment on b
    weld      p_b − p_a = 0, θ_b − θ_a = φ                     λ: force and moment on b
    spring    tension k (l − l₀) + c l', l = |p_b − p_a|

n is across the slider's axis, which turns with a. A. A. Shabana, Dynamics of Multibody Systems, 5th ed., chapter 3.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigidarea.compile.jit import kernel

KINDS = ("revolute", "slider", "weld", "spring")
REVOLUTE, SLIDER, WELD, SPRING = range(4)
ROWS = 3  # multipliers a joint has room for

JOINT = np.dtype(
    [(name, "i8") for name in ("kind", "a", "b")]
    + [(name, "f8") for name in ("ax", "ay", "bx", "by", "nx", "ny", "angle", "rest", "stiffness", "damping")]
)


@dataclass(frozen=True)
class Joint:
    """One joint. kind: of ``KINDS``; a, b: body numbers, a = -1 the ground.

    at_a, at_b (2,): its points in the bodies' frames (length; of the ground: world). axis (2,): of a slider, in the
    frame of a. angle: θ_b − θ_a that slider and weld keep. rest (length), stiffness (force/length), damping
    (force/velocity): of a spring.
    """

    kind: str
    a: int
    b: int
    at_a: tuple[float, float] = (0.0, 0.0)
    at_b: tuple[float, float] = (0.0, 0.0)
    axis: tuple[float, float] = (1.0, 0.0)
    angle: float = 0.0
    rest: float = 0.0
    stiffness: float = 0.0
    damping: float = 0.0

    def row(self) -> tuple[float, ...]:
        """The joint as a row of ``JOINT``."""
        x, y = np.array(self.axis) / np.hypot(*self.axis)
        return (
            KINDS.index(self.kind), self.a, self.b, *self.at_a, *self.at_b, -y, x, self.angle, self.rest,
            self.stiffness, self.damping,
        )  # fmt: skip


@kernel
def _place(j, buf):  # type: ignore[no-untyped-def]
    """World places of the joint's points, and their arms from the frames' origins: p_a, p_b, arm_a, arm_b."""
    ax, ay = j["ax"], j["ay"]
    px, py = ax, ay
    if j["a"] >= 0:
        pose = buf.pose[j["a"]]
        ax, ay = pose[2] * ax - pose[3] * ay, pose[3] * ax + pose[2] * ay
        px, py = pose[0] + ax, pose[1] + ay
    pose = buf.pose[j["b"]]
    bx, by = pose[2] * j["bx"] - pose[3] * j["by"], pose[3] * j["bx"] + pose[2] * j["by"]
    return px, py, pose[0] + bx, pose[1] + by, ax, ay, bx, by


@kernel
def _across(j, buf):  # type: ignore[no-untyped-def]
    """World direction across a slider's axis."""
    nx, ny = j["nx"], j["ny"]
    if j["a"] < 0:
        return nx, ny
    pose = buf.pose[j["a"]]
    return pose[2] * nx - pose[3] * ny, pose[3] * nx + pose[2] * ny


@kernel
def _push(buf, j, n, fx, fy, turn_a, turn_b):  # type: ignore[no-untyped-def]
    """A force on b, its opposite on a, with these moments on them; recorded as joint n's."""
    a, b = j["a"], j["b"]
    buf.load[b, 0] += fx
    buf.load[b, 1] += fy
    buf.load[b, 2] += turn_b
    if a >= 0:
        buf.load[a, 0] -= fx
        buf.load[a, 1] -= fy
        buf.load[a, 2] -= turn_a
    buf.joint[n, 0], buf.joint[n, 1] = fx, fy


@kernel
def _spring(j, n, buf, vel):  # type: ignore[no-untyped-def]
    """Force and stiffness of a spring; the turn of its direction is left out of the tangent. Returns the force."""
    px, py, qx, qy, ax, ay, bx, by = _place(j, buf)
    ux, uy = qx - px, qy - py
    length = np.sqrt(ux * ux + uy * uy)
    if length == 0.0:
        return 0.0
    ux, uy = ux / length, uy / length
    a, b, row = j["a"], j["b"], buf.row
    turn_a, turn_b = ax * uy - ay * ux, bx * uy - by * ux
    rate = ux * buf.rate[b, 0] + uy * buf.rate[b, 1] + turn_b * buf.rate[b, 2]
    if a >= 0:
        rate -= ux * buf.rate[a, 0] + uy * buf.rate[a, 1] + turn_a * buf.rate[a, 2]
    tension = j["stiffness"] * (length - j["rest"]) + j["damping"] * rate
    _push(buf, j, n, -tension * ux, -tension * uy, -tension * turn_a, -tension * turn_b)
    stiff = j["stiffness"] + j["damping"] * vel
    row[3 * b], row[3 * b + 1], row[3 * b + 2] = ux, uy, turn_b
    if a >= 0:
        row[3 * a], row[3 * a + 1], row[3 * a + 2] = -ux, -uy, -turn_a
    for m in range(6 if a >= 0 else 3):
        i = 3 * b + m if m < 3 else 3 * a + m - 3
        for o in range(6 if a >= 0 else 3):
            k = 3 * b + o if o < 3 else 3 * a + o - 3
            buf.tangent[i, k] += stiff * row[i] * row[k]
    return abs(tension)


@kernel
def joint_forces(sy, buf, state, vel):  # type: ignore[no-untyped-def]
    """Adds what joints do to loads and tangent; ``vel``: change of a velocity by its position's. The largest force."""
    largest = 0.0
    for n in range(len(sy.joints)):
        j = sy.joints[n]
        mu = state.mu[len(sy.mass) + n]
        if j["kind"] == SPRING:
            largest = max(largest, _spring(j, n, buf, vel))
            continue
        px, py, qx, qy, ax, ay, bx, by = _place(j, buf)
        fx, fy, moment = mu[0], mu[1], mu[2]
        if j["kind"] == SLIDER:
            nx, ny = _across(j, buf)
            fx, fy = mu[0] * nx, mu[0] * ny
            ax, ay = ax + qx - px, ay + qy - py  # it bears where b is
        _push(buf, j, n, fx, fy, ax * fy - ay * fx + moment, bx * fy - by * fx + moment)
        buf.joint[n, 2] = moment
        largest = max(largest, np.hypot(fx, fy), abs(moment) / sy.size[j["b"]])
    return largest


@kernel
def _row(sy, buf, j, row, nx, ny, ax, ay, bx, by, turn):  # type: ignore[no-untyped-def]
    """A constraint's gradient, into a row and a column: n on points with these arms, ``turn`` on angles."""
    m = buf.matrix
    for side in range(2):
        body, sign, x, y = (j["b"], 1.0, bx, by) if side == 0 else (j["a"], -1.0, ax, ay)
        if body < 0 or sy.fixed[body] == 1:
            continue
        i = 3 * body
        m[row, i], m[row, i + 1], m[row, i + 2] = sign * nx, sign * ny, sign * (x * ny - y * nx + turn)
        for k in range(i, i + 3):
            m[k, row] = -m[row, k]


@kernel
def joint_rows(sy, buf, state, first):  # type: ignore[no-untyped-def]
    """Rows of the joints' constraints from ``first`` on: where they end, and the largest violation."""
    worst = 0.0
    for n in range(len(sy.joints)):
        j = sy.joints[n]
        kind = j["kind"]
        if kind == SPRING:
            continue
        px, py, qx, qy, ax, ay, bx, by = _place(j, buf)
        b = j["b"]
        size = sy.size[b] if sy.fixed[b] == 0 or j["a"] < 0 else sy.size[j["a"]]
        if kind == SLIDER:
            nx, ny = _across(j, buf)
            _row(sy, buf, j, first, nx, ny, ax + qx - px, ay + qy - py, bx, by, 0.0)
            buf.rhs[first] = -(nx * (qx - px) + ny * (qy - py))
            worst = max(worst, abs(buf.rhs[first]) / size)
            first += 1
        else:
            _row(sy, buf, j, first, 1.0, 0.0, ax, ay, bx, by, 0.0)
            _row(sy, buf, j, first + 1, 0.0, 1.0, ax, ay, bx, by, 0.0)
            buf.rhs[first], buf.rhs[first + 1] = px - qx, py - qy
            worst = max(worst, abs(px - qx) / size, abs(py - qy) / size)
            first += 2
        if kind != REVOLUTE:
            _row(sy, buf, j, first, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)
            turned = state.x[b, 2] - j["angle"]
            if j["a"] >= 0:
                turned -= state.x[j["a"], 2]
            buf.rhs[first] = -turned
            worst = max(worst, abs(turned))
            first += 1
    return first, worst


@kernel
def correct_joints(sy, buf, state, first, scale):  # type: ignore[no-untyped-def]
    """Newton's correction of the joints' multipliers, from the solution in ``buf.rhs``."""
    for n in range(len(sy.joints)):
        kind = sy.joints[n]["kind"]
        mu = state.mu[len(sy.mass) + n]
        if kind == SPRING:
            continue
        mu[0] += buf.rhs[first] / scale
        first += 1
        if kind != SLIDER:
            mu[1] += buf.rhs[first] / scale
            first += 1
        if kind != REVOLUTE:
            mu[2] += buf.rhs[first] / scale
            first += 1
