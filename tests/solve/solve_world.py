"""Worlds of pymunk bodies whose contacts are solved by area contact or, to check the tests themselves, by pymunk.

`SOLVE_ENGINE=pymunk pytest tests/solve` runs every test on pymunk's own solver (those marked `area` are left out):
what fails there is either pymunk's own error (said in the test) or the test's.
"""

from __future__ import annotations

import itertools
import math
import os
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import pymunk
import pytest
from shapely import Point, Polygon

import rigidarea as ra

#: "area", or "pymunk" for its own impulses.
ENGINE = os.environ.get("SOLVE_ENGINE", "area")
#: A test of what only area contact has (regions, stiffness, penetration).
area_only = pytest.mark.skipif(ENGINE != "area", reason="of area contact only")
DT = 1 / 60
G = 10.0

Vector = tuple[float, float]


class World:
    """A space with bodies of one friction and one elasticity a pair (each shape has the roots)."""

    def __init__(
        self,
        gravity: float | Vector = 0.0,
        *,
        stiffness: float | None = None,
        friction: float = 0.0,
        elasticity: float = 0.0,
        engine: str = ENGINE,
        iterations: int | None = None,
        **settings: Any,
    ) -> None:
        """gravity: downward, or a vector; the other arguments are those of `attach`, for the engine "area"."""
        self.space = pymunk.Space()
        self.space.gravity = gravity if isinstance(gravity, tuple) else (0.0, -gravity)
        if iterations is not None:
            self.space.iterations = iterations
        if engine == "pymunk":
            # 0.1 is meant for pixels; most bodies here have sizes of 1, and gravity tells which is which
            self.space.collision_slop = 1e-4 * max(abs(self.space.gravity), 10.0)
        self.friction, self.elasticity = math.sqrt(friction), math.sqrt(elasticity)
        self.bodies: list[pymunk.Body] = []
        self.contact = ra.attach(self.space, stiffness, **settings) if engine == "area" else None
        self._h = DT

    # --- bodies ---

    def add(
        self,
        body: pymunk.Body,
        *shapes: pymunk.Shape,
        at: Sequence[float] = (0.0, 0.0),
        angle: float = 0.0,
        velocity: Sequence[float] = (0.0, 0.0),
        spin: float = 0.0,
    ) -> pymunk.Body:
        """Put a body with its shapes into the world."""
        body.position, body.angle = (float(at[0]), float(at[1])), angle
        body.velocity, body.angular_velocity = (float(velocity[0]), float(velocity[1])), spin
        for shape in shapes:
            shape.friction, shape.elasticity = self.friction, self.elasticity
        self.space.add(body, *shapes)
        if body.body_type == pymunk.Body.DYNAMIC:
            self.bodies.append(body)
        return body

    def box(
        self,
        at: Sequence[float],
        size: Vector = (1.0, 1.0),
        mass: float = 1.0,
        kind: int = pymunk.Body.DYNAMIC,
        **motion: Any,
    ) -> pymunk.Body:
        body = pymunk.Body(mass, pymunk.moment_for_box(mass, size), body_type=kind)
        return self.add(body, pymunk.Poly.create_box(body, size), at=at, **motion)

    def disc(
        self,
        at: Sequence[float],
        radius: float = 0.5,
        mass: float = 1.0,
        kind: int = pymunk.Body.DYNAMIC,
        **motion: Any,
    ) -> pymunk.Body:
        body = pymunk.Body(mass, pymunk.moment_for_circle(mass, 0, radius), body_type=kind)
        return self.add(body, pymunk.Circle(body, radius), at=at, **motion)

    def polygon(
        self, at: Sequence[float], points: Sequence[Sequence[float]], mass: float = 1.0, **motion: Any
    ) -> pymunk.Body:
        """A convex body of `points` about their centroid."""
        ring = [(float(x), float(y)) for x, y in points]
        body = pymunk.Body(mass, pymunk.moment_for_poly(mass, ring))
        return self.add(body, pymunk.Poly(body, ring), at=at, **motion)

    def segment(self, a: Vector, b: Vector, radius: float = 0.0) -> pymunk.Segment:
        """Static."""
        return self._static(pymunk.Segment(self.space.static_body, a, b, radius))

    def floor(self, y: float = 0.0, half: float = 500.0) -> pymunk.Segment:
        return self.segment((-half, y), (half, y))

    def fixed(self, points: Sequence[Sequence[float]]) -> pymunk.Poly:
        """A static convex polygon."""
        return self._static(pymunk.Poly(self.space.static_body, [(float(x), float(y)) for x, y in points]))

    def block(self, left: float, bottom: float, right: float, top: float) -> pymunk.Poly:
        """A static box."""
        ring = [(left, bottom), (right, bottom), (right, top), (left, top)]
        return self.fixed(ring)

    def _static(self, shape: Any) -> Any:
        shape.friction, shape.elasticity = self.friction, self.elasticity
        self.space.add(shape)
        return shape

    # --- time ---

    def step(self, steps: int | None = None, frames: int = 1, dt: float = DT) -> None:
        """Frames of dt, each in `steps` (None: the default, of pymunk one)."""
        self._h = dt / (steps or 1)
        if self.contact is not None:
            self.contact.step(dt, frames, steps)
            return
        for _ in range(frames * (steps or 1)):
            self.space.step(self._h)

    def run(self, seconds: float, steps: int | None = None) -> None:
        self.step(steps, round(seconds / DT))

    # --- what it shows ---

    def state(self) -> np.ndarray:
        """(n, 6): x, y, angle, their velocities."""
        rows = [(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in self.bodies]
        return np.array(rows, dtype=float).reshape(-1, 6)

    def kinetic(self) -> float:
        return sum(
            0.5 * b.mass * b.velocity.dot(b.velocity)
            + (0.5 * b.moment * b.angular_velocity**2 if math.isfinite(b.moment) else 0.0)
            for b in self.bodies
        )

    def flight_energy(self, body: pymunk.Body) -> float:
        """Energy a mass of a body in flight, potential from y = 0, constant to rounding in either engine.

        pymunk's own step is first order: what it keeps in free fall is v²/2 + g y + g h v_y/2.
        """
        g = -self.space.gravity.y
        first = 0.0 if self.contact is not None else 0.5 * g * self._h * body.velocity.y
        return body.velocity.dot(body.velocity) / 2 + g * body.position.y + first

    def energy(self) -> float:
        """Kinetic, potential, and what contacts store."""
        if self.contact is not None:
            return self.contact.energy()
        return self.mechanical()

    def mechanical(self) -> float:
        """Kinetic and potential alone: what contacts cannot raise beyond what they had stored."""
        gravity = self.space.gravity
        return self.kinetic() - sum(b.mass * gravity.dot(b.position) for b in self.bodies)

    def momentum(self) -> np.ndarray:
        """(3,): momentum, and angular momentum about the origin."""
        total = np.zeros(3)
        for b in self.bodies:
            spin = b.moment * b.angular_velocity if math.isfinite(b.moment) else 0.0
            turning = spin + b.mass * b.position.cross(b.velocity)
            total += (b.mass * b.velocity.x, b.mass * b.velocity.y, turning)
        return total

    def fastest(self) -> float:
        return max((b.velocity.length for b in self.bodies), default=0.0)

    def finite(self) -> bool:
        return bool(np.isfinite(self.state()).all())


def still(world: World, seconds: float, steps: int | None = None) -> float:
    """Largest speed of any body at the end of any frame of the next `seconds`."""
    worst = 0.0
    for _ in range(round(seconds / DT)):
        world.step(steps)
        worst = max(worst, world.fastest())
    return worst


def displacement(world: World, start: np.ndarray) -> float:
    """Largest way of any body since `start` (`World.state`)."""
    moved = world.state()[:, :2] - start[:, :2]
    return float(np.hypot(moved[:, 0], moved[:, 1]).max())


def outline_of(body: pymunk.Body) -> Polygon:
    """Where a body's first shape is, by shapely: an oracle that knows nothing of contact."""
    shape = next(iter(body.shapes))
    if isinstance(shape, pymunk.Circle):
        return Point(*body.local_to_world(shape.offset)).buffer(shape.radius, 64)
    assert isinstance(shape, pymunk.Poly)
    return Polygon([tuple(body.local_to_world(v)) for v in shape.get_vertices()])


def overlap(world: World) -> float:
    """Largest area that two bodies of the world share (length²)."""
    outlines = [outline_of(b) for b in world.bodies]
    return max((a.intersection(b).area for a, b in itertools.combinations(outlines, 2)), default=0.0)


def regular(corners: int, radius: float) -> list[Vector]:
    """Corners of a regular polygon, an edge at the bottom."""
    turn = -math.pi / 2 + math.pi / corners
    angles = turn + 2 * math.pi * np.arange(corners) / corners
    return [(radius * math.cos(a), radius * math.sin(a)) for a in angles]


def inside(bodies: Iterable[pymunk.Body], left: float, right: float, bottom: float) -> bool:
    """Whether every body's centre lies between two walls and above a floor."""
    return all(left < b.position.x < right and b.position.y > bottom for b in bodies)
