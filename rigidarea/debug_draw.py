"""Outlines as `pymunk.Space.debug_draw` paints them: themselves, not the proxy shapes that pymunk's broad phase sees.

An attached space does so with whatever options it is given (`true_outlines`). `rigidarea.pygame_util`,
`rigidarea.pyglet_util` and `rigidarea.matplotlib_util` have pymunk's `DrawOptions` with contact regions and forces
drawn over the shapes. None of it imports a library that draws.
"""

from __future__ import annotations

import importlib
import math
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import lru_cache
from typing import Any, Protocol

import numpy as np
import pymunk
import shapely
from pymunk.space_debug_draw_options import SpaceDebugColor as Color

from .geometry.arcs import Points
from .geometry.outline import Outline, outline_on
from .overlap_queries import overlap

#: Largest sagitta of what is drawn in the place of an arc (length of the drawing: a pixel, where that is its unit).
DETAIL = 0.05
#: The longest force of a picture, from end to end, over the root of the drawn bodies' mean area (dimensionless).
LONGEST = 0.7


@lru_cache(maxsize=1024)
def _rings(outline: Outline, tolerance: float) -> tuple[Points, ...]:
    return outline.sample(tolerance).rings


@lru_cache(maxsize=1024)
def _triangles_of(outline: Outline, tolerance: float) -> Points:
    return _triangles(_rings(outline, tolerance))


def _triangles(rings: Sequence[Points]) -> Points:
    """(n, 3, 2): triangles between the points of rings, the outer one and holes, that cover what is between them."""
    outer, *holes = rings
    parts = shapely.constrained_delaunay_triangles(shapely.Polygon(outer, holes))
    corners: Points = shapely.get_coordinates(shapely.get_parts(parts)).reshape(-1, 4, 2)[:, :3]
    return corners


class HasRegions(Protocol):
    """What is drawn of a contact: `AreaContact` is one."""

    @property
    def regions(self) -> Any:
        """Structured array, a row a region."""


class OutlineOptions(pymunk.SpaceDebugDrawOptions):
    """pymunk's drawing options, for outlines: to be inherited before a class that draws.

    A class of your own needs no more than pymunk's `draw_polygon` and `draw_segment`: an outline comes as triangles
    and its boundary as segments. Where your library fills rings with holes, override `draw_rings`.
    """

    region_color = Color(213, 94, 0, 255)
    """Of contact regions, where there is a `contact`."""
    force_color = Color(120, 30, 0, 255)
    """Of the forces in them."""
    contact: HasRegions | None = None
    """Its regions and forces are drawn over the shapes; None: they are not."""
    _shape: pymunk.Shape | None = None

    def color_for_shape(self, shape: pymunk.Shape) -> Color:
        """The colour of a shape: Chipmunk asks for it before it draws the shape."""
        outline = outline_on(shape)
        self._shape = shape if outline is not None and outline.proxied else None
        return super().color_for_shape(shape)

    def draw_circle(
        self, pos: pymunk.Vec2d, angle: float, radius: float, outline_color: Color, fill_color: Color
    ) -> None:
        """A circle, or the outline whose proxy it is."""
        if not self._draw_outline(outline_color, fill_color):
            super().draw_circle(pos, angle, radius, outline_color, fill_color)

    def draw_polygon(
        self, verts: Sequence[tuple[float, float]], radius: float, outline_color: Color, fill_color: Color
    ) -> None:
        """A convex polygon, or the outline whose proxy it is."""
        if not self._draw_outline(outline_color, fill_color):
            corners = [pymunk.Vec2d(*corner) for corner in verts]
            super().draw_polygon(corners, radius, outline_color, fill_color)

    def _draw_outline(self, outline_color: Color, fill_color: Color) -> bool:
        """Draw the outline of the shape that is being drawn; False: it has none but what pymunk sees."""
        shape, self._shape = self._shape, None
        if shape is None or shape.body is None:
            return False
        t = self.transform
        scale = math.sqrt(abs(t.a * t.d - t.b * t.c)) or 1.0
        # to a power of two, so that what zooms samples anew only now and then
        tolerance = 2.0 ** math.floor(math.log2(DETAIL / scale))
        outline: Outline = shape.outline  # type: ignore[attr-defined]
        rings = [self._drawn(ring, shape.body) for ring in _rings(outline, tolerance)]
        triangles = _triangles_of(outline, tolerance)
        drawn = self._drawn(triangles.reshape(-1, 2), shape.body).reshape(triangles.shape)
        self.draw_rings(rings, drawn, outline_color, fill_color)
        return True

    def _drawn(self, points: Points, body: pymunk.Body) -> Points:
        """Points (n, 2) of a body, as they are drawn."""
        c, s = body.rotation_vector
        return self._transformed(points @ np.array([[c, s], [-s, c]]) + tuple(body.position))

    def _transformed(self, points: Points) -> Points:
        t = self.transform
        return points @ np.array([[t.a, t.b], [t.c, t.d]]) + (t.tx, t.ty)

    def draw_rings(
        self, rings: Sequence[Points], triangles: Points, outline_color: Color, fill_color: Color
    ) -> None:
        """Fill a polygon with holes: its rings, (n, 2) each, or the triangles (m, 3, 2) that it consists of."""
        for triangle in triangles.tolist():
            super().draw_polygon([pymunk.Vec2d(*corner) for corner in triangle], 0.0, fill_color, fill_color)
        for ring in rings:
            ends = [pymunk.Vec2d(*corner) for corner in ring.tolist()]
            for i, end in enumerate(ends):
                self.draw_segment(ends[i - 1], end, outline_color)

    def __exit__(self, *raised: Any) -> None:
        if self.contact is not None and raised[0] is None:
            self._draw_contact(self.contact)
        super().__exit__(*raised)

    def _draw_contact(self, contact: HasRegions) -> None:
        """The regions where the bodies are now, and the forces of the last substep, as long as their roots."""
        regions = contact.regions
        pairs = dict.fromkeys(zip(regions["shape_a"].tolist(), regions["shape_b"].tolist()))
        for a, b in pairs:
            for polygon in _common(a, b):
                rings = [self._transformed(polygon)]
                self.draw_rings(rings, _triangles(rings), self.region_color, self.region_color)
        if len(regions) == 0:
            return
        n = regions["direction"]
        force = regions["force"][:, None] * n
        force += regions["friction"][:, None] * np.column_stack((-n[:, 1], n[:, 0]))
        size = np.hypot(*force.T)
        if not size.max() > 0:
            return
        areas = [Outline.from_pymunk(s).area for pair in pairs for s in pair if not _is_fixed(s)]
        longest = LONGEST * math.sqrt(float(np.mean(areas))) if areas else 1.0
        with np.errstate(invalid="ignore", divide="ignore"):
            half = np.where(size > 0, longest / 2 * np.sqrt(size / size.max()) / size, 0.0)[:, None] * force
        starts, ends = (self._transformed(regions["centroid"] + sign * half) for sign in (-1, 1))
        for start, end in zip(starts.tolist(), ends.tolist()):
            self.draw_segment(pymunk.Vec2d(*start), pymunk.Vec2d(*end), self.force_color)


def _is_fixed(shape: pymunk.Shape) -> bool:
    return shape.body is None or shape.body.body_type != pymunk.Body.DYNAMIC


def _common(a: pymunk.Shape, b: pymunk.Shape) -> list[Points]:
    """The polygons in which two shapes overlap where their bodies are; of a bare segment's two sides the smaller."""
    assert a.body is not None and b.body is not None
    places = [(*shape.body.position, shape.body.angle) for shape in (a, b) if shape.body is not None]
    outlines = [Outline.from_pymunk(shape) for shape in (a, b)]
    found = [
        overlap(one, places[0], other, places[1])
        for one in (outlines[0], outlines[0].mirror)
        for other in (outlines[1], outlines[1].mirror)
        if one is not None and other is not None
    ]
    least = min(found, key=lambda regions: float(regions["area"].sum()))
    return [np.asarray(polygon) for polygon in least["polygon"]]


#: pymunk's modules that draw, and those here that draw outlines with the same library.
BACK_ENDS = ("pygame_util", "pyglet_util", "matplotlib_util")
_classes: dict[type, type] = {}


def _with_outlines(plain: type[pymunk.SpaceDebugDrawOptions]) -> type:
    """A class of options like `plain` that draws outlines; made once."""
    if plain not in _classes:
        drawing: type = OutlineOptions
        for name in BACK_ENDS:
            theirs = sys.modules.get(f"pymunk.{name}")
            if theirs is not None and issubclass(plain, theirs.DrawOptions):
                drawing = importlib.import_module(f"rigidarea.{name}").Rings
        _classes[plain] = type(plain.__name__, (drawing, plain), {})
    return _classes[plain]


@contextmanager
def true_outlines(options: pymunk.SpaceDebugDrawOptions) -> Iterator[None]:
    """Within it, options of any class draw outlines in the place of their proxies."""
    plain = type(options)
    if isinstance(options, OutlineOptions):
        yield
        return
    options.__class__ = _with_outlines(plain)
    try:
        yield
    finally:
        options.__class__ = plain
