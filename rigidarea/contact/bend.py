"""What turns leaves the tangent: a joint's way bends within a substep, and its row aims at where that leads.

Rows say what velocities do to a joint where its bodies are; the drift of h that follows takes what turns by w off, by
r (w h)^2 / 2. Taken back by the bias of later substeps alone, that is energy lost: a rod that turned by a quarter of a
radian a substep kept a tenth of it for ten seconds. So a row asks for the velocities with which its joint holds after
the drift. Places and velocities leapfrog, and the row's impulse acts along its direction where they are now: that is
SHAKE, which is symplectic (J.-P. Ryckaert, G. Ciccotti, H. Berendsen, J. Comput. Phys. 23 (1977),
doi:10.1016/0021-9991(77)90098-5; Hairer, Lubich, Wanner, Geometric Numerical Integration, VII.1.4).

A way that bends alike before and after sends a joint's ends off as fast as they have come. It is given no more than
that: what a blow has only now set turning, or what cannot turn (a chain that is stretched out), is not thrown.
"""

from __future__ import annotations

import math
from typing import Any

from ..compile.jit import kernel
from .joint_record import GROOVE, PIVOT, anchor
from .tables import QUEUE, Tables


@kernel
def _lengthening(row: Any, joint: Any, a: Any, b: Any, h: float) -> float:
    """How much longer a pin or slide joint is after a drift than the row's own speed makes it (length).

    Along n: of one whose direction is from B to A it is how much shorter.
    """
    ax, ay = anchor(a, joint.p[0], joint.p[1])
    bx, by = anchor(b, joint.p[2], joint.p[3])
    dx = b.x + bx - a.x - ax
    dy = b.y + by - a.y - ay
    distance = math.hypot(dx, dy)
    if distance == 0.0:
        return 0.0
    dx /= distance
    dy /= distance
    vx = b.vx - b.w * by - a.vx + a.w * ay
    vy = b.vy + b.w * bx - a.vy - a.w * ax
    across = h * (vy * dx - vx * dy)
    if abs(across) > distance:
        return 0.0
    of_a = h * a.w
    of_b = h * b.w
    cos_a = math.cos(of_a) - 1.0
    cos_b = math.cos(of_b) - 1.0
    sin_a = math.sin(of_a) - of_a
    sin_b = math.sin(of_b) - of_b
    x = cos_b * bx - sin_b * by - cos_a * ax + sin_a * ay
    y = sin_b * bx + cos_b * by - sin_a * ax - cos_a * ay
    longer = math.hypot(distance + x * dx + y * dy, across + y * dx - x * dy) - distance
    return longer if row.nx * dx + row.ny * dy > 0.0 else -longer


@kernel
def _off_its_groove(row: Any, joint: Any, a: Any, b: Any, h: float) -> float:
    """How far off a groove its point is after a drift, more than the row's own speed takes it (length)."""
    bx, by = anchor(b, joint.p[6], joint.p[7])
    x = b.x + bx - a.x
    y = b.y + by - a.y
    of_a = h * a.w
    of_b = h * b.w
    cos_a = math.cos(of_a)
    sin_a = math.sin(of_a)
    cos_b = math.cos(of_b) - 1.0
    sin_b = math.sin(of_b) - of_b
    mx = h * (b.vx - a.vx - b.w * by)
    my = h * (b.vy - a.vy + b.w * bx)
    then_x = x + mx + cos_b * bx - sin_b * by
    then_y = y + my + sin_b * bx + cos_b * by
    off = then_x * (cos_a * row.nx - sin_a * row.ny) + then_y * (sin_a * row.nx + cos_a * row.ny)
    return float(off - (x + mx + of_a * y) * row.nx - (y + my - of_a * x) * row.ny)


@kernel
def _off_the_tangent(row: Any, joint: Any, a: Any, b: Any, h: float) -> tuple[float, float, float, float]:
    """The speeds along n and t by which a joint's ends part in a drift that its row knows nothing of (length/time).

    First those that are the same a drift ago, then those that change sign. None of what turns by more than a radian,
    which no step follows.
    """
    if max(abs(a.w), abs(b.w)) * h > 1.0:
        return 0.0, 0.0, 0.0, 0.0
    if joint.kind != PIVOT:
        if joint.kind == GROOVE:
            return _off_its_groove(row, joint, a, b, h) / h, 0.0, 0.0, 0.0
        return _lengthening(row, joint, a, b, h) / h, 0.0, 0.0, 0.0
    ax, ay = anchor(a, joint.p[0], joint.p[1])
    bx, by = anchor(b, joint.p[2], joint.p[3])
    cos_a = (math.cos(h * a.w) - 1.0) / h
    cos_b = (math.cos(h * b.w) - 1.0) / h
    sin_a = math.sin(h * a.w) / h - a.w
    sin_b = math.sin(h * b.w) / h - b.w
    return (
        cos_b * bx - cos_a * ax,
        cos_b * by - cos_a * ay,
        sin_a * ay - sin_b * by,
        sin_b * bx - sin_a * ax,
    )


@kernel
def bend(row: Any, joint: Any, a: Any, b: Any, h: float) -> None:
    """Aim a joint's row at where the bodies' present velocities lead it in h, in the place of where it was aimed."""
    if joint.kind > GROOVE:
        return
    bend1, bend_t, odd1, odd_t = _off_the_tangent(row, joint, a, b, h)
    ux = (a.came_vx - a.kick_x) - (b.came_vx - b.kick_x)
    uy = (a.came_vy - a.kick_y) - (b.came_vy - b.kick_y)
    wa = a.came_w - a.kick_w
    wb = b.came_w - b.kick_w
    came1 = ux * row.nx + uy * row.ny + (wa * row.arm_a - wb * row.arm_b)
    came_t = uy * row.nx - ux * row.ny + (wa * row.lean_a - wb * row.lean_b)
    asked = bend1 * bend1 + bend_t * bend_t
    returned = -(bend1 * came1 + bend_t * came_t)
    part = max(0.0, returned / asked) if returned < asked else 1.0
    bend1 = part * (bend1 + odd1)
    bend_t = part * (bend_t + odd_t)
    row.t1 += bend1 - row.bend1
    row.tt += bend_t - row.bend_t
    row.bend1 = bend1
    row.bend_t = bend_t


@kernel
def bend_again(tables: Tables, h: float) -> None:
    """Aim the joints that are being solved at where the velocities lead that the sweeps have come to."""
    for k in range(tables.counters[QUEUE]):
        row = tables.rows[tables.queue[k].row]
        if row.ends == 0:
            bend(row, tables.joints[row.region], tables.bodies[row.a], tables.bodies[row.b], h)
