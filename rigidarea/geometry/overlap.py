"""Overlap of two placed outlines: its connected regions, each with area, centroid and chord.

Four algorithms, one result. Small convex pairs of polygons (boxes, most game polygons) are clipped edge by edge
(Sutherland & Hodgman, Commun ACM 17, 1974). A disc with a disc is a lens, with any convex outline one walk round that
(`disc.py`). Small convex pairs with arcs that cross twice take their one region from there (`convex.py`). Everything
else, with holes, concave, thousands of edges, arcs, goes the general way:

1. *Crossings.* Both hierarchies are walked together; where two leaves meet, edge pairs are tested with the exact
   predicate of `predicates.side`. A crossing is where A's boundary enters B (+1) or leaves it (-1); where A leaves
   B, B enters A, and the other way round. Cost follows the contact, not the outlines.
2. *Loops.* Follow A from where it enters B to where it leaves; change to B, which enters A there, until it leaves;
   change back. Crossings of one ring alternate, so every crossing lies on exactly one loop and every loop closes.

            B ___________           A: entering at p, leaving at q: the arc p..q of A lies inside B
             /     q__p  \\          B: entering at q, leaving at p: the arc q..p of B lies inside A
        ____/_____/    \\__\\__       p..q..p, counter-clockwise, is the region; the chord of A's arc is q - p
         A                            and of B's arc p - q: equal and opposite by construction

3. *Rings without a crossing* lie wholly inside the other outline or wholly outside: one point decides.
4. *Signs.* A loop with positive area is a region, one with negative area is a hole of the region around it.

Degenerate cases of polygons need no code: the predicate shifts B by an infinitesimal (see `predicates`), after which
there are none. What the shift leaves behind, loops of no area, is dropped. With arcs the signs are those of a filter
(`arc`); where it cannot tell the answer is TANGLED, and `place.overlap_of_outlines` asks again with B shifted in
earnest. So each answer is that of boundaries moved by rounding, or by that shift, with all signs beyond doubt:
crossings come in pairs, their order alternates (`sequence`), of a ring without a crossing any corner tells where it is.
What is no wider than the rounding, or than the shift, is dropped: no force comes of it. An answer that no two outlines
allow (`impossible`) would say that one of these arguments is wrong; it is CAUGHT, and asked again like a tangle.

Differences from the paper: Alg. 1 asks for a node of each body inside the other and for two crossings; here a region
is there when its area is positive, however many crossings it has, and whatever nodes (theory 1). Area and centroid
are Eq. 4 and Eq. 7, taken relative to a point of the region.

Everything is computed in A's frame, with B placed relative to A, so that a common offset costs no digits.
Kernel arguments: a `Pool` and the number of an outline in it for A and for B, a `Relative` pose, a `Work`.
"""

from __future__ import annotations

import numpy as np

from ..compile.jit import kernel
from .clip import clip
from .convex import convex_pair
from .disc import disc_convex
from .loops import general
from .pool import Pool
from .two_discs import disc_disc
from .work import (
    A_EDGE,
    B_EDGE,
    CAUGHT,
    LOOP,
    OTHERWISE,
    OVERFLOW,
    TANGLED,
    Relative,
    Work,
    enlarged,
    fits,
    new_work,
    noise_of,
    relative,
)

#: At most this many edge pairs for the clipping of convex outlines; above, the hierarchy is faster.
CLIP_PAIRS = 64
#: At most this many edge pairs for the walk round two convex outlines with arcs: two rounded boxes have 64.
WALKED_PAIRS = 144

__all__ = [
    "A_EDGE",
    "B_EDGE",
    "CAUGHT",
    "LOOP",
    "OVERFLOW",
    "TANGLED",
    "Relative",
    "Work",
    "enlarged",
    "fits",
    "new_work",
    "overlap_kernel",
    "relative",
]


@kernel
def impossible(loops: np.ndarray, n: int, most: float) -> bool:
    """Whether n regions are together larger than `most` (length^2), or one of them is not positive."""
    total = 0.0
    for k in range(n):
        if not loops[k].area > 0.0:
            return True
        total += loops[k].area
    return total > most


@kernel
def checked(
    heads_a: np.ndarray, ia: int, heads_b: np.ndarray, ib: int, rel: Relative, loops: np.ndarray, n: int
) -> int:
    """n, the number of regions of two outlines one of which has arcs; or CAUGHT, if they are `impossible`.

    (Called where it is needed, and from its own arguments: what it needs would else be kept all the while.)
    """
    a = heads_a[ia]
    b = heads_b[ib]
    # rounding moves the smaller's boundary by the noise
    noise = noise_of(a.radius, b.radius, rel)
    most = min(a.area, b.area) * (1.0 + 1e-9) + 8.0 * noise * min(a.radius, b.radius)
    return CAUGHT if impossible(loops, n, most) else n


@kernel
def overlap_kernel(pa: Pool, ia: int, pb: Pool, ib: int, rel: Relative, work: Work) -> int:
    """Regions of A and B placed by `rel`: their number, work.loops[:number]; or OVERFLOW, TANGLED, CAUGHT.

    The work must hold the two outlines (`fits`). Holes of regions follow them in work.loops where there are any.
    """
    ha = pa.heads[ia]
    hb = pb.heads[ib]
    if ha.convex and hb.convex:
        if ha.disc and hb.disc:
            return disc_disc(ha.radius, hb.radius, rel, work.polygon, work.label, work.bows, work.loops)
        noise = noise_of(ha.radius, hb.radius, rel)
        n = OTHERWISE
        if ha.disc or hb.disc:
            pool, head, own, place = pa, ha, A_EDGE, Relative(1.0, 0.0, 0.0, 0.0)
            x = rel.tx
            y = rel.ty
            radius = hb.radius
            if ha.disc:
                pool, head, own, place = pb, hb, B_EDGE, rel
                x = 0.0
                y = 0.0
                radius = ha.radius
            n = disc_convex(
                x, y, radius, pool.points, pool.arcs, pool.boxes, head.point, head.count, head.box + head.leaves, place,
                own, work.polygon, work.label, work.bows, work.loops, noise,
            )  # fmt: skip
        elif ha.arcs + hb.arcs == 0:
            if ha.count * hb.count <= CLIP_PAIRS:
                return clip(
                    pa.points, ha.point, ha.count, pb.points, hb.point, hb.count, rel,
                    work.polygon, work.label, work.bows, work.loops, noise,
                )  # fmt: skip
        elif ha.count * hb.count <= WALKED_PAIRS:
            n = convex_pair(
                pa.points, pa.arcs, pa.boxes, ha.point, ha.count, ha.box + 1,
                pb.points, pb.arcs, pb.boxes, hb.point, hb.count, hb.box + 1, rel,
                work.polygon, work.label, work.bows, work.loops, noise,
            )  # fmt: skip
        if n == 1 and 0.0 < work.loops[0].area <= min(ha.area, hb.area):  # nearly always: as `checked` has it
            return 1
        if n > 0:
            return checked(pa.heads, ia, pb.heads, ib, rel, work.loops, n)
        if n != OTHERWISE:
            return n
    n = general(pa, ia, pb, ib, rel, work)
    if n > 0 and ha.arcs + hb.arcs > 0:
        return checked(pa.heads, ia, pb.heads, ib, rel, work.loops, n)
    return n
