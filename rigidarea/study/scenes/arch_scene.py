"""A semicircular arch of voussoirs, a tenth thicker than the thinnest that can stand."""

import itertools
from functools import cache

import numpy as np
from scipy.optimize import linprog

from ...geometry.outline import Outline
from ..scene import Array, Body, G, Polygon, Scene, floor, rest_error

COUNT, RADIUS, MU, MARGIN = 11, 5.0, 0.7, 1.1
"""Voussoirs; radius of the arch's middle line (m); friction; thickness over the least one."""


def joints(thickness: float, count: int = COUNT) -> Array:
    """Corners (count + 1, 2, 2) of the joints, each (inner, outer), from the right springing to the left.

    Joints are radial and evenly spaced; voussoirs have straight sides, so that their corners are all there is.
    """
    angles = np.linspace(0.0, np.pi, count + 1)
    along = np.column_stack((np.cos(angles), np.sin(angles)))
    return np.stack(((RADIUS - thickness / 2) * along, (RADIUS + thickness / 2) * along), axis=1)


def voussoirs(thickness: float, count: int = COUNT) -> list[Outline]:
    """Outlines, in the world's coordinates."""
    corners = joints(thickness, count)
    return [Outline((a[0], a[1], b[1], b[0])) for a, b in itertools.pairwise(corners)]


def stands(thickness: float, count: int = COUNT, friction: float = MU) -> bool:
    """Whether there are forces in the joints that hold the arch's weight: a linear programme (Livesley 1978).

    Every joint has a force n >= 0 across it at either corner and s along it, |s| <= μ n at each; any force that the
    joint can bear is such a pair, for it pushes within the joint and within the cone of friction. Every voussoir is in
    balance: three equations each. By the safe theorem one solution is enough.
    """
    corners, stones = joints(thickness, count), voussoirs(thickness, count)
    unknowns = 4 * (count + 1)  # of each joint n, s at the inner corner, n, s at the outer
    balance = np.zeros((3 * count, unknowns))
    weight = np.zeros(3 * count)
    for i, stone in enumerate(stones):
        centre = np.array(stone.centroid)
        # the force on the stone beyond the joint, as seen from the right
        for joint, sense in ((i, 1.0), (i + 1, -1.0)):
            outwards = corners[joint, 1] - corners[joint, 0]
            along = outwards / np.hypot(*outwards)
            across = np.array((-along[1], along[0]))
            for k, corner in enumerate(corners[joint]):
                arm = corner - centre
                for j, direction in enumerate((across, along)):
                    force = sense * direction
                    column = 4 * joint + 2 * k + j
                    balance[3 * i : 3 * i + 2, column] = force
                    balance[3 * i + 2, column] = arm[0] * force[1] - arm[1] * force[0]
        weight[3 * i + 1] = stone.area  # upwards, what holds a stone of unit weight per area
    cone = np.zeros((unknowns, unknowns))
    for k in range(unknowns // 2):
        cone[2 * k, 2 * k : 2 * k + 2] = -friction, 1.0
        cone[2 * k + 1, 2 * k : 2 * k + 2] = -friction, -1.0
    bounds = [(0, None), (None, None)] * (unknowns // 2)
    found = linprog(
        np.zeros(unknowns), cone, np.zeros(unknowns), balance, weight, bounds=bounds, method="highs"
    )
    return bool(found.status == 0)


@cache
def least_thickness(count: int = COUNT) -> float:
    """The least thickness over the radius with which the arch stands, to 1e-6 (bisection)."""
    low, high = 0.0, 0.5
    while high - low > 1e-6:
        middle = (low + high) / 2
        low, high = (low, middle) if stands(middle * RADIUS, count) else (middle, high)
    return high


def scene() -> Scene:
    """Eleven voussoirs on a floor, 1.1 times the least thickness of as many: nothing moves."""
    thickness = MARGIN * least_thickness() * RADIUS
    stones = []
    for i, outline in enumerate(voussoirs(thickness)):
        x, y = outline.centroid
        corners = tuple((float(px - x), float(py - y)) for px, py in outline.rings[0])
        mass = outline.area
        moment = Outline(corners).moment(mass)
        stones.append(Body(f"stone{i}", (Polygon(corners),), (x, y), mass=mass, moment=moment))
    names = [stone.name for stone in stones]
    half = sum(stone.mass for stone in stones) / 2 * G
    return Scene(
        title="arch of voussoirs at 1.1 of the least thickness",
        bodies=(floor(), *stones),
        friction=MU,
        duration=5.0,
        error_name="displacement after 5 s / thickness",
        error=lambda trace: rest_error(trace, names, thickness),
        source="limit analysis by a linear programme (Livesley 1978)",
        size=thickness,
        pressure=half / thickness**2,
        tags=frozenset({"rest", "flat", "stack"}),
    )
