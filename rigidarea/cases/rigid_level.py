"""The rigid level of a mechanism, through the pymunk hook: a driver that turns as told, and a wheel on a pivot.

Leaves the same ``Record`` as the flexible stepper, so that a case measures both alike.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pymunk

import rigidarea
from rigidarea.flexible.integrate import Record


def turn(
    driver: rigidarea.Outline,
    wheel: rigidarea.Outline,
    at: tuple[float, float],
    density: float,
    angles: tuple[float, float],
    speed: Callable[[float], float],
    stiffness: float,
    damper: float,
    duration: float,
    h: float,
) -> Record:
    """Steps ``driver`` (about the origin) at ``speed(t)`` against ``wheel``, pivoted at ``at``, with a torsional
    damper.

    density: mass an area. angles: of driver and wheel at t = 0. Frictionless, undamped contact: F = stiffness · A.
    """
    space = pymunk.Space()
    crank = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    crank.angle = angles[0]
    driven = wheel.body(density=density)
    driven.position, driven.angle = at, angles[1]
    for outline, body in ((driver, crank), (wheel, driven)):
        shape = outline.add_to(body)
        shape.elasticity, shape.friction = 1.0, 0.0
        space.add(body, shape)
    pivot = pymunk.PivotJoint(space.static_body, driven, at)
    pivot.collide_bodies = True
    space.add(pivot)
    # Eq. 5 and 8-15 literally, as a verification asks: the chord would lean by another third of a degree on gear
    # flanks, and a contact taken implicitly is softer than k where the step is long for it
    most = 16  # regions of the one pair: more than a mechanism's teeth in contact
    contact = rigidarea.attach(space, stiffness=stiffness, direction="nodal", integration="explicit")
    n = round(duration / h)
    x, v = np.zeros((n, 2, 3)), np.zeros((n, 2, 3))
    force, regions = np.zeros((n, 2)), np.zeros((n, most, 5))
    for i in range(n):
        # the middle of the step: the angle is then exact for a ramp
        crank.angular_velocity = speed((i + 0.5) * h)
        driven.torque = -damper * driven.angular_velocity
        space.step(h)
        x[i] = (*crank.position, crank.angle), (*driven.position, driven.angle)
        v[i] = (0.0, 0.0, crank.angular_velocity), (*driven.velocity, driven.angular_velocity)
        for k, r in enumerate(contact.regions[:most]):
            sign = 1.0 if r["body_b"] is driven else -1.0
            regions[i, k] = r["force"], *(sign * r["direction"]), *r["centroid"]
            force[i] += sign * r["force"] * r["direction"]
    contact.detach()
    kinetic = 0.5 * driven.moment * v[:, 1, 2] ** 2
    one, none, empty = np.ones(n), np.zeros(n), np.zeros(0)
    return Record(
        h * np.arange(1.0, n + 1.0), x, v, x[:, :, 2], v[:, :, 2], force[:, None], regions,
        np.where(regions[:, :, 0] > 0, 0, -1), one, none, none, kinetic, empty, empty, np.zeros((n, 0, 3)), n,
    )  # fmt: skip
