"""What a system of bodies must be before it is stepped: each check raises ValueError naming expected and actual."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from rigidarea.flexible.element import Material
from rigidarea.flexible.mechanism_joints import KINDS, Joint
from rigidarea.geometry.gate import finite, listed, not_negative, numbers, positive, whole

#: Modes of a body, contact points a mesh edge: beyond so many a body would ask for gigabytes.
MOST = 10_000
PIVOT = 1e-2  # of a body's size, how far from its hub a pivot may be given: a ring's mean is near its middle, not in it


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
    numbers(gravity, "gravity", 2)


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
    except (TypeError, ValueError, OverflowError):
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
            numbers(getattr(j, name), f"joint {n}: {name}", 2)
        if not np.hypot(*j.axis) > 0:
            raise ValueError(f"joint {n}: axis must have a direction, got {j.axis}")
        finite(j.angle, f"joint {n}: angle")
        for name in ("rest", "stiffness", "damping"):
            not_negative(getattr(j, name), f"joint {n}: {name}")
    return list(joints)


def held_nodes(
    clamp: Callable[[NDArray[np.float64]], Any],
    points: NDArray[np.float64],
    loaded: Sequence[NDArray[np.int64]],
) -> NDArray[np.int64]:
    """Which of the boundary nodes ``points`` (n, 2) a clamp holds: enough to hold the body, and not all that contacts
    load (``loaded``, ring by ring)."""
    given = np.asarray(clamp(points))
    if given.shape != (len(points),) or given.dtype != bool:
        raise ValueError(
            f"clamp must return True or False for each of {len(points)} boundary nodes, got an array of"
            f" {given.dtype} of shape {given.shape}"
        )
    held = np.flatnonzero(given)
    if len(held) < 2:
        low, high = points.min(0), points.max(0)
        raise ValueError(
            f"clamp must hold 2 boundary nodes at least, which keep the body from turning, got {len(held)} of"
            f" {len(points)}; their x are {low[0]:.4g} … {high[0]:.4g}, their y {low[1]:.4g} … {high[1]:.4g}"
        )
    if all(given[ring].all() for ring in loaded):
        raise ValueError(
            f"clamp must leave some of what touches others free, got {len(held)} of {len(points)} boundary nodes held:"
            " a body that cannot yield is a rigid one (Mechanism.ground)"
        )
    return held


def check_start(bodies: Sequence[Any], pairs: NDArray[np.int64], limit: float) -> None:
    """No pair may overlap at t = 0 deeper than ``limit``, or than a body's half thickness: from the other side of the
    middle a contact would push the wrong way.

    The half thickness is the radius of the largest circle in a body, the depth the diameter of that in the overlap.
    """
    solids = [_solid(b) for b in bodies]
    for i, j in pairs.tolist():
        reach = sum(float(np.linalg.norm(bodies[k].boundary.points, axis=1).max()) for k in (i, j))
        if np.hypot(*np.subtract(bodies[i].position, bodies[j].position)) > reach:
            continue
        shared = shapely.intersection(solids[i], solids[j])
        if shared.area == 0.0:
            continue
        most = min(limit, _within(solids[i]), _within(solids[j]))
        for part in getattr(shared, "geoms", [shared]):
            depth = 2.0 * _within(part)
            if depth > most:
                x, y = part.centroid.coords[0]
                raise ValueError(
                    f"bodies {i} and {j} overlap at t = 0: expected a depth of at most {most:.4g}, got {depth:.4g}"
                    f" about ({x:.4g}, {y:.4g})"
                )


def _within(part: Any) -> float:
    """The radius of the largest circle in a polygon (shapely); of a line or a point: 0."""
    return float(shapely.maximum_inscribed_circle(part).length) if part.area > 0.0 else 0.0


def _solid(body: Any) -> Any:
    """A body where it is at t = 0, as far as its contact rings bound it (shapely).

    Where only holes touch others, the body goes on around them farther than any depth that is looked for.
    """
    b = body.boundary
    c, s = np.cos(body.angle), np.sin(body.angle)
    at = b.points @ np.array([[c, s], [-s, c]]) + np.asarray(body.position)
    rings = [shapely.Polygon(at[b.ring_of == k]) for k in range(int(b.ring_of[-1]) + 1)]
    rings = [ring if ring.is_valid else shapely.make_valid(ring) for ring in rings]
    outer = [r for r in rings if r.geom_type != "Polygon" or r.exterior.is_ccw]
    holes = shapely.unary_union([r for r in rings if r not in outer])
    if outer:
        return shapely.union_all(outer).difference(holes)
    return holes.buffer(4.0 * holes.area / holes.length).difference(holes)


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
                numbers(getattr(b, name), f"body {i}: {name}", size)
        for name in ("angle", "torque"):
            finite(getattr(b, name), f"body {i}: {name}")
        if b.drive is not None and b.drive[2] < 0:
            raise ValueError(f"body {i}: drive's ramp time must not be negative, got {b.drive[2]}")
        if b.anchor is not None and not b.fixed:
            c, s = np.cos(b.angle), np.sin(b.angle)
            at = np.array(b.position) + np.array([[c, -s], [s, c]]) @ np.array(b.hub)
            near = PIVOT * float(np.linalg.norm(b.boundary.points, axis=1).max())
            if not np.hypot(*(at - b.anchor)) <= near:
                raise ValueError(
                    f"body {i}: its pivot must be where its hub is, ({at[0]:.6g}, {at[1]:.6g}), within"
                    f" {near:.3g}, got ({b.anchor[0]:.6g}, {b.anchor[1]:.6g})"
                )
        moved = b.anchor is not None or b.drive is not None or b.torque or b.damper or any(b.velocity)
        if b.fixed and moved:
            raise ValueError(f"body {i} is fixed: expected no anchor, drive, torque, damper or velocity")
        modes = b.boundary.modes.shape[1]
        for name, shape in (("frequency", (modes,)), ("stretch", (modes,)), ("coupling", (modes, modes))):
            if np.shape(getattr(b, name)) != shape:
                raise ValueError(
                    f"body {i}: expected {name} of shape {shape}, one for each of its boundary's modes, got"
                    f" {np.shape(getattr(b, name))}"
                )
    if rho == 1.0 and (constrained or any(b.anchor is not None or b.drive is not None for b in bodies)):
        raise ValueError("rho must be below 1 with constraints (index 3 is unstable at 1), got 1")


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
    if len(listed(contact, "contact")) == 0:
        raise ValueError("contact must name 1 ring at least that may touch others, got none")
    for number in contact:
        whole(number, "contact: a ring", 0, len(points) - 1)
    for name, number in held.items():
        if number is not None and not callable(number):
            whole(number, f"{name}: a ring", 0, len(points) - 1)
        if number is not None and name == "clamped" and number in list(contact):
            raise ValueError(
                f"clamped: expected a ring that touches nobody, got {number}, one of those in contact; a function of"
                " the boundary nodes holds a part of it, like lambda p: p[:, 0] < 0.01"
            )
    for name, count in counts.items():
        whole(count, name, 0 if name == "modes" else 1, MOST)  # no modes: static flexibility alone
