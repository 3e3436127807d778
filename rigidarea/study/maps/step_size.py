"""A box resting on a floor: how large a step its contact bears."""

import math

import numpy as np

from ..atlas import Axis, Map, Outcome, Variant, engines, judge
from ..peers import get_peer
from ..scene import VY, Array, G, Scene, block, floor

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
    scene = Scene(
        name="step_size",
        title="",
        bodies=(floor(10.0), block("box", 1.0, 1.0, (0.0, 0.5 - sunk), velocity=(0.0, kick))),
        elasticity=elasticity,
        duration=1.0,
        error_name="",
        error=lambda trace: 0.0,
        source="",
        pressure=1.0,
        frame=phase / OMEGA,
    )
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
    """ω h at which symplectic Euler with a damped force goes unstable, the damping taken at the new velocity.

    With c = 2 ζ ω and the factor 1/(1 + h c) of an implicit dashpot: 4 − 2 h c' − (ω h)² = 0, h c' = h c/(1
    + h c). Explicit damping would give 2 (sqrt(1 + ζ²) − ζ).
    """
    from scipy.optimize import brentq

    def solve(z: float) -> float:
        return float(brentq(lambda p: 4 - 2 * (2 * z * p / (1 + 2 * z * p)) - p * p, 0.5, 2.0))

    return np.array([solve(float(z)) for z in zeta])


def theory() -> list[tuple[str, Array, Array]]:
    """The limit over the elasticity."""
    e = np.linspace(0.02, 1.0, 50)
    zeta = np.array([damping_ratio(float(value)) for value in e])
    explicit = 2 * (np.sqrt(1 + zeta**2) - zeta)
    return [("4 − 2hc′ − (ωh)² = 0", limit(zeta), e), ("explicit damping", explicit, e)]


def atlas_map() -> Map:
    """ω h × elasticity (e = 1: no damping)."""
    return Map(
        name="step_size",
        title="step size: a box resting on a floor",
        x=Axis(
            "ω h", tuple(np.round(np.arange(1.0, 2.41, 0.05), 3)), (1.2, 1.4, 1.6, 1.8, 1.9, 1.97, 2.03, 2.1)
        ),
        y=Axis("elasticity e", (0.02, 0.1, 0.2, 0.4, 0.6, 0.8, 0.9, 1.0), (0.1, 0.5, 1.0)),
        measure="log10 of the speed's growth in 3,000 steps",
        limit=2.0,
        variants=engines(rigidarea={"peer": "rigidarea"}, box2d={"substeps": 1})
        | {"explicit, energy law": Variant("rigidarea-explicit", {"law": "energy"})},
        run=run,
        source="symplectic Euler: ω h < 2 undamped",
        theory=theory,
        theory_of=("explicit", "literal", "explicit, energy law"),
    )
