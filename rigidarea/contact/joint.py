"""Joints as rows of the solve: every constraint of pymunk's, one row each, beside the contacts'.

A joint is a row of two unknowns at one point, l along n and lt along t = (-n_y, n_x), each within bounds, and the two
together within a disc of radius `most` (max_force). What Chipmunk's own functions ask for is what the row asks for:

| joint | n | l | lt |
|---|---|---|---|
| pivot | (1, 0) | free | free |
| groove | the groove's normal | free | one sign, at the groove's ends |
| pin (of no length: pivot) | A's anchor to B's | free | where taut: C (v' - vt) |
| slide | the same | one sign, at either end of its range | the same |
| damped spring | the same | F0 + C (v' - vt) | the same |
| rotary spring, limit, ratchet, gear, motor | (0, 0), a torque | as those | |

`vt` is Chipmunk's bias velocity: of the error of place, the part 1 - error_bias^h is to go within h, no faster than
max_bias. Joints that cannot all be held share what is asked of them (`_give`). A limit ahead is a speculative row: it
may close by what is left of it, over h. A spring's damping is exact for the pair alone, exp(-c h W) of its speed, as
Chipmunk's, and c times its speed where others load it; its stiffness is taken midway where the step hardly follows it,
at the step's end where it cannot.
"""

from __future__ import annotations

import math
from typing import Any

from ..compile.jit import kernel
from .active import moves
from .constants import FOLLOWED, JOINT_GIVE, SWINGS_ON
from .joint_record import (
    GEAR,
    GROOVE,
    LIMIT,
    MOTOR,
    PIN,
    PIVOT,
    RATCHET,
    ROTARY_SPRING,
    SLIDE,
    SPRING,
    anchor,
    held_by,
    unfollowed,
)


@kernel(forceinline=True)
def _bias(joint: Any, error: float, h: float) -> float:
    """The speed at which so much of an error goes (cpConstraint's bias_coef and maxBias)."""
    speed = (1.0 - joint.error_bias**h) * error / h
    return min(joint.max_bias, max(-joint.max_bias, speed))


@kernel(forceinline=True)
def _place(row: Any, nx: float, ny: float, ax: float, ay: float, bx: float, by: float) -> None:
    """The row's direction, and its arms: it acts at (ax, ay) from A's centre, (bx, by) from B's."""
    row.nx = nx
    row.ny = ny
    row.arm_a = ax * ny - ay * nx
    row.arm_b = bx * ny - by * nx
    row.lean_a = ax * nx + ay * ny
    row.lean_b = bx * nx + by * ny


@kernel
def spring_reach(joint: Any, a: Any, b: Any) -> float:
    """What a spring's force function is asked with: its length, or the angle from B to A."""
    if joint.kind == ROTARY_SPRING:
        return float(a.angle - b.angle)
    ax, ay = anchor(a, joint.p[0], joint.p[1])
    bx, by = anchor(b, joint.p[2], joint.p[3])
    return math.hypot(b.x + bx - a.x - ax, b.y + by - a.y - ay)


@kernel
def _stretch(row: Any, joint: Any, a: Any, b: Any, h: float) -> None:
    """Pin, slide joint or spring: along the line from anchor to anchor."""
    ax, ay = anchor(a, joint.p[0], joint.p[1])
    bx, by = anchor(b, joint.p[2], joint.p[3])
    nx = b.x + bx - a.x - ax
    ny = b.y + by - a.y - ay
    distance = math.hypot(nx, ny)
    if distance > 0.0:
        nx /= distance
        ny /= distance
    if joint.kind == PIN:
        row.t1 = _bias(joint, distance - joint.p[4], h)
    elif joint.kind == SLIDE:
        over = distance - joint.p[5]
        under = joint.p[4] - distance
        if over > under:  # B is to be pulled: the direction is from B to A
            nx = -nx
            ny = -ny
        _limit(row, joint, -max(over, under), h)
    _place(row, nx, ny, ax, ay, bx, by)


@kernel(forceinline=True)
def _limit(row: Any, joint: Any, left: float, h: float) -> None:
    """A limit with so much `left` until it is reached (less than nothing: it has been passed)."""
    row.low = 0.0
    row.t1 = left / h if left >= 0.0 else _bias(joint, left, h)


@kernel
def _groove(row: Any, joint: Any, a: Any, b: Any, h: float) -> None:
    """B's anchor on a groove of A's: across it, and at its ends along it too."""
    nx = a.c * joint.p[0] - a.s * joint.p[1]
    ny = a.s * joint.p[0] + a.c * joint.p[1]
    sx, sy = anchor(a, joint.p[2], joint.p[3])  # from its start
    ex, ey = anchor(a, joint.p[4], joint.p[5])
    bx, by = anchor(b, joint.p[6], joint.p[7])
    x = b.x + bx - a.x
    y = b.y + by - a.y
    # along t = (-n_y, n_x); the groove's end is before its start, for n is its direction turned by +90 degrees
    along = -x * ny + y * nx
    start = -sx * ny + sy * nx
    end = -ex * ny + ey * nx
    at = min(start, max(end, along))
    across = sx * nx + sy * ny
    ax = across * nx - at * ny
    ay = across * ny + at * nx
    _place(row, nx, ny, ax, ay, bx, by)
    _bias_vector(row, joint, (x - ax) * nx + (y - ay) * ny, -(x - ax) * ny + (y - ay) * nx, h)
    if start - along < along - end:  # its start is nearer: it pushes along -t
        row.low_t = -math.inf
        if along < start:
            row.tt = (along - start) / h
    else:
        row.high_t = math.inf
        if along > end:
            row.tt = (along - end) / h


@kernel(forceinline=True)
def _bias_vector(row: Any, joint: Any, x: float, y: float, h: float) -> None:
    """Of an error (x, y) along n and t, the speed at which it goes: no faster than max_bias."""
    part = (1.0 - joint.error_bias**h) / h
    speed = part * math.hypot(x, y)
    if speed > joint.max_bias:
        part *= joint.max_bias / speed
    row.t1 = part * x
    row.tt = part * y


@kernel(forceinline=True)
def mending_speeds(row: Any) -> tuple[float, float]:
    """Of the speeds that a joint asks for along n and t, those that mend an error of place: a limit ahead has none."""
    mends = (row.low < 0.0 and row.t1 > 0.0) or (row.high > 0.0 and row.t1 < 0.0)
    mends_t = (row.low_t < 0.0 and row.tt > 0.0) or (row.high_t > 0.0 and row.tt < 0.0)
    return row.t1 if mends else 0.0, row.tt if mends_t else 0.0


@kernel(forceinline=True)
def _give(row: Any, joint: Any, a: Any, b: Any, h: float) -> float:
    """By which part of its effective mass a joint gives way: JOINT_GIVE, and more where it has an error to mend.

    Joints that nearly contradict each other, two rods of one line, can all be held, at any speed across. What gives way
    by g bounds that: the gain of a solve (W + g)^-1 is at most 1 / (2 sqrt(g)) (Tikhonov), so that with g = (t h / e)^2
    an error that goes at the speed t moves neither of the joint's own two bodies by more than e / 2 in a step; what
    those push or pull in turn it does not bound. e is the smaller one's extent, or the error where that is larger: what
    bears a load far above its own would give way to it the more the farther it has given way. (A limit that is not
    reached yet asks for nothing; a rotary joint turns by half a radian.)
    """
    t1, tt = mending_speeds(row)
    part = h * math.sqrt(t1 * t1 + tt * tt)
    if row.nx != 0.0 or row.ny != 0.0:
        least = min(a.extent if moves(a) else math.inf, b.extent if moves(b) else math.inf)
        part = part / least if least > 0.0 else 0.0
    part = min(part, 1.0 - joint.error_bias**h)
    return float(JOINT_GIVE + part * part)


@kernel(forceinline=True)
def _give_across(row: Any, joint: Any, a: Any, b: Any, h: float) -> float:
    """By which part a taut rod or spring gives way across itself: a short one turns farther than its row knows.

    As of a spring, the force at the step's end where the step does not follow: the shorter, the more it is a pivot.
    Less what it swings on by (SWINGS_ON): a slow swing would be damped with the fast one.
    """
    _, _, stiffness = held_by(joint, a, b)
    phase2 = stiffness * row.w22 * h * h
    part = unfollowed(phase2, 1.0) * phase2
    if part == 0.0:
        return 0.0
    row.low_t = -math.inf
    row.high_t = math.inf
    vx, vy = a.vx - a.kick_x - b.vx + b.kick_x, a.vy - a.kick_y - b.vy + b.kick_y
    slip = vy * row.nx - vx * row.ny + (a.w - a.kick_w) * row.lean_a - (b.w - b.kick_w) * row.lean_b
    row.ft = -SWINGS_ON * slip * part / row.w22
    return 1.0 / part


@kernel
def make_joint_row(row: Any, joint: Any, a: Any, b: Any, h: float) -> bool:
    """The row of a joint where its bodies are; False: it can do nothing. `a`, `b`: its bodies, the kick already given.

    Row.region, a, b are set by the caller.
    """
    kind = joint.kind
    row.ends = 0
    row.friction = 0.0
    row.e1 = 0.0
    row.e2 = 0.0
    row.t1 = row.tt = 0.0
    row.bend1 = row.bend_t = 0.0
    row.l1 = 0.0
    row.lt = 0.0
    row.low = -math.inf
    row.high = math.inf
    row.low_t = 0.0
    row.high_t = 0.0
    row.most = joint.max_force * h
    if kind == PIVOT:
        ax, ay = anchor(a, joint.p[0], joint.p[1])
        bx, by = anchor(b, joint.p[2], joint.p[3])
        _place(row, 1.0, 0.0, ax, ay, bx, by)
        _bias_vector(row, joint, b.x + bx - a.x - ax, b.y + by - a.y - ay, h)
        row.low_t = -math.inf
        row.high_t = math.inf
    elif kind == GROOVE:
        _groove(row, joint, a, b, h)
    elif kind == PIN or kind == SLIDE or kind == SPRING:
        _stretch(row, joint, a, b, h)
    else:
        row.nx = 0.0
        row.ny = 0.0
        row.arm_a = 1.0
        row.arm_b = 1.0
        row.lean_a = 0.0
        row.lean_b = 0.0
        turned = b.angle - a.angle
        if kind == LIMIT:
            over = turned - joint.p[1]
            under = joint.p[0] - turned
            if over > under:
                row.arm_a = -1.0
                row.arm_b = -1.0
            _limit(row, joint, -max(over, under), h)
        elif kind == RATCHET:
            ahead = joint.p[0] - turned
            if ahead * joint.p[2] <= 0.0:
                joint.p[0] = math.floor((turned - joint.p[1]) / joint.p[2]) * joint.p[2] + joint.p[1]
                ahead = joint.p[0] - turned
            side = 1.0 if joint.p[2] > 0.0 else -1.0
            row.arm_a = side
            row.arm_b = side
            _limit(row, joint, -side * ahead, h)
        elif kind == GEAR:
            row.arm_b = joint.p[1]
            row.most /= abs(joint.p[1])
            row.t1 = _bias(joint, b.angle * joint.p[1] - a.angle - joint.p[0], h)
        elif kind == MOTOR:
            row.t1 = joint.p[0]
    ia = a.inverse_moment
    ib = b.inverse_moment
    masses = (a.inverse_mass + b.inverse_mass) * (row.nx * row.nx + row.ny * row.ny)
    row.w11 = masses + row.arm_a * row.arm_a * ia + row.arm_b * row.arm_b * ib
    row.w22 = masses + row.lean_a * row.lean_a * ia + row.lean_b * row.lean_b * ib
    row.w12 = row.arm_a * row.lean_a * ia + row.arm_b * row.lean_b * ib
    if row.w11 <= 0.0:
        return False
    row.weight = row.w11
    row.f1 = 0.0
    row.f2 = 0.0
    row.ft = 0.0
    give = JOINT_GIVE if kind == MOTOR else _give(row, joint, a, b, h)
    row.alpha = give / (1.0 + give)
    row.gamma = row.alpha / (give * row.w11)
    row.own = 1.0
    row.other = 0.0
    row.alpha_t = 0.0
    row.gamma_t = 1.0
    along = kind == PIN or kind == SLIDE or kind == SPRING
    give_t = _give_across(row, joint, a, b, h) if along else give
    row.grips = row.low_t < row.high_t and row.w22 > 0.0
    if kind == SPRING or kind == ROTARY_SPRING:
        _load_spring(row, joint, a, b, h)
        row.grips = row.grips and row.gamma > 0.0  # 0: the step follows it, its force is given
    elif joint.step > 0.0:
        scale = h / joint.step
        row.l1, row.lt = clamp_joint(row, scale * _along(row, joint), scale * _across(row, joint))
    t1, tt = mending_speeds(row)
    row.held = max(0.0, -(row.l1 * t1 + row.lt * tt)) if kind != MOTOR else 0.0
    if row.grips:
        row.alpha_t = give_t / (1.0 + give_t)
        row.gamma_t = row.alpha_t / (give_t * row.w22)
        row.w11 = row.w11 * (1.0 + give) if kind != SPRING else row.w11 + row.alpha / row.gamma
        row.w22 *= 1.0 + give_t
        row.det = 1.0 / (row.w11 * row.w22 - row.w12 * row.w12)
    row.l2 = 0.0
    return True


@kernel(forceinline=True)
def _along(row: Any, joint: Any) -> float:
    """Of the impulse that a joint did last, as Chipmunk keeps it, the row's l."""
    if joint.kind == PIVOT or joint.kind == GROOVE:
        return float(joint.jx * row.nx + joint.jy * row.ny)
    if joint.kind == SLIDE:
        return -float(joint.jx)
    return float(joint.jx / row.arm_b) if joint.kind >= LIMIT else float(joint.jx)


@kernel(forceinline=True)
def _across(row: Any, joint: Any) -> float:
    """And its lt."""
    if joint.kind == PIVOT or joint.kind == GROOVE:
        return float(joint.jy * row.nx - joint.jx * row.ny)
    return 0.0


@kernel
def settle_joint(joint: Any, row: Any, h: float) -> None:
    """After the sweeps: what the joint remembers, as Chipmunk keeps it."""
    if joint.kind == PIVOT or joint.kind == GROOVE:
        joint.jx = row.l1 * row.nx - row.lt * row.ny
        joint.jy = row.l1 * row.ny + row.lt * row.nx
    elif joint.kind == SLIDE:
        joint.jx = -row.l1
    else:
        joint.jx = row.l1 * row.arm_b if joint.kind >= LIMIT else row.l1
    joint.step = h
    joint.x += joint.jx
    joint.y += joint.jy


@kernel(forceinline=True)
def _load_spring(row: Any, joint: Any, a: Any, b: Any, h: float) -> None:
    """A spring's force where it is now, its damping, and its stiffness as far as the step does not follow it.

    Of place and velocity that leapfrog, the force a quarter of a step times the change of velocity further on keeps an
    oscillation's amplitude whatever its frequency (Newmark's constant acceleration, J Eng Mech Div 85 (1959)): it is
    l = f1 + q (v - v0) / W, v0 the speed before kicks. What goes through more than a radian in a step is not seen to
    oscillate, and comes to rest: the force at the step's end.

    Its damper does c h of the speed, of v and v0 in the proportion by which the pair alone keeps exp(-c h W) of it
    (exponential fitting: W. Liniger & R. A. Willoughby, SIAM J. Numer. Anal. 7 (1970), doi:10.1137/0707002): between
    the trapezoidal rule and the speed at the step's end.
    """
    if joint.kind == SPRING:
        stiffness = joint.p[5]
        damping = joint.p[6]
        force = (joint.p[4] - spring_reach(joint, a, b)) * stiffness
    else:
        stiffness = joint.p[1]
        damping = joint.p[2]
        force = (spring_reach(joint, a, b) - joint.p[0]) * stiffness
    if joint.asked:
        force = joint.force
        stiffness = 0.0
    force = min(joint.max_force, max(-joint.max_force, force))
    w = row.weight
    phase2 = stiffness * w * h * h
    kept = 0.25 * phase2 * unfollowed(phase2, FOLLOWED)
    damped = damping * h * w
    at_end = damped / -math.expm1(-damped) - 1.0 if damped > 0.0 else 0.0
    q = at_end + unfollowed(phase2, 1.0) * phase2 + kept
    before = kept - (damped - at_end)  # by how much of the speed before
    if before != 0.0 and q > 0.0:
        ux = a.vx - a.kick_x - b.vx + b.kick_x
        uy = a.vy - a.kick_y - b.vy + b.kick_y
        wa = a.w - a.kick_w
        wb = b.w - b.kick_w
        row.t1 = before / q * (ux * row.nx + uy * row.ny + (wa * row.arm_a - wb * row.arm_b))
    row.alpha = 1.0 / (1.0 + q)
    row.gamma = q / w * row.alpha
    row.f1 = h * force
    row.l1 = row.f1


@kernel(forceinline=True)
def clamp_joint(row: Any, l1: float, lt: float) -> tuple[float, float]:
    """The impulses of a joint within its bounds."""
    l1 = min(row.high, max(row.low, l1))
    lt = min(row.high_t, max(row.low_t, lt)) if row.grips else 0.0
    size = math.sqrt(l1 * l1 + lt * lt)
    if size > row.most:
        l1 *= row.most / size
        lt *= row.most / size
    return l1, lt


@kernel(forceinline=True)
def solve_joint(row: Any, v: float, slip: float) -> tuple[float, float]:
    """Changes of l and lt that a joint asks for at the closing speed v and the slip: both together, within bounds."""
    r1 = row.alpha * (row.f1 - row.l1) + row.gamma * (v - row.t1)
    if not row.grips:  # alpha + gamma W = 1
        l1, _ = clamp_joint(row, row.l1 + r1, 0.0)
        return l1 - row.l1, 0.0
    r1 = v - row.t1 + row.alpha / row.gamma * (row.f1 - row.l1)
    rt = slip - row.tt + row.alpha_t / row.gamma_t * (row.ft - row.lt)
    lt = row.lt + (row.w11 * rt - row.w12 * r1) * row.det
    within = min(row.high_t, max(row.low_t, lt))
    l1 = row.l1 + (row.w22 * r1 - row.w12 * rt) * row.det
    if within != lt:  # an end of a groove that does not bear: the other alone
        l1 = row.l1 + (r1 - row.w12 * (within - row.lt)) / row.w11
    l1, lt = clamp_joint(row, l1, within)
    return l1 - row.l1, lt - row.lt
