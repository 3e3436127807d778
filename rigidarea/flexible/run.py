"""Runs of generalised-alpha steps, in one compiled loop: halving, records."""

from __future__ import annotations

import numpy as np

from rigidarea.compile.jit import entry, kernel
from rigidarea.flexible.bodies import boundary_at, work_at
from rigidarea.flexible.boundary import make_ready
from rigidarea.flexible.boundary_places import clear_nodes
from rigidarea.flexible.hub import hub_angle
from rigidarea.flexible.resist import keep_springs
from rigidarea.flexible.scratch import FULL
from rigidarea.flexible.step import spin_of_modes, step
from rigidarea.flexible.tension import between

NOT_FINITE, COARSE = -11, -12
HALVINGS = 6  # a step is tried at h, h/2, … h/64, then given up
IMPACT_HALVINGS = 16  # one in which bodies come together or part, so many times
# Step times the highest angular frequency of a contact that it follows: a blow then comes back about 0.5 % too fast
# (from 1 on energy is multiplied), and the frequency is off by (0.3)²/24 = 0.4 %.
RESOLVED = 0.3
BODY = 8  # columns of a body in a row of the record: frame, its velocity, hub's angle and its rate
HEAD = 7  # columns before the bodies': time, iterations, halvings, strain and kinetic energy, regions, loads


@kernel
def _copy(source, target):  # type: ignore[no-untyped-def]
    for b in range(len(source.x)):
        for i in range(3):
            target.x[b, i] = source.x[b, i]
            target.v[b, i] = source.v[b, i]
            target.acc[b, i] = source.acc[b, i]
            target.aux[b, i] = source.aux[b, i]
        for i in range(4):
            target.turn[b, i] = source.turn[b, i]
    for b in range(len(source.mu)):
        for i in range(3):
            target.mu[b, i] = source.mu[b, i]
    for i in range(len(source.q)):
        target.q[i] = source.q[i]
        target.dq[i] = source.dq[i]
        target.ddq[i] = source.ddq[i]
        target.auxq[i] = source.auxq[i]


@kernel
def _finite(state):  # type: ignore[no-untyped-def]
    total = 0.0
    for b in range(len(state.x)):
        for i in range(3):
            total += abs(state.x[b, i]) + abs(state.v[b, i]) + abs(state.mu[b, i])
    for i in range(len(state.q)):
        total += abs(state.q[i]) + abs(state.dq[i])
    return np.isfinite(total)


@kernel
def _unloaded(bodies, sy, state, buf):  # type: ignore[no-untyped-def]
    """What a step left that was not finite is taken out of the work arrays: no loads, hubs' as in ``state``."""
    for b in range(len(sy.mass)):
        w, mu = work_at(bodies, b), state.mu[b]
        clear_nodes(w)
        c, s = np.cos(state.x[b, 2]), np.sin(state.x[b, 2])
        w.hub_load[0], w.hub_load[1] = c * mu[0] + s * mu[1], -s * mu[0] + c * mu[1]
        w.hub_load[2] = mu[2] + sy.torque[b]
    buf.pace[:] = 0.0


@kernel
def _keep_met(buf, source, target):  # type: ignore[no-untyped-def]
    for p in range(len(buf.force)):
        for k in range(7):
            buf.met[target, p, k] = buf.met[source, p, k]


@kernel
def _closing(v, buf, i, j, met):  # type: ignore[no-untyped-def]
    """How fast two frames of velocities v close or part where ``met`` is."""
    dx = v[i, 0] - v[i, 2] * (met[4] - buf.pose[i, 1]) - v[j, 0] + v[j, 2] * (met[4] - buf.pose[j, 1])
    dy = v[i, 1] + v[i, 2] * (met[3] - buf.pose[i, 0]) - v[j, 1] - v[j, 2] * (met[3] - buf.pose[j, 0])
    return abs(dx * met[1] + dy * met[2])


@kernel
def _too_coarse(sy, state, saved, pairs, st, buf, h):  # type: ignore[no-untyped-def]
    """Whether a pair has come together, or parted, or not yet borne a blow through, in a step h too long to follow it:
    it would gain energy.

    Of the squared phase ω h both estimates must be too large: contact stiffness over effective mass, which knows not
    how bodies yield; and the blow over the momentum, which knows not what touches from the start. A blow lasts for half
    a period; while a pair goes on touching the scheme itself gains nothing (Settings.rho). Notes in ``buf.met`` what
    touches now.
    """
    coarse = False
    for p in range(len(pairs)):
        i, j, met = pairs[p, 0], pairs[p, 1], buf.met[0, p]
        before, force, most = met[0], 0.0, 0.0
        for n in range(buf.counts[0]):
            r = buf.regions[n]
            if r[0] == p:
                force += r[1]
                if r[1] > most:
                    most = r[1]
                    met[1], met[2], met[3], met[4], met[5] = r[2], r[3], r[4], r[5], r[6]
        met[0] = force
        met[6] = met[6] + h if before > 0.0 and force > 0.0 else 0.0
        if before == 0.0 and force == 0.0:
            continue
        mobility = sy.inverse[i, 0] + sy.inverse[j, 0]
        for b in (i, j):
            turn = (met[3] - buf.pose[b, 0]) * met[2] - (met[4] - buf.pose[b, 1]) * met[1]
            mobility += turn * turn * sy.inverse[b, 1]
        speed = max(_closing(saved.v, buf, i, j, met), _closing(state.v, buf, i, j, met))
        square = st.k * met[5] * mobility
        if speed > 0.0:
            square = min(square, max(before, force) * mobility / (speed * h))
        coarse |= met[6] * met[6] * square < np.pi**2 and square * h * h > RESOLVED * RESOLVED
    return coarse


@kernel
def _given(b, w, i):  # type: ignore[no-untyped-def]
    """The i-th static load on a body, hub's first: its row of the interface, and the force."""
    if i < 3:
        return len(b.modes) - 3 + i, w.hub_load[i]
    node = w.loaded[(i - 3) // 2]
    return 2 * node + (i - 3) % 2, w.node_load[node, (i - 3) % 2]


@kernel
def _static_energy(b, w):  # type: ignore[no-untyped-def]
    """½ fᵀ C f of what loads on nodes and hub bend statically."""
    if b.flexibility.shape[0] == 0:
        return 0.0
    energy, count = 0.0, 3 + 2 * w.loaded[-1]
    for i in range(count):
        row, f = _given(b, w, i)
        if f == 0.0:
            continue
        for j in range(i + 1):
            column, g = _given(b, w, j)
            if len(b.ready) > 0 and j >= 3:
                make_ready(b, row // 2, column // 2, column // 2 + 1)
            part = b.flexibility[row, column]
            if w.tight[0]:
                part += between(b, w, row, column)
            energy += (0.5 if i == j else 1.0) * f * part * g
    return energy


@kernel
def _record(bodies, sy, state, buf, row):  # type: ignore[no-untyped-def]
    """Energies, frames, hubs and forces of this instant; columns: HEAD, BODY a body, 2 a pair, 3 a joint, modes, hub
    loads."""
    strain = kinetic = 0.0
    for i in range(len(state.q)):
        strain += 0.5 * sy.square[i] * state.q[i] ** 2
    count = len(sy.mass)
    at = HEAD
    for b in range(count):
        lo, hi = sy.first[b], sy.first[b + 1]
        v, (more, swing) = state.v[b, 2], spin_of_modes(bodies, sy, state, b)
        for i in range(lo, hi):
            kinetic += 0.5 * state.dq[i] ** 2
        kinetic += 0.5 * sy.mass[b] * (state.v[b, 0] ** 2 + state.v[b, 1] ** 2)
        kinetic += v * swing + 0.5 * (sy.inertia[b] + more) * v * v
        for i in range(3):
            row[at + i] = state.x[b, i]
            row[at + 3 + i] = state.v[b, i]
        body = boundary_at(bodies, b)
        row[at + 6], row[at + 7] = hub_angle(body, sy, state, b)
        strain += _static_energy(body, work_at(bodies, b))
        at += BODY
    row[3], row[4] = strain, kinetic
    for p in range(len(buf.force)):
        row[at], row[at + 1] = buf.force[p, 0], buf.force[p, 1]
        at += 2
    for n in range(len(buf.joint)):
        for i in range(3):
            row[at + i] = buf.joint[n, i]
        at += 3
    if len(row) > at:  # shapes are kept
        for i in range(len(state.q)):
            row[at + i] = state.q[i]
        at += len(state.q)
        for b in range(count):
            for k in range(3):
                row[at + 3 * b + k] = work_at(bodies, b).hub_load[k]


@entry
def run_steps(  # type: ignore[no-untyped-def]
    bodies, sy, state, saved, pairs, st, s, found, buf, t0, h, first, last, every, out, regions, loads, filled
):
    """Steps number ``first`` … ``last`` - 1 of length h from t0; a row of ``out`` each time ``every`` are complete.

    Contact regions and, where ``loads`` has rows, loaded FE nodes (body, node, force) are appended to ``regions`` and
    ``loads``; filled (5,): rows so far of ``out``, ``regions`` and ``loads``, then iterations and halvings since the
    last row. Returns (the step to go on with, code): before ``last``, without error, where room for a row's regions or
    loads may be wanting.
    """
    keep = len(loads) > 0
    nodes = 0
    for b in range(len(sy.mass)):
        nodes += len(work_at(bodies, b).node_load)
    for n in range(first, last):
        if filled[1] + len(buf.regions) > len(regions) or (keep and filled[2] + nodes > len(loads)):
            return n, 0
        parts, most = 1, HALVINGS
        while True:
            _copy(state, saved)
            keep_springs(buf, 1, 2)
            _keep_met(buf, 0, 1)
            code = 0
            used = 0
            for part in range(parts):
                at = t0 + h * (n + part / parts)
                code = step(bodies, sy, state, pairs, st, s, found, buf, at, h / parts)
                if code > 0 and not _finite(state):
                    code = NOT_FINITE
                if code > 0 and _too_coarse(sy, state, saved, pairs, st, buf, h / parts):
                    code = COARSE
                if code < 0:
                    break
                keep_springs(buf, 0, 1)
                used += code
            if code > 0:
                break
            _copy(saved, state)
            keep_springs(buf, 2, 1)
            _keep_met(buf, 1, 0)
            s.load.made[0] = 0  # a failed step's tangent foresees nothing
            if code == NOT_FINITE:
                _unloaded(bodies, sy, state, buf)
            if code == FULL:
                return n, code
            parts *= 2
            filled[4] += 1
            if code == COARSE:
                most = IMPACT_HALVINGS
            if parts > 2**most:
                return n, code
        filled[3] = max(filled[3], used)
        if (n + 1) % every > 0:
            continue
        row = out[filled[0]]
        filled[0] += 1
        row[0], row[1], row[2] = t0 + h * (n + 1), filled[3], filled[4]
        filled[3] = filled[4] = 0
        _record(bodies, sy, state, buf, row)
        row[5] = buf.counts[0]
        for i in range(buf.counts[0]):
            for k in range(6):
                regions[filled[1] + i, k] = buf.regions[i, k]
        filled[1] += buf.counts[0]
        if keep:
            start = filled[2]
            for b in range(len(sy.mass)):
                w = work_at(bodies, b)
                for i in range(w.loaded[-1]):
                    one, node = loads[filled[2]], w.loaded[i]
                    one[0], one[1], one[2], one[3] = (
                        b,
                        node,
                        w.node_load[node, 0],
                        w.node_load[node, 1],
                    )
                    filled[2] += 1
            row[6] = filled[2] - start
    return last, 0
