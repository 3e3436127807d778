"""Two free boxes that start inside each other are taken apart: to where they touch, without being thrown."""

import numpy as np

from ..scene import ANGLE, Scene, Trace, X, Y, block

DEPTH, V = 0.4, 1.0
"""How deep they start in each other (sides); the speed that both have, along their faces (m/s)."""


def error(trace: Trace) -> float:
    """Largest distance from where a box should be after 2 s, or turn times half a side, over the side.

    The overlap was put there, not worked for: no energy came in, and none may come out. So the answer is the two boxes
    touching and, but for the velocity that they started with, at rest; each has moved half the depth, since the common
    centre of mass goes on as before. Whoever lets them part at a speed of u sides a second and leaves them that is off
    by about 2 u, whoever shoots them apart by much more, whoever leaves them in each other by what is left.
    """
    worst = 0.0
    for name, side in (("left", -1.0), ("right", 1.0)):
        last = trace[name][-1]
        exact = np.array((side / 2, V * trace.times[-1]))
        worst = max(worst, float(np.hypot(*(last[[X, Y]] - exact))), abs(float(last[ANGLE])) / 2)
    return worst


def scene() -> Scene:
    """Unit boxes, 0.4 of a side deep in each other, no gravity, no friction; both move along their faces."""
    apart = (1 - DEPTH) / 2
    bodies = (
        block("left", 1.0, 1.0, (-apart, 0.0), velocity=(0.0, V)),
        block("right", 1.0, 1.0, (apart, 0.0), velocity=(0.0, V)),
    )
    return Scene(
        title="two free boxes, overlapped at the start",
        bodies=bodies,
        gravity=(0.0, 0.0),
        duration=2.0,
        error_name="displacement / side",
        error=error,
        source="no energy came in; the centre of mass is not moved from inside",
        pressure=V**2,
        tags=frozenset({"flat"}),
    )
