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
in the next evaluation.

Two more things move under soft bodies, and without them an iteration takes off a decimal digit at the most. Boundaries
slope against the force, so displacements v across the loads change them too, by −X v. And each region's direction turns
by φ = G (w, v): a load f e becomes (f + y) e + f φ e⊥. A turn is one more unknown, of a load pattern f e⊥ and with −G
for its row of K, so with K' = (K, X; −G) and C' what unit loads and turns move along and across,

    (I + K' C') z = −K' (a + P δ),      z = (y, φ).

Regions on one flat of a rigid body have one direction, and share their loads. What neither moves nor yields has none.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidarea.compile.jit import kernel
from rigidarea.flexible.boundary import Boundary, Work
from rigidarea.flexible.scratch import Loads, Scratch
from rigidarea.flexible.slabs import GAUSS_W, GAUSS_X, cuts, slab

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

YIELDS, STILL = -1, -2  # sides that have no unknowns of their own: loads on nodes instead; none at all
TWO = (0.5 - 0.5 / 3.0**0.5, 0.5 + 0.5 / 3.0**0.5)  # Gauss: exact for a product of two linear shape functions


@kernel
def _new(s: Loads, side: int, node: int, x: float, y: float, nx: float, ny: float, pose: Array) -> int:
    """One more unknown: a load at (x, y), world, along the force on its side; its number."""
    i = s.made[0]
    s.made[0] += 1
    s.side[i], s.node[i], s.force[i], s.region[i] = side, node, 0.0, s.made[1]
    s.turn[0, i] = s.turn[1, i] = 0.0
    for j in range(s.made[2], i + 1):
        s.across[i, j] = s.across[j, i] = s.stiffness[i, j] = s.stiffness[j, i] = 0.0
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
def flexible(b: Boundary) -> bool:
    """Whether a body yields at all."""
    return b.modes.shape[1] > 0 or b.flexibility.shape[0] > 0


@kernel
def _enter(
    b: Boundary, w: Work, pose: Array, s: Loads, side: int, edge: int, points: int, weight: float, ends: int,
    nx: float, ny: float, rate: float, count: int,
) -> int:  # fmt: skip
    """Appends the two unknowns under a piece of a contact edge to ``s.entry``, with ``weight`` times their shares at
    so many Gauss points; their number so far.

    The places: parameters ``s.place[side]`` of the edge, which grow at ``rate`` towards what is across the loads; of a
    rigid side (``ends`` >= 0, the first of its two) ``s.place[2]``, 0 and 1 at its ends.
    """
    if ends == STILL:
        return count
    if ends >= 0:
        s.entry[count], s.entry[count + 1] = ends, ends + 1
        s.slide[count] = s.slide[count + 1] = 0.0
        for g in range(points):
            s.share[g, count], s.share[g, count + 1] = weight * (1.0 - s.place[2, g]), weight * s.place[2, g]
        return count + 2
    j = b.following[edge]
    low = b.share[edge]
    high = b.share[j] if b.share[j] > 0.0 else 1.0  # within one finite-element edge, or to its end
    other = b.high[j] if b.share[j] > 0.0 else b.low[j]
    s.entry[count] = _at_node(b, w, pose, s, side, b.low[edge], nx, ny)
    s.entry[count + 1] = _at_node(b, w, pose, s, side, other, nx, ny)
    for g in range(points):
        part = low + s.place[side, g] * (high - low)
        s.share[g, count], s.share[g, count + 1] = weight * (1.0 - part), weight * part
    rate *= weight * (high - low)
    s.slide[count], s.slide[count + 1] = -rate, rate
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
    if rigid == STILL:
        return count
    if rigid >= 0:
        for k in range(3):
            s.entry[count + k] = rigid + k
        s.share[0, count], s.share[0, count + 1] = nx, ny
        s.share[0, count + 2] = (x - pose[0]) * ny - (y - pose[1]) * nx
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
        s.share[0, count], s.share[0, count + 1] = v * nx, v * ny
        count += 2
    return count


@kernel
def begin_vectors(
    a: Boundary, wa: Work, pa: Array, b: Boundary, wb: Work, pb: Array, s: Loads
) -> tuple[int, int]:
    """Starts a region of STS: the first of the three unknowns of each rigid side, YIELDS or STILL for others."""
    s.made[1] += 1
    s.made[2] = s.made[0]
    first = (STILL if wa.still[0] else YIELDS, STILL if wb.still[0] else YIELDS)
    for side in range(2):
        body, pose = (a, pa) if side == 0 else (b, pb)
        if not flexible(body) and first[side] != STILL:
            i = _new(s, side, -1, pose[0], pose[1], 1.0, 0.0, pose)
            _new(s, side, -1, pose[0], pose[1], 0.0, 1.0, pose)
            _new(s, side, -2, pose[0], pose[1], 0.0, 0.0, pose)
            s.local[i + 2, 0] = -1.0 if side == 0 else 1.0
            first = (i, first[1]) if side == 0 else (first[0], i)
    return first


@kernel
def gather_vectors(s: Loads, count: int, force: float, stiff: float) -> None:
    """One Gauss point of STS: adds its force, and its stiffness, to the unknowns entered."""
    share = s.share[0]
    for p in range(count):
        i, v = s.entry[p], share[p]
        s.force[i] += force * v
        for q in range(count):
            s.stiffness[i, s.entry[q]] += stiff * v * share[q]


@kernel
def _gather(s: Loads, points: int, of_a: int, count: int, slope_a: float, slope_b: float) -> None:
    """Adds the Gauss points of one piece to the unknowns entered, of which ``of_a`` are on A: forces, and what
    displacements along and across the loads do to them and to the region's direction. ``s.point`` (points, 3): force,
    stiffness, weight in the direction's turn.

    Slopes b', t' of the arcs of A and B over the axis across the force: a boundary's height there grows by the
    displacement along the force less its own slope times that across. With d = t - b the direction leans by
    ∫ d^q (b' + t')/2 dx / ∫ d^q dx. As d is zero at both ends, by parts, it leans more by

        q ∫ d^(q-1) (b' δt - t' δb) dx / ∫ d^q dx,

    and loads on A push along the heights, those on B against them. What moves across under a pressure also has its
    loads shifted.
    """
    for p in range(count):
        i, on_a = s.entry[p], p < of_a
        own, other = (slope_a, slope_b) if on_a else (slope_b, slope_a)
        force = turn = 0.0
        for g in range(points):
            force += s.point[g, 0] * s.share[g, p]
            turn += s.point[g, 2] * s.share[g, p]
        s.force[i] += force
        s.turn[0, i] -= turn * other
        s.turn[1, i] -= turn * other * own
        for q in range(count):
            j, stiff = s.entry[q], 0.0
            for g in range(points):
                stiff += s.point[g, 1] * s.share[g, p] * s.share[g, q]
            s.stiffness[j, i] += stiff
            s.across[j, i] += stiff * own
            if (q < of_a) == on_a:
                s.across[j, i] -= s.slide[q] * force


@kernel
def _begin(
    a: Boundary, wa: Work, pa: Array, b: Boundary, wb: Work, pb: Array, r: Any, s: Loads, x0: float, x1: float,
    flat: int,
) -> tuple[int, int, bool]:  # fmt: skip
    """Starts a region: the first of the two unknowns of each rigid side, YIELDS or STILL for others; whether it shares
    the loads of the region before.

    They do on one ``flat``, the number of a rigid body's edge, or -1: one direction is all theirs.
    """
    if flat >= 0 and flat == s.made[3]:
        return s.made[4], s.made[5], True
    s.made[1] += 1
    s.made[2], s.made[3] = s.made[0], flat
    nx, ny = r["nx"], r["ny"]
    for side in range(2):
        body, pose = (a, pa) if side == 0 else (b, pb)
        s.made[4 + side] = STILL if (wa if side == 0 else wb).still[0] else YIELDS
        if not flexible(body) and s.made[4 + side] != STILL:
            s.made[4 + side] = s.made[0]
            for x in (x0, x1):  # along the axis across the force, from the entry
                _new(s, side, -1, r["enter_x"] - x * ny, r["enter_y"] + x * nx, nx, ny, pose)
    return s.made[4], s.made[5], False


@kernel
def _mean(s: Loads, total: float) -> None:
    """Ends a region with ∫ d^q dx = ``total``."""
    for i in range(s.made[2], s.made[0]):
        for k in range(2):
            s.turn[k, i] = s.turn[k, i] / total if total > 0.0 else 0.0


@kernel
def _ends(r: Any, s: Loads, rigid: int) -> tuple[float, float]:
    """Where the region's entry is, from one end of a rigid side's loads to the other (0 to 1), and 1 over their
    distance; ``rigid``: the first of them."""
    if rigid < 0:
        return 0.0, 0.0
    ux, uy = -r["ny"], r["nx"]
    x, y = s.at[rigid, 0], s.at[rigid, 1]
    inverse = 1.0 / ((s.at[rigid + 1, 0] - x) * ux + (s.at[rigid + 1, 1] - y) * uy)
    return ((r["enter_x"] - x) * ux + (r["enter_y"] - y) * uy) * inverse, inverse


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
    nx, ny = r["nx"], r["ny"]
    level_a, level_b = n_a == 1 and not flexible(a), n_b == 1 and not flexible(b)
    flat = 2 * edge[1, 0] + 1 if level_b else (2 * edge[0, 0] if level_a else -1)
    rigid_a, rigid_b, joins = _begin(a, wa, pa, b, wb, pb, r, s, 0.0, x[0, n_a], flat)
    origin, pace = _ends(r, s, max(rigid_a, rigid_b))
    leans = 0.0 if joins else 1.0  # all regions of a flat turn as the first does
    i = j = 0
    lo = 0.0
    while i < n_a and j < n_b:
        hi = min(x[0, i + 1], x[1, j + 1])
        if hi > lo:
            inverse_a, inverse_b = 1.0 / (x[0, i + 1] - x[0, i]), 1.0 / (x[1, j + 1] - x[1, j])
            # a flat is across the force
            slope_a = 0.0 if level_a else inverse_a * (y[0, i + 1] - y[0, i])
            slope_b = 0.0 if level_b else inverse_b * (y[1, j + 1] - y[1, j])
            rate_a, rate_b = inverse_a * (t[0, i, 1] - t[0, i, 0]), inverse_b * (t[1, j, 1] - t[1, j, 0])
            w = 0.5 * (hi - lo)
            for g in range(2):
                z = lo + TWO[g] * (hi - lo)
                za, zb = z - x[0, i], z - x[1, j]
                d = y[1, j] + zb * inverse_b * (y[1, j + 1] - y[1, j]) - y[0, i]
                d -= za * inverse_a * (y[0, i + 1] - y[0, i])
                s.place[0, g], s.place[1, g] = t[0, i, 0] + za * rate_a, t[1, j, 0] + zb * rate_b
                s.place[2, g] = origin + z * pace
                s.point[g, 0], s.point[g, 1], s.point[g, 2] = w * k * d, w * k, w * leans
            n = _enter(a, wa, pa, s, 0, edge[0, i], 2, 1.0, rigid_a, nx, ny, rate_a, 0)
            m = _enter(b, wb, pb, s, 1, edge[1, j], 2, 1.0, rigid_b, nx, ny, -rate_b, n)
            _gather(s, 2, n, m, slope_a, slope_b)
            lo = hi
        if x[0, i + 1] <= lo:
            i += 1
        else:
            j += 1
    if not joins:
        _mean(s, r["area"])


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
    rigid_a, rigid_b, _joins = _begin(a, wa, pa, b, wb, pb, r, s, x0, x1, -1)
    origin, pace = _ends(r, s, max(rigid_a, rigid_b))
    total = 0.0
    for m in range(n - 1):
        lo, hi = cut[m], cut[m + 1]
        if hi <= lo:
            continue
        d0, d1, middle, net, right_a, right_b = slab(x, y, t, n_a, n_b, lo, hi)
        if net <= 0:
            continue
        half = 0.5 * (d1 - d0) / (hi - lo)
        for g in range(3):
            z, d, w = lo + GAUSS_X[g] * (hi - lo), d0 + (d1 - d0) * GAUSS_X[g], net * GAUSS_W[g] * (hi - lo)
            s.place[2, g] = origin + z * pace
            s.point[g, 0], s.point[g, 1], s.point[g, 2] = w * (alpha + beta * (z - xc)) * d**q, w * k, 0.0
            if d > 0.0:
                total += w * d**q
                s.point[g, 2] = w * q * d ** (q - 1.0)
        count = of_a = 0
        for side in range(2):
            body, work, pose = (a, wa, pa) if side == 0 else (b, wb, pb)
            ends = rigid_a if side == 0 else rigid_b
            part = 1.0 / (right_a if side == 0 else right_b)
            for i in range(n_a if side == 0 else n_b):
                u0, u1 = x[side, i], x[side, i + 1]
                if u0 > lo or u1 < hi or t[side, i, 0] == t[side, i, 1]:
                    continue
                rate = (t[side, i, 1] - t[side, i, 0]) / (u1 - u0)
                for g in range(3):
                    s.place[side, g] = t[side, i, 0] + rate * (lo + GAUSS_X[g] * (hi - lo) - u0)
                rate = rate if side == 0 else -rate
                count = _enter(body, work, pose, s, side, edge[side, i], 3, part, ends, nx, ny, rate, count)
            of_a = count if side == 0 else of_a
        half = 0.5 * (d1 - d0) / (hi - lo)
        _gather(s, 3, of_a, count, middle - half, middle + half)
    _mean(s, total)
