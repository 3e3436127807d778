"""A block slides down a wedge that is free to slide itself; no friction anywhere."""

import math

import numpy as np

from ..scene import Body, G, Polygon, Scene, Trace, X, block, floor

SLOPE, M_WEDGE, M_BLOCK = math.radians(30), 2.0, 1.0
LENGTH, SIDE = 3.0, 0.5


def accelerations() -> tuple[float, float]:
    """(wedge's, block's along the slope relative to the wedge).

    A = m g sin θ cos θ/(M + m sin² θ); relative (M + m) g sin θ/(M + m sin² θ).
    """
    s, c = math.sin(SLOPE), math.cos(SLOPE)
    below = M_WEDGE + M_BLOCK * s * s
    return M_BLOCK * G * s * c / below, (M_WEDGE + M_BLOCK) * G * s / below


def wedge_points() -> np.ndarray:
    """The triangle (3, 2) about its centroid; the slope falls towards +x."""
    points = np.array([(0.0, 0.0), (LENGTH, 0.0), (0.0, LENGTH * math.tan(SLOPE))])
    return points - points.mean(axis=0)


def error(trace: Trace) -> float:
    """Largest error of either body's place, relative to the block's path on the slope."""
    wedge_a, relative = accelerations()
    half = trace.times**2 / 2
    wedge, sliding = trace["wedge"], trace["block"]
    ex = np.column_stack((-wedge_a * half, 0 * half))
    along = np.array((math.cos(SLOPE), -math.sin(SLOPE)))
    far = np.linalg.norm(wedge[:, :2] - wedge[0, :2] - ex, axis=1)
    near = np.linalg.norm(sliding[:, :2] - sliding[0, :2] - ex - relative * half[:, None] * along, axis=1)
    return float(max(far.max(), near.max()) / (relative * half[-1]))


def scene() -> Scene:
    """30 degrees, wedge 2 kg, block 1 kg, 0.6 s from rest."""
    points = wedge_points()
    low = points[:, 1].min()
    top = points[2] - (0.0, low)
    along = np.array((math.cos(SLOPE), -math.sin(SLOPE)))
    normal = np.array((math.sin(SLOPE), math.cos(SLOPE)))
    start = top + 0.8 * along + SIDE / 2 * normal
    # Moment of a right triangle with legs a, b about its centroid: m (a² + b²)/18.
    moment = M_WEDGE * (LENGTH**2 + (LENGTH * math.tan(SLOPE)) ** 2) / 18
    corners = tuple((float(x), float(y)) for x, y in points)
    bodies = (
        floor(),
        Body("wedge", (Polygon(corners),), (0.0, -float(low)), mass=M_WEDGE, moment=moment),
        block("block", SIDE, SIDE, (float(start[X]), float(start[1])), M_BLOCK, angle=-SLOPE),
    )
    return Scene(
        title="block on a free wedge",
        bodies=bodies,
        duration=0.6,
        error_name="position / path",
        error=error,
        source="Lagrange: A = m g sin θ cos θ/(M + m sin² θ)",
        size=SIDE,
        tags=frozenset({"flat"}),
    )
