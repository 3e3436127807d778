"""What a setting's error is expected to be, from a survey and the estimates: one line a mechanism.

Errors are those of the study: of a velocity over the approach speed, of a path over its length or the body's size;
1e-2 is one per cent. Each mechanism names the body or shape that decides it and the number that does.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
import pymunk
from numpy.typing import NDArray

from ..kernel.constants import FOLLOWED, WEIGHTLESS_PHASE2
from ..outline import Outline
from . import estimates as est
from .survey import TOUCH, Array, Survey, support

#: Error that stands for "the motion is another one": a contact missed, a tower that buckles.
LOST = 1.0
#: Error of a bounce whose contact the step follows explicitly: restitution then goes by what the depth law gives back.
#: Measured: 0.07 to 0.1 in three scenes of the study, at every step that follows.
FOLLOWED_BOUNCE = 0.1


class Setting(NamedTuple):
    """What a plan chooses for a whole space."""

    level: str  # "rigid" or "pymunk"
    steps: int
    sweeps: int
    penetration: float


class Cause(NamedTuple):
    """One mechanism's share of the error."""

    name: str
    error: float
    who: Any  # body, shape, or None for the whole space
    number: str  # what decided it, to be read


class Facet(NamedTuple):
    """A sampled curve of the space."""

    shape: int
    turn: float  # between its chords (radians), as it is sampled now
    angle: float  # that contacts run over (radians)
    radius: float  # of curvature (length)
    extent: float  # of the smallest body that lies on it (length)
    clearance: float  # least difference of radii to what lies in it or around it (length)
    known: bool  # whether it can be sampled anew
    lever: float  # of a tooth: how far from the pitch point it bears, over the radius; 1 without teeth

    def error(self, p: float, turn: float, pressed: bool) -> float:
        """What facets that turn by so much leave at penetration p."""
        sagitta = float(est.tolerance_for_turn(self.radius, turn))
        if (
            not pressed
        ):  # driven: the direction swings by the turn, rms turn/sqrt(12), and the ratio by that at its lever
            return self.lever * turn / math.sqrt(12.0)
        lost = float(est.facet_loss(turn, self.angle, sagitta, p * self.extent))
        return min(LOST, max(lost, sagitta / self.clearance))

    def turn_for(self, error: float, p: float, pressed: bool) -> float:
        """The largest turn whose error is no larger (radians), to a factor of sqrt(2); LEAST_TURN if none is."""
        return _turn_for(self, error, p, pressed)


@lru_cache(maxsize=4096)
def _turn_for(facet: Facet, error: float, p: float, pressed: bool) -> float:
    turn = MOST_TURN
    while turn > LEAST_TURN and facet.error(p, turn, pressed) > error:
        turn /= math.sqrt(2.0)
    return max(turn, LEAST_TURN)


LEAST_TURN, MOST_TURN = 2.0 * math.pi / 20000.0, 2.0 * math.pi / 32.0
"""Finest and coarsest facets that a plan asks for (radians): 20,000 and 32 a turn."""
FACETS = 0.3
"""Of the tolerance: the share that the facets of curves sampled anew may have of it."""


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
    wanted: float  # sweeps with which its loads are found
    flat: (
        Worst | None
    )  # how many times its depth a flush body sinks: what it carries, how near its base's edge it stands
    rounded: Worst | None  # 1 where a round body meets friction, else 0
    corner: Worst | None  # 1/extent of a body near its balance on a corner (1/length)
    leaning: Worst | None  # 1/reach of a body that leans on one
    leaning_extent: float  # extent of that body (length)
    pile: Worst | None  # crossings/extent of a body in a pile (1/length)
    crossings: float  # seams that a body slides over
    bounce: Worst | None  # 1/v of the last bounce (time/length), of a body that falls
    elastic_bounce: bool  # e = 1: what is off comes back
    largest: float  # largest extent of what moves (length)
    slowest: Worst | None  # 1/v of what moves already and is pressed (time/length)
    toppling: float  # rate at which what stands on a corner falls (1/time)
    curves: Array  # (curves, 4): (v/rho)², extent, rho, body; those that no other is worse than
    gap: tuple[float, int]  # least time between two touches in a row, body
    teeth: tuple[float, int]  # way of a tooth in a frame over its chord, shape
    facets: list[Facet]
    facet_share: float  # error that the facets of a curve sampled anew may have
    fixed_turns: dict[int, float]  # turns between facets that the user has asked for (radians)
    overlapped: tuple[float, int]  # deepest overlap at the start over the extent, pair

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
    n, g, free, owner = len(seen.bodies), seen.g, seen.moves, seen.owner
    layers, load, heavier = support(seen)
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
    corners = free & polygon & (g > 0.0) & (turned | (margin <= 0.0))
    speed = np.where(drops > 0.0, np.sqrt(seen.speed**2 + 2.0 * g * drops), 0.0)
    e = np.minimum(elasticity, 1.0) ** 2  # of a pair the product; the other side's is not known yet
    bounces = (speed > 0.0) & (e > 0.0) & free & (g > 0.0)
    last: Array = est.last_speed(np.where(bounces, speed, 1.0), max(g, 1e-300), e, time)
    carried = (
        np.maximum(np.maximum(layers, ratio), np.where(piled, heavier, 1.0))
        * crossings
        / np.maximum(margin, 1e-3)
    )
    leaning = _worst(1.0 / np.maximum(seen.reach, 1e-300), corners & ~upright)
    toppling = _worst(1.0 / np.maximum(seen.reach, 1e-300), corners)
    moving = free & (g > 0.0) & (seen.speed > 0.0) & (drops == 0.0)
    return Facts(
        seen=seen,
        frame=frame,
        time=time,
        tower=tower,
        wanted=float(est.sweeps_wanted(float(tower), max(heavier, 1.0))),
        flat=_worst(carried, free & polygon & ~corners & (g > 0.0)),
        rounded=_worst(np.where(friction > 0.0, 1.0, 0.0), free & ~polygon & (g > 0.0)),
        corner=_worst(1.0 / extent, corners & upright),
        leaning=leaning,
        leaning_extent=float(extent[leaning.body]) if leaning else 0.0,
        pile=_worst(crossings / extent, piled),
        crossings=float(crossings[piled].max(initial=1.0)),
        bounce=_worst(1.0 / last, bounces),
        elastic_bounce=bool(bounces.any() and e[bounces].min() > 0.999),
        largest=float(seen.extent[free].max(initial=0.0)),
        slowest=_worst(1.0 / np.maximum(seen.speed, 1e-300), moving),
        toppling=math.sqrt(0.75 * g * toppling.value) if toppling else 0.0,
        curves=_curves(seen, time),
        gap=_gap(seen),
        teeth=_teeth(seen, frame),
        facets=_facets(seen, time),
        facet_share=0.0,
        fixed_turns={},
        overlapped=_overlapped(seen),
    )


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
    falling = np.flatnonzero(seen.moves[seen.owner] & ~touching[seen.owner])
    for start in range(0, len(falling), 256):  # in blocks: all against all
        k = falling[start : start + 256, None]
        below = (right > left[k]) & (left < right[k]) & (high <= low[k]) & (seen.owner != seen.owner[k])
        level = np.where(below, high, -math.inf)
        under = np.argmax(level, axis=1)
        k = k[:, 0]
        found = below[np.arange(len(k)), under]
        drops[seen.owner[k[found]]] = (low[k] - high[under])[found]
        above, base = seen.owner[k[found]], seen.owner[under[found]]
        lands[above] = seen.moves[base]
        heavier = max(heavier, float((seen.mass[above] / seen.mass[base])[seen.moves[base]].max(initial=1.0)))
    return drops, lands, heavier


def _curves(seen: Survey, time: float) -> Array:
    """Bodies that follow a curve which does not give way: (v/rho)², extent, rho, body; the worst of equal kind."""
    i, j = seen.pairs.T
    a, b = seen.owner[i], seen.owner[j]
    rho = np.abs(seen.radius[i] + seen.radius[j])
    both = (seen.radius[i] != 0.0) & (seen.radius[j] != 0.0) & (seen.moves[a] != seen.moves[b])
    both &= rho > 1e-9 * np.maximum(np.abs(seen.radius[i]), np.abs(seen.radius[j]))
    if seen.g == 0.0 or not both.any():
        return np.zeros((0, 4))
    i, j, rho = i[both], j[both], rho[both]
    first = seen.moves[seen.owner[i]]
    mover, ground = np.where(first, i, j), np.where(first, j, i)
    axis = 1 if abs(seen.gravity[1]) >= abs(seen.gravity[0]) else 0
    if seen.gravity[axis] < 0.0:
        fall = seen.boxes[mover, axis] - seen.boxes[ground, axis]
    else:
        fall = seen.boxes[ground, axis + 2] - seen.boxes[mover, axis + 2]
    fall = np.where(seen.radius[mover] < 0.0, rho, fall)  # a ring hangs: it starts no higher than its middle
    drop = np.clip(np.minimum(fall, min(2.0 * float(rho.max()), 0.5 * seen.g * time**2)), 0.0, 2.0 * rho)
    speed = seen.speed[seen.owner[mover]] + seen.speed[seen.owner[ground]]
    rate = (speed**2 + seen.g * drop) / rho**2  # the mean of v² on the way down
    rows = np.column_stack((rate, seen.extent[seen.owner[mover]], rho, seen.owner[mover])).astype(np.float64)
    _, kinds = np.unique(np.round(np.log2(np.maximum(rows[:, :3], 1e-300)), 0), axis=0, return_index=True)
    order = np.argsort(-rows[kinds, 0])
    return rows[kinds[order][:16]]


def _gap(seen: Survey) -> tuple[float, int]:
    """Where a body waits close behind another that is about to be struck: gap over speed (time), and who."""
    fastest = float(seen.speed[seen.moves].max(initial=0.0))
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


def tooth(outline: Outline) -> float:
    """Chord on which a concave outline lies (length): its hull's longest edge that is its own, or its extent."""
    import shapely

    hull = shapely.convex_hull(outline.polygon)
    own = shapely.intersection(shapely.boundary(hull), shapely.boundary(outline.polygon))
    pieces = shapely.get_parts(shapely.line_merge(own) if own.geom_type == "MultiLineString" else own)
    longest = max((piece.length for piece in pieces), default=0.0)
    return min(longest, outline.smallest_extent) or outline.smallest_extent


def facet_angle(outline: Outline) -> float:
    """Angle between the facets of a sampled curve (radians), the middle one; 0 where it has none."""
    if outline.arcs:
        return 0.0
    turns = []
    for ring in outline.rings:
        ahead = np.roll(ring, -1, axis=0) - ring
        behind = np.roll(ahead, 1, axis=0)
        turn = np.arctan2(
            behind[:, 0] * ahead[:, 1] - behind[:, 1] * ahead[:, 0], (behind * ahead).sum(axis=1)
        )
        turns.append(np.abs(turn[(np.abs(turn) < 0.5) & (np.abs(turn) > 1e-9)]))
    found = np.concatenate(turns)
    return float(np.median(found)) if len(found) >= 8 else 0.0


def _facets(seen: Survey, time: float) -> list[Facet]:
    found = []
    for k, shape in enumerate(seen.shapes):
        outline = getattr(shape, "outline", None)
        if seen.radius[k] == 0.0 or not isinstance(outline, Outline) or outline.arcs:
            continue
        near = seen.owner[seen.pairs[(seen.pairs == k).any(axis=1)]].ravel()
        extent = float(seen.extent[near].min(initial=math.inf))
        lever = 1.0
        if seen.concave[k]:  # teeth bear as far as a pitch from the pitch point, twice what they lie on
            lever = min(1.0, 2.0 * tooth(outline) / float(seen.reach[seen.owner[k]]))
        found.append(
            Facet(
                *(k, facet_angle(outline), run_over(seen, k, time), abs(float(seen.radius[k]))),
                *(
                    extent if math.isfinite(extent) else 0.0,
                    clearance(seen, k),
                    outline._resample is not None,
                    lever,
                ),
            )
        )
    return found


def clearance(seen: Survey, k: int) -> float:
    """Least difference of radii between a curve and what may lie in it or around it (length); infinite without."""
    mine = seen.pairs[(seen.pairs == k).any(axis=1)]
    other = np.where(mine[:, 0] == k, mine[:, 1], mine[:, 0])
    opposite = seen.radius[other] * seen.radius[k] < 0.0
    return float(np.min(np.abs(seen.radius[other] + seen.radius[k])[opposite], initial=math.inf))


def run_over(seen: Survey, k: int, time: float) -> float:
    """Angle of a curve that a contact runs over in a time (radians), no less than one.

    At the speed that its bodies have, or get in a swing to the curve's side, v² = g r on the average, if that
    comes sooner than the time ends; and with the faster of their spins.
    """
    near = seen.owner[seen.pairs[(seen.pairs == k).any(axis=1)]].ravel()
    radius = abs(float(seen.radius[k]))
    falls = min(math.sqrt(seen.g * radius), 0.5 * seen.g * time)
    speed = float(seen.speed[near].max(initial=0.0)) + falls
    spin = max(float(seen.spin[seen.owner[k]]), float(seen.spin[near].max(initial=0.0)))
    return max(1.0, (speed / radius + spin) * time)


def _overlapped(seen: Survey) -> tuple[float, int]:
    """The deepest overlap at the start, over the smaller extent, of boxes that fill their boxes and of discs."""
    if not len(seen.pairs):
        return 0.0, -1
    i, j = seen.pairs.T
    circles = np.array(
        [isinstance(shape, pymunk.Circle) and not hasattr(shape, "outline") for shape in seen.shapes]
    )
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


# --- the errors of one setting ----------------------------------------------------------------------------------


def causes(found: Facts, setting: Setting) -> list[Cause]:
    """All mechanisms that bear on a space, the worst first."""
    told = _native(found, setting) if setting.level == "pymunk" else _area(found, setting)
    return sorted(told, key=lambda cause: -cause.error)


def total(found: Facts, setting: Setting) -> float:
    """The error of a setting: the largest of its mechanisms."""
    told = _native(found, setting) if setting.level == "pymunk" else _area(found, setting)
    return max((cause.error for cause in told), default=0.0)


def _area(f: Facts, s: Setting) -> list[Cause]:
    """Area contact: sinking, and what substeps and sweeps leave."""
    p, h, g = s.penetration, f.frame / s.steps, f.seen.g
    bodies = f.seen.bodies
    told = []
    if f.flat:
        told.append(
            Cause(
                "sinking",
                p * f.flat.value,
                bodies[f.flat.body],
                f"{f.flat.value:.3g} times {p:.0e} of its size",
            )
        )
    if f.rounded:
        error = p + math.sqrt(p) * f.rounded.value
        told.append(Cause("sinking", error, bodies[f.rounded.body], f"a round body at {p:.0e}"))
    if f.corner:
        falls = 0.5 * g * h * h * f.corner.value
        text = f"corner sqrt({p:.0e}), and g h²/2s = {falls:.1e}, as it falls over"
        told.append(Cause("corner", est.TOPPLE * (math.sqrt(p) + falls), bodies[f.corner.body], text))
    if f.leaning:
        error = (math.sqrt(p) * f.leaning_extent + 0.5 * g * h * h) * f.leaning.value
        told.append(
            Cause(
                "corner", error, bodies[f.leaning.body], f"leans on a corner, sqrt({p:.0e}) of its thickness"
            )
        )
    if f.pile:
        error = est.pile_sag(g, h, 1.0 / f.pile.value, f.wanted, s.sweeps)
        if s.sweeps < est.LEAST_PILE_SWEEPS or s.steps < est.LEAST_PILE_STEPS:
            error = max(error, LOST)
        text = f"{f.wanted:.0f} sweeps carry its load, {f.tower} high" + (
            f", {f.crossings:.0f} seams" * (f.crossings > 1.0)
        )
        told.append(Cause("pile", float(error), bodies[f.pile.body], text))
    most = est.buckling_penetration(SLENDER * f.tower)
    if f.tower > 2 and p > most:
        told.append(Cause("buckling", LOST, None, f"{f.tower} high: p <= {most:.0e}"))
    if f.bounce and not f.elastic_bounce:
        text = f"g h/v = {g * h * f.bounce.value:.1e} at its last bounce"
        told.append(
            Cause("bounce", float(est.bounce_error(g, h, 1.0 / f.bounce.value)), bodies[f.bounce.body], text)
        )
    if f.largest > 0.0:
        presses = g if g > 0.0 else WEIGHTLESS_PHASE2 * p * f.largest / f.frame**2
        phase2 = est.resting_phase2(presses, h, p, f.largest)
        if phase2 < FOLLOWED:
            told.append(Cause("followed", FOLLOWED_BOUNCE, None, f"(w h)² = {phase2:.2g} < {FOLLOWED}"))
    for rate, extent, rho, who in f.curves:
        pressed = 1.0 + rate * rho / g  # k follows the load, and here it is g + v²/rho
        lost = est.curve_loss(math.sqrt(rate), 1.0, h, f.time, est.resting_phase2(g * pressed, h, p, extent))
        told.append(
            Cause(
                "curve",
                min(LOST, lost),
                bodies[int(who)],
                f"turns by {math.sqrt(rate) * h:.1e} rad a substep",
            )
        )
        sinks = p * max(pressed, extent / rho)
        told.append(
            Cause(
                "sinking",
                min(LOST, sinks),
                bodies[int(who)],
                f"{p * extent / rho:.1e} of its clearance or path",
            )
        )
    depth, pair = f.overlapped
    if depth > ALREADY:
        shape = f.seen.shapes[f.seen.pairs[pair, 0]]
        told.append(
            Cause(
                "overlapped",
                min(LOST, 2.0 * depth),
                shape,
                f"starts {depth:.2g} deep, is let out at its own speed",
            )
        )
    return told + _shared(f, s, h)


#: A tower is planned as if so many times as high: buckling grows slowly near its limit.
SLENDER = 3.0
#: Overlap at the start, over the smaller extent, that somebody has put there.
ALREADY = 1e-2


def _shared(f: Facts, s: Setting, h: float) -> list[Cause]:
    """What goes wrong alike with either response."""
    told = []
    if f.gap[0] < h:
        told.append(
            Cause(
                "two hits at once", LOST, f.seen.bodies[f.gap[1]], f"gap/v = {f.gap[0]:.2g} s < h = {h:.2g} s"
            )
        )
    if f.teeth[0] > s.steps:
        told.append(
            Cause(
                "teeth", LOST, f.seen.shapes[f.teeth[1]], f"move by {f.teeth[0]:.1f} of their width a frame"
            )
        )
    for facet in f.facets:
        pressed = f.seen.g > 0.0
        turn = f.fixed_turns.get(facet.shape)
        if turn is None:  # sampled as fine as its share of the tolerance asks for, or as it is
            turn = facet.turn_for(f.facet_share, s.penetration, pressed) if facet.known else facet.turn
        error = facet.error(s.penetration, turn, pressed)
        told.append(Cause("facets", error, f.seen.shapes[facet.shape], f"turn by {turn:.1e} rad"))
    return told


def _native(f: Facts, s: Setting) -> list[Cause]:
    """Chipmunk's own response: symplectic Euler of the first order, impulses, a slop instead of a depth."""
    h, g = f.frame / s.steps, f.seen.g
    bodies = f.seen.bodies
    told = [Cause("slop", s.penetration * f.tower, None, f"{s.penetration:.0e} of the smallest extent")]
    told.append(Cause("first order", h / f.time, None, f"h/T = {h / f.time:.1e}"))
    if f.slowest:
        error = min(LOST, g * h * f.slowest.value)
        told.append(
            Cause("first kick", error, bodies[f.slowest.body], f"g h/v = {g * h * f.slowest.value:.1e}")
        )
    if f.toppling > 0.0:
        told.append(
            Cause("corner", min(LOST, f.toppling * h), None, f"falls over at {f.toppling:.2g} a second")
        )
    if f.pile:
        error = f.crossings * est.pile_sag(g, h, 1.0 / f.pile.value, NATIVE_SWEEPS * f.wanted, s.sweeps)
        if f.tower > 2:
            error = LOST
        told.append(
            Cause("pile", float(error), bodies[f.pile.body], f"{f.tower} high: impulses want many steps")
        )
    if f.bounce:
        told.append(
            Cause(
                "bounce",
                g * h * f.bounce.value,
                bodies[f.bounce.body],
                f"g h/v = {g * h * f.bounce.value:.1e}",
            )
        )
    for rate, _, _, who in f.curves:
        told.append(
            Cause(
                "curve",
                min(LOST, math.sqrt(rate) * h),
                bodies[int(who)],
                f"turns by {math.sqrt(rate) * h:.1e} rad a step",
            )
        )
    return told + _shared(f, s, h)


#: Sweeps of Chipmunk's for one of ours: its are not conjugate, and it has no area to spread a face's load over.
NATIVE_SWEEPS = 4.0
