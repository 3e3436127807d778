"""What loads, and forces on hubs, move one flexible body by: its part of the compliance that `condense` solves with."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidarea.compile.jit import kernel, vectorized
from rigidarea.flexible.boundary import Boundary, Work, make_ready
from rigidarea.flexible.dense import SUMS, dot
from rigidarea.flexible.scratch import Loads
from rigidarea.flexible.tension import follow, pull

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@kernel
def note_loads(
    b: Boundary, w: Work, s: Loads, buf: Any, body: int, lo: int, hi: int, q: Array, column: int, wide: bool
) -> int:
    """Lists one body's loads in ``buf.own``: how many. Of each, along and, if ``wide``, across it: the modes, what
    they move as their frame turns, and, in ``column`` of ``buf.along`` and ``buf.across``, a of ``condense`` but for
    what the loads of this iteration move.
    """
    m, static, h = b.modes.shape[1], b.flexibility.shape[0] > 0, len(b.modes) - 3
    free, give = buf.modes[0, :m], buf.modes[1, :m]
    residual, swing = buf.modal_residual[lo:hi], buf.swing[lo:hi]
    for c in range(m):
        free[c], give[c] = w.mobility[c] * residual[c], w.mobility[c] * swing[c]
    count = 0
    for i in range(s.made[0]):
        if s.side[i] != body:
            continue
        buf.own[count] = i
        count += 1
        row, ex, ey, u = 2 * s.node[i], s.local[i, 0], s.local[i, 1], w.displacement[s.node[i]]
        for k in range(2 if wide else 1):
            modal, moved = (buf.modal[i, :m], buf.along[i]) if k == 0 else (buf.gauge[i, :m], buf.across[i])
            for c in range(m):
                modal[c] = ex * b.modes[row, c] + ey * b.modes[row + 1, c]
            buf.lag[k, i] = -dot(modal, give)
            moved[column] = -dot(modal, free)
            if static:
                old = ex * u[0] + ey * u[1] - dot(modal, q)
                for c in range(3):
                    old -= w.hub_load[c] * (
                        ex * b.flexibility[row, h + c] + ey * b.flexibility[row + 1, h + c]
                    )
                if len(b.swell) > 0:
                    old -= w.spin[0] * (ex * b.swell[row] + ey * b.swell[row + 1])
                if w.tight[0]:
                    old -= follow(b, w, 1, row, ex, ey)
                moved[column] -= old
            ex, ey = -ey, ex
    return count


@kernel
def _static(b: Boundary, w: Work, s: Loads, buf: Any, count: int) -> None:
    """Static displacements along, then across, the ``count`` loads in ``buf.own``, by unit forces along and across
    them: into ``buf.local``."""
    local, lazy = buf.local, len(b.ready) > 0
    for p in range(count):
        i = buf.own[p]
        row, ex, ey = 2 * s.node[i], s.local[i, 0], s.local[i, 1]
        top, low, out, beside = b.flexibility[row], b.flexibility[row + 1], local[p], local[count + p]
        for o in range(p + 1):
            j = buf.own[o]
            if lazy:
                make_ready(b, s.node[i], s.node[j], s.node[j] + 1)
            u, ux, uy = 2 * s.node[j], s.local[j, 0], s.local[j, 1]
            xx, xy, yx, yy = top[u], top[u + 1], low[u], low[u + 1]
            x, y = ex * xx + ey * yx, ex * xy + ey * yy
            out[o] = local[o, p] = x * ux + y * uy
            out[count + o] = local[count + o, p] = y * ux - x * uy
            x, y = ex * yx - ey * xx, ex * yy - ey * xy
            beside[o] = local[o, count + p] = x * ux + y * uy
            beside[count + o] = local[count + o, count + p] = y * ux - x * uy
    for p in range(count if w.tight[0] else 0):
        i = buf.own[p]
        ex, ey = s.local[i, 0], s.local[i, 1]
        for k in range(2):
            pull(b, w, 2 * s.node[i], ex, ey)
            out = local[p + k * count]
            for o in range(count):
                j = buf.own[o]
                u, ux, uy = 2 * s.node[j], s.local[j, 0], s.local[j, 1]
                out[o] += follow(b, w, 2, u, ux, uy)
                out[count + o] += follow(b, w, 2, u, -uy, ux)
            ex, ey = -ey, ex


@vectorized(
    "void(f8[:, ::1], f8[:, ::1], f8[::1], i8[::1], i8, i8, f8[:, ::1], f8[:, ::1], b1)",
    fastmath=SUMS,
)
def _modal(
    modal: Array,
    gauge: Array,
    mobility: Array,
    own: Ints,
    count: int,
    m: int,
    turned: Array,
    local: Array,
    wide: bool,
) -> None:
    """Adds what the m modes give to ``local``; ``turned`` (m, 2 count) is scratch: them along and across the loads."""
    sides = 2 if wide else 1
    for p in range(count):
        i = own[p]
        for c in range(m):
            turned[c, p] = modal[i, c]
            if wide:
                turned[c, count + p] = gauge[i, c]
    for k in range(sides):
        for p in range(count):
            i, out = own[p], local[p + k * count, : sides * count]
            for c in range(m):
                f, row = (modal[i, c] if k == 0 else gauge[i, c]) * mobility[c], turned[c]
                for o in range(len(out)):
                    out[o] += f * row[o]


@kernel
def body_compliance(b: Boundary, w: Work, s: Loads, buf: Any, count: int, column: int, wide: bool) -> None:
    """One body's part of C̃, by the ``count`` loads in ``buf.own``, of ``turning`` directions too: columns of
    ``buf.along`` and ``buf.across``. What the loads of this iteration move statically goes to a, in ``column``."""
    m, local, sides = b.modes.shape[1], buf.local, 2 if wide else 1
    if b.flexibility.shape[0] > 0:
        _static(b, w, s, buf, count)
        for p in range(count):
            i = buf.own[p]
            for o in range(count):
                f = s.force[buf.own[o]]
                buf.along[i, column] += local[p, o] * f
                buf.across[i, column] += local[count + p, o] * f
    else:
        for p in range(sides * count):
            local[p, : sides * count] = 0.0
    if m > 0:
        _modal(buf.modal, buf.gauge, w.mobility, buf.own, count, m, buf.turned, local, wide)
    for p in range(count):
        i = buf.own[p]
        for k in range(sides):
            moved, row = (buf.along[i] if k == 0 else buf.across[i]), local[p + k * count]
            for o in range(count):
                j = buf.own[o]
                moved[j] = row[o]
                if buf.turning[j] >= 0:
                    moved[buf.turning[j]] += s.force[j] * row[count + o]


@kernel
def hub_moves(
    b: Boundary, w: Work, node: int, ex: float, ey: float, pose: Array, modal: Array, give: Array, out: Array
) -> None:
    """What a force and a moment on the hub (world x, y, moment) move an FE node along (ex, ey), body frame: out (3,).

    By reciprocity also what a force there in that direction moves the hub. modal (m,): of the modes along it; ``give``
    (m,) is scratch.
    """
    h, row = len(b.modes) - 3, 2 * node
    for m in range(len(give)):
        give[m] = modal[m] * w.mobility[m]
    if w.tight[0]:
        pull(b, w, row, ex, ey)
    for k in range(3):
        c = 0.0
        if b.flexibility.shape[0] > 0:
            c = ex * b.flexibility[row, h + k] + ey * b.flexibility[row + 1, h + k]
        if w.tight[0]:
            c += dot(b.soft[h + k], w.drawn[2])
        out[k] = c + dot(give, b.modes[h + k])
    x, y = out[0], out[1]
    out[0], out[1] = pose[2] * x - pose[3] * y, pose[3] * x + pose[2] * y
