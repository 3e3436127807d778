"""Loads at the start of a step: those of the last one would stay where the bodies have left.

Where contacts are far stiffer than bodies, a boundary goes with what touches it, and the predicted motion of frames and
modes changes the load on it by far more than all of it. Newton's method then begins with an overlap that is none of the
contact's: another width, another stiffness. The last tangent of the step before knows better (``condense``): loads that
the motion moves by Δw change by y, (I + K C̃) y = −K Δw, and modes by what y does to them.
"""

from __future__ import annotations

from rigidarea.compile.jit import kernel
from rigidarea.flexible.bodies import work_at
from rigidarea.flexible.boundary_places import add_load
from rigidarea.flexible.dense import dot, yielded


@kernel
def note_places(sy, buf, state, s, sign):  # type: ignore[no-untyped-def]
    """Adds ``sign`` times the place of each load along its direction to ``buf.right[0]``: before and after a motion.

    By the gradients of the last evaluation, so that only a difference of two such places means something.
    """
    frames = 3 * len(sy.mass)
    for i in range(s.made[0]):
        b = s.side[i]
        lo, hi = sy.first[b], sy.first[b + 1]
        place = -buf.lag[i] * state.x[b, 2]  # it is in ``buf.moves``, and in q as predicted
        if s.node[i] >= 0:
            place += dot(buf.modal[i, : hi - lo], state.q[lo:hi])
        for c in range(buf.counts[2]):
            if buf.active[c] < frames:
                place += buf.moves[i, c] * state.x[buf.active[c] // 3, buf.active[c] % 3]
        buf.right[0, i] = sign * place + (buf.right[0, i] if sign > 0.0 else 0.0)


@kernel
def foresee(bodies, sy, buf, state, scheme, s, sts):  # type: ignore[no-untyped-def]
    """Loads on nodes, and modes, after the motion noted in ``buf.right[0]``. No contact pulls."""
    n = s.made[0]
    yielded(buf.right, n, 1, buf.system, buf.last)
    for i in range(n):
        y, b = buf.right[0, i], s.side[i]
        if s.node[i] < 0:
            continue
        if not sts:
            y = max(y, -s.force[i])
        w = work_at(bodies, b)
        add_load(w.node_load, w.node_flag, w.loaded, s.node[i], y * s.local[i, 0], y * s.local[i, 1])
        lo, hi = sy.first[b], sy.first[b + 1]
        for j in range(hi - lo):
            d = w.mobility[j] * buf.modal[i, j] * y
            state.q[lo + j] += d
            state.dq[lo + j] += scheme.vel * d
            state.ddq[lo + j] += scheme.acc * d
            state.auxq[lo + j] += scheme.correction * scheme.acc * d
