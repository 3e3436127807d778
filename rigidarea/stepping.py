"""A frame into steps: how stiff the contacts can get, and how short a step that asks for (design 2.3).

The stiffness of a contact is k L, L its chord. What decides is not the chord of now but the longest one that can
come: a box that hits with a corner lands on its face. So every shape brings the chord with which it would lie flat
(`pool.HEAD.face`), and the step is planned for the stiffest such contact, in a stack; chords longer than that, which
only conforming concave outlines have, are taken from the last step as they are met.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pymunk
import pymunk.batch
from pymunk._chipmunk_cffi import ffi, lib

from .kernel.jit import njit
from .kernel.pool import Pool
from .kernel.region import LAW_AREA, Law
from .kernel.tables import Tables

#: Largest phase w h of the stiffest contact within a step. Symplectic Euler is stable below 2; the frequency is
#: already that of a body between two others in a stack (twice a single contact's), so that this is 1/9 of what a
#: single contact could bear: the rest is accuracy (restitution within 0.002).
PHASE = 0.45
#: Penetration that `attach` allows a body at rest, as a fraction of its size, when it chooses the stiffness. A tower
#: of about (0.65 / this)^(1/3) boxes stands: 14.
PENETRATION = 2e-4
#: The same for the fastest body's impact, where there is no gravity.
IMPACT_PENETRATION = 0.05
#: At rest is slower than this many times the speed that gravity gives within a contact's natural time.
REST_SPEEDS = 2.0


@njit
def highest_frequency(pool: Pool, tables: Tables, shapes: int, law: Law, stamp: int) -> float:
    """Largest angular frequency (1/time) that a contact of these shapes can have, or had in step `stamp`.

    A chain of equal masses m and springs k L has no frequency above 2 sqrt(k L / m): inside a stack (Gershgorin).
    """
    most = 0.0
    for i in range(shapes):
        shape = tables.shapes[i]
        if shape.outline < 0:
            continue
        head = pool.heads[shape.outline]
        length = head.face
        stiffness = length if law.law == LAW_AREA else length * length / law.length
        most = max(most, stiffness * (shape.inverse_mass + head.face_arm**2 * shape.inverse_moment))
    stiffest = law.stiffness * most
    for i in range(tables.regions.size):
        if tables.regions[i].stamp == stamp:
            stiffest = max(stiffest, tables.regions[i].rate2)
    return 2.0 * math.sqrt(stiffest)


def choose_stiffness(space: pymunk.Space, sizes: dict[pymunk.Body, float], penetration: float) -> float:
    """k (force/length^2) with which no body of `sizes` (length) sinks deeper than `penetration` of its size.

    From each body's weight; without gravity from its speed, and IMPACT_PENETRATION. Raises ValueError where neither
    says anything.
    """
    gravity = abs(space.gravity)
    k = 0.0
    for body, size in sizes.items():
        k = max(k, body.mass * gravity / (penetration * size**2))
        if gravity == 0.0:
            k = max(k, body.mass * body.velocity.length**2 / (size * (IMPACT_PENETRATION * size) ** 2))
    if not (k > 0.0 and math.isfinite(k)):
        raise ValueError(
            "stiffness cannot be chosen: expected gravity or a moving body to choose it from, got gravity "
            f"{tuple(space.gravity)} and {len(sizes)} bodies at rest; pass stiffness=..."
        )
    return k


def choose_rest_speed(space: pymunk.Space, sizes: dict[pymunk.Body, float], stiffness: float) -> float:
    """Closing speed (length/time) below which a contact rests from its first touch: gravity's within its own time."""
    gravity = abs(space.gravity)
    softest = [math.sqrt(body.mass / (stiffness * size)) for body, size in sizes.items()]
    return REST_SPEEDS * gravity * min(softest, default=0.0)


_Fields = pymunk.batch.BodyFields
_STATE = _Fields.POSITION | _Fields.ANGLE | _Fields.VELOCITY | _Fields.ANGULAR_VELOCITY


class Watch:
    """Looks at the state of all bodies after every step, and keeps the last good one: two buffers in turn, no copy."""

    def __init__(self, space: pymunk.Space) -> None:
        self._space = space
        self._buffers = [pymunk.batch.Buffer(), pymunk.batch.Buffer()]

    def take(self) -> None:
        """Take the present state."""
        self._buffers.reverse()
        self._buffers[0].clear()
        pymunk.batch.get_space_bodies(self._space, _STATE, self._buffers[0])

    def look(self) -> bool:
        """Take the present state; whether it is finite."""
        self.take()
        return math.isfinite(float(self._rows(0).sum()))  # a sum is not finite if one number is not

    def put_back(self) -> str:
        """Put all bodies back to the state before the last, and say which was not finite."""
        now, good = self._rows(0), self._rows(1)
        found: list[Any] = []
        handle = ffi.new_handle(found)
        lib.cpSpaceEachBody(self._space._space, lib.ext_cpSpaceBodyIteratorFunc, handle)
        bodies = [ffi.from_handle(lib.cpBodyGetUserData(body)) for body in found]
        known = list(self._space.bodies)
        names = [
            f"bodies[{known.index(body)}]" if body in known else "a body"
            for body, row in zip(bodies, now)
            if not np.isfinite(row).all()
        ]
        what = "bodies came or went in that step, so the state is as it left them"
        if len(good) == len(now):
            what = "all bodies were put back to the step before"
            for body, row in zip(bodies, good):
                body.angle, body.position = row[2], (row[0], row[1])
                body.velocity, body.angular_velocity = (row[3], row[4]), row[5]
        return f"the state of {', '.join(names[:3])} is not finite ({what})"

    def _rows(self, which: int) -> np.ndarray:
        return np.frombuffer(self._buffers[which].float_buf(), dtype=np.float64).reshape(-1, 6)
