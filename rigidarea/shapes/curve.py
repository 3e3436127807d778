"""A smooth curve as a chain of chords: as few points as the tolerance allows, all of them on the curve."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ..geometry.gate import finite, size, whole

Curve = Callable[[NDArray[np.float64]], NDArray[np.float64]]
"""Parameters (n,) -> points (n, 2)."""

_FINE = 512  # steps in which curvature is measured
MOST = 10**6  # chords of one curve: beyond, the outline would take gigabytes
MOST_TEETH = 10_000  # of a gear: more than any has, and its outline is still some ten megabytes
_ROUNDING = 16 * np.finfo(float).eps  # of a coordinate; a sagitta is not known better
_WITHIN = np.arange(1, 8) / 8  # where, between a chord's ends, its distance from the curve is measured


def check_gear(module: float, teeth: int, pressure_angle: float) -> None:
    """ValueError for what is out of range of a gear, whatever its teeth look like."""
    whole(teeth, "teeth", 3, MOST_TEETH)
    size(module, "module")
    if not 0 < finite(pressure_angle, "pressure_angle") < math.pi / 4:
        raise ValueError(f"pressure_angle must lie between 0 and π/4 radians, got {pressure_angle!r}")


def check_modules(teeth: int, **lengths: float) -> None:
    """ValueError for a length (modules) of more than two pitch radii."""
    for name, value in lengths.items():
        if value > teeth:
            raise ValueError(f"{name} must be at most {teeth} modules for {teeth} teeth, got {value:.6g}")


def involute(roll: float) -> float:
    """The involute function of the angle whose tangent is `roll`."""
    return roll - math.atan(roll)


def arc(radius: float, angle: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points (n, 2) of a circle about the origin at angles (n,)."""
    return radius * np.column_stack((np.cos(angle), np.sin(angle)))


def repeated(points: NDArray[np.float64], teeth: int, sense: int) -> NDArray[np.float64]:
    """Points (n, 2) of one tooth, repeated around the origin (sense 1: counter-clockwise, -1): (teeth · n, 2)."""
    turn = np.exp(sense * 2j * math.pi * np.arange(teeth) / teeth)
    z = (turn[:, None] * (points[:, 0] + 1j * points[:, 1])[None, :]).ravel()
    return np.column_stack((z.real, z.imag))


def sample_curve(
    curve: Curve, first: float, last: float, tolerance: float, spacing: float | None = None
) -> NDArray[np.float64]:
    """Points (n, 2) on `curve` from parameter `first` to `last`, both included.

    No chord's sagitta exceeds `tolerance` (length) and no chord is longer than `spacing` (length), if
    given. A chord of length ds on curvature κ has sagitta κ ds²/8, so chords of equal sagitta are spread
    with density sqrt(κ/(8·tolerance)) along the curve; the count is then raised until the sagittas,
    measured, obey. Raises ValueError for what would take more than MOST chords.
    """
    fine = np.linspace(first, last, _FINE + 1)
    seen = curve(fine)
    count = _ideal_count(seen, tolerance, spacing)
    given = f"tolerance {tolerance:.3g}" + ("" if spacing is None else f", spacing {spacing:.3g}")
    rounding = _ROUNDING * float(np.abs(seen).max())
    if not tolerance > rounding:
        raise ValueError(f"expected a tolerance above the points' rounding, {rounding:.3g}, got {given}")
    chords = max(1, math.ceil(count[-1])) if count[-1] <= MOST else MOST + 1
    while chords <= MOST:
        chosen = np.interp(np.linspace(0, count[-1], chords + 1), count, fine)
        chosen[0], chosen[-1] = first, last  # (where the curve is straight, the count stands still)
        points = curve(chosen)
        if _sagitta(curve, chosen, points) <= tolerance and (
            spacing is None or np.hypot(*np.diff(points, axis=0).T).max() <= spacing
        ):
            return points
        chords += 1 + chords // 100
    raise ValueError(f"expected a tolerance and spacing of at most {MOST} chords a curve, got {given}")


def _ideal_count(points: NDArray[np.float64], tolerance: float, spacing: float | None) -> NDArray[np.float64]:
    """How many chords there should be up to each of finely spaced points (n, 2) of a curve; (n,), starting at 0."""
    step = np.diff(points, axis=0)
    length = np.hypot(step[:, 0], step[:, 1])
    heading = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
    density = np.sqrt(np.abs(np.gradient(heading)) * length / (8 * tolerance))
    if spacing is not None:
        density = np.maximum(density, length / spacing)
    return np.concatenate(((0.0,), np.cumsum(density)))


def _sagitta(curve: Curve, chosen: NDArray[np.float64], points: NDArray[np.float64]) -> float:
    """Largest distance of the curve from the chord over it."""
    between = chosen[:-1, None] + _WITHIN * np.diff(chosen)[:, None]
    away = curve(between.ravel()).reshape(*between.shape, 2) - points[:-1, None]
    along = np.diff(points, axis=0)[:, None]
    cross = along[..., 0] * away[..., 1] - along[..., 1] * away[..., 0]
    length = np.hypot(along[..., 0], along[..., 1])
    away_from_point = np.hypot(away[..., 0], away[..., 1])
    return float(
        np.max(np.where(length > 0.0, np.abs(cross) / np.where(length > 0.0, length, 1.0), away_from_point))
    )
