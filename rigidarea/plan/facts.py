"""What of a survey bears on the errors: of each mechanism the worst body, reduced once, judged often."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pymunk
from numpy.typing import NDArray

from . import estimates as est
from .curves import MANY_TEETH, Facet, facets_of, pockets, tooth, tooth_lever
from .survey import TOUCH, Array, Survey, bases, support


class Worst(NamedTuple):
    """The body for which a mechanism is worst, and what of it the error goes by."""

    value: float
    body: int


@dataclass
class Facts:
    """What of a survey bears on the errors: of each mechanism the worst body, so that a setting is judged in
    microseconds."""

    seen: Survey
    frame: float
    time: float
    tower: int  # layers of the highest pile
    wanted: float  # sweeps of Chipmunk's with which its loads are found
    shared: bool  # whether a body of it lies on two
    struck: float  # mass of what falls on another over that of the other, the largest; 0 where nothing does
    heavier: float  # mass of what lies or falls on another over that of the other, the largest; 1 at least
    flat: (
        Worst | None
    )  # how many times its depth a flush body sinks: what it carries, how near its base's edge it stands
    rounded: Worst | None  # 1 where a round body slips against friction, else 0
    corner: Worst | None  # 1/extent of a body near its balance on a corner (1/length)
    rocks: bool  # whether that one stands on its corner already, and does not tip from its face
    leaning: Worst | None  # 1/reach of a body that leans on one
    pile: Worst | None  # crossings/size of a body in a pile (1/length)
    crossings: float  # seams that a body slides over
    rough: bool  # whether there is friction
    column: int  # bodies in a row that may buckle: a tower's layers, or the stones of an arch
    landing: Worst | None  # 1/v at the first touch of a body that falls (time/length)
    blow: Worst | None  # v/extent of a body that falls and stays (1/time)
    bounce: Worst | None  # 1/v of the last bounce (time/length), of a body that falls
    elastic_bounce: bool  # e = 1: what is off comes back
    largest: float  # largest extent of what moves (length)
    slowest: Worst | None  # 1/v of what moves already and is pressed (time/length)
    toppling: float  # rate at which what stands on a corner falls (1/time)
    curves: Array  # (curves, 7): see `_curves`
    gap: tuple[float, int]  # least time between two touches in a row, body
    teeth: tuple[float, int]  # way of a tooth in a frame over its chord, shape
    driven: tuple[float, int]  # fastest spin of teeth times their lever (1/time), shape
    slots: tuple[float, int]  # fastest spin of slots, cams and hooks (1/time), shape
    tumbling: float  # fastest spin of what has corners (1/time)
    offset: float  # of discs that are about to meet: speed times offset over R² (1/time), the largest
    facets: list[Facet]
    facet_share: float  # error that the facets of a curve sampled anew may have
    fixed_turns: dict[int, float]  # turns between facets that the user has asked for (radians)
    overlapped: tuple[float, int]  # deepest overlap at the start over the extent, pair
    met: bool  # whether anything moves relative to anything else, so that it may be met

    @property
    def least_sweeps(self) -> int:
        """With fewer sweeps its loads are not found."""
        several = self.piled and (self.tower > 1 or (self.shared and self.leaning is not None))
        return est.LEAST_PILE_SWEEPS if several else est.LEAST_SWEEPS

    @property
    def least_steps(self) -> int:
        """With fewer substeps it may fall, or be let go."""
        return est.LEAST_PILE_STEPS if self.tower > 2 or self.heavier > est.MOST_HEAVIER else 1

    @property
    def seams(self) -> bool:
        """Whether what slides does so over what does not move: on one tile it is held, while it comes to the next."""
        return self.tower == 1 and self.crossings > 1.0

    @property
    def piled(self) -> bool:
        """Whether anything stands on, falls on, or slides over more than one."""
        return self.pile is not None


def _worst(values: Array, among: NDArray[np.bool_]) -> Worst | None:
    if not among.any():
        return None
    i = int(np.argmax(np.where(among, values, -math.inf)))
    return Worst(float(values[i]), i)


def facts(seen: Survey, frame: float, time: float) -> Facts:
    """Reduce a survey to what decides over a time, in frames of that length."""
    n, g, free, owner = len(seen.bodies), seen.g, seen.moves & ~seen.held, seen.owner
    layers, load, heavier, shared = support(seen)
    ratio = np.where(free, load / np.where(free, seen.mass, 1.0), 1.0)
    a, b = owner[seen.pairs].T
    reached = seen.gaps <= TOUCH * seen.thickness[seen.pairs].min(axis=1, initial=math.inf)
    reached |= seen.gaps <= (seen.speed[a] + seen.speed[b]) * AHEAD * frame
    partners = np.zeros(n, np.int64)
    np.add.at(partners, np.concatenate((a[reached], b[reached])), 1)
    drops, lands_on_free, falls_on = _drops(seen)
    heavier = max(heavier, falls_on)
    piled = free & (g > 0.0) & ((layers > 1) | (ratio > 1.0 + 1e-9) | (partners > 1) | lands_on_free)
    tower = int(layers[free].max(initial=1)) + bool(lands_on_free.any())
    extent = np.where(free, seen.extent, 1.0)
    crossings = np.where(partners > 1, np.maximum(1.0, seen.speed * time / extent), 1.0)
    polygon, turned, friction, elasticity = np.zeros(n, bool), np.zeros(n, bool), np.zeros(n), np.zeros(n)
    np.logical_or.at(polygon, owner, seen.radius == 0.0)
    np.logical_or.at(turned, owner, seen.corners)
    np.maximum.at(friction, owner, seen.friction)
    np.maximum.at(elasticity, owner, seen.elasticity)
    margin, upright = _margins(seen, turned)
    oblique = turned.copy()  # whatever they lie on: stones of an arch, steps on a slope
    turned &= ~_flush_with(seen, turned)
    corners = free & polygon & (g > 0.0) & (turned | (margin <= 0.0))
    speed = np.where(drops > 0.0, np.sqrt(seen.speed**2 + 2.0 * g * drops), 0.0)
    e = np.minimum(elasticity, 1.0) ** 2  # of a pair the product; the other side's is not known yet
    bounces = (speed > 0.0) & (e > 0.0) & free & (g > 0.0)
    last: Array = est.last_speed(np.where(bounces, speed, 1.0), max(g, 1e-300), e, time)
    slender = seen.reach / extent
    if tower > 1 and not shared:  # a load beside the middle leans on its base's edge, upright as it may stand
        beside, width = bases(seen)
        nearer = (beside > 0.0) & (beside < margin) & ~oblique
        margin, slender = np.where(nearer, beside, margin), np.where(nearer, seen.reach / width, slender)
    carried = (
        np.maximum(np.maximum(layers, ratio), np.where(piled, heavier, 1.0))
        * np.where(crossings > 1.0, est.SEAM * crossings, 1.0)
        * est.leaning(np.maximum(margin, 1e-3), slender)
    )
    held = partners > 1  # by its neighbours: it leans, and does not fall over
    leans = corners & (~upright | held)
    size = np.where(
        leans, np.maximum(seen.reach, extent), extent
    )  # by how much a ladder gives way is of its length
    leaning = _worst(1.0 / np.maximum(seen.reach, 1e-300), leans | (oblique & held & piled))
    corner = _worst(1.0 / extent, corners & upright & ~held)
    rim = 0.5 * seen.spin * np.where(np.isfinite(seen.extent), seen.extent, 0.0)
    slips = np.abs(seen.speed - rim) > SLIP * np.maximum(seen.speed, rim)
    toppling = _worst(1.0 / np.maximum(seen.reach, 1e-300), corners)
    moving = free & (g > 0.0) & (seen.speed > 0.0) & (drops == 0.0)
    return Facts(
        seen=seen,
        frame=frame,
        time=time,
        tower=tower,
        wanted=float(est.sweeps_wanted(float(tower), max(heavier, 1.0))),
        shared=shared,
        struck=falls_on if lands_on_free.any() else 0.0,
        heavier=heavier,
        flat=_worst(carried, free & polygon & ~corners & (g > 0.0)),
        rounded=_worst(np.where((friction > 0.0) & slips, 1.0, 0.0), free & ~polygon & (g > 0.0)),
        corner=corner,
        rocks=corner is not None and bool(turned[corner.body]),
        leaning=leaning,
        pile=_worst(crossings / size, piled),
        crossings=float(crossings[piled].max(initial=1.0)),
        rough=bool(friction[free].max(initial=0.0) > 0.0),
        column=max(tower, min(int((oblique & held & piled).sum()), 2 * tower)),
        landing=_worst(1.0 / np.maximum(speed, 1e-300), (speed > 0.0) & free),
        blow=_worst(speed / extent, (drops > 0.0) & (elasticity == 0.0) & free & polygon),
        bounce=_worst(1.0 / last, bounces),
        elastic_bounce=bool(bounces.any() and e[bounces].min() > 0.999),
        largest=float(seen.extent[free].max(initial=0.0)),
        slowest=_worst(1.0 / np.maximum(seen.speed, 1e-300), moving),
        toppling=math.sqrt(0.75 * g * toppling.value) if toppling else 0.0,
        curves=_curves(seen, time),
        gap=_gap(seen),
        teeth=_teeth(seen, frame),
        driven=_driven(seen, True),
        slots=_driven(seen, False),
        tumbling=float(seen.spin[free & polygon].max(initial=0.0)),
        offset=_offset(seen),
        facets=facets_of(seen, time),
        facet_share=0.0,
        fixed_turns={},
        overlapped=_overlapped(seen),
        met=len(owner) > 0 and bool(np.ptp(seen.velocity[owner], axis=0).any() or seen.spin[owner].any()),
    )


#: A disc whose rim and centre differ in speed by more than this part slips.
SLIP = 0.05
#: Frames for which pairs that a moving body may reach are looked for.
AHEAD = 6


def _margins(seen: Survey, turned: NDArray[np.bool_]) -> tuple[Array, NDArray[np.bool_]]:
    """How much of half its base lies between a flush body's weight and the base's edge: (bodies,) 1 - |lean|
    height/base.

    And (bodies,) which stand near their balance: no narrower a box than NARROW times as wide as they are thick.
    """
    margin = np.ones(len(seen.bodies))
    upright = np.zeros(len(seen.bodies), bool)
    wide, high = (seen.boxes[:, i + 2] - seen.boxes[:, i] for i in (0, 1))
    np.logical_or.at(upright, seen.owner, np.minimum(wide, high) < NARROW * seen.thickness)
    gx, gy = np.abs(seen.gravity)
    if seen.g == 0.0:
        return margin, upright
    lean = gx / gy * high / wide if gy >= gx else gy / gx * wide / high
    flat = seen.radius == 0.0
    np.minimum.at(margin, seen.owner[flat], 1.0 - lean[flat])
    margin[turned] = 1.0
    return margin, upright


def _flush_with(seen: Survey, turned: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """(bodies,) which turned bodies lie with an edge along an edge of what they touch. Of MOST_LOOKED_AT at the
    most."""
    flush = np.zeros(len(seen.bodies), bool)
    edges: dict[int, Array] = {}

    def directions(k: int) -> Array:
        if k not in edges:
            edges[k] = np.zeros(0)
            shape = seen.shapes[k]
            if isinstance(shape, pymunk.Poly) and seen.outlines[k] is None:
                body = seen.bodies[seen.owner[k]]
                ring = np.array(shape.get_vertices())
                along = np.roll(ring, -1, axis=0) - ring
                edges[k] = np.arctan2(along[:, 1], along[:, 0]) + body.angle
        return edges[k]

    close = seen.gaps <= TOUCH * seen.thickness[seen.pairs].min(axis=1, initial=math.inf)
    touching = seen.pairs[close & turned[seen.owner[seen.pairs]].any(axis=1)]
    for i, j in touching[:MOST_LOOKED_AT]:
        apart = np.abs(np.sin(directions(i)[:, None] - directions(j)[None, :]))
        if apart.size and apart.min() < PARALLEL:
            flush[[seen.owner[i], seen.owner[j]]] = True
    return flush


#: Angle (radians) up to which two edges are parallel: what lies on a face is put there to rounding, what leans is not.
PARALLEL = 1e-6
#: Pairs whose edges are compared: the rest is taken for turned, which is on the safe side.
MOST_LOOKED_AT = 64
#: A body whose box is less than so many times as wide as the body is thick stands near its balance on a corner.
NARROW = 3.0


def _drops(seen: Survey) -> tuple[Array, NDArray[np.bool_], float]:
    """How far each body falls before it touches what is below it, by boxes (length; 0: it lies, or nothing is
    there), and whether that is a body that moves itself; and the largest mass over that of one below.
    """
    n = len(seen.bodies)
    drops, lands, heavier = np.zeros(n), np.zeros(n, bool), 1.0
    if seen.g == 0.0 or not len(seen.shapes):
        return drops, lands, heavier
    axis = 1 if abs(seen.gravity[1]) >= abs(seen.gravity[0]) else 0
    low, high = seen.boxes[:, axis], seen.boxes[:, axis + 2]
    if seen.gravity[axis] > 0.0:
        low, high = -high, -low
    left, right = seen.boxes[:, 1 - axis], seen.boxes[:, 3 - axis]
    touching = np.zeros(n, bool)
    close = seen.gaps <= TOUCH * seen.thickness[seen.pairs].min(axis=1, initial=math.inf)
    touching[seen.owner[seen.pairs[close]].ravel()] = True
    falling = np.flatnonzero((seen.moves & ~seen.held)[seen.owner] & ~touching[seen.owner])
    for start in range(0, len(falling), 256):  # in blocks: all against all
        k = falling[start : start + 256, None]
        below = (right > left[k]) & (left < right[k]) & (high <= low[k]) & (seen.owner != seen.owner[k])
        level = np.where(below, high, -math.inf)
        under = np.argmax(level, axis=1)
        k = k[:, 0]
        found = below[np.arange(len(k)), under]
        drops[seen.owner[k[found]]] = (low[k] - high[under])[found]
        above, base = seen.owner[k[found]], seen.owner[under[found]]
        lands[above] = seen.mobile[base]
        weight = seen.inertia[above] / seen.inertia[base]
        heavier = max(heavier, float(weight[seen.mobile[base]].max(initial=1.0)))
    return drops, lands, heavier


def _curves(seen: Survey, time: float) -> Array:
    """Bodies that follow a curve which does not give way: (v/rho)², extent, rho, body, time on it, bounces, sampled.

    On a hump a body is for about a radian, then it has left it. Of equal kinds the worst.
    """
    i, j = seen.pairs.T
    a, b = seen.owner[i], seen.owner[j]
    rho = np.abs(seen.radius[i] + seen.radius[j])
    both = (seen.radius[i] != 0.0) & (seen.radius[j] != 0.0) & (seen.moves[a] != seen.moves[b])
    both &= rho > 1e-9 * np.maximum(np.abs(seen.radius[i]), np.abs(seen.radius[j]))
    if seen.g == 0.0 or not both.any():
        return np.zeros((0, 7))
    i, j, rho = i[both], j[both], rho[both]
    first = seen.moves[seen.owner[i]]
    mover, ground = np.where(first, i, j), np.where(first, j, i)
    axis = 1 if abs(seen.gravity[1]) >= abs(seen.gravity[0]) else 0
    if seen.gravity[axis] < 0.0:
        fall = seen.boxes[mover, axis] - seen.boxes[ground, axis]
    else:
        fall = seen.boxes[ground, axis + 2] - seen.boxes[mover, axis + 2]
    middle = 0.5 * (seen.boxes[:, axis] + seen.boxes[:, axis + 2])
    hung = (middle[mover] - middle[ground]) * (1.0 if seen.gravity[axis] < 0.0 else -1.0) + rho
    fall = np.where(
        seen.radius[mover] < 0.0, hung, fall
    )  # a ring hangs: over the lowest that its middle may come
    drop = np.clip(np.minimum(fall, min(2.0 * float(rho.max()), 0.5 * seen.g * time**2)), 0.0, 2.0 * rho)
    speed = seen.speed[seen.owner[mover]] + seen.speed[seen.owner[ground]]
    rate = (speed**2 + seen.g * drop) / rho**2  # the mean of v² on the way down
    hump = (seen.radius[mover] > 0.0) & (seen.radius[ground] > 0.0)
    lasts = np.where(hump, np.minimum(time, 1.0 / np.sqrt(np.maximum(rate, 1e-300))), time)
    sampled = np.array([outline is not None and not outline.arcs for outline in seen.outlines], bool)
    faceted = sampled[mover] | sampled[ground]
    bounces = (seen.elasticity[mover] * seen.elasticity[ground] > 0.0) & ~hump
    rows = np.column_stack(
        (rate, seen.extent[seen.owner[mover]], rho, seen.owner[mover], lasts, bounces, faceted)
    ).astype(np.float64)
    kind = np.column_stack((np.round(np.log2(np.maximum(rows[:, :3], 1e-300)), 0), bounces))
    _, kinds = np.unique(kind, axis=0, return_index=True)
    order = np.argsort(-rows[kinds, 0])
    return rows[kinds[order][:16]]


def _gap(seen: Survey) -> tuple[float, int]:
    """Where a body waits close behind another that is about to be struck: gap over speed (time), and who."""
    fastest = seen.fastest
    if fastest == 0.0 or not len(seen.pairs):
        return math.inf, -1
    a, b = seen.owner[seen.pairs].T
    waiting = (seen.gaps > TOUCH * seen.thickness[seen.pairs].min(axis=1)) & seen.moves[a] & seen.moves[b]
    waiting &= (seen.speed[a] == 0.0) & (seen.speed[b] == 0.0)
    if not waiting.any():
        return math.inf, -1
    k = int(np.argmin(np.where(waiting, seen.gaps, math.inf)))
    return float(seen.gaps[k]) / fastest, int(a[k])


def _teeth(seen: Survey, frame: float) -> tuple[float, int]:
    """The way of a moving concave outline's rim in a frame over the chord that it lies on, the largest; its shape."""
    worst, which = 0.0, -1
    for k in np.flatnonzero(seen.concave):
        body = seen.owner[k]
        way = (seen.speed[body] + seen.spin[body] * seen.reach[body]) * frame
        if way > 0.0:
            ratio = way / tooth(seen.shapes[k].outline)  # type: ignore[attr-defined]
            if ratio > worst:
                worst, which = float(ratio), int(k)
    return worst, which


def _driven(seen: Survey, many: bool) -> tuple[float, int]:
    """The fastest spin among pairs with a concave outline that something drives, times its lever (1/time); the shape.

    Two gears from about a dozen teeth up hand over while another pair still bears (contact ratio above one), and bear
    as far from the pitch point as a tooth is wide; slots, cams and hooks (not many, or against a pin: a wheel of six
    slots has six hollows for the lock beside them) begin from nothing each time, anywhere.
    """
    fastest, which = 0.0, -1
    for i, j in seen.pairs[seen.concave[seen.pairs].any(axis=1)]:
        own = seen.owner[[i, j]]
        driver = own[~seen.moves[own]]
        spin = float(seen.spin[driver].max(initial=0.0)) if seen.g > 0.0 else float(seen.spin[own].max())
        if spin <= 0.0:
            continue
        outlines = [seen.shapes[k].outline for k in (i, j) if seen.concave[k]]  # type: ignore[attr-defined]
        mesh = len(outlines) == 2 and min(map(pockets, outlines)) >= MANY_TEETH
        if mesh != many:
            continue
        lever = 1.0
        if many:  # with that of the pair before and of the pair after, which are met a substep late
            lever = 3.0 * max(
                tooth_lever(seen.shapes[k].outline, float(seen.reach[seen.owner[k]]))  # type: ignore[attr-defined]
                for k in (i, j)
                if seen.concave[k]
            )
        if lever * spin > fastest:
            fastest, which = lever * spin, int(i)
    return fastest, which


def _offset(seen: Survey) -> float:
    """Of discs that may meet: v b/R², the largest (1/time). See `estimates.late_direction`."""
    if not len(seen.pairs):
        return 0.0
    i, j = seen.pairs.T
    middle = 0.5 * (seen.boxes[:, :2] + seen.boxes[:, 2:])
    way = seen.velocity[seen.owner[i]] - seen.velocity[seen.owner[j]]
    apart = middle[i] - middle[j]
    radius = seen.radius[i] + seen.radius[j]
    both = (seen.radius[i] > 0.0) & (seen.radius[j] > 0.0)
    missed = np.abs(way[:, 0] * apart[:, 1] - way[:, 1] * apart[:, 0])  # speed times offset
    return float(np.max(np.where(both, missed, 0.0) / np.where(both, radius, 1.0) ** 2, initial=0.0))


def _overlapped(seen: Survey) -> tuple[float, int]:
    """The deepest overlap at the start, over the smaller extent, of boxes that fill their boxes and of discs."""
    if not len(seen.pairs):
        return 0.0, -1
    i, j = seen.pairs.T
    plain = [outline is None for outline in seen.outlines]
    circles = np.array([isinstance(shape, pymunk.Circle) for shape in seen.shapes]) & plain
    flush = (seen.radius == 0.0) & ~seen.corners & ~seen.concave
    segments = np.array([isinstance(shape, pymunk.Segment) for shape in seen.shapes])
    depth = np.where((flush & ~segments)[i] & (flush & ~segments)[j], -seen.gaps, 0.0)
    both = circles[i] & circles[j]
    if both.any():
        middle = 0.5 * (seen.boxes[:, :2] + seen.boxes[:, 2:])
        apart = np.hypot(*(middle[i] - middle[j]).T)
        depth = np.where(both, seen.radius[i] + seen.radius[j] - apart, depth)
    depth = np.where(np.isfinite(depth), depth, 0.0)
    relative = depth / np.maximum(np.minimum(seen.thickness[i], seen.thickness[j]), 1e-300)
    relative = np.where(depth > 0.0, relative, 0.0)
    worst = int(np.argmax(relative))
    return max(float(relative[worst]), 0.0), worst
