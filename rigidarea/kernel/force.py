"""Force of one contact region: the area law, its direction, restitution, damping and friction.

Notation: n is the unit direction from A to B, t = (-n_y, n_x); F pushes A along -n and B along +n; closing speed
and slip are those of A relative to B at the point of application. Everything here is about one region and two
bodies; who they are, and where regions are kept between steps, is `pair.py`'s business.

Laws (design 2.3), L the chord of the region, A its area:

- `area`    F = k A (Eq. 5), at the centroid (Eq. 7). Stiffness dF/ddelta = k L. Against one straight edge exactly
            conservative.
- `energy`  F = k A L / l with a reference length l: the gradient of U = k A^2 / (2 l), conservative between any
            two outlines, along the line of action that the gradient has. Stiffness k L^2 / l.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from .jit import kernel
from .memory import record
from .overlap import A_EDGE, B_EDGE

LAW_AREA, LAW_ENERGY = 0, 1
CHORD, NODAL = 0, 1

#: Tangential over normal stiffness of a region (Cundall & Strack 1979 leave it free; 2/7 is usual: below the value
#: at which a rolling disc's tangential period equals its normal one).
TANGENT_STIFFNESS = 2.0 / 7.0
#: Restitution below this is taken as this: the exact law needs a damping factor that grows as 1/e.
LEAST_RESTITUTION = 0.01
#: A contact that has lasted this many radians of its own natural motion is no impact any more, but rest.
REST_PHASE = 50.0
#: (w h)^2 above which a step h is too long to follow a contact of frequency w: its spring is then taken implicitly,
#: its impact as an impulse. (Symplectic Euler is stable up to 4, and in a stack up to 1.)
FOLLOWED = 0.25
#: The same in a crowd, summed over a body's contacts at rest, as a multiple.
CROWDED = 4.0
#: Time in which faces at rest part again when a step has pressed them together too far, in steps: they must not jump.
SLOW = 4.0
#: A chord below this fraction of sqrt(area) is rounding: the direction is then taken from memory, or anew.
NO_CHORD = 1e-6

#: One region, remembered while it lives. Also the record of what it did in the last step.
REGION = record(
    [
        ("stamp", "i8"),  # space step in which it was last there
        ("pair", "i4"),
        ("next", "i4"),  # next region of the pair, or of the free list; -1: none
        ("resting", "i4"),  # 0: impact, 1: rest
        ("opened", "i4"),  # 1 once the bodies have moved apart within this contact
        ("sudden", "i4"),  # 1: an impact too short for the step
        ("past", "i4"),  # 1: past the middle of a body, the direction is kept
        ("area", "f8"),  # (length^2)
        ("x", "f8"),  # point of application, world (length)
        ("y", "f8"),
        ("nx", "f8"),  # direction, A to B
        ("ny", "f8"),
        ("chord", "f8"),  # (length)
        ("force", "f8"),  # normal force, never negative (force)
        ("friction", "f8"),  # tangential force on B along t (force)
        ("couple", "f8"),  # moment on B of the resting pressure's damping (force length)
        ("spring", "f8"),  # tangential force of the friction spring (force)
        ("tangent_stiffness", "f8"),  # its stiffness when last loaded (force/length)
        ("damping", "f8"),  # a of F = k A (1 + a speed) (time/length)
        ("elastic", "f8"),  # what of the force is elastic (force)
        ("excess", "f8"),  # what is damping (force)
        ("work", "f8"),  # done on the spring while closing (force length)
        ("loss", "f8"),  # energy lost to damping while closing (force length)
        ("slowed", "f8"),  # closing speed that its force has taken while closing (length/time)
        ("lasted", "f8"),  # time since first touch was noticed, while closing
        ("late", "f8"),  # time from the middle of the step of first touch to first touch
        ("withheld", "f8"),  # fraction of the spring's force that is missing while opening
        ("depth", "f8"),  # its extent along n at first touch (length)
        ("beyond", "f8"),  # A's surface beyond the point of application, along n, then (length)
        ("straight", "f8"),  # longest straight stretch of both boundaries in it (length)
        ("crowd", "f8"),  # of the two bodies' sums of rate2 over their contacts the larger (1/time^2)
        ("curved", "i4"),  # 1: one of the two boundaries is a curve
        ("alone", "i4"),  # 1: between what cannot move and a body that nothing movable touches
        ("phase", "f8"),  # radians of natural motion since first touch
        ("first_speed", "f8"),  # closing speed at first touch (length/time)
        ("speed", "f8"),  # closing speed (length/time)
        ("rate2", "f8"),  # its natural frequency squared, on these two bodies alone (1/time^2)
        ("slip", "f8"),  # tangential speed of A relative to B (length/time)
    ],
)


class Law(NamedTuple):
    """What the user chose for every region of a space."""

    stiffness: float  # k (force/length^2: a pressure per unit depth of the plane, Eq. 5 and 6)
    law: int  # LAW_AREA or LAW_ENERGY
    length: float  # l of the energy law (length)
    direction: int  # CHORD or NODAL
    exponent: float  # q of Eq. 12, for NODAL
    rest_speed: float  # first touch slower than this: rest from the start (length/time)
    followed: float = (
        FOLLOWED  # (w h)^2 up to which a step follows a contact; infinity: always, stable or not
    )


class Motion(NamedTuple):
    """A rigid body as a region sees it, world axes."""

    x: float  # centre of gravity (length)
    y: float
    vx: float  # (length/time)
    vy: float
    w: float  # (1/time)
    inverse_mass: float
    inverse_moment: float
    ax: float = 0.0  # what everything but this region does to it in this step (length/time^2)
    ay: float = 0.0
    aw: float = 0.0  # (1/time^2)


class Arms(NamedTuple):
    """Arms of the normal force and of the friction about the two bodies' centres (length)."""

    arm_a: float
    lean_a: float
    arm_b: float
    lean_b: float


class Pull(NamedTuple):
    """Force and moment on B, about its centre; and the moment on A. A's force is the opposite."""

    fx: float
    fy: float
    moment_a: float
    moment_b: float


@kernel
def restitution_damping(e: float) -> float:
    """alpha = a v0 for which F = f(depth) (1 + a speed) returns exactly e v0, whatever f.

    m v dv/dx = -f (1 + a v) separates: both ways through the same integral of f give
    alpha (1 + e) = ln[(1 + alpha) / (1 - alpha e)] (design 2.4). The right side minus the left is negative just
    above 0 and infinite at 1/e; its one root between is found by bisection.
    """
    if e >= 1.0:
        return 0.0
    e = max(e, LEAST_RESTITUTION)
    low = 0.0
    high = 1.0 / e
    for _ in range(60):
        mid = 0.5 * (low + high)
        if mid * e < 1.0 and math.log1p(mid) - math.log1p(-mid * e) < mid * (1.0 + e):
            low = mid
        else:
            high = mid
    return 0.5 * (low + high)


@kernel
def damping_ratio(e: float) -> float:
    """Damping ratio of the linear spring and dashpot that returns e: 0 for e = 1, near 1 for e = 0."""
    if e >= 1.0:
        return 0.0
    s = math.log(max(e, LEAST_RESTITUTION))
    return -s / math.sqrt(math.pi * math.pi + s * s)


@kernel
def _ray(
    polygon: np.ndarray, label: np.ndarray, start: int, stop: int, i: int, nx: float, ny: float
) -> float:
    """Distance from vertex i along n to the nearest edge of the other outline in the region (Eq. 9); 0 if none."""
    px = polygon[i, 0]
    py = polygon[i, 1]
    own = label[i]
    best = np.inf
    j = stop - 1
    for k in range(start, stop):
        if label[j] != own:
            ux = polygon[j, 0] - px
            uy = polygon[j, 1] - py
            vx = polygon[k, 0] - px
            vy = polygon[k, 1] - py
            cu = nx * uy - ny * ux
            cv = nx * vy - ny * vx
            if (cu > 0.0) != (cv > 0.0):
                s = cu / (cu - cv)
                d = nx * (ux + s * (vx - ux)) + ny * (uy + s * (vy - uy))
                if 0.0 <= d < best:
                    best = d
        j = k
    return best if best < np.inf else 0.0


@kernel
def nodal_direction(
    polygon: np.ndarray, label: np.ndarray, start: int, stop: int, exponent: float
) -> tuple[float, float]:
    """Unit direction A to B by the paper's Alg. 2, lines 6-14 (Eq. 8-15), in the polygon's frame; (0, 0) if none.

    Nodes are the vertices of an arc that are no crossings. Where one outline has no node in the region the other's
    direction stands alone (the paper then sees no contact, Fig. 1b).
    """
    total_x = 0.0
    total_y = 0.0
    for own in (A_EDGE, B_EDGE):
        sum_x = 0.0
        sum_y = 0.0
        before = stop - 1
        for i in range(start, stop):
            after = i + 1 if i + 1 < stop else start
            if label[i] == own and label[before] == own:
                dx = polygon[after, 0] - polygon[before, 0]
                dy = polygon[after, 1] - polygon[before, 1]
                length = math.sqrt(dx * dx + dy * dy)
                if length > 0.0:
                    nx = (
                        -dy / length
                    )  # Eq. 8; counter-clockwise: into the region, towards the other's boundary
                    ny = dx / length
                    depth = _ray(polygon, label, start, stop, i, nx, ny)  # Eq. 9
                    tributary = 0.5 * (
                        math.hypot(polygon[i, 0] - polygon[before, 0], polygon[i, 1] - polygon[before, 1])
                        + math.hypot(polygon[after, 0] - polygon[i, 0], polygon[after, 1] - polygon[i, 1])
                    )  # Eq. 11
                    weight = tributary * depth**exponent  # Eq. 10 and 12, without the common factor
                    sum_x += weight * nx
                    sum_y += weight * ny
            before = i
        length = math.sqrt(sum_x * sum_x + sum_y * sum_y)
        if length > 0.0:
            sign = -1.0 if own == A_EDGE else 1.0  # Eq. 13, 14, then 15: n points from A to B
            total_x += sign * sum_x / length
            total_y += sign * sum_y / length
    length = math.sqrt(total_x * total_x + total_y * total_y)
    if length == 0.0:
        return 0.0, 0.0
    return total_x / length, total_y / length


@kernel
def chord_direction(chord_x: float, chord_y: float, area: float) -> tuple[float, float]:
    """Unit direction A to B: A's outward normal integrated over its arcs is the chord turned by -90 degrees.

    (0, 0) where the chord is nothing: one outline inside the other, or two bars crossed.
    """
    length = math.sqrt(chord_x * chord_x + chord_y * chord_y)
    if length <= NO_CHORD * math.sqrt(area):
        return 0.0, 0.0
    return chord_y / length, -chord_x / length


@kernel(inline="always")
def _impact(
    r: Any,
    elastic: float,
    elasticity: float,
    speed: float,
    coming: float,
    inverse: float,
    dt: float,
    born: bool,
) -> float:
    """Normal force of an impact; what the region remembers of it is brought up to date.

    While closing, F = f (1 + a speed) with the a that in free flight returns `elasticity` exactly, whatever f
    (design 2.4). While opening, F = f (1 - b), b such that the loss of the whole impact becomes (1 - e^2) of the
    kinetic energy at first touch: the same restitution again, but also where gravity, or anything else, acts during
    the impact (the plain law then returns up to 0.25 less, the softer the contact).

    An impact shorter than the step has no course, only a result: the impulse that returns e of the speed at touch,
    all at once, and leaves the rest of the step to whatever else acts.
    """
    if r.sudden:
        if r.opened:
            return 0.0
        # Speed at touch and speed now (positions are those of the step's middle) differ by what the rest of the world
        # does over the depth; so do the two on the way out, and the energy of the way in and out is kept.
        gained = coming - speed
        fallen = 2.0 * (gained / dt) * min(r.depth, dt * speed) if born else 0.0
        if born:
            r.first_speed = math.sqrt(max(0.0, (speed + 0.5 * gained) ** 2 - fallen))
        out2 = (min(1.0, elasticity) * r.first_speed) ** 2 + fallen
        leaving = min(0.0, 0.5 * gained - math.sqrt(max(0.0, out2)))
        return max(0.0, (coming - leaving) / (dt * inverse))
    # The step of first touch is spent in touch for a part only, and so is the one that will end it: with
    # (1 + part) / 2 of the force there symplectic Euler's energy is the same before and after.
    depth = r.area / r.chord
    if r.opened:
        force = elastic * (1.0 - r.withheld)
        leaving = dt * (dt * force * inverse - speed)
        if depth < leaving:
            force *= 0.5 * (1.0 + depth / leaving)
        return force
    if born and depth < dt * speed:
        elastic *= 0.5 * (1.0 + depth / (dt * speed))
    force = max(0.0, elastic * (1.0 + r.damping * speed) / (1.0 + 0.5 * dt * elastic * r.damping * inverse))
    # damping slows down, it never turns the speed round within a step
    force = min(force, max(elastic, speed / (dt * inverse)))
    r.elastic = elastic
    r.excess = force - elastic
    return force


@kernel(inline="always")
def _remember(
    r: Any, elasticity: float, speed: float, inverse: float, rest_speed: float, dt: float, born: bool
) -> None:
    """Bring up to date what a region knows of its impact, and whether it is one."""
    if born:
        r.first_speed = speed
        r.spring = 0.0
        r.tangent_stiffness = 0.0
        r.phase = 0.0
        r.opened = 0
        r.sudden = 0
        r.resting = 1 if speed <= rest_speed else 0
        r.damping = 0.0 if r.resting else restitution_damping(elasticity) / speed
        r.work = 0.0
        r.loss = 0.0
        r.slowed = 0.0
        r.lasted = 0.0
        r.late = 0.5 * dt - min(dt, r.depth / speed) if speed > 0.0 else 0.0
        r.withheld = 0.0
    r.phase += min(1.0, dt * math.sqrt(r.rate2))
    if not (born or r.opened):
        # what the last step's force did is now known: it acted while the speed went from the old to the present one
        moved = 0.5 * dt * (r.speed + speed)
        r.work += r.elastic * moved
        r.loss += r.excess * moved
        r.slowed += dt * (r.elastic + r.excess) * inverse
        r.lasted += dt
        if speed < 0.0:
            r.opened = 1
            # touch came within a step, whose speed is that of its middle: what else pushes has changed it since
            others = (speed - r.first_speed + r.slowed) / r.lasted if r.lasted > 0.0 else 0.0
            touch = r.first_speed + others * r.late
            energy = 0.5 * touch * touch / inverse
            missing = energy * (1.0 - min(1.0, elasticity) ** 2) - r.loss
            r.withheld = min(1.0, max(0.0, missing / r.work)) if r.work > 0.0 else 0.0
    if (r.opened and speed > 0.0) or r.phase > REST_PHASE:
        r.resting = 1


class Rest(NamedTuple):
    """Normal force, friction and couple of a contact at rest."""

    force: float
    friction: float
    couple: float


@kernel(inline="always")
def _capped(a11: float, a12: float, a22: float, b1: float, b2: float, friction: float) -> tuple[float, float]:
    """(force, friction) of the two equations a x = b, no pulling and none beyond Coulomb's cone."""
    det = a11 * a22 - a12 * a12
    force = (b1 * a22 - a12 * b2) / det
    tangential = (a11 * b2 - a12 * b1) / det
    if abs(tangential) > friction * force:
        slope = friction if tangential > 0.0 else -friction
        force = b1 / (a11 + slope * a12)
        tangential = slope * force
    if force <= 0.0:
        return 0.0, 0.0
    return force, tangential


@kernel
def _implicit_rest(
    r: Any, a: Motion, b: Motion, elastic: float, c: float, ct: float, friction: float, coming: float,
    sliding: float, turning: float, arms: Arms, inverse: float, inverse_t: float, dt: float,
) -> Rest:  # fmt: skip
    """A contact at rest whose springs are taken at the end of the step: all three of its forces at once.

    Each is F0 + c v', v' the velocity at the end of the step, v* - h W x of all three x: so (1/c + h W) x = F0/c + v*
    with the 3 x 3 inverse mass W of the two bodies in closing, sliding and turning. One after the other they would
    undo each other, the more the stiffer.
    """
    ia = a.inverse_moment
    ib = b.inverse_moment
    a11 = 1.0 / c + dt * inverse
    a22 = 1.0 / ct + dt * inverse_t
    a12 = dt * (ia * arms.arm_a * arms.lean_a + ib * arms.arm_b * arms.lean_b) if friction > 0.0 else 0.0
    b1 = elastic / c + coming
    b2 = r.spring / ct + sliding if friction > 0.0 else 0.0
    bed = c * r.straight**3 / (12.0 * r.chord)
    if bed == 0.0:
        force, tangential = _capped(a11, a12, a22, b1, b2, friction)
        return Rest(force, tangential, 0.0)
    a13 = dt * (ia * arms.arm_a + ib * arms.arm_b)
    a23 = dt * (ia * arms.lean_a + ib * arms.lean_b) if friction > 0.0 else 0.0
    a33 = 1.0 / bed + dt * (ia + ib)
    force, tangential = _capped(
        a11 - a13 * a13 / a33, a12 - a13 * a23 / a33, a22 - a23 * a23 / a33,
        b1 - a13 * turning / a33, b2 - a23 * turning / a33, friction,
    )  # fmt: skip
    couple = (turning - a13 * force - a23 * tangential) / a33
    most = force * r.chord / 3.0  # the point of application may be L/6 off the middle, the resultant L/2
    if abs(couple) > most:
        couple = min(most, max(-most, couple))
        force, tangential = _capped(a11, a12, a22, b1 - a13 * couple, b2 - a23 * couple, friction)
        most = force * r.chord / 3.0
        couple = min(most, max(-most, couple))
    return Rest(force, tangential, couple)


@kernel
def region_force(
    r: Any, law: Law, a: Motion, b: Motion, friction: float, elasticity: float,
    surface_x: float, surface_y: float, dt: float, born: bool,
) -> Pull:  # fmt: skip
    """Force of region r (one REGION record: area, x, y, nx, ny, chord set; its memory is brought up to date).

    Impacts: see `_impact`. Rest: a bed of springs with dashpots beside them: a resultant along n, and, where the
    boundaries are straight, a moment against the turning of one face on the other (else a box rocks on its face for
    ever). Not where they are curved: a bed of dashpots would brake a rolling disc, as a damped foundation does, and
    no user expects that.

    The closing speed within a step is the one in the middle of the step for impacts and the one at its end for
    resting dashpots, as far as this region's own force changes it: no damping is then too strong for the step.

    Contacts too stiff for the step, (w h)^2 > `law.followed`. An impact becomes an impulse. At rest springs are taken
    at the end of the step, in part or, the stiffer, in whole (theta = 1 - (followed / (w h)^2)^2, `_implicit_rest`):
    no stiffness is then too high. That needs the speeds that the rest of the world will give the bodies in this step
    (`Motion.ax`), and so contacts are met one after the other, each with the force of those before it: Gauss and
    Seidel's way, once a step. In a crowd of bodies once is not enough: there k is lowered to what the step can
    follow, for all contacts of a body alike, so that a face feels no seam.
    """
    nx = r.nx
    ny = r.ny
    rax = r.x - a.x
    ray = r.y - a.y
    rbx = r.x - b.x
    rby = r.y - b.y
    ux = (a.vx - a.w * ray) - (b.vx - b.w * rby)
    uy = (a.vy + a.w * rax) - (b.vy + b.w * rbx)
    speed = ux * nx + uy * ny
    slip = -ux * ny + uy * nx - (-surface_x * ny + surface_y * nx)
    # what the rest of the world adds to the relative velocity in this step
    gx = dt * ((a.ax - a.aw * ray) - (b.ax - b.aw * rby))
    gy = dt * ((a.ay + a.aw * rax) - (b.ay + b.aw * rbx))
    coming = speed + gx * nx + gy * ny
    arm_a = rax * ny - ray * nx
    arm_b = rbx * ny - rby * nx
    inverse_masses = a.inverse_mass + b.inverse_mass
    inverse_moments = a.inverse_moment + b.inverse_moment
    inverse = inverse_masses + arm_a * arm_a * a.inverse_moment + arm_b * arm_b * b.inverse_moment

    if law.law == LAW_AREA:
        elastic = law.stiffness * r.area
        stiffness = law.stiffness * r.chord
    else:
        elastic = law.stiffness * r.area * r.chord / law.length
        stiffness = law.stiffness * r.chord * r.chord / law.length
    r.rate2 = stiffness * inverse
    phase2 = r.rate2 * dt * dt
    stretched = 0.0 if phase2 <= law.followed else dt * (1.0 - (law.followed / phase2) ** 2)  # theta h

    rest_speed = law.rest_speed
    if stretched > 0.0:  # at rest is also what the world presses together within a step
        rest_speed = max(rest_speed, 2.0 * (coming - speed))
    _remember(r, elasticity, speed, inverse, rest_speed, dt, born)
    if stretched > 0.0 and not r.resting:
        r.sudden = 1
    if stretched > 0.0 and not r.alone:
        stretched = 0.0
        stiffest = max(phase2, r.crowd * dt * dt)
        if r.resting and stiffest > CROWDED * law.followed:
            softer = CROWDED * law.followed / stiffest
            elastic *= softer
            stiffness *= softer
            elasticity = 0.0  # a spring of our own making must not swing

    lean_a = rax * nx + ray * ny
    lean_b = rbx * nx + rby * ny
    if r.sudden:  # what slid was the surfaces, not the middle of the overlap
        lean_a += r.beyond
        lean_b -= r.depth - r.beyond
        slip += a.w * r.beyond + b.w * (r.depth - r.beyond)
    inverse_t = inverse_masses + lean_a * lean_a * a.inverse_moment + lean_b * lean_b * b.inverse_moment
    kt = TANGENT_STIFFNESS * stiffness
    ct = 0.0
    if friction > 0.0:
        # the spring remembers a force; where the region shrinks the force shrinks with it, so no energy comes free
        if kt < r.tangent_stiffness:
            r.spring *= kt / r.tangent_stiffness
        r.tangent_stiffness = kt
        r.spring += kt * slip * dt
        ct = 2.0 * math.sqrt(kt / inverse_t) if inverse_t > 0.0 else 0.0
    c = 2.0 * damping_ratio(elasticity) * math.sqrt(stiffness / inverse)
    tangential = 0.0
    couple = 0.0
    if r.resting and stretched > 0.0:
        if not r.curved:
            stretched += SLOW * dt
        force, tangential, couple = _implicit_rest(
            r, a, b, elastic, c + stiffness * stretched, ct + kt * stretched, friction, coming,
            slip + gy * nx - gx * ny, a.w - b.w + dt * (a.aw - b.aw), Arms(arm_a, lean_a, arm_b, lean_b),
            inverse, inverse_t, dt,
        )  # fmt: skip
        most = friction * force
        r.spring = min(most, max(-most, r.spring))
    else:
        if r.resting:
            force = max(0.0, elastic + c * speed / (1.0 + dt * c * inverse))
            bed = c * r.straight**3 / (12.0 * r.chord)
            couple = bed * (a.w - b.w) / (1.0 + dt * bed * inverse_moments)
            most = force * r.chord / 6.0  # more would need the pressure to pull at one end
            couple = min(most, max(-most, couple))
        else:
            force = _impact(r, elastic, elasticity, speed, coming, inverse, dt, born)
        if friction > 0.0:
            most = friction * force
            r.spring = min(most, max(-most, r.spring))
            tangential = r.spring + ct * slip / (1.0 + dt * ct * inverse_t)
            tangential = min(most, max(-most, tangential))
    r.force = force
    r.friction = tangential
    r.couple = couple
    r.speed = speed
    r.slip = slip
    fx = force * nx - tangential * ny
    fy = force * ny + tangential * nx
    moment_a = -(rax * fy - ray * fx) - couple
    moment_b = rbx * fy - rby * fx + couple
    if r.sudden:
        moment_a -= tangential * r.beyond
        moment_b -= tangential * (r.depth - r.beyond)
    return Pull(fx, fy, moment_a, moment_b)
