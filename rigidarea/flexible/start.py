"""What satisfies motion and constraints at t = 0, with contacts and modes at rest: velocities, accelerations,
multipliers, and what static flexibility does under them.

Without them the scheme starts with an error of first order, and with swinging that is not the bodies'.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidarea.flexible.check import PIVOT
from rigidarea.flexible.mechanism_joints import ROWS, Joint
from rigidarea.flexible.modes import carriers, hub_rows
from rigidarea.geometry.pool import boxes_of

Array = NDArray[np.float64]

SMALL = 1e-3  # of the energy that will go round: what a body may be given as strain before it starts


def moving(b: Any, number: int) -> Any:
    """An ``integrate.Body`` whose velocity leaves its pivot at rest, and is that of a drive without a ramp.

    Raises ValueError for a velocity that says otherwise; zeros say nothing.
    """
    if b.fixed or (b.anchor is None and b.drive is None):
        return b
    vx, vy, omega = b.velocity
    if b.drive is not None and b.drive[2] == 0.0 and omega == 0.0:
        omega = b.drive[1]
    if b.anchor is not None:
        c, s = np.cos(b.angle), np.sin(b.angle)
        arm = np.array([c * b.hub[0] - s * b.hub[1], s * b.hub[0] + c * b.hub[1]])
        v = omega * np.array([arm[1], -arm[0]])
        given = np.array([vx, vy])
        size = float(np.linalg.norm(b.boundary.points, axis=1).max())
        if given.any() and np.hypot(*(given - v)) > PIVOT * abs(omega) * size:
            raise ValueError(
                f"body {number}: its velocity must leave its pivot at rest, ({v[0]:.6g}, {v[1]:.6g}) at {omega:.6g}"
                f" rad/time, got ({vx:.6g}, {vy:.6g})"
            )
        vx, vy = float(v[0]), float(v[1])
    return replace(b, velocity=(vx, vy, omega))


def weighed(b: Any, gravity: tuple[float, float]) -> tuple[Any, Array | None]:
    """An ``integrate.Body``; a clamped one as its own weight bends it, which loads and modes move from there, and the
    displacements (n, 2) of its mesh's nodes by that."""
    if b.shape is None or b.shape.clamped is None or not np.any(gravity):
        return b, None
    c, s = np.cos(b.angle), np.sin(b.angle)
    sag = b.shape.sag((c * gravity[0] + s * gravity[1], -s * gravity[0] + c * gravity[1]))
    shape, bd = b.shape, b.boundary
    spread = carriers(shape.mesh, shape.contact_rings, shape.sides)
    u = (spread.T @ sag.reshape(-1)).reshape(-1, 2)
    share = bd.share[:, None]
    points = bd.points + (1.0 - share) * u[bd.low] + share * u[bd.high]
    hub = np.array(b.hub)
    if shape.hub is not None:
        hub = hub + (hub_rows(shape.mesh.points, shape.mesh.rings[shape.hub]).T @ sag.reshape(-1))[:2]
    boxes, _ = boxes_of(points, bd.following, np.zeros((len(points), 4)))
    bent = bd._replace(points=points, nodes=bd.nodes + u, boxes=boxes)
    return replace(b, boundary=bent, hub=(float(hub[0]), float(hub[1]))), sag


def _damped(b: Any) -> float:
    """The moment of a body's damper at t = 0, where a drive does not say how the hub turns; none, where the strain by
    it would have more than SMALL of the body's energy."""
    if b.drive is not None or b.damper == 0.0:
        return 0.0
    yields = b.boundary.flexibility[-1, -1] if len(b.boundary.flexibility) else 0.0
    return b.damper * b.velocity[2] if yields * b.damper**2 <= SMALL * b.inertia else 0.0


def settle(b: Any, gravity: Array, x: Array, mu: Array, turn: Array) -> Array:
    """The load (3,) on a body's hub at t = 0, in its frame. Moves frame ``x`` (3,) and ``turn`` (4,) to where static
    flexibility under it, and under the spin, leaves the pivot and the drive's angle where they are.

    Of all such frames the one that is nearest in the metric of the mass: that about which the body, let go as it was
    said to be, would swing. Where first forces strain the body by more than SMALL of its energy (a sudden drive) it
    starts without that strain, and swings.
    """
    c, s = np.cos(b.angle), np.sin(b.angle)
    load = np.array([c * mu[0] + s * mu[1], -s * mu[0] + c * mu[1], mu[2] + b.torque])
    u, bd = np.zeros(3), b.boundary
    if len(bd.flexibility):
        u += bd.flexibility[-3:, -3:] @ load
    size = float(np.linalg.norm(bd.points, axis=1).max())
    speed = b.velocity[2] if b.drive is None else b.drive[1]
    inertia = b.inertia + b.mass * float(np.dot(b.hub, b.hub))
    energy = 0.5 * inertia * speed**2 + b.mass * size * float(np.hypot(*gravity)) + abs(b.torque)
    if 0.5 * float(load @ u) > SMALL * energy:
        u[:] = load[:] = 0.0
    if len(bd.swell):
        u += b.velocity[2] ** 2 * bd.swell[-3:]
    turn[0] = u[2]
    if b.drive is None and b.damper > 0.0 and _damped(b) == 0.0:
        turn[1] = -b.velocity[2]  # the damper holds the hub still, where it bears nothing yet
    if b.fixed or (b.drive is None and b.anchor is None):
        return load
    frame = np.array([[c, -s], [s, c]])
    arm, moved = frame @ np.array(b.hub), frame @ u[:2]
    if b.drive is not None:
        x[2] -= u[2]
    else:
        x[2] -= b.mass * _cross(arm, moved) / (b.inertia + b.mass * float(arm @ arm))
    if b.anchor is not None:
        c, s = np.cos(x[2]), np.sin(x[2])
        x[:2] = np.array(b.anchor) - np.array([[c, -s], [s, c]]) @ (np.array(b.hub) + u[:2])
    return load


class _Rows:
    """Constraint rows J a = γ, and which multiplier each belongs to."""

    def __init__(self, bodies: int) -> None:
        self.n = 3 * bodies
        self.gradient: list[Array] = []
        self.right: list[float] = []
        self.place: list[tuple[int, int]] = []

    def add(self, place: tuple[int, int], parts: Sequence[tuple[int, Any]], right: float) -> None:
        row = np.zeros(self.n)
        for body, values in parts:
            if body >= 0:
                row[3 * body : 3 * body + 3] = values
        self.gradient.append(row)
        self.right.append(right)
        self.place.append(place)


def _cross(x: Array, y: Array) -> float:
    return float(x[0] * y[1] - x[1] * y[0])


def _ends(bodies: Sequence[Any], joint: Joint) -> list[tuple[Array, Array, Array, float]]:
    """Place, arm, velocity of the joint's point, and angular velocity, of a and of b."""
    out = []
    for i, at in ((joint.a, joint.at_a), (joint.b, joint.at_b)):
        if i < 0:
            out.append((np.array(at), np.zeros(2), np.zeros(2), 0.0))
            continue
        body = bodies[i]
        c, s = np.cos(body.angle), np.sin(body.angle)
        arm = np.array([[c, -s], [s, c]]) @ np.array(at, float)
        v, w = np.array(body.velocity[:2], float), float(body.velocity[2])
        if body.fixed:
            v, w = np.zeros(2), 0.0
        out.append((np.array(body.position) + arm, arm, v + w * np.array([-arm[1], arm[0]]), w))
    return out


def _joint(rows: _Rows, load: Array, bodies: Sequence[Any], joint: Joint, place: int) -> None:
    (pa, arm_a, va, wa), (pb, arm_b, vb, wb) = _ends(bodies, joint)
    a, b, d, dv = joint.a, joint.b, pb - pa, vb - va
    drift = wb**2 * arm_b - wa**2 * arm_a  # what the arms' turning takes off the points' accelerations
    if joint.kind == "spring":
        length = float(np.hypot(*d))
        if length > 0:
            u = d / length
            f = -(joint.stiffness * (length - joint.rest) + joint.damping * float(u @ dv)) * u
            for body, arm, sign in ((b, arm_b, 1.0), (a, arm_a, -1.0)):
                if body >= 0:
                    load[3 * body : 3 * body + 3] += sign * np.array([*f, _cross(arm, f)])
        return
    if joint.kind == "slider":
        c, s = (np.cos(bodies[a].angle), np.sin(bodies[a].angle)) if a >= 0 else (1.0, 0.0)
        u = np.array([[c, -s], [s, c]]) @ (np.array(joint.axis, float) / np.hypot(*joint.axis))
        n = np.array([-u[1], u[0]])
        turned = np.array([-n[1], n[0]])
        right = float(n @ drift - 2 * wa * (turned @ dv) + wa**2 * (n @ d))
        rows.add((place, 0), ((b, [*n, _cross(arm_b, n)]), (a, [*-n, -_cross(arm_a + d, n)])), right)
    else:
        for k, n in enumerate(np.eye(2)):
            rows.add(
                (place, k), ((b, [*n, _cross(arm_b, n)]), (a, [*-n, -_cross(arm_a, n)])), float(drift[k])
            )
    if joint.kind != "revolute":
        rows.add((place, 2), ((b, [0.0, 0.0, 1.0]), (a, [0.0, 0.0, -1.0])), 0.0)


def start(bodies: Sequence[Any], joints: Sequence[Joint], gravity: Array) -> tuple[Array, Array]:
    """Accelerations (b, 3) of ``integrate.Body``s, and multipliers (b + j, 3) of their hubs and joints.

    Raises ValueError where constraints say the same twice, or contradict each other.
    """
    n = len(bodies)
    rows = _Rows(n)
    mass, load = np.ones(3 * n), np.zeros(3 * n)
    for i, b in enumerate(bodies):
        at = slice(3 * i, 3 * i + 3)
        if b.fixed:
            continue
        omega = b.velocity[2]
        c, s = np.cos(b.angle), np.sin(b.angle)
        arm = np.array([c * b.hub[0] - s * b.hub[1], s * b.hub[0] + c * b.hub[1]])
        mass[at] = b.mass, b.mass, b.inertia
        damping = b.damper * omega if b.drive is None else 0.0
        load[at] = b.mass * gravity[0], b.mass * gravity[1], b.torque - damping
        if b.anchor is not None:
            rows.add((i, 0), ((i, [1.0, 0.0, -arm[1]]),), float(omega**2 * arm[0]))
            rows.add((i, 1), ((i, [0.0, 1.0, arm[0]]),), float(omega**2 * arm[1]))
        if b.drive is not None:
            rows.add((i, 2), ((i, [0.0, 0.0, 1.0]),), b.drive[1] / b.drive[2] if b.drive[2] > 0 else 0.0)
    for k, joint in enumerate(joints):
        _joint(rows, load, bodies, joint, n + k)
    count = len(rows.right)
    matrix = np.zeros((3 * n + count, 3 * n + count))
    matrix[: 3 * n, : 3 * n] = np.diag(mass)
    gradient = np.array(rows.gradient).reshape(count, 3 * n)
    held = np.repeat([b.fixed for b in bodies], 3)
    load[held], gradient[:, held] = 0.0, 0.0
    matrix[3 * n :, : 3 * n] = gradient
    matrix[: 3 * n, 3 * n :] = -gradient.T
    free = gradient / np.sqrt(mass)
    if count and np.linalg.matrix_rank(free) < count:
        raise ValueError(
            f"constraints of pivots, drives and joints must be independent, got {count} of rank"
            f" {np.linalg.matrix_rank(free)}: one says what others say, or holds a fixed body"
        )
    solution = np.linalg.solve(matrix, np.concatenate([load, rows.right]))
    mu = np.zeros((n + len(joints), ROWS))
    for (i, k), value in zip(rows.place, solution[3 * n :], strict=True):
        mu[i, k] = value
    for i, b in enumerate(bodies):
        if not b.fixed:
            mu[i, 2] -= _damped(b)
    return solution[: 3 * n].reshape(n, 3), mu
