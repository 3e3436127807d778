"""A disc that hits a rough floor at a slant, without gravity."""

from ..scene import OMEGA, VX, VY, Scene, Trace, disc, floor


def slanted(
    title: str,
    source: str,
    error_name: str,
    radius: float,
    friction: float,
    elasticity: float,
    approach: tuple[float, float],
    after: tuple[float, float, float],
    scale: float,
) -> Scene:
    """Speeds of `approach` along the floor and down to it; velocities (vx, vy, ω) exactly `after` the impact.

    The error is the largest of a velocity (rim speed for the spin), relative to `scale` (length/time).
    """

    def error(trace: Trace) -> float:
        vx, vy, omega = after
        last = trace["ball"][-1]
        return max(abs(last[VX] - vx), abs(last[VY] - vy), radius * abs(last[OMEGA] - omega)) / scale

    along, down = approach
    return Scene(
        title=title,
        bodies=(floor(), disc("ball", radius, (0.0, radius + 0.5), velocity=(along, -down))),
        gravity=(0.0, 0.0),
        friction=friction,
        elasticity=elasticity,
        duration=0.5,
        error_name=error_name,
        error=error,
        source=source,
        size=2 * radius,
        pressure=down**2 / (2 * radius) ** 3,
        tags=frozenset({"impact", "friction"}),
    )
