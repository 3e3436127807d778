"""The stiffness that keeps a promise: under its own weight no body sinks by more than a part of its smallest extent.

Under n times that it sinks by sqrt(n) as much.
"""

from __future__ import annotations

import math
from typing import Any

from ..compile.jit import kernel
from .constants import CALM_LOAD_TIME, DEEPER, LOAD_TIME, PLACED_LOADS, RELEASE_STEPS, WEIGHTLESS_PHASE2
from .region import closing, growth, least_extent, put_closer, region_stiffness
from .tables import AWAKE, FIXED, FOLLOWS, LAW_AREA, LED, NEAR, Law, Tables


@kernel(forceinline=True)
def allowed_depth(law: Law, a: Any, b: Any) -> float:
    """How deep the two bodies may sink into each other (length): a fraction of the smaller one that can move."""
    return law.penetration * least_extent(a, b)


@kernel
def damping_that_opens(
    r: Any, a: Any, b: Any, pressed: float, elastic: float, inverse: float, h: float
) -> float:
    """The damping with which a contact opens, within a substep, as far as a program has put its bodies into each other.

    So that what is moved by its place, frame by frame, carries and pushes as if it had the velocity; what was there
    already opens as all does. pressed: the least that presses the two together; infinity: nothing has been put, or
    `elastic` is too little for it.
    """
    nearer = min(put_closer(r, a, b), r.depth)
    if nearer <= 0.0:
        return math.inf
    pressed = max(pressed, (closing(r, a, b, 0.0) - closing(r, a, b, 1.0)) / (h * inverse))
    opens = nearer + (r.depth - nearer) / (1.0 + RELEASE_STEPS)
    damping = (elastic - pressed) * h / opens - 1.0 / (h * inverse)
    return damping if damping > 0.0 else math.inf


@kernel
def depth_for(law: Law, pair: Any, r: Any, load: float) -> float:
    """The depth at which the region would carry `load`.

    Of a k that is given its area grows as depth^n (`growth`).
    """
    if load <= 0.0:
        return 0.0
    if law.stiffness == 0.0:
        return float(load / pair.rate)
    n = max(1.0, growth(r))
    force = law.stiffness * r.area
    if law.law != LAW_AREA:
        force *= r.chord / law.length
        n = 2.0 * n - 1.0
    return float(r.depth * (load / force) ** (1.0 / n))


@kernel
def choose_stiffness(law: Law, pair: Any, face: float, a: Any, b: Any, h: float) -> None:
    """The rate of a pair that touches for the first time: for the weight of the lighter body that can move.

    face: the chord on which it would lie (length).
    """
    pair.face = face
    pair.firm = 0.0
    if law.stiffness > 0.0:
        pair.rate = region_stiffness(law, law.stiffness, face)
        return
    depth = allowed_depth(law, a, b)
    acceleration = law.gravity if law.gravity > 0.0 else WEIGHTLESS_PHASE2 * depth / (h * h)
    pair.least = acceleration / max(a.inverse_mass, b.inverse_mass)
    pair.load = pair.least
    pair.rate = pair.least / depth


@kernel
def stiffness_of(law: Law, pair: Any, r: Any) -> float:
    """k of a region as it is now (force/length^2): what presses it to the depth allowed when the pair bears its load.

    k A is then the pair's rate times the mean thickness A / L of a face, times twice that of a corner: linear in the
    depth of either, so that neither the corner on which a body lands is too soft for it nor, a frame later, the face
    that comes down too hard. By the energy law, and of an explicit step, k is that of the face all along: only a k that
    does not follow the region's shape has a potential (theory 1).
    """
    if law.stiffness > 0.0:
        return float(law.stiffness)
    if law.law != LAW_AREA:
        return float(pair.rate / pair.face * law.length / pair.face)
    if law.followed == math.inf:
        return float(pair.rate / pair.face)
    n = growth(r)
    if r.chord > 0.0:
        part = r.straight / r.chord if n > 1.0 else 0.0
        return float((n + (1.0 - n) * part) * pair.rate / r.chord)
    return float(pair.rate * r.depth / r.area)


@kernel(forceinline=True)
def bear(pair: Any, dt: float, most: float, calm: bool) -> float:
    """Once a frame: the load that the pair bears (force), averaged over LOAD_TIME; 0 where nothing lies.

    calm: whether neither of its bodies moves much. most: no load that a stiffness follows is more (force). What is
    jammed between walls presses as far as it is stiff: that would be stiffer and stiffer, and one such pair makes a
    whole pile too unequal to be solved.
    """
    if pair.lies <= 0:
        return 0.0
    time = CALM_LOAD_TIME if calm else LOAD_TIME
    pair.load += dt / (dt + time) * (min(most, pair.carrying / dt) - pair.load)
    return float(max(pair.load, pair.least))


@kernel
def carry(pair: Any, load: float, now: float, depth: float) -> None:
    """Once a frame, after `bear`: the pair's rate after a load (force) no less than its own, at the depth allowed.

    That of the less loaded of its two bodies, not the pair's: where a body lies on several, each bears as much as it is
    stiff, and stiff as it bears they would share the load in any way at all, and go on sharing it anew. One whose k has
    a potential only stiffens: what it has stored it gives back.

    now: what it bears in this frame (force). Until the rate has grown to that, it resists sinking as if it had; and
    what goes beyond all that it may sink under (DEEPER) it resists wholly.
    """
    if pair.lies > 0:
        wanted = max(math.sqrt(load * pair.least), load / DEEPER) / depth
        if pair.lies == FOLLOWS or wanted > pair.rate:
            pair.rate = wanted
        pair.firm = max(math.sqrt(now * pair.least), now - DEEPER * pair.least) / depth
    pair.carrying = 0.0
    pair.lies = 0


@kernel
def adapt_stiffness(tables: Tables, law: Law, dt: float) -> None:
    """Once a frame, where the user gave none: each pair's stiffness follows the load that its bodies carry.

    Nobody carries more than what pushes everybody, together, but for who hangs in a joint or lies on a kinematic body:
    those may press harder. (What such a body whirls lies softer on one another than `penetration` says.)
    """
    if tables.counters[NEAR] == 0:
        return
    most = 0.0
    for k in range(tables.counters[AWAKE]):
        body = tables.bodies[tables.awake[k]]
        body.load = 0.0 if body.inverse_mass > 0.0 else math.inf
        if body.inverse_mass > 0.0:
            most += max(law.gravity, math.hypot(body.forced_x, body.forced_y)) / body.inverse_mass
    for i in range(tables.counters[NEAR]):
        near = tables.near[i]
        a = tables.bodies[near.a]
        b = tables.bodies[near.b]
        calm = (a.calm > 0 or a.kind == FIXED) and (b.calm > 0 or b.kind == FIXED)
        load = bear(tables.pairs[near.pair], dt, _most(a, b, most), calm)
        a.load = max(a.load, load)
        b.load = max(b.load, load)
    for i in range(tables.counters[NEAR]):
        near = tables.near[i]
        pair = tables.pairs[near.pair]
        a = tables.bodies[near.a]
        b = tables.bodies[near.b]
        now = min(_most(a, b, most), pair.carrying / dt)
        carry(pair, min(a.load, b.load), now, allowed_depth(law, a, b))


@kernel(forceinline=True)
def _most(a: Any, b: Any, most: float) -> float:
    """The most that a contact of two bodies may bear, where nobody who is free bears more than `most` (force)."""
    driven = (a.kind != FIXED and not a.mobile) or (b.kind != FIXED and not b.mobile)
    if a.kind == LED or b.kind == LED or a.calm < 0 or b.calm < 0:
        return math.inf
    return PLACED_LOADS * most if driven else most
