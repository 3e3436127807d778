"""The search: which leaves of two bodies' trees may touch.

Circles do not mind rotation, so the trees are built once, in the body frames. Two branches whose circles are near are
looked at again as boxes along their chords (separating axes, S. Gottschalk et al., OBBTree, 1996,
doi:10.1145/237170.237244): a piece of a smooth boundary is far longer than thick.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rigidarea.flexible.boundary import Boundary
from rigidarea.flexible.scratch import MANY, Scratch
from rigidarea.kernel.jit import entry, kernel

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

TURN = 3.0  # turn between two searches, in margins over the body's size
NEAR = 0.5  # of the search's margin: how much farther than the deformation leaves are looked at, and how far bodies
# move before they are searched anew. The rest is for what deforms them more from one evaluation to the next.


@kernel(forceinline=True)
def relative(pose_a: Array, pose_b: Array) -> tuple[float, float, float, float]:
    """Pose of b in the frame of a: cosine, sine, x, y."""
    c = pose_a[2] * pose_b[2] + pose_a[3] * pose_b[3]
    sn = pose_a[2] * pose_b[3] - pose_a[3] * pose_b[2]
    dx, dy = pose_b[0] - pose_a[0], pose_b[1] - pose_a[1]
    return c, sn, pose_a[2] * dx + pose_a[3] * dy, -pose_a[3] * dx + pose_a[2] * dy


@kernel
def look(
    a: Boundary, pose_a: Array, b: Boundary, pose_b: Array, margin: float, turn: float, at: Array, s: Scratch
) -> int:
    """``search`` within ``margin``, and farther from the point ``at`` (b's frame) by ``turn`` of the distance to it.

    That is how far points come when b moves by ``margin`` there and turns by so many radians, in the frame of a.
    Where gears mesh they roll: there nothing moves, while they turn.
    """
    c, sn, tx, ty = relative(pose_a, pose_b)
    stack, out = s.stack, s.pairs
    count, top = 0, 1
    stack[0, 0] = stack[0, 1] = 0
    while top > 0:
        top -= 1
        i, j = stack[top, 0], stack[top, 1]
        ex = tx + c * b.centre[j, 0] - sn * b.centre[j, 1] - a.centre[i, 0]
        ey = ty + sn * b.centre[j, 0] + c * b.centre[j, 1] - a.centre[i, 1]
        allowed = margin
        if turn > 0.0:
            fx, fy = b.centre[j, 0] - at[0], b.centre[j, 1] - at[1]
            allowed += turn * (np.sqrt(fx * fx + fy * fy) + b.radius[j])
        reach = a.radius[i] + b.radius[j] + allowed
        if ex * ex + ey * ey > reach * reach or _apart(a.box, i, b.box, j, c, sn, tx, ty, allowed):
            continue
        if a.left[i] < 0 and b.left[j] < 0:
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
def search(a: Boundary, pose_a: Array, b: Boundary, pose_b: Array, margin: float, s: Scratch) -> int:
    """Fills ``s.pairs`` and ``s.close``, the leaves that come within ``margin``: their number, or MANY.

    Poses are (x, y, cos θ, sin θ). ``margin`` (length) covers the deformation and, where the list is kept for several
    evaluations, the motion between them.
    """
    return look(a, pose_a, b, pose_b, margin, 0.0, pose_b, s)


@entry
def narrow(
    a: Boundary, pose_a: Array, b: Boundary, pose_b: Array, n_pairs: int, margin: float, s: Scratch
) -> int:
    """Fills ``s.close`` with those of ``s.pairs`` whose boxes are within ``margin`` where the bodies are now."""
    c, sn, tx, ty = relative(pose_a, pose_b)
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


@kernel
def keep(a, pa, b, pb, margin, size, bend, s, found, p):  # type: ignore[no-untyped-def]
    """The leaves of pair p that are near, or may come near soon, in ``s.pairs``: their number, or MANY.

    The search, of undeformed bodies, holds while b has moved little in the frame of a. Where it found nothing it is
    done again with twice the margin, and so on: bodies far apart need not be searched until they have come near each
    other. size: of the smaller body; bend: the largest deformation, or what else brings them together.
    """
    c, sn, x, y = relative(pa, pb)
    at, was = found.held[p], found.posed[p]
    dc, ds = c - was[0], sn - was[1]
    dx, dy = x - was[2] + dc * at[0] - ds * at[1], y - was[3] + ds * at[0] + dc * at[1]
    moved = np.sqrt(dx * dx + dy * dy) + abs(bend - found.bend[p])
    if found.found[p] < 0 or moved > NEAR * found.margin[p] or np.sqrt(dc * dc + ds * ds) > found.turn[p]:
        at[0], at[1] = found.pole[p, 0], found.pole[p, 1]
        was[0], was[1], was[2], was[3] = c, sn, x, y
        found.bend[p] = bend
        found.margin[p], found.turn[p] = margin, TURN * margin / size
        found.found[p] = look(a, pa, b, pb, margin + bend, found.turn[p], at, s)
        while (
            found.found[p] < 0 and found.turn[p] > 1e-3 * TURN * margin / size
        ):  # more than there is room for
            found.turn[p] *= 0.25
            found.found[p] = look(a, pa, b, pb, margin + bend, found.turn[p], at, s)
        while found.found[p] == 0 and 0.0 < found.margin[p] < size:
            if look(a, pa, b, pb, 2.0 * found.margin[p] + bend, 2.0 * found.turn[p], at, s) != 0:
                break
            found.margin[p] *= 2.0
            found.turn[p] *= 2.0
    return found.found[p]
