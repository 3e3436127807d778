"""Newton's cradle with gaps: elastic impacts, one after the other, hand the whole speed on."""

import math

import pymunk

from ..gallery import Headline, Scene, new_space
from ..shapes import circle

BALLS, RADIUS, GAP = 5, 0.05, 0.002
"""Number, radius (m), distance between neighbours at rest (m)."""
LENGTH, LIFT = 0.45, math.radians(40)
"""Of the pendulum (m); angle from which the first ball is let go."""
MASS, G = 1.0, 9.81
STIFFNESS = 2e9
"""k of F = k A (N/m²): the balls flatten by a quarter of the gap."""


def build() -> Scene:
    """Five pendulums; the balls hang at height 0, the leftmost lifted."""
    space = new_space(1e-4, G)
    ball = circle(RADIUS)
    pitch = 2 * RADIUS + GAP
    balls = []
    for i in range(BALLS):
        x = (i - (BALLS - 1) / 2) * pitch
        body = ball.body(mass=MASS)
        angle = -LIFT if i == 0 else 0.0
        body.angle = angle
        body.position = x + LENGTH * math.sin(angle), LENGTH * (1 - math.cos(angle))
        space.add(body, ball.add_to(body, elasticity=1.0))
        space.add(pymunk.PivotJoint(space.static_body, body, (x, LENGTH)))
        balls.append(body)

    best = {0: 0.0, BALLS - 1: 0.0}
    seen = [0.0]
    inertia = MASS + ball.moment(MASS) / LENGTH**2

    def watch(t: float) -> None:
        """The speed at height 0 that the outer balls have energy for, up to the last ball's first return."""
        seen[0] = t
        for i in best:
            body = balls[i]
            energy = inertia * body.velocity.dot(body.velocity) / 2 + MASS * G * body.position.y
            if t < 0.45 * period:
                best[i] = max(best[i], math.sqrt(max(0.0, 2 * energy / inertia)))

    def handed_on() -> float:
        """Speed of the last ball over that of the first; NaN before the first hand-over."""
        return best[BALLS - 1] / best[0] if seen[0] > 0.4 * period else math.nan

    period = 2 * math.pi * math.sqrt(inertia / MASS * LENGTH / G) * (1 + LIFT**2 / 16)
    return Scene(
        name="cradle",
        title="Newton's cradle with gaps",
        shows="Elasticity 1: the last ball leaves with the speed at which the first one came.",
        space=space,
        view=(-0.62, -0.1, 0.62, 0.5),
        headline=Headline("last_to_first_speed", handed_on, 1.0),
        chipmunk="as it is, the discs as polygons",
        attach={"stiffness": STIFFNESS, "rest_speed": 0.0},
        frame=1 / 120,
        frames=360,
        still=0.29,
        watch=watch,
        energy="kept",
        energy_scale=MASS * G * LENGTH * (1 - math.cos(LIFT)),
        force=2000.0,
    )
