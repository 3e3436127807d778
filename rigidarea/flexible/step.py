"""One generalised-alpha step, by Newton's method on frames, modes and constraints.

Scheme for index 3: M. Arnold and O. Brüls, Convergence of the generalized-α scheme for constrained mechanical
systems, Multibody System Dynamics 18 (2007), doi:10.1007/s11044-007-9084-0. Dynamic rows are scaled by β h² and the
multipliers by its inverse (C. L. Bottasso et al., 2007), the residual is judged before scaling.

Newton's matrix has the rigid rows, the constraints, and the contact tangent k L (and k L³/12 in rotation); modes are
eliminated first, their block being diagonal. Static flexibility (residual modes, or all of it for a compliant
body) is a compliance of hub and boundary: the hub's enters the matrix, the boundary's goes with the contact's loads,
which are unknowns eliminated like the modes (``condense``), so that bodies may be softer than their contacts.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rigidarea.compile.jit import kernel
from rigidarea.flexible.bodies import boundary_at, coupling_at, geometric_at, work_at
from rigidarea.flexible.boundary import Boundary, Work
from rigidarea.flexible.boundary_places import clear_loads, clear_nodes
from rigidarea.flexible.contacts import all_apart, correct_forces, evaluate, poses
from rigidarea.flexible.dense import eliminate
from rigidarea.flexible.eliminate_loads import eliminate_loads, renew_loads
from rigidarea.flexible.floating_frame import inertia_forces, momentum_of_modes, turning_rows
from rigidarea.flexible.foresee import foresee, note_places
from rigidarea.flexible.hub import Hub, hub_of, hub_of_mode, keep_turn, second_order, static_displacement
from rigidarea.flexible.mechanism_joints import correct_joints, joint_forces, joint_rows
from rigidarea.flexible.pace import WHOLE, pace, whole_tangent
from rigidarea.flexible.rows import constraint_rows, frame_rows, held_contacts, mode_rows, scheme_of
from rigidarea.flexible.tension import draw, slack, tighten

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

NEWTON_LIMIT = (
    60  # of which all but a few are for contacts far stiffer than the bodies, whose directions turn
)
HELD = (0.9, 0.8, 0.6, 0.3, 0.0)  # parts of the loads before, tried in turn where the contact seems lost
TOLERANCE = 1e-7  # residual force over the largest force of the step
CYCLE = 4  # iterations; then a region that parts and merges again, to and fro, may end them: the directions of its
# loads jump there, and no loads are those of their own displacements
PARTED = 1e-2  # and then all loads together are off by no more than this part of the largest force
FAST = 1e-2  # of a residual, left by a correction: Newton's method is then in its last, fast part
SURE = 10.0  # and the next may still take this much less off
UNSEEN = 3e-6  # of the largest force: what the step before says is less is not looked at again
CLOSURE = 1e-10  # constraint violation over the size of the body (angles: radians)
ROUNDING = 1e-14  # a correction this small, over the size of the body, ends the iteration too
SETTLED = 1e-3  # and then loads and displacements disagree by no more than this part of the largest force

NO_CONVERGENCE = -10


@kernel
def _predict(state, c):  # type: ignore[no-untyped-def]
    """The step with the accelerations kept."""
    h, am, gamma, beta = c.h, c.am, c.gamma, c.beta
    for b in range(len(state.x)):
        for i in range(3):
            a_old = state.aux[b, i]
            a_new = (state.acc[b, i] - am * a_old) / (1.0 - am)
            state.x[b, i] += h * state.v[b, i] + h * h * ((0.5 - beta) * a_old + beta * a_new)
            state.v[b, i] += h * ((1.0 - gamma) * a_old + gamma * a_new)
            state.aux[b, i] = a_new
        turn = state.turn[b]
        a_old = turn[3]
        turn[3] = (turn[2] - am * a_old) / (1.0 - am)
        turn[0] += h * turn[1] + h * h * ((0.5 - beta) * a_old + beta * turn[3])
        turn[1] += h * ((1.0 - gamma) * a_old + gamma * turn[3])
    for i in range(len(state.q)):
        a_old = state.auxq[i]
        a_new = (state.ddq[i] - am * a_old) / (1.0 - am)
        state.q[i] += h * state.dq[i] + h * h * ((0.5 - beta) * a_old + beta * a_new)
        state.dq[i] += h * ((1.0 - gamma) * a_old + gamma * a_new)
        state.auxq[i] = a_new


@kernel
def _number(sy, buf):  # type: ignore[no-untyped-def]
    """Numbers the unknowns of the constraints after those of the frames, into ``buf.column``; returns their end."""
    end = 3 * len(sy.mass)
    for b in range(len(sy.mass)):
        for kind in range(3):
            if sy.pinned[b] == 1 if kind < 2 else sy.driven[b] == 1 or sy.damper[b] > 0.0:
                buf.column[3 * b + kind] = end
                end += 1
            else:
                buf.column[3 * b + kind] = -1
    return end


@kernel
def _move_mode(state, scheme, i, d):  # type: ignore[no-untyped-def]
    state.q[i] += d
    state.dq[i] += scheme.vel * d
    state.ddq[i] += scheme.acc * d
    state.auxq[i] += scheme.correction * scheme.acc * d


@kernel
def _correct(body: Boundary, w: Work, g: Array, sy, buf, s_load, state, scheme, b):  # type: ignore[no-untyped-def]
    """Newton's correction of one body, of the solution in ``buf.rhs``; the largest change over its size."""
    rhs, k, change = buf.rhs, 3 * b, 0.0
    lo, hi = sy.first[b], sy.first[b + 1]
    c, s = buf.pose[b, 2], buf.pose[b, 3]
    for i in range(0 if sy.fixed[b] == 1 else 3):
        d = rhs[k + i]
        change = max(change, abs(d) / (sy.size[b] if i < 2 else 1.0))
        state.x[b, i] += d
        state.v[b, i] += scheme.vel * d
        state.acc[b, i] += scheme.acc * d
        state.aux[b, i] += scheme.correction * scheme.acc * d
    d0 = rhs[buf.column[k]] / scheme.scale if buf.column[k] >= 0 else 0.0
    d1 = rhs[buf.column[k + 1]] / scheme.scale if buf.column[k + 1] >= 0 else 0.0
    d2 = rhs[buf.column[k + 2]] / scheme.scale if buf.column[k + 2] >= 0 else 0.0
    mu = state.mu[b]
    mu[0] += d0
    mu[1] += d1
    mu[2] += d2
    x, y = c * d0 + s * d1, -s * d0 + c * d1
    d, moved = buf.modes[0], buf.modes[1]
    for j in range(hi - lo):
        f = hub_of_mode(body, j, x, y, d2)
        d[j], moved[j] = f - buf.modal_residual[lo + j] - buf.swing[lo + j] * rhs[k + 2], 0.0
    for i in range(s_load.made[0] if hi > lo else 0):
        if s_load.side[i] == b:
            along, more = buf.modal[i], buf.answer[0, i]
            for j in range(hi - lo):
                d[j] += along[j] * more
            if buf.turning[i] >= 0:
                along, more = buf.gauge[i], buf.answer[1, i]
                for j in range(hi - lo):
                    d[j] += along[j] * more
    for j in range(hi - lo):
        d[j] *= w.mobility[j]
    # what these do to each other as the frame turns (G is antisymmetric)
    turning = state.acc[b, 2] + 2.0 * state.v[b, 2] * scheme.vel
    for m in range(hi - lo):
        row, x = g[m], turning * d[m]
        for j in range(hi - lo):
            moved[j] += row[j] * x
    for j in range(hi - lo):
        more = d[j] + moved[j] * w.mobility[j]
        change = max(change, abs(more) * sy.amplitude[lo + j] / sy.size[b])
        _move_mode(state, scheme, lo + j, more)
    c, s = np.cos(state.x[b, 2]), np.sin(state.x[b, 2])
    w.hub_load[0], w.hub_load[1] = c * mu[0] + s * mu[1], -s * mu[0] + c * mu[1]
    w.hub_load[2] = mu[2] + sy.torque[b]
    return change


@kernel
def spin_of_modes(bodies, sy, state, b):  # type: ignore[no-untyped-def]
    """What the modes of body b add to its moment of inertia, and their own moment of momentum, in the present state."""
    lo, hi, stiff = sy.first[b], sy.first[b + 1], geometric_at(bodies, b)
    if not work_at(bodies, b).tight[1]:
        stiff = stiff[:0]
    return momentum_of_modes(
        sy.stretch[lo:hi], coupling_at(bodies, b), stiff, state.q[lo:hi], state.dq[lo:hi]
    )


@kernel
def _turn_hubs(bodies, sy, state, scheme):  # type: ignore[no-untyped-def]
    """Hubs' static rotations under the loads of the last correction."""
    for b in range(len(sy.mass)):
        body, w = boundary_at(bodies, b), work_at(bodies, b)
        if w.tight[0]:
            draw(body, w)
        keep_turn(state, scheme, b, static_displacement(body, w, 2))


@kernel
def _touch_again(bodies, sy, buf, q, pairs, st, s, found):  # type: ignore[no-untyped-def]
    """Where bodies pushed back by the loads before do not touch: the same with less of these loads, none at last.

    A contact far stiffer than the bodies is far thinner than they yield; a predicted position that misses it would let
    all of that yielding go at once, and Newton's method come back from an overlap thousands of times too deep. From a
    little too much overlap it converges.
    """
    code = 0
    part = 1.0
    for wanted in HELD:
        left = False
        for b in range(len(sy.mass)):
            w = work_at(bodies, b)
            for k in range(w.loaded[-1]):
                w.node_load[w.loaded[k], 0] *= wanted / part
                w.node_load[w.loaded[k], 1] *= wanted / part
                left = True
        part = wanted
        if not left:
            return code
        code = evaluate(bodies, sy, buf, q, pairs, st, s, found)
        if code != 0:
            return code
    for b in range(len(sy.mass)):
        clear_nodes(work_at(bodies, b))
    return code


@kernel
def _flies(bodies, sy, state, scheme, pairs, st, s, found, buf):  # type: ignore[no-untyped-def]
    """Whether the predicted state is the step's: nothing is near, and accelerations are those of gravity.

    For systems that nothing but contacts holds (``Settings.loose``). What is decided here Newton's iteration would find
    after its first look, to the bit; what is not, it decides.
    """
    for b in range(len(sy.mass)):
        if work_at(bodies, b).loaded[-1] > 0:
            return False
        if sy.fixed[b] == 1:
            continue
        mass = sy.mass[b]
        ax, ay, alpha = state.acc[b, 0], state.acc[b, 1], state.acc[b, 2]
        limit = TOLERANCE * mass * max(abs(ax), abs(ay))
        off = mass * max(abs(ax - sy.gravity[0]), abs(ay - sy.gravity[1]))
        if max(off, abs(sy.inertia[b] * alpha) / sy.size[b]) > limit:
            return False
    poses(state.x, buf)
    if not all_apart(bodies, sy, buf, pairs, st, s, found):
        return False
    buf.load[:] = 0.0
    buf.force[:] = 0.0
    buf.held[0] = buf.counts[0] = s.load.made[0] = 0
    buf.counts[1] += 1
    for b in range(len(sy.mass)):
        buf.hubs[b, 4] = sy.inertia[b] * state.acc[b, 2]
        w = work_at(bodies, b)
        if w.tight[0]:
            draw(boundary_at(bodies, b), w)
        clear_loads(w)
    _turn_hubs(bodies, sy, state, scheme)
    return True


@kernel
def step(bodies, sy, state, pairs, st, s, found, buf, t, h):  # type: ignore[no-untyped-def]
    """One generalised-α step of length h from time t, in place. Returns Newton iterations, or an error code."""
    scheme = scheme_of(st.rho, h)
    count = len(sy.mass)
    note_places(sy, buf, state, s.load, -1.0)
    _predict(state, scheme)
    for b in range(count):
        w = work_at(bodies, b)
        w.spin[0] = state.v[b, 2] ** 2
        tighten(boundary_at(bodies, b), w, sy.tense[b])
        w.tight[1] = not slack(sy.tense[b], w.spin[0], w.hub_load[0], w.hub_load[1])
        stiff, lo, hi = geometric_at(bodies, b), sy.first[b], sy.first[b + 1]
        second_order(stiff if w.tight[1] else stiff[:0], state.q[lo:hi], buf.hubs[b, 6:])
        for i in range(lo, hi):
            stiffness = scheme.acc + sy.viscous[i] * scheme.vel + sy.square[i]
            w.mobility[i - lo] = 1.0 / stiffness
    if st.loose and _flies(bodies, sy, state, scheme, pairs, st, s, found, buf):
        return 1
    if s.load.made[0] > 0:
        note_places(sy, buf, state, s.load, 1.0)
        foresee(bodies, sy, buf, state, scheme, s.load, st.sts)
    end = _number(sy, buf)
    buf.clock[0], buf.clock[1] = h, scheme.vel
    change, before, regions = 1.0, 0.0, -1
    first = slowest = 0.0
    earlier = np.inf
    rate, whole = 0.0, whole_tangent(buf)
    for iteration in range(1, NEWTON_LIMIT + 1):
        poses(state.x, buf)
        for b in range(count):
            if sy.fixed[b] == 1 and sy.inverse[b, 1] > 0.0 and sy.first[b + 1] > sy.first[b]:
                more, swing = spin_of_modes(bodies, sy, state, b)
                state.v[b, 2] = (buf.momentum[b] - swing) / (1.0 / sy.inverse[b, 1] + more)
            work_at(bodies, b).spin[0] = state.v[b, 2] ** 2
            if sy.fixed[b] == 0:
                for i in range(3):
                    buf.rate[b, i] = state.v[b, i]
        code = evaluate(bodies, sy, buf, state.q, pairs, st, s, found)
        if code == 0 and st.spread:
            code = _touch_again(bodies, sy, buf, state.q, pairs, st, s, found)
        if code < 0:
            return code
        buf.matrix[:] = 0.0
        buf.rhs[:] = 0.0
        worst = open_most = 0.0
        reference = joint_forces(sy, buf, state, scheme.vel)
        for p in range(len(pairs)):
            reference = max(reference, np.hypot(buf.force[p, 0], buf.force[p, 1]))
        # where the dashpot lets go, deformation still answers to the region's force
        for i in range(buf.counts[0]):
            reference = max(reference, buf.regions[i, 1])
        for b in range(count):
            body, w = boundary_at(bodies, b), work_at(bodies, b)
            lo, hi = sy.first[b], sy.first[b + 1]
            stiff = geometric_at(bodies, b)
            if not w.tight[1]:
                stiff = stiff[:0]
            hub = hub_of(body, w, sy, buf, state, scheme, b)
            moment = inertia_forces(
                sy.inertia[b], sy.stretch[lo:hi], coupling_at(bodies, b), stiff, w.hub_load[0],
                w.hub_load[1], state.q[lo:hi], state.dq[lo:hi], state.ddq[lo:hi], state.v[b, 2], state.acc[b, 2],
                buf.modal_residual[lo:hi], buf.modes,
            )  # fmt: skip
            buf.hubs[b, 0], buf.hubs[b, 1], buf.hubs[b, 2], buf.hubs[b, 3] = (
                hub.x,
                hub.y,
                hub.turn,
                hub.moment,
            )
            buf.hubs[b, 4] = moment
            buf.hubs[b, 8] = turning_rows(
                sy.stretch[lo:hi], state.q[lo:hi], state.dq[lo:hi], sy.inertia[b], scheme.acc, scheme.vel, buf.modes,
                buf.swing[lo:hi],
            )  # fmt: skip
            reference = max(reference, abs(state.mu[b, 0]), abs(state.mu[b, 1]), abs(hub.moment) / sy.size[b])
            force, left = mode_rows(body, w, sy, buf, state, b, hub)
            reference, worst = max(reference, force), max(worst, left)
        off = eliminate_loads(bodies, sy, buf, state, s.load, not st.sts and (whole or rate > FAST))
        worst = max(worst, off)
        for b in range(count):
            body, w = boundary_at(bodies, b), work_at(bodies, b)
            hub = Hub(buf.hubs[b, 0], buf.hubs[b, 1], buf.hubs[b, 2], buf.hubs[b, 3])
            if sy.fixed[b] == 1:
                for i in range(3 * b, 3 * b + 3):
                    buf.matrix[i, i] = 1.0
            else:
                force, left = frame_rows(w, sy, buf, state, scheme, b, hub, buf.hubs[b, 4])
                reference, worst = max(reference, force), max(worst, left)
            gap, left = constraint_rows(body, w, sy, buf, state, scheme, b, hub, t + h)
            open_most, worst = max(open_most, gap), max(worst, left)
        total, gap = joint_rows(sy, buf, state, end)
        open_most = max(open_most, gap)
        if st.spread:
            held_contacts(sy, buf, scheme)
        if before > 0.0:
            rate = worst / before
            slowest = max(slowest, rate)
            if rate > FAST:
                buf.pace[4] = WHOLE
            buf.pace[0], buf.pace[1], buf.pace[2], buf.pace[3] = slowest, first, regions, 0.0
        else:
            first = worst
            rate = pace(buf, worst)
        rounded = change < ROUNDING and off <= SETTLED * reference
        if (worst <= TOLERANCE * reference or rounded) and open_most <= CLOSURE:
            return iteration
        parted = iteration > CYCLE and worst > 0.5 * earlier and buf.counts[0] != regions
        if parted and worst <= PARTED * reference and open_most <= CLOSURE:
            return iteration
        # one correction more is enough where the last took so much off that the next leaves less than the tolerance
        left = (
            SURE * rate * worst <= TOLERANCE * reference
            if before > 0.0
            else rate * worst <= UNSEEN * reference
        )
        sure = rate < FAST and left and rate * open_most <= CLOSURE
        sure = sure and buf.counts[0] == (regions if before > 0.0 else buf.pace[2])
        if sure and before == 0.0:
            buf.pace[3] += 1.0
        earlier, before = before, worst
        for i in range(total):
            buf.matrix[i, total] = buf.rhs[i]
        eliminate(buf.matrix, total, 1)
        for i in range(total):
            buf.rhs[i] = buf.matrix[i, total]
        if st.spread:
            renew_loads(bodies, sy, buf, s.load, scheme.scale)
        change = 0.0
        for b in range(count):
            change = max(
                change,
                _correct(
                    boundary_at(bodies, b),
                    work_at(bodies, b),
                    coupling_at(bodies, b),
                    sy,
                    buf,
                    s.load,
                    state,
                    scheme,
                    b,
                ),
            )
        correct_joints(sy, buf, state, end, scheme.scale)
        if sure:
            correct_forces(bodies, sy, buf, st, s, pairs)
            _turn_hubs(bodies, sy, state, scheme)
            return iteration
        buf.rhs[-2], buf.rhs[-1] = worst, reference
        regions = buf.counts[0]
    return NO_CONVERGENCE
