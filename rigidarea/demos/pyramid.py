"""820 boxes in 40 rows: a pyramid that stands."""

import pymunk

from ..gallery import Headline, Scene, new_space

ROWS = 40
SIZE = 1.0
"""Side of a box (m)."""
PITCH = 1.08
"""Distance of two boxes of a row (m)."""
DENSITY, FRICTION = 1.0, 0.6
G = 9.81


def build() -> Scene:
    """The pyramid, set down without gaps, and a floor that is one segment."""
    space = new_space(0.005, G)
    floor = pymunk.Segment(space.static_body, (-40, 0), (40, 0), 0)
    floor.friction = FRICTION
    space.add(floor)

    mass = DENSITY * SIZE**2
    start, colors = {}, {}
    for row in range(ROWS):
        for i in range(ROWS - row):
            body = pymunk.Body(mass, pymunk.moment_for_box(mass, (SIZE, SIZE)))
            body.position = (i - (ROWS - row - 1) / 2) * PITCH, (row + 0.5) * SIZE
            shape = pymunk.Poly.create_box(body, (SIZE, SIZE))
            shape.friction = FRICTION
            space.add(body, shape)
            start[body] = body.position
            colors[body] = row // 4

    def shift() -> float:
        """Largest sideways displacement (mm)."""
        return 1e3 * max(abs(body.position.x - at.x) for body, at in start.items())

    return Scene(
        name="pyramid",
        title="Pyramid of 820 boxes",
        shows="Every interface carries the boxes above it: the strokes are the contact forces.",
        space=space,
        view=(-24.5, -1.2, 24.5, 41.5),
        headline=Headline("largest_shift_mm", shift, 0.0),
        chipmunk="as it is",
        frames=300,
        energy_scale=sum(mass * G * at.y for at in start.values()),
        force=40 * mass * G,
        force_px=13,
        colors=colors,
    )
