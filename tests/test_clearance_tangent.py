"""The clearance of what touches along a tangent or coincides is none: nothing says that it may go on for a while."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import tangent_families
import tangent_pairs
from conftest import PURE_PYTHON, kernel_module

TOUCHING = [
    family for family in tangent_families.FAMILIES if family is not tangent_families.capsule_over_bore
]


@pytest.mark.parametrize("family", TOUCHING, ids=lambda family: family.__name__)
def test_what_touches_has_no_clearance(family: Any) -> None:
    """At its place, and moved by s no more than |s| (a touching point moves by that), but for what a coordinate of the
    bodies' places rounds. Of the boundaries: so inside of each other too."""
    clearance, place, pool_of = (kernel_module(name) for name in ("clearance", "place", "pool"))
    rng = np.random.default_rng(8)
    for _ in range(4 if PURE_PYTHON else 30):
        size = 10 ** rng.uniform(-6, 6)
        pair = family(rng, size)
        if pair.family == "stacked boxes" and not len(pair.against[0]):
            continue  # corner beside corner: these may not touch
        pool = pool_of.pack([pair.a, pair.b])
        points = sum(len(ring) for outline in (pair.a, pair.b) for ring in outline.rings)
        work = kernel_module("work").new_work(max(256, 2 * points))
        for a, b, s in zip(*tangent_pairs.poses(rng, pair, size, 5)):
            rel = place.seen_from(pool.heads[0], place.Pose(*a), pool.heads[1], place.Pose(*b))
            noise = kernel_module("work").noise_of(pool.heads[0].radius, pool.heads[1].radius, rel)
            room = 4 * noise + 2.0**-51 * float(np.abs([*a[:2], *b[:2]]).max())
            found = clearance.clearance(pool, 0, pool, 1, rel, 1e9 * size, work)
            assert 0.0 <= found <= math.hypot(*s) + room, (pair.family, size, s)
