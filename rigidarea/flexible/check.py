"""What a system of bodies must be before it is stepped: each check raises ValueError naming expected and actual."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidarea.flexible.joints import KINDS, Joint


def check_settings(
    k: float,
    q: float,
    contact: str,
    reach: float,
    margin: float,
    rho: float,
    gravity: tuple[float, float],
) -> None:
    """Contact law and scheme, see ``integrate.Simulation``."""
    if not 0.0 <= rho <= 1.0:
        raise ValueError(f"rho must lie in [0, 1], got {rho}")
    if contact not in ("area", "sts"):
        raise ValueError(f"contact must be 'area' or 'sts', got {contact!r}")
    if contact == "sts" and not 0 < reach < np.inf:
        raise ValueError(f"reach must be positive for STS, got {reach}")
    if not 0 < k < np.inf:
        raise ValueError(f"k must be positive and finite, got {k}")
    for name, value in (("q", q), ("margin", margin)):
        if not 0 <= value < np.inf:
            raise ValueError(f"{name} must be finite and not negative, got {value}")
    _vector("gravity", gravity, 2)


def check_pairs(pairs: Sequence[tuple[int, int]], bodies: int) -> NDArray[np.int64]:
    """The pairs (p, 2): whole numbers of two different bodies each, none twice."""
    given = np.asarray(pairs)
    if given.size == 0:
        return np.zeros((0, 2), np.int64)
    if given.ndim != 2 or given.shape[1] != 2 or not np.issubdtype(given.dtype, np.integer):
        raise ValueError(f"pairs must be whole numbers of shape (p, 2), got {pairs!r}")
    seen: dict[frozenset[int], int] = {}
    for n, (i, j) in enumerate(given.tolist()):
        if not (0 <= i < bodies and 0 <= j < bodies):
            raise ValueError(f"pair {n} must name bodies 0 … {bodies - 1}, got ({i}, {j})")
        if i == j:
            raise ValueError(f"pair {n} must name two different bodies, got ({i}, {j})")
        if frozenset((i, j)) in seen:
            raise ValueError(f"pair {n} must not repeat pair {seen[frozenset((i, j))]}, got ({i}, {j})")
        seen[frozenset((i, j))] = n
    return np.ascontiguousarray(given, np.int64)


def of_pairs(name: str, values: float | Sequence[float], pairs: int) -> NDArray[np.float64]:
    """One value a pair (p,) of one for all or one each: finite and not negative."""
    given = np.array(values, float)
    if given.shape not in ((), (pairs,)):
        raise ValueError(f"{name} must be a number or {pairs}, one a pair, got shape {given.shape}")
    if not (np.isfinite(given).all() and (given >= 0).all()):
        raise ValueError(f"{name} must be finite and not negative, got {values!r}")
    return np.ascontiguousarray(np.broadcast_to(given, (pairs,)).copy())


def check_joints(joints: Sequence[Joint], bodies: int) -> list[Joint]:
    """Joints of two different bodies of ``bodies``, or of the ground (a = -1) and one."""
    for n, j in enumerate(joints):
        if j.kind not in KINDS:
            raise ValueError(f"joint {n}: kind must be one of {KINDS}, got {j.kind!r}")
        if not (-1 <= j.a < bodies and 0 <= j.b < bodies and j.a != j.b):
            raise ValueError(
                f"joint {n} must tie two of the bodies 0 … {bodies - 1}, or -1, the ground, to one; got ({j.a}, {j.b})"
            )
        for name in ("at_a", "at_b", "axis"):
            _vector(f"joint {n}: {name}", getattr(j, name), 2)
        if not np.hypot(*j.axis) > 0:
            raise ValueError(f"joint {n}: axis must have a direction, got {j.axis}")
        if not np.isfinite(j.angle):
            raise ValueError(f"joint {n}: angle must be finite, got {j.angle}")
        for name in ("rest", "stiffness", "damping"):
            if not 0 <= getattr(j, name) < np.inf:
                raise ValueError(f"joint {n}: {name} must be finite and not negative, got {getattr(j, name)}")
    return list(joints)


def check_bodies(bodies: Sequence[Any], rho: float, constrained: bool = False) -> None:
    """Each ``integrate.Body``; ``rho`` of the scheme, which constraints (joints: ``constrained``) keep below 1."""
    if len(bodies) == 0:
        raise ValueError("a system needs at least 1 body, got 0")
    for i, b in enumerate(bodies):
        for name in ("mass", "inertia"):
            if not 0 < getattr(b, name) < np.inf:
                raise ValueError(f"body {i}: {name} must be positive and finite, got {getattr(b, name)}")
        for name in ("damping", "damper"):
            if not 0 <= getattr(b, name) < np.inf:
                raise ValueError(f"body {i}: {name} must be finite and not negative, got {getattr(b, name)}")
        for name, size in (("position", 2), ("hub", 2), ("anchor", 2), ("drive", 3), ("velocity", 3)):
            if getattr(b, name) is not None:
                _vector(f"body {i}: {name}", getattr(b, name), size)
        for name in ("angle", "torque"):
            if not np.isfinite(getattr(b, name)):
                raise ValueError(f"body {i}: {name} must be finite, got {getattr(b, name)}")
        if b.drive is not None and b.drive[2] < 0:
            raise ValueError(f"body {i}: drive's ramp time must not be negative, got {b.drive[2]}")
        if b.fixed and (b.anchor is not None or b.drive is not None):
            raise ValueError(f"body {i} is fixed: expected neither anchor nor drive")
        modes = b.boundary.modes.shape[1]
        for name, shape in (("frequency", (modes,)), ("stretch", (modes,)), ("coupling", (modes, modes))):
            if np.shape(getattr(b, name)) != shape:
                raise ValueError(
                    f"body {i}: expected {name} of shape {shape}, one for each of its boundary's modes, got"
                    f" {np.shape(getattr(b, name))}"
                )
    if rho == 1.0 and (constrained or any(b.anchor is not None or b.drive is not None for b in bodies)):
        raise ValueError("rho must be below 1 with constraints (index 3 is unstable at 1), got 1")


def _vector(name: str, value: Any, size: int) -> None:
    given = np.asarray(value, float)
    if given.shape != (size,) or not np.isfinite(given).all():
        raise ValueError(f"{name} must be {size} finite numbers, got {value!r}")
