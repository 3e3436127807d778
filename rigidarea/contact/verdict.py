"""The user's verdict on a pair, and how what is too fast waits for it.

Chipmunk asks a callback of the user's about pairs that it finds overlapping where a frame begins. What would come to
touch and pass within a frame is put where it touches, its velocity kept: so it is asked about in the next frame.
"""

from __future__ import annotations

from typing import Any

from ..compile.jit import kernel
from ..geometry.clearance import clearance
from ..geometry.overlap import OVERFLOW
from ..geometry.place import place, seen_from
from ..geometry.pool import Pool
from ..geometry.work import Work
from .birth import size_of
from .constants import PUT_FOLLOWED
from .motion import afford, earlier, jumped, overlap_before, pose_of
from .region import closing
from .sides import shown_sides
from .tables import COUNTED, DRIFTS, MORE_WORK, NEAR, SUBSTEP, Tables


@kernel(forceinline=True)
def _heard(tables: Tables, pair: Any) -> bool:
    """Whether the user has a callback to be asked about the pair."""
    a = tables.shapes[pair.a].heard
    b = tables.shapes[pair.b].heard
    return bool((a | b) & 1 or a & b & 2)


@kernel
def allowed(tables: Tables, pair: Any, frame: int) -> bool:
    """Whether the pair may collide in this frame: the user's verdict, where there is somebody to ask.

    A pair that Chipmunk has not reported in this frame has come to touch within it. Where a callback of the user's
    would be asked, it waits for that.
    """
    if pair.stamp == frame:
        return bool(pair.verdict)
    if _heard(tables, pair):
        # friction and elasticity as they were set then
        return bool(pair.verdict) and (pair.stamp >= tables.counters[COUNTED] or pair.lasting == frame)
    sa = tables.shapes[pair.a]
    sb = tables.shapes[pair.b]
    pair.friction = sa.friction * sb.friction
    pair.elasticity = sa.elasticity * sb.elasticity
    pair.steer_c = 1.0
    pair.steer_s = 0.0
    pair.surface_x = sb.surface_x - sa.surface_x
    pair.surface_y = sb.surface_y - sa.surface_y
    return True


@kernel
def lasts(pool: Pool, tables: Tables, work: Work, pair: Any, frame: int, dt: float) -> bool:
    """Whether a pair that touched in the frame before still does, for the user: no farther apart than a solve leaves.

    And what turns about a corner leaves it by its centripetal way in a frame of dt. What has begun to touch would be
    heard to separate and begin anew.
    """
    # Frames after the one that counted last have failed: what touched as they began touched as it ended. Of what has
    # not touched in the step before, failed or not, Chipmunk may have put the arbiter to another use.
    last = max(pair.stamp, pair.lasting)
    if not pair.verdict or last < tables.counters[COUNTED] or last < frame - 1 or not _heard(tables, pair):
        return False
    a = tables.bodies[tables.shapes[pair.a].body]
    b = tables.bodies[tables.shapes[pair.b].body]
    if (a.kind == DRIFTS and a.since == 0.0) or (b.kind == DRIFTS and b.since == 0.0):
        return False  # put there by hand
    slop = PUT_FOLLOWED * min(size_of(a), size_of(b))
    slop += 0.5 * dt * dt * (a.w * a.w * a.reach + b.w * b.w * b.reach)
    if pair.head < 0 and pair.gap > 0.0:
        return bool(pair.parted == tables.counters[SUBSTEP] and pair.gap <= slop)
    if pair.head < 0:  # no axis parts concave outlines
        sa = tables.shapes[pair.a]
        sb = tables.shapes[pair.b]
        ia = sa.mirror if pair.side_a < 0 else sa.outline
        ib = sb.mirror if pair.side_b < 0 else sb.outline
        rel = seen_from(pool.heads[ia], pose_of(a), pool.heads[ib], pose_of(b))
        return bool(clearance(pool, ia, pool, ib, rel, 2.0 * slop, work) <= slop)
    r = pair.head
    while r >= 0:  # as the middle of the last substep has found them, and half of it later
        region = tables.regions[r]
        if region.depth + 0.5 * region.step * closing(region, a, b, 0.0) >= -slop:
            return True
        r = region.next
    return False


@kernel
def refused(tables: Tables, pair: Any, frame: int) -> bool:
    """Whether the pair did not collide in the frame that has been: nobody wants it to, or it still waits."""
    if pair.stamp == frame:
        return not pair.verdict
    return _heard(tables, pair)


@kernel
def _put_back(body: Any, back: float) -> None:
    """A body where it was `back` ago, its velocity kept."""
    if body.kind == DRIFTS:
        body.x -= back * body.vx
        body.y -= back * body.vy
        body.angle -= back * body.w
        place(body)


@kernel
def _underway(body: Any, dt: float) -> float:
    """For how long a body has come at its velocity when a frame of dt ends: longer where it has gone on (`go_on`)."""
    square = body.vx * body.vx + body.vy * body.vy
    if body.kind != DRIFTS or square == 0.0:
        return dt
    way = (body.x - body.old_x) * body.vx + (body.y - body.old_y) * body.vy
    return float(max(dt, min(2.0 * dt, way / square)))


@kernel
def wait_for_verdicts(pool: Pool, tables: Tables, work: Work, frame: int, dt: float) -> bool:
    """After a frame of dt: what has passed a shape that the user is to be asked about goes back to where they touch.

    What it has lost by that it gets where the user lets it through (`go_on`). False: the scratch is too small.
    """
    for i in range(tables.counters[NEAR]):
        pair = tables.pairs[tables.near[i].pair]
        pair.owed = 0.0
        if pair.stamp == frame or not _heard(tables, pair):
            continue
        a = tables.bodies[tables.near[i].a]
        b = tables.bodies[tables.near[i].b]
        time = max(_underway(a, dt), _underway(b, dt))
        looks = jumped(tables, pair, a, b, time)
        if looks == 1 or (a.kind != DRIFTS and b.kind != DRIFTS):
            continue
        ia, ib = shown_sides(pool, tables, pair, earlier(a, time), earlier(b, time))
        n, back = overlap_before(pool, work, ia, ib, a, b, time, afford(tables.counters, looks))
        if n == OVERFLOW:
            tables.counters[MORE_WORK] = 1
            return False
        if n > 0:
            pair.owed = back
            _put_back(a, back)
            _put_back(b, back)
    return True


@kernel
def go_on(tables: Tables, pair: Any) -> None:
    """What has been put back to be asked about, and is let through, is where it would be."""
    _put_back(tables.bodies[tables.shapes[pair.a].body], -pair.owed)
    _put_back(tables.bodies[tables.shapes[pair.b].body], -pair.owed)
    pair.owed = 0.0
