"""Two rubber gears in a game: their teeth bend, 50 rigid boxes fall on and around them."""

import math
import random

import pymunk

from ..gallery import Headline, Lens, Scene, new_space
from ..shapes import box, involute_gear

MODULE, TEETH = 0.05, (16, 32)
"""Module (m), teeth of pinion and wheel."""
BACKLASH = 2e-3
"""At the pitch circles (m)."""
YOUNG, POISSON, DENSITY, THICKNESS = 5e7, 0.45, 1150.0, 0.1
"""A hard rubber (N/m², -, kg/m³), and its thickness (m)."""
MESH = 0.02
"""Of the finite elements, on the boundary (m)."""
STIFFNESS = 1e8
"""k of F = k A between the gears (N/m²): contacts about as stiff as the teeth are."""
SPEED, BRAKE = 2.0, 150.0
"""Of the pinion (rad/s), and the moment that holds the wheel back (N m)."""
BOXES, SIZE, BOX_DENSITY = 50, 0.16, 100.0
G = 9.81


def build() -> Scene:
    """The pinion is turned by a motor, the wheel held back by a brake; boxes come down on both (seeded)."""
    from ..flexible import Assembly, Material

    space = new_space(1e-3, G)
    ground = space.static_body
    for a, b in (((-3, -1.4), (3, -1.4)), ((-2.4, -1.4), (-3, 3)), ((2.4, -1.4), (3, 3))):
        wall = pymunk.Segment(ground, a, b, 0.02)
        wall.friction = 0.5
        space.add(wall)
    distance = MODULE * sum(TEETH) / 2
    places = (-0.6, 0.0), (-0.6 + distance, 0.0)
    rubber = Material(YOUNG, POISSON, DENSITY, THICKNESS)
    gears = Assembly(k=STIFFNESS)
    bodies = []
    for teeth, place, turned in zip(TEETH, places, (0.0, math.pi + math.pi / TEETH[1])):
        outline = involute_gear(MODULE, teeth, backlash=BACKLASH / 2, bore=0.1)
        body = outline.body(density=DENSITY * THICKNESS)
        body.position, body.angle = place, turned
        shape = outline.add_to(body, friction=0.5)
        pivot = pymunk.PivotJoint(ground, body, place)
        space.add(body, shape, pivot)
        gears.part(shape, rubber, mesh=MESH, hub=1)
        bodies.append(body)
    pinion, wheel = bodies
    motor, brake = pymunk.SimpleMotor(ground, pinion, -SPEED), pymunk.SimpleMotor(ground, wheel, 0.0)
    brake.max_force = BRAKE
    space.add(motor, brake)

    chance = random.Random(5)
    crate = box(SIZE, SIZE)
    for i in range(BOXES):
        body = crate.body(density=BOX_DENSITY)
        body.position = 0.32 * (i % 10 - 4.5) + chance.uniform(-0.05, 0.05), 1.6 + 0.3 * (i // 10)
        body.angle = chance.uniform(-0.5, 0.5)
        space.add(body, crate.add_to(body, friction=0.5))

    turned_by: list[tuple[float, float]] = []

    def watch(t: float) -> None:
        turned_by.append((pinion.angle, wheel.angle))

    def ratio() -> float:
        """Mean speed ratio since the first half second."""
        if len(turned_by) < 60:
            return math.nan
        (a0, b0), (a1, b1) = turned_by[30], turned_by[-1]
        return (b0 - b1) / (a1 - a0)

    return Scene(
        name="rubber",
        title="Rubber gears among boxes",
        shows="Finite elements in a game: the gears' teeth bend under the brake, everything else is rigid.",
        space=space,
        view=(-3.1, -1.5, 3.1, 2.6),
        headline=Headline("mean_ratio", ratio, TEETH[0] / TEETH[1]),
        chipmunk="the gears cut into convex pieces, rigid",
        attach={"flexible": gears},
        watch=watch,
        energy="driven",
        force=100.0,
        lens=Lens(lambda: (places[0][0] + MODULE * TEETH[0] / 2, 0.0), 0.4),
        colors={pinion: 1, wheel: 4},
    )
