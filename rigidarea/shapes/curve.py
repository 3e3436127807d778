"""A smooth curve as a chain of chords: as few points as the tolerance allows, all of them on the curve."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Curve = Callable[[NDArray[np.float64]], NDArray[np.float64]]
"""Parameters (n,) -> points (n, 2)."""

_FINE = 512  # steps in which curvature is measured: many more than any chord count that comes out


def sample_curve(
    curve: Curve, first: float, last: float, tolerance: float, spacing: float | None = None
) -> NDArray[np.float64]:
    """Points (n, 2) on `curve` from parameter `first` to `last`, both included.

    No chord's sagitta exceeds `tolerance` (length) and no chord is longer than `spacing` (length), if
    given. A chord of length ds on curvature κ has sagitta κ ds²/8, so chords of equal sagitta are spread
    with density sqrt(κ/(8·tolerance)) along the curve; the count is then raised until the sagittas,
    measured, obey.
    """
    fine = np.linspace(first, last, _FINE + 1)
    points = curve(fine)
    step = np.diff(points, axis=0)
    length = np.hypot(step[:, 0], step[:, 1])
    heading = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
    turn = np.abs(np.gradient(heading))
    density = np.sqrt(turn * length / (8 * tolerance))
    if spacing is not None:
        density = np.maximum(density, length / spacing)
    count = np.concatenate(((0.0,), np.cumsum(density)))
    chords = max(1, math.ceil(count[-1]))
    while True:
        at = np.linspace(0, count[-1], chords + 1)
        chosen = np.interp(at, count, fine) if count[-1] > 0 else np.linspace(first, last, chords + 1)
        sampled = curve(chosen)
        if _sagitta(sampled, chosen, points, fine) <= tolerance and (
            spacing is None or np.hypot(*np.diff(sampled, axis=0).T).max() <= spacing
        ):
            return sampled
        chords += 1


def _sagitta(
    sampled: NDArray[np.float64],
    chosen: NDArray[np.float64],
    points: NDArray[np.float64],
    fine: NDArray[np.float64],
) -> float:
    """Largest distance of the finely known curve from the chord over it."""
    sign = 1 if chosen[-1] > chosen[0] else -1
    chord = np.clip(np.searchsorted(sign * chosen, sign * fine, side="right") - 1, 0, len(chosen) - 2)
    start, along = sampled[chord], (sampled[1:] - sampled[:-1])[chord]
    away = points - start
    return float(np.max(np.abs(along[:, 0] * away[:, 1] - along[:, 1] * away[:, 0]) / np.hypot(*along.T)))
