"""What a blow does within a substep that no row knew of when it was made: it goes on, and it takes.

Through what lies at rest it goes on as through something rigid, a bed being as stiff as its load asks and a blow
shorter than the step. And it adds no energy, which Newton's restitution can where friction turns the slip round.
"""

from __future__ import annotations

from typing import Any

from .birth import drives
from .constants import REST_KICKS
from .jit import kernel
from .region import closing
from .row import harden
from .tables import FIXED, REST, ROWS, STRUCK, Law, Tables


@kernel(forceinline=True)
def _struck_at_rest(row: Any, r: Any, law: Law, a: Any, b: Any, h: float) -> bool:
    """Whether what lies there is pressed in as by a blow, faster than rest, deeper than it lies: then it is rigid.

    A bed is as stiff as its load asks; a blow that goes on through it is shorter than the step.
    """
    if r.mode != REST or row.theta == 0.0 or row.alpha == 0.0:
        return False
    turn = a.w - b.w
    u = closing(r, a, b, 0.0) + max(-turn * row.e1, -turn * row.e2)
    pushed = max(law.gravity, abs(closing(r, a, b, 0.0) - closing(r, a, b, 1.0)) / h)
    if u <= REST_KICKS * pushed * h or u * h <= r.depth:
        return False
    harden(row, row.alpha)
    return True


@kernel
def blows(tables: Tables, law: Law, h: float) -> bool:
    """Whether a blow goes on through what lies at rest: there it is no bed any more.

    Not of what hangs in a joint, or a kinematic body hits: those press on, and something has to give way.
    """
    rows = tables.rows
    for i in range(tables.counters[ROWS]):
        a = tables.bodies[rows[i].a]
        b = tables.bodies[rows[i].b]
        a.free = a.calm >= 0
        b.free = b.calm >= 0
    for i in range(tables.counters[ROWS]):
        a = tables.bodies[rows[i].a]
        b = tables.bodies[rows[i].b]
        if drives(a) or drives(b):
            a.free = 0
            b.free = 0
    struck = False
    for i in range(tables.counters[ROWS]):
        a = tables.bodies[rows[i].a]
        b = tables.bodies[rows[i].b]
        if rows[i].ends > 0 and (a.free or a.kind == FIXED) and (b.free or b.kind == FIXED):
            struck |= _struck_at_rest(rows[i], tables.regions[rows[i].region], law, a, b, h)
    return struck


@kernel
def _give_back_less(row: Any, r: Any, a: Any, b: Any, elasticity: float) -> bool:
    """Whether a bounce has added energy: it is to leave more slowly then.

    Friction that has turned the slip round had work to give, of which Newton's restitution does not know (T. R. Kane,
    "A dynamics puzzle", Stanford Mechanics Alumni Club Newsletter, 1984). The work is -l (v + v')/2 at each end, and of
    friction likewise; slower by d at the ends it is l d / 2 less.
    """
    normal = row.l1 + row.l2
    if r.mode != STRUCK or normal == 0.0 or drives(a) or drives(b) or elasticity > 1.0:
        return False
    vx = a.vx + a.came_vx - b.vx - b.came_vx
    vy = a.vy + a.came_vy - b.vy - b.came_vy
    wa = a.w + a.came_w
    wb = b.w + b.came_w
    v = vx * row.nx + vy * row.ny + wa * row.arm_a - wb * row.arm_b
    slip = vy * row.nx - vx * row.ny + wa * row.lean_a - wb * row.lean_b
    turn = (wa - wb) * (row.l1 * row.e1 + row.l2 * row.e2)
    gain = -0.5 * (normal * v - turn + row.lt * slip)
    if gain <= 0.0:
        return False
    row.t1 = max(row.t1, min(0.0, row.t1 + 2.0 * gain / normal))
    row.t2 = max(row.t2, min(0.0, row.t2 + 2.0 * gain / normal))
    return True


@kernel
def calm_bounces(tables: Tables) -> bool:
    """No bounce adds energy: whether one did."""
    less = False
    for i in range(tables.counters[ROWS]):
        row = tables.rows[i]
        if row.ends > 0:
            region = tables.regions[row.region]
            elasticity = tables.pairs[region.pair].elasticity
            less |= _give_back_less(row, region, tables.bodies[row.a], tables.bodies[row.b], elasticity)
    return less
