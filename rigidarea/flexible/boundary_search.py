"""The search: which leaves of two bodies' hierarchies may touch, the bodies undeformed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rigidarea.compile.jit import entry, kernel
from rigidarea.flexible.boundary import Boundary, edges_of, strip
from rigidarea.flexible.scratch import MANY, Scratch, Searches
from rigidarea.geometry.crossings import boxes_meet, go_down
from rigidarea.geometry.work import Relative, placed, relative

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

TURN = 1.0  # turn between two searches, in margins over the body's size
NEAR = 0.5  # of the search's margin: how much farther than the deformation leaves are looked at, and how far bodies
# move before they are searched anew. The rest is for what deforms them more from one evaluation to the next.


@kernel(forceinline=True)
def seen(pa: Array, pb: Array) -> Relative:
    """Body b in the frame of a, of their poses (x, y, cos θ, sin θ)."""
    return relative(pa[0], pa[1], pa[2], pa[3], pb[0], pb[1], pb[2], pb[3], 0.0, 0.0, 0.0, 0.0)


@kernel(forceinline=True)
def rounding(pa: Array, pb: Array, size: float) -> float:
    """What places of points in the world may be off (length): eight roundings; size: of both bodies together.

    A leaf that only touches another may cross it to rounding, and of a boundary's crossings none may be missed.
    """
    return 8.0 * 2.0**-52 * (size + abs(pa[0]) + abs(pa[1]) + abs(pb[0]) + abs(pb[1]))


@kernel
def _aside(a: Boundary, i: int, b: Boundary, j: int, rel: Relative) -> float:
    """How far leaf j of b is on one side of the strip that holds leaf i of a; below 0 if it is not.

    A piece of a smooth boundary is far longer than thick, and the sides of its box are along it by chance only.
    """
    low, high = edges_of(a, i)
    ox, oy, ux, uy, above, below = strip(a.points, a.following, low, high)
    lowest, highest = np.inf, -np.inf
    low, high = edges_of(b, j)
    for n in range(2 * (high - low)):
        m = low + n // 2
        x, y = placed(b.points, m if n % 2 == 0 else b.following[m], rel)
        o = ux * (y - oy) - uy * (x - ox)
        lowest, highest = min(lowest, o), max(highest, o)
    length = np.sqrt(ux * ux + uy * uy)
    return max(lowest - above, below - highest) / length if length > 0.0 else 0.0


@kernel
def _look(
    a: Boundary, b: Boundary, rel: Relative, margin: float, turn: float, at: Array, stack: NDArray[np.int32], out: Ints,
    gap: Array, far: Array,
) -> int:  # fmt: skip
    """``search`` within ``margin``, and farther from the point ``at`` (b's frame) by ``turn`` of the distance to it.

    That is how far points come when b moves by ``margin`` there and turns by so many radians, in the frame of a.
    Where gears mesh they roll: there nothing moves, while they turn.
    """
    leaves_a, leaves_b = len(a.boxes) // 2, len(b.boxes) // 2
    stack[0, 0] = stack[0, 1] = 1
    count, depth = 0, 1
    while depth > 0:
        depth -= 1
        i, j = stack[depth, 0], stack[depth, 1]
        x = abs(b.boxes[j, 0] - at[0]) + max(b.boxes[j, 2], 0.0)  # of its farthest corner; an empty box
        y = abs(b.boxes[j, 1] - at[1]) + max(b.boxes[j, 3], 0.0)  # has sides below nothing
        distance = np.sqrt(x * x + y * y)
        allowed = margin + turn * distance
        if not boxes_meet(a.boxes, i, b.boxes, j, rel, allowed):
            continue
        if i < leaves_a or j < leaves_b:
            depth = go_down(a.boxes, i, i, i >= leaves_a, b.boxes, j, j, j >= leaves_b, stack, depth)
            continue
        aside = _aside(a, i - leaves_a, b, j - leaves_b, rel)
        if aside <= allowed:
            if count == len(out):
                return MANY
            out[count, 0], out[count, 1] = i - leaves_a, j - leaves_b
            gap[count], far[count] = aside, distance
            count += 1
    return count


@entry
def search(a: Boundary, pose_a: Array, b: Boundary, pose_b: Array, margin: float, s: Scratch) -> int:
    """Fills ``s.pairs`` and ``s.close``, the leaves that come within ``margin``: their number, or MANY.

    Poses are (x, y, cos θ, sin θ). ``margin`` (length) covers the deformation and, where the list is kept for several
    evaluations, the motion between them.
    """
    size = 0.0
    for k in range(4):
        size += abs(a.boxes[1, k]) + abs(b.boxes[1, k])
    margin += rounding(pose_a, pose_b, size)
    count = _look(a, b, seen(pose_a, pose_b), margin, 0.0, pose_b, s.work.stack, s.pairs, s.gap, s.far)
    for k in range(count):
        s.close[k, 0], s.close[k, 1] = s.pairs[k, 0], s.pairs[k, 1]
    return count


@kernel(forceinline=True)
def _since(rel: Relative, found: Searches, p: int) -> tuple[float, float]:
    """How far b has moved since the last search of pair p, in the frame of a: the point held, and the turn."""
    at, was = found.held[p], found.posed[p]
    dc, ds = rel.c - was[0], rel.s - was[1]
    dx, dy = rel.tx - was[2] + dc * at[0] - ds * at[1], rel.ty - was[3] + ds * at[0] + dc * at[1]
    return np.sqrt(dx * dx + dy * dy), np.sqrt(dc * dc + ds * ds)


@kernel
def narrow(
    boxes_a: Array,
    boxes_b: Array,
    rel: Relative,
    margin: float,
    found: Searches,
    p: int,
    n_pairs: int,
    close: Ints,
) -> int:
    """Fills ``close`` with those of pair p's first ``n_pairs`` pairs of leaves that may be within ``margin``.

    What was farther apart when they were searched than b has moved since is not looked at: of a pin in its journal all
    leaves are near each other.
    """
    pairs, gap, far = found.pairs[p], found.gap[p], found.far[p]
    moved, turned = _since(rel, found, p)
    leaves_a, leaves_b = len(boxes_a) // 2, len(boxes_b) // 2
    count = 0
    for k in range(n_pairs):
        if gap[k] > margin + moved + turned * far[k]:
            continue
        i, j = pairs[k, 0], pairs[k, 1]
        if boxes_meet(boxes_a, leaves_a + i, boxes_b, leaves_b + j, rel, margin):
            close[count, 0], close[count, 1] = i, j
            count += 1
    return count


@kernel(forceinline=True)
def holds(rel: Relative, bend: float, found: Searches, p: int) -> bool:
    """Whether the last search of pair p still does: b has moved little since, in the frame of a.

    bend: the largest deformation, or what else brings them together.
    """
    moved, turned = _since(rel, found, p)
    moved += abs(bend - found.bend[p])
    return not (found.found[p] < 0 or moved > NEAR * found.margin[p] or turned > found.turn[p])


@kernel(forceinline=False)  # else numba hands on what ``_near`` says of itself
def renew(
    a: Boundary, b: Boundary, rel: Relative, margin: float, size: float, bend: float, stack: NDArray[np.int32],
    found: Searches, p: int,
) -> int:  # fmt: skip
    """The leaves of pair p that are near, or may come near soon, into ``found``: their number, or MANY.

    Where the search, of undeformed bodies, finds nothing it is done again with twice the margin, and so on: bodies far
    apart need not be searched until they have come near each other. size: of the smaller body; bend: see ``holds``.
    """
    at, was, out, gap, far = found.held[p], found.posed[p], found.pairs[p], found.gap[p], found.far[p]
    at[0], at[1] = found.pole[p, 0], found.pole[p, 1]
    was[0], was[1], was[2], was[3] = rel.c, rel.s, rel.tx, rel.ty
    found.bend[p] = bend
    least = 1e-3 * TURN * margin / size
    turn = TURN * margin / size
    count = _look(a, b, rel, margin + bend, turn, at, stack, out, gap, far)
    while count < 0 and turn > least:  # more than there is room for
        turn *= 0.25
        count = _look(a, b, rel, margin + bend, turn, at, stack, out, gap, far)
    while count == 0 and 0.0 < margin < size:
        if _look(a, b, rel, 2.0 * margin + bend, 2.0 * turn, at, stack, out, gap, far) != 0:
            break
        margin *= 2.0
        turn *= 2.0
    found.found[p], found.margin[p], found.turn[p] = count, margin, turn
    return count
