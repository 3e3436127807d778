"""What a setting's error is expected to be, from a survey and the estimates: one line a mechanism.

Errors are those of the study: of a velocity over the approach speed, of a path over its length or the body's size;
1e-2 is one per cent. Each mechanism names the body or shape that decides it and the number that does.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from ..kernel.constants import FOLLOWED, TANGENT_STIFFNESS, WEIGHTLESS_PHASE2
from . import estimates as est
from .curves import LOST
from .facts import Facts

#: Error of a bounce whose contact the step follows explicitly: restitution then goes by what the depth law gives back.
#: Measured: 0.07 to 0.1 in three scenes of the study, at every step that follows; twice that, to stay clear of it.
FOLLOWED_BOUNCE = 0.2


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
    corner = float(est.corner_depth(p))
    bodies = f.seen.bodies
    told = []
    if f.slots[0] > 0.0:
        told.append(Cause("sinking", p, f.seen.shapes[f.slots[1]], f"what drives it sinks by {p:.0e}"))
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
        falls = float(est.free_fall(g, 0.5 * h, 1.0)) * f.corner.value * (ROCKS if f.rocks else 1.0)
        text = (
            f"corner sqrt({p:.0e}), and {'g h²/s' if f.rocks else 'g h²/8s'} = {falls:.1e}, as it falls over"
        )
        told.append(Cause("corner", est.TOPPLE * (corner + falls), bodies[f.corner.body], text))
    if f.leaning:
        error = LEAN * corner + 0.5 * g * h * h * f.leaning.value
        told.append(Cause("corner", error, bodies[f.leaning.body], f"leans on a corner, sqrt({p:.0e})"))
    if f.pile:
        wanted = est.sweeps_ours(f.tower, f.shared, f.struck, s.sweeps)
        error = est.pile_sag(g, h, 1.0 / f.pile.value, wanted, s.sweeps)
        text = f"{wanted:.0f} sweeps carry its load, {f.tower} high" + (
            f", {f.crossings:.0f} seams" * (f.crossings > 1.0)
        )
        if f.seams:
            falls = float(est.free_fall(g, h, 1.0))
            depth = p * float(f.seen.extent[f.pile.body])
            error = f.pile.value * falls if falls > BEDDED * depth else 0.0
            text = f"{f.crossings:.0f} seams, g h²/2 = {falls / depth:.1g} of its depth"
            if error > 0.0 and s.steps < est.LEAST_PILE_STEPS:
                error = LOST
        if s.sweeps < f.least_sweeps or s.steps < f.least_steps:
            error = max(error, LOST)
        told.append(Cause("pile", float(error), bodies[f.pile.body], text))
    if f.blow:
        extent = float(f.seen.extent[f.blow.body])
        w = math.sqrt(
            g / (p * max(f.struck, 1.0) * extent)
        )  # the bed is as stiff as the lighter one lets it be
        deep = float(est.blow_depth(f.blow.value, w, h))
        text = f"a blow presses it in by {deep:.1e} of its size"
        told.append(Cause("blow", min(LOST, deep), bodies[f.blow.body], text))
    most = est.buckling_penetration(f.column if f.shared and not f.leaning else SLENDER * f.column)
    if f.column > 2 and p > most:
        told.append(Cause("buckling", LOST, None, f"{f.column} in a row: p <= {most:.0e}"))
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
    for rate, extent, rho, who, lasts, bounces, faceted in f.curves:
        pressed = 1.0 + rate * rho / g  # k follows the load on the average, and here it is g + v²/rho
        lost = TURNING * rate * h * h
        depth = p * extent * pressed if faceted else rho * est.lens_depth(p * pressed, extent, rho)
        if est.turning_gap(rate, rho, h, depth) > (1.0 if faceted else SEEN):
            phase2 = est.resting_phase2(g * pressed, h, p, extent)
            lost = max(lost, UNSEEN * est.curve_loss(math.sqrt(rate), 1.0, h, lasts, phase2))
        sinks = p * max(pressed, extent / rho) / (TANGENT_STIFFNESS if f.rough else 1.0)
        if extent > CONFORMING * rho:
            sinks = est.lens_depth(p, extent, rho)
        turns = f"turns by {math.sqrt(rate) * h:.1e} rad a substep"
        told.append(Cause("curve", min(LOST, lost + sinks), bodies[int(who)], turns))
        text = f"{p * extent / rho:.1e} of its clearance or path"
        told.append(Cause("sinking", min(LOST, sinks), bodies[int(who)], text))
        if (
            bounces
        ):  # about as fast as from its side: how deep that goes over the clearance, and where touch lies
            deep = float(est.impact_depth(math.sqrt(2.0 * g * rho), p * extent, g, 1.0)) / rho
            late = float(est.bounce_error(g, h, math.sqrt(2.0 * g * rho)))
            told.append(
                Cause("bounce", min(LOST, max(deep, late)), bodies[int(who)], f"in a clearance of {rho:.2g}")
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


#: Error that a curve leaves where the solve sees it turn, over the turn a substep squared; and over `curve_loss` where
#: it does not. Measured, on loops and in bowls; the first with pins in slots as well.
TURNING, UNSEEN = 5.0, 2.0
#: Of the turn a substep: so much late is what a pin turns in its slot, for loads are found within the substep. Measured
#: on the study's drive, not derived: 0.01 to 0.1 at 1 to 8 substeps and penetrations of 1e-2 to 1e-5, more where it is
#: softer; so half as much again.
LATE = 1.0 / 6.0
#: Of the depth of a lens: so far may an arc turn away in a substep before contact is lost, and struck anew. Measured on
#: a ring on a peg (between 0.18 and 0.33), in bowls and journals (0.7 to 1).
SEEN = 0.2
#: What is so many times as large as its clearance nearly fills it.
CONFORMING = 4.0
#: What stands on a corner falls so many times as far before it is held as what tips from its face, which the bed holds
#: from the start. Measured on a rocking block, one to four substeps: 6.6 to 7.4.
ROCKS = 8.0
#: What leans has a corner at either end, and each sinks.
LEAN = 2.0
#: A tower is planned as if so many times as high: buckling grows slowly near its limit. Not a pile whose
#: bodies lie on two each: neighbours hold it.
SLENDER = 3.0
#: What slides over seams does not feel a fall of so many times its depth before the next tile holds it: it lies on the
#: last. Measured on tiles, at 1 to 24 substeps: with less there is nothing but `est.SEAM`.
BEDDED = 10.0
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
    if f.driven[0] > 0.0:
        turn = f.driven[0] * h  # within a substep the direction stays, and loads are found in the next
        text = f"turns by {turn:.1e} rad a substep, where it bears"
        told.append(Cause("drive", min(LOST, turn), f.seen.shapes[f.driven[1]], text))
    if f.slots[0] > 0.0:
        turn = f.slots[0] * h
        text = f"turns by {turn:.1e} rad a substep"
        late = max(TURNING * turn, LATE) * turn
        told.append(Cause("drive", min(LOST, late), f.seen.shapes[f.slots[1]], text))
    if f.teeth[0] > s.steps:
        told.append(
            Cause(
                "teeth", LOST, f.seen.shapes[f.teeth[1]], f"move by {f.teeth[0]:.1f} of their width a frame"
            )
        )
    for facet in f.facets:
        pressed = f.seen.g > 0.0
        asked = f.fixed_turns.get(facet.shape)
        turn = asked or 0.0
        if asked is None:  # sampled as fine as its share of the tolerance asks for, or as it is
            turn = facet.turn_for(f.facet_share, s.penetration, pressed) if facet.known else facet.turn
        error = facet.error(s.penetration, turn, pressed)
        told.append(Cause("facets", error, f.seen.shapes[facet.shape], f"turn by {turn:.1e} rad"))
    return told


def _native(f: Facts, s: Setting) -> list[Cause]:
    """Chipmunk's own response: symplectic Euler of the first order, impulses, a slop instead of a depth."""
    h, g = f.frame / s.steps, f.seen.g
    bodies = f.seen.bodies
    told = [Cause("slop", s.penetration * f.tower, None, f"{s.penetration:.0e} of the smallest extent")]
    if g > 0.0:
        told.append(Cause("first order", h / f.time, None, f"h/T = {h / f.time:.1e}"))
    else:  # impulses are exact; the direction in which they act is that of the step after touch
        late = max(f.offset * h, h / f.time, f.tumbling * h) if f.met else 0.0
        told.append(Cause("first order", min(LOST, late), None, f"met {h:.1e} late"))
    depth, pair = f.overlapped
    if (
        depth > ALREADY
    ):  # taken apart without a speed that stays: what is left falls by the space's bias a second
        shape = f.seen.shapes[f.seen.pairs[pair, 0]]
        assert shape.space is not None
        left = depth * shape.space.collision_bias**f.time
        told.append(Cause("overlapped", left, shape, f"starts {depth:.2g} deep, {left:.1e} at the end"))
    if f.landing:
        error = g * h * f.landing.value
        told.append(Cause("landing", min(LOST, error), bodies[f.landing.body], f"g h/v = {error:.1e}"))
    if f.slowest:
        error = min(LOST, g * h * f.slowest.value)
        told.append(
            Cause("first kick", error, bodies[f.slowest.body], f"g h/v = {g * h * f.slowest.value:.1e}")
        )
    if f.toppling > 0.0:
        sinks = (
            est.TOPPLE * s.penetration if f.corner else 0.0
        )  # a slop is a depth, and is magnified like one
        text = f"falls over at {f.toppling:.2g} a second"
        told.append(Cause("corner", min(LOST, f.toppling * h + sinks), None, text))
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
    for rate, _, _, who, *_ in f.curves:
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
