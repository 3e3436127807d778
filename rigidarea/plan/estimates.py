"""Closed forms by which a plan chooses what bends: each with its formula, its source and its unit.

Nothing here is fitted to a scene.

Symbols, and the arguments that they stand for: m `mass` (mass), k `stiffness` of F = k A (force/length²), L `chord`
(length), w `frequency` of a contact (rad/time); E `young` (force/area), rho `density` (mass/volume), l `length`, h
`height` and `thickness` of what bends (length).
"""

from __future__ import annotations

import math
from typing import NamedTuple


def penetration(load: float, stiffness: float, chord: float) -> float:
    """Depth at which a face of length L carries a load (length): F/(k L).

    F = k A (Eq. 5) with A = L d. For a weight: m g/(k L).
    """
    return load / (stiffness * chord)


def contact_frequency(stiffness: float, chord: float, mass: float) -> float:
    """w = sqrt(k L/m) of a mass on a face of length L (1/time): dF/dd = k L (docs/theory.md, 3)."""
    return math.sqrt(stiffness * chord / mass)


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
