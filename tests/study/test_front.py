"""Fronts and ratios on points made up so that the answer is plain."""

import math

import pytest

from rigidarea.study.front import Point, compare, cost_at, error_at, front

THEIRS = [Point(1, 1e-1), Point(10, 1e-2), Point(100, 1e-3), Point(50, 5e-2), Point(5, math.inf)]


def test_front_keeps_what_nothing_beats():
    """Dearer and worse points and failures drop out."""
    assert front(THEIRS) == [Point(1, 1e-1), Point(10, 1e-2), Point(100, 1e-3)]
    assert front([Point(1, 1.0), Point(1, 0.5)]) == [Point(1, 0.5)]
    assert front([Point(1, 0.5), Point(2, 0.5)]) == [Point(1, 0.5)]
    assert front([]) == []


def test_reading_a_front():
    """Costs and errors are those of points, not between them; out of reach is infinite."""
    assert cost_at(THEIRS, 2e-2) == 10
    assert cost_at(THEIRS, 1e-4) == math.inf
    assert error_at(THEIRS, 99) == 1e-2
    assert error_at(THEIRS, 0.5) == math.inf


def test_half_the_cost():
    """Everything at half the cost."""
    found = compare([Point(p.cost / 2, p.error) for p in THEIRS], THEIRS)
    assert found.cost_ratio_at_matched_error == 0.5
    assert found.cost_ratio_worst == 0.5
    assert found.matched_error == 1e-3
    assert found.error_ratio_at_matched_cost == 1e-3 / 1e-2  # at a cost of 50 they are one setting behind


def test_mean_over_a_range():
    """At a tenth the cost down to an error of 1e-2, and ten times the cost at 1e-3: in between on the average."""
    ours = [Point(0.1, 1e-1), Point(1, 1e-2), Point(1000, 1e-3)]
    found = compare(ours, THEIRS)
    assert found.cost_ratio_at_matched_error == pytest.approx(10)
    assert found.cost_ratio_low == pytest.approx(0.1)
    assert found.cost_ratio_high == pytest.approx(10)
    # thirteen errors from 1e-3 to 1e-1: the first six lie below 1e-2
    assert found.cost_ratio_mean == pytest.approx((10**6 * 0.1**7) ** (1 / 13))


def test_less_accurate():
    """Where we do not reach their best error, the match is at ours, and the worst ratio is infinite."""
    found = compare([Point(1, 1e-2)], THEIRS)
    assert found.matched_error == 1e-2
    assert found.cost_ratio_at_matched_error == 0.1
    assert found.cost_ratio_worst == math.inf
    assert found.error_ratio_at_matched_cost == pytest.approx(0.1)


def test_resolution_and_nothing():
    """Errors below the resolution are equal; a peer without a finite point cannot be compared."""
    found = compare([Point(1, 1e-9)], [Point(2, 1e-7)], resolution=1e-4)
    assert found.error_ratio_at_matched_cost == 1
    assert found.cost_ratio_at_matched_error == 0.5
    assert all(math.isnan(value) for value in compare([Point(1, math.inf)], THEIRS))
