"""A disc hits a rough floor at a slant and slides throughout the impact."""

from ..scene import OMEGA, VX, VY, Scene, Trace, disc, floor

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


def error(trace: Trace) -> float:
    """Largest velocity error (rim speed for the spin), relative to the approach speed."""
    vx, vy, omega = after()
    last = trace["ball"][-1]
    worst = max(abs(last[VX] - vx), abs(last[VY] - vy), RADIUS * abs(last[OMEGA] - omega))
    return worst / (V_T**2 + V_N**2) ** 0.5


def scene() -> Scene:
    """No gravity; approach (4, −3) m/s, e = 0.5, μ = 0.2."""
    ball = disc("ball", RADIUS, (0.0, RADIUS + 0.5), velocity=(V_T, -V_N))
    return Scene(
        title="slanted bounce with sliding friction",
        bodies=(floor(), ball),
        gravity=(0.0, 0.0),
        friction=MU,
        elasticity=E,
        duration=0.5,
        error_name="velocity after impact, relative",
        error=error,
        source="Routh, impact with friction, gross sliding: J_t = μ J_n",
        size=2 * RADIUS,
        pressure=V_N**2 / (2 * RADIUS) ** 3,
        tags=frozenset({"impact", "friction"}),
    )
