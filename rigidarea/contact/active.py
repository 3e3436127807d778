"""Islands of rows: what is solved together, and which of it still is.

Rows that share a body that contacts or joints can move are one island; what they cannot move parts islands (as Box2D's
and Chipmunk's, but made anew in every substep from the rows that there are). Each island has a tolerance of its own,
and is left alone once it is solved: what lies still, or rolls by itself, pays for no collapse elsewhere. Sweeps and
searches see the rows (`Tables.queue`) and the bodies (`Tables.members`) of the islands that are active.
"""

from __future__ import annotations

import math
from typing import Any

from ..compile.jit import kernel
from ..compile.raw_memory import record
from .constants import CALM, LEFT, MOVED, REST_KICKS, REST_TURNS, SETTLED, SLOWLY, STILL_KICK
from .islands import root_of, unite
from .motion import kick_of
from .tables import ACTIVE, ISLANDS, LIVE, MEMBERS, QUEUE, ROWS, Law, Tables

#: Without weight a speed is none with which a body goes this part of the depth at which it may lie in a step: one of
#: 20 px goes a pixel in half an hour.
UNSEEN = 1e-3

ISLAND = record(
    [
        ("again", "i1"),  # bits, why it is solved anew: contacts, joints give energy (`given_energy`)
        ("active", "i1"),  # 1: it is not solved yet
        ("searching", "i1"),  # 1: it takes part in the search (`conjugate`)
        ("whole", "i1"),  # 1: no bound has cut the search's step short
        ("still", "i1"),  # 1: contacts bear it, neither speeds nor springs do more than a kick
        ("turn", "i1"),  # 0: this substep is solved as far as it takes to rest (REST_TURNS)
        ("driven", "i1"),  # 1: something that moves as it is told touches it
        ("listed", "i4"),  # number of the island that has this place among those that are active
        ("rows", "i4"),  # a joint counts as two: it is not solved by one visit
        ("mass", "f8"),
        ("extent", "f8"),  # of its smallest body (length)
        ("pushed", "f8"),  # sum of its masses times their kicks squared
        ("closing", "f8"),  # fastest that two close, or part, where its rows are (length/time)
        ("x", "f8"),  # momentum
        ("y", "f8"),
        ("lead_x", "f8"),  # what its bodies have borne of what forces have given ahead (momentum)
        ("lead_y", "f8"),
        ("energy", "f8"),  # kinetic, relative to that
        ("moment", "f8"),
        ("mending", "f8"),  # speeds at which its joints mend errors, summed (length/time)
        ("turning", "f8"),  # and rotary ones (1/time)
        ("lifted", "f8"),  # what they do against what they bore, as they mend (energy)
        ("held", "f8"),  # what its rows' springs hold, and could give back (energy)
        ("low_x", "f8"),  # velocities of what it touches that no impulse moves (`driven`)
        ("low_y", "f8"),
        ("high_x", "f8"),
        ("high_y", "f8"),
        ("small", "f8"),  # a change in a sweep that is small beside its kicks and speeds (length/time)
        ("seen", "f8"),  # and with which one that is still is left after all sweeps
        # largest change of a contact's speed in the last sweep, 0 once it is solved; that when its solve has ended, of
        # one that is still (length/time)
        ("moved", "f8"),
        ("left", "f8"),
        ("before", "f8"),  # of the search: residual times direction, a step ago (0: begin anew) and now
        ("product", "f8"),
        ("ahead", "f8"),
        ("curvature", "f8"),
        ("gained", "f8"),  # by the search's last step, of what it would have gained unbounded
        ("part", "f8"),
    ]
)


#: A row that is being solved, and the number of its island.
QUEUED = record([("row", "i4"), ("island", "i4")])


@kernel(forceinline=True)
def moves(body: Any) -> bool:
    """Whether an impulse moves it."""
    return bool(body.inverse_mass > 0.0 or body.inverse_moment > 0.0)


@kernel(forceinline=True)
def island_of(tables: Tables, row: Any) -> int:
    """The number of a row's island."""
    return int(tables.mobility[_of_row(tables, row)].island)


@kernel(forceinline=True)
def _of_row(tables: Tables, row: Any) -> int:
    """The body by which a row belongs to its island."""
    return int(row.a if moves(tables.bodies[row.a]) else row.b)


@kernel(forceinline=True)
def active_island(tables: Tables, k: int) -> Any:
    """The k-th island that is active."""
    return tables.islands[tables.islands[k].listed]


@kernel
def form_islands(tables: Tables, law: Law, h: float, first: int) -> None:
    """Part the rows into islands. Those are active that have a row from `first` on, or were before: all, if that is 0.

    `small` and `energy` are of the velocities before the sweeps.
    """
    mobility = tables.mobility
    n = tables.counters[ROWS]
    for k in range(tables.counters[LIVE]):
        i = tables.live[k]
        m = mobility[i]
        tables.bodies[i].island = i
        m.island = -1
        if first == 0:
            m.solved = 0
    for r in range(n):
        row = tables.rows[r]
        if moves(tables.bodies[row.a]) and moves(tables.bodies[row.b]):
            unite(tables, row.a, row.b)
    count = 0
    for r in range(n):
        i = _of_row(tables, tables.rows[r])
        root = root_of(tables, i)
        if mobility[root].island < 0:
            mobility[root].island = count
            tables.islands[count].rows = 0
            tables.islands[count].active = 0
            tables.islands[count].gained = 1.0
            count += 1
        island = tables.islands[mobility[root].island]
        island.rows += 1 if tables.rows[r].ends > 0 else 2
        if r >= first or not mobility[i].solved:
            island.active = 1
    tables.counters[ISLANDS] = count
    for k in range(tables.counters[LIVE]):
        i = tables.live[k]
        if mobility[i].island < 0:
            mobility[i].island = mobility[root_of(tables, i)].island
        if not moves(tables.bodies[i]):
            mobility[i].island = -1
    if first == 0:
        _take_turns(tables)
    measure(tables, law, h, True)
    list_active(tables)


@kernel
def _take_turns(tables: Tables) -> None:
    """Which of REST_TURNS substeps it is for each island, and for its bodies: all of one island go together."""
    for k in range(tables.counters[ISLANDS]):
        tables.islands[k].turn = 0
    for k in range(tables.counters[LIVE]):
        number = tables.mobility[tables.live[k]].island
        if number >= 0:
            body = tables.bodies[tables.live[k]]
            body.rest_turn = (body.rest_turn + 1) % REST_TURNS
            tables.islands[number].turn = max(tables.islands[number].turn, body.rest_turn)
    for k in range(tables.counters[LIVE]):
        number = tables.mobility[tables.live[k]].island
        if number >= 0:
            tables.bodies[tables.live[k]].rest_turn = tables.islands[number].turn


@kernel
def measure(tables: Tables, law: Law, h: float, before: bool) -> None:
    """Mass, energy and what is small of every island, by the velocities before the sweeps or by those now.

    Of speeds no more digits are asked than a sum of squares has: they say what is small.
    """
    for k in range(tables.counters[ISLANDS]):
        island = tables.islands[k]
        island.mass = 0.0
        island.x = 0.0
        island.y = 0.0
        island.energy = 0.0
        island.held = 0.0
        island.still = 0
        island.extent = math.inf
        island.pushed = 0.0
        island.closing = 0.0
        island.turn = 0
    for k in range(tables.counters[LIVE]):
        number = tables.mobility[tables.live[k]].island
        if number < 0:
            continue
        body = tables.bodies[tables.live[k]]
        island = tables.islands[number]
        island.extent = min(island.extent, body.extent)
        island.turn = max(island.turn, body.rest_turn)
        vx, vy, w = (body.came_vx, body.came_vy, body.came_w) if before else (body.vx, body.vy, body.w)
        if body.inverse_mass > 0.0:
            own = 1.0 / body.inverse_mass
            island.mass += own
            island.pushed += own * (body.kick_x * body.kick_x + body.kick_y * body.kick_y)
            island.x += own * vx
            island.y += own * vy
            island.energy += 0.5 * own * (vx * vx + vy * vy)
        if body.inverse_moment > 0.0:
            island.energy += 0.5 * w * w / body.inverse_moment
    for r in range(tables.counters[ROWS]):
        row = tables.rows[r]
        if row.ends > 0:
            island = tables.islands[island_of(tables, row)]
            island.held += (1.0 - row.theta) * row.held  # the rest opens without speed (`relax`)
            island.still = 1
            island.closing = max(island.closing, abs(tables.regions[row.region].speed))
    for k in range(tables.counters[ISLANDS]):
        island = tables.islands[k]
        kick = kick_of(law, island.extent, h) * (1.0 if law.gravity > 0.0 else UNSEEN)
        speed = 0.0
        able = 0.0
        if island.mass > 0.0:  # what is the same for all is nobody's speed
            common = 0.5 * (island.x * island.x + island.y * island.y) / island.mass
            island.energy = max(0.0, island.energy - common)
            speed = math.sqrt(2.0 * island.energy / island.mass)
            able = math.sqrt(2.0 * (island.energy + island.held) / island.mass)
            pushed = math.sqrt(island.pushed / island.mass)
            island.still = island.still and pushed > 0.0  # without load a small change is small at rest too
            kick = max(kick, pushed)
        island.small = LEFT * kick + MOVED * speed
        island.still = island.still and max(able, island.closing / REST_KICKS) < kick
        island.seen = SETTLED * island.small
        if island.still and speed < CALM * kick and island.turn == 0:
            island.small = LEFT * max(SLOWLY * STILL_KICK * kick, speed)


@kernel
def list_active(tables: Tables) -> None:
    """List the islands that are active, their rows, in order, and their bodies with all that nothing moves."""
    counters = tables.counters
    counters[ACTIVE] = counters[ISLANDS]
    for k in range(counters[ISLANDS]):
        tables.islands[k].listed = k
    counters[QUEUE] = counters[ROWS]
    for r in range(counters[ROWS]):
        tables.queue[r].row = r
        tables.queue[r].island = island_of(tables, tables.rows[r])
    counters[MEMBERS] = counters[LIVE]
    for k in range(counters[LIVE]):
        tables.members[k] = tables.live[k]
        tables.mobility[tables.live[k]].solved = 0
    _leave_solved(tables)


@kernel
def _leave_solved(tables: Tables) -> None:
    """Take islands that are active no more out of the lists."""
    counters = tables.counters
    n = 0
    for k in range(counters[ACTIVE]):
        number = tables.islands[k].listed
        if tables.islands[number].active:
            tables.islands[n].listed = number
            n += 1
    counters[ACTIVE] = n
    n = 0
    for k in range(counters[QUEUE]):
        queued = tables.queue[k]
        if tables.islands[queued.island].active:
            tables.queue[n].row = queued.row
            tables.queue[n].island = queued.island
            n += 1
    counters[QUEUE] = n
    n = 0
    for k in range(counters[MEMBERS]):
        i = tables.members[k]
        number = tables.mobility[i].island
        tables.mobility[i].solved = number >= 0 and not tables.islands[number].active
        if not tables.mobility[i].solved:
            tables.members[n] = i
            n += 1
    counters[MEMBERS] = n


@kernel
def rest_settled(tables: Tables, swept: int, least: int, most: float) -> None:
    """Islands are solved that the last of so many sweeps has changed by no more than SETTLED of what is small.

    After `least` sweeps by no more than `most` of it. One row alone is solved by its first visit (`row.visit`), unless
    that has moved much: then a blow may go on through it (`blows`).
    """
    dropped = False
    for k in range(tables.counters[ACTIVE]):
        island = active_island(tables, k)
        enough = SETTLED if swept < least else most
        alone = island.rows == 1 and island.moved <= island.small
        if alone or (swept > 1 and island.moved <= enough * island.small):
            island.active = 0
            island.moved = 0.0
            dropped = True
    if dropped:
        _leave_solved(tables)


@kernel
def rest_small(tables: Tables) -> None:
    """Islands are solved in which the last sweep's changes were small; of what is still not even seen (`seen`)."""
    for k in range(tables.counters[ACTIVE]):
        island = active_island(tables, k)
        if island.moved <= (island.seen if island.still else island.small):
            island.active = 0
    _leave_solved(tables)
