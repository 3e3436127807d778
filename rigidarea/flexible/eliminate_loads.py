"""The loads of ``condense``, and the turns of their directions, taken out of Newton's system and put back in."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidarea.compile.jit import kernel, vectorized
from rigidarea.flexible.bodies import boundary_at, work_at
from rigidarea.flexible.boundary import Boundary, Work
from rigidarea.flexible.boundary_places import add_load, clear_nodes
from rigidarea.flexible.condense import flexible
from rigidarea.flexible.dense import SUMS, again, factor
from rigidarea.flexible.load_moves import body_compliance, hub_moves, note_loads
from rigidarea.flexible.scratch import Loads

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@kernel
def _number_turns(buf: Any, s: Loads) -> int:
    """Numbers the turns of regions that turn after the loads, in ``buf.turning`` of each load, -1 of others; the number
    of unknowns."""
    n = s.made[0]
    end, first = n, 0
    turns = False
    for i in range(n):
        turns = turns or s.turn[0, i] != 0.0 or s.turn[1, i] != 0.0
        if i + 1 < n and s.region[i + 1] == s.region[i]:
            continue
        for j in range(first, i + 1):
            buf.turning[j] = end if turns else -1
        end, first, turns = end + 1 if turns else end, i + 1, False
    return end


@kernel
def _moved(
    b: Boundary, w: Work, s: Loads, buf: Any, body: int, i: int, k: int, m: int, held: bool, out: Array
) -> None:
    """What motions of one body's frame, and forces on its hub, move load i along (k: 0) or across (1) its direction."""
    ex, ey = s.world[i, 0], s.world[i, 1]
    if k == 1:
        ex, ey = -ey, ex
    out[0], out[1] = ex, ey
    out[2] = (s.at[i, 0] - buf.pose[body, 0]) * ey - (s.at[i, 1] - buf.pose[body, 1]) * ex
    if s.node[i] == -2:
        out[2] = s.local[i, 0]
    out[2] += buf.lag[k, i]
    if held:
        ex, ey = s.local[i, 0], s.local[i, 1]
        if k == 1:
            ex, ey = -ey, ex
        modal = buf.modal[i, :m] if k == 0 else buf.gauge[i, :m]
        hub_moves(b, w, s.node[i], ex, ey, buf.pose[body], modal, buf.modes[0, :m], out[3:])


@vectorized(
    "void(f8[:, ::1], f8[:, ::1], f8[:, ::1], f8[:, ::1], f8[:, ::1], i8[::1], i8[::1], f8[:, ::1], i8, i8, i8, i8,"
    " b1)",
    fastmath=SUMS,
)
def _answers(
    k: Array, across: Array, turn: Array, along: Array, beside: Array, region: Ints, turning: Ints, out: Array, n: int,
    unknowns: int, first: int, end: int, wide: bool,
) -> None:  # fmt: skip
    """K' of ``condense`` times columns ``first`` … ``end`` - 1 of what loads are moved along and ``beside``."""
    for i in range(n, unknowns):
        for c in range(first, end):
            out[i, c] = 0.0
    start = 0
    for i in range(n):
        if region[i] != region[start]:
            start = i
        stop = i + 1
        while stop < n and region[stop] == region[i]:
            stop += 1
        row = out[i]
        for c in range(first, end):
            row[c] = 0.0
        for j in range(start, stop):
            f, g = k[i, j], across[i, j]
            if f == 0.0 and (g == 0.0 or not wide):
                continue
            if wide:
                for c in range(first, end):
                    row[c] += f * along[j, c] + g * beside[j, c]
            else:
                for c in range(first, end):
                    row[c] += f * along[j, c]
        if turning[i] >= 0:
            row = out[turning[i]]
            f, g = turn[0, i], turn[1, i]
            for c in range(first, end):
                row[c] -= f * along[i, c] + g * beside[i, c]


@vectorized(
    "void(f8[:, ::1], f8[:, ::1], f8[:, ::1], f8[::1], i8[::1], f8[:, ::1], i8, i8, i8)", fastmath=SUMS
)
def _transfer(
    along: Array, beside: Array, system: Array, force: Array, turning: Ints, out: Array, n: int, unknowns: int,
    columns: int,
) -> None:  # fmt: skip
    """Forces on frames and hubs, a row each, by the solutions in ``system``: those of a, and of each unit motion."""
    for c in range(columns):
        row = out[c]
        for d in range(columns + 1):
            row[d] = 0.0
        for i in range(n):
            p, t = along[i, unknowns + 1 + c], turning[i]
            if p != 0.0:
                y = system[i, unknowns:]
                for d in range(columns + 1):
                    row[d] += p * y[d]
            p = force[i] * beside[i, unknowns + 1 + c] if t >= 0 else 0.0
            if p != 0.0:
                y = system[t, unknowns:]
                for d in range(columns + 1):
                    row[d] += p * y[d]


@kernel
def answer_to(buf: Any, s: Loads, n: int) -> None:
    """With the last tangent, the answer of loads and turns to displacements in column ``buf.counts[3]`` of
    ``buf.along`` and ``buf.across``: changed sign, into ``buf.single``."""
    end = buf.counts[3]
    _answers(
        s.stiffness, s.across, s.turn, buf.along, buf.across, s.region, buf.turning, buf.system, n, end, end, end + 1,
        buf.counts[4] > 0,
    )  # fmt: skip
    for i in range(end):
        buf.single[i] = buf.system[i, end]
    again(buf.system, end, buf.pivot, buf.single)


@kernel
def eliminate_loads(bodies: Ints, sy: Any, buf: Any, state: Any, s: Loads, wide: bool) -> float:
    """Takes the loads out of Newton's system: ``buf.tangent`` gets Pᵀ S, ``buf.push`` Pᵀ y₀.

    ``s.side`` holds bodies by now, ``buf.modal_residual`` the modes' residual under the new loads. wide: whether loads
    answer to what moves them across, and have the directions of their regions. Returns the sum of |y₀|: by how much
    the loads are off from what belongs to the present frames.
    """
    n, count = s.made[0], len(sy.mass)
    buf.push[:] = 0.0
    if n == 0:
        return 0.0
    unknowns = n
    if wide:
        unknowns = _number_turns(buf, s)
    else:
        buf.turning[:n] = -1
    first = unknowns + 1
    for b in range(count):
        buf.touched[b] = 0
    for i in range(n):
        buf.touched[s.side[i]] = 1
        buf.lag[0, i] = buf.lag[1, i] = 0.0
        buf.along[i, : first + 6 * count] = 0.0
        buf.across[i, : first + 6 * count] = 0.0
    columns = 0
    for b in range(count):
        if buf.touched[b] == 0:
            continue
        bd, w = boundary_at(bodies, b), work_at(bodies, b)
        lo, hi = sy.first[b], sy.first[b + 1]
        if flexible(bd):
            own = note_loads(bd, w, s, buf, b, lo, hi, state.q[lo:hi], unknowns, wide)
            body_compliance(bd, w, s, buf, own, unknowns, wide)
        held = flexible(bd) and (sy.pinned[b] == 1 or sy.driven[b] == 1 or sy.damper[b] > 0.0)
        if sy.fixed[b] == 1 and not held:
            continue
        for k in range(6 if held else 3):
            buf.active[columns + k] = 3 * b + k if k < 3 else 3 * count + 3 * b + k - 3
        at = first + columns
        for i in range(n):
            if s.side[i] == b:
                _moved(bd, w, s, buf, b, i, 0, hi - lo, held, buf.along[i, at : at + 6])
                if wide:
                    _moved(bd, w, s, buf, b, i, 1, hi - lo, held, buf.across[i, at : at + 6])
        columns += 6 if held else 3
    # (I + K' C') y = −K' (a + P δ)
    end = first + columns
    system = buf.system
    _answers(
        s.stiffness, s.across, s.turn, buf.along, buf.across, s.region, buf.turning, system, n, unknowns, 0, end, wide
    )  # fmt: skip
    for i in range(unknowns):
        system[i, i] += 1.0
    factor(system, unknowns, end, buf.pivot)
    off = 0.0
    for i in range(n):
        off += abs(system[i, unknowns])
        if buf.turning[i] >= 0:
            off += abs(s.force[i] * system[buf.turning[i], unknowns])
    _transfer(buf.along, buf.across, system, s.force, buf.turning, buf.grip, n, unknowns, columns)
    for c in range(columns):
        to = buf.active[c]
        buf.push[to] -= buf.grip[c, 0]
        for d in range(columns):
            buf.tangent[to, buf.active[d]] += buf.grip[c, 1 + d]
    buf.counts[2], buf.counts[3], buf.counts[4] = columns, unknowns, 1 if wide else 0
    return off


@kernel
def renew_loads(bodies: Ints, sy: Any, buf: Any, s: Loads, scale: float) -> None:
    """The loads that belong to the solution in ``buf.rhs``, and the nodes' loads: changes along and across each load in
    ``buf.answer``.
    """
    n, unknowns, columns, count = s.made[0], buf.counts[3], buf.counts[2], 3 * len(sy.mass)
    for b in range(len(sy.mass)):
        clear_nodes(work_at(bodies, b))
    for i in range(unknowns if n > 0 else 0):
        row = buf.system[i]
        y = -row[unknowns]
        for c in range(columns):
            to = buf.active[c]
            if to < count:
                y -= row[unknowns + 1 + c] * buf.rhs[to]
            elif buf.column[to - count] >= 0:
                y -= row[unknowns + 1 + c] * buf.rhs[buf.column[to - count]] / scale
        buf.single[i] = y
    for i in range(n):
        t = buf.turning[i]
        buf.answer[0, i], buf.answer[1, i] = buf.single[i], s.force[i] * buf.single[t] if t >= 0 else 0.0
        if s.node[i] >= 0:
            w = work_at(bodies, s.side[i])
            f, g = s.force[i] + buf.answer[0, i], buf.answer[1, i]
            x, y = s.local[i, 0], s.local[i, 1]
            add_load(w.node_load, w.node_flag, w.loaded, s.node[i], f * x - g * y, f * y + g * x)
