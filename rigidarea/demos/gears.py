"""Two involute gears at 600 rpm: rigid, meshing by their true flanks, faster than real time."""

import math

import pymunk

from ..gallery import Headline, Lens, Scene, new_space
from ..shapes import involute_gear

MODULE, TEETH = 0.002, (23, 57)
"""Module (m), teeth of pinion and wheel."""
BACKLASH = 40e-6
"""Of the pair, at the pitch circles (m), half cut from each gear."""
SPEED = 2 * math.pi * 600 / 60
"""Of the pinion (rad/s)."""
TORQUE = 50.0
"""That resists the wheel (N m)."""
THICKNESS, DENSITY = 0.050, 7800.0
"""Face width and steel (m, kg/m³)."""
STIFFNESS = 6e10
"""k of F = k A (N/m²): the tooth load, 0.9 kN, sinks some 20 µm in."""
FRAMES_A_TOOTH = 6


def build() -> Scene:
    """The pinion keeps its speed; the wheel starts at the exact ratio, working flanks touching."""
    space = new_space(1e-6)
    small, large = (
        involute_gear(MODULE, teeth, backlash=BACKLASH / 2, bore=bore, tolerance=2e-7)
        for teeth, bore in zip(TEETH, (0.008, 0.020))
    )
    distance = MODULE * sum(TEETH) / 2
    pinion = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    pinion.angular_velocity = SPEED
    space.add(pinion, small.add_to(pinion))

    wheel = large.body(density=DENSITY * THICKNESS)
    wheel.position = distance, 0
    # centred in mesh, then turned back by half the backlash until the working flanks touch
    wheel.angle = math.pi + math.pi / TEETH[1] + BACKLASH / (MODULE * TEETH[1])
    wheel.angular_velocity = -SPEED * TEETH[0] / TEETH[1]
    load = pymunk.SimpleMotor(space.static_body, wheel, 0)
    load.max_force = TORQUE
    space.add(wheel, large.add_to(wheel), pymunk.PivotJoint(space.static_body, wheel, (distance, 0)), load)

    turned: list[tuple[float, float]] = []

    def watch(t: float) -> None:
        turned.append((pinion.angle, wheel.angle))

    def ratio() -> float:
        """Mean speed ratio over the last three quarters, in whole teeth of the pinion."""
        frames = 3 * len(turned) // 4 // FRAMES_A_TOOTH * FRAMES_A_TOOTH
        if frames == 0:
            return math.nan
        (a0, b0), (a1, b1) = turned[-1 - frames], turned[-1]
        return (b0 - b1) / (a1 - a0)

    pitch = MODULE * TEETH[0] / 2
    return Scene(
        name="gears",
        title="Gears of 23 and 57 teeth, 600 rpm",
        shows="True involutes, rack-cut roots: one to two pairs of teeth carry the load, and the ratio is constant.",
        space=space,
        view=(-0.027, -0.062, 0.141, 0.062),
        headline=Headline("mean_ratio", ratio, TEETH[0] / TEETH[1]),
        chipmunk="the gears cut into convex pieces",
        attach={"stiffness": STIFFNESS},
        frame=2 * math.pi / SPEED / TEETH[0] / FRAMES_A_TOOTH,
        frames=3 * TEETH[0] * FRAMES_A_TOOTH,
        watch=watch,
        energy="driven",
        force=1000.0,
        lens=Lens(lambda: (pitch, 0.0), 0.012),
        chipmunk_steps=2,
        colors={pinion: 1, wheel: 4},
    )
