"""Two involute gears turn at a constant ratio."""

import math
from functools import cache
from typing import Any

import numpy as np

from ...geometry.outline import Outline
from ...shapes import involute_gear
from ..scene import OMEGA, Body, Curve, Elastic, Hinge, Scene, Trace

TEETH, MODULE, BACKLASH = (20, 30), 0.05, 0.02
"""Backlash in modules, half of it cut from each gear."""
SPEED, BRAKE, MASS = 2.0, 5.0, 5.0
"""Driver's speed (rad/s), the driven gear's brake (N m) and mass (kg)."""
STEEL = Elastic(207e9, 0.29, 0.01, 0.3 * MODULE)
RADII = tuple(MODULE * teeth / 2 for teeth in TEETH)


@cache
def gear(teeth: int, tolerance: float | None = None) -> Outline:
    """A gear of the pair. tolerance: largest sagitta of its flanks' chords (length)."""
    return involute_gear(MODULE, teeth, backlash=BACKLASH * MODULE / 2, tolerance=tolerance)


def _curve(teeth: int) -> Curve:
    return Curve(lambda tolerance: gear(teeth, tolerance).rings)


def error(trace: Trace) -> float:
    """Root mean square of the driven speed's error after a quarter of the run, relative to its exact value."""
    exact = -SPEED * TEETH[0] / TEETH[1]
    late = trace.times > trace.times[-1] / 4
    return float(np.sqrt(np.mean((trace["driven"][late, OMEGA] / exact - 1) ** 2)))


def scene() -> Scene:
    """20 and 30 teeth, module 50 mm, 2 rad/s; starts with working flanks touching and speeds exact."""
    # Centred in mesh, then turned against its own motion until the working flanks touch: half the backlash.
    centred = math.pi + math.pi / TEETH[1]
    touching = centred + BACKLASH * MODULE / 2 / RADII[1]
    curves = [_curve(teeth) for teeth in TEETH]
    driver = Body("driver", (curves[0],), angular_velocity=SPEED, mass=MASS, kind="kinematic", elastic=STEEL)
    inertia: dict[str, Any] = {"mass": MASS, "moment": gear(TEETH[1]).moment(MASS), "elastic": STEEL}
    place, speed = (RADII[0] + RADII[1], 0.0), -SPEED * TEETH[0] / TEETH[1]
    driven = Body("driven", (curves[1],), place, touching, angular_velocity=speed, **inertia)
    return Scene(
        title="involute gears, 20 : 30",
        bodies=(driver, driven),
        gravity=(0.0, 0.0),
        hinges=(Hinge("driven", "", place, BRAKE, turns=-1),),
        duration=2.0,
        error_name="rms error of ratio, relative",
        error=error,
        source="involutes: constant ratio z₁/z₂",
        size=MODULE,
        pressure=BRAKE / RADII[1] / MODULE**2,
        tags=frozenset({"curved", "conforming", "concave", "gears"}),
    )
