"""A ball dropped on a floor rises to e^(2n) h after its n-th bounce."""

import math

import numpy as np

from ..scene import VY, G, Scene, Trace, Y, disc, floor

DROP, RADIUS, E, BOUNCES = 1.0, 0.25, 0.7, 3


def flight(n: int, drop: float = DROP, e: float = E) -> tuple[float, float]:
    """Start and end time of the flight after bounce n = 1, 2, …: sqrt(2 h/g) (1 + 2 Σ e^i)."""
    fall = math.sqrt(2 * drop / G)
    start = fall * (1 + 2 * sum(e**i for i in range(1, n)))
    return start, start + 2 * fall * e**n


def apex(trace: Trace, n: int, drop: float = DROP, e: float = E, radius: float = RADIUS) -> float:
    """Height above the floor that the ball reaches in flight n, from its energy in the middle half of the flight."""
    start, stop = flight(n, drop, e)
    quarter = (stop - start) / 4
    inside = (trace.times > start + quarter) & (trace.times < stop - quarter)
    ball = trace["ball"][inside]
    return float(np.mean(ball[:, Y] - radius + ball[:, VY] ** 2 / (2 * G)))


def error(trace: Trace) -> float:
    """Largest relative error of an apex."""
    return max(abs(apex(trace, n) / (DROP * E ** (2 * n)) - 1) for n in range(1, BOUNCES + 1))


def scene() -> Scene:
    """Drop 1 m, e = 0.7, three bounces."""
    start, stop = flight(BOUNCES)
    return Scene(
        title="ball bouncing, e = 0.7",
        bodies=(floor(), disc("ball", RADIUS, (0.0, RADIUS + DROP))),
        elasticity=E,
        duration=(start + 3 * stop) / 4,
        error_name="relative error of apex",
        error=error,
        source="Newton's restitution: v' = −e v, so h' = e² h",
        size=2 * RADIUS,
        pressure=2 * G * DROP / (2 * RADIUS) ** 3,  # m v²/s³
        tags=frozenset({"impact"}),
    )
