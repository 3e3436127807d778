"""One loop of an overlap as a contact sees it."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from ..compile.jit import kernel
from ..geometry.direction import chord_direction, nodal_direction
from ..geometry.extent import extent
from ..geometry.place import Pose
from ..geometry.pool import Pool
from ..geometry.turning import curvature_of_disc, curvatures
from ..geometry.work import A_EDGE, Work
from .tables import CHORD, LAW_AREA, Law


class Patch(NamedTuple):
    """One loop of an overlap as a contact sees it, world axes."""

    area: float
    x: float
    y: float
    nx: float
    ny: float
    chord: float
    middle: float
    straight: float
    curve_a: float
    curve_b: float
    depth: float
    reach: float  # its extent along the direction
    blind: bool  # the chord is nothing: no direction of its own
    radial: int  # whose radius the direction is: 1 A's, 2 B's, 3 both'


@kernel
def reach_along(work: Work, start: int, stop: int, arcs: bool, nx: float, ny: float) -> float:
    """Extent of a loop along (nx, ny), in its own frame (length)."""
    low, high = extent(work.polygon, work.bows, start, stop, arcs, nx, ny)
    return high - low


@kernel
def longest_edges(work: Work, start: int, stop: int) -> tuple[float, float, float, float]:
    """Of a loop's straight edges the longest of A and of B, end to end, in its own frame; (0, 0): there is none."""
    longest_a = longest_b = 0.0
    ax = ay = bx = by = 0.0
    j = stop - 1
    for i in range(start, stop):
        dx = work.polygon[i, 0] - work.polygon[j, 0]
        dy = work.polygon[i, 1] - work.polygon[j, 1]
        length = dx * dx + dy * dy
        if work.label[j] == A_EDGE:
            if length > longest_a:
                longest_a = length
                ax = dx
                ay = dy
        elif length > longest_b:
            longest_b = length
            bx = dx
            by = dy
        j = i
    return ax, ay, bx, by


@kernel
def _depth(work: Work, start: int, stop: int, arcs: bool, reach: float) -> float:
    """How far a loop's outlines have gone into each other: its least width.

    Of those along the direction (`reach`) and across its longest edges. Along the direction alone a thin long strip
    would seem deep, its chord running from corner to opposite corner.
    """
    least = reach
    ax, ay, bx, by = longest_edges(work, start, stop)
    length = math.sqrt(ax * ax + ay * ay)
    if length > 0.0:
        least = min(least, reach_along(work, start, stop, arcs, -ay / length, ax / length))
    length = math.sqrt(bx * bx + by * by)
    if length > 0.0:
        least = min(least, reach_along(work, start, stop, arcs, -by / length, bx / length))
    return least


@kernel
def _radial(work: Work, loop: Any, disc: int, nx: float, ny: float) -> tuple[float, float, int]:
    """A disc's direction, from A to B: the radius through the centroid, so that no normal force turns the disc.

    Across a straight edge, and between discs, that is the chord's normal (nx, ny); at a corner it need not be.
    """
    for i in range(loop.start, loop.stop):
        if work.label[i] == disc and work.bows[i, 2] != 0.0:
            x = loop.x - work.bows[i, 0]
            y = loop.y - work.bows[i, 1]
            length = math.sqrt(x * x + y * y)
            if disc != A_EDGE:
                length = -length
            if (x * nx + y * ny) * length > 0.0:
                return x / length, y / length, 1
            break
    return nx, ny, 0


@kernel(forceinline=True)
def _is_cut_off(work: Work, start: int) -> bool:
    """Whether a loop of three is what a straight edge, its first, cuts off a disc: the arc's middle is last."""
    return bool(
        work.bows[start, 2] == 0.0 and work.bows[start + 1, 2] != 0.0 and work.bows[start + 2, 2] != 0.0
    )


@kernel
def patch_of(pool: Pool, work: Work, law: Law, k: int, ia: int, ib: int, pose: Pose) -> Patch:
    """Loop k of the work, of outlines ia at `pose` and ib."""
    loop = work.loops[k]
    head = pool.heads[ia]
    lx = loop.x + head.x
    ly = loop.y + head.y
    x = pose.x + pose.c * lx - pose.s * ly
    y = pose.y + pose.s * lx + pose.c * ly
    if law.direction == CHORD:
        nx, ny = chord_direction(loop.chord_x, loop.chord_y, loop.area)
    else:
        nx, ny = nodal_direction(work.polygon, work.label, loop.start, loop.stop, law.exponent)
        if nx == 0.0 and ny == 0.0:
            nx, ny = chord_direction(loop.chord_x, loop.chord_y, loop.area)
    blind = nx == 0.0 and ny == 0.0
    chord = math.sqrt(loop.chord_x * loop.chord_x + loop.chord_y * loop.chord_y)
    middle = 0.0
    if blind:
        chord = math.sqrt(loop.area)
    else:
        middle = loop.lever / chord
    straight = min(loop.straight, chord)
    radial = 0
    if not blind and law.direction == CHORD and law.law == LAW_AREA and (head.disc or pool.heads[ib].disc):
        nx, ny, radial = _radial(work, loop, A_EDGE if head.disc else 1 - A_EDGE, nx, ny)
        if radial:
            radial = (1 if head.disc else 0) | (2 if pool.heads[ib].disc else 0)
    wx = pose.c * nx - pose.s * ny
    wy = pose.s * nx + pose.c * ny
    depth = chord
    reach = chord
    curve_a = 0.0
    curve_b = 0.0
    if not blind:
        if head.disc and pool.heads[ib].disc:  # a lens, its arcs' middles second and last
            far = loop.start + 1
            near = loop.start + 3
            reach = nx * (work.polygon[far, 0] - work.polygon[near, 0])
            reach += ny * (work.polygon[far, 1] - work.polygon[near, 1])
        elif (
            (head.disc or pool.heads[ib].disc)
            and loop.stop - loop.start == 3
            and _is_cut_off(work, loop.start)
        ):
            middle_of_arc = loop.start + 2
            reach = nx * (work.polygon[middle_of_arc, 0] - work.polygon[loop.start, 0])
            reach = abs(reach + ny * (work.polygon[middle_of_arc, 1] - work.polygon[loop.start, 1]))
        else:
            reach = reach_along(work, loop.start, loop.stop, loop.arcs > 0, nx, ny)
        if straight > 0.0 or loop.arcs == 0 or chord == 0.0:
            depth = _depth(work, loop.start, loop.stop, loop.arcs > 0, reach)
        else:
            depth = min(reach, 2.0 * loop.area / chord)  # of a crescent its chord's normal says too much
            both = 12.0 * loop.area / (chord * chord * chord)
            if head.disc:
                curve_a = curvature_of_disc(head.radius, chord)
                curve_b = both - curve_a
            elif pool.heads[ib].disc:
                curve_b = curvature_of_disc(pool.heads[ib].radius, chord)
                curve_a = both - curve_b
            else:
                curve_a, curve_b = curvatures(
                    work.polygon, work.label, work.bows, loop.start, loop.stop, loop.area, chord
                )
    return Patch(
        loop.area, x, y, wx, wy, chord, middle, straight, curve_a, curve_b, depth, reach, blind, radial
    )


@kernel
def faceless(patch: Patch, nx: float, ny: float, past: bool) -> Patch:
    """A patch along another direction, on no face; `past` the middle of a body, on nothing round either."""
    return Patch(
        patch.area,
        patch.x,
        patch.y,
        nx,
        ny,
        patch.chord,
        0.0,
        0.0,
        0.0 if past else patch.curve_a,
        0.0 if past else patch.curve_b,
        patch.depth,
        patch.reach,
        patch.blind,
        0 if past else patch.radial,
    )


@kernel
def centred(patch: Patch) -> Patch:
    """A patch whose point of application is its chord's middle."""
    return Patch(
        patch.area,
        patch.x - patch.ny * patch.middle,
        patch.y + patch.nx * patch.middle,
        patch.nx,
        patch.ny,
        patch.chord,
        0.0,
        patch.straight,
        patch.curve_a,
        patch.curve_b,
        patch.depth,
        patch.reach,
        patch.blind,
        patch.radial,
    )


@kernel
def deepest_of(work: Work, n: int) -> float:
    """Largest depth of the work's n loops, along their chords' normals (length)."""
    most = 0.0
    for k in range(n):
        loop = work.loops[k]
        nx, ny = chord_direction(loop.chord_x, loop.chord_y, loop.area)
        if nx != 0.0 or ny != 0.0:
            most = max(most, reach_along(work, loop.start, loop.stop, loop.arcs > 0, nx, ny))
    return most
