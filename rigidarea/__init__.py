"""Rigid-body contact by overlap area for pymunk.

import pymunk, rigidarea as ra
contact = ra.attach(space)  # of a pymunk.Space
space.step(1 / 60)  # as ever
"""

from . import shapes
from .chipmunk import REGIONS, AreaContact, SimulationError, attach, attached
from .compile.chosen import backend
from .geometry.outline import Outline
from .overlap_queries import OVERLAP, OVERLAPS, covers, overlap, overlaps
from .plan import Plan, plan
from .queries import point_query, segment_query

__version__ = "0.2.0"

__all__ = [
    "OVERLAP",
    "OVERLAPS",
    "REGIONS",
    "AreaContact",
    "Outline",
    "Plan",
    "SimulationError",
    "attach",
    "attached",
    "backend",
    "covers",
    "overlap",
    "overlaps",
    "plan",
    "point_query",
    "segment_query",
    "shapes",
]
