"""Runs of generalised-alpha steps, in one compiled loop: halving, records."""

from __future__ import annotations

from rigidarea.flexible.hub import hub_displacement, hub_rate
from rigidarea.flexible.step import NO_CONVERGENCE, step
from rigidarea.flexible.system import REGIONS_KEPT
from rigidarea.kernel.jit import kernel

HALVINGS = 6  # a step is tried at h, h/2, … h/64, then given up


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
def _record(elastic, sy, couplings, state, buf, row):  # type: ignore[no-untyped-def]
    """Force, energies, frames, hubs and regions of this instant; see ``integrate.Simulation`` for the columns."""
    row[1], row[2] = buf.force[0], buf.force[1]
    strain = kinetic = 0.0
    for i in range(len(state.q)):
        strain += 0.5 * sy.square[i] * state.q[i] ** 2
    at = 7
    for b in range(len(elastic)):
        lo, hi = sy.first[b], sy.first[b + 1]
        j, w, g = sy.inertia[b], state.v[b, 2], couplings[b]
        for i in range(lo, hi):
            gq = 0.0
            for k in range(lo, hi):
                gq += g[i - lo, k - lo] * state.q[k]
            j += 2.0 * sy.stretch[i] * state.q[i] + state.q[i] ** 2
            kinetic += 0.5 * state.dq[i] ** 2 + w * gq * state.dq[i]
        kinetic += 0.5 * sy.mass[b] * (state.v[b, 0] ** 2 + state.v[b, 1] ** 2) + 0.5 * j * w * w
        for i in range(3):
            row[at + i] = state.x[b, i]
            row[at + 3 + i] = state.v[b, i]
        row[at + 6] = state.x[b, 2] + hub_displacement(elastic[b], state.q[lo:hi], 2)
        row[at + 7] = state.v[b, 2] + hub_rate(elastic[b], state.dq[lo:hi])
        at += 8
    row[5], row[6] = strain, kinetic
    for i in range(REGIONS_KEPT):
        for k in range(5):
            row[at + 5 * i + k] = buf.regions[i, k]


@kernel
def run_steps(  # type: ignore[no-untyped-def]
    bodies, works, elastic, sy, couplings, state, saved, pairs, st, s, buf, t0, h, steps, every, out
):
    """``steps`` steps of h; one row of ``out`` every ``every`` steps. Returns (steps done, code)."""
    peak_iterations = halved = 0
    for n in range(steps):
        parts = 1
        while True:
            _copy(state, saved)
            code = 0
            used = 0
            for part in range(parts):
                at = t0 + h * (n + part / parts)
                code = step(bodies, works, elastic, sy, couplings, state, pairs, st, s, buf, at, h / parts)
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
            row = out[(n + 1) // every - 1]
            row[0], row[3], row[4] = t0 + h * (n + 1), peak_iterations, halved
            _record(elastic, sy, couplings, state, buf, row)
            peak_iterations = halved = 0
    return steps, 0
