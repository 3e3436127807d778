"""A disc spinning in a rough V-groove slows at a rate that weighs both normal forces."""

import math

import numpy as np

from ...geometry.outline import Outline
from ..scene import OMEGA, Body, Curve, G, Scene, Trace, disc

RADIUS, MU, SPIN, PHI = 0.5, 0.2, 20.0, math.radians(45)
"""PHI: each wall's normal is that far from the vertical."""


def normal_forces() -> tuple[float, float]:
    """N₁ (left wall) and N₂ (right wall) of a disc of unit mass that spins counter-clockwise and stays in
    place.

    Friction μ N acts along each wall, clockwise about the disc. With normals (±sin φ, cos φ):
    (N₁ − N₂) sin φ = μ (N₁ + N₂) cos φ and (N₁ + N₂) cos φ + μ (N₁ − N₂) sin φ = m g.
    """
    total = G / (math.cos(PHI) * (1 + MU**2))
    difference = MU * total / math.tan(PHI)
    return (total + difference) / 2, (total - difference) / 2


def deceleration() -> float:
    """α = μ (N₁ + N₂) r/I with I = m r²/2."""
    return MU * sum(normal_forces()) * 2 / RADIUS


def error(trace: Trace) -> float:
    """Largest error of the spin, relative to its first value."""
    exact = SPIN - deceleration() * trace.times
    return float(np.max(np.abs(trace["disc"][:, OMEGA] - exact)) / SPIN)


def groove() -> Body:
    """A static block with a V-shaped notch whose bottom is the origin; walls along the normals (±sin φ, cos φ)."""
    half, depth = 2.0, 1.0
    rise = half * math.tan(PHI)
    points = np.array([(0.0, 0.0), (-half, rise), (-half, -depth), (half, -depth), (half, rise)])
    return Body("groove", (Curve(lambda _: (points,), exact=lambda: Outline(points)),), kind="static")


def scene() -> Scene:
    """90-degree groove, μ = 0.2, from 20 rad/s; ends before the disc stops."""
    return Scene(
        title="disc spinning in a V-groove",
        bodies=(groove(), disc("disc", RADIUS, (0.0, RADIUS / math.cos(PHI)), angular_velocity=SPIN)),
        friction=MU,
        duration=1.5,
        error_name="spin, relative",
        error=error,
        source="statics of a sliding disc in a groove; μ = 0 gives N = m g/(2 cos φ)",
        tags=frozenset({"friction", "concave"}),
    )
