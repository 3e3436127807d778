"""A rough ring hung on a peg rolls round it: a pendulum with an exact period."""

import math

from ...shapes import ring as annulus
from ..scene import Body, Circle, Curve, Scene, full_circle
from .bowl_slide_scene import path_error, period, swing

INNER, OUTER, PEG, START, MU = 0.5, 0.6, 0.3, math.radians(30), 0.8
RHO = INNER - PEG
GYRATION2 = (INNER**2 + OUTER**2) / 2
"""Squared radius of gyration of an annulus."""
LENGTH = RHO * (1 + GYRATION2 / INNER**2)
"""Length of the equal pendulum: the centre moves with ρ φ', the ring turns with ρ φ'/R."""


def ring() -> Curve:
    """The annulus."""
    return Curve(
        lambda tolerance: (full_circle(OUTER, tolerance), full_circle(INNER, tolerance)),
        exact=lambda: annulus(INNER, OUTER),
    )


def scene() -> Scene:
    """Ring 0.5–0.6 m on a peg of 0.3 m, from 30 degrees, two periods; rolling needs μ >= 0.35."""
    start = (RHO * math.sin(START), -RHO * math.cos(START))
    peg = Body("peg", (Circle(PEG),), kind="static")
    return Scene(
        title="ring rolling on a peg",
        bodies=(peg, Body("ring", (ring(),), start, moment=GYRATION2)),
        friction=MU,
        duration=2 * period(LENGTH, START),
        error_name="position over two periods / arc",
        error=lambda trace: path_error(trace, "ring", RHO, swing(trace.times, LENGTH, START)),
        source="rolling pendulum of length ρ (1 + I/(m R²)), ρ = R − r",
        size=2 * OUTER,
        tags=frozenset({"curved", "concave", "friction", "rolling"}),
    )
