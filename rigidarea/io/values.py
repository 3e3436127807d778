"""Values of a scene file, each checked where it is read; every message names its place in the file."""

from __future__ import annotations

import math
from collections.abc import Collection
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .limits import Limits, check, shown

LARGEST = 1e50
"""Numbers beyond this are refused: a moment goes with the fourth power of a length, times a density."""

FLATTEST = 1e-7
"""Least bulge. An arc's radius is its chord over 4 bulges: flatter ones drown in the rounding of their radius."""


Ring = NDArray[np.float64]


def coordinates(rows: list[Any], widths: Collection[int]) -> Ring | None:
    """Rows of numbers as an array (n, greatest width), short ones with zeros behind; at C's pace.

    None unless all of them are lists, of one of these widths, of finite numbers of at most LARGEST.
    """
    if not rows:
        return np.zeros((0, max(widths)))
    if set(map(type, rows)) - {list} or not (found := set(map(len, rows))) <= set(widths):
        return None
    widest = max(found)
    if len(found) > 1:
        rows = [[*row, *[0.0] * (widest - len(row))] for row in rows]
    if set(map(type, chain.from_iterable(rows))) - {int, float}:
        return None
    try:
        told = np.fromiter(chain.from_iterable(rows), np.float64, widest * len(rows)).reshape(-1, widest)
    except OverflowError:
        return None
    if not (np.abs(told) <= LARGEST).all():
        return None
    return np.pad(told, ((0, 0), (0, max(widths) - widest)))


def first_wrong(rows: list[Any], widths: Collection[int]) -> int:
    """Which of the rows is the first of which `coordinates` makes nothing; found by halves."""
    low, high = 0, len(rows)
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if coordinates(rows[low:middle], widths) is None else (middle, high)
    return low


class Values:
    """Reads values out of plain data: each method returns what it has found, checked.

    found: the value. place: where it stands in the file, for the message. All raise ValueError with the place, what was
    expected and what came, where something else was found.
    """

    def __init__(self, limits: Limits) -> None:
        self.limits = limits
        self.points = 0
        """Points of rings so far."""

    def table(self, found: Any, place: str, known: tuple[str, ...] | None = None) -> dict[str, Any]:
        """A table, all of whose keys are among `known` (None: any)."""
        if not isinstance(found, dict):
            raise ValueError(f"{place}: expected a table, got {shown(found)}")
        unknown = [key for key in found if known is not None and key not in known]
        if unknown:
            raise ValueError(f"{place}: expected some of {', '.join(known or ())}, got {shown(unknown[0])}")
        check(len(found), self.limits.parts, f"entries in {place}")
        return found

    def rows(self, found: Any, place: str) -> list[Any]:
        """A list."""
        if not isinstance(found, list):
            raise ValueError(f"{place}: expected a list, got {shown(found)}")
        return found

    def number(
        self, found: Any, place: str, low: float | None = None, above: bool = False, infinite: bool = False
    ) -> float:
        """A finite number, at least `low`, with `above` more than that; with `infinite` the word "inf" is one too."""
        wanted = "a finite number" if not infinite else 'a number or "inf"'
        if low is not None:
            wanted += f" {'>' if above else '>='} {low:g}"
        value = math.inf if infinite and found == "inf" else found
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise ValueError(f"{place}: expected {wanted}, got {shown(found)}")
        try:
            value = float(value)
        except OverflowError:
            value = math.nan
        finite = abs(value) <= LARGEST or (infinite and value == math.inf)
        if not finite or (low is not None and (value < low or (above and value == low))):
            raise ValueError(f"{place}: expected {wanted}, got {shown(found)}")
        return value

    def whole(self, found: Any, place: str) -> int:
        """A whole number as Chipmunk keeps them: 0 to 2^32 - 1."""
        if isinstance(found, bool) or not isinstance(found, int) or not 0 <= found < 2**32:
            raise ValueError(f"{place}: expected a whole number from 0 to 2^32 - 1, got {shown(found)}")
        return found

    def truth(self, found: Any, place: str) -> bool:
        """A truth value: true or false."""
        if not isinstance(found, bool):
            raise ValueError(f"{place}: expected true or false, got {shown(found)}")
        return found

    def point(self, found: Any, place: str) -> tuple[float, float]:
        """A point [x, y], as a tuple."""
        if not isinstance(found, list) or len(found) != 2:
            raise ValueError(f"{place}: expected [x, y], got {shown(found)}")
        return self.number(found[0], f"{place}[0]"), self.number(found[1], f"{place}[1]")

    def bulged(self, found: Any, place: str) -> Ring:
        """A list of points, [x, y] or, where an arc to the next begins, [x, y, bulge]: (n, 3), counted against the
        limit."""
        points = self.rows(found, place)
        self.points += len(points)
        check(self.points, self.limits.points, "points")
        told = coordinates(points, (2, 3))
        if told is None:
            i = first_wrong(points, (2, 3))
            if not isinstance(points[i], list) or len(points[i]) not in (2, 3):
                raise ValueError(f"{place}[{i}]: expected [x, y] or [x, y, bulge], got {shown(points[i])}")
            for k, value in enumerate(points[i]):
                self.number(value, f"{place}[{i}][{k}]")
            raise ValueError(f"{place}: expected points, got {shown(points)}")
        size = np.abs(told[:, 2])
        wrong = (size != 0) & ~((size >= FLATTEST) & (size <= 1 / FLATTEST))
        if wrong.any():
            i = int(np.argmax(wrong))
            raise ValueError(
                f"{place}[{i}][2]: expected 0 or a bulge of {FLATTEST:g} to {1 / FLATTEST:g} in size,"
                f" got {told[i, 2]:g}"
            )
        least = 2 if told[:, 2].any() else 3
        if len(told) < least:
            raise ValueError(f"{place}: expected at least {least} points, got {len(told)}")
        return told

    def ring(self, found: Any, place: str, least: int = 3) -> list[tuple[float, float]]:
        """A list of `least` or more points [x, y], counted against the limit."""
        points = self.rows(found, place)
        self.points += len(points)
        check(self.points, self.limits.points, "points")
        if len(points) < least:
            raise ValueError(f"{place}: expected at least {least} points, got {len(points)}")
        return [self.point(point, f"{place}[{i}]") for i, point in enumerate(points)]
