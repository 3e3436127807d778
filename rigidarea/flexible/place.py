"""Where boundary points are, and loads on their way from points to nodes.

A point's displacement is that of the two FE nodes of its edge, u = Φ q + C f: modes, and static flexibility under
the node loads of the evaluation before. Only points of leaves that are near the other body are placed, each once an
evaluation, which its stamp says.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rigidarea.flexible.boundary import Boundary, Work
from rigidarea.kernel.jit import entry, kernel

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@kernel(forceinline=True)
def displace(b: Boundary, w: Work, modal: Array, node: int, stamp: int) -> None:
    """Displacement (body frame) of an FE node; modal (m,) are the coordinates q."""
    w.displacement_stamp[node] = stamp
    n_modes, static = b.modes.shape[1], b.flexibility.shape[0] > 0
    if n_modes == 0 and not static:
        return
    x = y = 0.0
    row_x, row_y = b.modes[2 * node], b.modes[2 * node + 1]
    for k in range(n_modes):
        x += row_x[k] * modal[k]
        y += row_y[k] * modal[k]
    if static:
        load, loaded = w.node_load, w.loaded
        row_x, row_y = b.flexibility[2 * node], b.flexibility[2 * node + 1]
        for k in range(loaded[-1]):
            j = loaded[k]
            fx, fy = load[j, 0], load[j, 1]
            x += row_x[2 * j] * fx + row_x[2 * j + 1] * fy
            y += row_y[2 * j] * fx + row_y[2 * j + 1] * fy
        hub = len(row_x) - 3
        for k in range(3):
            x += row_x[hub + k] * w.hub_load[k]
            y += row_y[hub + k] * w.hub_load[k]
    if len(b.swell) > 0:
        x += b.swell[2 * node] * w.spin[0]
        y += b.swell[2 * node + 1] * w.spin[0]
    w.displacement[node, 0], w.displacement[node, 1] = x, y


@kernel
def place(b: Boundary, w: Work, pose: Array, modal: Array, i: int, stamp: int) -> None:
    """World position of point i, its nodes displaced; pose (x, y, cos θ, sin θ)."""
    w.position_stamp[i] = stamp
    x, y = b.points[i, 0], b.points[i, 1]
    if b.modes.shape[1] > 0 or b.flexibility.shape[0] > 0:
        m, n, f, u = b.low[i], b.high[i], b.share[i], w.displacement
        if w.displacement_stamp[m] != stamp:
            displace(b, w, modal, m, stamp)
        if w.displacement_stamp[n] != stamp:
            displace(b, w, modal, n, stamp)
        x += (1.0 - f) * u[m, 0] + f * u[n, 0]
        y += (1.0 - f) * u[m, 1] + f * u[n, 1]
    w.position[i, 0] = pose[0] + pose[2] * x - pose[3] * y
    w.position[i, 1] = pose[1] + pose[3] * x + pose[2] * y


@kernel
def place_leaves(
    b: Boundary, w: Work, pose: Array, modal: Array, pairs: Ints, n_pairs: int, side: int, stamp: int
) -> None:
    """``place`` for the points of the candidate leaves."""
    following, stamps = b.next, w.position_stamp
    last = -1
    for k in range(n_pairs):
        leaf = pairs[k, side]
        if leaf == last:
            continue
        last = leaf
        first, end = b.right[leaf], b.right[leaf] - b.left[leaf]
        for i in range(first, end):
            if stamps[i] != stamp:
                place(b, w, pose, modal, i, stamp)
        if stamps[following[end - 1]] != stamp:
            place(b, w, pose, modal, following[end - 1], stamp)


@kernel(forceinline=True)
def add_load(load: Array, flag: NDArray[np.bool_], touched: Ints, i: int, fx: float, fy: float) -> None:
    """Adds a force to point i and remembers that it is loaded."""
    if not flag[i]:
        flag[i] = True
        touched[touched[-1]] = i
        touched[-1] += 1
    load[i, 0] += fx
    load[i, 1] += fy


@entry(forceinline=True)
def clear_loads(w: Work) -> None:
    """Forgets the contact points' loads."""
    touched, load, pressure, flag = w.touched, w.point_load, w.pressure, w.point_flag
    for k in range(touched[-1]):
        i = touched[k]
        load[i, 0] = load[i, 1] = pressure[i] = 0.0
        flag[i] = False
    touched[-1] = 0


@kernel(forceinline=True)
def clear_nodes(w: Work) -> None:
    """Forgets the FE boundary nodes' loads."""
    load, flag, loaded = w.node_load, w.node_flag, w.loaded
    for k in range(loaded[-1]):
        load[loaded[k], 0] = load[loaded[k], 1] = 0.0
        flag[loaded[k]] = False
    loaded[-1] = 0


@kernel(forceinline=True)
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
