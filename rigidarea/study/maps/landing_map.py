"""A box lands on a corner, then flat: the stiffness of its contact grows with the chord."""

import math

import numpy as np

from ..atlas import Axis, Map, Outcome, Variant, engines, judge, run_scene
from ..scene import OMEGA, VX, VY, Array, G, Y, box_moment
from .corner_map import dropped

K, DROP = 1e4, 0.5
OMEGA_FLAT = math.sqrt(K * G)
"""ω of the box lying flat (unit box, k = K m g/s²)."""


def run(variant: Variant, x: float, y: float) -> Outcome:
    """Largest energy after the first touch over the energy before; `x` is ω h lying flat, `y` the tilt."""
    scene = dropped("landing", y, DROP, 0.5, 8 * x / OMEGA_FLAT)
    path = run_scene(variant, scene, K, steps=8)["box"]
    if not np.all(np.isfinite(path)):
        return "not finite", math.inf
    moving = path[:, VX] ** 2 + path[:, VY] ** 2 + box_moment(1.0, 1.0, 1.0) * path[:, OMEGA] ** 2
    energy = moving / 2 + G * path[:, Y]
    resting = path[-1, Y]
    if not 0.4 < resting < 0.8:
        return ("fell through" if resting <= 0.4 else "shot up"), float(np.max(energy) / energy[0])
    return judge(float(np.max(energy) / energy[0]), 1.05, "gained energy")


def theory() -> list[tuple[str, Array, Array]]:
    """ω h = 2, undamped."""
    return [("ω h = 2", np.array((2.0, 2.0)), np.array((0.0, 45.0)))]


def atlas_map() -> Map:
    """ω h of the flat box × tilt at landing."""
    return Map(
        title="contact length: a box lands on a corner, then flat",
        x=Axis(
            "ω h of the box lying flat",
            (0.1, 0.25, 0.5, 1.0, 1.4, 1.7, 2.0, 2.5, 3.0, 4.0),
            (0.25, 1.0, 1.7, 2.5, 4.0),
        ),
        y=Axis("tilt at landing (degrees)", (0.0, 1.0, 5.0, 15.0, 30.0, 45.0), (0.0, 5.0, 30.0)),
        measure="largest energy / first energy",
        limit=1.05,
        variants=engines(rigidarea={"peer": "rigidarea"}, box2d={"substeps": 1}),
        run=run,
        source="ω = sqrt(k L/m): the longest chord sets the step",
        theory=theory,
        theory_of=("explicit", "literal"),
    )
