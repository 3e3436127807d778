"""Values of a scene file, each checked where it is read; every message names its place in the file."""

from __future__ import annotations

import math
from typing import Any

from .limits import Limits, check

LARGEST = 1e50
"""Numbers beyond this are refused: a moment goes with the fourth power of a length, times a density."""

FLATTEST = 1e-7
"""Least bulge. An arc's radius is its chord over 4 bulges: flatter ones drown in the rounding of their radius."""


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
            raise ValueError(f"{place}: expected a table, got {found!r:.40}")
        unknown = [key for key in found if known is not None and key not in known]
        if unknown:
            raise ValueError(f"{place}: expected some of {', '.join(known or ())}, got {unknown[0]!r:.40}")
        check(len(found), self.limits.parts, f"entries in {place}")
        return found

    def rows(self, found: Any, place: str) -> list[Any]:
        """A list."""
        if not isinstance(found, list):
            raise ValueError(f"{place}: expected a list, got {found!r:.40}")
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
            raise ValueError(f"{place}: expected {wanted}, got {found!r:.40}")
        try:
            value = float(value)
        except OverflowError:
            value = math.nan
        finite = abs(value) <= LARGEST or (infinite and value == math.inf)
        if not finite or (low is not None and (value < low or (above and value == low))):
            raise ValueError(f"{place}: expected {wanted}, got {str(found)[:40]}")
        return value

    def whole(self, found: Any, place: str) -> int:
        """A whole number as Chipmunk keeps them: 0 to 2^32 - 1."""
        if isinstance(found, bool) or not isinstance(found, int) or not 0 <= found < 2**32:
            raise ValueError(f"{place}: expected a whole number from 0 to 2^32 - 1, got {str(found)[:40]!r}")
        return found

    def truth(self, found: Any, place: str) -> bool:
        """A truth value: true or false."""
        if not isinstance(found, bool):
            raise ValueError(f"{place}: expected true or false, got {found!r:.40}")
        return found

    def point(self, found: Any, place: str) -> tuple[float, float]:
        """A point [x, y], as a tuple."""
        if not isinstance(found, list) or len(found) != 2:
            raise ValueError(f"{place}: expected [x, y], got {found!r:.40}")
        return self.number(found[0], f"{place}[0]"), self.number(found[1], f"{place}[1]")

    def bulged(self, found: Any, place: str) -> list[tuple[float, float, float]]:
        """A list of points, [x, y] or, where an arc to the next begins, [x, y, bulge]; counted against the limit."""
        points = self.rows(found, place)
        self.points += len(points)
        check(self.points, self.limits.points, "points")
        told = []
        for i, point in enumerate(points):
            if not isinstance(point, list) or len(point) not in (2, 3):
                raise ValueError(f"{place}[{i}]: expected [x, y] or [x, y, bulge], got {point!r:.40}")
            x, y, bulge = (
                self.number(value, f"{place}[{i}][{k}]") for k, value in enumerate([*point, 0][:3])
            )
            if bulge and not FLATTEST <= abs(bulge) <= 1 / FLATTEST:
                raise ValueError(
                    f"{place}[{i}][2]: expected 0 or a bulge of {FLATTEST:g} to {1 / FLATTEST:g} in size, got {bulge:g}"
                )
            told.append((x, y, bulge))
        least = 2 if any(bulge for _, _, bulge in told) else 3
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
