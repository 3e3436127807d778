"""A smooth rod falls on a smooth floor: its centre goes straight down."""

import math

import numpy as np

from ..scene import ANGLE, Array, Body, G, Polygon, Scene, Trace, X, floor
from ._motion import angle
from .ladder_scene import LENGTH, THICK, moment

START = math.radians(70)
H = LENGTH / 2


def angle_at(t: Array) -> Array:
    """Angle above the floor at times `t`: (I + m h² cos² θ) θ'' = m h² θ'² sin θ cos θ − m g h cos θ."""
    inertia = moment(1.0)

    def rates(_: float, y: Array) -> tuple[float, float]:
        s, c = math.sin(y[0]), math.cos(y[0])
        return y[1], (H**2 * y[1] ** 2 * s * c - G * H * c) / (inertia + H**2 * c * c)

    return angle(rates, START, t)


def error(trace: Trace) -> float:
    """Largest error of the angle (relative to the angle turned) or sideways drift (relative to the length)."""
    exact = angle_at(trace.times)
    rod = trace["rod"]
    turn = np.max(np.abs(rod[:, ANGLE] - exact)) / (exact[0] - exact[-1])
    drift = np.max(np.abs(rod[:, X] - rod[0, X])) / LENGTH
    return float(max(turn, drift))


def scene() -> Scene:
    """2 m, released at 70 degrees; stops before it lands."""
    shape = Polygon(((-H, 0.0), (0.0, -THICK / 2), (H, 0.0), (0.0, THICK / 2)))
    rod = Body("rod", (shape,), (0.0, H * math.sin(START)), START, moment=moment(1.0))
    return Scene(
        title="rod falling on a smooth floor",
        bodies=(floor(), rod),
        duration=0.5,
        error_name="angle, relative",
        error=error,
        source="energy with y = h sin θ: (I + m h² cos² θ) θ'² = 2 m g h (sin θ₀ − sin θ)",
        size=LENGTH,
        tags=frozenset({"corner"}),
    )
