"""`pymunk.matplotlib_util.DrawOptions` that draws outlines as they are, with their holes, and what happens at contacts.

Needs matplotlib (`pip install matplotlib`). pymunk warns that its own class may go one day (DeprecationWarning).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pymunk.matplotlib_util
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from pymunk.space_debug_draw_options import SpaceDebugColor as Color

from .debug_draw import OutlineOptions
from .geometry.arcs import Points

if TYPE_CHECKING:
    from .chipmunk import AreaContact

__all__ = ["DrawOptions"]


class Rings(OutlineOptions):
    """Adds a patch with holes to the axes."""

    ax: Any

    def draw_rings(
        self, rings: Sequence[Points], triangles: Points, outline_color: Color, fill_color: Color
    ) -> None:
        """Fill, with a line around it that stays inside."""
        closed = [np.concatenate((ring, ring[:1])) for ring in rings]
        codes = [[Path.MOVETO, *[Path.LINETO] * (len(ring) - 1), Path.CLOSEPOLY] for ring in rings]
        path = Path(np.concatenate(closed), np.concatenate(codes))
        patch = PathPatch(path, facecolor=fill_color.as_float(), edgecolor=outline_color.as_float())
        self.ax.add_patch(patch)
        patch.set_clip_path(patch)
        patch.set_clip_box(self.ax.bbox)


class DrawOptions(Rings, pymunk.matplotlib_util.DrawOptions):
    """Draw a space on matplotlib axes: `space.debug_draw(DrawOptions(ax))`.

    contact: what `rigidarea.attach` returned; its regions and forces are drawn over the shapes. None: they are not.
    All else is pymunk's.
    """

    def __init__(self, ax: Any, contact: AreaContact | None = None) -> None:
        super().__init__(ax)
        self.contact = contact
