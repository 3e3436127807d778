"""Outlines that are curved or toothed: how fine their facets are, and what those leave."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import shapely

from ..outline import Outline
from . import estimates as est
from .survey import Survey

#: Error that stands for "the motion is another one": a contact missed, a tower that buckles.
LOST = 1.0


#: Teeth from which on a pair of gears hands over smoothly: below, standard teeth are undercut (17 at 20 degrees, fewer
#: where they are shifted).
MANY_TEETH = 12


class Facet(NamedTuple):
    """A sampled curve of the space."""

    shape: int
    turn: float  # between its chords (radians), as it is sampled now
    angle: float  # that contacts run over (radians)
    radius: float  # of curvature (length)
    extent: float  # of the smallest body that lies on it (length)
    clearance: float  # least difference of radii to what lies in it or around it (length)
    known: bool  # whether it can be sampled anew
    lever: (
        float  # of a tooth: how far from the pitch point it bears, over the radius; of a pin: radius over arm
    )
    driven: bool  # turned by something, against teeth or slots

    def error(self, p: float, turn: float, pressed: bool) -> float:
        """Relative error that facets leave which turn by `turn` (radians), at penetration p (fraction of the extent).

        pressed: whether weight holds the contact, which then sinks over the facets' edges.
        """
        sagitta = float(est.tolerance_for_turn(self.radius, turn))
        if (
            self.driven or not pressed
        ):  # the direction swings by the turn, rms turn/sqrt(12), the ratio by that lever
            return self.lever * turn / math.sqrt(12.0)
        lost = float(est.facet_loss(turn, self.angle, sagitta, p * self.extent))
        return min(LOST, max(lost, sagitta / self.clearance))

    def turn_for(self, error: float, p: float, pressed: bool) -> float:
        """The largest turn (radians) whose `error` at p is no larger, to a factor of sqrt(2); LEAST_TURN if none is."""
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


def facets_of(seen: Survey, time: float) -> list[Facet]:
    """The sampled curves of a space, with what contacts run over of each within `time`."""
    found = []
    for k, outline in enumerate(seen.outlines):
        if seen.radius[k] == 0.0 or outline is None or outline.arcs:
            continue
        near = seen.owner[seen.pairs[(seen.pairs == k).any(axis=1)]].ravel()
        extent = float(seen.extent[near].min(initial=math.inf))
        reach = float(seen.reach[seen.owner[k]])
        if seen.concave[k] and pockets(outline) >= MANY_TEETH:
            lever = tooth_lever(outline, reach)
        elif seen.concave[k]:  # the ends of slots
            lever = min(1.0, abs(float(seen.radius[k])) / reach)
        else:  # against what is straight a pin's facets turn nothing; they lift it, so far from where it turns about
            middle = 0.5 * (seen.boxes[k, :2] + seen.boxes[k, 2:])
            arm = math.dist(middle, seen.bodies[seen.owner[k]].position)
            lever = abs(float(seen.radius[k])) / (abs(float(seen.radius[k])) + arm)
        found.append(
            Facet(
                shape=k,
                turn=facet_angle(outline),
                angle=run_over(seen, k, time),
                radius=abs(float(seen.radius[k])),
                extent=extent if math.isfinite(extent) else 0.0,
                clearance=clearance(seen, k),
                known=outline._resample is not None,
                lever=lever,
                driven=driven(seen, k),
            )
        )
    return found


def driven(seen: Survey, k: int) -> bool:
    """Whether something turns the shape number k against teeth or slots, or those against it."""
    mine = seen.pairs[(seen.pairs == k).any(axis=1) & seen.concave[seen.pairs].any(axis=1)]
    own = seen.owner[mine].ravel()
    return bool((seen.spin[own[~seen.moves[own]]] > 0.0).any())


def tooth_lever(outline: Outline, reach: float) -> float:
    """How far from the pitch point a tooth bears, over the radius `reach` (length): about a pitch, four times a tip's
    width (dimensionless, at most 1).
    """
    return min(1.0, 4.0 * tooth(outline) / reach)


def clearance(seen: Survey, k: int) -> float:
    """Least difference of radii between the curve of shape k and what may lie in it or around it (length); infinite
    without.
    """
    mine = seen.pairs[(seen.pairs == k).any(axis=1)]
    other = np.where(mine[:, 0] == k, mine[:, 1], mine[:, 0])
    opposite = seen.radius[other] * seen.radius[k] < 0.0
    return float(np.min(np.abs(seen.radius[other] + seen.radius[k])[opposite], initial=math.inf))


def run_over(seen: Survey, k: int, time: float) -> float:
    """Angle of the curve of shape k that a contact runs over within `time` (radians), no less than one.

    At the speed that its bodies have, or get in a swing to the curve's side, v² = g r on the average, if that
    comes sooner than the time ends; and with the faster of their spins.
    """
    near = seen.owner[seen.pairs[(seen.pairs == k).any(axis=1)]].ravel()
    radius = abs(float(seen.radius[k]))
    falls = min(math.sqrt(seen.g * radius), 0.5 * seen.g * time)
    speed = float(seen.speed[near].max(initial=0.0)) + falls
    spin = max(float(seen.spin[seen.owner[k]]), float(seen.spin[near].max(initial=0.0)))
    return max(1.0, (speed / radius + spin) * time)


@lru_cache(maxsize=256)
def pockets(outline: Outline) -> int:
    """Teeth or slots of an outline: pockets between it and its hull."""
    hull = shapely.convex_hull(outline.polygon)
    found = shapely.get_parts(shapely.difference(hull, shapely.Polygon(outline.polygon.exterior)))
    return sum(part.area > 1e-6 * hull.area for part in found)


@lru_cache(maxsize=256)
def tooth(outline: Outline) -> float:
    """Chord on which a concave outline lies (length): its hull's longest edge that is its own, or its extent."""
    hull = shapely.convex_hull(outline.polygon)
    own = shapely.intersection(shapely.boundary(hull), shapely.boundary(outline.polygon))
    pieces = shapely.get_parts(shapely.line_merge(own) if own.geom_type == "MultiLineString" else own)
    longest = max((piece.length for piece in pieces), default=0.0)
    return min(longest, outline.smallest_extent) or outline.smallest_extent
