"""The stiffness that keeps a promise: no body sinks deeper than a fraction of its smallest extent under its load."""

from __future__ import annotations

from typing import Any

from .constants import LOAD_MEMORY, LOAD_TIME, STIFFNESS_CHANGE, WEIGHTLESS_PHASE2
from .jit import kernel
from .tables import LAW_AREA, STRUCK, Law


@kernel(inline="always")
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
def first_stiffness(law: Law, r: Any, a: Any, b: Any, h: float) -> float:
    """k of a pair that touches for the first time: for the weight of the lighter body that can move."""
    if law.stiffness > 0.0:
        return law.stiffness
    inverse = max(a.inverse_mass, b.inverse_mass)
    depth = allowed_depth(law, a, b)
    acceleration = max(law.gravity, WEIGHTLESS_PHASE2 * depth / (h * h) if law.gravity == 0.0 else 0.0)
    return stiffness_for(law, r, acceleration / inverse, depth)


@kernel
def carried(r: Any, force: float, h: float) -> None:
    """Remember what the region carries: its average, and for a while the largest that this has been."""
    if r.mode == STRUCK:
        return
    share = h / (h + LOAD_TIME)
    r.load += share * (force - r.load)
    r.peak = max(r.load, r.peak * (1.0 - h / (h + LOAD_MEMORY)))


@kernel
def adapted(law: Law, r: Any, k: float, a: Any, b: Any) -> float:
    """k for the load that the region has carried; never by more than STIFFNESS_CHANGE at a time."""
    depth = allowed_depth(law, a, b)
    wanted = stiffness_for(law, r, max(r.peak, law.gravity / max(a.inverse_mass, b.inverse_mass)), depth)
    return min(STIFFNESS_CHANGE * k, max(k / STIFFNESS_CHANGE, wanted))
