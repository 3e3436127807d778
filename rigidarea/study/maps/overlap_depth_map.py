"""Bodies that start inside each other: pushed out the short way, gently, or shot, swallowed, or pushed through?"""

import math

import numpy as np

from ..atlas import PASS, Axis, Map, Outcome, Variant, engines, run_scene
from ..scene import Body, Circle, Curve, Polygon, Shape, box, floor, full_circle, set_up

SHAPES = ("box", "flat bar", "disc", "triangle", "ring", "L")
SLAB = 2.0
"""Thickness of the slab under the body; its upper face is y = 0."""


def _shape(index: int) -> tuple[Shape, float]:
    """A shape about its centroid, and how far it reaches below that."""
    r = 1 / math.sqrt(3)
    triangle = tuple(
        (r * math.cos(a), r * math.sin(a)) for a in (math.pi / 2, 7 * math.pi / 6, 11 * math.pi / 6)
    )
    corner = np.array([(0, 0), (1, 0), (1, 0.3), (0.3, 0.3), (0.3, 1), (0, 1)], dtype=float)
    centroid = (np.array((0.5, 0.15)) * 0.3 + np.array((0.15, 0.65)) * 0.21) / 0.51
    shapes: tuple[tuple[Shape, float], ...] = (
        (box(1.0, 1.0), 0.5),
        (box(2.0, 0.3), 0.15),
        (Circle(0.5), 0.5),
        (Polygon(triangle), r / 2),
        (Curve(lambda tolerance: (full_circle(0.5, 1e-3), full_circle(0.4, 1e-3))), 0.5),
        (Curve(lambda tolerance: (corner - centroid,)), float(centroid[1])),
    )
    return shapes[index]


def run(variant: Variant, x: float, y: float) -> Outcome:
    """The speed with which the body leaves (its height a second); fails by direction, speed, or staying inside."""
    shape, below = _shape(round(y))
    height = 2 * below if round(y) != 3 else 3 * below
    slab = floor(20.0, SLAB)
    body = Body("body", (shape,), (0.0, below - x * height), moment=0.2)
    scene = set_up(name="overlap_depth", bodies=(slab, body), friction=0.3, duration=4.0)
    path = run_scene(variant, scene, 1e3)["body"]
    if not np.all(np.isfinite(path)):
        return "not finite", math.inf
    speed = float(np.max(np.abs(path[:, 4])))
    end = float(path[-1, 1])
    if end < -SLAB / 2:
        return "fell through", speed
    if end < 0.5 * below - x * height * 0.5:
        return "stayed inside", speed
    fastest = math.sqrt(2 * 9.81 * 10)  # thrown ten body heights up
    return (PASS if float(np.max(path[:, 1])) < 10 and speed < fastest else "shot out"), speed


def atlas_map() -> Map:
    """Depth of overlap at the start × shape."""
    return Map(
        title="starting inside a slab",
        x=Axis(
            "depth of overlap at the start / height",
            (0.01, 0.03, 0.1, 0.3, 0.5, 0.7, 0.9, 1.1),
            (0.03, 0.3, 0.7),
        ),
        y=Axis("shape", tuple(range(len(SHAPES))), (0, 2, 5), names=SHAPES),
        measure="largest speed (m/s)",
        limit=math.sqrt(2 * 9.81 * 10),
        variants=engines(),
        run=run,
        source="shortest way out: up, for a slab two bodies thick; thrown at most ten heights",
    )
