"""Seeded variations of the study's scenes: no estimate of a plan has seen them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from rigidarea.geometry.outline import Outline
from rigidarea.study.scene import Body, Circle, Curve, Polygon, Rings, Scene, Segment, scenes

LONGEST = 2.0
"""Simulated time of a variation, at most (s): further on, contacts that come and go part any two runs."""


def vary(scene: Scene, seed: int) -> Scene:
    """The scene with mass, size, friction, elasticity and speed each multiplied by 0.3 to 3, evenly in the
    logarithm."""
    rng = np.random.default_rng(seed)
    mass, size, friction, elasticity, speed = np.exp(rng.uniform(math.log(0.3), math.log(3.0), 5))

    def shape_of(shape: Any) -> Any:
        if isinstance(shape, Circle):
            return Circle(shape.radius * size, (shape.center[0] * size, shape.center[1] * size))
        if isinstance(shape, Polygon):
            return Polygon(tuple((x * size, y * size) for x, y in shape.points), shape.radius * size)
        if isinstance(shape, Segment):
            a, b = ((x * size, y * size) for x, y in (shape.a, shape.b))
            return Segment(a, b, shape.radius * size)

        def rings(tolerance: float, known: Callable[[float], Rings] = shape.rings) -> Rings:
            return [ring * size for ring in known(tolerance / size)]

        def exact(known: Callable[[], Outline] = shape.exact) -> Outline:
            found = known()
            return Outline.from_curve(
                [ring * size for ring in found.rings], arcs=[arcs * size for arcs in found.arcs]
            )

        return Curve(rings, None if shape.exact is None else exact)

    def body_of(body: Body) -> Body:
        return replace(
            body,
            shapes=tuple(shape_of(shape) for shape in body.shapes),
            position=(body.position[0] * size, body.position[1] * size),
            velocity=(body.velocity[0] * speed, body.velocity[1] * speed),
            angular_velocity=body.angular_velocity * speed,
            mass=body.mass * mass,
            moment=body.moment * mass * size * size,
            surface_speed=body.surface_speed * speed,
        )

    return replace(
        scene,
        name=f"{scene.name}-{seed}",
        bodies=tuple(body_of(body) for body in scene.bodies),
        friction=scene.friction * friction,
        elasticity=min(1.0, scene.elasticity * elasticity),
        hinges=tuple(
            replace(hinge, point=(hinge.point[0] * size, hinge.point[1] * size), brake=hinge.brake * mass * size * size)
            for hinge in scene.hinges
        ),
        size=scene.size * size,
        duration=min(scene.duration, LONGEST),
    )  # fmt: skip


def variations(count: int, names: Sequence[str] = ()) -> list[Scene]:
    """Seeded variations, the scenes in turn."""
    known = [scene for name, scene in scenes().items() if not scene.deforms and (not names or name in names)]
    return [vary(known[seed % len(known)], seed) for seed in range(count if known else 0)]
