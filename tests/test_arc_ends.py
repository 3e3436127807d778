"""Arcs as makers leave them: ends lie on their circles to a few roundings, which the signs of an overlap allow."""

from __future__ import annotations

import math
from collections.abc import Callable

import mpmath
import numpy as np
import pytest

import rigidarea as ra
import tangent_families
from rigidarea import shapes

MAKERS: dict[str, Callable[[np.random.Generator], ra.Outline]] = {
    "circle": lambda rng: ra.Outline.circle(rng.uniform(0.1, 1), tuple(rng.uniform(-1, 1, 2))),
    "turned": lambda rng: shapes.capsule(1, rng.uniform(0.1, 1)).rotated(rng.uniform(0, 7)),
    "shifted": lambda rng: shapes.capsule(1, rng.uniform(0.1, 1)).translated(*rng.uniform(-1e3, 1e3, 2)),
    "flat": lambda rng: ra.Outline.from_bulges([(0, 0, 10 ** rng.uniform(-6, -1)), (1, 0.2, 0), (0.5, 1, 0)]),
    "rounded": lambda rng: shapes.rounded_polygon(
        np.array([(0, 0), (1, 0), (1.3, 1), (0.2, 0.8)]) * rng.uniform(0.9, 1.1, (4, 1)), 0.02
    ),
    "geneva": lambda rng: shapes.geneva(6, 5.0, rng.uniform(0.3, 0.8), 0.0, locking_clearance=0.01).wheel,
    "tangent": lambda rng: (
        tangent_families.FAMILIES[rng.integers(len(tangent_families.FAMILIES))](
            rng, 10 ** rng.uniform(-6, 6)
        ).b
    ),
}


def off_circle(outline: ra.Outline) -> float:
    """The most that an end of an arc lies off its circle, over the largest of what says where that is."""
    worst = 0.0
    for ring, arcs in zip(outline.rings, outline.arcs):
        for p, q, (x, y, r) in zip(ring, np.roll(ring, -1, axis=0), arcs):
            for end in (p, q) if r else ():
                far = mpmath.hypot(mpmath.mpf(end[0]) - mpmath.mpf(x), mpmath.mpf(end[1]) - mpmath.mpf(y))
                largest = max(abs(r), abs(x), abs(y), *np.abs(end))
                worst = max(worst, float(abs(far - abs(mpmath.mpf(r)))) / largest)
    return worst


@pytest.mark.parametrize("name", MAKERS)
def test_ends_lie_on_their_circles(name: str) -> None:
    """5.3 roundings are the most that is seen, of a Geneva wheel, whose arcs are made in two steps; others 2."""
    rng = np.random.default_rng(4)
    worst = max(off_circle(MAKERS[name](rng)) for _ in range(30))
    assert worst <= 8 * 2.0**-52
    assert math.isfinite(worst)
