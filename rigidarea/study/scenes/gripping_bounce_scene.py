"""A disc hits a rough floor at a slant and grips: its rim has stopped when it leaves."""

from ..scene import Scene
from ._slant import slanted

RADIUS, E, MU = 1.0, 0.5, 0.8
V_T, V_N = 1.0, 3.0


def after() -> tuple[float, float, float]:
    """Velocities (vx, vy, ω) after the impact.

    Friction that brings the contact point to rest takes J_t = m_t v_t, with 1/m_t = 1/m + r²/I = 3/m (Routh); that is
    0.333 here, and friction could give μ J_n = μ m (1 + e) v_n = 3.6: the disc grips. A rigid floor has nothing to
    store tangential work in, so nothing of it comes back (no tangential restitution): v_x = (2/3) v_t, and
    ω = −r J_t/I = −(2/3) v_t/r, with which the rim's speed v_x + r ω is 0.
    """
    grip = V_T / 3
    assert grip < MU * (1 + E) * V_N
    return V_T - grip, E * V_N, -2 * grip / RADIUS


def scene() -> Scene:
    """No gravity; approach (1, −3) m/s, e = 0.5, μ = 0.8."""
    source = "Routh, impact with friction, sticking: J_t = v_t/(1/m + r²/I)"
    relative = "velocity after impact / tangential approach"
    title = "slanted bounce that grips"
    return slanted(title, source, relative, RADIUS, MU, E, (V_T, V_N), after(), V_T)
