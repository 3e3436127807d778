"""Impacts: how a region returns the restitution it is asked for (design 2.4)."""

from __future__ import annotations

import math
from typing import Any

from .jit import kernel

#: Restitution below this is taken as this: the exact law needs a damping factor that grows as 1/e.
LEAST_RESTITUTION = 0.01
#: A contact that has lasted this many radians of its own natural motion is no impact any more, but rest.
REST_PHASE = 50.0


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


@kernel(inline="always")
def remember_impact(
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


@kernel(inline="always")
def impact_force(
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
