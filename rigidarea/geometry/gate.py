"""The gate of outlines: rings as they come from users, cleaned, or a ValueError that names the fault and the place."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from typing import Any, TypedDict

import numpy as np
import pymunk
import shapely
from numpy.typing import ArrayLike

from .arcs import Points, area_and_first_moment, bulging

_EPS = float(np.finfo(np.float64).eps)
FLATTEST = 1e-8
"""Least bulge of an arc. A smaller one rises over its chord (by b / 2 chords) less than its radius (1 / 4b chords) is
rounded by: a straight edge is nearer to it."""
LARGEST = 1e75  # coordinates; their fourth powers, in the moments, stay finite


def positive(value: float, name: str) -> float:
    """The value as a float; ValueError with its name unless it is positive and finite."""
    if not (_real(value) and value > 0):
        raise ValueError(f"{name} must be positive and finite, got {value!r:.80}")
    return float(value)


def finite(value: float, name: str) -> float:
    """The value as a float; ValueError with its name unless it is a finite number."""
    if not _real(value):
        raise ValueError(f"{name} must be a finite number, got {value!r:.80}")
    return float(value)


def not_negative(value: float, name: str) -> float:
    """The value as a float; ValueError with its name unless it is finite and not negative."""
    if not (_real(value) and value >= 0):
        raise ValueError(f"{name} must be finite and not negative, got {value!r:.80}")
    return float(value)


def size(value: float, name: str) -> float:
    """A length as a float; ValueError with its name unless it is positive and no more than coordinates may be."""
    if positive(value, name) > LARGEST:
        raise ValueError(f"{name} must be at most {LARGEST:g}, got {value:.6g}")
    return float(value)


def fraction(value: float, name: str) -> float:
    """The value as a float; ValueError with its name unless it is more than 0 and less than 1."""
    if not (_real(value) and 0 < value < 1):
        raise ValueError(f"{name} must be a fraction, more than 0 and less than 1, got {value!r:.80}")
    return float(value)


def _real(value: Any) -> bool:
    """Whether it is a real number, no truth value, and finite as a double: whole numbers can be too large for one."""
    if not isinstance(value, int | float | np.integer | np.floating) or isinstance(value, bool):
        return False
    try:
        return math.isfinite(float(value))
    except OverflowError:
        return False


def whole(value: int, name: str, low: int, high: int | None = None) -> int:
    """The value as an int; ValueError with its name unless it is a whole number of low to high (None: no end)."""
    good = isinstance(value, int | np.integer) and not isinstance(value, bool) and value >= low
    if not good or (high is not None and value > high):
        wanted = f"of at least {low}" if high is None else f"from {low} to {high}"
        raise ValueError(f"{name} must be a whole number {wanted}, got {value!r:.80}")
    return int(value)


def one_of(value: str, name: str, known: Iterable[str]) -> str:
    """The value, one of the words known; ValueError with its name and all of them for anything else."""
    words = tuple(known)
    if not isinstance(value, str) or value not in words:
        raise ValueError(f"{name} must be one of {', '.join(map(repr, words))}, got {value!r:.80}")
    return value


def numbers(values: Any, name: str, count: int) -> tuple[float, ...]:
    """The values as a tuple of `count` floats; ValueError with their name unless they are as many finite numbers."""
    try:
        given = tuple(float(value) for value in values)
    except (TypeError, ValueError, OverflowError):
        given = ()
    if len(given) != count or not all(map(math.isfinite, given)):
        raise ValueError(f"{name} must be {count} finite numbers, got {values!r:.80}")
    return given


def truth(value: bool, name: str) -> bool:
    """The value as a bool; ValueError with its name for anything else."""
    if not isinstance(value, bool | np.bool_):
        raise ValueError(f"{name} must be True or False, got {value!r:.80}")
    return bool(value)


def listed(values: Any, name: str) -> list[Any]:
    """The values as a list; ValueError with their name for what cannot be gone through."""
    try:
        return list(values)
    except TypeError:
        raise ValueError(f"{name} must be a list, got {values!r:.80}") from None


class ShapeAttributes(TypedDict, total=False):
    """What pymunk's shapes have that may be given as keywords."""

    friction: float
    elasticity: float
    collision_type: int
    filter: pymunk.ShapeFilter
    sensor: bool
    surface_velocity: tuple[float, float]


def checked_attribute(name: str, value: Any) -> None:
    """ValueError unless `value` can be the attribute `name` of a pymunk shape (which would assert, or end the process).

    name: friction, elasticity, collision_type, filter, sensor or surface_velocity.
    """
    number = isinstance(value, int | float | np.number) and not isinstance(value, bool)
    good, wanted = {
        "friction": (number and math.isfinite(value) and value >= 0, "a finite number >= 0"),
        "elasticity": (number and math.isfinite(value) and value >= 0, "a finite number >= 0"),
        "collision_type": (
            number and isinstance(value, int | np.integer) and 0 <= value < 2**64,
            "a whole number from 0 to 2^64 - 1",
        ),
        "filter": (isinstance(value, pymunk.ShapeFilter), "a pymunk.ShapeFilter"),
        "sensor": (isinstance(value, bool | np.bool_), "True or False"),
        "surface_velocity": (
            isinstance(value, tuple | list | np.ndarray)
            and len(value) == 2
            and all(isinstance(v, int | float | np.number) and math.isfinite(v) for v in value),
            "two finite numbers",
        ),
    }[name]
    if not good:
        raise ValueError(f"{name} must be {wanted}, got {value!r:.80}")


def checked_ring(points: ArrayLike, name: str) -> Points:
    """A clean copy of a ring's points: float64 (n, 2), n >= 3, no repeated or closing point, in the sense given.

    Raises ValueError, beginning with `name`, for other shapes, numbers that are not finite or above LARGEST, fewer
    than three distinct points, and no area.
    """
    try:
        ring = _floats(points)
    except (TypeError, ValueError, OverflowError) as error:
        raise ValueError(f"{name} must be numbers of shape (n, 2), got {points!r:.80}") from error
    if ring.ndim != 2 or ring.shape[1] != 2:
        raise ValueError(f"{name} must have shape (n, 2) with n >= 3, got shape {ring.shape}")
    finite = np.isfinite(ring).all(axis=1)
    if not finite.all():
        bad = int(np.argmin(finite))
        raise ValueError(f"{name} must be finite, got {tuple(ring[bad].tolist())} at point {bad}")
    given = len(ring)
    if given:
        reach = float(np.abs(ring).max())
        if reach > LARGEST:
            raise ValueError(f"{name} must have coordinates below {LARGEST:g}, got {reach:.6g}")
        # nearer than this two points are one, rounded differently
        apart = np.abs(ring - np.concatenate((ring[-1:], ring[:-1]))) > 2 * _EPS * reach
        keep = apart.any(axis=1)
        if not keep.all():
            ring = ring[keep]
    if len(ring) < 3:
        raise ValueError(f"{name} must have at least 3 distinct points, got {len(ring)} (of {given} given)")
    middle = (ring.min(axis=0) + ring.max(axis=0)) / 2
    size = float(np.abs(ring - middle).max())
    area = area_and_first_moment(ring - middle)[0]
    if abs(area) <= 8 * _EPS * reach * size:  # what rounded coordinates of collinear points can enclose
        far = ring[np.argmax(((ring - ring[0]) ** 2).sum(axis=1))] - ring[0]
        width = np.abs((ring - ring[0]) @ (-far[1], far[0])).max()
        if width <= 8 * _EPS * reach * size:  # else a figure of eight: it crosses itself
            raise ValueError(f"{name} must enclose an area, got {abs(area):.3g} for a size of {2 * size:.3g}")
    return ring


def _floats(values: ArrayLike) -> Points:
    """A copy as float64; TypeError for complex numbers, of which numpy would take the real part."""
    if np.iscomplexobj(values):
        raise TypeError("complex numbers")
    return np.array(values, dtype=np.float64)


def checked_bulges(ring: ArrayLike, name: str) -> tuple[Points, Points]:
    """(points (n, 2), arcs (n, 3)) of a ring of x, y, bulge; ValueError naming what is wrong with it."""
    try:
        rows = _floats(ring)
    except (TypeError, ValueError, OverflowError) as error:
        raise ValueError(f"{name} must be numbers of shape (n, 3), got {ring!r:.80}") from error
    if rows.ndim != 2 or rows.shape[1] != 3 or len(rows) < 2:
        raise ValueError(f"{name} must have shape (n, 3) with n >= 2, got shape {rows.shape}")
    if not np.isfinite(rows).all() or np.abs(rows).max() > LARGEST:
        raise ValueError(f"{name} must be finite and below {LARGEST:g}")
    # nearer than this two points are one, rounded differently
    apart = np.abs(rows[:, :2] - np.roll(rows[:, :2], -1, axis=0)) > 2 * _EPS * np.abs(rows[:, :2]).max()
    if not apart.any(axis=1).all():
        raise ValueError(f"{name} must not repeat a point, nor its first at the end")
    rows[np.abs(rows[:, 2]) < FLATTEST, 2] = 0.0
    if len(rows) == 2 and rows[:, 2].sum() == 0:
        raise ValueError(f"{name} must enclose an area, got two edges on each other")
    return bulging(rows[:, :2], rows[:, 2])


def check_valid(rings: list[Points]) -> None:
    """ValueError naming the fault and the place, unless the rings bound a simple region (GEOS judges)."""
    whole = shapely.Polygon(rings[0], rings[1:])
    if shapely.is_valid(whole):
        return
    names = ["points"] + [f"holes[{i}]" for i in range(len(rings) - 1)]
    alone = [shapely.Polygon(ring) for ring in rings]
    for name, polygon in zip(names, alone):
        if not shapely.is_valid(polygon):
            raise ValueError(f"{name} must not cross or touch itself; it does {_place(polygon)}")
    for name, hole in zip(names[1:], alone[1:]):
        if not alone[0].covers(hole):
            x, y = hole.difference(alone[0]).representative_point().coords[0]
            raise ValueError(f"{name} must lie inside the outer ring; ({x:.6g}, {y:.6g}) of it is outside")
        if hole.boundary.intersection(alone[0].boundary).length > 0:
            raise ValueError(f"{name} must not share an edge with the outer ring; it does {_place(whole)}")
    for i, first in enumerate(alone[1:]):
        for j, second in enumerate(alone[i + 2 :], start=i + 1):
            common = first.intersection(second)
            if common.area > 0 or common.length > 0:
                x, y = common.representative_point().coords[0]
                raise ValueError(f"holes[{i}] and holes[{j}] must be apart; they meet at ({x:.6g}, {y:.6g})")
    raise ValueError(f"rings must bound one connected region, got: {shapely.is_valid_reason(whole)}")


def _place(polygon: shapely.Polygon) -> str:
    """Where GEOS says it is: its reason reads like "Self-intersection[x y]"."""
    reason = str(shapely.is_valid_reason(polygon))
    found = re.search(r"\[(\S+) ([^\]\s]+)", reason)
    return f"at ({float(found[1]):.6g}, {float(found[2]):.6g})" if found else f"({reason})"
