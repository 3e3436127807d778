"""The substeps of a frame: drift, kick, overlap, rows, sweeps, relaxing, drift; contacts and joints together."""

from __future__ import annotations

from typing import Any

from ..compile.jit import kernel
from ..contact.active import form_islands, rest_settled, rest_small
from ..contact.bend import bend_again
from ..contact.blows import blows
from ..contact.conjugate import conjugate_gradients, select_searched
from ..contact.constants import MORE_SWEEPS, RELAX_SWEEPS, SEARCH_STEPS, SEARCH_SWEEPS, SETTLED
from ..contact.driven import lessen_driven
from ..contact.given_energy import begin_again, contacts_give_energy, mix
from ..contact.islands import share_kicks
from ..contact.join import SPARE, any_pair_touches, gather, has_room, join, no_pair_comes_near
from ..contact.order import arrange, find_near, sieve
from ..contact.relax import begin_to_relax, end_relaxing
from ..contact.solve import (
    drift,
    finish,
    fly,
    kick,
    sweep,
    warm_start,
    warm_start_in_part,
)
from ..contact.space_record import load_law, load_pool, load_tables, load_work
from ..contact.tables import BOXED, KNOWN, QUEUE, ROWS, SUBSTEP, UNSORTED, Law, Tables
from ..contact.taut import free_turning, geometric_stiffness
from .joints import ask_springs, own_joints
from .phases import ITERATIONS, OVERLAPS, PAIRS, POSITIONS, SPECULATIVE, lap
from .record import floats, look_at_partners


@kernel
def near_pairs(s: Any, space: int, h: float, time: float, ordered: bool = True) -> bool:
    """Find the pairs that are near, and order them unless `number` is about to. Whether there was room for them."""
    tables = load_tables(s)
    if not find_near(load_pool(s), tables, s.frame, h, time):
        return False
    more = tables.counters[BOXED] - tables.counters[KNOWN]
    if tables.counters[UNSORTED]:
        look_at_partners(s, tables)
        sieve(tables, s.frame)
        if ordered:
            g = floats(space + s.space_gravity, 2)
            arrange(tables, g[0], g[1])
    lap(s, PAIRS)
    return bool(s.begun or more <= SPARE // 2 or has_room(tables, time))


@kernel
def find_contacts(s: Any, space: int, h: float, time: float, jointed: bool) -> bool:
    """Find the pairs that are near, their regions and rows, and the joints'. Whether there was room for them."""
    if not near_pairs(s, space, h, time):
        return False
    tables = load_tables(s)
    s.begun = 1
    tables.counters[SUBSTEP] += 1
    tables.counters[ROWS] = 0
    found = gather(load_pool(s), tables, load_work(s), load_law(s), s.frame, h, jointed)
    lap(s, OVERLAPS)
    return bool(found)


@kernel
def _join(s: Any, tables: Tables, h: float, first: bool) -> int:
    """Rows that come up while the others are solved: how many; -1: there was no room for them."""
    lap(s, POSITIONS if first else ITERATIONS)
    joined = int(join(load_pool(s), tables, load_work(s), load_law(s), s.frame, h, first))
    lap(s, SPECULATIVE)
    return joined


@kernel
def _solve(s: Any, tables: Tables, h: float, whole: int, jointed: bool) -> bool:
    """The sweeps (`whole` of them) and searches of a substep, and the rows that join. Whether there was room for it.

    They go on in islands where the last sweep has moved much.
    """
    # before the warm start: what that adds is no speed at which anybody comes
    if _join(s, tables, h, True) < 0:
        return False
    if tables.counters[ROWS] == 0:
        return True  # nothing that could change a velocity
    law = load_law(s)
    form_islands(tables, law, h, 0)
    if jointed:
        warm_start_in_part(tables)
    else:
        warm_start(tables)
    searches = whole // SEARCH_SWEEPS
    sweeps = max(1, whole - 2 * searches - _relaxing(whole))
    for more in range(1 + MORE_SWEEPS):
        look = 1 if more == 0 else 0
        wait = 1
        for k in range(sweeps):
            if k == look:  # less and less often, as long as nobody joins
                joined = _join(s, tables, h, False)
                if joined < 0:
                    return False
                if joined > 0:
                    form_islands(tables, law, h, tables.counters[ROWS] - joined)
                wait = 1 if joined > 0 else 2 * wait if more == 0 else sweeps
                look += wait
            if k > 0 and tables.counters[QUEUE] == 0:
                break
            sweep(tables, k % 2 == 0)
            rest_settled(tables, k + 1, whole, SETTLED)
            if k == 0:
                select_searched(tables, more <= 1)
                conjugate_gradients(tables, SEARCH_STEPS if jointed else searches, jointed)
                if blows(tables, law, h):
                    conjugate_gradients(tables, searches, False)
                if jointed:
                    bend_again(tables, h)
        rest_small(tables)
        if tables.counters[QUEUE] == 0:
            break
    return True


@kernel(forceinline=True)
def _relaxing(sweeps: int) -> int:
    """How many sweeps of a substep come after positions are settled."""
    return (sweeps + RELAX_SWEEPS - 1) // RELAX_SWEEPS


@kernel
def _relax(s: Any, tables: Tables, h: float, whole: int) -> None:
    """Bodies are moved by what takes overlaps apart, and go on without that speed."""
    if not begin_to_relax(tables, load_law(s), h):
        return
    for k in range(whole):
        sweep(tables, k % 2 == 0)
        rest_settled(tables, k + 2, _relaxing(whole) + 1, 1.0)  # the last sweep before was of the same bodies
        if tables.counters[QUEUE] == 0:
            break
    end_relaxing(tables, h)


@kernel
def _give_no_energy(tables: Tables, law: Law, whole: int) -> None:
    """Where contacts have given energy: as much of that solve as gives none, the rest of one that cannot."""
    if not contacts_give_energy(tables, law):
        return
    begin_again(tables)
    for k in range(whole):
        sweep(tables, k % 2 == 0)
        # of a small part of it no more is asked than that it gives nothing
        rest_settled(tables, k + 1, 1, 1.0)
        if tables.counters[QUEUE] == 0:
            break
        if k == 0:
            select_searched(tables, True)
            conjugate_gradients(tables, SEARCH_STEPS, True)
    mix(tables, law)


@kernel
def substeps(s: Any, space: int, dt: float, n: int) -> bool:
    """A frame in n substeps of the bodies that are live. Whether there was room for it."""
    h = dt / n
    tables = load_tables(s)
    joints = own_joints(s, tables)
    sweeps = s.sweeps
    if s.steps_given == 0 and joints == 0:  # a calm frame has those of both substeps
        sweeps *= max(1, s.substeps // n)
    for i in range(n):
        drift(tables, s.frame, 0.5 * h if i == 0 else h)
        lap(s, POSITIONS)
        if i == 0 and joints == 0 and not any_pair_touches(tables):
            # as far as the last substep would look, half of it beyond the frame
            if not near_pairs(s, space, dt, dt):
                return False
            if no_pair_comes_near(tables, dt):
                tables.counters[SUBSTEP] += 1
                tables.counters[ROWS] = 0
                # under constant forces one kick in the middle is exact
                fly(tables, s.frame, 0.5 * (dt - h), 0.5 * dt)
                lap(s, POSITIONS)
                return True
        if i == 0:
            share_kicks(tables, n)
        kick(tables, s.frame)
        if joints > 0:
            ask_springs(s, tables)
            geometric_stiffness(tables, h)
        if not find_contacts(s, space, h, dt - i * h, joints > 0):
            return False
        if not _solve(s, tables, h, sweeps, joints > 0):
            return False
        lap(s, ITERATIONS)
        _relax(s, tables, h, sweeps)
        _give_no_energy(tables, load_law(s), sweeps)
        lessen_driven(tables, load_law(s))
        if joints > 0:
            free_turning(tables)
        finish(tables, load_law(s), s.frame, h, i == n - 1)
    drift(tables, s.frame, 0.5 * h)
    s.contacts += tables.counters[ROWS]
    lap(s, POSITIONS)
    return True
