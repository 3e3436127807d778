"""The stiffness that keeps a promise: under its own weight no body sinks by more than a part of its smallest extent.

Under n times that it sinks by sqrt(n) as much.
"""

from __future__ import annotations

import math
from typing import Any

from .constants import DEEPER, LOAD_TIME, SOFTER, SPREAD, STIFFER, TOO_STIFF, WEIGHTLESS_PHASE2
from .jit import kernel
from .tables import AWAKE, LAW_AREA, LED, NEAR, Law, Tables


@kernel(forceinline=True)
def allowed_depth(law: Law, a: Any, b: Any) -> float:
    """How deep the two bodies may sink into each other (length): a fraction of the smaller one that can move."""
    if a.inverse_mass == 0.0:
        return law.penetration * b.extent
    if b.inverse_mass == 0.0:
        return law.penetration * a.extent
    return law.penetration * min(a.extent, b.extent)


@kernel
def stiffness_for(law: Law, r: Any, load: float, depth: float) -> float:
    """k (force/length^2) with which `load` presses the region to `depth`.

    Its area grows as depth^n with n = depth * chord / area, chord being dA/ddepth: 1 for a face, 3/2 for a disc on a
    plane, 2 for a corner.
    """
    n = min(2.0, max(1.0, r.depth * r.chord / r.area))
    area = r.area * (depth / r.depth) ** n
    if law.law != LAW_AREA:
        area *= r.chord * (depth / r.depth) ** (n - 1.0) / law.length
    return load / area


@kernel
def depth_for(law: Law, r: Any, k: float, load: float) -> float:
    """The depth at which the region would carry `load`: `stiffness_for` the other way round."""
    if load <= 0.0:
        return 0.0
    n = min(2.0, max(1.0, r.depth * r.chord / r.area))
    force = k * r.area
    if law.law != LAW_AREA:
        force *= r.chord / law.length
        n = 2.0 * n - 1.0
    return float(r.depth * (load / force) ** (1.0 / n))


@kernel
def choose_stiffness(law: Law, pair: Any, face: float, a: Any, b: Any, h: float) -> None:
    """The stiffness of a pair that touches for the first time: for the weight of the lighter body that can move.

    face: the chord on which it would lie (length). Not the one on which it has landed: k tuned on a corner is far too
    stiff for the face that comes down next (theory 3). What it rests on in the end, `carry` learns.
    """
    if law.stiffness > 0.0:
        pair.stiffness = law.stiffness
        return
    depth = allowed_depth(law, a, b)
    acceleration = law.gravity if law.gravity > 0.0 else WEIGHTLESS_PHASE2 * depth / (h * h)
    pair.least = acceleration / max(a.inverse_mass, b.inverse_mass)
    pair.load = pair.least
    pair.stiffness = pair.least / (depth * face)
    if law.law != LAW_AREA:
        pair.stiffness *= law.length / face


@kernel
def area_allowed(law: Law, r: Any, a: Any, b: Any) -> float:
    """The region's area (length^2; by the energy law weighted with chord / length) at the depth allowed.

    Of straight edges no less than if they met on a SPREAD of the smaller one's smallest extent: a corner's k would be
    a thousand times what is right for the face that comes down next, and what is that stiff keeps a pile awake.
    """
    depth = allowed_depth(law, a, b)
    area = 1.0 / stiffness_for(law, r, 1.0, depth)
    if r.straight > 0.0:
        spread = SPREAD * depth / law.penetration
        area = max(area, depth * spread if law.law == LAW_AREA else depth * spread * spread / law.length)
    return area


@kernel(forceinline=True)
def bear(pair: Any, dt: float, most: float) -> float:
    """Once a frame: the load that the pair bears (force), averaged over LOAD_TIME; 0 where nothing lies.

    most: no load that a stiffness follows is more (force). What is jammed between walls presses as far as it is stiff:
    that would be stiffer and stiffer, and one such pair makes a whole pile too unequal to be solved.
    """
    if pair.area <= 0.0 or pair.stiffness <= 0.0:
        return 0.0
    pair.load += dt / (dt + LOAD_TIME) * (pair.carrying / dt - pair.load)
    return float(max(min(most, pair.load), pair.least))


@kernel
def carry(pair: Any, load: float, dt: float, most: float) -> None:
    """Once a frame, after `bear`: the pair's stiffness after a load (force) no less than its own.

    That of the less loaded of its two bodies, not the pair's: where a body lies on several, each bears as much as it is
    stiff, and stiff as it bears they would share the load in any way at all, and go on sharing it anew.
    Too soft, it stiffens; far too stiff, it softens slowly, for every change moves what lies on it.
    """
    if pair.area > 0.0 and pair.stiffness > 0.0:
        pressed = pair.carrying / dt
        wanted = max(math.sqrt(load * pair.least), load / DEEPER) / pair.area
        pair.firm = max(wanted, min(most, pressed) / pair.area)
        k = pair.stiffness
        if wanted > k:
            pair.stiffness = STIFFER * k
        elif TOO_STIFF * wanted < k:
            pair.stiffness = k / SOFTER
    pair.carrying = 0.0
    pair.area = 0.0


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
            most += max(law.gravity, body.thrust / dt) / body.inverse_mass
    for i in range(tables.counters[NEAR]):
        pair = tables.pairs[tables.near[i].pair]
        a = tables.bodies[tables.shapes[pair.a].body]
        b = tables.bodies[tables.shapes[pair.b].body]
        load = bear(pair, dt, _most(a, b, most))
        a.load = max(a.load, load)
        b.load = max(b.load, load)
    for i in range(tables.counters[NEAR]):
        pair = tables.pairs[tables.near[i].pair]
        a = tables.bodies[tables.shapes[pair.a].body]
        b = tables.bodies[tables.shapes[pair.b].body]
        carry(pair, min(a.load, b.load), dt, _most(a, b, most))


@kernel(forceinline=True)
def _most(a: Any, b: Any, most: float) -> float:
    """The most that a contact of two bodies may bear, where nobody who is free bears more than `most` (force)."""
    return math.inf if a.kind == LED or b.kind == LED or a.calm < 0 or b.calm < 0 else most
