"""A heavy box on a light one: how many steps a frame that takes."""

from functools import partial

import numpy as np

from ..atlas import Axis, Map, Outcome, Variant, engines, judge, run_scene
from ..scene import Array, G, Scene, block, floor, rest_error, set_up

SINKING, LIMIT = 1e-3, 0.02
"""Allowed sinking under the heavy box (sides), from which rigidarea's stiffness; displacement that counts."""


def scene(ratio: float) -> Scene:
    """Unit boxes, masses 1 below and `ratio` above."""
    light, heavy = block("light", 1.0, 1.0, (0.0, 0.5)), block("heavy", 1.0, 1.0, (0.0, 1.5), mass=ratio)
    bodies = (floor(10.0), light, heavy)
    error = partial(rest_error, names=("light", "heavy"), size=1.0)
    return set_up("mass_ratio", bodies, 3.0, error, friction=0.5, pressure=ratio * G)


def run(variant: Variant, x: float, y: float) -> Outcome:
    """Displacement at the end of three seconds."""
    described = scene(x)
    trace = run_scene(variant, described, 1 / SINKING, steps=round(y))
    return judge(described.measure(trace), LIMIT, "sank or fell")


def theory() -> list[tuple[str, Array, Array]]:
    """ω h = 2 of the light box between two contacts: ω² = 2 k s/m (heavy box at rest)."""
    ratio = np.logspace(0, 4, 30)
    omega = np.sqrt(2 * ratio * G / SINKING)
    return [("ω h = 2, undamped", ratio, omega / 2 / 60)]


def atlas_map() -> Map:
    """Mass ratio × steps a frame."""
    steps = (1, 2, 4, 8, 16, 32, 64, 128, 256)
    return Map(
        title="mass ratio: a heavy box on a light one",
        x=Axis(
            "mass ratio",
            tuple(float(10**p) for p in np.arange(0, 4.1, 0.5)),
            (1, 10, 100, 1000, 1e4),
            log=True,
        ),
        y=Axis("steps a frame", steps, (1, 4, 16, 64, 256), log=True),
        measure="displacement / side",
        limit=LIMIT,
        variants=engines(rigidarea={"peer": "rigidarea"}, box2d={"substeps": 1, "stiff": True}),
        run=run,
        source="symplectic Euler: ω h < 2",
        theory=theory,
        theory_of=("explicit", "literal"),
    )
