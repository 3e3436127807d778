"""A result that no two outlines allow is caught where it arises, and decided again: never returned.

It does not arise by itself (counted over pairs that touch along tangents or coincide), so faults are planted too.
"""

from __future__ import annotations

import os
import subprocess
import sys
from typing import Any

import numpy as np
import pytest

import tangent_families
import test_arcs_random
from conftest import kernel_module


@pytest.mark.slow
def test_impossible_results_do_not_arise(kernel: Any) -> None:
    """Undecided pairs are plenty here; a result that no two outlines allow is none of them."""
    posed = [test_arcs_random.tangent(family, 7, 300, 20) for family in tangent_families.FAMILIES]
    outlines = [outline for p in posed for outline in p.outlines]
    start = np.repeat(np.cumsum([0, *(len(p.outlines) for p in posed[:-1])]), [len(p.first) for p in posed])
    first = start + np.concatenate([p.first for p in posed])
    a, b = np.concatenate([p.a for p in posed]), np.concatenate([p.b for p in posed])
    undecided, caught = kernel.refused(outlines, first, first + 1, a, b)
    assert undecided > 0.1 * len(first)
    assert caught == 0


def test_impossible_results_are_told(kernel: Any) -> None:
    """More area than the smaller outline has, or a region of none; entries and exits that do not alternate."""
    work = kernel.overlap.new_work()
    for areas, most, impossible in (
        ((0.5, 0.4), 1.0, False),
        ((0.5, 0.6), 1.0, True),
        ((0.5, -0.1), 1.0, True),
    ):
        work.loops["area"][:2] = areas
        assert kernel.overlap.impossible(work.loops, 2, most) == impossible
    alternate = kernel_module("sequence").alternate
    cross = np.array([[0, 0, 1], [0, 1, 1], [0, 2, -1], [0, 3, -1]], np.int32)
    for spots, near, wanted, want in (
        ([0, 1, 2, 3], 0.5, 1, None),  # in, in, out, out, and apart
        ([0, 1, 1.1, 3], 0.5, 1, [0, 2, 1, 3]),  # two in the middle as good as in one point
        ([0, 1, 1.1, 3], 0.5, -1, None),  # but that is no way out of it, if it starts inside
    ):
        order = np.arange(4, dtype=np.int32)
        spot = np.array([(x, 0.0) for x in spots])
        assert alternate(cross, spot, order, 0, wanted, near) == (want is not None)
        assert want is None or order.tolist() == want


#: Run without compilation, where a kernel's parts can be exchanged. Each fault spoils one answer of one way through two
#: outlines, once; what is asked for comes from the answer after it.
PLANTED = """
import math
import rigidarea as ra
from rigidarea import shapes
from rigidarea.geometry import loops, overlap, place, pool, sequence

ring = shapes.ring(0.5, 1.0)
moon = ra.Outline.from_bulges([(0, -0.8, 1.0), (0, 0.8, -0.5)])
disc, box, capsule = ra.Outline.circle(0.5), shapes.box(1, 1), shapes.capsule(1.0, 0.25)
ways = {
    ("general", overlap): (ring, moon, (0.3, 0.1, 0.3)),
    ("disc_convex", overlap): (disc, box, (0.3, 0.9, 0.1)),
    ("convex_pair", overlap): (capsule, capsule, (0.3, 0.4, 0.1)),
}
faults = {
    "more than the smaller one": lambda work, n: (work.loops["area"].__setitem__(0, 9.0), n)[1],
    "no area": lambda work, n: (work.loops["area"].__setitem__(0, 0.0), n)[1],
    "negative": lambda work, n: (work.loops["area"].__setitem__(0, -0.1), n)[1],
    "not a number": lambda work, n: (work.loops["area"].__setitem__(0, math.nan), n)[1],
}
for (name, module), (a, b, (x, y, angle)) in ways.items():
    packed, work = pool.pack([a, b]), overlap.new_work()
    here = place.Pose(0.0, 0.0, 1.0, 0.0)
    there = place.Pose(x, y, math.cos(angle), math.sin(angle))
    rel = place.seen_from(packed.heads[0], here, packed.heads[1], there)
    n, _ = place.overlap_of_outlines(packed, 0, here, 1, there, work)
    want = work.loops["area"][:n].sum()
    assert n > 0 and 0.0 < want < min(a.area, b.area)
    real = getattr(module, name)
    for fault, spoil in faults.items():
        asked = []

        def once(*arguments):
            found = real(*arguments)
            asked.append(found)
            return spoil(work, found) if len(asked) == 1 else found

        setattr(module, name, once)
        assert overlap.overlap_kernel(packed, 0, packed, 1, rel, work) == overlap.CAUGHT, (name, fault)
        asked.clear()
        m, _ = place.overlap_of_outlines(packed, 0, here, 1, there, work)
        assert len(asked) == 2 and m == n, (name, fault)
        assert abs(work.loops["area"][:m].sum() - want) < 1e-12 * want, (name, fault)
        setattr(module, name, real)

# a crossing that is lost, so that pieces do not close, or is there twice, so that two neighbours are inside
real = loops.crossings
for change in (-1, 1):
    asked = []

    def spoiled(*arguments):
        k, work = real(*arguments), arguments[-1]
        asked.append(k)
        if len(asked) == 1:
            for table in (work.cross, work.param, work.spot):
                table[k] = table[k - 1]
            return k + change
        return k

    a, b, (x, y, angle) = ways["general", overlap]
    packed, work = pool.pack([a, b]), overlap.new_work()
    there = place.Pose(x, y, math.cos(angle), math.sin(angle))
    rel = place.seen_from(packed.heads[0], here, packed.heads[1], there)
    n, _ = place.overlap_of_outlines(packed, 0, here, 1, there, work)
    want = work.loops["area"][:n].sum()
    loops.crossings = spoiled
    assert overlap.overlap_kernel(packed, 0, packed, 1, rel, work) < overlap.OVERFLOW
    asked.clear()
    m, _ = place.overlap_of_outlines(packed, 0, here, 1, there, work)
    assert len(asked) == 2 and m == n and abs(work.loops["area"][:m].sum() - want) < 1e-12 * want
    loops.crossings = real
print("planted")
"""


def test_planted_impossible_results_are_caught_and_decided_again() -> None:
    """1e-12: the second answer is that of B moved by 16 roundings."""
    done = subprocess.run(
        [sys.executable, "-c", PLANTED],
        env={**os.environ, "NUMBA_DISABLE_JIT": "1"},
        capture_output=True,
        text=True,
    )
    assert done.stdout.strip() == "planted", done.stderr
