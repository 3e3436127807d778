"""What loads, and forces on hubs, move one flexible body by: its part of the compliance that `condense` solves with."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidarea.compile.jit import kernel
from rigidarea.flexible.boundary import Boundary, Work, make_ready
from rigidarea.flexible.dense import dot
from rigidarea.flexible.scratch import Loads
from rigidarea.flexible.tension import follow, pull

Array = NDArray[np.float64]


@kernel
def body_compliance(
    b: Boundary, w: Work, s: Loads, buf: Any, body: int, lo: int, hi: int, q: Array, n: int
) -> None:
    """One body's part of C̃ and a: modes, static flexibility, and what the loads of the iteration before moved."""
    m, static, h = b.modes.shape[1], b.flexibility.shape[0] > 0, len(b.modes) - 3
    free, give, residual, swing = (
        buf.modes[0, :m],
        buf.modes[1, :m],
        buf.modal_residual[lo:hi],
        buf.swing[lo:hi],
    )
    for c in range(m):
        free[c], give[c] = w.mobility[c] * residual[c], w.mobility[c] * swing[c]
    for i in range(n):
        if s.side[i] != body:
            continue
        row, ex, ey = 2 * s.node[i], s.local[i, 0], s.local[i, 1]
        along = buf.modal[i, :m]
        old = ex * w.displacement[s.node[i], 0] + ey * w.displacement[s.node[i], 1]
        for c in range(m):
            along[c] = ex * b.modes[row, c] + ey * b.modes[row + 1, c]
        old -= dot(along, q)
        if static:
            for c in range(3):
                old -= w.hub_load[c] * (ex * b.flexibility[row, h + c] + ey * b.flexibility[row + 1, h + c])
        if len(b.swell) > 0:
            old -= w.spin[0] * (ex * b.swell[row] + ey * b.swell[row + 1])
        if w.tight[0]:
            old -= follow(b, w, 1, row, ex, ey)
        buf.stale[i] = -old if static else 0.0
        buf.shift[i], buf.lag[i] = -dot(along, free), -dot(along, give)
    for i in range(n):
        if s.side[i] != body:
            continue
        row, ex, ey = 2 * s.node[i], s.local[i, 0], s.local[i, 1]
        for c in range(m):
            give[c] = buf.modal[i, c] * w.mobility[c]
        if w.tight[0]:
            pull(b, w, row, ex, ey)
        for j in range(i + 1):
            if s.side[j] != body:
                continue
            moved = 0.0
            if static:
                if len(b.ready) > 0:
                    make_ready(b, s.node[i], s.node[j], s.node[j] + 1)
                u, ux, uy = 2 * s.node[j], s.local[j, 0], s.local[j, 1]
                top, low = b.flexibility[row], b.flexibility[row + 1]
                moved = ex * (top[u] * ux + top[u + 1] * uy) + ey * (low[u] * ux + low[u + 1] * uy)
                if w.tight[0]:
                    moved += follow(b, w, 2, u, ux, uy)
                buf.stale[i] += moved * s.force[j]
                if j != i:
                    buf.stale[j] += moved * s.force[i]
            moved += dot(give, buf.modal[j, :m])
            buf.compliance[i, j] = buf.compliance[j, i] = moved


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
