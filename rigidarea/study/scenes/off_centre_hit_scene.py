"""A disc hits a free bar off its centre."""

from ..scene import OMEGA, VY, Scene, Trace, block, box_moment, disc

RADIUS, LENGTH, WIDTH = 0.2, 2.0, 0.2
M_DISC, M_BAR, V, E, ARM = 1.0, 2.0, 3.0, 0.6, 0.6
I_BAR = box_moment(M_BAR, LENGTH, WIDTH)


def impulse() -> float:
    """J = (1 + e) v/(1/m + 1/M + d²/I)."""
    return (1 + E) * V / (1 / M_DISC + 1 / M_BAR + ARM**2 / I_BAR)


def error(trace: Trace) -> float:
    """Largest velocity error (bar's rotation as speed of the point hit), relative to the approach speed."""
    j = impulse()
    disc_, bar = trace["disc"][-1], trace["bar"][-1]
    off = (disc_[VY] - (-V + j / M_DISC), bar[VY] + j / M_BAR, ARM * (bar[OMEGA] + ARM * j / I_BAR))
    return max(abs(value) for value in off) / V


def scene() -> Scene:
    """3 m/s down on a bar of 2 kg, 0.6 m right of its centre, e = 0.6; no friction, no gravity."""
    start = WIDTH / 2 + RADIUS + 0.6
    bodies = (
        block("bar", LENGTH, WIDTH, (0.0, 0.0), M_BAR),
        disc("disc", RADIUS, (ARM, start), M_DISC, velocity=(0.0, -V)),
    )
    return Scene(
        title="disc hits a free bar off centre",
        bodies=bodies,
        gravity=(0.0, 0.0),
        elasticity=E,
        duration=0.4,
        error_name="velocity after impact, relative",
        error=error,
        source="J = (1 + e) v/(1/m + 1/M + d²/I)",
        size=2 * RADIUS,
        pressure=V**2 / (2 * RADIUS) ** 3,
        tags=frozenset({"impact"}),
    )
