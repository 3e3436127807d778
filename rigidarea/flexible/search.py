"""The search: which leaves of two bodies' trees may touch, and which points have to be placed for them.

Circles do not mind rotation, so the trees are built once, in the body frames. Two leaves whose circles are near are
looked at again as boxes along their chords (separating axes, S. Gottschalk et al., OBBTree, 1996,
doi:10.1145/237170.237244): a leaf of a smooth boundary is far longer than thick.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rigidarea.flexible.boundary import Boundary
from rigidarea.flexible.jit import inner
from rigidarea.flexible.scratch import MANY, Scratch
from rigidarea.kernel.jit import entry as kernel

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@kernel
def search(a: Boundary, pose_a: Array, b: Boundary, pose_b: Array, margin: float, s: Scratch) -> int:
    """Fills ``s.pairs``, the leaves that come within ``margin``, and ``s.near``: their number, or MANY.

    Poses are (x, y, cos θ, sin θ). ``margin`` (length) covers the deformation and, where the list is kept for several
    evaluations, the motion between them.
    """
    if max(len(a.points), len(b.points)) >= s.mark.shape[1]:
        return MANY
    # pose of b in the frame of a
    c = pose_a[2] * pose_b[2] + pose_a[3] * pose_b[3]
    sn = pose_a[2] * pose_b[3] - pose_a[3] * pose_b[2]
    dx, dy = pose_b[0] - pose_a[0], pose_b[1] - pose_a[1]
    tx = pose_a[2] * dx + pose_a[3] * dy
    ty = -pose_a[3] * dx + pose_a[2] * dy
    stack, out = s.stack, s.pairs
    count, top = 0, 1
    stack[0, 0] = stack[0, 1] = 0
    while top > 0:
        top -= 1
        i, j = stack[top, 0], stack[top, 1]
        ex = tx + c * b.centre[j, 0] - sn * b.centre[j, 1] - a.centre[i, 0]
        ey = ty + sn * b.centre[j, 0] + c * b.centre[j, 1] - a.centre[i, 1]
        reach = a.radius[i] + b.radius[j] + margin
        if ex * ex + ey * ey > reach * reach:
            continue
        if a.left[i] < 0 and b.left[j] < 0:
            if _apart(a.box, i, b.box, j, c, sn, tx, ty, margin):
                continue
            if count == len(out):
                return MANY
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
    s.runs[0] = _runs(a, s.pairs, count, 0, s.mark[0], s.near[0])
    s.runs[1] = _runs(b, s.pairs, count, 1, s.mark[1], s.near[1])
    return count


@inner(forceinline=True)
def _apart(
    box_a: Array, i: int, box_b: Array, j: int, c: float, sn: float, tx: float, ty: float, margin: float
) -> bool:
    """Whether one of the four sides' directions separates the leaves' boxes by more than ``margin``."""
    ux, uy = box_a[i, 2], box_a[i, 3]
    vx, vy = c * box_b[j, 2] - sn * box_b[j, 3], sn * box_b[j, 2] + c * box_b[j, 3]
    dx = tx + c * box_b[j, 0] - sn * box_b[j, 1] - box_a[i, 0]
    dy = ty + sn * box_b[j, 0] + c * box_b[j, 1] - box_a[i, 1]
    cosine, sine = abs(ux * vx + uy * vy), abs(ux * vy - uy * vx)
    la, wa, lb, wb = box_a[i, 4], box_a[i, 5], box_b[j, 4], box_b[j, 5]
    return (
        abs(dx * ux + dy * uy) > la + lb * cosine + wb * sine + margin
        or abs(dy * ux - dx * uy) > wa + lb * sine + wb * cosine + margin
        or abs(dx * vx + dy * vy) > lb + la * cosine + wa * sine + margin
        or abs(dy * vx - dx * vy) > wb + la * sine + wa * cosine + margin
    )


@inner
def _runs(b: Boundary, pairs: Ints, n_pairs: int, side: int, mark: Ints, near: Ints) -> int:
    """The points of the candidate leaves and the FE nodes that carry them, as runs of neighbours; their number."""
    following, low, high, share = b.next, b.low, b.high, b.share
    if n_pairs == 0:
        return 0
    mark[-1] += 1
    epoch = mark[-1]
    first, last = len(following), 0
    for k in range(n_pairs):
        leaf = pairs[k, side]
        start, end = b.right[leaf], b.right[leaf] - b.left[leaf]
        if mark[start] != epoch:
            for i in range(start, end):
                mark[i] = epoch
            first, last = min(first, start), max(last, end)
    count = 0
    i = first
    while i < last:
        if mark[i] != epoch:
            i += 1
            continue
        start = i
        while i < last and mark[i] == epoch and following[i] == i + 1:
            i += 1
        end = (
            i + 1
        )  # with the closing point; where the ring closes, i is its last and the closing point its first
        closing = -1
        if i < last and mark[i] == epoch:
            closing = following[i]
            i += 1
        near[count, 0], near[count, 1] = start, end
        near[count, 2], near[count, 3] = low[start], low[end - 1] + 1
        if closing < 0 and share[end - 1] > 0.0:  # the last point rides on an edge to one more node
            if high[end - 1] == near[count, 3]:
                near[count, 3] += 1
            else:  # the ring's first
                count += 1
                near[count, 0] = near[count, 1] = 0
                near[count, 2], near[count, 3] = high[end - 1], high[end - 1] + 1
        count += 1
        if closing >= 0 and mark[closing] != epoch:
            near[count, 0], near[count, 1] = closing, closing + 1
            near[count, 2], near[count, 3] = low[closing], low[closing] + 1
            count += 1
    return count
