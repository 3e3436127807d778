"""Concave pieces, some with holes, fill a concave bowl: no convex decomposition anywhere."""

import math
import random

import numpy as np

from .. import Outline
from ..gallery import Headline, Scene, add_body, new_space, static_body
from ..geometry.arcs import arc_points
from ..geometry.gate import ShapeAttributes
from ..shapes import ring, rounded_polygon

RADIUS, WALL, RIM = 5.0, 0.4, 2.0
"""Of the bowl, inside; of its wall; height of its straight sides: what falls 10 m rebounds over less (m)."""
TOLERANCE = 2e-3
"""Largest sagitta of a chord (m)."""
COLUMNS, ROWS, PITCH = 5, 8, 1.75
"""How the pieces hang above the bowl before they fall; distance of neighbours (m)."""
DENSITY, FRICTION, ELASTICITY = 1.0, 0.35, 0.1
G = 9.81


def bowl() -> Outline:
    """Half a ring below height 0, straight sides above."""
    inner = arc_points((0, 0), RADIUS, math.pi, math.pi, TOLERANCE)
    outer = arc_points((0, 0), RADIUS + WALL, 2 * math.pi, -math.pi, TOLERANCE)
    right = [(RADIUS, RIM), (RADIUS + WALL, RIM)]
    left = [(-RADIUS - WALL, RIM), (-RADIUS, RIM)]
    return Outline(np.concatenate((inner, right, outer, left)))


def c_shape(radius: float, width: float, opening: float) -> Outline:
    """A ring of outer `radius` and thickness `width` (m) with a mouth of `opening` radians, ends cut square."""
    start, sweep = opening / 2, 2 * math.pi - opening
    outside = arc_points((0, 0), radius, start, sweep, TOLERANCE)
    inside = arc_points((0, 0), radius - width, start + sweep, -sweep, TOLERANCE)
    return Outline(np.concatenate((outside, inside)))


def star(points: int, outer: float, inner: float) -> Outline:
    """A star of so many points with rounded tips and creases, at the radii `outer` and `inner` (m)."""
    angle = math.pi * np.arange(2 * points) / points + math.pi / 2
    radius = np.where(np.arange(2 * points) % 2 == 0, outer, inner)
    return rounded_polygon(
        radius[:, None] * np.column_stack((np.cos(angle), np.sin(angle))), 0.04, tolerance=TOLERANCE
    )


def pieces() -> list[Outline]:
    """What falls: U, L, star, C, ring, plate with two holes."""
    u = [
        (-0.55, -0.5),
        (0.55, -0.5),
        (0.55, 0.5),
        (0.3, 0.5),
        (0.3, -0.22),
        (-0.3, -0.22),
        (-0.3, 0.5),
        (-0.55, 0.5),
    ]
    l = [(-0.4, -0.55), (0.45, -0.55), (0.45, -0.27), (-0.12, -0.27), (-0.12, 0.55), (-0.4, 0.55)]
    plate = [(-0.62, -0.34), (0.62, -0.34), (0.62, 0.34), (-0.62, 0.34)]
    windows = [[(x - 0.2, -0.18), (x + 0.2, -0.18), (x + 0.2, 0.18), (x - 0.2, 0.18)] for x in (-0.29, 0.29)]
    return [
        Outline(u),
        Outline(l),
        star(5, 0.65, 0.3),
        c_shape(0.55, 0.24, 1.5),
        ring(0.27, 0.5, tolerance=TOLERANCE),
        Outline(plate, holes=windows),
    ]


def build() -> Scene:
    """40 pieces in a loose column above the bowl, turned at random (seeded)."""
    space = new_space(0.005, G)
    static_body(space, bowl(), friction=FRICTION, elasticity=ELASTICITY)
    chance = random.Random(7)
    kinds = pieces()
    bodies, colors = [], {}
    surface: ShapeAttributes = {"friction": FRICTION, "elasticity": ELASTICITY}
    for i in range(COLUMNS * ROWS):
        row, column = divmod(i, COLUMNS)
        kind = chance.randrange(len(kinds))
        x = (column - (COLUMNS - 1) / 2) * PITCH + chance.uniform(-0.1, 0.1)
        place, angle = (x, -1.5 + row * PITCH), chance.uniform(-math.pi, math.pi)
        body = add_body(space, kinds[kind], place, density=DENSITY, angle=angle, **surface)
        bodies.append(body)
        colors[body] = kind

    def kept() -> float:
        """How many pieces are in the bowl, heap included."""
        inside = 0
        for body in bodies:
            x, y = body.position
            inside += math.hypot(x, y) < RADIUS if y < 0 else abs(x) < RADIUS + WALL
        return float(inside)

    top = -1.5 + ROWS * PITCH
    return Scene(
        name="bowl",
        title="Concave pieces in a bowl",
        shows="U, L, star, C, ring and plate with windows: contact by their true outlines, holes included.",
        space=space,
        view=(-8.5, -5.8, 8.5, 3.4),
        headline=Headline("pieces_in_bowl", kept, float(len(bodies))),
        chipmunk="every piece and the bowl cut into convex pieces",
        attach={"law": "energy", "penetration": 4e-3},
        frames=330,
        energy_scale=sum(body.mass for body in bodies) * G * top / 2,
        force=60.0,
        force_px=30,
        colors=colors,
    )
