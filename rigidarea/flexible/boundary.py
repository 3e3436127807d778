"""A body's contact boundary as the kernels see it: points, where they move, and a tree of circles over them.

Every boundary point rides on an edge of the finite-element boundary: its displacement is that of the edge's two
nodes, interpolated. With one point a node this is the paper's perimeter; with more, a curved profile (a tooth flank)
stays finer than the mesh that carries it. Kernels number bodies' points ring after ring; edge i runs from point i
to point ``next[i]``, the material on its left.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rigidarea.kernel.jit import kernel

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

LEAF = 4  # edges a leaf: fewer make the tree deeper, more test more edge pairs


class Boundary(NamedTuple):
    """Constant data of one body; lengths in the body frame, origin at the centre of mass.

    points (n, 2); next, previous, ring (n,); low, high (n,) FE boundary nodes of the carrying edge and share (n,) in
    [0, 1), the weight of ``high``; centre (t, 2), radius (t,), left, right (t,) the tree (a leaf has left < 0 and
    holds edges right … right - left - 1); modes (2 f + 3, m): rows 2 i, 2 i + 1 of FE boundary node i, the last
    three rows the hub's (x, y, rotation); flexibility (2 f + 3, 2 f + 3), or (0, 0) if not used.
    """

    points: Array
    next: Ints
    previous: Ints
    ring: Ints
    low: Ints
    high: Ints
    share: Array
    centre: Array
    radius: Array
    left: Ints
    right: Ints
    modes: Array
    flexibility: Array


class Work(NamedTuple):
    """What changes at every evaluation: positions (world), displacements (body frame), loads, and their stamps."""

    position: Array  # (n, 2) world
    position_stamp: Ints  # (n,) evaluation that wrote the position
    displacement: Array  # (f, 2) body frame
    displacement_stamp: Ints  # (f,)
    point_load: Array  # (n, 2) force on a contact point, world
    pressure: Array  # (n,) force a length at a contact point
    point_flag: NDArray[np.bool_]  # (n,) listed in ``touched``
    touched: Ints  # (n + 1,) contact points that carry load; [-1] their number
    node_load: Array  # (f, 2) force on an FE boundary node, body frame
    node_flag: NDArray[np.bool_]  # (f,) listed in ``loaded``
    leaf_stamp: Ints  # (t,)
    hub_load: Array  # (3,) force and moment on the hub, body frame
    loaded: Ints  # (f + 1,) FE nodes that carry load; [-1] their number
    mobility: Array  # (m,) what a force on a mode moves it within the step, 1/(M' + C' + ω²)


def build(
    rings: list[Array],
    carriers: tuple[Ints, Ints, Array] | None = None,
    modes: Array | None = None,
    flexibility: Array | None = None,
) -> Boundary:
    """A boundary from rings of contact points; without ``carriers`` (low, high, share) each point is its own node."""
    points = np.ascontiguousarray(np.vstack(rings), float)
    n = len(points)
    nxt, prv, ring = np.empty(n, np.int64), np.empty(n, np.int64), np.empty(n, np.int64)
    centre: list[Array] = []
    radius: list[float] = []
    left: list[int] = []
    right: list[int] = []

    def circle(first: int, count: int) -> int:
        p = points[np.append(np.arange(first, first + count), nxt[first + count - 1])]
        c = 0.5 * (p.min(0) + p.max(0))
        centre.append(c)
        radius.append(float(np.linalg.norm(p - c, axis=1).max()))
        left.append(0)
        right.append(0)
        return len(centre) - 1

    def grow(first: int, count: int) -> int:
        me = circle(first, count)
        if count <= LEAF:
            left[me], right[me] = -count, first
        else:
            half = -(-count // (2 * LEAF)) * LEAF
            left[me], right[me] = grow(first, half), grow(first + half, count - half)
        return me

    start, roots = 0, []
    for k, r in enumerate(rings):
        i = np.arange(start, start + len(r))
        nxt[i], prv[i], ring[i] = np.roll(i, -1), np.roll(i, 1), k
        start += len(r)
    centre.append(np.zeros(2))  # node 0, the root, is filled in last
    radius.append(np.inf)
    left.append(0)
    right.append(0)
    start = 0
    for r in rings:
        roots.append(grow(start, len(r)))
        start += len(r)
    while len(roots) > 1:  # join the rings' trees under one root
        a, b = roots.pop(), roots.pop()
        c = 0.5 * (centre[a] + centre[b])
        centre.append(c)
        radius.append(
            float(max(np.linalg.norm(centre[a] - c) + radius[a], np.linalg.norm(centre[b] - c) + radius[b]))
        )
        left.append(a)
        right.append(b)
        roots.append(len(centre) - 1)
    top = roots[0]
    centre[0], radius[0], left[0], right[0] = centre[top], radius[top], left[top], right[top]
    identity = (np.arange(n), np.arange(n), np.zeros(n))
    low, high, share = identity if carriers is None else carriers
    f = int(max(low.max(), high.max())) + 1
    return Boundary(
        points, nxt, prv, ring,
        np.asarray(low, np.int64), np.asarray(high, np.int64), np.asarray(share, float),
        np.array(centre), np.array(radius), np.array(left), np.array(right),
        np.zeros((2 * f + 3, 0)) if modes is None else np.ascontiguousarray(modes, float),
        np.zeros((0, 0)) if flexibility is None else np.ascontiguousarray(flexibility, float),
    )  # fmt: skip


def workspace(b: Boundary) -> Work:
    """Scratch arrays for one body."""
    n, f = len(b.points), (len(b.modes) - 3) // 2
    return Work(
        np.zeros((n, 2)), np.full(n, -1), np.zeros((f, 2)), np.full(f, -1), np.zeros((n, 2)), np.zeros(n),
        np.zeros(n, bool), np.zeros(n + 1, np.int64), np.zeros((f, 2)), np.zeros(f, bool), np.full(len(b.left), -1),
        np.zeros(3), np.zeros(f + 1, np.int64), np.zeros(b.modes.shape[1]),
    )  # fmt: skip


@kernel(inline="always")
def place(b: Boundary, w: Work, pose: Array, modal: Array, start: int, count: int, stamp: int) -> None:
    """World positions of ``count`` contact points from ``start`` on along the perimeter, each once an evaluation.

    pose is (x, y, cos θ, sin θ). Displacements are u = Φ q + C f of the carrying edge's two FE nodes; f are the node
    loads of the evaluation before. One call places a run of points: handing over the tuples costs more than a point.
    """
    points, following, low, high, share, modes, flex = (
        b.points,
        b.next,
        b.low,
        b.high,
        b.share,
        b.modes,
        b.flexibility,
    )
    position, position_stamp = w.position, w.position_stamp
    u, u_stamp, load, loaded, hub = w.displacement, w.displacement_stamp, w.node_load, w.loaded, w.hub_load
    n_modes, static = modes.shape[1], flex.shape[0] > 0
    px, py, c, s = pose[0], pose[1], pose[2], pose[3]
    i = start
    for _ in range(count):
        if position_stamp[i] != stamp:
            position_stamp[i] = stamp
            x, y = points[i, 0], points[i, 1]
            if n_modes > 0 or static:
                for end in range(2):
                    weight = share[i] if end == 1 else 1.0 - share[i]
                    if weight == 0.0:
                        continue
                    node = high[i] if end == 1 else low[i]
                    if u_stamp[node] != stamp:
                        u_stamp[node] = stamp
                        ux = uy = 0.0
                        for k in range(n_modes):
                            ux += modes[2 * node, k] * modal[k]
                            uy += modes[2 * node + 1, k] * modal[k]
                        if static:  # C is symmetric: a load's row, for neighbouring nodes next to each other
                            for k in range(loaded[-1]):
                                j = loaded[k]
                                fx, fy = load[j, 0], load[j, 1]
                                ux += flex[2 * j, 2 * node] * fx + flex[2 * j + 1, 2 * node] * fy
                                uy += flex[2 * j, 2 * node + 1] * fx + flex[2 * j + 1, 2 * node + 1] * fy
                            last = flex.shape[0] - 3
                            for k in range(3):
                                ux += flex[last + k, 2 * node] * hub[k]
                                uy += flex[last + k, 2 * node + 1] * hub[k]
                        u[node, 0] = ux
                        u[node, 1] = uy
                    x += weight * u[node, 0]
                    y += weight * u[node, 1]
            position[i, 0] = px + c * x - s * y
            position[i, 1] = py + s * x + c * y
        i = following[i]


@kernel
def place_one(b: Boundary, w: Work, pose: Array, modal: Array, i: int, stamp: int) -> None:
    """``place`` for a single point, as a call: for the rare point that no candidate leaf holds."""
    place(b, w, pose, modal, i, 1, stamp)


@kernel(inline="always")
def place_leaves(
    b: Boundary, w: Work, pose: Array, modal: Array, pairs: Ints, n_pairs: int, side: int, stamp: int
) -> None:
    """Places the points of all candidate leaves of one body (``side`` 0: A, 1: B)."""
    first, size, done = b.right, b.left, w.leaf_stamp
    for k in range(n_pairs):
        leaf = pairs[k, side]
        if done[leaf] != stamp:
            done[leaf] = stamp
            place(b, w, pose, modal, first[leaf], 1 - size[leaf], stamp)


@kernel
def candidates(
    a: Boundary, pose_a: Array, b: Boundary, pose_b: Array, margin: float, stack: Ints, out: Ints
) -> int:
    """Pairs of leaves whose circles come within ``margin``: fills ``out`` (k, 2), returns their number, -1 if full.

    Circles do not mind rotation, so the trees are built once, in the body frames. ``margin`` covers the deformation
    and, where a list is kept for several evaluations, the motion between them.
    """
    # pose of b in the frame of a
    c = pose_a[2] * pose_b[2] + pose_a[3] * pose_b[3]
    s = pose_a[2] * pose_b[3] - pose_a[3] * pose_b[2]
    dx, dy = pose_b[0] - pose_a[0], pose_b[1] - pose_a[1]
    tx = pose_a[2] * dx + pose_a[3] * dy
    ty = -pose_a[3] * dx + pose_a[2] * dy
    count, top = 0, 1
    stack[0, 0] = stack[0, 1] = 0
    while top > 0:
        top -= 1
        i, j = stack[top, 0], stack[top, 1]
        ex = tx + c * b.centre[j, 0] - s * b.centre[j, 1] - a.centre[i, 0]
        ey = ty + s * b.centre[j, 0] + c * b.centre[j, 1] - a.centre[i, 1]
        reach = a.radius[i] + b.radius[j] + margin
        if ex * ex + ey * ey > reach * reach:
            continue
        if a.left[i] < 0 and b.left[j] < 0:
            if count == len(out):
                return -1
            out[count, 0] = i
            out[count, 1] = j
            count += 1
        elif b.left[j] < 0 or (a.left[i] >= 0 and a.radius[i] >= b.radius[j]):
            stack[top, 0], stack[top, 1] = a.left[i], j
            stack[top + 1, 0], stack[top + 1, 1] = a.right[i], j
            top += 2
        else:
            stack[top, 0], stack[top, 1] = i, b.left[j]
            stack[top + 1, 0], stack[top + 1, 1] = i, b.right[j]
            top += 2
    return count


@kernel(inline="always")
def add_load(load: Array, flag: NDArray[np.bool_], touched: Ints, i: int, fx: float, fy: float) -> None:
    """Adds a force to point i and remembers that it is loaded. (Arrays, not their tuple: see ``place``.)"""
    if not flag[i]:
        flag[i] = True
        touched[touched[-1]] = i
        touched[-1] += 1
    load[i, 0] += fx
    load[i, 1] += fy


@kernel(inline="always")
def clear_loads(w: Work) -> None:
    """Forgets the contact points' loads."""
    touched, load, pressure, flag = w.touched, w.point_load, w.pressure, w.point_flag
    for k in range(touched[-1]):
        i = touched[k]
        load[i, 0] = load[i, 1] = pressure[i] = 0.0
        flag[i] = False
    touched[-1] = 0


@kernel(inline="always")
def to_nodes(b: Boundary, w: Work, pose: Array) -> None:
    """Carries the contact points' loads (world) to the FE boundary nodes (body frame)."""
    load, flag, loaded, point_load, touched = w.node_load, w.node_flag, w.loaded, w.point_load, w.touched
    low, high, share = b.low, b.high, b.share
    for k in range(loaded[-1]):
        load[loaded[k], 0] = load[loaded[k], 1] = 0.0
        flag[loaded[k]] = False
    loaded[-1] = 0
    for k in range(touched[-1]):
        i = touched[k]
        fx = pose[2] * point_load[i, 0] + pose[3] * point_load[i, 1]
        fy = -pose[3] * point_load[i, 0] + pose[2] * point_load[i, 1]
        s = share[i]
        add_load(load, flag, loaded, low[i], (1.0 - s) * fx, (1.0 - s) * fy)
        if s > 0.0:
            add_load(load, flag, loaded, high[i], s * fx, s * fy)
