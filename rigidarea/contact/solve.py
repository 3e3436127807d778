"""A substep of all bodies and contacts: drift, kick, sweeps, settle.

Positions and velocities leapfrog: contacts are met where the bodies are in the middle of the substep, which is where
the first half of the substep's drift has taken them; second order in time (Hairer, Lubich, Wanner, Acta Numerica 12
(2003), doi:10.1017/S0962492902000144). Two half drifts between two substeps are one whole drift.
"""

from __future__ import annotations

import math
from typing import Any

from ..compile.jit import kernel
from ..geometry.place import shift, turn
from .active import active_island, island_of
from .constants import ROUNDING
from .joint import settle_joint
from .row import push, settle, visit
from .tables import ACTIVE, AWAKE, COMING, DRIFTS, LIVE, LYING, QUEUE, REST, ROWS, Law, Tables


@kernel
def drift(tables: Tables, frame: int, time: float) -> None:
    """Move every body that we move, at its present velocity."""
    for k in range(tables.counters[LIVE]):
        body = tables.bodies[tables.live[k]]
        if body.stamp == frame and body.kind == DRIFTS:
            body.x += time * body.vx
            body.y += time * body.vy
            body.since += time
            if body.w == 0.0:
                shift(body)
            else:
                turn(body, time * body.w)


@kernel
def fly(tables: Tables, frame: int, before: float, after: float) -> None:
    """`drift`, the whole frame's `kick`, another drift: of who meets nobody, in one go."""
    for k in range(tables.counters[LIVE]):
        body = tables.bodies[tables.live[k]]
        body.pushed = 0
        if body.stamp != frame:
            continue
        x = before * body.vx
        y = before * body.vy
        angle = before * body.w
        _kick(body, body.gain_x, body.gain_y, body.gain_w)
        if body.kind == DRIFTS:
            body.x += x + after * body.vx
            body.y += y + after * body.vy
            body.since += before + after
            angle += after * body.w
            if angle == 0.0:
                shift(body)
            else:
                turn(body, angle)


@kernel(forceinline=True)
def _kick(body: Any, x: float, y: float, w: float) -> None:
    body.kick_x = x
    body.kick_y = y
    body.kick_w = w
    body.vx += x
    body.vy += y
    body.w += w
    body.came_vx = body.vx
    body.came_vy = body.vy
    body.came_w = body.w


@kernel
def kick(tables: Tables, frame: int) -> None:
    """What everything but contacts and joints adds in a substep."""
    for k in range(tables.counters[LIVE]):
        body = tables.bodies[tables.live[k]]
        if body.stamp == frame:
            _kick(body, body.kick_x, body.kick_y, body.kick_w)


@kernel
def warm_start(tables: Tables) -> None:
    """Begin with the impulses of the substep before."""
    for i in range(tables.counters[ROWS]):
        row = tables.rows[i]
        push(row, tables.bodies[row.a], tables.bodies[row.b], row.l1, row.l2, row.lt)


@kernel(forceinline=True)
def _left_to_solve(row: Any, a: Any, b: Any) -> float:
    """A row's impulses times what they lack at the present velocities: nothing where a visit would change nothing."""
    ux = a.vx - b.vx
    uy = a.vy - b.vy
    v = ux * row.nx + uy * row.ny + (a.w * row.arm_a - b.w * row.arm_b)
    slip = uy * row.nx - ux * row.ny + (a.w * row.lean_a - b.w * row.lean_b)
    give = row.alpha / row.gamma
    left = 0.0
    if row.lt != 0.0:
        left += row.lt * (row.alpha_t / row.gamma_t * (row.ft - row.lt) + slip - row.tt)
    if row.ends < 2:
        return float(left + row.l1 * (give * (row.f1 - row.l1) + v - row.t1))
    turn = a.w - b.w
    gap1 = row.f1 - row.l1
    gap2 = row.f2 - row.l2
    left += row.l1 * (give * (row.own * gap1 + row.other * gap2) + v - turn * row.e1 - row.t1)
    return float(left + row.l2 * (give * (row.other * gap1 + row.own * gap2) + v - turn * row.e2 - row.t2))


@kernel
def warm_start_in_part(tables: Tables) -> None:
    """Begin with so much of the impulses of the substep before as leaves each island the least to solve.

    What balances kicks and itself is used whole, and what has borne against something that has come off since is not.
    (The length of a step along a direction, as in `conjugate`.)
    """
    for k in range(tables.counters[ACTIVE]):
        island = active_island(tables, k)
        island.ahead = 0.0
        island.curvature = 0.0
    for i in range(tables.counters[ROWS]):
        row = tables.rows[i]
        if row.gamma > 0.0:
            island = tables.islands[island_of(tables, row)]
            give = row.alpha / row.gamma
            own = give * (row.own if row.ends == 2 else 1.0)
            other = give * (row.other if row.ends == 2 else 0.0)
            island.ahead += _left_to_solve(row, tables.bodies[row.a], tables.bodies[row.b])
            island.ahead += own * (row.l1 * row.l1 + row.l2 * row.l2) + 2.0 * other * row.l1 * row.l2
            if row.lt != 0.0:
                island.ahead += row.alpha_t / row.gamma_t * row.lt * row.lt
    warm_start(tables)
    for i in range(tables.counters[ROWS]):
        row = tables.rows[i]
        if row.gamma > 0.0:
            left = _left_to_solve(row, tables.bodies[row.a], tables.bodies[row.b])
            tables.islands[island_of(tables, row)].curvature -= left
    for k in range(tables.counters[ACTIVE]):
        island = active_island(tables, k)
        island.curvature += island.ahead
        island.part = 1.0
        if island.curvature > island.ahead:
            island.part = max(0.0, island.ahead) / island.curvature
    for i in range(tables.counters[ROWS]):
        row = tables.rows[i]
        part = tables.islands[island_of(tables, row)].part
        if row.gamma > 0.0 and part < 1.0:
            d1, d2, dt = (part - 1.0) * row.l1, (part - 1.0) * row.l2, (part - 1.0) * row.lt
            row.l1 += d1
            row.l2 += d2
            row.lt += dt
            push(row, tables.bodies[row.a], tables.bodies[row.b], d1, d2, dt)


@kernel
def sweep(tables: Tables, up: bool) -> None:
    """Visit every row that is being solved once, from the bottom to the top or back (Gauss-Seidel, symmetric over two).

    Leaves with each island the largest change of a contact's speed (`moved`).
    """
    for k in range(tables.counters[ACTIVE]):
        active_island(tables, k).moved = 0.0
    n = tables.counters[QUEUE]
    for k in range(n):
        queued = tables.queue[k if up else n - 1 - k]
        row = tables.rows[queued.row]
        moved = visit(row, tables.bodies[row.a], tables.bodies[row.b])
        island = tables.islands[queued.island]
        if moved > island.moved:
            island.moved = moved


@kernel(forceinline=True)
def _note_pushed(row: Any, region: Any, body: Any) -> None:
    """That a contact has pushed a body: added to what the substep before has left until all contacts are seen."""
    if row.l1 + row.l2 > 0.0:
        comes = region.mode != REST and body.pushed & LYING == 0
        body.pushed |= 4 * (COMING if comes else LYING)


@kernel(forceinline=True)
def _spin(body: Any, spin: float, island: Any) -> None:
    """Turn a body by so much faster (1/time), or by a part of it: no more energy changes than contacts have taken."""
    energy = (
        (abs(body.w * spin) + 0.5 * spin * spin) / body.inverse_moment if body.inverse_moment > 0.0 else 0.0
    )
    left = max(0.0, -island.ahead)  # `contacts_give_energy`
    if energy > left:
        spin *= left / energy
        energy = left
    island.ahead += energy
    body.w += spin


@kernel
def finish(tables: Tables, law: Law, frame: int, h: float, last: bool) -> None:
    """What the rows leave behind: in their regions, and in the places of bodies that were struck."""
    for i in range(tables.counters[ROWS]):
        row = tables.rows[i]
        if row.ends == 0:
            settle_joint(tables.joints[row.region], row, h)
            continue
        region = tables.regions[row.region]
        a = tables.bodies[row.a]
        b = tables.bodies[row.b]
        settle(row, region, law, tables.pairs[region.pair], a, b, h, last)
        _note_pushed(row, region, a)
        _note_pushed(row, region, b)
    for k in range(tables.counters[LIVE]):
        body = tables.bodies[tables.live[k]]
        body.pushed //= 4
        if body.stamp != frame:
            continue
        number = tables.mobility[tables.live[k]].island
        if tables.counters[ROWS] > 0 and number >= 0 and tables.islands[number].turn == 0:
            body.unsolved = tables.islands[number].left
        least = ROUNDING * (abs(body.kick_x) + abs(body.kick_y))
        if abs(body.vx) < least:
            body.vx = 0.0
        if abs(body.vy) < least:
            body.vy = 0.0
        if body.shift_x != 0.0 or body.shift_y != 0.0 or body.shift_a != 0.0:
            if body.kind == DRIFTS:
                body.x += body.shift_x
                body.y += body.shift_y
                # What has been shifted by one impulse meets the next with another arm. (Not a disc without friction:
                # there the direction goes with the arm, and spin would be energy from nowhere.)
                vx = body.vx - body.came_vx
                vy = body.vy - body.came_vy
                turned = abs(body.w - body.came_w) * body.extent
                if body.inverse_mass > 0.0 and turned > 1e-9 * (abs(vx) + abs(vy)):
                    spin = (body.shift_y * vx - body.shift_x * vy) * body.inverse_moment / body.inverse_mass
                    _spin(body, spin, tables.islands[tables.mobility[tables.live[k]].island])
                turn(body, body.shift_a)
            body.shift_x = 0.0
            body.shift_y = 0.0
            body.shift_a = 0.0


@kernel
def respond_explicitly(tables: Tables) -> None:
    """The explicit law: every row answers to the same velocities, none to what another has done."""
    counters = tables.counters
    for i in range(counters[ROWS]):
        row = tables.rows[i]
        a = tables.bodies[row.a]
        b = tables.bodies[row.b]
        keep = (a.vx, a.vy, a.w, b.vx, b.vy, b.w)
        push(row, a, b, row.l1, row.l2, row.lt)
        visit(row, a, b)
        a.vx, a.vy, a.w, b.vx, b.vy, b.w = keep
    warm_start(tables)


@kernel
def finite(tables: Tables) -> int:
    """The first body whose state is not finite; -1: all are."""
    for k in range(tables.counters[AWAKE]):
        body = tables.bodies[tables.awake[k]]
        if not math.isfinite(body.x + body.y + body.angle + body.vx + body.vy + body.w):
            return int(tables.awake[k])
    return -1
