"""Sampling against clearance: a smooth pin in a journal."""

import math

import numpy as np

from ..atlas import Axis, Map, Outcome, Variant, engines, judge, run_scene
from ..scene import Array, Body, G, Trace, disc, set_up, slab_with_hole
from ..scenes.bowl_slide_scene import path_error, period, swing

HOLE, START, LIMIT = 1.0, math.radians(60), 0.2


def run(variant: Variant, x: float, y: float) -> Outcome:
    """Error of the pin's path over one period, relative to its arc; `x` is the chord tolerance, `y` the clearance."""
    rho = y * HOLE
    body = Body("journal", (slab_with_hole(HOLE, 1.5),), kind="static")
    pin = disc("pin", HOLE - rho, (rho * math.sin(START), -rho * math.cos(START)))
    whole = period(rho, START)

    def error(trace: Trace) -> float:
        return path_error(trace, "pin", rho, swing(trace.times, rho, START))

    scene = set_up("clearance", (body, pin), whole, error, frame=whole / 40, pressure=G / y)
    return judge(scene.measure(run_scene(variant, scene, 1e3, sampling=x)), LIMIT, "wrong path")


def theory() -> list[tuple[str, Array, Array]]:
    """Sagitta = a hundredth of the clearance."""
    sagitta = np.logspace(-6, -2, 10)
    return [("sagitta = clearance / 100", sagitta, 100 * sagitta)]


def atlas_map() -> Map:
    """Chord tolerance × clearance."""
    return Map(
        title="sampling against clearance: a pin in a journal",
        x=Axis("sagitta / hole radius", (1e-6, 1e-5, 1e-4, 1e-3, 1e-2), (1e-5, 1e-4, 1e-3), log=True),
        y=Axis("clearance / hole radius", (1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3), (3e-3, 3e-2, 0.3), log=True),
        measure="error of the path / arc",
        limit=LIMIT,
        variants=engines(
            rigidarea={"peer": "rigidarea", "steps": 16},
            pymunk={"steps": 16},
            box2d={"steps": 4},
            literal={"spacing": 1.0},  # the chords are shorter
        ),
        run=run,
        source="pendulum of length ρ = R − r",
        theory=theory,
    )
