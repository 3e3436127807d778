"""What a system of bodies must be before it is stepped: each check raises ValueError naming expected and actual."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidarea.flexible.element import Material
from rigidarea.flexible.joints import KINDS, Joint
from rigidarea.gate import finite, listed, not_negative, numbers, positive, whole

#: Modes of a body, contact points a mesh edge: beyond so many a body would ask for gigabytes.
MOST = 10_000


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
    if not 0.0 <= finite(rho, "rho") <= 1.0:
        raise ValueError(f"rho must lie in [0, 1], got {rho}")
    if not isinstance(contact, str) or contact not in ("area", "sts"):
        raise ValueError(f"contact must be 'area' or 'sts', got {contact!r}")
    if contact == "sts" and not 0 < finite(reach, "reach"):
        raise ValueError(f"reach must be positive for STS, got {reach}")
    positive(k, "k")
    for name, value in (("q", q), ("margin", margin)):
        not_negative(value, name)
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
    try:
        given = np.array(values, float)
    except (TypeError, ValueError):
        raise ValueError(f"{name} must be a number or {pairs}, one a pair, got {values!r:.80}") from None
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
        for name in ("a", "b"):
            whole(getattr(j, name), f"joint {n}: {name}", -1)
        if not (-1 <= j.a < bodies and 0 <= j.b < bodies and j.a != j.b):
            raise ValueError(
                f"joint {n} must tie two of the bodies 0 … {bodies - 1}, or -1, the ground, to one; got ({j.a}, {j.b})"
            )
        for name in ("at_a", "at_b", "axis"):
            _vector(f"joint {n}: {name}", getattr(j, name), 2)
        if not np.hypot(*j.axis) > 0:
            raise ValueError(f"joint {n}: axis must have a direction, got {j.axis}")
        finite(j.angle, f"joint {n}: angle")
        for name in ("rest", "stiffness", "damping"):
            not_negative(getattr(j, name), f"joint {n}: {name}")
    return list(joints)


def check_bodies(bodies: Sequence[Any], rho: float, constrained: bool = False) -> None:
    """Each ``integrate.Body``; ``rho`` of the scheme, which constraints (joints: ``constrained``) keep below 1."""
    if len(bodies) == 0:
        raise ValueError("a system needs at least 1 body, got 0")
    for i, b in enumerate(bodies):
        for name in ("mass", "inertia"):
            positive(getattr(b, name), f"body {i}: {name}")
        for name in ("damping", "damper"):
            not_negative(getattr(b, name), f"body {i}: {name}")
        for name, size in (("position", 2), ("hub", 2), ("anchor", 2), ("drive", 3), ("velocity", 3)):
            if getattr(b, name) is not None:
                _vector(f"body {i}: {name}", getattr(b, name), size)
        for name in ("angle", "torque"):
            finite(getattr(b, name), f"body {i}: {name}")
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
    numbers(value, name, size)


def check_elastic(
    rings: Sequence[Any],
    material: object,
    contact: Sequence[int],
    held: Mapping[str, Any],
    counts: Mapping[str, int],
) -> None:
    """What a body is to be meshed from. held: rings by what holds them (None, or a function); counts: by name."""
    if not isinstance(material, Material):
        raise ValueError(f"material must be a flexible.Material, got {type(material).__name__}")
    points = [np.asarray(ring) for ring in listed(rings, "rings")]
    for n, ring in enumerate(points):
        good = ring.ndim == 2 and ring.shape[1:] == (2,) and len(ring) >= 3 and ring.dtype.kind in "fiu"
        if not good or not np.isfinite(ring).all():
            raise ValueError(f"rings[{n}] must be finite numbers (n, 2) with n >= 3, got shape {ring.shape}")
    for number in listed(contact, "contact"):
        whole(number, "contact: a ring", 0, len(points) - 1)
    for name, number in held.items():
        if number is not None and not callable(number):
            whole(number, f"{name}: a ring", 0, len(points) - 1)
        if number is not None and name == "clamped" and number in list(contact):
            raise ValueError(
                f"clamped: expected a ring that touches nobody, got {number}, one of those in contact"
            )
    for name, count in counts.items():
        whole(count, name, 0 if name == "modes" else 1, MOST)  # no modes: static flexibility alone
