"""A smooth disc slides off a round dome: it leaves at cos θ = (2/3) cos θ₀."""

import math

import numpy as np

from ..scene import Body, Circle, G, Scene, Trace, disc

DOME, RADIUS, START = 1.0, 0.2, 0.3
RHO = DOME + RADIUS


def motion(t: np.ndarray) -> tuple[np.ndarray, float]:
    """Places (n, 2) at times `t`, and the time of leaving: θ'' = (g/ρ) sin θ from rest, then a parabola."""
    from scipy.integrate import solve_ivp

    angle = math.acos(2 / 3 * math.cos(START))

    def leaves(_: float, y: np.ndarray) -> float:
        return float(y[0] - angle)

    leaves.terminal = True  # type: ignore[attr-defined]
    found = solve_ivp(
        lambda _, y: (y[1], G / RHO * math.sin(y[0])),
        (0.0, 10.0),
        (START, 0.0),
        method="DOP853",
        events=leaves,
        dense_output=True,
        rtol=1e-12,
        atol=1e-12,
    )
    events, path = found.t_events, found.sol
    assert events is not None and path is not None  # asked for above
    left = float(events[0][0])
    theta = path(np.minimum(t, left))[0]
    place = RHO * np.column_stack((np.sin(theta), np.cos(theta)))
    speed = math.sqrt(G * RHO * math.cos(angle))  # N = 0: m v²/ρ = m g cos θ
    flying = np.maximum(t - left, 0.0)[:, None]
    velocity = speed * np.array((math.cos(angle), -math.sin(angle)))
    return place + flying * velocity - np.array((0.0, G / 2)) * flying**2, left


def error(trace: Trace) -> float:
    """Largest distance from the exact place, relative to ρ."""
    exact, _ = motion(trace.times)
    return float(np.max(np.linalg.norm(trace["disc"][:, :2] - exact, axis=1)) / RHO)


def scene() -> Scene:
    """Released at rest 0.3 rad from the top; no friction."""
    dome = Body("dome", (Circle(DOME),), kind="static")
    start = (RHO * math.sin(START), RHO * math.cos(START))
    return Scene(
        name="dome",
        title="smooth disc sliding off a dome",
        bodies=(dome, disc("disc", RADIUS, start)),
        duration=1.1,
        error_name="position / path radius",
        error=error,
        source="energy and N = 0: cos θ = (2/3) cos θ₀",
        size=2 * RADIUS,
        pressure=G / (2 * RADIUS) ** 2,
        tags=frozenset({"curved"}),
    )
