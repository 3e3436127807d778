"""An elastic pin dropped in its journal bounces back to where it was."""

import math

import numpy as np

from ..scene import Body, Elastic, G, Scene, Trace, disc, slab_with_hole

HOLE, PIN, BOUNCES = 1.0, 0.9, 3
CLEARANCE = HOLE - PIN
DROP = 0.3 * CLEARANCE
"""Below half the clearance, where bouncing along the axis is stable: |2 − 8 h/ρ| < 2 (a bouncer on a mirror
of radius ρ).
"""
PERIOD = 2 * math.sqrt(2 * DROP / G)
STEEL = Elastic(207e9, 0.29, 0.01, 0.05)
"""Of the pin."""


def height(t: np.ndarray) -> np.ndarray:
    """Height of the pin's centre at times `t`: parabolas of drop h and period 2 sqrt(2 h/g)."""
    since = (t + PERIOD / 2) % PERIOD - PERIOD / 2
    return DROP - CLEARANCE - G * since**2 / 2


def error(trace: Trace) -> float:
    """Largest distance from the exact place, relative to the drop."""
    pin = trace["pin"]
    return float(np.max(np.hypot(pin[:, 0], pin[:, 1] - height(trace.times))) / DROP)


def scene() -> Scene:
    """Clearance 0.1 m, pin 0.9 m, dropped 0.03 m, e = 1, three bounces; a compliant contact's duration
    counts as error.
    """
    journal = Body("journal", (slab_with_hole(HOLE, 1.5),), kind="static")
    return Scene(
        title="elastic pin in a journal",
        bodies=(journal, disc("pin", PIN, (0.0, DROP - CLEARANCE), elastic=STEEL)),
        elasticity=1.0,
        duration=BOUNCES * PERIOD,
        error_name="position over three bounces / drop",
        error=error,
        source="free fall: T = 2 sqrt(2 h/g) in the rigid limit",
        pressure=2 * G / (PIN * DROP),  # k s δ²/2 = m g h at δ = h
        frame=1 / 240,
        tags=frozenset({"curved", "conforming", "concave", "impact"}),
    )
