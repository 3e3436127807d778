"""Outlines from pictures: the edge of what is opaque."""

from __future__ import annotations

import io
import itertools
import os
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from ..geometry.gate import finite, size, truth
from ..geometry.outline import Outline
from .formats import stripped
from .limits import LIMITS, Limits, allowed, check, read, shown
from .rings import outlines_of_polygons

ROUNDED = 1e-5
"""What a soft mask may be off 0 and 1 by: some roundings of float32."""


def outlines_from_image(
    source: str | os.PathLike[str],
    *,
    threshold: float = 0.5,
    scale: float = 1.0,
    flip: bool = False,
    tolerance: float | None = None,
    limits: Limits = LIMITS,
) -> list[Outline]:
    """Outlines of a picture file's opaque parts, largest first.

    source: path of a PNG, JPEG, BMP, GIF or WebP file, whatever its name says; of several frames the first counts.
    Opaque is what has more alpha than `threshold` (0 to 1); in a picture without an alpha channel, what is darker than
    that. scale, flip, tolerance, limits: as in `outlines_from_mask`.
    Raises ValueError for anything else, and for more pixels than `limits` allow (asked before decoding).
    """
    _check_options(threshold, scale, flip, tolerance)
    data = read(source, limits)
    try:
        kind, width, height, data = stripped(data)
        if not (width > 0 and height > 0):
            raise ValueError(f"expected width and height of at least 1 pixel, got {width} x {height}")
        check(width * height, limits.pixels, "pixels")
        padded = _solid(kind, (width, height), data)
    except ValueError as error:
        raise ValueError(f"{source}: expected a picture: {error}") from None
    return _outlines(padded, threshold, scale, flip, tolerance, limits)


def _solid(kind: str, size: tuple[int, int], data: bytes) -> NDArray[np.float64]:
    """How solid each pixel is, 0 to 1, with a row and a column of nothing on each side: (rows + 2, columns + 2)."""
    from PIL import Image, WebPImagePlugin  # the latter for Image to know it without asking for all it knows

    assert WebPImagePlugin is not None
    padded = np.zeros((size[1] + 2, size[0] + 2))
    inner = padded[1:-1, 1:-1]
    try:
        with Image.open(io.BytesIO(data), formats=[kind]) as picture:
            if picture.size != size:
                raise ValueError(f"its header says {size[0]} x {size[1]} pixels, there are {picture.size}")
            if picture.mode in ("RGBA", "LA", "PA") or "transparency" in picture.info:
                alpha = picture if picture.mode in ("RGBA", "LA", "PA") else picture.convert("RGBA")
                np.divide(np.asarray(alpha.getchannel("A")), 255.0, out=inner)
            else:
                np.divide(np.asarray(picture.convert("L")), -255.0, out=inner)
                inner += 1.0
    except MemoryError:
        raise
    except Exception as error:  # a damaged file may lead to any: OSError, SyntaxError, struct.error ...
        raise ValueError(f"{type(error).__name__}: {error}"[:200]) from None
    return padded


def outlines_from_mask(
    mask: ArrayLike,
    *,
    threshold: float = 0.5,
    scale: float = 1.0,
    flip: bool = False,
    tolerance: float | None = None,
    limits: Limits = LIMITS,
) -> list[Outline]:
    """Outlines of where a mask (rows, columns), 0 to 1, is above the threshold, holes included, largest first.

    The edge is the contour of the mask between pixels' centres, so soft edges give places finer than a pixel; beyond
    the picture nothing is solid. Coordinates: pixel (row i, column j) covers [j, j + 1] x [i, i + 1] times `scale`
    (length a pixel); y points down, or up with `flip`. tolerance: largest distance of a contour point that is dropped
    (length; None: half a pixel). Solids smaller than one pixel are dropped as specks.

    Raises ValueError for other shapes, values that are not finite or outside 0 to 1 (of 0 to 255: `mask / 255`), a
    threshold outside 0 to 1, too many pixels.
    """
    allowed(limits)
    _check_options(threshold, scale, flip, tolerance)
    try:
        given = np.asarray(mask, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"mask must be numbers of shape (rows, columns), got {shown(mask, 80)}") from None
    if given.ndim != 2 or 0 in given.shape:
        raise ValueError(f"mask must have shape (rows, columns), got {given.shape}")
    check(given.size, limits.pixels, "pixels")
    if not np.isfinite(given).all():
        raise ValueError("mask must be finite, got NaN or infinity")
    low, high = float(given.min()), float(given.max())
    if low < -ROUNDED or high > 1 + ROUNDED:
        hint = "; divide it by 255" if 1 < high <= 255 and low >= 0 else ""
        raise ValueError(f"mask must be from 0 to 1, got {low:g} to {high:g}{hint}")
    return _outlines(np.pad(given, 1), threshold, scale, flip, tolerance, limits)


def _check_options(threshold: float, scale: float, flip: bool, tolerance: float | None) -> None:
    if not 0 < finite(threshold, "threshold") < 1:
        raise ValueError(f"threshold must be between 0 and 1, got {threshold!r}")
    size(scale, "scale"), truth(flip, "flip")
    if tolerance is not None:
        size(tolerance, "tolerance")


def _outlines(
    padded: NDArray[np.float64],
    threshold: float,
    scale: float,
    flip: bool,
    tolerance: float | None,
    limits: Limits,
) -> list[Outline]:
    from contourpy import FillType, contour_generator

    dropped = 0.5 * scale if tolerance is None else tolerance
    above = padded > threshold
    crossed = np.count_nonzero(above[1:] != above[:-1]) + np.count_nonzero(above[:, 1:] != above[:, :-1])
    # contours have one where two pixels' centres lie on both sides
    check(int(crossed), limits.points, "points")
    contours: Any = contour_generator(z=padded, fill_type=FillType.OuterOffset)
    points, offsets = contours.filled(threshold, max(float(padded.max()), threshold) + 1.0)
    check(sum(map(len, offsets)) - len(offsets), limits.rings, "solids and holes")
    polygons = []
    for ring_points, ring_offsets in zip(points, offsets):
        placed = scale * (ring_points - 0.5)  # a pixel's value is at its centre; one row of padding
        if flip:
            placed = placed * (1.0, -1.0)
        rings = [placed[a:b] for a, b in itertools.pairwise(ring_offsets)]
        polygon = shapely.Polygon(rings[0], rings[1:])
        polygons += [part for part in _parts(polygon) if part.area >= scale**2]
    polygons.sort(key=lambda polygon: -polygon.area)
    return outlines_of_polygons(polygons, dropped, limits)


def _parts(polygon: shapely.Polygon) -> list[shapely.Polygon]:
    """A contour may touch itself in a point (pixels that meet in a corner): the valid parts that it is made of."""
    if shapely.is_valid(polygon):
        return [polygon]
    mended = shapely.make_valid(polygon)
    return [part for part in shapely.get_parts(mended) if isinstance(part, shapely.Polygon)]
