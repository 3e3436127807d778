"""After the sweeps: what takes an overlap apart moves bodies, and is no speed that they keep.

A contact that the step is too long to follow is overdamped: pressed too deep it opens again within RELEASE_STEPS. That
speed is of the step's making, not of the bodies'; added up along a pile, and only half solved, it would throw the pile
up (Baumgarte's stabilization does). So bodies are moved by it, as far as it takes them in the substep, and then the
same rows are solved again, rigid, for the velocities that bodies go on with. (Chipmunk's pseudo-velocities and the
relaxing sweeps of Box2D v3 are for the same; E. Catto, "Solver2D", box2d.org, 2024.)

At rest, F = k A, nothing opens, and this changes nothing.
"""

from __future__ import annotations

from .constants import HIT
from .jit import kernel
from .place import place
from .row import stiffen
from .tables import DRIFTS, LIVE, ROWS, Tables


@kernel
def begin_to_relax(tables: Tables) -> bool:
    """Make rows rigid, and take down what velocities are with them as they were; whether any of them bears."""
    bears = False
    for i in range(tables.counters[ROWS]):
        bears |= stiffen(tables.rows[i])
    if bears:
        for k in range(tables.counters[LIVE]):
            i = tables.live[k]
            body = tables.bodies[i]
            before = tables.mobility[i]
            before.vx = body.vx
            before.vy = body.vy
            before.vw = body.w
    return bears


@kernel
def end_relaxing(tables: Tables, h: float) -> None:
    """Move bodies by what has been taken from their velocities, over a substep of h.

    By as much as contacts take apart: more than HIT of a body is a blow that the sweeps had not solved yet, and the
    velocity that it has now is the better one.
    """
    for k in range(tables.counters[LIVE]):
        i = tables.live[k]
        body = tables.bodies[i]
        before = tables.mobility[i]
        x = h * (before.vx - body.vx)
        y = h * (before.vy - body.vy)
        turn = h * (before.vw - body.w)
        way = abs(x) + abs(y) + abs(turn) * body.extent
        before.moved = 0.0 < way <= HIT * body.extent and body.kind == DRIFTS
        if before.moved:
            body.x += x
            body.y += y
            body.angle += turn
            place(body)
    # Parted while they slip, two bodies have other arms: spin makes that good.
    for i in range(tables.counters[ROWS]):
        row = tables.rows[i]
        if tables.mobility[row.a].moved and tables.mobility[row.b].moved:
            a = tables.bodies[row.a]
            b = tables.bodies[row.b]
            share = a.inverse_moment + b.inverse_moment
            if share > 0.0:
                normal = row.was1 - row.l1 + row.was2 - row.l2
                along = row.was_t - row.lt
                jx = normal * row.nx - along * row.ny
                jy = normal * row.ny + along * row.nx
                turn = (
                    h
                    * (jx * (a.vy - b.vy) - jy * (a.vx - b.vx))
                    * a.inverse_moment
                    * b.inverse_moment
                    / share
                )
                a.w += turn
                b.w += turn
