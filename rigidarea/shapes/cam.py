"""Cams and what follows them: an eccentric disc, and a lever with a flat face."""

from __future__ import annotations

from functools import partial

import numpy as np

from ..geometry.arcs import circle_points
from ..geometry.gate import finite, not_negative, positive
from ..geometry.outline import Outline


def eccentric(
    radius: float, eccentricity: float, bore: float = 0.0, *, tolerance: float | None = None
) -> Outline:
    """A disc that turns about a point of its own: the origin, where its bore is; its centre lies at (eccentricity, 0).

    Lengths; bore: radius of the hole, 0 for none. tolerance: largest sagitta, default a thousandth of the radius. A
    flat follower perpendicular to its direction of motion is lifted by eccentricity · cos of the disc's angle to it.
    Raises ValueError for lengths out of range and a bore that leaves the disc.
    """
    positive(radius, "radius")
    not_negative(bore, "bore")
    if not 0 <= finite(eccentricity, "eccentricity") < radius - bore:
        raise ValueError(
            f"eccentricity must lie in [0, radius − bore = {radius - bore:.6g}), got {eccentricity!r}"
        )
    sagitta = 1e-3 * radius if tolerance is None else positive(tolerance, "tolerance")
    holes = [circle_points((0, 0), bore, sagitta)] if bore > 0 else []
    outline = Outline(circle_points((eccentricity, 0), radius, sagitta), holes)
    return outline.with_curve(partial(eccentric, radius, eccentricity, bore))


def flat_follower(
    length: float,
    height: float,
    bore: float = 0.0,
    *,
    overhang: float | None = None,
    tolerance: float | None = None,
) -> Outline:
    """A lever whose lower face, y = −height/2, is the flat that a cam pushes; it turns about the origin.

    length: from the pivot to the free end, along x. height: of the lever. bore: radius of the pivot's hole, 0 for
    none. overhang: how far it goes on beyond the pivot, default its height. tolerance: largest sagitta of the bore,
    default a thousandth of the height. Raises ValueError for lengths out of range and a bore that leaves the lever.
    """
    positive(length, "length")
    positive(height, "height")
    back = height if overhang is None else positive(overhang, "overhang")
    if not (0 <= finite(bore, "bore") < min(height / 2, back, length)):
        raise ValueError(
            f"bore must lie in [0, {min(height / 2, back, length):.6g}), inside the lever, got {bore!r}"
        )
    sagitta = 1e-3 * height if tolerance is None else positive(tolerance, "tolerance")
    corners = np.array(
        [[-back, -height / 2], [length, -height / 2], [length, height / 2], [-back, height / 2]]
    )
    outline = Outline(corners, [circle_points((0, 0), bore, sagitta)] if bore > 0 else [])
    return outline.with_curve(partial(flat_follower, length, height, bore, overhang=back))
