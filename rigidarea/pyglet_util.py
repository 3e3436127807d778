"""`pymunk.pyglet_util.DrawOptions` that draws outlines as they are, with their holes, and what happens at contacts.

Needs pyglet 2.1 (`pip install pyglet`).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pyglet
import pymunk.pyglet_util
from pymunk.space_debug_draw_options import SpaceDebugColor as Color

from .debug_draw import OutlineOptions
from .geometry.arcs import Points

if TYPE_CHECKING:
    from .chipmunk import AreaContact

__all__ = ["DrawOptions"]


class _Mesh(pyglet.shapes.ShapeBase):
    """Triangles (m, 3, 2) of one colour, as one vertex list of the batch."""

    _draw_mode = pyglet.gl.GL_TRIANGLES
    _vertex_list: Any
    _batch: Any
    _group: Any

    def __init__(self, triangles: Points, color: tuple[int, int, int, int], batch: Any) -> None:
        self._corners = triangles.reshape(-1, 2)
        self._rotation = 0
        self._x = self._y = 0
        self._rgba = color
        blend = pyglet.gl.GL_SRC_ALPHA, pyglet.gl.GL_ONE_MINUS_SRC_ALPHA
        super().__init__(len(self._corners), *blend, batch, pyglet.graphics.Group(0), None)

    def _create_vertex_list(self) -> None:
        n = self._num_verts
        self._vertex_list = self._program.vertex_list(
            n,
            self._draw_mode,
            self._batch,
            self._group,
            position=("f", self._corners.astype(np.float32).ravel().tolist()),
            colors=("Bn", self._rgba * n),
            translation=("f", (0.0, 0.0) * n),
            rotation=("f", (0.0,) * n),
        )

    def _update_vertices(self) -> None:
        self._vertex_list.position[:] = self._corners.ravel().tolist()


class Rings(OutlineOptions):
    """Adds an outline's triangles to pymunk's batch."""

    batch: Any
    draw_shapes: list[Any]

    def draw_rings(
        self, rings: Sequence[Points], triangles: Points, outline_color: Color, fill_color: Color
    ) -> None:
        """Fill; as pymunk's polygons, without a line around it."""
        self.draw_shapes.append(_Mesh(triangles, fill_color.as_int(), self.batch))


class DrawOptions(Rings, pymunk.pyglet_util.DrawOptions):
    """Draw a space in the current window: `space.debug_draw(DrawOptions())`, or into a `batch` of yours.

    contact: what `rigidarea.attach` returned; its regions and forces are drawn over the shapes. None: they are not.
    All else is pymunk's.
    """

    def __init__(self, *, contact: AreaContact | None = None, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.contact = contact
