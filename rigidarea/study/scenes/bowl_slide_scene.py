"""A smooth disc slides to and fro in a circular bowl: an exact pendulum of length R − r."""

import math

import numpy as np
from scipy.special import ellipj, ellipk

from ...geometry.outline import Outline
from ..scene import Body, Curve, G, Rings, Scene, Trace, arc, disc, place_error

BOWL, RADIUS, START = 2.0, 0.2, math.radians(60)
RHO = BOWL - RADIUS


def period(length: float, amplitude: float) -> float:
    """Exact period 4 sqrt(l/g) K(sin²(θ₀/2)) of a pendulum of `length` (DLMF 22.19)."""
    return float(4 * math.sqrt(length / G) * ellipk(math.sin(amplitude / 2) ** 2))


def swing(t: np.ndarray, length: float, amplitude: float) -> np.ndarray:
    """Angle (radians) at times t of a pendulum of that length, released at rest at `amplitude`.

    sin(θ/2) = k cd(ω t, k), k = sin(θ₀/2) (DLMF 22.19.2).
    """
    k = math.sin(amplitude / 2)
    _, cn, dn, _ = ellipj(math.sqrt(G / length) * np.asarray(t), k * k)
    return 2 * np.arcsin(k * cn / dn)


def bowl() -> Body:
    """The static bowl: a half-round trough in a solid block, centre of curvature at the origin."""
    wall = 1.25 * BOWL
    block = [(-wall, 0.0), (-wall, -wall), (wall, -wall), (wall, 0.0)]

    def rings(tolerance: float) -> Rings:
        # clockwise seen from the solid below: right rim to left rim
        return (np.vstack((block, arc(BOWL, 0.0, -math.pi, tolerance))),)

    def exact() -> Outline:
        corners = [(*point, 0.0) for point in block]
        return Outline.from_bulges([*corners, (BOWL, 0.0, -1.0), (-BOWL, 0.0, 0.0)])

    return Body("bowl", (Curve(rings, exact=exact),), kind="static")


def path_error(trace: Trace, name: str, rho: float, angle: np.ndarray) -> float:
    """Largest distance from the exact place rho (sin θ, −cos θ), relative to the arc rho θ₀."""
    exact = rho * np.column_stack((np.sin(angle), -np.cos(angle)))
    return place_error(trace[name], exact, rho * abs(angle[0]))


def scene() -> Scene:
    """R = 2 m, r = 0.2 m, released at 60 degrees, two periods, no friction."""
    start = (RHO * math.sin(START), -RHO * math.cos(START))
    return Scene(
        title="smooth disc in a bowl",
        bodies=(bowl(), disc("disc", RADIUS, start)),
        duration=2 * period(RHO, START),
        error_name="position over two periods / arc",
        error=lambda trace: path_error(trace, "disc", RHO, swing(trace.times, RHO, START)),
        source="pendulum of length ρ = R − r: T = 4 sqrt(ρ/g) K(sin²(θ₀/2))",
        size=2 * RADIUS,
        tags=frozenset({"curved", "concave"}),
    )
