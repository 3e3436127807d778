"""`pymunk.pygame_util.DrawOptions` that draws outlines as they are, with their holes, and what happens at contacts.

Needs pygame or pygame-ce (`pip install "rigidarea[demos]"`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import pygame
import pymunk.pygame_util
from numpy.typing import NDArray
from pymunk.space_debug_draw_options import SpaceDebugColor as Color

from .debug_draw import OutlineOptions
from .geometry.arcs import Points

if TYPE_CHECKING:
    from .chipmunk import AreaContact

__all__ = ["DrawOptions"]


class Rings(OutlineOptions):
    """Fills rings on a surface, pixel by pixel: a pixel is painted if its point is inside (even-odd rule)."""

    surface: pygame.Surface

    def draw_rings(
        self, rings: Sequence[Points], triangles: Points, outline_color: Color, fill_color: Color
    ) -> None:
        """Fill, and paint the outermost pixels in the outline's colour."""
        if pymunk.pygame_util.positive_y_is_up:
            height = self.surface.get_height()
            rings = [ring * (1, -1) + (0, height) for ring in rings]
        at, inside = covered(rings, self.surface.get_clip())
        if not inside.any():  # thinner than a pixel, or out of sight
            for ring in rings:
                pygame.draw.aalines(self.surface, fill_color.as_int(), True, ring.tolist())
            return
        edge = inside.copy()
        edge[1:-1, 1:-1] &= ~(inside[:-2, 1:-1] & inside[2:, 1:-1] & inside[1:-1, :-2] & inside[1:-1, 2:])
        colors = np.array([(0, 0, 0, 0), fill_color.as_int(), outline_color.as_int()], np.uint8)
        pixels = colors[inside.astype(np.intp) + edge]
        image = pygame.image.frombuffer(pixels.tobytes(), inside.shape[::-1], "RGBA")
        self.surface.blit(image, at)


class DrawOptions(Rings, pymunk.pygame_util.DrawOptions):
    """Draw a space on a pygame surface: `space.debug_draw(DrawOptions(surface))`.

    contact: what `rigidarea.attach` returned; its regions and forces are drawn over the shapes. None: they are not.
    All else is pymunk's: `flags`, `transform`, `shape.color`, `pymunk.pygame_util.positive_y_is_up`.
    """

    def __init__(self, surface: pygame.Surface, contact: AreaContact | None = None) -> None:
        super().__init__(surface)
        self.contact = contact


def covered(rings: Sequence[Points], clip: pygame.Rect) -> tuple[tuple[int, int], NDArray[np.bool_]]:
    """((x, y), inside): which pixels' points are within the rings, (h, w) from the pixel (x, y) on, within `clip`.

    Every edge toggles, in each row that it crosses, all pixels to its right.
    """
    low = np.min([ring.min(axis=0) for ring in rings], axis=0)
    high = np.max([ring.max(axis=0) for ring in rings], axis=0)
    x0, y0 = (max(math.ceil(v), least) for v, least in zip(low, clip.topleft))
    x1, y1 = (min(math.floor(v) + 1, most) for v, most in zip(high, clip.bottomright))
    if x1 <= x0 or y1 <= y0:
        return (0, 0), np.zeros((0, 0), np.bool_)
    a = np.concatenate(rings)
    b = np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])
    lower, upper = np.minimum(a[:, 1], b[:, 1]), np.maximum(a[:, 1], b[:, 1])
    first = np.maximum(np.ceil(lower), y0).astype(np.intp)
    rows = np.maximum(np.minimum(np.ceil(upper), y1).astype(np.intp) - first, 0)
    edge = np.repeat(np.arange(len(a)), rows)
    y = first[edge] + np.arange(len(edge)) - np.repeat(np.cumsum(rows) - rows, rows)
    slope = (b[edge, 0] - a[edge, 0]) / (b[edge, 1] - a[edge, 1])
    x = np.ceil(a[edge, 0] + (y - a[edge, 1]) * slope)
    toggles = np.zeros((y1 - y0, x1 - x0 + 1), np.intp)
    np.add.at(toggles, (y - y0, np.clip(x, x0, x1).astype(np.intp) - x0), 1)
    return (x0, y0), np.cumsum(toggles[:, :-1], axis=1) % 2 == 1
