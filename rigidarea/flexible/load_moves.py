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
def note_loads(
    b: Boundary, w: Work, s: Loads, buf: Any, body: int, lo: int, hi: int, q: Array, column: int, wide: bool
) -> int:
    """Lists one body's loads in ``buf.own``: how many. Of each, along and, if ``wide``, across it: the modes, what
    they move as their frame turns, and, in ``column`` of ``buf.along`` and ``buf.across``, a of ``condense`` but for what
    the loads of this iteration move.
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
def _static(
    b: Boundary, w: Work, row: int, u: int, ex: float, ey: float, ux: float, uy: float
) -> tuple[float, float]:
    """Static displacement along (ex, ey) at the node of ``row`` by unit forces at that of ``u``: along (ux, uy), and a
    quarter of a turn further. A tight body: after ``pull`` of the former."""
    top, low = b.flexibility[row], b.flexibility[row + 1]
    x, y = ex * top[u] + ey * low[u], ex * top[u + 1] + ey * low[u + 1]
    along, across = x * ux + y * uy, y * ux - x * uy
    if w.tight[0]:
        along += follow(b, w, 2, u, ux, uy)
        across += follow(b, w, 2, u, -uy, ux)
    return along, across


@kernel
def body_compliance(b: Boundary, w: Work, s: Loads, buf: Any, count: int, column: int, wide: bool) -> None:
    """One body's part of C̃, by the ``count`` loads in ``buf.own``, of ``turning`` directions too: columns of
    ``buf.along`` and ``buf.across``. What the loads of this iteration move statically goes to a, in ``column``."""
    m, static = b.modes.shape[1], b.flexibility.shape[0] > 0
    give = buf.modes[1, :m]
    for p in range(count):
        i = buf.own[p]
        row, ex, ey = 2 * s.node[i], s.local[i, 0], s.local[i, 1]
        for k in range(2 if wide else 1):
            moved, modal = (buf.along[i], buf.modal[i]) if k == 0 else (buf.across[i], buf.gauge[i])
            for c in range(m):
                give[c] = modal[c] * w.mobility[c]
            if w.tight[0]:
                pull(b, w, row, ex, ey)
            for o in range(count):
                j = buf.own[o]
                along = turn = 0.0
                if static:
                    if len(b.ready) > 0:
                        make_ready(b, s.node[i], s.node[j], s.node[j] + 1)
                    along, turn = _static(b, w, row, 2 * s.node[j], ex, ey, s.local[j, 0], s.local[j, 1])
                    moved[column] += along * s.force[j]
                if m > 0:
                    along += dot(give, buf.modal[j, :m])
                moved[j] = along
                if buf.turning[j] >= 0:
                    if m > 0:
                        turn += dot(give, buf.gauge[j, :m])
                    moved[buf.turning[j]] += s.force[j] * turn
            ex, ey = -ey, ex


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
