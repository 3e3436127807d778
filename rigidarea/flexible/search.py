"""The search: which leaves of two bodies' trees may touch.

Circles do not mind rotation, so the trees are built once, in the body frames. Two leaves whose circles are near are
looked at again as boxes along their chords (separating axes, S. Gottschalk et al., OBBTree, 1996,
doi:10.1145/237170.237244): a leaf of a smooth boundary is far longer than thick.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rigidarea.flexible.boundary import Boundary
from rigidarea.flexible.scratch import MANY, Scratch
from rigidarea.kernel.jit import entry, kernel

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@kernel(forceinline=True)
def _relative(pose_a: Array, pose_b: Array) -> tuple[float, float, float, float]:
    """Pose of b in the frame of a: cosine, sine, x, y."""
    c = pose_a[2] * pose_b[2] + pose_a[3] * pose_b[3]
    sn = pose_a[2] * pose_b[3] - pose_a[3] * pose_b[2]
    dx, dy = pose_b[0] - pose_a[0], pose_b[1] - pose_a[1]
    return c, sn, pose_a[2] * dx + pose_a[3] * dy, -pose_a[3] * dx + pose_a[2] * dy


@entry
def search(a: Boundary, pose_a: Array, b: Boundary, pose_b: Array, margin: float, s: Scratch) -> int:
    """Fills ``s.pairs`` and ``s.close``, the leaves that come within ``margin``: their number, or MANY.

    Poses are (x, y, cos θ, sin θ). ``margin`` (length) covers the deformation and, where the list is kept for several
    evaluations, the motion between them.
    """
    c, sn, tx, ty = _relative(pose_a, pose_b)
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
    for k in range(count):
        s.close[k, 0], s.close[k, 1] = out[k, 0], out[k, 1]
    return count


@entry
def narrow(
    a: Boundary, pose_a: Array, b: Boundary, pose_b: Array, n_pairs: int, margin: float, s: Scratch
) -> int:
    """Fills ``s.close`` with those of ``s.pairs`` whose boxes are within ``margin`` where the bodies are now."""
    c, sn, tx, ty = _relative(pose_a, pose_b)
    count = 0
    for k in range(n_pairs):
        i, j = s.pairs[k, 0], s.pairs[k, 1]
        if not _apart(a.box, i, b.box, j, c, sn, tx, ty, margin):
            s.close[count, 0], s.close[count, 1] = i, j
            count += 1
    return count


@kernel(forceinline=True)
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
