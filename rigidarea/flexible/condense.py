"""Contact forces and quasi-static deformation solved together: the loads as unknowns of Newton's iteration.

Displacements u = Φ q + C f enter an evaluation with the loads f° of the iteration before; the evaluation finds loads
f. To renew u with them and nothing else runs away on a soft body: a pressure pushes the boundary back by more than it
was pressed in. To treat each region's resultant alone is not enough either: regions of one body feel each other
through it (the teeth of an internal gear), and within a region the pressure has a shape of its own.

So the unknowns are all loads: one scalar f_i along the contact's direction for each FE boundary node under a region,
and for a rigid side two, at the ends of its chord. With w_i the displacement at load i along its direction, Gauss
points with weights ω and thickness d, and N the shape functions of both sides,

    f = Σ k ω d N,        ∂f/∂w = −K,        K = Σ k ω N Nᵀ,

symmetric and positive as k > 0. Between two evaluations w changes by Δw = C̃ y + a + P δ, y = f_next − f, where C̃ is C
and what the modes give within a step, Φ (M' + C' + ω²)⁻¹ Φᵀ; a = C (f − f°) less what the modes' own residual
moves; δ the unknown changes of frames and hub forces with P what they move at the loads. Hence

    (I + K C̃) y = −K (a + P δ)      ⇒      y = y₀ − S δ.

Pᵀ y₀ and Pᵀ S go to the frames' and hubs' rows; the frames' solution δ gives the loads. As C̃ is positive as well, the
linear system is regular, and this is the semi-smooth Newton method of the obstacle problem (M. Hintermüller, K. Ito,
K. Kunisch, SIAM J. Optim. 13, 2002, doi:10.1137/S1052623401383558): where a load comes out negative the contact opens
in the next evaluation. Left out of the tangent are the turns of the directions.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidarea.compile.jit import kernel
from rigidarea.flexible.bodies import boundary_at, work_at
from rigidarea.flexible.boundary import Boundary, Work
from rigidarea.flexible.boundary_places import add_load, clear_nodes
from rigidarea.flexible.dense import factor, yielded
from rigidarea.flexible.load_moves import body_compliance, hub_moves
from rigidarea.flexible.scratch import Loads, Scratch
from rigidarea.flexible.slabs import GAUSS_W, GAUSS_X, cuts, slab

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

TWO = (0.5 - 0.5 / 3.0**0.5, 0.5 + 0.5 / 3.0**0.5)  # Gauss: exact for a product of two linear shape functions


@kernel
def _new(s: Loads, side: int, node: int, x: float, y: float, nx: float, ny: float, pose: Array) -> int:
    """One more unknown: a load at (x, y), world, along the force on its side; its number."""
    i = s.made[0]
    s.made[0] += 1
    s.side[i], s.node[i], s.force[i], s.region[i] = side, node, 0.0, s.made[1]
    s.stiffness[i, : i + 1] = 0.0
    s.stiffness[:i, i] = 0.0
    sign = -1.0 if side == 0 else 1.0
    s.at[i, 0], s.at[i, 1] = x, y
    s.world[i, 0], s.world[i, 1] = sign * nx, sign * ny
    s.local[i, 0] = sign * (pose[2] * nx + pose[3] * ny)
    s.local[i, 1] = sign * (-pose[3] * nx + pose[2] * ny)
    return i


@kernel
def _at_node(b: Boundary, w: Work, pose: Array, s: Loads, side: int, node: int, nx: float, ny: float) -> int:
    """The unknown that is the load on an FE node in the present region."""
    if w.slot_region[node] != s.made[1]:
        x, y = b.nodes[node, 0] + w.displacement[node, 0], b.nodes[node, 1] + w.displacement[node, 1]
        c, sn = pose[2], pose[3]
        w.slot_region[node] = s.made[1]
        w.slot[node] = _new(s, side, node, pose[0] + c * x - sn * y, pose[1] + sn * x + c * y, nx, ny, pose)
    return w.slot[node]


@kernel
def _flexible(b: Boundary) -> bool:
    return b.modes.shape[1] > 0 or b.flexibility.shape[0] > 0


@kernel
def _enter(
    b: Boundary, w: Work, pose: Array, s: Loads, side: int, edge: int, t: float, weight: float, ends: int, along: float,
    nx: float, ny: float, count: int,
) -> int:  # fmt: skip
    """Appends the two unknowns under a place to ``s.entry``, with ``weight`` times their shares; their number so far.

    The place: parameter t of a contact edge; of a rigid side (``ends`` >= 0, the first of its two) ``along`` in [0, 1].
    """
    if ends >= 0:
        s.entry[count], s.share[count] = ends, weight * (1.0 - along)
        s.entry[count + 1], s.share[count + 1] = ends + 1, weight * along
        return count + 2
    j = b.following[edge]
    low = b.share[edge]
    high = b.share[j] if b.share[j] > 0.0 else 1.0  # within one finite-element edge, or to its end
    other = b.high[j] if b.share[j] > 0.0 else b.low[j]
    part = low + t * (high - low)
    s.entry[count] = _at_node(b, w, pose, s, side, b.low[edge], nx, ny)
    s.share[count] = weight * (1.0 - part)
    s.entry[count + 1] = _at_node(b, w, pose, s, side, other, nx, ny)
    s.share[count + 1] = weight * part
    return count + 2


@kernel
def enter_vector(
    b: Boundary, w: Work, pose: Array, s: Loads, side: int, edge: int, t: float, rigid: int, x: float, y: float,
    nx: float, ny: float, count: int,
) -> int:  # fmt: skip
    """Appends what a unit force along (nx, ny) at (x, y), parameter t of an edge, is to the unknowns of STS.

    Its forces have many directions: an FE node has two unknowns, along x and y; a rigid side (``rigid`` >= 0, the first
    of its three) has force and moment about its origin.
    """
    if rigid >= 0:
        for k in range(3):
            s.entry[count + k] = rigid + k
        s.share[count], s.share[count + 1] = nx, ny
        s.share[count + 2] = (x - pose[0]) * ny - (y - pose[1]) * nx
        return count + 3
    j = b.following[edge]
    low = b.share[edge]
    high = b.share[j] if b.share[j] > 0.0 else 1.0
    part = low + t * (high - low)
    for k in range(2):
        node = b.low[edge] if k == 0 else (b.high[j] if b.share[j] > 0.0 else b.low[j])
        v = 1.0 - part if k == 0 else part
        if w.slot_region[node] != s.made[1]:
            i = _at_node(b, w, pose, s, side, node, 1.0, 0.0)
            _new(s, side, node, s.at[i, 0], s.at[i, 1], 0.0, 1.0, pose)
        i = w.slot[node]
        s.entry[count], s.entry[count + 1] = i, i + 1
        s.share[count], s.share[count + 1] = v * nx, v * ny
        count += 2
    return count


@kernel
def begin_vectors(a: Boundary, pa: Array, b: Boundary, pb: Array, s: Loads) -> tuple[int, int]:
    """Starts a region of STS: the first of the three unknowns of each rigid side, -1 for sides that yield."""
    s.made[1] += 1
    first = (-1, -1)
    for side in range(2):
        body, pose = (a, pa) if side == 0 else (b, pb)
        if not _flexible(body):
            i = _new(s, side, -1, pose[0], pose[1], 1.0, 0.0, pose)
            _new(s, side, -1, pose[0], pose[1], 0.0, 1.0, pose)
            _new(s, side, -2, pose[0], pose[1], 0.0, 0.0, pose)
            s.local[i + 2, 0] = -1.0 if side == 0 else 1.0
            first = (i, first[1]) if side == 0 else (first[0], i)
    return first


@kernel
def gather(s: Loads, count: int, force: float, stiff: float) -> None:
    """One Gauss point: adds its force, and its stiffness, to the unknowns entered."""
    for p in range(count):
        i, v = s.entry[p], s.share[p]
        s.force[i] += force * v
        for q in range(count):
            s.stiffness[i, s.entry[q]] += stiff * v * s.share[q]


@kernel
def _begin(
    a: Boundary, pa: Array, b: Boundary, pb: Array, r: Any, s: Loads, x0: float, x1: float
) -> tuple[int, int]:
    """Starts a region: the first of the two unknowns of each rigid side, -1 for sides that yield."""
    s.made[1] += 1
    nx, ny = r["nx"], r["ny"]
    first = (-1, -1)
    for side in range(2):
        body, pose = (a, pa) if side == 0 else (b, pb)
        if not _flexible(body):
            i = s.made[0]
            for x in (x0, x1):  # along the axis across the force, from the entry
                _new(s, side, -1, r["enter_x"] - x * ny, r["enter_y"] + x * nx, nx, ny, pose)
            first = (i, first[1]) if side == 0 else (first[0], i)
    return first


@kernel
def room(s: Scratch, n_a: int, n_b: int) -> bool:
    """Whether the loads of one more region, of arcs of so many pieces, find room."""
    return s.load.made[0] + 2 * (n_a + n_b) + 4 <= len(s.load.force)


@kernel
def couple(
    a: Boundary, wa: Work, pa: Array, b: Boundary, wb: Work, pb: Array, r: Any, scratch: Scratch, n_a: int, n_b: int,
    k: float,
) -> None:  # fmt: skip
    """Loads and stiffness of a region under p = k d, its arcs graphs in axes across and along the force."""
    x, y, edge, t, s = scratch.x, scratch.y, scratch.edge, scratch.t, scratch.load
    chord = x[0, n_a]
    nx, ny = r["nx"], r["ny"]
    rigid_a, rigid_b = _begin(a, pa, b, pb, r, s, 0.0, chord)
    i = j = 0
    lo = 0.0
    while i < n_a and j < n_b:
        hi = min(x[0, i + 1], x[1, j + 1])
        if hi > lo:
            inverse_a, inverse_b = 1.0 / (x[0, i + 1] - x[0, i]), 1.0 / (x[1, j + 1] - x[1, j])
            for g in range(2):
                z = lo + TWO[g] * (hi - lo)
                ra, rb = (z - x[0, i]) * inverse_a, (z - x[1, j]) * inverse_b
                d = y[1, j] + rb * (y[1, j + 1] - y[1, j]) - y[0, i] - ra * (y[0, i + 1] - y[0, i])
                ta = t[0, i, 0] + ra * (t[0, i, 1] - t[0, i, 0])
                tb = t[1, j, 0] + rb * (t[1, j, 1] - t[1, j, 0])
                n = _enter(a, wa, pa, s, 0, edge[0, i], ta, 1.0, rigid_a, z / chord, nx, ny, 0)
                n = _enter(b, wb, pb, s, 1, edge[1, j], tb, 1.0, rigid_b, z / chord, nx, ny, n)
                w = 0.5 * (hi - lo)
                gather(s, n, w * k * d, w * k)
            lo = hi
        if x[0, i + 1] <= lo:
            i += 1
        else:
            j += 1


@kernel
def couple_slabs(
    a: Boundary, wa: Work, pa: Array, b: Boundary, wb: Work, pb: Array, r: Any, scratch: Scratch, n_a: int, n_b: int,
    k: float, alpha: float, beta: float, xc: float, q: float,
) -> None:  # fmt: skip
    """``couple`` for any region: pressures (α + β (x − x_c)) d^q, as ``slabs.distribute`` has them.

    The stiffness is that of k d: the resultant's, whatever the exponent.
    """
    x, y, edge, t, s, cut = scratch.x, scratch.y, scratch.edge, scratch.t, scratch.load, scratch.cut
    nx, ny = r["nx"], r["ny"]
    n = cuts(x, n_a, n_b, cut)
    x0, x1 = cut[0], cut[n - 1]
    rigid_a, rigid_b = _begin(a, pa, b, pb, r, s, x0, x1)
    for m in range(n - 1):
        lo, hi = cut[m], cut[m + 1]
        if hi <= lo:
            continue
        d0, d1, _middle, net, right_a, right_b = slab(x, y, t, n_a, n_b, lo, hi)
        if net <= 0:
            continue
        for g in range(3):
            z = lo + GAUSS_X[g] * (hi - lo)
            d = d0 + (d1 - d0) * GAUSS_X[g]
            count = 0
            for side in range(2):
                body, work, pose = (a, wa, pa) if side == 0 else (b, wb, pb)
                ends = rigid_a if side == 0 else rigid_b
                part = 1.0 / (right_a if side == 0 else right_b)
                for i in range(n_a if side == 0 else n_b):
                    u0, u1 = x[side, i], x[side, i + 1]
                    if u0 > lo or u1 < hi or t[side, i, 0] == t[side, i, 1]:
                        continue
                    at = t[side, i, 0] + (t[side, i, 1] - t[side, i, 0]) * (z - u0) / (u1 - u0)
                    along = (z - x0) / (x1 - x0)
                    count = _enter(
                        body, work, pose, s, side, edge[side, i], at, part, ends, along, nx, ny, count
                    )
            w = net * GAUSS_W[g] * (hi - lo)
            gather(s, count, w * (alpha + beta * (z - xc)) * d**q, w * k)


@kernel
def eliminate_loads(bodies: Ints, sy: Any, buf: Any, state: Any, s: Loads) -> float:
    """Takes the loads out of Newton's system: ``buf.tangent`` gets Pᵀ S, ``buf.push`` Pᵀ y₀.

    ``s.side`` holds bodies by now, ``buf.modal_residual`` the modes' residual under the new loads. Returns the sum
    of |y₀|: by how much the loads are off from what belongs to the present frames.
    """
    n, count = s.made[0], len(sy.mass)
    buf.push[:] = 0.0
    if n == 0:
        return 0.0
    for b in range(count):
        buf.touched[b] = 0
    for i in range(n):
        buf.stale[i] = buf.shift[i] = buf.lag[i] = 0.0
        buf.touched[s.side[i]] = 1
        for j in range(i + 1):
            buf.compliance[i, j] = buf.compliance[j, i] = 0.0
    columns = 0
    for b in range(count):
        if buf.touched[b] == 0:
            continue
        bd, w = boundary_at(bodies, b), work_at(bodies, b)
        lo, hi = sy.first[b], sy.first[b + 1]
        if _flexible(bd):
            body_compliance(bd, w, s, buf, b, lo, hi, state.q[lo:hi], n)
        held = _flexible(bd) and (sy.pinned[b] == 1 or sy.driven[b] == 1 or sy.damper[b] > 0.0)
        if sy.fixed[b] == 1 and not held:
            continue
        for k in range(6 if held else 3):
            buf.active[columns + k] = 3 * b + k if k < 3 else 3 * count + 3 * b + k - 3
        for i in range(n):
            moves = buf.moves[i, columns : columns + 6]
            moves[:] = 0.0
            if s.side[i] != b:
                continue
            ex, ey = s.world[i, 0], s.world[i, 1]
            moves[0], moves[1] = ex, ey
            moves[2] = (s.at[i, 0] - buf.pose[b, 0]) * ey - (s.at[i, 1] - buf.pose[b, 1]) * ex
            if s.node[i] == -2:
                moves[2] = s.local[i, 0]
            moves[2] += buf.lag[i]
            if held:
                ex, ey = s.local[i, 0], s.local[i, 1]
                hub_moves(
                    bd, w, s.node[i], ex, ey, buf.pose[b], buf.modal[i], buf.modes[0, : hi - lo], moves[3:]
                )
        columns += 6 if held else 3
    # (I + K C̃) y = −K (a + P δ)
    for i in range(n):
        buf.right[0, i] = buf.stale[i] + buf.shift[i]
        for c in range(columns):
            buf.right[c + 1, i] = buf.moves[i, c]
    factor(s.stiffness, buf.compliance, n, buf.system, buf.last)
    yielded(buf.right, n, columns + 1, buf.system, buf.last)
    off = 0.0
    for i in range(n):
        off += abs(buf.right[0, i])
    for c in range(columns):
        to = buf.active[c]
        for i in range(n):
            p = buf.moves[i, c]
            if p == 0.0:
                continue
            buf.push[to] += p * buf.right[0, i]
            for d in range(columns):
                buf.tangent[to, buf.active[d]] -= p * buf.right[d + 1, i]
    buf.counts[2] = columns
    return off


@kernel
def renew_loads(bodies: Ints, sy: Any, buf: Any, s: Loads, scale: float, part: float) -> None:
    """The loads that belong to the solution in ``buf.rhs``: y = y₀ − S δ in ``buf.answer``, and the nodes' loads.

    Of these, ``part``: the rest is what the nodes were given in the iteration before.
    """
    n, columns, count = s.made[0], buf.counts[2], 3 * len(sy.mass)
    for b in range(len(sy.mass)):
        w = work_at(bodies, b)
        clear_nodes(w)
        if part != 1.0:
            for j in range(w.given[-1]):
                node, rest = w.given[j], 1.0 - part
                x, y = w.given_load[j, 0], w.given_load[j, 1]
                add_load(w.node_load, w.node_flag, w.loaded, node, rest * x, rest * y)
    for i in range(n):
        y = buf.right[0, i]
        for c in range(columns):
            to = buf.active[c]
            if to < count:
                y += buf.right[c + 1, i] * buf.rhs[to]
            elif buf.column[to - count] >= 0:
                y += buf.right[c + 1, i] * buf.rhs[buf.column[to - count]] / scale
        buf.answer[i] = y
        if s.node[i] >= 0:
            w = work_at(bodies, s.side[i])
            f = part * (s.force[i] + y)
            add_load(w.node_load, w.node_flag, w.loaded, s.node[i], f * s.local[i, 0], f * s.local[i, 1])
    for b in range(len(sy.mass)):
        w = work_at(bodies, b)
        w.given[-1] = w.loaded[-1]
        for j in range(w.loaded[-1]):
            node = w.loaded[j]
            w.given[j] = node
            w.given_load[j, 0], w.given_load[j, 1] = w.node_load[node, 0], w.node_load[node, 1]
