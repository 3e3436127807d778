"""Reference solutions of ordinary differential equations, to twelve digits (Hairer's DOP853)."""

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from ..scene import Array, G

Rates = Callable[[float, Array], Sequence[float]]


def _solve(rates: Rates, start: Sequence[float], end: float, **more: Any) -> Any:
    return solve_ivp(rates, (0.0, end), start, method="DOP853", rtol=1e-12, atol=1e-12, **more)


def angle(rates: Rates, start: float, t: Array) -> Array:
    """The first component at times `t` (n,) of a body at rest at `start`: y = (angle, its rate)."""
    found = _solve(rates, (start, 0.0), float(np.max(t)) or 1.0, t_eval=t)
    return np.asarray(found.y[0])


def slide_and_fly(rho: float, start: float, speed: float, leaving: float, t: Array) -> tuple[Array, float]:
    """Places (n, 2) at times `t` of a point that slides on a circle of radius `rho` about the origin, leaves it at the
    angle `leaving` and flies on; and the time of leaving.

    Angles from the lowest point; θ'' = −(g/ρ) sin θ on the circle, a parabola in the air.
    """

    def leaves(_: float, y: Array) -> float:
        return float(y[0] - leaving)

    leaves.terminal = True  # type: ignore[attr-defined]

    def rates(_: float, y: Array) -> tuple[float, float]:
        return y[1], -G / rho * math.sin(y[0])

    found = _solve(rates, (start, speed / rho), 10.0, events=leaves, dense_output=True)
    left = float(found.t_events[0][0])
    theta = found.sol(np.minimum(t, left))[0]
    place = rho * np.column_stack((np.sin(theta), -np.cos(theta)))
    velocity = rho * float(found.sol(left)[1]) * np.array((math.cos(leaving), math.sin(leaving)))
    flying = np.maximum(t - left, 0.0)[:, None]
    return place + flying * velocity - np.array((0.0, G / 2)) * flying**2, left
