"""Outlines of common shapes and mechanisms: each function returns an `Outline` that knows its curve.

All are centred on the origin of the body's coordinates unless they say otherwise. `tolerance` is the
largest sagitta of a chord (length), see `rigidarea.geometry.outline`; `Outline.sample(tolerance)` makes the same
shape again with another one.
"""

from .basic import box, capsule, circle, ring, rounded_polygon
from .cam import eccentric, flat_follower
from .gear import involute_gear
from .geneva_wheel import Geneva, geneva
from .internal import internal_gear

__all__ = [
    "Geneva",
    "box",
    "capsule",
    "circle",
    "eccentric",
    "flat_follower",
    "geneva",
    "internal_gear",
    "involute_gear",
    "ring",
    "rounded_polygon",
]
