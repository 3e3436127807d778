"""World to pixels: camera, palette, and outlines with holes as pygame can fill them."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
import pygame
import pymunk
import shapely
from numpy.typing import NDArray

from ..geometry.arcs import Points
from ..geometry.outline import Outline

Color = tuple[int, int, int]

#: Okabe and Ito's palette (safe for colour-blind readers), calmer ones first.
PALETTE: tuple[Color, ...] = (
    (86, 180, 233),  # sky
    (230, 159, 0),  # orange
    (0, 158, 115),  # green
    (204, 121, 167),  # purple
    (0, 114, 178),  # blue
    (240, 228, 66),  # yellow
    (140, 140, 150),  # grey
)
PAPER: Color = (252, 252, 250)
INK: Color = (45, 50, 58)
FAINT: Color = (150, 155, 162)
STATIC: Color = (176, 181, 188)
FORCE: Color = (120, 30, 0)
CONTACT: Color = (213, 94, 0)  # vermilion: kept for contacts
OVER: Color = CONTACT
UNDER: Color = (0, 114, 178)


def tint(color: Color, strength: float) -> Color:
    """The colour (r, g, b, 0 to 255) at a strength: 1 is full, 0 is paper; above 1, up to 2, it darkens to ink."""
    base, other, share = (PAPER, color, strength) if strength <= 1 else (color, INK, strength - 1)
    r, g, b = (round(p + (c - p) * share) for p, c in zip(base, other))
    return r, g, b


class Camera(NamedTuple):
    """Maps world coordinates (length, y up) to pixels (y down)."""

    x: float
    """World coordinates of the middle of `area`."""
    y: float
    scale: float
    """Pixels per length."""
    area: pygame.Rect

    @classmethod
    def fit(cls, view: tuple[float, float, float, float], area: pygame.Rect) -> Camera:
        """The camera that shows all of `view` (xmin, ymin, xmax, ymax) in `area`, undistorted."""
        xmin, ymin, xmax, ymax = view
        scale = min(area.width / (xmax - xmin), area.height / (ymax - ymin))
        return cls((xmin + xmax) / 2, (ymin + ymax) / 2, scale, area)

    def pixels(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """World points (n, 2) to pixels (n, 2)."""
        x = self.area.centerx + (points[:, 0] - self.x) * self.scale
        y = self.area.centery - (points[:, 1] - self.y) * self.scale
        return np.rint(np.column_stack((x, y)))  # pygame would cut off, which leans to the upper left

    def world(self, pixel: tuple[float, float]) -> tuple[float, float]:
        """A pixel's place in the world."""
        return (
            self.x + (pixel[0] - self.area.centerx) / self.scale,
            self.y - (pixel[1] - self.area.centery) / self.scale,
        )


class Sketch(NamedTuple):
    """What is drawn of an outline, body coordinates (length)."""

    fill: Points
    """(n, 2): outer ring and holes as one closed walk, bridges walked twice."""
    rings: tuple[Points, ...]
    mark: Points
    """(2, 2): a stroke inside the solid along the body's x axis, to see it turn."""
    reach: float
    """Largest distance of a point from the body's origin."""


@lru_cache(maxsize=4096)
def sketch(outline: Outline, detail: float) -> Sketch:
    """The outline, simplified to `detail` (length), ready to be drawn."""
    polygon = shapely.simplify(outline.polygon, detail) if detail > 0 else outline.polygon
    if polygon.is_empty or polygon.geom_type != "Polygon":
        polygon = outline.polygon
    rings = tuple(
        np.asarray(shapely.get_coordinates(ring))[:-1] for ring in (polygon.exterior, *polygon.interiors)
    )
    reach = float(np.hypot(*rings[0].T).max())
    return Sketch(_bridged(rings), rings, _mark(polygon, reach), reach)


def _bridged(rings: tuple[Points, ...]) -> Points:
    """Outer ring and holes as one closed walk.

    A scan-line fill counts crossings, and a bridge walked there and back counts twice: the holes stay empty. Each
    hole hangs on the nearest point of the walk so far, so that the bridge runs inside the solid.
    """
    walk = rings[0]
    for hole in rings[1:]:
        distance = ((walk[:, None, :] - hole[None, :, :]) ** 2).sum(axis=2)
        i, j = np.unravel_index(int(np.argmin(distance)), distance.shape)
        walk = np.concatenate((walk[: i + 1], hole[j:], hole[: j + 1], walk[i:]))
    return walk


def _mark(polygon: shapely.Polygon, reach: float) -> Points:
    center = polygon.centroid
    start = center if polygon.contains(center) else polygon.representative_point()
    ray = shapely.LineString([(start.x, start.y), (start.x + 2 * reach, start.y)]).intersection(polygon)
    parts = [part for part in getattr(ray, "geoms", [ray]) if part.distance(start) < 1e-9 * reach]
    length = max((part.length for part in parts), default=0.0)
    return np.array([(start.x, start.y), (start.x + 0.7 * length, start.y)])


def placed(points: Points, body: pymunk.Body) -> Points:
    """Points (n, 2) in body coordinates, in the world."""
    c, s = body.rotation_vector
    return points @ np.array([[c, s], [-s, c]]) + tuple(body.position)


def placed_polygon(outline: Outline, body: pymunk.Body) -> shapely.Polygon:
    """The outline in the world."""
    outer, *holes = (placed(ring, body) for ring in outline.polygon_rings)
    return shapely.Polygon(outer, holes)
