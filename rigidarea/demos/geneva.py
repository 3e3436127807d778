"""A Geneva drive with 0.01 mm of clearance: turned by a sixth, locked, turned by a sixth."""

import itertools
import math

import pymunk

from ..gallery import Headline, Lens, Scene, new_space
from ..shapes import geneva

SLOTS, CENTRES, PIN, CLEARANCE = 6, 0.05, 0.008, 1e-5
"""Maddio et al., Table 3 (m)."""
SPEED = 2 * math.pi * 30 / 60
"""Of the driver (rad/s)."""
THICKNESS, DENSITY = 0.005, 7800.0
"""Of the wheel (m, kg/m³), Table 4."""
BRAKE = 0.02
"""Torque with which the wheel's bearing opposes rotation (N m)."""
STIFFNESS = 6e8
"""k of F = k A (N/m²)."""
LEAD = 0.5
"""How far before the pin enters the driver starts (rad)."""
TURNS = 3


def build() -> Scene:
    """Driver with pin and locking disc, kinematic; the wheel on a pivot with a brake."""
    parts = geneva(SLOTS, CENTRES, PIN, CLEARANCE, bore=0.005)
    space = new_space(1e-6)
    start = -parts.entry_angle - LEAD
    driver = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    driver.angle = start
    driver.angular_velocity = SPEED
    space.add(driver, parts.pin.add_to(driver), parts.locking_disc.add_to(driver))
    wheel = parts.wheel.body(density=DENSITY * THICKNESS)
    wheel.position = CENTRES, 0
    wheel.angle = parts.wheel_angle(start)
    brake = pymunk.SimpleMotor(space.static_body, wheel, 0)
    brake.max_force = BRAKE
    space.add(
        wheel, parts.wheel.add_to(wheel), pymunk.PivotJoint(space.static_body, wheel, (CENTRES, 0)), brake
    )

    locked: list[float] = []
    origin = wheel.angle

    def watch(t: float) -> None:
        """The wheel's angle at half dwell, once a revolution (half a turn after the pin was deepest)."""
        due = (math.pi * (2 * len(locked) + 1) - start) / SPEED
        if t >= due:
            locked.append(wheel.angle)

    def index_error() -> float:
        """Largest departure of an index from 60 degrees (degrees)."""
        stops = [origin, *locked]
        steps = [abs(b - a) for a, b in itertools.pairwise(stops)]
        return max((abs(math.degrees(s) - 360 / SLOTS) for s in steps), default=math.nan)

    def flank() -> tuple[float, float]:
        """Where the pin pushes: its point furthest across the slot."""
        center = driver.local_to_world((parts.crank_radius, 0))
        across = (wheel.position - center).normalized().perpendicular()
        at = center + PIN / 2 * across
        return at.x, at.y

    frame = 1 / 60
    return Scene(
        name="geneva",
        title="Geneva drive, six slots",
        shows="A sixth of a turn per revolution of the driver; in between, the disc locks the wheel.",
        space=space,
        view=(-0.034, -0.049, 0.100, 0.049),
        headline=Headline("index_angle_error_deg", index_error, 0.0),
        chipmunk="wheel and disc cut into convex pieces",
        attach={"stiffness": STIFFNESS},
        frame=frame,
        frames=math.ceil(2 * math.pi * TURNS / SPEED / frame),
        still=(-start / SPEED - 0.12) / (2 * math.pi * TURNS / SPEED),
        watch=watch,
        energy="driven",
        force=5.0,
        lens=Lens(flank, 0.0004),
        colors={driver: 1, wheel: 4},
    )
