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
from typing import Any

from .impact import damping_ratio, impact_force, remember_impact
from .jit import kernel
from .region import LAW_AREA, Law, Motion, Pull
from .rest import Arms, implicit_rest

#: Tangential over normal stiffness of a region (Cundall & Strack 1979 leave it free; 2/7 is usual: below the value
#: at which a rolling disc's tangential period equals its normal one).
TANGENT_STIFFNESS = 2.0 / 7.0
#: In a crowd: the sum of (w h)^2 over a body's contacts that a step follows, over `region.FOLLOWED`.
CROWDED = 4.0
#: Time in which faces at rest part again when a step has pressed them together too far, in steps: they must not jump.
SLOW = 4.0


@kernel
def region_force(
    r: Any, law: Law, a: Motion, b: Motion, friction: float, elasticity: float,
    surface_x: float, surface_y: float, dt: float, born: bool,
) -> Pull:  # fmt: skip
    """Force of region r (one REGION record: area, x, y, nx, ny, chord set; its memory is brought up to date).

    Impacts: see `impact.impact_force`. Rest: a bed of springs with dashpots beside them: a resultant along n, and,
    where the boundaries are straight, a moment against the turning of one face on the other (else a box rocks on its
    face for ever). Not where they are curved: a bed of dashpots would brake a rolling disc, as a damped foundation
    does, and no user expects that.

    The closing speed within a step is the one in the middle of the step for impacts and the one at its end for
    resting dashpots, as far as this region's own force changes it: no damping is then too strong for the step.

    Contacts too stiff for the step, (w h)^2 > `law.followed`. An impact becomes an impulse. At rest springs are taken
    at the end of the step, in part or, the stiffer, in whole (theta = 1 - (followed / (w h)^2)^2, `implicit_rest`):
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
    remember_impact(r, elasticity, speed, inverse, rest_speed, dt, born)
    if born:
        r.inside = r.inside and r.depth > 4.0 * dt * (math.sqrt(ux * ux + uy * uy) + abs(coming - speed))
    if r.inside:
        r.resting = 1
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
        force, tangential, couple = implicit_rest(
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
            force = impact_force(r, elastic, elasticity, speed, coming, inverse, dt, born)
        if friction > 0.0:
            most = friction * force
            r.spring = min(most, max(-most, r.spring))
            tangential = r.spring + ct * slip / (1.0 + dt * ct * inverse_t)
            tangential = min(most, max(-most, tangential))
    if r.inside and coming > speed:
        # Put there, not come there: let out, not shot out, no faster than what falls four depths.
        leaving = math.sqrt(8.0 * (coming - speed) / dt * r.area / r.chord)
        most = (coming + leaving) / (dt * inverse)
        if force > 0.0 and force > most:
            share = max(0.0, most) / force
            force *= share
            tangential *= share
            couple *= share
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
