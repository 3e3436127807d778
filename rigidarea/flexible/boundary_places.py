"""Where boundary points are, and loads on their way from points to nodes.

A point's displacement is that of the two FE nodes of its edge, u = Φ q + C f: modes, and static flexibility under
the node loads of the evaluation before. Only points of leaves that are near the other body are placed, each once an
evaluation, which its stamp says.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rigidarea.compile.jit import entry, kernel
from rigidarea.flexible.boundary import Boundary, Work, edges_of, make_ready
from rigidarea.flexible.dense import dot

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@kernel
def displace(b: Boundary, w: Work, modal: Array, first: int, end: int, stamp: int) -> None:
    """Displacements (body frame) of the FE nodes ``first`` … ``end`` - 1; modal (m,) are the coordinates q.

    Nodes that lie together are moved together: a load moves them by one piece of a row of C, which is symmetric.
    """
    w.displacement_stamp[first:end] = stamp
    u, n = w.displacement[first:end], end - first
    for i in range(n):
        u[i, 0] = u[i, 1] = 0.0
        if b.modes.shape[1] > 0:
            u[i, 0] = dot(b.modes[2 * (first + i)], modal)
            u[i, 1] = dot(b.modes[2 * (first + i) + 1], modal)
    if b.flexibility.shape[0] > 0:
        flexibility, load, loaded = b.flexibility, w.node_load, w.loaded
        for k in range(loaded[-1]):
            j = loaded[k]
            if len(b.ready) > 0:
                make_ready(b, j, first, end)
            fx, fy = load[j, 0], load[j, 1]
            row_x = flexibility[2 * j, 2 * first : 2 * end]
            row_y = flexibility[2 * j + 1, 2 * first : 2 * end]
            for i in range(n):
                u[i, 0] += row_x[2 * i] * fx + row_y[2 * i] * fy
                u[i, 1] += row_x[2 * i + 1] * fx + row_y[2 * i + 1] * fy
        for k in range(3):
            f = w.hub_load[k]
            if f != 0.0:
                row = flexibility[len(flexibility) - 3 + k, 2 * first : 2 * end]
                for i in range(n):
                    u[i, 0] += row[2 * i] * f
                    u[i, 1] += row[2 * i + 1] * f
    if len(b.swell) > 0 and w.spin[0] != 0.0:
        row, f = b.swell[2 * first : 2 * end], w.spin[0]
        for i in range(n):
            u[i, 0] += row[2 * i] * f
            u[i, 1] += row[2 * i + 1] * f
    if w.tight[0]:
        for i in range(n):
            u[i, 0] += dot(b.soft[2 * (first + i)], w.drawn[0])
            u[i, 1] += dot(b.soft[2 * (first + i) + 1], w.drawn[0])


@kernel(forceinline=True)
def _put(
    points: Array, low: Ints, high: Ints, share: Array, u: Array, pose: Array, position: Array, yields: bool, i: int
) -> None:  # fmt: skip
    """World position of point i; pose (x, y, cos θ, sin θ), u the displacements of its nodes, if it yields."""
    x, y = points[i, 0], points[i, 1]
    if yields:
        m, n, f = low[i], high[i], share[i]
        x += (1.0 - f) * u[m, 0] + f * u[n, 0]
        y += (1.0 - f) * u[m, 1] + f * u[n, 1]
    position[i, 0] = pose[0] + pose[2] * x - pose[3] * y
    position[i, 1] = pose[1] + pose[3] * x + pose[2] * y


@kernel
def place(b: Boundary, w: Work, pose: Array, modal: Array, i: int, stamp: int) -> None:
    """World position of point i, its nodes displaced; pose (x, y, cos θ, sin θ)."""
    w.position_stamp[i] = stamp
    yields = b.modes.shape[1] > 0 or b.flexibility.shape[0] > 0
    for side in range(2 if yields else 0):
        node = b.low[i] if side == 0 else b.high[i]
        if w.displacement_stamp[node] != stamp:
            displace(b, w, modal, node, node + 1, stamp)
    _put(b.points, b.low, b.high, b.share, w.displacement, pose, w.position, yields, i)


@kernel
def place_leaves(
    b: Boundary, w: Work, pose: Array, modal: Array, pairs: Ints, n_pairs: int, side: int, stamp: int
) -> None:
    """``place`` for the points of the candidate leaves; the nodes of leaves beside each other move together."""
    following, stamps, moved = b.following, w.position_stamp, w.displacement_stamp
    points, low, high, share, u, position = b.points, b.low, b.high, b.share, w.displacement, w.position
    yields = b.modes.shape[1] > 0 or b.flexibility.shape[0] > 0
    start = end = -1  # a run of nodes to be displaced
    for k in range(n_pairs + 1 if yields else 0):
        n0 = n1 = -1
        if k < n_pairs:
            first, last = edges_of(b, pairs[k, side])
            after = following[last - 1]
            n0, n1 = low[first], (high[after] if after > first else low[last - 1]) + 1
            if (n0 >= start and n1 <= end) or (moved[n0] == stamp and moved[n1 - 1] == stamp):
                continue
            if start >= 0 and n0 <= end and n1 >= start:
                start, end = min(start, n0), max(end, n1)
                continue
        if start >= 0:
            displace(b, w, modal, start, end, stamp)
        start, end = n0, n1
    before = -1
    for k in range(n_pairs):
        leaf = pairs[k, side]
        if leaf == before:
            continue
        before = leaf
        first, last = edges_of(b, leaf)
        for n in range(first, last + 1):
            i = n if n < last else following[last - 1]
            if n > first and following[n - 1] != i and stamps[following[n - 1]] != stamp:  # a ring ends
                place(b, w, pose, modal, following[n - 1], stamp)
            if stamps[i] == stamp:
                continue
            if yields and (moved[low[i]] != stamp or moved[high[i]] != stamp):
                place(b, w, pose, modal, i, stamp)
                continue
            stamps[i] = stamp
            _put(points, low, high, share, u, pose, position, yields, i)


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
