"""Where boundary points are, and loads on their way from points to nodes.

A point's displacement is that of the two FE nodes of its edge, u = Φ q + C f: modes, and static flexibility under
the node loads of the evaluation before. Nodes come in runs, so a mode or a load moves a whole run by one row of Φᵀ
or of C (which is symmetric).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rigidarea.flexible.boundary import Boundary, Work
from rigidarea.flexible.jit import inner
from rigidarea.kernel.jit import entry as kernel

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@inner(forceinline=True)
def displace(b: Boundary, w: Work, modal: Array, first: int, end: int, stamp: int) -> None:
    """Displacements (body frame) of the FE nodes ``first`` … ``end`` - 1; modal (m,) are the coordinates q."""
    n_modes, static = b.shapes.shape[0], b.flexibility.shape[0] > 0
    w.displacement_stamp[first:end] = stamp
    if n_modes == 0 and not static:
        return
    u = w.displacement[first:end].reshape(2 * (end - first))
    u[:] = 0.0
    for k in range(n_modes):
        row = b.shapes[k, 2 * first : 2 * end]
        for i in range(len(u)):
            u[i] += row[i] * modal[k]
    if static:
        flexibility, load, loaded = b.flexibility, w.node_load, w.loaded
        for k in range(loaded[-1]):
            j = loaded[k]
            fx, fy = load[j, 0], load[j, 1]
            row_x, row_y = (
                flexibility[2 * j, 2 * first : 2 * end],
                flexibility[2 * j + 1, 2 * first : 2 * end],
            )
            for i in range(len(u)):
                u[i] += row_x[i] * fx + row_y[i] * fy
        for k in range(3):
            f = w.hub_load[k]
            if f != 0.0:
                row = flexibility[len(flexibility) - 3 + k, 2 * first : 2 * end]
                for i in range(len(u)):
                    u[i] += row[i] * f
    if len(b.swell) > 0 and w.spin[0] != 0.0:
        row, f = b.swell[2 * first : 2 * end], w.spin[0]
        for i in range(len(u)):
            u[i] += row[i] * f


@inner(forceinline=True)
def displace_near(b: Boundary, w: Work, modal: Array, near: Ints, runs: int, stamp: int) -> None:
    """``displace`` for the nodes that the search left in ``near``."""
    for k in range(runs):
        displace(b, w, modal, near[k, 2], near[k, 3], stamp)


@inner(forceinline=True)
def place(b: Boundary, w: Work, pose: Array, first: int, end: int, stamp: int) -> None:
    """World positions of the points ``first`` … ``end`` - 1, their nodes displaced; pose (x, y, cos θ, sin θ)."""
    points, low, high, share, position, u = b.points, b.low, b.high, b.share, w.position, w.displacement
    w.position_stamp[first:end] = stamp
    px, py, c, s = pose[0], pose[1], pose[2], pose[3]
    moves = b.shapes.shape[0] > 0 or b.flexibility.shape[0] > 0
    for i in range(first, end):
        x, y = points[i, 0], points[i, 1]
        if moves:
            m, n, f = low[i], high[i], share[i]
            x += (1.0 - f) * u[m, 0] + f * u[n, 0]
            y += (1.0 - f) * u[m, 1] + f * u[n, 1]
        position[i, 0] = px + c * x - s * y
        position[i, 1] = py + s * x + c * y


@inner(forceinline=True)
def place_near(b: Boundary, w: Work, pose: Array, near: Ints, runs: int, stamp: int) -> None:
    """``place`` for the points that the search left in ``near``."""
    for k in range(runs):
        place(b, w, pose, near[k, 0], near[k, 1], stamp)


@inner
def place_one(b: Boundary, w: Work, pose: Array, modal: Array, i: int, stamp: int) -> None:
    """Displaces and places point i: for the rare point of an arc that no candidate leaf holds."""
    for node in (b.low[i], b.high[i]):
        if w.displacement_stamp[node] != stamp:
            displace(b, w, modal, node, node + 1, stamp)
    place(b, w, pose, i, i + 1, stamp)


@inner(forceinline=True)
def add_load(load: Array, flag: NDArray[np.bool_], touched: Ints, i: int, fx: float, fy: float) -> None:
    """Adds a force to point i and remembers that it is loaded."""
    if not flag[i]:
        flag[i] = True
        touched[touched[-1]] = i
        touched[-1] += 1
    load[i, 0] += fx
    load[i, 1] += fy


@kernel(forceinline=True)
def clear_loads(w: Work) -> None:
    """Forgets the contact points' loads."""
    touched, load, pressure, flag = w.touched, w.point_load, w.pressure, w.point_flag
    for k in range(touched[-1]):
        i = touched[k]
        load[i, 0] = load[i, 1] = pressure[i] = 0.0
        flag[i] = False
    touched[-1] = 0


@inner(forceinline=True)
def clear_nodes(w: Work) -> None:
    """Forgets the FE boundary nodes' loads."""
    load, flag, loaded = w.node_load, w.node_flag, w.loaded
    for k in range(loaded[-1]):
        load[loaded[k], 0] = load[loaded[k], 1] = 0.0
        flag[loaded[k]] = False
    loaded[-1] = 0


@inner(forceinline=True)
def to_nodes(b: Boundary, w: Work, pose: Array) -> None:
    """Carries the contact points' loads (world) to the FE boundary nodes (body frame)."""
    load, flag, loaded, point_load, touched = w.node_load, w.node_flag, w.loaded, w.point_load, w.touched
    low, high, share = b.low, b.high, b.share
    clear_nodes(w)
    for k in range(touched[-1]):
        i = touched[k]
        fx = pose[2] * point_load[i, 0] + pose[3] * point_load[i, 1]
        fy = -pose[3] * point_load[i, 0] + pose[2] * point_load[i, 1]
        s = share[i]
        add_load(load, flag, loaded, low[i], (1.0 - s) * fx, (1.0 - s) * fy)
        if s > 0.0:
            add_load(load, flag, loaded, high[i], s * fx, s * fy)
