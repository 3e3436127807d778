"""Closed forms from which a plan is made: each with its formula, its source and its unit.

They take numbers or NumPy arrays alike. Nothing here is fitted to a scene; the few numbers that were measured on this
solve, not derived, say so and stand together at the end.

Symbols, and the arguments that they stand for: m `mass` (mass), g `gravity`, the acceleration that presses
(length/time²), v `speed` (length/time), s `extent`, a body's smallest (length), k `stiffness` of F = k A
(force/length²), L `chord` (length), h a substep (time), w `frequency` of a contact (rad/time), p the penetration
allowed (fraction of s), r or rho `radius` of an arc (length), d `depth` (length), t `tolerance`, the sagitta of a chord
(length), e `restitution`; E `young` (force/area), rho `density` (mass/volume), l `length`, h `height` and `thickness`
of what bends (length).
"""

from __future__ import annotations

import math
from typing import NamedTuple, TypeVar

import numpy as np

from ..kernel.constants import SEARCH_SWEEPS

Number = TypeVar("Number", float, np.ndarray)

# --- how deep -------------------------------------------------------------------------------------------------


def penetration(load: Number, stiffness: Number, chord: Number) -> Number:
    """Depth at which a face of length L carries a load (length): F/(k L).

    F = k A (Eq. 5) with A = L d. For a weight: m g/(k L).
    """
    return load / (stiffness * chord)


def impact_depth(speed: Number, mass: Number, stiffness: Number, chord: Number) -> Number:
    """Depth at which a face of length L stops a mass (length): v sqrt(m/(k L)), from m v²/2 = k L d²/2."""
    return speed * np.sqrt(mass / (stiffness * chord))


def blow_depth(speed: Number, frequency: Number, h: float) -> Number:
    """How deep a blow drives a contact that takes substeps of h (length): (v/w)/sqrt(1 + (w h)²), at the most.

    Backward Euler lets d'' = -w² d go as v/w (1 + (w h)²)^(-n/2) sin(n atan(w h)) after n substeps, and n = 1 has the
    largest factor. Soft for the step it is `impact_depth`; stiff, v/(w² h): the weight's depth, as many times as the
    blow's m v is the weight's m g h.
    """
    return speed / frequency / np.sqrt(1.0 + (frequency * h) ** 2)


def corner_depth(p: Number) -> Number:
    """How deep a right corner sinks where a face would sink by p, over s (dimensionless): sqrt(p).

    A right corner cuts off A = d² where its sides are at 45 degrees, and a face of length s has A = p s² for the same
    load: d/s = sqrt(p).
    """
    return np.sqrt(p)


def buckling_penetration(boxes: float) -> float:
    """p with which a tower of so many boxes just stands (dimensionless): 0.65/n³ (docs/architecture.md)."""
    return 0.65 / boxes**3


# --- how fast -------------------------------------------------------------------------------------------------


def contact_frequency(stiffness: Number, chord: Number, mass: Number) -> Number:
    """w = sqrt(k L/m) of a mass on a face of length L (1/time): dF/dd = k L (docs/theory.md, 3)."""
    return np.sqrt(stiffness * chord / mass)


def resting_phase2(gravity: Number, h: float, p: Number, extent: Number) -> Number:
    """(w h)² of a body that rests on a face at penetration p (dimensionless): g h²/(p s), from k L = m g/(p s)."""
    return gravity * h * h / (p * extent)


def curve_loss(speed: Number, radius: Number, h: float, time: float, phase2: Number) -> Number:
    """Share of its energy that a body loses on a path of curvature 1/rho (dimensionless).

    In each substep the path turns by v h/rho, and the contact has to take off the velocity v² h/rho that now points
    into it, (v h/rho)²/2 of its energy. A contact that is soft for the step stores it and gives it back: it takes the
    share r = (w h)²/(1 + (w h)²) of it at once (backward Euler), and of what it has stored the same share is damped
    before it has come back. So r² of it is lost a substep, in T/h of them. So it is where the solve sees no curvature
    (`turning_gap`): measured twice as much.
    """
    turned = speed / radius
    stiff = phase2 / (1.0 + phase2)
    return 0.5 * turned * turned * h * time * stiff * stiff


def turning_gap(rate: Number, radius: Number, h: float, depth: Number) -> Number:
    """How far a curve turns away in a substep over the depth of the contact (dimensionless): (v h)²/2 rho d.

    `rate`: (v/rho)². The solve asks for the speed that leaves no such gap (`kernel.turning`), by the curvature that
    it sees of the region. Where the gap is deeper than the region, a sampled curve shows it a facet or two and no
    curvature, and from an arc it has come off.
    """
    return 0.5 * rate * radius * h * h / depth


def lens_depth(p: Number, extent: float, clearance: float) -> Number:
    """How deep an arc sinks into one that it nearly fills, over their clearance (dimensionless): (1.06 p s/c)^(2/3).

    The lens that they share at depth d has the area 4/3 sqrt(2 R) d^(3/2), 1/R = 1/R1 - 1/R2, R about s²/4c, and needs
    p s² for the weight.
    """
    found: Number = (1.06 * p * extent / clearance) ** (2.0 / 3.0)
    return found


def bounce_error(gravity: Number, h: float, speed: Number) -> Number:
    """Error of the height after a bounce, relative (dimensionless): (g h/v)²/4.

    Touch lies somewhere within the substep, at the most h/2 from its middle, where gravity's share is given: a
    height of g (h/2)²/2 out of v²/2g is wrong by (g h/v)²/4 at the most.
    """
    return (gravity * h / speed) ** 2 / 4.0


def last_speed(speed: np.ndarray, gravity: float, restitution: np.ndarray, time: float) -> np.ndarray:
    """Speed at the last touch within a time, of a body that first touches at v (length/time).

    Flights last 2 v eⁿ/g, so T = v/g (1 + 2 e + 2 e² + ... + 2 eⁿ), fall included, gives
    eⁿ = 1 - (T g/v - 1)(1 - e)/(2 e), and the last touch within T is at v eⁿ.
    """
    e = np.maximum(restitution, 1e-3)
    flights = np.maximum(time * gravity / np.maximum(speed, 1e-300) - 1.0, 0.0)
    left = 1.0 - flights * (1.0 - e) / (2.0 * e)
    found: np.ndarray = speed * np.clip(left, LEAST_BOUNCE, 1.0)
    return found


# --- how fine -------------------------------------------------------------------------------------------------


def sagitta(radius: Number, chord: Number) -> Number:
    """How far a chord stays within an arc (length): r - sqrt(r² - c²/4), about c²/8r."""
    half = 0.5 * chord
    return half * half / (radius + np.sqrt(radius * radius - half * half))  # the same, without cancellation


def facet_turn(radius: Number, tolerance: Number) -> Number:
    """Angle between two chords of an arc sampled to a sagitta (radians): 4 asin(sqrt(t/2r)), about 2 sqrt(2 t/r)."""
    return 4.0 * np.arcsin(np.sqrt(np.minimum(tolerance / (2.0 * radius), 1.0)))


def tolerance_for_turn(radius: Number, turn: Number) -> Number:
    """The sagitta at which facets turn by that angle (length): 2 r sin²(turn/4)."""
    return 2.0 * radius * np.sin(0.25 * turn) ** 2


def facet_loss(turn: Number, angle: Number, tolerance: Number, depth: Number) -> Number:
    """Share by which a swing gets smaller over the facets of an arc (dimensionless): turn · angle/2 · t²/(t² +
    (d/10)²).

    Each facet's edge takes off the velocity across it, v sin(turn): turn² of the energy, half of that of the amplitude,
    angle/turn times. A contact that is pressed deeper than ten times the facets' sagitta (t < d/10) does not feel
    their edges: the area that it cuts off changes by t/d only, and gives back what it takes.
    """
    return 0.5 * turn * angle * tolerance * tolerance / (tolerance * tolerance + 0.01 * depth * depth)


# --- what bends -----------------------------------------------------------------------------------------------


def deflection(load: float, young: float, thickness: float, length: float, height: float) -> float:
    """How far a load bends a bar, or presses a lump, of that length and height (length).

    F/(E t) · (l/h + (l/h)³/4): compression over the length, and bending on two supports (F l³/(48 E t h³/12);
    Timoshenko, Strength of Materials).
    """
    slender = length / height
    return load / (young * thickness) * (slender + 0.25 * slender**3)


class Blow(NamedTuple):
    """A blow on what yields: its largest force, its frequency (rad/time), and the body's share of its energy."""

    force: float
    frequency: float
    share: float


def blow(speed: float, mass: float, give: float, stiffness: float | None, chord: float) -> Blow:
    """A mass that comes at a speed on what yields by ``give`` (length/force) behind a contact of ``stiffness``
    (force/length²; None: rigid) along ``chord`` (length).

    F = v sqrt(K m), w = sqrt(K/m), 1/K = give + 1/(k L): the energy m v²/2 is F²/2K (Timoshenko, Strength of Materials;
    W. Goldsmith, Impact, 1960, chapter 4).
    """
    both = give + (1.0 / (stiffness * chord) if stiffness else 0.0)
    return Blow(speed * math.sqrt(mass / both), math.sqrt(1.0 / (both * mass)), give / both)


def bar_frequency(young: float, density: float, length: float, height: float) -> float:
    """First elastic frequency of a free bar (rad/time): the slower of bending and stretching.

    22.373 (h/l²) sqrt(E/12 rho) (Euler and Bernoulli), pi/l sqrt(E/rho).
    """
    wave = math.sqrt(young / density)
    return min(22.3733 * height / (length * length) * wave / math.sqrt(12.0), math.pi / length * wave)


def ring_frequency(young: float, density: float, radius: float, height: float) -> float:
    """First elastic frequency of a free ring of mean radius R and radial height (rad/time).

    sqrt(36/5) sqrt(E h²/12 rho)/R²: two lobes (Timoshenko, Vibration Problems in Engineering; Love, Treatise, 293).
    """
    return math.sqrt(7.2 * young * height * height / (12.0 * density)) / (radius * radius)


def dynamic_error(excitation: float, elastic: float) -> float:
    """What statics leaves out of a deflection, relative: r²/|1 - r²|, r the excitation over the elastic frequency."""
    r2 = (excitation / elastic) ** 2
    return math.inf if r2 == 1.0 else r2 / abs(1.0 - r2)


def modes_below(frequency: float, area: float, young: float, density: float) -> int:
    """Elastic modes of a plate in its plane up to a frequency: Weyl's A w²/4 pi (1/cp² + 1/cs²), at least one.

    cp² = E/rho and cs² = E/2.6 rho: plane stress at Poisson's ratio 0.3.
    """
    slow = density / young
    return max(1, math.ceil(area * frequency**2 / (4.0 * math.pi) * slow * 3.6))


# --- how long -------------------------------------------------------------------------------------------------


def free_fall(gravity: Number, h: float, extent: Number) -> Number:
    """How far a body falls in a substep in which nothing holds it yet, over s (dimensionless): g h²/(2 s).

    With h/2 for h, in the half drift before the first solve.
    """
    return gravity * h * h / (2.0 * extent)


def leaning(margin: np.ndarray, slenderness: np.ndarray) -> np.ndarray:
    """By how much a body that stands near its base's edge shifts, over what it would sink by (dimensionless).

    margin: of half the base w, the part between the weight and the edge. While the whole base is pressed (2/3 and
    more), 1/margin. Beyond, a bed of springs holds on 3/2 margin w alone, where the load is a triangle: the edge sinks
    by 4/(3 margin) times as much, over that length, which turns the body by 8/(9 margin²) p; its centre goes that,
    times the slenderness (half its diagonal over w).
    """
    found: np.ndarray = np.maximum(
        1.0 / margin, np.where(margin < 2.0 / 3.0, 8.0 / (9.0 * margin * margin) * slenderness, 0.0)
    )
    return found


def sweeps_wanted(layers: Number, ratio: Number) -> Number:
    """Sweeps of Gauss and Seidel with which a load has gone through a pile (dimensionless): CARRY n sqrt(ratio).

    A chain of n masses has modes whose squared frequencies reach from about (pi/2n)² to 4, and conjugate sweeps
    take half the root of that quotient for each e-fold: 2 n/pi (Hestenes and Stiefel 1952); ln(100) of them are 3
    n. `ratio`: the mass of a body over that of one below it, whose root widens the quotient. Fewer of ours do where
    nothing is shared (`sweeps_ours`).
    """
    return CARRY * layers * np.sqrt(np.maximum(ratio, 1.0))


def sweeps_ours(layers: float, shared: bool, struck: float = 0.0, sweeps: int = SEARCH_SWEEPS) -> float:
    """Sweeps of ours in which a load has gone through a pile (dimensionless): CARRY n sqrt(struck).

    Every `SEARCH_SWEEPS` there is a step for all contacts at once (`kernel.conjugate`): one is exact on towers and
    chains, whatever their masses, so that with so many `sweeps` a substep nothing is left for the next (0). Where
    supports are shared it is a step of conjugate gradients among others. struck: the mass of what falls on the pile
    over that of what it falls on, 0 where nothing does: what lies on it already has been carried before, a blow has
    not.
    """
    if shared or struck > 1.0:
        return CARRY * layers * math.sqrt(max(struck, 1.0))
    if struck == 0.0 and layers > 1.0 and sweeps >= SEARCH_SWEEPS:
        return 0.0
    return min(CARRY * layers, SEARCH_SWEEPS)


def pile_sag(gravity: Number, h: float, extent: Number, wanted: Number, sweeps: float) -> Number:
    """How far a pile sinks before its loads are found, over s (dimensionless): (1 + wanted/sweeps)² g h²/(2 s).

    The warm start goes on where the substep before has stopped, so that the loads take 1 + wanted/sweeps substeps
    to get through, and what they do not hold yet falls freely for so long.
    """
    return free_fall(gravity, h, extent) * (1.0 + wanted / sweeps) ** 2


# --- numbers that are not derived ----------------------------------------------------------------------------------

CARRY = 3.0
"""Conjugate sweeps a layer: (2/pi) ln(100), which is 2.9 (dimensionless)."""
LEAST_SWEEPS, LEAST_PILE_SWEEPS = 5, SEARCH_SWEEPS
"""Of a body on fixed ones, whose normal forces at a face's two ends and friction answer to each other; and of a pile:
with fewer there is no step for all contacts at once (`sweeps_ours`), and errors go neither with substeps nor with
depth. Measured, with five sweeps beside ten: an arch a hundredth lower, a blow on a crate off by 2 to 10 % beside
0.1 to 0.5, a tower of ten by 1.5 % beside 1e-7, at one to three substeps."""
MOST_HEAVIER = 100.0
"""Times as heavy as what it lies on, from which on a pile wants `LEAST_PILE_STEPS`: a light crate jammed by friction
between forces that are a thousand times its weight lets go at a solve's least error, and with two substeps the second
answers it. Measured on a crate across two others, 27 settings each, one substep: none lets go at ratios of 10, 30 and
100, 1 at 300, 2 at 1,000, 6 at 3,000; two: none up to 1,000, 2 at 3,000."""
LEAST_PILE_STEPS = 2
"""Substeps for a pile of three and more: what the first has met, the second answers. Measured: with one, an arch and
five books over an edge may fall. And for what slides over seams on a bed that gives less than it falls: with one, it is
tilted at each."""
SEAM = 3.0
"""So many times its depth a body is off after each seam that it slides over. Measured on tiles: 2.2 to 3, from one to
64 substeps (dimensionless)."""
LEAST_BOUNCE = 0.1
"""Bounces slower than this part of the first are rest to whoever looks at the whole (dimensionless)."""
TOPPLE = math.cosh(3.0)
"""By how much a body that turns about a corner magnifies what its corner was off at first: an inverted pendulum
from near balance takes about three e-foldings to fall (dimensionless)."""
