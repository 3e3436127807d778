"""A pin bouncing in its journal: a hole is a hole, and the pin comes back to where it was."""

import math

from ..gallery import Headline, Lens, Scene, new_space
from ..shapes import circle, ring

PIN, HOLE, SUPPORT = 0.020, 0.035, 0.045
"""Radii (m): the pin's, the journal's and the support's outside; Maddio et al., section 3.2."""
THICKNESS, DENSITY = 0.005, 7800.0
"""Of the pin (m, kg/m³), Table 1."""
STIFFNESS = 5e7
"""k of F = k A (Pa), Table 1."""
G = 9.81
PERIOD_MS = 111.906
"""From apex to apex: free fall of 15 mm twice, and the exact lens area integrated through the impact."""


def build() -> Scene:
    """The pin starts at rest in the journal's centre; y = 0 is where it touches."""
    space = new_space(1e-5, G)
    drop = HOLE - PIN
    tolerance = 2e-7  # a thousandth of the deepest penetration, 0.24 mm
    shape = ring(HOLE, SUPPORT, tolerance=tolerance).translated(0, drop).add_to(space.static_body)
    shape.elasticity = 1.0
    space.add(shape)
    outline = circle(PIN, tolerance=tolerance)
    pin = outline.body(density=DENSITY * THICKNESS)
    pin.position = 0, drop
    space.add(pin, outline.add_to(pin, elasticity=1.0))

    heights: list[tuple[float, float]] = []

    def watch(t: float) -> None:
        heights.append((t, pin.position.y))

    def period() -> float:
        """Time of the first apex after the start, from a parabola of known curvature g (ms)."""
        first = [(t, y) for t, y in heights if 0.07 < t < 0.15 and y > drop / 2]
        if len(first) < 3:
            return math.nan
        # y + g t²/2 is a straight line in free fall: its slope is g times the apex' time
        n = len(first)
        mt = sum(t for t, _ in first) / n
        my = sum(y + G * t * t / 2 for t, y in first) / n
        slope = sum((t - mt) * (y + G * t * t / 2 - my) for t, y in first) / sum(
            (t - mt) ** 2 for t, _ in first
        )
        return 1e3 * slope / G

    return Scene(
        name="journal",
        title="Pin in a journal",
        shows="One outline inside the hole of another, without convex pieces; no energy is lost.",
        space=space,
        view=(-0.06, -0.032, 0.06, 0.062),
        headline=Headline("period_ms", period, PERIOD_MS),
        chipmunk="the ring cut into convex pieces",
        attach={"stiffness": STIFFNESS, "rest_speed": 0.0},
        frame=1 / 1200,
        frames=276,
        still=0.243,
        watch=watch,
        energy="kept",
        energy_scale=pin.mass * G * drop,
        force=76.0,
        lens=Lens(lambda: (0.0, -0.020), 0.006),
        unit="m",
    )
