"""Loads at the start of a step: those of the last one would stay where the bodies have left.

Where contacts are far stiffer than bodies, a boundary goes with what touches it, and the predicted motion of frames and
modes changes the load on it by far more than all of it. Newton's method then begins with an overlap that is none of the
contact's: another width, another stiffness. The last tangent of the step before knows better (``condense``): loads that
the motion moves by Δw change by y, (I + K' C') y = −K' Δw, and modes by what y does to them.
"""

from __future__ import annotations

from rigidarea.compile.jit import kernel
from rigidarea.flexible.bodies import work_at
from rigidarea.flexible.boundary_places import add_load
from rigidarea.flexible.dense import dot
from rigidarea.flexible.eliminate_loads import answer_to


@kernel
def note_places(sy, buf, state, s, sign):  # type: ignore[no-untyped-def]
    """Adds ``sign`` times the place of each load along and across its direction to column ``buf.counts[3]`` of
    ``buf.along`` and ``buf.across``: before and after a motion.

    By the gradients of the last evaluation, so that only a difference of two such places means something.
    """
    frames, column = 3 * len(sy.mass), buf.counts[3]
    for i in range(s.made[0]):
        b = s.side[i]
        lo, hi = sy.first[b], sy.first[b + 1]
        for k in range(1 + buf.counts[4]):
            moved, modal = (buf.along[i], buf.modal[i]) if k == 0 else (buf.across[i], buf.gauge[i])
            place = -buf.lag[k, i] * state.x[b, 2]  # it is in ``moved``, and in q as predicted
            if s.node[i] >= 0:
                place += dot(modal[: hi - lo], state.q[lo:hi])
            for c in range(buf.counts[2]):
                if buf.active[c] < frames:
                    place += moved[column + 1 + c] * state.x[buf.active[c] // 3, buf.active[c] % 3]
            moved[column] = sign * place + (moved[column] if sign > 0.0 else 0.0)


@kernel
def foresee(bodies, sy, buf, state, scheme, s, sts):  # type: ignore[no-untyped-def]
    """Loads on nodes, and modes, after the motion noted by ``note_places``. No contact pulls."""
    n = s.made[0]
    answer_to(buf, s, n)
    for i in range(n):
        y, b, t = -buf.single[i], s.side[i], buf.turning[i]
        if s.node[i] < 0:
            continue
        if not sts:
            y = max(y, -s.force[i])
        turned = -s.force[i] * buf.single[t] if t >= 0 else 0.0
        w, ex, ey = work_at(bodies, b), s.local[i, 0], s.local[i, 1]
        add_load(w.node_load, w.node_flag, w.loaded, s.node[i], y * ex - turned * ey, y * ey + turned * ex)
        lo, hi = sy.first[b], sy.first[b + 1]
        for j in range(hi - lo):
            d = y * buf.modal[i, j]
            if t >= 0:
                d += turned * buf.gauge[i, j]
            d *= w.mobility[j]
            state.q[lo + j] += d
            state.dq[lo + j] += scheme.vel * d
            state.ddq[lo + j] += scheme.acc * d
            state.auxq[lo + j] += scheme.correction * scheme.acc * d
