"""What a blow does within a substep that no row knew of when it was made: it goes on.

Through what lies at rest it goes on as through something rigid, a bed being as stiff as its load asks and a blow
shorter than the step.
"""

from __future__ import annotations

from typing import Any

from ..compile.jit import kernel
from .active import active_island
from .birth import drives
from .constants import REST_KICKS
from .region import closing
from .row import take_inverse
from .tables import ACTIVE, FIXED, QUEUE, REST, Law, Tables


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
    row.alpha = 0.0
    take_inverse(row)
    return True


@kernel
def blows(tables: Tables, law: Law, h: float) -> bool:
    """Whether a blow goes on through what lies at rest: there it is no bed any more, and its island is to be searched.

    Only where the last sweep has moved more than is small. Not of what hangs in a joint, or a kinematic body hits:
    those press on, and something has to give way.
    """
    rows = tables.rows
    hit = False
    for k in range(tables.counters[ACTIVE]):
        island = active_island(tables, k)
        island.searching = 0
        hit |= island.moved > island.small
    if not hit:
        return False
    for k in range(tables.counters[QUEUE]):
        i = tables.queue[k].row
        a = tables.bodies[rows[i].a]
        b = tables.bodies[rows[i].b]
        a.free = a.calm >= 0
        b.free = b.calm >= 0
    for k in range(tables.counters[QUEUE]):
        i = tables.queue[k].row
        a = tables.bodies[rows[i].a]
        b = tables.bodies[rows[i].b]
        if drives(law, a) or drives(law, b):
            a.free = 0
            b.free = 0
    struck = False
    for k in range(tables.counters[QUEUE]):
        i = tables.queue[k].row
        island = tables.islands[tables.queue[k].island]
        if island.moved <= island.small or rows[i].ends == 0:
            continue
        a = tables.bodies[rows[i].a]
        b = tables.bodies[rows[i].b]
        if (a.free or a.kind == FIXED) and (b.free or b.kind == FIXED):
            if _struck_at_rest(rows[i], tables.regions[rows[i].region], law, a, b, h):
                island.searching = 1
                struck = True
    return struck
