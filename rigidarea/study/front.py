"""Fronts of cost and error, and what two of them say about each other.

A front is what one engine can do on one scene: the settings that no other of its settings beats in both cost
and error.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple


class Point(NamedTuple):
    """One setting: `cost` (computing time per simulated time) and `error` (dimensionless)."""

    cost: float
    error: float


def front(points: Iterable[Point]) -> list[Point]:
    """The points not beaten in both cost and error, by growing cost and strictly falling error."""
    kept: list[Point] = []
    for point in sorted(p for p in points if math.isfinite(p.cost) and math.isfinite(p.error)):
        if not kept or point.error < kept[-1].error:
            kept.append(point)
    return kept


def cost_at(points: Sequence[Point], error: float) -> float:
    """The least cost of an error not above `error`; infinity where it is out of reach."""
    return min((p.cost for p in points if p.error <= error), default=math.inf)


def error_at(points: Sequence[Point], cost: float) -> float:
    """The least error at a cost not above `cost`; infinity where there is none so cheap."""
    return min((p.error for p in points if p.cost <= cost), default=math.inf)


class Comparison(NamedTuple):
    """Ours over theirs; below 1 is better.

    `cost_ratio_at_matched_error`: costs at the smallest error that both reach. `error_ratio_at_matched_cost`:
    errors at the largest cost that both have a use for (the smaller of the two fronts' largest costs, or the
    dearer of the two cheapest settings if that is more). `matched_error` and `matched_cost` say where that
    is. `cost_ratio_worst` is the largest cost ratio over all points of their front: infinite where we do not
    reach their error, at most 1 if our front is nowhere dominated. The smallest error that both reach is where the
    less accurate of the two pays for its finest setting, so `cost_ratio_mean` is the geometric mean of the ratios at
    errors from there up to COARSE, evenly spread in the logarithm, and `cost_ratio_low`, `cost_ratio_high` are their
    extremes.
    """

    cost_ratio_at_matched_error: float
    error_ratio_at_matched_cost: float
    matched_error: float
    matched_cost: float
    cost_ratio_worst: float
    cost_ratio_mean: float
    cost_ratio_low: float
    cost_ratio_high: float


COARSE, LEVELS = 0.1, 13
"""The largest error at which costs are compared, and at how many errors."""


def compare(ours: Iterable[Point], theirs: Iterable[Point], resolution: float = 0.0) -> Comparison:
    """Compare two sets of settings, ours and theirs, by their fronts. Errors below `resolution` count as equal to it.

    All NaN if either has no finite point.
    """
    one, other = (front(Point(p.cost, max(p.error, resolution)) for p in points) for points in (ours, theirs))
    if not one or not other:
        return Comparison(*[math.nan] * 8)
    error = max(one[-1].error, other[-1].error)
    steps = (
        [error * (COARSE / error) ** (i / (LEVELS - 1)) for i in range(LEVELS)] if error < COARSE else [error]
    )
    ratios = [cost_at(one, level) / cost_at(other, level) for level in steps]
    cost = max(min(one[-1].cost, other[-1].cost), one[0].cost, other[0].cost)
    return Comparison(
        cost_at(one, error) / cost_at(other, error),
        error_at(one, cost) / error_at(other, cost) if error_at(other, cost) > 0 else math.nan,
        error,
        cost,
        max(cost_at(one, p.error) / p.cost for p in other),
        math.exp(sum(map(math.log, ratios)) / len(ratios)),
        min(ratios),
        max(ratios),
    )
