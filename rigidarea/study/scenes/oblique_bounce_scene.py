"""A disc hits a rough floor at a slant and slides throughout the impact."""

from ..scene import Scene
from ._slant import slanted

RADIUS, E, MU = 0.25, 0.5, 0.2
V_T, V_N = 4.0, 3.0


def after() -> tuple[float, float, float]:
    """Velocities (vx, vy, ω) after the impact.

    The normal impulse is m (1 + e) v_n; the disc slides throughout when μ (1 + e) v_n (1 + m r²/I) < v_t, so
    friction takes μ times that impulse (Routh's impact with friction; r²m/I = 2 for a disc).
    """
    impulse = (1 + E) * V_N
    assert 3 * MU * impulse < V_T
    return V_T - MU * impulse, E * V_N, -2 * MU * impulse / RADIUS


def scene() -> Scene:
    """No gravity; approach (4, −3) m/s, e = 0.5, μ = 0.2."""
    source = "Routh, impact with friction, gross sliding: J_t = μ J_n"
    title, speed = "slanted bounce with sliding friction", (V_T**2 + V_N**2) ** 0.5
    relative = "velocity after impact, relative"
    return slanted(title, source, relative, RADIUS, MU, E, (V_T, V_N), after(), speed)
