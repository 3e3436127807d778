"""A smooth disc thrown along the inside of a circle leaves it where gravity takes it off the wall."""

import math

import numpy as np

from ..scene import Body, G, Scene, Trace, disc, slab_with_hole

HOLE, RADIUS = 1.0, 0.1
RHO = HOLE - RADIUS
THROW = 3.5
"""v₀²/(g ρ) at the bottom: between 2 (it stays below the axis) and 5 (it goes all the way round)."""
SPEED = math.sqrt(THROW * G * RHO)


def leaving_angle() -> float:
    """Angle from the bottom at which N = 0: cos θ = (2 − v₀²/(g ρ))/3."""
    return math.acos((2 - THROW) / 3)


def motion(t: np.ndarray) -> tuple[np.ndarray, float]:
    """Places (n, 2) at times `t`, and the time of leaving.

    On the wall: θ'' = −(g/ρ) sin θ from θ = 0 with θ' = v₀/ρ. In the air: a parabola. Valid until the disc
    meets the wall again.
    """
    from scipy.integrate import solve_ivp

    angle = leaving_angle()

    def leaves(_: float, y: np.ndarray) -> float:
        return float(y[0] - angle)

    leaves.terminal = True  # type: ignore[attr-defined]
    found = solve_ivp(
        lambda _, y: (y[1], -G / RHO * math.sin(y[0])),
        (0.0, 10.0),
        (0.0, SPEED / RHO),
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
    place = RHO * np.column_stack((np.sin(theta), -np.cos(theta)))
    speed = math.sqrt(-G * RHO * math.cos(angle))  # N = 0: m v²/ρ = −m g cos θ
    flying = np.maximum(t - left, 0.0)[:, None]
    velocity = speed * np.array((math.cos(angle), math.sin(angle)))
    return place + flying * velocity - np.array((0.0, G / 2)) * flying**2, left


def error(trace: Trace) -> float:
    """Largest distance from the exact place, relative to ρ."""
    exact, _ = motion(trace.times)
    return float(np.max(np.linalg.norm(trace["disc"][:, :2] - exact, axis=1)) / RHO)


def scene() -> Scene:
    """v₀² = 3.5 g ρ: leaves the wall 120 degrees from the bottom; stops before the disc lands again."""
    ring = Body("ring", (slab_with_hole(HOLE, 1.5),), kind="static")
    return Scene(
        name="loop",
        title="smooth disc in a loop, leaving the wall",
        bodies=(ring, disc("disc", RADIUS, (0.0, -RHO), velocity=(SPEED, 0.0))),
        duration=0.85,
        error_name="position / path radius",
        error=error,
        source="energy and N = 0: cos θ = (2 − v₀²/(g ρ))/3",
        size=2 * RADIUS,
        pressure=THROW * G / (2 * RADIUS) ** 2,
        tags=frozenset({"curved", "concave"}),
    )
