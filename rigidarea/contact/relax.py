"""After the sweeps: what takes an overlap apart moves bodies, and is no speed that they keep.

A contact that the step is too long to follow is overdamped: pressed too deep it opens again within RELEASE_STEPS. That
speed is of the step's making, not of the bodies'; added up along a pile, and only half solved, it would throw the pile
up (Baumgarte's stabilization does). So bodies are moved by it, as far as it takes them in the substep, and then the
same rows are solved again, rigid, for the velocities that bodies go on with. (Chipmunk's pseudo-velocities and the
relaxing sweeps of Box2D v3 are for the same; E. Catto, "Solver2D", box2d.org, 2024.)

At rest, F = k A, nothing opens, and this changes nothing.
"""

from __future__ import annotations

from typing import Any

from ..compile.jit import kernel
from ..geometry.place import turn
from .active import island_of, list_active, measure
from .row import take_inverse
from .tables import DRIFTS, ISLANDS, JOINTS, LED, LIVE, ROWS, Law, Tables


@kernel
def begin_to_relax(tables: Tables, law: Law, h: float) -> bool:
    """Make rows rigid, and take down what velocities are with them as they were; whether any of them bears.

    Islands in which one does are active.
    """
    bears = False
    for k in range(tables.counters[ISLANDS]):
        island = tables.islands[k]
        island.active = 0
        island.left = island.moved if island.still else 0.0
    for i in range(tables.counters[ROWS]):
        row = tables.rows[i]
        if _stiffen(row, row.ends > 0 and row.jammed == 1 and _hinged(tables, row.a, row.b)):
            tables.islands[island_of(tables, row)].active = 1
            bears = True
    if bears:
        list_active(tables)
        measure(tables, law, h, False)
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
    """Move bodies by what has been taken from their velocities, over a substep of h."""
    for k in range(tables.counters[LIVE]):
        i = tables.live[k]
        body = tables.bodies[i]
        taken = tables.mobility[i]
        taken.vx -= body.vx
        taken.vy -= body.vy
        taken.vw -= body.w
        taken.moved = body.kind == DRIFTS and (taken.vx != 0.0 or taken.vy != 0.0 or taken.vw != 0.0)
        if body.kind == LED:  # its own function moves it
            body.put_x += h * taken.vx
            body.put_y += h * taken.vy
            body.put_a += h * taken.vw
        if taken.moved:
            body.x += h * taken.vx
            body.y += h * taken.vy
            turn(body, h * taken.vw)
    for i in range(tables.counters[ROWS]):
        row = tables.rows[i]
        of_a = tables.mobility[row.a]
        of_b = tables.mobility[row.b]
        if of_a.moved:
            row.slid += row.nx * of_a.vy - row.ny * of_a.vx + row.lean_a * of_a.vw
        if of_b.moved:
            row.slid -= row.nx * of_b.vy - row.ny * of_b.vx + row.lean_b * of_b.vw
        if of_a.moved and of_b.moved:
            _turn_back(row, tables.bodies[row.a], tables.bodies[row.b], h)


@kernel(forceinline=True)
def _turn_back(row: Any, a: Any, b: Any, h: float) -> None:
    """Parted while they slip, two bodies have other arms: spin makes good what the rows' change gains by that."""
    rough = row.friction + row.most > 0.0
    ia = a.inverse_moment if rough or row.arm_a != 0.0 else 0.0  # nothing turns a smooth disc
    ib = b.inverse_moment if rough or row.arm_b != 0.0 else 0.0
    if ia + ib > 0.0:
        normal = row.was1 - row.l1 + row.was2 - row.l2
        along = row.was_t - row.lt
        jx = normal * row.nx - along * row.ny
        jy = normal * row.ny + along * row.nx
        ux = a.vx - b.vx
        uy = a.vy - b.vy
        spin = h * (jx * uy - jy * ux)
        back = spin * ia * ib / (ia + ib) if ia > 0.0 and ib > 0.0 else spin * (ia + ib)
        # what turns easily no faster than they slip: no place for second orders
        most = (abs(ux) + abs(uy)) / max(a.extent if ia > 0.0 else 0.0, b.extent if ib > 0.0 else 0.0)
        back = min(most, max(-most, back))
        a.w += back if ia > 0.0 else 0.0
        b.w += back if ib > 0.0 else 0.0


@kernel
def _hinged(tables: Tables, a: int, b: int) -> bool:
    """Whether a joint holds two bodies to each other."""
    for k in range(tables.counters[JOINTS]):
        joint = tables.joints[k]
        if joint.mine and ((joint.a == a and joint.b == b) or (joint.a == b and joint.b == a)):
            return True
    return False


@kernel(forceinline=True)
def _stiffen(row: Any, hinged: bool) -> bool:
    """The row as of a rigid contact, as far as the step is too long for its spring; whether it bears as such."""
    row.was1 = row.l1
    row.was2 = row.l2
    row.was_t = row.lt
    if row.ends == 0:
        return False
    if row.jammed:  # held overlapped it presses nobody; what a joint of the two bears it goes on bearing
        row.f1 = row.l1 if hinged else 0.0
        row.f2 = row.l2 if hinged else 0.0
        row.held = 0.0
        return bool(row.l1 + row.l2 > 0.0)
    if row.theta == 0.0:
        return False
    row.alpha -= row.theta * row.alpha
    take_inverse(row)
    return bool(row.l1 + row.l2 > 0.0)
