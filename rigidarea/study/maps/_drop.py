"""A unit box dropped on a floor, tilted."""

import math

from ..scene import Body, Scene, box, box_moment, floor, set_up


def dropped(name: str, tilt: float, drop: float, elasticity: float, frame: float = 1 / 60) -> Scene:
    """The lowest corner `drop` (sides) above the floor, `tilt` in degrees, μ = 0.5, two seconds."""
    angle = math.radians(tilt)
    reach = math.sqrt(0.5) * math.cos(math.radians(45) - angle)
    body = Body("box", (box(1.0, 1.0),), (0.0, reach + drop), angle, moment=box_moment(1.0, 1.0, 1.0))
    return set_up(
        name=name, bodies=(floor(), body), friction=0.5, elasticity=elasticity, duration=2.0, frame=frame
    )
