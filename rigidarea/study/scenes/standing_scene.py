"""A slender block on an incline stands while tan θ < w/h."""

import math

from ..scene import G, Scene, block, floor, rest_error
from .tipping_scene import HEIGHT, MU, WIDTH

THETA = math.atan(0.9 * WIDTH / HEIGHT)


def scene() -> Scene:
    """tan θ = 0.9 w/h, five seconds; gravity is turned instead of the floor."""
    return Scene(
        name="standing",
        title="block standing on an incline",
        bodies=(floor(), block("block", WIDTH, HEIGHT, (0.0, HEIGHT / 2))),
        gravity=(G * math.sin(THETA), -G * math.cos(THETA)),
        friction=MU,
        duration=5.0,
        error_name="displacement after 5 s / width",
        error=lambda trace: rest_error(trace, ["block"], WIDTH),
        source="statics: stands if and only if tan θ <= w/h",
        size=WIDTH,
        pressure=G / WIDTH**2,
        tags=frozenset({"rest", "corner", "flat"}),
    )


def softest() -> float:
    """The largest penetration (of the width, lying flat) at which the block stands on a bed of springs: m³ w/6h.

    The weight lies a part m of half the base from the lower edge, m w/2. Turned by φ the block is pressed along c from
    that edge, with k c²/2 φ = m g where k = m g/(p w²), and the resultant is c/3 from it: m w/2 − φ h/2 = c/3. So
    (m w/2 − φ h/2)² φ = 2 p w²/9, whose left side is at most (4/27) (m w/2)³/(h/2), where φ = m w/3h.
    """
    margin = 1.0 - math.tan(THETA) * HEIGHT / WIDTH
    return margin**3 * WIDTH / (6.0 * HEIGHT)
