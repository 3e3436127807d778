"""Which outline is under a point: what a mouse asks for."""

from __future__ import annotations

from ..compile.jit import entry
from .locate import inside_outline
from .pool import Pool
from .work import Relative, Work


@entry
def is_inside(pool: Pool, i: int, x: float, y: float, work: Work) -> bool:
    """Whether the point (x, y) of outline i's own frame, its middle at (0, 0), lies inside it."""
    return bool(inside_outline(pool, i, Relative(1.0, 0.0, 0.0, 0.0), x, y, True, work))
