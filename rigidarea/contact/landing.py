"""What lands nearly flat comes down with one corner and then with another, both within a substep.

A bounce turns the body, and by the next substep its other corner would be as far inside as that turns and falls. So the
blows of both ends are told one after another, until the substep is over, and the row is asked for the speeds that they
leave: of two bodies by themselves, without friction, what happens (Newton's restitution at each blow).
"""

from __future__ import annotations

import math
from typing import Any

from ..compile.jit import kernel
from ..geometry.place import overlap_of_outlines
from ..geometry.work import Work
from .constants import SMOOTH
from .exposed import exposed_patch
from .motion import centre_of, earlier
from .neighbours import TwoShapes
from .patch import longest_edges
from .region import closing, fill, least_extent
from .stiffness import allowed_depth

#: Where the second end touches is seen when it has come on so much further, of the way to where it was seen first.
PAST = 0.1
#: A face that is thinner at one end by more than this part of its mean thickness may end before that corner.
WEDGE = 0.9
#: Square of the sine of the angle up to which a boundary goes straight on.
STRAIGHT = 1e-12
#: So much of the smaller one's smallest extent at the most is looked into.
INTO = 0.45


@kernel
def _corners(work: Work, loop: Any) -> int:
    """How many corners a loop has: points at which its boundary goes straight on are none."""
    n = 0
    count = loop.stop - loop.start
    for k in range(count):
        i = loop.start + k
        j = loop.start + (k + 1) % count
        m = loop.start + (k + 2) % count
        ux = work.polygon[j, 0] - work.polygon[i, 0]
        uy = work.polygon[j, 1] - work.polygon[i, 1]
        vx = work.polygon[m, 0] - work.polygon[j, 0]
        vy = work.polygon[m, 1] - work.polygon[j, 1]
        cross = ux * vy - uy * vx
        n += cross * cross > STRAIGHT * (ux * ux + uy * uy) * (vx * vx + vy * vy)
    return n


@kernel
def _flat(work: Work, loop: Any) -> bool:
    """Whether a loop's two faces are one plane but for a small angle: a corner beside an edge is none that lands."""
    ax, ay, bx, by = longest_edges(work, loop.start, loop.stop)
    cross = ax * by - ay * bx
    return bool(cross * cross <= SMOOTH * (ax * ax + ay * ay) * (bx * bx + by * by))


@kernel
def _since_second(
    patch: Any, most: float, a: Any, b: Any, ax: float, ay: float, bx: float, by: float
) -> tuple[float, float]:
    """Of a face's overlap, from one corner to the other: for how long its thinner end has been within the other body.

    And the speed at which it closes; infinity where that end has not come down yet: the thickness there differs from
    the mean by more than `most` of it. (ax, ay), (bx, by): the centres.
    """
    lean = 6.0 * patch.middle / patch.chord
    if abs(lean) >= most:
        return math.inf, 0.0
    end = patch.middle + math.copysign(0.5 * patch.chord, lean)
    x = patch.x - end * patch.ny
    y = patch.y + end * patch.nx
    speed = (a.vx - b.vx - a.w * (y - ay) + b.w * (y - by)) * patch.nx
    speed += (a.vy - b.vy + a.w * (x - ax) - b.w * (x - bx)) * patch.ny
    if speed <= 0.0:
        return math.inf, 0.0
    return patch.area / patch.chord * (1.0 - abs(lean)) / speed, speed


@kernel
def find_other_end(two: TwoShapes, region: Any, h: float) -> None:
    """See a bounce's region as the face that comes down, if it does so soon: within two substeps of free motion.

    Leaves in `region.later` how much later than the first its second end would touch: negative if it is the first, 0 if
    both are down at once. Where it is no face, or one of the two is not convex, the region stays as it is.
    """
    if not (two.pool.heads[two.ia].convex and two.pool.heads[two.ib].convex):
        return
    a, b = two.a, two.b
    speed = closing(region, a, b, 0.0)
    step = min(h, INTO * least_extent(a, b) / speed) if speed > 0.0 else h
    then = step - region.back
    found = False
    for look in range(3):
        pose = earlier(a, -then)
        other = earlier(b, -then)
        n, _ = overlap_of_outlines(two.pool, two.ia, pose, two.ib, other, two.work)
        if n != 1 or not _flat(two.work, two.work.loops[0]):
            return
        down = _corners(two.work, two.work.loops[0]) > 3  # a triangle ends in nothing
        patch = exposed_patch(two, 0, pose, other)
        along = patch.nx * region.nx + patch.ny * region.ny
        if patch.blind or patch.straight < 0.5 * patch.chord or along <= 0.0:
            return
        ax, ay = centre_of(a, pose)
        bx, by = centre_of(b, other)
        since, speed = _since_second(patch, 1.0 if found else WEDGE, a, b, ax, ay, bx, by)
        if since == math.inf or not (found or down):
            if found or look > 0:
                return
            then += step
            continue
        later = then - since + region.back
        together = later * speed <= allowed_depth(two.law, a, b)
        if not (found or together):
            found = True
            then -= (1.0 - PAST) * since
            continue
        of_a = a.inverse_moment > b.inverse_moment  # its corners come down
        arm = region.arm_a if of_a else region.arm_b
        lean_a, lean_b, back = region.lean_a, region.lean_b, region.back
        area, depth = region.area, region.depth
        fill(region, patch, ax, ay, bx, by)
        region.straight = region.chord  # from corner to corner
        region.reach = (region.arm_a if of_a else region.arm_b) - arm
        region.area = area
        region.depth = depth
        region.lean_a = lean_a
        region.lean_b = lean_b
        region.back = back
        region.later = 0.0 if together else math.copysign(later, patch.middle)
        return
