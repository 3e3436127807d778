"""Outlines from SVG drawings: paths and basic shapes, curves sampled by a tolerance."""

from __future__ import annotations

import io
import math
import os
import re
from typing import TYPE_CHECKING, Any

import numpy as np

from ..gate import truth
from ..outline import Outline
from .limits import LIMITS, Limits, allowed, check, read, text
from .rings import Ring, curve_tolerance, outlines_of_polygons, polygons_of_rings

if TYPE_CHECKING:
    from svgelements import Path

#: svgelements is Python: a drawing of this size may take it half a minute.
SVG_BYTES = 2 * 2**20
#: Things that can make a small file a large drawing, or reach beyond the file.
REFUSED = re.compile(r"<\s*!\s*(DOCTYPE|ENTITY)|<\s*(\w+:)?(use|script|foreignObject)\b", re.IGNORECASE)


def outlines_from_svg(
    source: str | os.PathLike[str],
    *,
    scale: float = 1.0,
    flip: bool = False,
    tolerance: float | None = None,
    limits: Limits = LIMITS,
) -> list[Outline]:
    """Outlines from an SVG file: one for every connected solid of every path, rectangle, circle, ellipse, polygon.

    Within one element what lies within an odd number of its rings is solid, so letters keep their holes; whether it
    is filled or stroked is not asked. Transforms and units are applied; lengths are CSS pixels times `scale`. y
    points down as in the file, or up with `flip`. tolerance: largest sagitta of a chord in place of a curve (length;
    None: a thousandth of the element's smaller extent).

    Raises ValueError for what is no SVG, for a file that uses entities, scripts or <use> (a short one can unfold
    without end), for rings that cross, and for more than `limits` allow.
    """
    from svgelements import SVG, Shape
    from svgelements import Path as SvgPath

    allowed(limits), truth(flip, "flip")
    content = text(read(source, limits._replace(bytes=min(limits.bytes, SVG_BYTES))), str(source))
    refused = REFUSED.search(content)
    if refused:
        raise ValueError(f"{source}: expected a plain drawing, got {refused.group()!r}")
    check(content.count("<"), limits.parts, "elements")
    depth = _depth(content)
    if depth > limits.depth:
        raise ValueError(f"{source}: expected at most {limits.depth} elements within each other, got {depth}")
    made: list[Outline] = []
    try:
        drawing = SVG.parse(io.StringIO(content), reify=True)
        if not isinstance(drawing, SVG):
            raise ValueError(f"{source}: expected an SVG drawing, got one without an <svg> around it")
        for element in drawing.elements():
            if isinstance(element, Shape):
                path: Any = abs(SvgPath(element))
                made += _outlines_of(path, scale, flip, tolerance, limits)
                check(len(made), limits.parts, "outlines")
    except ValueError as error:
        raise (
            error if "expected" in str(error) or "ring" in str(error) else _no_drawing(source, error)
        ) from None
    except Exception as error:  # the parser knows no error of its own: XML's, and whatever odd values lead to
        raise _no_drawing(source, error) from None
    return made


def _no_drawing(source: object, error: Exception) -> ValueError:
    return ValueError(f"{source}: expected an SVG drawing: {type(error).__name__}: {error}"[:300])


def _depth(content: str) -> int:
    """How deep elements are nested, as far as tags tell; what is malformed is left to the parser."""
    depth = deepest = 0
    for tag in re.finditer(r"<(/?)\w[^<>]*?(/?)>", content):
        if tag.group(1):
            depth -= 1
        elif not tag.group(2):
            depth += 1
            deepest = max(deepest, depth)
    return deepest


def _outlines_of(
    path: Path, scale: float, flip: bool, tolerance: float | None, limits: Limits
) -> list[Outline]:
    box = path.bbox()
    if box is None or not all(map(math.isfinite, box)):
        if box is None:
            return []
        raise ValueError(f"expected finite coordinates, got a path in {box}")
    allowed = curve_tolerance(tolerance, tuple(scale * c for c in box))
    rings: list[Ring] = []
    points: list[complex] = []
    total = 0
    for segment in path:
        name = type(segment).__name__
        if name == "Move":
            rings += _closed(points, scale, flip)
            points = [_plain(segment.end)]
        elif name == "Close":
            rings += _closed(points, scale, flip)
            points = [points[0]] if points else []
        else:
            n = _pieces(segment, name, allowed / scale)
            total += n
            check(total, limits.points, "points")
            points += [_plain(segment.point(i / n)) for i in range(1, n + 1)]
    rings += _closed(points, scale, flip)
    return outlines_of_polygons(polygons_of_rings(rings, limits), 0.0, limits)


def _closed(points: list[complex], scale: float, flip: bool) -> list[Ring]:
    if len(points) < 3:
        return []
    ring = np.array(points)
    return [scale * np.column_stack((ring.real, -ring.imag if flip else ring.imag))]


def _plain(point: Any) -> complex:
    return complex(float(point.x), float(point.y))


def _pieces(segment: Any, name: str, tolerance: float) -> int:
    """Chords of a segment whose sagitta stays below `tolerance`.

    A curve's chord over 1/n of its parameter is off by at most max|B''| / (8 n²); Bézier curves' second derivatives
    are bounded by their control points' second differences. An arc's ellipse is off by no more than its large circle.
    """
    if name == "QuadraticBezier":
        second = 2 * abs(_plain(segment.start) - 2 * _plain(segment.control) + _plain(segment.end))
    elif name == "CubicBezier":
        a, b, c, d = map(_plain, (segment.start, segment.control1, segment.control2, segment.end))
        second = 6 * max(abs(a - 2 * b + c), abs(b - 2 * c + d))
    elif name == "Arc":
        second = max(abs(segment.rx), abs(segment.ry)) * segment.sweep**2
    else:
        return 1
    if not math.isfinite(second):
        raise ValueError("expected finite coordinates in every path")
    return max(1, math.ceil(min(math.sqrt(second / (8 * tolerance)), 1e9)))
