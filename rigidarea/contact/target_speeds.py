"""The speeds at which rows are to leave their bodies where no force in the step says so: a bounce, an overlap to come.

A bounce shorter than the step is over by its end, and an overlap that the next drift would bring may close until it is
there: neither has a course within the step that a force could follow, so that `row.make_row` asks for a speed.
"""

from __future__ import annotations

import math
from typing import Any

from ..compile.jit import kernel
from .constants import REST_KICKS, SMOOTH
from .motion import centre_of, earlier
from .region import closing, others_push
from .tables import LYING

#: So many blows of a face's two ends at most: what closes still bounces in the substep after.
MOST_BLOWS = 12


@kernel
def turn_along(r: Any, a: Any, b: Any, left: float) -> float:
    """The direction in which a disc is led on, from one fixed side to the next of a chain; the speed to leave it at.

    It may close by `left` (length/time) along the side ahead. Pushed along that side's normal it loses part of its
    speed in every substep, however smooth the chain; pushed across the mean of the velocities before and after, it
    keeps it (l (v + v') / 2 = 0: a discrete gradient, O. Gonzalez, J. Nonlinear Sci. 6 (1996),
    doi:10.1007/BF02440162). So where it lies on something already, comes to the next side at a flat angle, and is not
    at rest.
    """
    u_x = a.vx - a.kick_x - b.vx + b.kick_x
    u_y = a.vy - a.kick_y - b.vy + b.kick_y
    square = u_x * u_x + u_y * u_y
    closes = u_x * r.nx + u_y * r.ny
    disc = a if b.inverse_mass == 0.0 else b
    other = b if b.inverse_mass == 0.0 else a
    round_one = 1 if b.inverse_mass == 0.0 else 2
    if (
        r.radial & round_one == 0
        or other.inverse_mass > 0.0
        or other.w != 0.0
        or disc.pushed < LYING
        or closes <= left
        or closes * closes > SMOOTH * square
        or square <= REST_KICKS * REST_KICKS * (disc.kick_x * disc.kick_x + disc.kick_y * disc.kick_y)
    ):
        return left
    along = u_y * r.nx - u_x * r.ny
    then = math.copysign(math.sqrt(max(0.0, square - left * left)), along)
    # (along - then) / (closes - left): of either little but rounding may be left
    turn = -(closes + left) / (along + then)
    size = math.sqrt(1.0 + turn * turn)
    nx = (r.nx - turn * r.ny) / size
    ny = (r.ny + turn * r.nx) / size
    r.nx = nx
    r.ny = ny
    return (left + then * turn) / size


@kernel(forceinline=True)
def _closes(r: Any, speed: float, wa: float, wb: float, end: float) -> float:
    """How fast the two close so far along the face: speed, that of their centres; wa, wb, how fast they turn."""
    return speed + wa * (r.arm_a - end) - wb * (r.arm_b - end)


@kernel(forceinline=True)
def _swung(arm: float, end: float, lever: float, c: float, s: float) -> tuple[float, float]:
    """A corner's place along the face and its lever, once its body has turned by the angle of cosine c, sine s."""
    return arm - (arm - end) * c + lever * s, lever * c + (arm - end) * s


@kernel
def _by_turns(row: Any, r: Any, a: Any, b: Any, e: float, since: float, h: float) -> float:
    """A face comes down with one end, then with the other, perhaps again: what it is left with a substep of h on.

    Of two bodies by themselves, without friction, what happens, with Newton's restitution at each blow. A corner comes
    nearer to its body's centre, or goes from it, as that turns: it is that of the body that turns more easily.
    Leaves the row's ends where their blows act on the mean, one where there is no other, and the speeds that its bodies
    have in the end as its targets.
    since: for how long kicks have acted on the bodies after the first touch (time).
    Returns how long after the first touch the blows are, on the mean (time).
    """
    first = r.later > 0.0
    end1 = r.reach if first else r.middle - 0.5 * r.straight
    end2 = r.middle + 0.5 * r.straight if first else r.reach
    masses = a.inverse_mass + b.inverse_mass
    part = since / h
    speed = (a.vx - b.vx - part * (a.kick_x - b.kick_x)) * r.nx
    speed += (a.vy - b.vy - part * (a.kick_y - b.kick_y)) * r.ny
    wa = a.w - part * a.kick_w
    wb = b.w - part * b.kick_w
    gap1 = 0.0
    gap2 = 0.0
    if first:
        gap2 = r.later * max(0.0, _closes(r, speed, wa, wb, end2))
    else:
        gap1 = -r.later * max(0.0, _closes(r, speed, wa, wb, end1))
    of_a = a.inverse_moment > b.inverse_moment
    arm, lever, up = (r.arm_a, r.lean_a, -1.0) if of_a else (r.arm_b, r.lean_b, 1.0)
    lever1 = lever + up * gap1
    lever2 = lever + up * gap2
    clock = 0.0
    l1 = 0.0
    l2 = 0.0
    at1 = 0.0
    at2 = 0.0
    late = 0.0
    for _ in range(MOST_BLOWS):
        u1 = _closes(r, speed, wa, wb, end1)
        u2 = _closes(r, speed, wa, wb, end2)
        wait1 = gap1 / u1 if u1 > 0.0 else math.inf
        wait2 = gap2 / u2 if u2 > 0.0 else math.inf
        wait = min(wait1, wait2)
        if clock + wait > r.back + h:
            break
        clock += wait
        gap1 = max(0.0, gap1 - u1 * wait)
        gap2 = max(0.0, gap2 - u2 * wait)
        turn = wait * (wa if of_a else wb)
        c = math.cos(turn)
        s = math.sin(turn)
        end1, lever1 = _swung(arm, end1, lever1, c, s)
        end2, lever2 = _swung(arm, end2, lever2, c, s)
        end = end1 if wait1 <= wait2 else end2
        arm_a = r.arm_a - end
        arm_b = r.arm_b - end
        inverse = masses + arm_a * arm_a * a.inverse_moment + arm_b * arm_b * b.inverse_moment
        # that it has swung may have turned a corner back
        push = (1.0 + e) * max(0.0, _closes(r, speed, wa, wb, end)) / inverse
        speed -= push * masses
        wa -= push * arm_a * a.inverse_moment
        wb += push * arm_b * b.inverse_moment
        late += push * clock
        if wait1 <= wait2:
            l1 += push
            at1 += push * end
        else:
            l2 += push
            at2 += push * end
    row.ends = 2 if l1 > 0.0 and l2 > 0.0 else 1
    row.e1 = at1 / l1 if l1 > 0.0 else at2 / l2 if l2 > 0.0 else r.reach
    row.e2 = at2 / l2 if row.ends == 2 else 0.0
    speed += part * ((a.kick_x - b.kick_x) * r.nx + (a.kick_y - b.kick_y) * r.ny)
    wa += part * a.kick_w
    wb += part * b.kick_w
    row.t1 = _closes(r, speed, wa, wb, row.e1)
    row.t2 = _closes(r, speed, wa, wb, row.e2)
    return late / (l1 + l2) if l1 + l2 > 0.0 else 0.0


@kernel
def _bounce_by_turns(row: Any, r: Any, a: Any, b: Any, e: float, since: float, h: float) -> None:
    """Aim at what the blows of a face's two ends leave, all of them at one time, where the bodies have been then."""
    late = _by_turns(row, r, a, b, e, since, h)
    if row.shift != 0.0:
        row.shift -= late
    _one_point(r, a, b, row.friction, row.shift)
    _by_turns(row, r, a, b, e, since, h)
    if row.ends == 1:
        r.arm_a -= row.e1
        r.arm_b -= row.e1
        r.straight = 0.0
        row.e1 = 0.0


@kernel
def aim_bounce(row: Any, r: Any, a: Any, b: Any, elasticity: float, h: float) -> None:
    """A bounce shorter than the step: speeds at first touch returned, and what they have moved since made good.

    It came `back` ago at u0; now it closes at u, what else pushes having added u - u0. To leave is e u0 less that;
    and where that is no leaving, it rests. Had it left at once, the change of velocity would have acted since then:
    so much further on it is put (`shift`). Not where contacts have pushed it a substep ago: others are near.
    """
    back = r.back
    if not others_push(a, b):
        row.shift = back
    # before speeds are asked for: the impulse is to act against those that it returns
    _one_point(r, a, b, row.friction, row.shift)
    full = closing(r, a, b, 0.0)
    gain = (full - closing(r, a, b, 1.0)) / h
    time = back + 0.5 * h
    touch = full - gain * time
    turn = a.w - b.w
    turn_gain = (a.kick_w - b.kick_w) / h
    e = elasticity if r.first_speed > 0.0 else 0.0
    row.t1 = 0.0
    row.t2 = 0.0
    if row.ends == 2 and r.later != 0.0 and e > 0.0:
        _bounce_by_turns(row, r, a, b, e, time, h)
        return
    for end in range(row.ends):
        at = row.e1 if end == 0 else row.e2
        since = (gain - turn_gain * at) * time
        u0 = touch - (turn - turn_gain * time) * at
        target = since - e * u0  # what opens may close by as much
        if u0 > 0.0 or e == 0.0:
            target = min(0.0, target)
        if end == 0:
            row.t1 = target
        else:
            row.t2 = target
    if e == 0.0 and row.ends == 1:
        row.t1 = turn_along(r, a, b, max(0.0, row.t1))
        if row.shift == 0.0:
            _one_point(r, a, b, row.friction, 0.0)


@kernel(forceinline=True)
def _centre(body: Any, time: float) -> tuple[float, float]:
    """A body's centre of gravity, so long ago."""
    if time == 0.0:
        return body.x, body.y
    return centre_of(body, earlier(body, time))


@kernel(forceinline=True)
def _one_point(r: Any, a: Any, b: Any, friction: float, time: float) -> None:
    """Arms of one point of application, bodies where they were so long ago: the heavier one's gives way.

    Those of another time, at which nothing is done, would be of two points by now: a couple from nowhere. A disc's
    radius stays one, whatever its weight: nothing but friction turns it; of two discs, where there is none.
    """
    share = b.inverse_mass / (a.inverse_mass + b.inverse_mass)
    ax, ay = _centre(a, time)
    bx, by = _centre(b, time)
    lean = r.lean_a - r.lean_b - ((bx - ax) * r.nx + (by - ay) * r.ny)
    r.lean_a -= share * lean
    r.lean_b += (1.0 - share) * lean
    if r.radial == 3 and friction == 0.0:
        return
    if r.radial == 1 or r.radial == 2:
        share = 0.0 if r.radial == 1 else 1.0
    arm = r.arm_a - r.arm_b - ((bx - ax) * r.ny - (by - ay) * r.nx)
    r.arm_a -= share * arm
    r.arm_b += (1.0 - share) * arm


@kernel
def aim_speculative(row: Any, r: Any, a: Any, b: Any, h: float) -> None:
    """An overlap yet to come, as it would be in r.back: each end may close by what is left of its gap.

    Between a face's ends the thickness to come is linear: mean times (1 + lean) and (1 - lean), the centroid being the
    point of application. A corner is thicker between them: the thicker end then has all of the depth. No end is asked
    to open: they do not overlap yet, whatever is seen of the overlap to come when they come from aside.
    """
    speed = closing(r, a, b, 0.0)
    turn = a.w - b.w
    _one_point(r, a, b, row.friction, 0.0)
    if row.ends == 1:
        row.t1 = turn_along(r, a, b, max(0.0, (speed * r.back - r.depth + r.rest_depth) / h))
        return
    length = row.e2 - row.e1
    mean = r.area / r.chord
    lean = min(1.0, max(-1.0, 3.0 * (row.e1 + row.e2) / length))
    left = r.rest_depth - r.depth + mean * abs(lean)
    row.t1 = max(0.0, ((speed - turn * row.e1) * r.back - mean * lean + left) / h)
    row.t2 = max(0.0, ((speed - turn * row.e2) * r.back + mean * lean + left) / h)
