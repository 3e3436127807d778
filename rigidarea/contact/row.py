"""One contact region as rows of the solve: a normal force at each end of its face, and friction (theory 4).

    l = h (F0 + C (v' - vt)),   F0 = k A,   C = c + theta (1 + S) h k L,   l >= 0

l an impulse, v' the closing speed after the solve, h the substep. At rest l = h k A, whatever the step: nothing is
softened. theta = 0 where the step follows the contact, which is the explicit law; theta -> 1 where it does not: the
spring is then taken at the end of the step, and opens again in S steps. C -> infinity with a target speed vt is an
impact shorter than the step. All of them share one form with alpha = 1/(1 + h C W), gamma = h C alpha, W the inverse
effective mass: a visit adds

    dl = [alpha (h F0 - l) + gamma (v - vt)] / (alpha + gamma W)

so that alpha = 1, gamma = 0 is a given force, and alpha = 0 a given speed.

A straight face is two such rows, at the ends e1, e2 of its straight stretch s, solved as one block with
C [[a, b], [b, a]], a + b = 1/2, a - b = s / 6L: that is a bed's stiffness k L and, against turning, k s^3/12; F0 is
shared so that k A acts at the centroid; and with both l >= 0 the resultant stays within the face. What gives way is
their compliance, so that a face on one end is the slope of an energy as well. Friction is a third row along the
tangent, bounded by mu (l1 + l2).

n from A to B, t = (-n_y, n_x); an impulse l pushes A along -n and B along +n.
"""

from __future__ import annotations

import math
from typing import Any

from ..compile.jit import kernel
from ..geometry.turning import turning_speed, turning_together
from .birth import drives, flies_off
from .constants import DRIVEN_SPEED, OVERTAKE, PLACED_LOADS, PUT_SPEED, RELEASE_STEPS, TANGENT_STIFFNESS
from .impact import begin_impact, damping_ratio, follow_impact, impact_force
from .joint import solve_joint
from .region import beyond, closing, growth, inverse_mass, is_face, least_extent, region_stiffness, slipping
from .stiffness import damping_that_opens
from .tables import BLOW, FOLLOWS, IMPACT, LAW_AREA, LIES, NEARING, PLACED, REST, SPENT, STRUCK, Law
from .target_speeds import aim_bounce, aim_speculative, turn_along

#: Ends of a face whose determinant is less than this part of what it is the difference of are one: that part is
#: rounding's where a body turns easily.
ONE_END = 1e-12


@kernel
def _ends(row: Any, r: Any) -> None:
    """The face's two ends from the point of application, and how F0 and C are shared."""
    if not is_face(r):
        row.ends = 1
        row.e1 = 0.0
        row.e2 = 0.0
        return
    half = 0.5 * r.straight
    middle = min(0.999 * half, max(-0.999 * half, r.middle))  # the point of application lies between them
    row.ends = 2
    row.e1 = middle - half
    row.e2 = middle + half


@kernel
def make_row(row: Any, r: Any, law: Law, a: Any, b: Any, pair: Any, h: float) -> None:
    """Everything of region r that stays the same during the sweeps. `a`, `b`: its bodies, the kick already given.

    Row.region, a, b are set by the caller.
    """
    row.shift = row.theta = row.slid = 0.0
    row.jammed = row.swapped = 0
    row.friction = pair.friction
    row.most = 0.0
    surface = -pair.surface_x * r.ny + pair.surface_y * r.nx
    _ends(row, r)
    if r.mode == STRUCK:
        aim_bounce(row, r, a, b, pair.elasticity, h)
    elif r.mode == NEARING:
        aim_speculative(row, r, a, b, h)
    else:
        row.t1 = 0.0
        row.t2 = 0.0
    row.nx = r.nx
    row.ny = r.ny
    row.arm_a = r.arm_a
    row.arm_b = r.arm_b
    row.lean_a = r.lean_a
    row.lean_b = r.lean_b
    ia = a.inverse_moment
    ib = b.inverse_moment
    masses = a.inverse_mass + b.inverse_mass
    inverse = inverse_mass(r, a, b)
    inverse_t = masses + r.lean_a * r.lean_a * ia + r.lean_b * r.lean_b * ib
    row.weight = inverse
    stiffness = region_stiffness(law, r.stiffness, r.chord)
    elastic = r.stiffness * (r.area if law.law == LAW_AREA else r.area * r.chord / law.length)
    middle_speed = closing(r, a, b, 0.5)
    if r.mode == IMPACT:
        if r.born:
            begin_impact(r, pair.elasticity, h)
        else:
            follow_impact(r, pair.elasticity, middle_speed, inverse, h)
    r.speed = middle_speed
    r.slip = slipping(r, a, b, 0.5) - surface
    # a given speed: of a bounce, or of what is yet to come, neither of which has borne a load
    gamma = 1.0 / inverse
    force = 0.0
    row.alpha = row.alpha_t = 0.0
    row.gamma_t = 1.0 / inverse_t
    row.ft = 0.0
    row.tt = surface
    row.l1 = row.l2 = row.lt = 0.0
    if r.mode >= STRUCK:
        r.spring = 0.0
    elif flies_off(law, pair, r, a, b, h):
        # Sent back it may close as fast as it opens. Stopped sooner it would be pushed while it opens, and gain energy
        # (l (v + v') / 2: J. J. Moreau, "Unilateral contact and dry friction in finite freedom dynamics", 1988,
        # doi:10.1007/978-3-7091-2624-0_1).
        row.t1 = -closing(r, a, b, 0.0)
        row.t2 = row.t1
        r.spring = 0.0
    elif r.mode == IMPACT:
        row.ends = 1
        row.e1 = 0.0
        row.e2 = 0.0
        gamma = 0.0
        row.alpha = 1.0
        force = h * impact_force(r, pair.elasticity, elastic, middle_speed, inverse, h)
        r.spring = 0.0
        row.l1 = force
        row.lt = r.lt * (h / r.step)
    else:
        stiffness = max(stiffness, pair.firm)
        if law.followed < math.inf:  # past a body's middle the area hardly grows: a force without a slope
            stiffness = max(stiffness, elastic / r.depth)
        driven = drives(law, a) or drives(law, b)
        if r.placed == PLACED and law.stiffness == 0.0:
            pressed = pair.least if driven else max(pair.least, pair.load)
            most = PLACED_LOADS * pressed
            if elastic > most:
                stiffness *= most / elastic
                elastic = most
        phase2 = stiffness * inverse * h * h
        theta = beyond(law, phase2)
        c = 2.0 * damping_ratio(pair.elasticity) * math.sqrt(stiffness / inverse)
        c += theta * (1.0 + RELEASE_STEPS) * h * stiffness
        if r.placed == SPENT and law.followed < math.inf:
            c = max(c, stiffness / PUT_SPEED)
        elif r.placed == PLACED:
            c = max(c, elastic / ((DRIVEN_SPEED if driven else PUT_SPEED) * least_extent(a, b)))
        put = damping_that_opens(r, a, b, pair.least, elastic, inverse, h) if driven else math.inf
        c = min(c, put)
        q = h * c * inverse
        row.alpha = 1.0 / (1.0 + q)
        row.jammed = r.placed == PLACED and (a.calm < 0 or b.calm < 0)
        row.theta = (1.0 if r.placed == PLACED else theta) * (1.0 - row.alpha)
        # a step longer than an edge's own time opens it all by itself: no trace of speed is left; what is round rolls
        if phase2 >= 1.0:
            row.theta = 1.0 if row.ends == 2 or c == put else max(row.theta, 2.0 * growth(r) - 3.0)
        gamma = h * c * row.alpha
        force = h * elastic
        kt = TANGENT_STIFFNESS * stiffness
        # the spring remembers a force; where the region shrinks the force shrinks with it: no energy comes free
        if kt < r.tangent_stiffness:
            r.spring *= kt / r.tangent_stiffness
        r.tangent_stiffness = kt
        ct = 2.0 * math.sqrt(kt / inverse_t) + kt * theta * h
        qt = h * ct * inverse_t
        row.alpha_t = 1.0 / (1.0 + qt)
        row.gamma_t = h * ct * row.alpha_t
        row.ft = h * r.spring
        scale = h / r.step
        row.l1 = r.l1 * scale
        row.l2 = r.l2 * scale
        row.lt = r.lt * scale
        if row.ends == 1:
            row.l1 += row.l2
            row.l2 = 0.0
            row.t1 = turning_speed(r, a, b, h)
            if theta > 0.0:
                row.t1 += turn_along(r, a, b, 0.0)
                row.nx = r.nx
                row.ny = r.ny
        else:
            row.t1 = row.t2 = turning_together(r, a, b, h)
    row.began = row.l1 + row.l2
    row.mt = 1.0 / (row.alpha_t + row.gamma_t * inverse_t)
    lean_a = row.lean_a * ia
    lean_b = row.lean_b * ib
    if row.ends == 2 and ia + ib <= 1e-12 * masses / (r.chord * r.chord):  # nothing turns: both ends are one
        row.ends = 1
        row.l1 += row.l2
        row.l2 = 0.0
        row.t1 = 0.5 * (row.t1 + row.t2)
    row.gamma = gamma
    row.w11 = inverse
    row.own = 1.0
    row.other = 0.0
    row.f1 = force
    row.f2 = 0.0
    # what a step is too long for opens without giving speed (`relax`); of those who bounce, restitution gives
    kept = 1.0 - row.theta if pair.elasticity > 0.0 else 1.0
    row.held = kept * force / h * r.depth
    row.slip1 = r.arm_a * lean_a + r.arm_b * lean_b
    take_inverse(row)
    if row.ends == 1:
        return
    turning = (row.e2 - row.e1) / (6.0 * r.chord)
    row.own = 0.5 / turning + 1.0
    row.other = 1.0 - 0.5 / turning
    row.f1 = force * row.e2 / (row.e2 - row.e1)
    row.f2 = force - row.f1
    a1 = r.arm_a - row.e1
    a2 = r.arm_a - row.e2
    b1 = r.arm_b - row.e1
    b2 = r.arm_b - row.e2
    row.slip1 = a1 * lean_a + b1 * lean_b
    row.slip2 = a2 * lean_a + b2 * lean_b
    row.w11 = masses + a1 * a1 * ia + b1 * b1 * ib
    row.w12 = masses + a1 * a2 * ia + b1 * b2 * ib
    row.w22 = masses + a2 * a2 * ia + b2 * b2 * ib


@kernel(forceinline=True)
def take_inverse(row: Any) -> None:
    """What `visit` multiplies with, of a row of one end: anew where its compliance has changed."""
    row.m1 = 1.0 / (row.alpha + row.gamma * (row.w11 - row.slip1 * row.mt * row.gamma_t * row.slip1))


@kernel(forceinline=True)
def push(row: Any, a: Any, b: Any, d1: float, d2: float, dt: float) -> None:
    """Give the two bodies impulses d1, d2 at the ends and dt along the tangent."""
    normal = d1 + d2
    turn = 0.0 if row.ends < 2 else d1 * row.e1 + d2 * row.e2
    fx = normal * row.nx - dt * row.ny
    fy = normal * row.ny + dt * row.nx
    a.vx -= fx * a.inverse_mass
    a.vy -= fy * a.inverse_mass
    a.w -= (normal * row.arm_a - turn + dt * row.lean_a) * a.inverse_moment
    b.vx += fx * b.inverse_mass
    b.vy += fy * b.inverse_mass
    b.w += (normal * row.arm_b - turn + dt * row.lean_b) * b.inverse_moment


@kernel(forceinline=True)
def _press(
    l1: float, l2: float, r1: float, r2: float, m11: float, m12: float, m21: float, m22: float
) -> tuple[float, float]:
    """What both ends of a face add, of what is left to solve; an end that would pull is open.

    Of ends that are one but for rounding one is solved for, as long as it presses.
    """
    det = m11 * m22 - m12 * m21
    if det <= ONE_END * m11 * m22:
        d1 = max(-l1, r1 / m11)
        return d1, (0.0 if d1 > -l1 else max(-l2, (r2 - m21 * d1) / m22))
    det = 1.0 / det
    d1 = (r1 * m22 - m12 * r2) * det
    d2 = (m11 * r2 - m21 * r1) * det
    if l1 + d1 < 0.0 or l2 + d2 < 0.0:
        if l1 + d1 < l2 + d2:
            d1 = -l1
            d2 = max(-l2, (r2 - m21 * d1) / m22)
        else:
            d2 = -l2
            d1 = max(-l1, (r1 - m12 * d2) / m11)
    return d1, d2


@kernel(forceinline=True)
def visit(row: Any, a: Any, b: Any) -> float:
    """Solve one row for the bodies' present velocities: its ends and the friction under them, all at once.

    Returns by how much that has changed the speed at which the row's bodies close or slip (length/time).

    Friction that grips is eliminated; where that is more than its bound it slides, as much as the ends then bear: the
    local problem of non-smooth contact dynamics, solved exactly (M. Jean, "The non-smooth contact dynamics method",
    1999, doi:10.1016/S0045-7825(98)00383-1). Normal force and friction by turns diverge where a body turns easily.
    Where what slides draws the two together, the more the more they bear, nothing need solve that (P. Painlevé, C. R.
    Acad. Sci. 121 (1895)): there is none then.
    """
    ux = a.vx - b.vx
    uy = a.vy - b.vy
    v = ux * row.nx + uy * row.ny + (a.w * row.arm_a - b.w * row.arm_b)
    slip = uy * row.nx - ux * row.ny + (a.w * row.lean_a - b.w * row.lean_b)
    if row.ends == 0:
        d1, dt = solve_joint(row, v, slip)
        row.l1 += d1
        row.lt += dt
        push(row, a, b, d1, 0.0, dt)
        return max(abs(d1), abs(dt)) * row.weight
    gamma = row.gamma
    c1 = gamma * row.slip1
    grips = row.mt * (row.alpha_t * (row.ft - row.lt) + row.gamma_t * (slip - row.tt))
    k1 = row.mt * row.gamma_t * row.slip1
    if row.ends == 1:
        r1 = row.alpha * (row.f1 - row.l1) + gamma * (v - row.t1)
        d2 = 0.0
        d1 = max(-row.l1, (r1 - c1 * grips) * row.m1)
        dt = grips - k1 * d1
        if abs(row.lt + dt) > row.friction * (row.l1 + d1) + row.most:
            side = math.copysign(row.friction, row.lt + dt)
            given = math.copysign(row.most, row.lt + dt) - row.lt
            m11 = row.alpha + gamma * row.w11
            slides = side * row.l1 + given
            if m11 + c1 * side <= 0.0:
                side, slides = 0.0, -row.lt
            d1 = max(-row.l1, (r1 - c1 * slides) / (m11 + c1 * side))
            dt = slides + side * d1
    else:
        turn = a.w - b.w
        left1 = row.alpha * (row.f1 - row.l1)
        left2 = row.alpha * (row.f2 - row.l2)
        r1 = row.own * left1 + row.other * left2 + gamma * (v - (turn * row.e1 + row.t1))
        r2 = row.other * left1 + row.own * left2 + gamma * (v - (turn * row.e2 + row.t2))
        m11 = row.alpha * row.own + gamma * row.w11
        m12 = row.alpha * row.other + gamma * row.w12
        m22 = row.alpha * row.own + gamma * row.w22
        c2 = gamma * row.slip2
        k2 = row.mt * row.gamma_t * row.slip2
        d1, d2 = _press(
            row.l1, row.l2, r1 - c1 * grips, r2 - c2 * grips,
            m11 - c1 * k1, m12 - c1 * k2, m12 - c2 * k1, m22 - c2 * k2,
        )  # fmt: skip
        dt = grips - k1 * d1 - k2 * d2
        both = row.l1 + row.l2
        if abs(row.lt + dt) > row.friction * (both + d1 + d2) + row.most:
            side = math.copysign(row.friction, row.lt + dt)
            slides = side * both + math.copysign(row.most, row.lt + dt) - row.lt
            q1 = c1 * side
            q2 = c2 * side
            own = (m11 + q1) * (m22 + q2)
            if min(m11 + q1, m22 + q2) <= 0.0 or own - (m12 + q1) * (m12 + q2) <= -ONE_END * own:
                side = q1 = q2 = 0.0
                slides = -row.lt
            d1, d2 = _press(
                row.l1, row.l2, r1 - c1 * slides, r2 - c2 * slides,
                m11 + q1, m12 + q1, m12 + q2, m22 + q2,
            )  # fmt: skip
            dt = slides + side * (d1 + d2)
        row.l2 += d2
    row.l1 += d1
    row.lt += dt
    push(row, a, b, d1, d2, dt)
    return max(abs(d1 + d2), abs(dt)) * row.weight


@kernel(forceinline=True)
def shift_as_held(body: Any, time: float) -> None:
    """What hangs in a joint is moved by what a blow, some time ago, and the joint have left of it together."""
    body.shift_x = time * (body.vx - body.came_vx)
    body.shift_y = time * (body.vy - body.came_vy)
    body.shift_a = time * (body.w - body.came_w)


@kernel
def settle(row: Any, r: Any, law: Law, pair: Any, a: Any, b: Any, h: float, last: bool) -> None:
    """After the sweeps: what the region remembers. Friction's spring takes the slip that came out."""
    normal = row.l1 + row.l2
    if r.mode == NEARING:
        r.spring = row.lt / h  # what grips will go on gripping
    elif r.mode == REST and row.friction + row.most > 0.0:
        slip = slipping(r, a, b, 0.0) - row.tt + row.slid
        most = pair.friction * normal / h
        r.spring = min(most, max(-most, r.spring + r.tangent_stiffness * h * slip))
    # sent back while it flies off: that is not borne
    flying = r.mode == REST and row.alpha == 0.0 and row.theta == 0.0
    ahead = (
        0.0 if flying or normal <= 0.0 else max(0.0, 1.0 - OVERTAKE * max(0.0, row.began - normal) / normal)
    )
    r.l1 = ahead * (row.l2 if row.swapped else row.l1)
    r.l2 = ahead * (row.l1 if row.swapped else row.l2)
    r.lt = ahead * row.lt
    r.step = h
    r.force = normal / h
    r.friction = row.lt / h
    if law.stiffness == 0.0:
        pair.carrying += normal
        # a blow is no load, nor is what joints or kinematic bodies hold overlapped, which presses as far as it is stiff
        held = r.placed == PLACED and (a.calm < 0 or b.calm < 0 or drives(law, a) or drives(law, b))
        if r.mode == IMPACT or held:
            pair.lies = BLOW
        elif last and r.mode != NEARING and pair.lies != BLOW:
            pair.lies = FOLLOWS if row.theta > 0.0 and law.law == LAW_AREA else LIES
    pair.jx += normal * row.nx - row.lt * row.ny
    pair.jy += normal * row.ny + row.lt * row.nx
    if row.shift != 0.0:
        turn = row.l1 * row.e1 + row.l2 * row.e2
        fx = (normal * row.nx - row.lt * row.ny) * row.shift
        fy = (normal * row.ny + row.lt * row.nx) * row.shift
        if a.calm < 0:
            shift_as_held(a, row.shift)
        else:
            a.shift_x -= fx * a.inverse_mass
            a.shift_y -= fy * a.inverse_mass
            a.shift_a -= (normal * row.arm_a - turn + row.lt * row.lean_a) * row.shift * a.inverse_moment
        if b.calm < 0:
            shift_as_held(b, row.shift)
        else:
            b.shift_x += fx * b.inverse_mass
            b.shift_y += fy * b.inverse_mass
            b.shift_a += (normal * row.arm_b - turn + row.lt * row.lean_b) * row.shift * b.inverse_moment
