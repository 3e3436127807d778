"""What outlives a step: a record a shape, a body, a pair, a region; pairs and regions in free lists."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .jit import kernel
from .memory import record

SHAPE = record(
    [
        ("address", "u8"),  # of the shape; 0: none
        ("outline", "i4"),  # number in the pool
        ("mirror", "i4"),  # the outline's other side, for a segment without thickness; -1: none
        ("inverse_mass", "f8"),  # of its body, as last seen; 0 for a sensor
        ("inverse_moment", "f8"),
        ("body", "i4"),  # row of its body
    ],
)

BODY = record(
    [
        ("stamp", "i8"),  # space step in which a contact last met it
        ("force_x", "f8"),  # what was in its accumulators after that
        ("force_y", "f8"),
        ("torque", "f8"),
        ("met_x", "f8"),  # force of all its contacts met in that step
        ("met_y", "f8"),
        ("met_turn", "f8"),
        ("old_x", "f8"),  # force, in the step before, of those not met yet
        ("old_y", "f8"),
        ("old_turn", "f8"),
        ("met_rate", "f8"),  # sum of rate2 of all its regions in that step
        ("old_rate", "f8"),  # in the step before
        ("crowded", "i4"),  # steps for which it still counts as touched by a body that can move
    ]
)

PAIR = record(
    [
        ("shape_a", "i8"),  # Chipmunk's shape ids, for finding the Python objects again
        ("shape_b", "i8"),
        ("head", "i4"),  # first region; -1: none
        ("side_a", "i4"),  # of a two-sided outline: 0 undecided, 1 itself, -1 its mirror
        ("side_b", "i4"),
        ("next", "i4"),  # in the free list
        ("stamp", "i8"),  # space step of the pull
        ("fx", "f8"),  # force on B (force)
        ("fy", "f8"),
        ("moment_a", "f8"),  # on each about its centre (force length)
        ("moment_b", "f8"),
    ],
)

#: Counters: free regions' list head, how many are free, free pairs' list head, how many.
FREE_REGION, FREE_REGIONS, FREE_PAIR, FREE_PAIRS = range(4)
COUNTERS = 4


class Tables(NamedTuple):
    """What outlives a step."""

    shapes: np.ndarray  # (n,) SHAPE
    bodies: np.ndarray  # (n,) BODY
    pairs: np.ndarray  # (n,) PAIR
    regions: np.ndarray  # (n,) REGION
    counters: np.ndarray  # (COUNTERS,) int64


@kernel
def new_pair(tables: Tables, shape_a: int, shape_b: int) -> int:
    """Take a pair from the free list; -1: there is none."""
    counters = tables.counters
    p = counters[FREE_PAIR]
    if p >= 0:
        pair = tables.pairs[p]
        counters[FREE_PAIR] = pair.next
        counters[FREE_PAIRS] -= 1
        pair.shape_a = shape_a
        pair.shape_b = shape_b
        pair.head = -1
        pair.side_a = 0
        pair.side_b = 0
        pair.next = -1
        pair.stamp = -1
    return p


@kernel
def free_regions(regions: np.ndarray, counters: np.ndarray, r: int) -> None:
    """Put the list that starts at region r onto the free list."""
    while r >= 0:
        after = regions[r].next
        regions[r].stamp = -1
        regions[r].next = counters[FREE_REGION]
        counters[FREE_REGION] = r
        counters[FREE_REGIONS] += 1
        r = after


@kernel
def end_pair(tables: Tables, p: int) -> None:
    """The two shapes have separated: forget the pair and its regions."""
    pair = tables.pairs[p]
    free_regions(tables.regions, tables.counters, pair.head)
    pair.head = -1
    pair.shape_a = -1
    pair.shape_b = -1
    pair.next = tables.counters[FREE_PAIR]
    tables.counters[FREE_PAIR] = p
    tables.counters[FREE_PAIRS] += 1
