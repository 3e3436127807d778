"""A tower of 40 boxes, one on the other: how stiff a contact has to be for that."""

import random

import pymunk

from ..gallery import Headline, Lens, Scene, new_space

BOXES = 40
SIZE = 1.0
"""Side of a box (m)."""
DENSITY, FRICTION = 1.0, 0.6
G = 9.81
SCATTER = 0.002
"""Largest offset of a box from the tower's axis (m). A tower without any could not buckle."""
PENETRATION = 8e-6
"""Sinking of one box under its own weight, over its side: (0.65 / this)^(1/3) = 43 boxes stand, softer towers buckle
under their own weight (docs/theory.md, 8: a beam on elastic interfaces)."""


def build() -> Scene:
    """The tower, its boxes set down by hand: each up to SCATTER off (seeded)."""
    space = new_space(0.005, G)
    floor = pymunk.Segment(space.static_body, (-60, 0), (60, 0), 0)
    floor.friction = FRICTION
    space.add(floor)
    mass = DENSITY * SIZE**2
    chance = random.Random(3)
    bodies = []
    for i in range(BOXES):
        body = pymunk.Body(mass, pymunk.moment_for_box(mass, (SIZE, SIZE)))
        body.position = chance.uniform(-SCATTER, SCATTER), (i + 0.5) * SIZE
        shape = pymunk.Poly.create_box(body, (SIZE, SIZE))
        shape.friction = FRICTION
        space.add(body, shape)
        bodies.append(body)

    start = [body.position for body in bodies]

    def shift() -> float:
        """Largest sideways displacement of a box since the start (mm)."""
        return 1e3 * max(abs(body.position.x - at.x) for body, at in zip(bodies, start))

    return Scene(
        name="tower",
        title="Tower of 40 boxes",
        shows="Stiff enough not to buckle under its own weight: the strokes grow towards the foot.",
        space=space,
        view=(-20, -1.2, 20, 41.2),
        headline=Headline("largest_shift_mm", shift, 0.0),
        chipmunk="as it is",
        attach={"penetration": PENETRATION},
        frames=600,
        energy_scale=mass * G * SIZE * BOXES**2 / 2,
        force=BOXES * mass * G,
        force_px=16,
        lens=Lens(lambda: (0.0, 0.9), 3.2),
        colors={body: i // 4 for i, body in enumerate(bodies)},
    )
