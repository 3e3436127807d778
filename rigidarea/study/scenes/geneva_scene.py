"""A Geneva drive indexes a wheel by a sixth of a turn."""

import math
from functools import cache
from typing import Any

import numpy as np

from ...shapes.geneva_wheel import Geneva
from ...shapes.geneva_wheel import geneva as make
from ..scene import ANGLE, Body, Circle, Curve, Elastic, Hinge, Scene, Trace

SLOTS, CENTRES, PIN = 6, 0.05, 0.008
SPEED, LEAD, MASS, BRAKE = math.pi, 0.3, 0.1, 2e-3
"""Driver's speed (rad/s); how far before entry and after exit it runs (rad); wheel's mass (kg); brake (N m)."""
STEEL = Elastic(207e9, 0.29, 0.005, 0.002)
"""Of the wheel."""


@cache
def drive(tolerance: float | None = None) -> Geneva:
    """The paper's drive (Table 3): six slots, centres 50 mm, pin 8 mm, clearance 0.01 mm."""
    return make(SLOTS, CENTRES, PIN, tolerance=tolerance)


def crank(t: np.ndarray) -> np.ndarray:
    """Crank angle at times `t`, 0 on the line of centres."""
    return SPEED * t - drive().entry_angle - LEAD


def wheel_angle(crank_angle: np.ndarray) -> np.ndarray:
    """Wheel angle relative to where it is locked first: tan ψ = λ sin φ/(1 − λ cos φ), λ = sin(π/n)."""
    ratio = math.sin(math.pi / SLOTS)
    inside = np.clip(crank_angle, -drive().entry_angle, drive().entry_angle)
    psi = np.arctan2(ratio * np.sin(inside), 1 - ratio * np.cos(inside))
    return -(psi + math.pi / SLOTS)


def error(trace: Trace) -> float:
    """Root mean square of the wheel's angle error, relative to the index angle."""
    found = trace["wheel"][:, ANGLE] - trace["wheel"][0, ANGLE]
    off = found - wheel_angle(crank(trace.times))
    return float(np.sqrt(np.mean(off**2)) / (2 * math.pi / SLOTS))


def scene() -> Scene:
    """Half a turn a second, from locked to locked; a brake keeps the wheel on the pin."""
    parts = drive()
    start = -parts.entry_angle - LEAD
    lock = Curve(lambda tolerance: drive(tolerance).locking_disc.rings, exact=lambda: drive().locking_disc)
    wheel = Curve(lambda tolerance: drive(tolerance).wheel.rings, exact=lambda: drive().wheel)
    pin, angle = Circle(PIN / 2, (parts.crank_radius, 0.0)), parts.wheel_angle(start)
    inertia: dict[str, Any] = {"mass": MASS, "moment": parts.wheel.moment(MASS), "elastic": STEEL}
    bodies = (
        Body("driver", (pin, lock), angle=start, angular_velocity=SPEED, kind="kinematic"),
        Body("wheel", (wheel,), (CENTRES, 0.0), angle, **inertia),
    )
    return Scene(
        title="Geneva drive, six slots",
        bodies=bodies,
        gravity=(0.0, 0.0),
        hinges=(Hinge("wheel", "", (CENTRES, 0.0), BRAKE, turns=-1),),
        duration=2 * (parts.entry_angle + LEAD) / SPEED,
        error_name="rms angle error / index angle",
        error=error,
        source="tan ψ = λ sin φ/(1 − λ cos φ), λ = sin(π/n)",
        size=CENTRES,
        pressure=BRAKE / CENTRES**3,
        frame=1 / 120,
        tags=frozenset({"curved", "conforming", "concave", "gears"}),
    )
