"""Parts of a space that nothing connects, each planned for itself: what is delicate makes nobody else pay.

Islands are those of the frame (`kernel.islands`): what is near, or jointed, directly or through others that move.
Those of a kind are one part: teeth and slots at work; what touches others that move; what is alone.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import pymunk
from numpy.typing import NDArray

from .facts import Facts, facts
from .survey import Survey

#: Kinds, as a plan's table names them.
KINDS = ("alone", "touching others", "teeth or slots")


class Part(NamedTuple):
    """Bodies that are planned for together."""

    kind: str
    bodies: list[pymunk.Body]  # none static
    facts: Facts


def parts_of(seen: Survey, space: pymunk.Space, frame: float, time: float) -> list[Part]:
    """The parts of a space, one a kind; none where all is of one kind."""
    static = seen.static
    labels, several = _islands(seen, space)
    kind = several.astype(np.int64)  # of each island
    toothed = np.zeros(len(several), bool)
    toothed[labels[seen.owner[seen.concave]]] = True
    kind[toothed & several] = 2
    of = np.where(static, -1, kind[labels])
    kinds = np.unique(of[seen.moves])
    if len(kinds) < 2:
        return []
    found = []
    for k in kinds:
        mine = of == k
        part = facts(alone(seen, mine), frame, time)
        found.append(Part(KINDS[k], [body for body, own in zip(seen.bodies, mine) if own], part))
    return found


def _islands(seen: Survey, space: pymunk.Space) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """(bodies,) number of its island, and (islands,) whether it has several bodies; what is static is none's."""
    index = {body: i for i, body in enumerate(seen.bodies)}
    joints = [(index.get(joint.a, -1), index.get(joint.b, -1)) for joint in space.constraints]
    links = np.concatenate((seen.owner[seen.pairs], np.array(joints, np.int64).reshape(-1, 2)))
    links = links[(links >= 0).all(axis=1)]
    static = seen.static
    links = links[~static[links].any(axis=1)]
    labels = np.arange(len(seen.bodies))
    while True:  # the least number of an island goes along its links, and along what it has come to already
        least = np.minimum(labels[links[:, 0]], labels[links[:, 1]])
        before = labels.copy()
        np.minimum.at(labels, labels[links[:, 0]], least)
        np.minimum.at(labels, labels[links[:, 1]], least)
        labels = labels[labels]
        if (labels == before).all():
            break
    return labels, np.bincount(labels[~static], minlength=len(labels)) > 1


def alone(seen: Survey, mine: NDArray[np.bool_]) -> Survey:
    """The survey as if only these bodies moved, and nobody else were there but what is static."""
    free = mine & seen.moves
    own = mine[seen.owner]
    pairs = own[seen.pairs].any(axis=1)
    used = own.copy()
    used[seen.pairs[pairs].ravel()] = True
    there = mine | seen.static
    way = seen.velocity[free]
    return seen._replace(
        mass=np.where(free, seen.mass, math.inf),
        moment=np.where(free, seen.moment, math.inf),
        velocity=np.where(there[:, None], seen.velocity, 0.0),
        speed=np.where(there, seen.speed, 0.0),
        spin=np.where(there, seen.spin, 0.0),
        extent=np.where(free, seen.extent, math.inf),
        radius=np.where(used, seen.radius, 0.0),
        concave=seen.concave & used,
        pairs=seen.pairs[pairs],
        gaps=seen.gaps[pairs],
        apart=float(np.hypot(*(way - way.mean(axis=0)).T).max()) if len(way) else 0.0,
    )
