"""Contacts give no energy: where a solve has had them give some, part of it is taken, of another that cannot.

Newton's restitution returns speeds, and knows nothing of the work of friction that turns the slip round (T. R. Kane,
"A dynamics puzzle", Stanford Mechanics Alumni Club Newsletter, 1984), nor of what is hinged to who bounces; nor does a
solve that has not converged. Without restitution and friction a solve gives none from its first visit on: it lessens a
convex function that begins at 0 (J. J. Moreau, doi:10.1007/978-3-7091-2624-0_1). Of the two any mean obeys joints and
friction's cone as both do, and its work is a square of the part: the largest part is taken that gives nothing. What
joints do counts as well, through which a contact may give what it does not itself; not what motors and springs do.

Joints give energy as they mend errors of place, without bound where two contradict each other on one body: its island
may have as much of it as if every body went at each of their speeds, ½ M Σ T^2 + ½ I Σ R^2 (M, I: its mass and moment;
T, R: its joints' mending speeds), and as it takes to mend against the load that they bore before: a hanging bridge is
lifted. What gives more is mixed with a solve that mends nothing.
"""

from __future__ import annotations

import math
from typing import Any

from ..compile.jit import kernel
from .active import island_of, list_active
from .birth import drives
from .constants import LOOSE, UNSOLVED_WORK
from .joint import mending_speeds
from .joint_record import MOTOR, ROTARY_SPRING, SPRING
from .tables import ISLANDS, LIVE, QUEUE, ROWS, Law, Tables

#: Why an island is solved again (`Tables.islands.again`).
CONTACTS_GIVE, JOINTS_GIVE = 1, 2


@kernel(forceinline=True)
def _speeds(row: Any, kind: int, ux: float, uy: float, wa: float, wb: float) -> tuple[float, float, float]:
    """The speeds that a row's three impulses act against: closing at either end, and the slip.

    kind: as of `_kind`; ux, uy: A's velocity less B's (length/time); wa, wb: how fast the two turn (1/time). On a
    surface that moves, and by a motor, it is how much is missing of the speed that is asked for.
    """
    v = ux * row.nx + uy * row.ny + (wa * row.arm_a - wb * row.arm_b)
    slip = uy * row.nx - ux * row.ny + (wa * row.lean_a - wb * row.lean_b)
    if kind == MOTOR:
        v -= row.t1
    elif kind < 0:
        slip -= row.tt
    return v - (wa - wb) * row.e1, v - (wa - wb) * row.e2, slip


@kernel(forceinline=True)
def _may_give(law: Law, pair: Any, a: Any, b: Any) -> bool:
    """Whether a contact is asked to give energy: off what moves as it is told, or by a restitution above 1."""
    return bool(drives(law, a) or drives(law, b) or pair.elasticity > 1.0)


@kernel(forceinline=True)
def _kind(tables: Tables, row: Any) -> int:
    """Which joint's row it is; -1: a contact's."""
    return int(tables.joints[row.region].kind) if row.ends == 0 else -1


@kernel(forceinline=True)
def _holds(kind: int) -> bool:
    """Whether a row is a joint's that mends errors of place."""
    return kind >= 0 and kind != SPRING and kind != ROTARY_SPRING and kind != MOTOR


@kernel
def _note_held(tables: Tables) -> None:
    """What springs may give back, `held` of each island, and twice what joints may as they mend, `mending`.

    What a step is too long for opens without giving speed (`relax`). That is not solved exactly: a LOOSE part of the
    bodies' energy may come of it.
    """
    for k in range(tables.counters[ISLANDS]):
        tables.islands[k].held = 0.0
        tables.islands[k].energy = 0.0
        tables.islands[k].product = 0.0
        tables.islands[k].moment = 0.0
        tables.islands[k].mending = 0.0
        tables.islands[k].turning = 0.0
        tables.islands[k].lifted = 0.0
    for i in range(tables.counters[ROWS]):
        row = tables.rows[i]
        island = tables.islands[island_of(tables, row)]
        if _holds(_kind(tables, row)):
            t1, tt = mending_speeds(row)
            if row.nx != 0.0 or row.ny != 0.0:
                island.mending += t1 * t1 + tt * tt
            else:
                island.turning += t1 * t1
            island.lifted += min(row.held, max(0.0, -(row.l1 * t1 + row.lt * tt)))  # a blow is no load
        elif row.ends > 0:
            island.held += 0.5 * (1.0 - row.theta) * row.held
            island.product += 0.5 * row.theta * row.held
    for k in range(tables.counters[LIVE]):
        number = tables.mobility[tables.live[k]].island
        if number < 0:
            continue
        body = tables.bodies[tables.live[k]]
        energy = 0.0
        if body.inverse_mass > 0.0:
            energy += (body.came_vx * body.came_vx + body.came_vy * body.came_vy) / body.inverse_mass
        if body.inverse_moment > 0.0:
            energy += body.came_w * body.came_w / body.inverse_moment
            tables.islands[number].moment += 1.0 / body.inverse_moment
        tables.islands[number].energy += 0.5 * energy
    for k in range(tables.counters[ISLANDS]):
        island = tables.islands[k]
        island.held += min(island.product, LOOSE * island.energy)
        island.product = 0.0
        island.mending = island.mass * island.mending + island.moment * island.turning + 2.0 * island.lifted


@kernel
def contacts_give_energy(tables: Tables, law: Law) -> bool:
    """Whether an island has been given more energy than it may have: those are active then, to be solved again.

    `ahead` of each island is what they have given. Joints may take it, or give it in their place: not what they give as
    they mend an error of place, unless contacts have.

    Who is at rest gives none.
    """
    _note_held(tables)
    for k in range(tables.counters[ISLANDS]):
        island = tables.islands[k]
        island.active = 0
        island.ahead = 0.0
        island.curvature = island.held
        island.part = 0.0
    for i in range(tables.counters[ROWS]):
        row = tables.rows[i]
        kind = _kind(tables, row)
        if kind == SPRING or kind == ROTARY_SPRING or (kind < 0 and row.l1 + row.l2 == 0.0):
            continue
        a = tables.bodies[row.a]
        b = tables.bodies[row.b]
        island = tables.islands[island_of(tables, row)]
        if island.still:
            continue
        if kind < 0 and _may_give(law, tables.pairs[tables.regions[row.region].pair], a, b):
            continue
        ux, uy = a.came_vx - b.came_vx, a.came_vy - b.came_vy
        came1, came2, came_t = _speeds(row, kind, ux, uy, a.came_w, b.came_w)
        v1, v2, slip = _speeds(row, kind, a.vx - b.vx, a.vy - b.vy, a.w, b.w)
        given = -0.5 * (row.l1 * (came1 + v1) + row.l2 * (came2 + v2) + row.lt * (came_t + slip))
        if kind < 0:
            change1, change2 = abs(v1 - came1), abs(v2 - came2)
            alone1, alone2 = change1 / row.weight, change2 / row.weight
            unsolved = min(row.l1, alone1) * change1 + min(row.l2, alone2) * change2
            island.ahead += given
            island.curvature += UNSOLVED_WORK * unsolved
        else:
            island.product += given
            if kind != MOTOR:
                island.part += row.l1 * row.t1 + row.lt * row.tt
    again = False
    for k in range(tables.counters[ISLANDS]):
        island = tables.islands[k]
        given = island.ahead + island.product
        gives = max(given + island.part, min(island.ahead, given)) > island.curvature
        island.again = CONTACTS_GIVE if gives and island.ahead != 0.0 else 0
        if min(given, -0.5 * island.part) > island.curvature + 0.5 * island.mending:
            island.again += JOINTS_GIVE
            island.held += 0.5 * island.mending
        island.active = island.again > 0
        again |= island.active
    return again


@kernel
def begin_again(tables: Tables) -> None:
    """From the velocities before the sweeps, without impulses; what there was is taken down.

    Where contacts give energy, without restitution and friction; where joints do, without what they mend.
    """
    list_active(tables)
    for k in range(tables.counters[LIVE]):
        body = tables.bodies[tables.live[k]]
        m = tables.mobility[tables.live[k]]
        if m.island >= 0 and tables.islands[m.island].again:
            m.vx = body.vx
            m.vy = body.vy
            m.vw = body.w
            body.vx = body.came_vx
            body.vy = body.came_vy
            body.w = body.came_w
    for k in range(tables.counters[QUEUE]):
        row = tables.rows[tables.queue[k].row]
        row.was1 = row.l1
        row.was2 = row.l2
        row.was_t = row.lt
        row.l1 = 0.0
        row.l2 = 0.0
        row.lt = 0.0
        again = tables.islands[tables.queue[k].island].again
        if row.ends > 0:
            if again != JOINTS_GIVE:
                row.friction = 0.0
                row.most = 0.0
                row.t1 = max(0.0, row.t1)
                row.t2 = max(0.0, row.t2)
        elif again != CONTACTS_GIVE and _holds(_kind(tables, row)):
            t1, tt = mending_speeds(row)
            row.t1 -= t1
            row.tt -= tt


@kernel(forceinline=True)
def _largest_part(a0: float, a1: float, a2: float, most: float) -> float:
    """The largest s up to 1 before which a0 + a1 s + a2 s^2 is no more than `most`, or than at 0 where it is more."""
    c = min(0.0, a0 - most)
    if c == 0.0:
        return min(1.0, -a1 / a2) if a1 < -a2 and a2 > 0.0 else 0.0
    root = a1 * a1 - 4.0 * a2 * c
    if root < 0.0:
        return 1.0
    # the smaller positive root, without cancellation; a1 + a2 > -c > 0 where there is one up to 1
    below = a1 + math.sqrt(root)
    return min(1.0, -2.0 * c / below) if below > 0.0 else 1.0


@kernel
def mix(tables: Tables, law: Law) -> None:
    """Of the solve before, which gave energy, the largest part that gives none, the rest of the one without."""
    for k in range(tables.counters[ISLANDS]):
        island = tables.islands[k]
        island.ahead = 0.0
        island.curvature = 0.0
        island.product = 0.0
    for i in range(tables.counters[ROWS]):
        row = tables.rows[i]
        island = tables.islands[island_of(tables, row)]
        kind = _kind(tables, row)
        if not island.again or kind == SPRING or kind == ROTARY_SPRING:
            continue
        a = tables.bodies[row.a]
        b = tables.bodies[row.b]
        if kind < 0 and _may_give(law, tables.pairs[tables.regions[row.region].pair], a, b):
            continue
        of_a = tables.mobility[row.a]
        of_b = tables.mobility[row.b]
        ux, uy, wa, wb = a.vx - b.vx, a.vy - b.vy, a.w, b.w
        came_x, came_y = a.came_vx - b.came_vx, a.came_vy - b.came_vy
        came1, came2, came_t = _speeds(row, kind, came_x, came_y, a.came_w, b.came_w)
        v1, v2, slip = _speeds(row, kind, ux, uy, wa, wb)
        if of_a.island >= 0:
            ux += of_a.vx - a.vx
            uy += of_a.vy - a.vy
            wa = of_a.vw
        if of_b.island >= 0:
            ux -= of_b.vx - b.vx
            uy -= of_b.vy - b.vy
            wb = of_b.vw
        d1, d2, dt = _speeds(row, kind, ux, uy, wa, wb)
        d1 -= v1
        d2 -= v2
        dt -= slip
        m1, m2, mt = row.was1 - row.l1, row.was2 - row.l2, row.was_t - row.lt
        v1 += came1
        v2 += came2
        slip += came_t
        island.ahead -= 0.5 * (row.l1 * v1 + row.l2 * v2 + row.lt * slip)
        island.product -= 0.5 * (m1 * v1 + m2 * v2 + mt * slip + row.l1 * d1 + row.l2 * d2 + row.lt * dt)
        island.curvature -= 0.5 * (m1 * d1 + m2 * d2 + mt * dt)
    for k in range(tables.counters[ISLANDS]):
        island = tables.islands[k]
        island.part = _largest_part(island.ahead, island.product, island.curvature, island.held)
        if island.again:
            island.ahead = 0.0
    for k in range(tables.counters[LIVE]):
        body = tables.bodies[tables.live[k]]
        m = tables.mobility[tables.live[k]]
        if m.island >= 0 and tables.islands[m.island].again:
            part = tables.islands[m.island].part
            body.vx += part * (m.vx - body.vx)
            body.vy += part * (m.vy - body.vy)
            body.w += part * (m.vw - body.w)
    for i in range(tables.counters[ROWS]):
        row = tables.rows[i]
        island = tables.islands[island_of(tables, row)]
        if island.again:
            row.l1 += island.part * (row.was1 - row.l1)
            row.l2 += island.part * (row.was2 - row.l2)
            row.lt += island.part * (row.was_t - row.lt)
