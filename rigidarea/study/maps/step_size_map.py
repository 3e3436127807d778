"""A box resting on a floor: how large a step its contact bears."""

import math

import numpy as np

from ..atlas import Axis, Map, Outcome, Variant, engines, judge
from ..peers import get_peer
from ..scene import VY, Array, G, block, floor, set_up

STEPS, LAST, K = 3000, 50, 1e5
OMEGA = math.sqrt(K)
"""ω = sqrt(k L/m) of a unit box of unit mass."""


def damping_ratio(elasticity: float) -> float:
    """ζ of the linear spring and dashpot that give a body back `elasticity` (> 0) of its speed after half a swing."""
    loss = -math.log(elasticity)
    return loss / math.hypot(math.pi, loss)


def growth(phase: float, elasticity: float, variant: Variant) -> float:
    """Largest speed in the last fifty of 3,000 steps of ω h = `phase`, over the speed at the start.

    The box starts in equilibrium, with a velocity that moves it by a thousandth of its sinking: no contact is lost.
    Box2D gets a spring of the same ω; pymunk has none.
    """
    sunk = G / K
    kick = 1e-3 * sunk * OMEGA
    bodies = floor(10.0), block("box", 1.0, 1.0, (0.0, 0.5 - sunk), velocity=(0.0, kick))
    scene = set_up("step_size", bodies, 1.0, elasticity=elasticity, pressure=1.0, frame=phase / OMEGA)
    knob: dict[str, float] = {"stiffness": K, "rest_speed": 1e9}
    if variant.peer in ("pymunk", "box2d"):
        knob = {"hertz": OMEGA / (2 * math.pi)} if variant.peer == "box2d" else {}
    run = get_peer(variant.peer).build(scene, {**variant.settings, **knob, "steps": 1})
    run.advance(STEPS - LAST)
    speeds = []
    for _ in range(LAST):
        run.advance(1)
        speeds.append(abs(run.state()[1, VY]))
    found = float(np.max(speeds)) / kick
    return found if math.isfinite(found) else math.inf


def run(variant: Variant, x: float, y: float) -> Outcome:
    """Bounded (a hundredfold at most: at the limit itself it grows with the number of steps) or not."""
    return judge(math.log10(max(growth(x, y, variant), 1e-12)), 2.0, "unstable")


def limit(zeta: Array) -> Array:
    """ω h at which symplectic Euler with an implicit dashpot goes unstable: 2 (sqrt(1 + ζ²) + ζ).

    With c = 2 ζ ω, d = 1/(1 + h c) and (v, x) taken to (d (v − h ω² x), x + h v'), a step has the determinant d and the
    trace 1 + d − d (ω h)². Both its eigenvalues are within the unit circle while |trace| < 1 + d (Jury), that is
    (ω h)² < 2 (1 + d)/d = 4 + 4 ζ ω h. Damping therefore allows longer steps; a dashpot at the old velocity would
    allow shorter ones, 2 (sqrt(1 + ζ²) − ζ).
    """
    return np.asarray(2.0 * (np.sqrt(1.0 + zeta**2) + zeta), dtype=np.float64)


def theory() -> list[tuple[str, Array, Array]]:
    """The limit over the elasticity."""
    e = np.linspace(0.02, 1.0, 50)
    zeta = np.array([damping_ratio(float(value)) for value in e])
    explicit = 2 * (np.sqrt(1 + zeta**2) - zeta)
    return [("2 (√(1+ζ²) + ζ)", limit(zeta), e), ("dashpot at the old speed", explicit, e)]


def atlas_map() -> Map:
    """ω h × elasticity (e = 1: no damping)."""
    return Map(
        title="step size: a box resting on a floor",
        x=Axis(
            "ω h",
            tuple(np.round(np.arange(1.05, 4.36, 0.1), 3)),
            (1.25, 1.75, 1.95, 2.05, 2.45, 2.95, 3.45, 4.05),
        ),
        y=Axis("elasticity e", (0.02, 0.1, 0.2, 0.4, 0.6, 0.8, 0.9, 1.0), (0.1, 0.5, 1.0)),
        measure="log10 of the speed's growth in 3,000 steps",
        limit=2.0,
        variants=engines(rigidarea={"peer": "rigidarea"}, box2d={"substeps": 1})
        | {"explicit, energy law": Variant("rigidarea-explicit", {"law": "energy"})},
        run=run,
        source="symplectic Euler: ω h < 2 (√(1+ζ²) + ζ)",
        theory=theory,
        theory_of=("explicit", "literal", "explicit, energy law"),
    )
