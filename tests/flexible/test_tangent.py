"""Flexible bodies whose boundaries touch along a tangent or coincide, also deformed: no wrong area."""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from rigidarea.flexible import nodal
from rigidarea.flexible.boundary import Boundary, build, workspace
from rigidarea.flexible.boundary_places import place

sys.path.insert(0, str(Path(__file__).parents[1]))
import tangent_drawings
import tangent_families

SPACING = 0.02
"""A sample's distance from its arc, over the size."""


def flexible(rings: list[np.ndarray]) -> Boundary:
    """A boundary with four modes: the plane's linear maps, so that what coincides does so deformed."""
    points = np.vstack(rings)
    modes = np.zeros((2 * len(points) + 3, 4))
    modes[0:-3:2, :2] = points
    modes[1:-3:2, 2:] = points
    return build(rings, modes=modes)


def regions_and_outlines(
    a: Boundary, b: Boundary, pose: np.ndarray, modal: np.ndarray, stamp: int
) -> tuple[int, np.ndarray, list[Any]]:
    works = workspace(a), workspace(b)
    s = nodal.scratch(len(a.points) + len(b.points))
    # the boxes are those of the undeformed points: the margin is what the modes move them
    reach = 2 * float(np.abs(modal).sum()) * max(float(np.abs(x.points).max()) for x in (a, b))
    pairs = nodal.search(a, pose, b, pose, reach, s)
    n = nodal.contact(a, works[0], pose, modal, b, works[1], pose, modal, pairs, stamp, 1.0, 1.0, True, s)
    polygons = []
    for body, work in zip((a, b), works):
        for i in range(len(body.points)):
            place(body, work, pose, modal, i, stamp)
        rings = [work.position[body.ring_of == k].copy() for k in range(int(body.ring_of.max()) + 1)]
        polygons.append(shapely.Polygon(rings[0], rings[1:]))
    return n, s.regions[: max(n, 0)].copy(), polygons


FAMILIES = (*tangent_families.FAMILIES, *tangent_drawings.DRAWINGS)


def beside(family: Any, rng: np.random.Generator) -> Any:
    """A pair that only touches, or None of a family that has no such one."""
    for _ in range(60):
        pair = family(rng, 1.0)
        if pair.area == 0.0:
            return pair
    return None


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.__name__)
def test_deformed_boundaries_that_touch(family: Any) -> None:
    """The pairs' samples, both deformed by one linear map and turned: GEOS says the area, mostly none.

    1e-12 of the lengths: boundaries moved by a few roundings of places of up to 10 sizes.
    """
    rng = np.random.default_rng(11)
    for trial in range(25):
        pair = beside(family, rng)
        if pair is None:
            pytest.skip("its outlines overlap by more than a feature, which is no contact of flexible bodies")
        a, b = (o.sample(SPACING) if o.arcs else o for o in (pair.a, pair.b))
        rings_a = [np.array(ring, float) for ring in a.rings]
        rings_b = [np.array(ring, float) + pair.place for ring in b.rings]
        one, other = flexible(rings_a), flexible(rings_b)
        modal = rng.uniform(-0.2, 0.2, 4) * (rng.random() < 0.7)
        angle = float(rng.choice([0.0, rng.uniform(-3, 3)]))
        pose = np.array([*rng.uniform(-5, 5, 2), math.cos(angle), math.sin(angle)])
        for first, second in ((one, other), (other, one)):
            n, regions, (p, q) = regions_and_outlines(first, second, pose, modal, trial + 1)
            assert n >= 0, (pair.family, trial, n)
            want = float(p.intersection(q).area)
            room = 1e-12 * (p.length + q.length)
            assert abs(float(regions["area"].sum()) - want) <= room, (pair.family, trial, n, want)
            assert float(np.abs(regions["force"]).sum()) <= want + room  # the stiffness is 1
