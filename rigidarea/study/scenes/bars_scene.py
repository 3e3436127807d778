"""A short elastic bar hits the end of a long one: the restitution is the ratio of their lengths (Saint-Venant)."""

from ..scene import VX, Body, Elastic, Scene, Trace, box, box_moment

LENGTHS, HEIGHT, THICK, GAP, V = (0.1, 0.2), 0.005, 0.01, 1e-6, 1.0
"""Lengths (m) of the bar that hits and of the one that rests; both 5 mm high and 10 mm thick; speed (m/s)."""
YOUNG, POISSON, DENSITY = 207e9, 0.29, 7800.0
NARROW = 0.96
"""Height of the short bar over that of the long one, its thickness growing as much: no side lies on a side."""
WAVE = (YOUNG / DENSITY) ** 0.5
"""Speed of the longitudinal wave (m/s)."""


def after() -> tuple[float, float]:
    """Velocities after the impact: the wave runs through the short bar and back and brings it to rest; the long one
    has all the momentum.
    """
    return 0.0, V * LENGTHS[0] / LENGTHS[1]


def error(trace: Trace) -> float:
    """Largest velocity error relative to the approach speed, of the mean over the last third (the bars go on
    ringing).
    """
    late = trace.times > trace.times[-1] * 2 / 3
    found = (float(trace[name][late, VX].mean()) for name in ("short", "long"))
    return max(abs(one - other) for one, other in zip(found, after(), strict=True)) / V


def scene() -> Scene:
    """Steel bars of 100 and 200 mm at 1 m/s; three times the contact's duration 2 L/c of the long bar."""
    bodies = []
    for name, length, scale, x, v in (
        ("short", LENGTHS[0], NARROW, -LENGTHS[0] / 2 - GAP, V),
        ("long", LENGTHS[1], 1.0, LENGTHS[1] / 2, 0.0),
    ):
        mass = DENSITY * length * HEIGHT * THICK
        made = Elastic(YOUNG, POISSON, THICK / scale, HEIGHT / 4)
        height = scale * HEIGHT
        moment = box_moment(mass, length, height)
        shape = (box(length, height),)
        bodies.append(Body(name, shape, (x, 0.0), velocity=(v, 0.0), mass=mass, moment=moment, elastic=made))
    return Scene(
        title="elastic bars, end to end",
        bodies=tuple(bodies),
        gravity=(0.0, 0.0),
        elasticity=1.0,
        duration=240e-6,
        error_name="velocity after impact, relative",
        error=error,
        source="Saint-Venant: one-dimensional waves; e = L₁/L₂ for bars of one section and material",
        size=HEIGHT,
        pressure=DENSITY * WAVE * V * THICK / (2 * HEIGHT),  # the impact's force ρ c A v/2 over size²
        frame=1e-5,
        tags=frozenset({"impact", "elastic"}),
        deforms=True,
    )
