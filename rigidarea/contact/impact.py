"""Impacts that the steps follow: how a region returns the restitution it is asked for (theory 5).

(One shorter than the step has no course, only a result: see `row.py`.)
"""

from __future__ import annotations

import math
from typing import Any

from ..compile.jit import entry, kernel
from .constants import LEAST_RESTITUTION, REST_DAMPING
from .tables import REST, SPENT


@kernel
def restitution_damping(e: float) -> float:
    """alpha = a v0 for which F = f(depth) (1 + a speed) returns exactly e v0, whatever f.

    m v dv/dx = -f (1 + a v) separates: both ways through the same integral of f give
    alpha (1 + e) = ln[(1 + alpha) / (1 - alpha e)] (theory 5). The right side minus the left is negative just
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


@entry
def damping_ratio(e: float) -> float:
    """Damping ratio of the linear spring and dashpot that returns e: 0 for e = 1, near REST_DAMPING for e = 0."""
    if e >= 1.0:
        return 0.0
    s = math.log(max(e, LEAST_RESTITUTION))
    return -REST_DAMPING * s / math.sqrt(math.pi * math.pi + s * s)


@kernel
def begin_impact(r: Any, elasticity: float, h: float) -> None:
    """A region that has just been touched, at `first_speed`."""
    r.damping = restitution_damping(elasticity) / r.first_speed
    r.work = 0.0
    r.loss = 0.0
    r.slowed = 0.0
    r.lasted = 0.0
    r.late = 0.5 * h - min(h, r.depth / r.first_speed)
    r.withheld = 0.0
    r.opened = 0


@kernel
def follow_impact(r: Any, elasticity: float, speed: float, inverse: float, h: float) -> None:
    """What the last substep's force did is now known: it acted while the speed went from the old to the present one.

    The law in free flight is exact; where gravity or anything else acts during the impact it would return up to 0.25
    less. So the energy is kept account of: what the opening must give back less is withheld from its force.
    """
    if r.opened:
        if (
            speed > 1e-9 * r.first_speed or r.withheld == 1.0
        ):  # its load is more than what it has to give back
            r.mode = REST
            r.placed = SPENT if r.withheld > 0.5 else 0
        return
    moved = 0.5 * h * (r.speed + speed)
    r.work += r.elastic * moved
    r.loss += r.excess * moved
    r.slowed += h * (r.elastic + r.excess) * inverse
    r.lasted += h
    if speed < 0.0:
        _open(r, elasticity, speed, inverse)


@kernel
def _open(r: Any, elasticity: float, speed: float, inverse: float) -> None:
    """From here on it opens: what must be withheld from its elastic force for it to return e."""
    r.opened = 1
    # touch came within a step, whose speed is that of its middle: what else pushes has changed it since
    others = (speed - r.first_speed + r.slowed) / r.lasted if r.lasted > 0.0 else 0.0
    touch = r.first_speed + others * r.late
    energy = 0.5 * touch * touch / inverse
    missing = energy * (1.0 - elasticity**2) - r.loss
    least = 0.0 if elasticity <= 1.0 else -math.inf  # above one it gives more than it took, as it is asked to
    r.withheld = min(1.0, max(least, missing / r.work)) if r.work > 0.0 else 0.0


@kernel
def impact_force(r: Any, elasticity: float, elastic: float, speed: float, inverse: float, h: float) -> float:
    """Normal force: f (1 + a speed) while closing, f (1 - b) while opening.

    The step of first touch is spent in touch for a part only, and so is the one that will end it: with (1 + part) / 2
    of the force there symplectic Euler's energy is the same before and after.
    """
    depth = r.area / r.chord
    if r.opened:
        force = elastic * (1.0 - r.withheld)
        leaving = h * (h * force * inverse - speed)
        if depth < leaving:
            force *= 0.5 * (1.0 + depth / leaving)
        return force
    if r.born and depth < h * speed:
        elastic *= 0.5 * (1.0 + depth / (h * speed))
    force = max(0.0, elastic * (1.0 + r.damping * speed) / (1.0 + 0.5 * h * elastic * r.damping * inverse))
    # damping slows down, it never turns the speed round within a step; nor is it less than nothing while closing
    force = min(force, max(elastic, speed / (h * inverse)))
    if speed >= 0.0:
        force = max(force, elastic)
    r.elastic = elastic
    r.excess = force - elastic
    stop = speed / (h * inverse)  # where it turns round within the step, the rest of it is opening already
    if elasticity != 1.0 and 0.0 <= stop <= force and speed > 0.0:
        moved = 0.5 * h * speed * stop / force
        r.work += elastic * moved
        r.loss += r.excess * moved
        _open(r, elasticity, speed, inverse)
        force = stop + (1.0 - stop / force) * elastic * (1.0 - r.withheld)
    return force
