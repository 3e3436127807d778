"""A rough disc rolls in a circular bowl: the pendulum's period times sqrt(3/2)."""

import math

from ..scene import Scene, disc
from .bowl_slide_scene import RADIUS, RHO, bowl, path_error, period, swing

START, MU = math.radians(45), 0.8


def scene() -> Scene:
    """As `bowl_slide` from 45 degrees, with μ = 0.8 (rolling needs tan θ₀/3 = 0.33)."""
    start = (RHO * math.sin(START), -RHO * math.cos(START))
    return Scene(
        title="disc rolling in a bowl",
        bodies=(bowl(), disc("disc", RADIUS, start)),
        friction=MU,
        duration=2 * period(1.5 * RHO, START),
        error_name="position over two periods / arc",
        error=lambda trace: path_error(trace, "disc", RHO, swing(trace.times, 1.5 * RHO, START)),
        source="rolling adds I/(m r²) = 1/2 to the inertia: a pendulum of length (3/2) ρ",
        size=2 * RADIUS,
        tags=frozenset({"curved", "concave", "friction", "rolling"}),
    )
