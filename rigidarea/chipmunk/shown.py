"""What an arbiter of outlines says: the normal and the points of the regions in which they overlap.

Chipmunk finds contact points of proxy shapes. Before a callback of the user's looks at them they are overwritten
(`show`): the normal is that of the largest region, and each of the two largest is a point, from A's farthest into B to
B's farthest into A along the region's own direction.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..compile.jit import kernel
from ..compile.raw_memory import array_at, record

#: What was found of the pair that Chipmunk is at; its addresses are Chipmunk's.
SHOWN = record(
    [
        ("collide_at", "u8"),  # what Chipmunk does with a pair of shapes whose boxes meet
        ("class_at", "u8"),  # of its index of what moves, and that class's function that asks for these pairs
        ("reindex_at", "u8"),
        ("spied_at", "u8"),  # what is done with a pair in the place of `collide_at`
        ("begin_at", "u8"),  # Python's begin and pre_solve
        ("pre_solve_at", "u8"),
        ("first_at", "u8"),  # what is called in the place of that pre_solve
        ("shape_a", "u8"),  # A of the regions
        ("count", "i8"),  # how many regions are to be shown, 0: none
        ("arbiter", "u8"),  # the arbiter that shows them
        ("nx", "f8"),  # direction of the largest, A to B
        ("ny", "f8"),
    ]
    + [
        (f"{which}{axis}{i}", "f8") for i in range(2) for which in "ab" for axis in "xy"
    ]  # points, world (length)
)


@kernel(inline="always")
def shown_of(s: Any) -> Any:
    """The record of an attached space."""
    return array_at(s.shown_at, (1,), SHOWN)[0]


@kernel
def show(s: Any, space: int, arbiter: int) -> None:
    """Write what was found of the pair into its arbiter, unless that has been done."""
    t = shown_of(s)
    if t.count == 0:
        return
    both = array_at(arbiter + s.arbiter_shape_a, (4,), np.uint64)  # shapes A and B, their bodies
    same = both[0] == t.shape_a  # Chipmunk sorts a pair by class
    sign = 1.0 if same else -1.0
    n = array_at(arbiter + s.arbiter_normal, (2,), np.float64)
    n[0] = sign * t.nx
    n[1] = sign * t.ny
    points = array_at(arbiter + s.arbiter_count, (1,), np.int32)
    contacts = array_at(arbiter + s.arbiter_contacts, (1,), np.uint64)[0]
    if points[0] == 1 and t.count == 2:  # its buffer has room for two
        used = array_at(array_at(space + s.space_contacts, (1,), np.uint64)[0] + 16, (1,), np.uint32)
        used[0] += np.uint32(1)
        one = array_at(contacts, (2, s.contact_size // 8), np.uint64)
        for k in range(one.shape[1]):
            one[1, k] = one[0, k]
        carried = array_at(contacts + s.contact_size + s.contact_normal_impulse, (2,), np.float64)
        carried[0] = 0.0
        carried[1] = 0.0
    points[0] = t.count
    a = array_at(both[2] + s.body_position, (2,), np.float64)
    b = array_at(both[3] + s.body_position, (2,), np.float64)
    for i in range(t.count):
        ax, ay, bx, by = (t.ax0, t.ay0, t.bx0, t.by0) if i == 0 else (t.ax1, t.ay1, t.bx1, t.by1)
        if not same:
            ax, ay, bx, by = bx, by, ax, ay
        arms = array_at(contacts + i * s.contact_size, (4,), np.float64)
        arms[0] = ax - a[0]
        arms[1] = ay - a[1]
        arms[2] = bx - b[0]
        arms[3] = by - b[1]
    va = array_at(both[0] + s.shape_surface_velocity, (2,), np.float64)
    vb = array_at(both[1] + s.shape_surface_velocity, (2,), np.float64)
    x = vb[0] - va[0]
    y = vb[1] - va[1]
    along = x * n[0] + y * n[1]
    surface = array_at(arbiter + s.arbiter_surface, (2,), np.float64)
    surface[0] = x - along * n[0]
    surface[1] = y - along * n[1]
    t.count = 0
    t.arbiter = arbiter
