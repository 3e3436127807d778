"""What moves as it is told gives no more than its own speed.

Seen from a kinematic body its contacts give no energy: there it stands still. But two that stand still in no one frame,
a paddle and a floor, or what a joint holds, pinch what is between them, and the nearer their rows are to contradicting
each other, the faster an exact solve sends that off aside, without bound. So an island's speed grows by no more than
DRIVE times what its drivers' velocities differ by; the overlap gives way, and opens as of what has been put there.
"""

from __future__ import annotations

import math
from typing import Any

from ..compile.jit import kernel
from .active import island_of, moves
from .birth import drives
from .joint_record import MOTOR, ROTARY_SPRING, SPRING
from .tables import ISLANDS, LIVE, ROWS, Law, Tables

#: An island's speed (root of the mean square by mass) grows in a substep by no more than so many times what its drivers
#: differ by: an elastic body between two walls that close in comes back faster by twice that.
DRIVE = 2.0
#: How a kinematic body that moves drives an island: by contacts; by a joint, whose lead is not to be kept back (servos,
#: cranes, the hand that drags).
PRESSED, LED_BY_JOINT = 1, 2


@kernel(forceinline=True)
def _drive(island: Any, row: Any, body: Any, arm: float, lean: float) -> None:
    """Note the velocity of a point of a body that no impulse moves, and of its surface."""
    v = body.vx * row.nx + body.vy * row.ny + body.w * arm
    slip = body.vy * row.nx - body.vx * row.ny + body.w * lean
    surface = row.tt if row.ends > 0 else 0.0
    for along in (slip + surface, slip - surface):
        x = v * row.nx - along * row.ny
        y = v * row.ny + along * row.nx
        island.low_x = min(island.low_x, x)
        island.low_y = min(island.low_y, y)
        island.high_x = max(island.high_x, x)
        island.high_y = max(island.high_y, y)


@kernel
def _find_drivers(tables: Tables, law: Law) -> bool:
    """Whether islands are pressed by what moves; between what velocities (`low_x` to `high_y` of each)."""
    driven = False
    for k in range(tables.counters[ISLANDS]):
        island = tables.islands[k]
        island.driven = 0
        island.low_x = island.low_y = math.inf
        island.high_x = island.high_y = -math.inf
    for i in range(tables.counters[ROWS]):
        row = tables.rows[i]
        a = tables.bodies[row.a]
        b = tables.bodies[row.b]
        island = tables.islands[island_of(tables, row)]
        by = PRESSED if row.ends > 0 else LED_BY_JOINT
        for body, arm, lean in ((a, row.arm_a, row.lean_a), (b, row.arm_b, row.lean_b)):
            if not moves(body):
                _drive(island, row, body, arm, lean)
                if drives(law, body) and (body.vx != 0.0 or body.vy != 0.0 or body.w != 0.0):
                    island.driven |= by
                    driven |= by == PRESSED
    for k in range(tables.counters[ISLANDS]):
        tables.islands[k].driven = tables.islands[k].driven == PRESSED
    return driven


@kernel
def _own_work(tables: Tables, row: Any) -> float:
    """What a row gives that is asked to: a spring, a motor, a contact that returns more than it gets (energy)."""
    joint = row.ends == 0
    if joint:
        kind = tables.joints[row.region].kind
        if kind != SPRING and kind != ROTARY_SPRING and kind != MOTOR:
            return 0.0
    elif tables.pairs[tables.regions[row.region].pair].elasticity <= 1.0:
        return 0.0
    a = tables.bodies[row.a]
    b = tables.bodies[row.b]
    ux = a.came_vx + a.vx - b.came_vx - b.vx
    uy = a.came_vy + a.vy - b.came_vy - b.vy
    wa, wb = a.came_w + a.w, b.came_w + b.w
    v = ux * row.nx + uy * row.ny + wa * row.arm_a - wb * row.arm_b
    turn = row.l1 * row.e1 + row.l2 * row.e2
    return float(max(0.0, -0.5 * ((row.l1 + row.l2) * v - turn * (wa - wb))))


@kernel
def lessen_driven(tables: Tables, law: Law) -> None:
    """Of what a substep has done to islands that are driven, as much as leaves them the speed that they may have."""
    if not _find_drivers(tables, law):
        return
    for k in range(tables.counters[ISLANDS]):
        island = tables.islands[k]
        island.energy = 0.0
        island.product = 0.0
        island.curvature = 0.0
        island.ahead = 0.0
        island.mass = 0.0
    for k in range(tables.counters[LIVE]):
        number = tables.mobility[tables.live[k]].island
        if number < 0 or not tables.islands[number].driven:
            continue
        body = tables.bodies[tables.live[k]]
        island = tables.islands[number]
        dw = body.w - body.came_w
        if body.inverse_mass > 0.0:
            own = 1.0 / body.inverse_mass
            x = body.came_vx - 0.5 * (island.low_x + island.high_x)
            y = body.came_vy - 0.5 * (island.low_y + island.high_y)
            dx = body.vx - body.came_vx
            dy = body.vy - body.came_vy
            island.mass += own
            island.energy += 0.5 * own * (x * x + y * y)
            island.product += own * (x * dx + y * dy)
            island.curvature += 0.5 * own * (dx * dx + dy * dy)
        if body.inverse_moment > 0.0:
            own = 1.0 / body.inverse_moment
            island.energy += 0.5 * own * body.came_w * body.came_w
            island.product += own * body.came_w * dw
            island.curvature += 0.5 * own * dw * dw
    for i in range(tables.counters[ROWS]):
        island = tables.islands[island_of(tables, tables.rows[i])]
        if island.driven:
            island.ahead += _own_work(tables, tables.rows[i])
    for k in range(tables.counters[ISLANDS]):
        island = tables.islands[k]
        island.part = 1.0
        if not island.driven:
            continue
        differ = math.hypot(island.high_x - island.low_x, island.high_y - island.low_y)
        # what joints bore here may be what a driver has pinched: no load to be lifted
        had = island.energy + island.ahead + island.held + 0.5 * island.mending - island.lifted
        root = math.sqrt(had) + DRIVE * differ * math.sqrt(0.5 * island.mass)
        over = max(0.0, root * root - island.energy)  # alone with one driver it is nothing, but for rounding
        if island.product + island.curvature > over:
            reach = math.sqrt(island.product * island.product + 4.0 * island.curvature * over)
            island.part = min(1.0, (reach - island.product) / (2.0 * island.curvature))
    for k in range(tables.counters[LIVE]):
        number = tables.mobility[tables.live[k]].island
        if number >= 0 and tables.islands[number].driven:
            part = tables.islands[number].part
            body = tables.bodies[tables.live[k]]
            if part < 1.0:
                body.vx = body.came_vx + part * (body.vx - body.came_vx)
                body.vy = body.came_vy + part * (body.vy - body.came_vy)
                body.w = body.came_w + part * (body.w - body.came_w)
    for i in range(tables.counters[ROWS]):
        row = tables.rows[i]
        island = tables.islands[island_of(tables, row)]
        if island.driven and island.part < 1.0:
            row.l1 *= island.part
            row.l2 *= island.part
            row.lt *= island.part
