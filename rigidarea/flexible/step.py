"""One compiled loop of generalised-alpha steps: the kernels of ``integrate``.

Scheme for index 3: M. Arnold and O. Brüls, Convergence of the generalized-α scheme for constrained mechanical
systems, Multibody System Dynamics 18 (2007), doi:10.1007/s11044-007-9084-0. Dynamic rows are scaled by β h² and the
multipliers by its inverse (C. L. Bottasso et al., 2007), the residual is judged before scaling.

Newton's matrix has the rigid rows, the constraints, and the contact tangent k L (and k L³/12 in rotation); modes are
eliminated first, their block being diagonal. Static flexibility (residual modes, or all of it for a compliant
body) is a compliance of hub and boundary: the hub's enters the matrix, the boundary's is condensed into the
contact forces (``condense``), so that bodies may be softer than their contacts.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rigidarea.flexible import nodal, segment
from rigidarea.flexible.boundary import Boundary, Work
from rigidarea.flexible.condense import by_mode, hub_row
from rigidarea.flexible.frame import inertia_forces
from rigidarea.flexible.place import add_load, clear_loads, to_nodes
from rigidarea.kernel.jit import kernel

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

HALVINGS = 6  # a step is tried at h, h/2, … h/64, then given up
NEWTON_LIMIT = 25
TOLERANCE = 1e-7  # residual force over the largest force of the step
CLOSURE = 1e-10  # constraint violation over the size of the body (angles: radians)
ROUNDING = 1e-14  # a correction this small, over the size of the body, ends the iteration too
SETTLED = 1e-3  # and then the contact forces differ from k A by no more than this part of the largest
REGIONS_KEPT = 4  # contact regions of a pair that a record holds

NO_CONVERGENCE = -10


class System(NamedTuple):
    """A list of bodies as arrays (b bodies, m modes in all); see ``Body``."""

    mass: Array
    inertia: Array
    fixed: Ints
    hub: Array
    pinned: Ints
    anchor: Array
    driven: Ints
    drive: Array
    damper: Array
    torque: Array
    gravity: Array
    first: Ints  # (b + 1,) where each body's modes begin
    square: Array  # (m,) ω²
    viscous: Array  # (m,) 2 ζ ω
    stretch: Array  # (m,)
    size: Array  # (b,) largest radius of each boundary
    amplitude: Array  # (m,) largest displacement of the boundary in each mode


class Settings(NamedTuple):
    """Contact and scheme: k, q (or reach, for STS), sts, spread loads, search margin, and generalised-α constants."""

    k: float
    q: float
    sts: bool
    spread: bool
    margin: float
    rho: float


class State(NamedTuple):
    """x, v, acceleration, auxiliary acceleration (b, 3) and the same of the modes (m,); multipliers (b, 3)."""

    x: Array
    v: Array
    acc: Array
    aux: Array
    q: Array
    dq: Array
    ddq: Array
    auxq: Array
    mu: Array


@kernel
def _prescribed(drive: Array, t: float) -> float:
    """Hub angle at time t: the angular velocity grows linearly over the ramp time, then stays."""
    if t < drive[2]:
        return drive[0] + 0.5 * drive[1] * t * t / drive[2]
    return drive[0] + drive[1] * (t - 0.5 * drive[2])


@kernel
def _solve(a: Array, b: Array, n: int) -> None:
    """Gaussian elimination with partial pivoting, in place: b becomes the solution. n is at most a few dozen."""
    for i in range(n):
        p = i
        for r in range(i + 1, n):
            if abs(a[r, i]) > abs(a[p, i]):
                p = r
        if p != i:
            for c in range(i, n):
                a[i, c], a[p, c] = a[p, c], a[i, c]
            b[i], b[p] = b[p], b[i]
        if a[i, i] == 0.0:
            continue
        for r in range(i + 1, n):
            f = a[r, i] / a[i, i]
            if f != 0.0:
                for c in range(i + 1, n):
                    a[r, c] -= f * a[i, c]
                b[r] -= f * b[i]
    for i in range(n - 1, -1, -1):
        s = b[i]
        for c in range(i + 1, n):
            s -= a[i, c] * b[c]
        b[i] = s / a[i, i] if a[i, i] != 0.0 else 0.0


@kernel
def _hub(b: Boundary, w: Work, modal: Array, row: int) -> float:
    """Hub displacement (row 0, 1: body frame; 2: rotation) by modes and static flexibility."""
    n = b.modes.shape[0] - 3 + row
    u = 0.0
    for k in range(b.modes.shape[1]):
        u += b.modes[n, k] * modal[k]
    if b.flexibility.shape[0] > 0:
        for k in range(w.loaded[-1]):
            j = w.loaded[k]
            u += b.flexibility[n, 2 * j] * w.node_load[j, 0] + b.flexibility[n, 2 * j + 1] * w.node_load[j, 1]
        for k in range(3):
            u += b.flexibility[n, k - 3] * w.hub_load[k]
    return u


@kernel
def _hub_rate(b: Boundary, dq: Array) -> float:
    u = 0.0
    for k in range(b.modes.shape[1]):
        u += b.modes[b.modes.shape[0] - 1, k] * dq[k]
    return u


class Buffers(NamedTuple):
    """Scratch of the stepper."""

    pose: Array  # (b, 4)
    searched: Array  # (b, 4) poses of the last search
    matrix: Array
    rhs: Array
    load: Array  # (b, 3) generalised contact forces
    tangent: Array  # (6 b, 6 b) of the contacts: frames, then hub loads (x, y, moment)
    row: Array  # (6 b,)
    force: Array  # (2,)
    regions: Array  # (REGIONS_KEPT, 5)
    modal_residual: Array
    column: Ints  # (3 b,) unknown of each hub's constraint force or moment, -1 if there is none
    counts: Ints  # [0] candidate pairs, [1] evaluation stamp, [2] regions
    springs: Array  # (REGIONS_KEPT b, 24) of the regions: bodies, middles, direction, stiffness, force, row
    bend: Array  # (2,) largest displacement of the boundaries under a contact, and of any in the last search
    apart: Array  # (1,) largest difference of a region's k A from the force that it hands on (``condense``)


@kernel
def _contact(bodies, works, sy, buf, q, pairs, st, s):  # type: ignore[no-untyped-def]
    """Evaluates all pairs at buf.pose: loads, tangent, records. Returns a count or an error code of ``region``."""
    buf.counts[1] += 1
    buf.load[:] = 0.0
    buf.tangent[:] = 0.0
    buf.force[:] = 0.0
    buf.apart[0] = 0.0
    buf.regions[:] = 0.0
    for b in range(len(bodies)):
        clear_loads(works[b])
    total = 0
    under = 0.0
    for p in range(len(pairs)):
        ia, ib = pairs[p, 0], pairs[p, 1]
        a, b = bodies[ia], bodies[ib]
        pa, pb = buf.pose[ia], buf.pose[ib]
        # the search, of undeformed bodies, holds while no point has moved, relative to the other body, by more than
        # the margin
        bend = buf.bend[0]
        for i in (ia, ib):
            for k in range(sy.first[i], sy.first[i + 1]):
                bend += abs(q[k]) * sy.amplitude[k]
        moved = abs(bend - buf.bend[1])
        for i in (ia, ib):
            d = np.hypot(buf.pose[i, 0] - buf.searched[i, 0], buf.pose[i, 1] - buf.searched[i, 1])
            turn = np.hypot(buf.pose[i, 2] - buf.searched[i, 2], buf.pose[i, 3] - buf.searched[i, 3])
            moved += (
                d
                + turn * bodies[i].radius[0]
                + turn * np.hypot(bodies[i].centre[0, 0], bodies[i].centre[0, 1])
            )
        if buf.counts[0] < 0 or moved > 0.5 * st.margin or len(pairs) > 1:
            reach = st.margin + bend + (st.q if st.sts else 0.0)
            buf.bend[1] = bend
            buf.counts[0] = nodal.search(a, pa, b, pb, reach, s)
            for i in range(4):
                buf.searched[ia, i] = pa[i]
                buf.searched[ib, i] = pb[i]
        n_pairs = buf.counts[0]
        if n_pairs < 0:
            return n_pairs
        if n_pairs == 0:
            continue
        qa, qb = q[sy.first[ia] : sy.first[ia + 1]], q[sy.first[ib] : sy.first[ib + 1]]
        if st.sts:
            n = segment.contact(
                a, works[ia], pa, qa, b, works[ib], pb, qb, n_pairs, buf.counts[1], st.k, st.q, st.spread, s
            )
        else:
            n = nodal.contact(
                a, works[ia], pa, qa, b, works[ib], pb, qb, n_pairs, buf.counts[1], st.k, st.q, st.spread, s
            )
        if n < 0:
            return n
        for i in range(n):
            r = s.regions[i]
            buf.apart[0] = max(buf.apart[0], abs(r["force"] - st.k * r["area"]))
            fx, fy = r["force"] * r["nx"], r["force"] * r["ny"]
            buf.force[0] += fx
            buf.force[1] += fy
            if total < REGIONS_KEPT:
                buf.regions[total, 0] = r["force"]
                buf.regions[total, 1], buf.regions[total, 2] = r["nx"], r["ny"]
                buf.regions[total, 3], buf.regions[total, 4] = r["x"], r["y"]
            stiff = st.k * r["chord"] * r["give"]
            if st.spread and not st.sts:
                u_a, u_b = works[ia].displacement, works[ib].displacement
                i_a, i_b = r["low_a"], r["low_b"]
                under = max(under, np.hypot(u_a[i_a, 0], u_a[i_a, 1]) + np.hypot(u_b[i_b, 0], u_b[i_b, 1]))
            if st.spread and total < len(buf.springs):
                spring = buf.springs[total]
                spring[0], spring[2], spring[4], spring[6] = ia, r["low_a"], r["high_a"], r["share_a"]
                spring[1], spring[3], spring[5], spring[7] = ib, r["low_b"], r["high_b"], r["share_b"]
                spring[8], spring[9], spring[10], spring[11] = r["nx"], r["ny"], stiff, r["force"]
            total += 1
            buf.row[:] = 0.0
            for side in range(2):
                j, sign = (ia, -1.0) if side == 0 else (ib, 1.0)
                ax, ay = r["x"] - buf.pose[j, 0], r["y"] - buf.pose[j, 1]
                buf.load[j, 0] += sign * fx
                buf.load[j, 1] += sign * fy
                buf.load[j, 2] += sign * (ax * fy - ay * fx)
                ax, ay = r["x_chord"] - buf.pose[j, 0], r["y_chord"] - buf.pose[j, 1]
                buf.row[3 * j], buf.row[3 * j + 1] = sign * r["nx"], sign * r["ny"]
                buf.row[3 * j + 2] = sign * (ax * r["ny"] - ay * r["nx"])
                if st.spread and not st.sts and sy.pinned[j] + sy.driven[j] > 0:
                    low, high = (r["low_a"], r["high_a"]) if side == 0 else (r["low_b"], r["high_b"])
                    share = r["share_a"] if side == 0 else r["share_b"]
                    hub = 3 * (len(bodies) + j)
                    hub_row(
                        bodies[j], works[j], buf.pose[j], sign * r["nx"], sign * r["ny"], low, high, share,
                        buf.row[hub : hub + 3],
                    )  # fmt: skip
            for m in range(12):
                row = 3 * ((ia if m % 2 == 0 else ib) + (0 if m < 6 else len(bodies))) + (m // 2) % 3
                if total <= len(buf.springs):
                    buf.springs[total - 1, 12 + m] = buf.row[row]
                if buf.row[row] == 0.0:
                    continue
                for c in range(12):
                    col = 3 * ((ia if c % 2 == 0 else ib) + (0 if c < 6 else len(bodies))) + (c // 2) % 3
                    buf.tangent[row, col] += stiff * buf.row[row] * buf.row[col]
            if not st.sts:
                turn = st.k * r["chord"] ** 3 / 12.0
                buf.tangent[3 * ia + 2, 3 * ia + 2] += turn
                buf.tangent[3 * ib + 2, 3 * ib + 2] += turn
                buf.tangent[3 * ia + 2, 3 * ib + 2] -= turn
                buf.tangent[3 * ib + 2, 3 * ia + 2] -= turn
    buf.bend[0] = under
    if st.spread:
        for b in range(len(bodies)):
            to_nodes(bodies[b], works[b], buf.pose[b])
    buf.counts[2] = total
    return total


@kernel
def _poses(x, buf):  # type: ignore[no-untyped-def]
    for b in range(len(x)):
        buf.pose[b, 0], buf.pose[b, 1] = x[b, 0], x[b, 1]
        buf.pose[b, 2], buf.pose[b, 3] = np.cos(x[b, 2]), np.sin(x[b, 2])


@kernel
def _step(bodies, works, sy, couplings, state, pairs, st, s, buf, t, h):  # type: ignore[no-untyped-def]
    """One generalised-α step of length h from time t, in place. Returns Newton iterations, or an error code."""
    n_b = len(bodies)
    rho = st.rho
    am, af = (2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0)
    gamma = 0.5 + af - am
    beta = 0.25 * (gamma + 0.5) ** 2
    # prediction: the acceleration stays
    for b in range(n_b):
        for i in range(3):
            a_old = state.aux[b, i]
            a_new = (state.acc[b, i] - am * a_old) / (1.0 - am)
            state.x[b, i] += h * state.v[b, i] + h * h * ((0.5 - beta) * a_old + beta * a_new)
            state.v[b, i] += h * ((1.0 - gamma) * a_old + gamma * a_new)
            state.aux[b, i] = a_new
    for i in range(len(state.q)):
        a_old = state.auxq[i]
        a_new = (state.ddq[i] - am * a_old) / (1.0 - am)
        state.q[i] += h * state.dq[i] + h * h * ((0.5 - beta) * a_old + beta * a_new)
        state.dq[i] += h * ((1.0 - gamma) * a_old + gamma * a_new)
        state.auxq[i] = a_new
    b_acc = (1.0 - am) / (h * h * beta * (1.0 - af))
    b_vel = gamma / (h * beta)
    correction = (1.0 - af) / (1.0 - am)
    scale = beta * h * h
    for b in range(n_b):
        for i in range(sy.first[b], sy.first[b + 1]):
            works[b].mobility[i - sy.first[b]] = 1.0 / (b_acc + sy.viscous[i] * b_vel + sy.square[i])
    t_new = t + h
    n3 = n_unknown = 3 * n_b
    for b in range(n_b):
        for kind in range(3):
            if (sy.pinned[b] if kind < 2 else sy.driven[b]) == 1:
                buf.column[3 * b + kind] = n_unknown
                n_unknown += 1
            else:
                buf.column[3 * b + kind] = -1
    change = 1.0
    for iteration in range(1, NEWTON_LIMIT + 1):
        _poses(state.x, buf)
        code = _contact(bodies, works, sy, buf, state.q, pairs, st, s)
        if code < 0:
            return code
        m, rhs = buf.matrix, buf.rhs
        m[:] = 0.0
        rhs[:] = 0.0
        reference = np.hypot(buf.force[0], buf.force[1])
        worst, worst_g = buf.apart[0], 0.0
        row = n3
        for b in range(n_b):
            bd, w = bodies[b], works[b]
            lo, hi = sy.first[b], sy.first[b + 1]
            c, sn = buf.pose[b, 2], buf.pose[b, 3]
            q = state.q[lo:hi]
            # hub: arm in the world, its compliance 3×3 in the world (from modes by elimination, and static)
            ux, uy, ur = _hub(bd, w, q, 0), _hub(bd, w, q, 1), _hub(bd, w, q, 2)
            hx, hy = sy.hub[b, 0] + ux, sy.hub[b, 1] + uy
            arm_x, arm_y = c * hx - sn * hy, sn * hx + c * hy
            mux, muy, mut = state.mu[b, 0], state.mu[b, 1], state.mu[b, 2]
            rate = state.v[b, 2] + _hub_rate(bd, state.dq[lo:hi])
            hub_moment = mut + sy.torque[b] - sy.damper[b] * rate
            local_x, local_y = c * mux + sn * muy, -sn * mux + c * muy
            moment = inertia_forces(
                sy.inertia[b], sy.stretch[lo:hi], couplings[b], q, state.dq[lo:hi], state.ddq[lo:hi],
                state.v[b, 2], state.acc[b, 2], buf.modal_residual[lo:hi],
            )  # fmt: skip
            reference = max(reference, abs(mux), abs(muy), abs(hub_moment) / sy.size[b])
            k = 3 * b
            weight_x, weight_y = sy.mass[b] * sy.gravity[0], sy.mass[b] * sy.gravity[1]
            if sy.fixed[b] == 0:
                rhs[k] = sy.mass[b] * state.acc[b, 0] - weight_x - buf.load[b, 0] - mux
                rhs[k + 1] = sy.mass[b] * state.acc[b, 1] - weight_y - buf.load[b, 1] - muy
                rhs[k + 2] = moment - buf.load[b, 2] - (arm_x * muy - arm_y * mux) - hub_moment
                reference = max(reference, np.hypot(weight_x, weight_y), sy.mass[b] * abs(state.acc[b, 0]),
                                sy.mass[b] * abs(state.acc[b, 1]), abs(moment) / sy.size[b],
                                abs(buf.load[b, 2]) / sy.size[b])  # fmt: skip
                worst = max(worst, abs(rhs[k]), abs(rhs[k + 1]), abs(rhs[k + 2]) / sy.size[b])
            # modes: residual, then eliminated
            for i in range(lo, hi):
                j = i - lo
                f = bd.modes[-3, j] * local_x + bd.modes[-2, j] * local_y + bd.modes[-1, j] * hub_moment
                for n in range(w.loaded[-1]):
                    node = w.loaded[n]
                    f += (
                        bd.modes[2 * node, j] * w.node_load[node, 0]
                        + bd.modes[2 * node + 1, j] * w.node_load[node, 1]
                    )
                r = buf.modal_residual[i] + sy.viscous[i] * state.dq[i] + sy.square[i] * state.q[i] - f
                buf.modal_residual[i] = r
                reference = max(reference, abs(sy.square[i] * state.q[i]) * np.sqrt(sy.mass[b]))
                # a modal force of φ f, made a nodal one by the largest entry a mass-orthonormal mode can have
                worst = max(worst, abs(r) * np.sqrt(sy.mass[b]))
            # matrix: dynamic rows times scale, multipliers over scale
            if sy.fixed[b] == 1:
                for i in range(3):
                    m[k + i, k + i] = 1.0
            else:
                m[k, k] = m[k + 1, k + 1] = sy.mass[b] * b_acc * scale
                m[k + 2, k + 2] = (sy.inertia[b] * b_acc + sy.damper[b] * b_vel) * scale
                for i in range(3):
                    for j in range(n3):
                        m[k + i, j] += buf.tangent[k + i, j] * scale
                    rhs[k + i] *= -scale
            if sy.fixed[b] == 1:
                continue
            # rows of the constraints: which hub component (0, 1 world displacement, 2 rotation)
            for kind in range(3):
                if buf.column[k + kind] < 0:
                    continue
                if kind == 0:
                    g = state.x[b, 0] + arm_x - sy.anchor[b, 0]
                    m[row, k], m[row, k + 2] = 1.0, -arm_y
                elif kind == 1:
                    g = state.x[b, 1] + arm_y - sy.anchor[b, 1]
                    m[row, k + 1], m[row, k + 2] = 1.0, arm_x
                else:
                    g = state.x[b, 2] + ur - _prescribed(sy.drive[b], t_new)
                    m[row, k + 2] = 1.0
                worst_g = max(worst_g, abs(g) / (sy.size[b] if kind < 2 else 1.0))
                for i in range(3):
                    m[k + i, row] = -m[row, k + i]
                rhs[row] = -g
                # world direction of this component in the body frame
                e0 = c if kind == 0 else (sn if kind == 1 else 0.0)
                e1 = -sn if kind == 0 else (c if kind == 1 else 0.0)
                e2 = 1.0 if kind == 2 else 0.0
                for kind2 in range(3):
                    if buf.column[k + kind2] < 0:
                        continue
                    d0 = c if kind2 == 0 else (sn if kind2 == 1 else 0.0)
                    d1 = -sn if kind2 == 0 else (c if kind2 == 1 else 0.0)
                    d2 = 1.0 if kind2 == 2 else 0.0
                    value = 0.0
                    if bd.flexibility.shape[0] > 0:
                        cf = bd.flexibility
                        value += e0 * (cf[-3, -3] * d0 + cf[-3, -2] * d1 + cf[-3, -1] * d2)
                        value += e1 * (cf[-2, -3] * d0 + cf[-2, -2] * d1 + cf[-2, -1] * d2)
                        value += e2 * (cf[-1, -3] * d0 + cf[-1, -2] * d1 + cf[-1, -1] * d2)
                    for i in range(lo, hi):
                        j = i - lo
                        pe = e0 * bd.modes[-3, j] + e1 * bd.modes[-2, j] + e2 * bd.modes[-1, j]
                        pd = d0 * bd.modes[-3, j] + d1 * bd.modes[-2, j] + d2 * bd.modes[-1, j]
                        value += pe * pd / (b_acc + sy.viscous[i] * b_vel + sy.square[i])
                    m[row, buf.column[k + kind2]] += value / scale
                # modes move the hub by their own residual in this iteration
                for i in range(lo, hi):
                    j = i - lo
                    pe = e0 * bd.modes[-3, j] + e1 * bd.modes[-2, j] + e2 * bd.modes[-1, j]
                    rhs[row] += pe * buf.modal_residual[i] / (b_acc + sy.viscous[i] * b_vel + sy.square[i])
                row += 1
        for i in range(n3 if st.spread else 0):  # contacts on bodies that are held by their hubs
            row_i = buf.column[i]
            if row_i < 0:
                continue
            for j in range(n3):
                if sy.fixed[j // 3] == 0:
                    m[j, row_i] += buf.tangent[j, n3 + i]
                m[row_i, j] -= buf.tangent[n3 + i, j]
                if buf.column[j] >= 0:
                    m[row_i, buf.column[j]] -= buf.tangent[n3 + i, n3 + j] / scale
        rounded = change < ROUNDING and buf.apart[0] <= SETTLED * reference
        done = (worst <= TOLERANCE * reference or rounded) and worst_g <= CLOSURE
        # static flexibility answers to the loads of the evaluation before: look twice while there are any
        if done and (iteration > 1 or not st.spread or buf.counts[2] == 0):
            return iteration
        _solve(m, rhs, row)
        row = n3
        change = 0.0
        for b in range(n_b):
            lo, hi = sy.first[b], sy.first[b + 1]
            c, sn = buf.pose[b, 2], buf.pose[b, 3]
            for i in range(0 if sy.fixed[b] == 1 else 3):
                d = rhs[3 * b + i]
                change = max(change, abs(d) / (sy.size[b] if i < 2 else 1.0))
                state.x[b, i] += d
                state.v[b, i] += b_vel * d
                state.acc[b, i] += b_acc * d
                state.aux[b, i] += correction * b_acc * d
            d0 = d1 = d2 = 0.0
            if sy.pinned[b] == 1:
                d0, d1 = rhs[row] / scale, rhs[row + 1] / scale
                row += 2
            if sy.driven[b] == 1:
                d2 = rhs[row] / scale
                row += 1
            state.mu[b, 0] += d0
            state.mu[b, 1] += d1
            state.mu[b, 2] += d2
            l0, l1 = c * d0 + sn * d1, -sn * d0 + c * d1
            bd, w = bodies[b], works[b]
            for i in range(lo, hi):
                j = i - lo
                f = bd.modes[-3, j] * l0 + bd.modes[-2, j] * l1 + bd.modes[-1, j] * d2
                d = (f - buf.modal_residual[i]) / (b_acc + sy.viscous[i] * b_vel + sy.square[i])
                state.q[i] += d
                state.dq[i] += b_vel * d
                state.ddq[i] += b_acc * d
                state.auxq[i] += correction * b_acc * d
            c, sn = np.cos(state.x[b, 2]), np.sin(state.x[b, 2])
            w.hub_load[0] = c * state.mu[b, 0] + sn * state.mu[b, 1]
            w.hub_load[1] = -sn * state.mu[b, 0] + c * state.mu[b, 1]
            rate = state.v[b, 2] + _hub_rate(bd, state.dq[lo:hi])
            w.hub_load[2] = state.mu[b, 2] + sy.torque[b] - sy.damper[b] * rate
        if st.spread and not st.sts:  # what the contact forces change by goes to the middle of each region
            for i in range(min(buf.counts[2], len(buf.springs))):
                spring = buf.springs[i]
                df = 0.0
                for n in range(12):
                    b = int(spring[n % 2])
                    if n < 6:
                        df -= spring[12 + n] * rhs[3 * b + (n // 2) % 3]
                    elif buf.column[3 * b + (n // 2) % 3] >= 0:
                        df -= spring[12 + n] * rhs[buf.column[3 * b + (n // 2) % 3]] / scale
                df = max(spring[10] * df, -spring[11])
                for side in range(2):
                    b, low, high = int(spring[side]), int(spring[2 + side]), int(spring[4 + side])
                    share, push = spring[6 + side], df if side == 1 else -df
                    c, sn = buf.pose[b, 2], buf.pose[b, 3]
                    ex, ey = c * spring[8] + sn * spring[9], -sn * spring[8] + c * spring[9]
                    w = works[b]
                    for end in range(2):
                        f = (1.0 - share if end == 0 else share) * push
                        node = low if end == 0 else high
                        add_load(w.node_load, w.node_flag, w.loaded, node, f * ex, f * ey)
                    for k in range(sy.first[b], sy.first[b + 1]):
                        j = k - sy.first[b]
                        d = w.mobility[j] * by_mode(bodies[b], low, high, share, ex, ey, j) * push
                        state.q[k] += d
                        state.dq[k] += b_vel * d
                        state.ddq[k] += b_acc * d
                        state.auxq[k] += correction * b_acc * d
        buf.rhs[-2], buf.rhs[-1] = worst, reference
    return NO_CONVERGENCE


@kernel
def _copy(source, target):  # type: ignore[no-untyped-def]
    for b in range(len(source.x)):
        for i in range(3):
            target.x[b, i] = source.x[b, i]
            target.v[b, i] = source.v[b, i]
            target.acc[b, i] = source.acc[b, i]
            target.aux[b, i] = source.aux[b, i]
            target.mu[b, i] = source.mu[b, i]
    for i in range(len(source.q)):
        target.q[i] = source.q[i]
        target.dq[i] = source.dq[i]
        target.ddq[i] = source.ddq[i]
        target.auxq[i] = source.auxq[i]


@kernel
def run_steps(bodies, works, sy, couplings, state, saved, pairs, st, s, buf, t0, h, steps, every, out):  # type: ignore[no-untyped-def]
    """``steps`` steps of h; one row of ``out`` every ``every`` steps. Returns (steps done, code)."""
    n_b = len(bodies)
    peak_iterations = halved = 0
    for n in range(steps):
        parts = 1
        while True:
            _copy(state, saved)
            code = 0
            used = 0
            for part in range(parts):
                code = _step(
                    bodies,
                    works,
                    sy,
                    couplings,
                    state,
                    pairs,
                    st,
                    s,
                    buf,
                    t0 + h * (n + part / parts),
                    h / parts,
                )
                if code < 0:
                    break
                used += code
            if code > 0 or code < NO_CONVERGENCE:
                break
            _copy(saved, state)
            parts *= 2
            halved += 1
            if parts > 2**HALVINGS:
                return n, code
        peak_iterations = max(peak_iterations, used)
        if (n + 1) % every == 0:
            r = out[(n + 1) // every - 1]
            r[0] = t0 + h * (n + 1)
            r[1], r[2] = buf.force[0], buf.force[1]
            r[3], r[4] = peak_iterations, halved
            elastic = 0.0
            for i in range(len(state.q)):
                elastic += 0.5 * sy.square[i] * state.q[i] ** 2
            r[5] = elastic
            kinetic = 0.0
            at = 7
            for b in range(n_b):
                lo, hi = sy.first[b], sy.first[b + 1]
                j = sy.inertia[b]
                w = state.v[b, 2]
                for i in range(lo, hi):
                    gq = 0.0
                    for k in range(lo, hi):
                        gq += couplings[b][i - lo, k - lo] * state.q[k]
                    j += 2.0 * sy.stretch[i] * state.q[i] + state.q[i] ** 2
                    kinetic += 0.5 * state.dq[i] ** 2 + w * gq * state.dq[i]
                kinetic += 0.5 * sy.mass[b] * (state.v[b, 0] ** 2 + state.v[b, 1] ** 2) + 0.5 * j * w * w
                for i in range(3):
                    r[at + i] = state.x[b, i]
                    r[at + 3 + i] = state.v[b, i]
                r[at + 6] = state.x[b, 2] + _hub(bodies[b], works[b], state.q[lo:hi], 2)
                r[at + 7] = state.v[b, 2] + _hub_rate(bodies[b], state.dq[lo:hi])
                at += 8
            r[6] = kinetic
            for i in range(REGIONS_KEPT):
                for k in range(5):
                    r[at + 5 * i + k] = buf.regions[i, k]
            peak_iterations = halved = 0
    return steps, 0


@kernel
def replay(bodies, works, sy, q, pairs, st, s, buf, x):  # type: ignore[no-untyped-def]
    """One contact evaluation for each recorded frame position x (n, b, 3)."""
    for n in range(len(x)):
        _poses(x[n], buf)
        _contact(bodies, works, sy, buf, q, pairs, st, s)
