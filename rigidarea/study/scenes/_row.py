"""Discs in a row that hit one after the other."""

import numpy as np

from ..scene import VX, Array, Scene, Trace, disc


def row(
    title: str,
    source: str,
    radius: float,
    gap: float,
    first: float,
    masses: tuple[float, ...],
    speed: float,
    exact: Array,
) -> Scene:
    """Discs of equal `radius`, gaps between them, no gravity, e = 1; the first starts `first` further off at `speed`.

    `exact` (n,) are the velocities at the end; the error is relative to the largest of them.
    """
    names = [f"disc{i}" for i in range(len(masses))]
    discs = []
    for i, mass in enumerate(masses):
        place = i * (2 * radius + gap) - first * (i == 0), 0.0
        discs.append(disc(names[i], radius, place, mass, velocity=(speed * (i == 0), 0.0)))

    def error(trace: Trace) -> float:
        """Largest velocity error relative to the largest exact velocity."""
        found = np.array([trace[each][-1, VX] for each in names])
        return float(np.max(np.abs(found - exact)) / np.max(exact))

    return Scene(
        title=title,
        bodies=tuple(discs),
        gravity=(0.0, 0.0),
        elasticity=1.0,
        duration=0.6,
        error_name="velocity, relative",
        error=error,
        source=source,
        size=2 * radius,
        pressure=speed**2 / (2 * radius) ** 3,
        tags=frozenset({"impact"}),
    )
