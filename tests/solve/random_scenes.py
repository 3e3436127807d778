"""Seeded random scenes over the whole range of stiffness, steps, mass ratio, restitution, friction; what they keep."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from solve_world import ENGINE, World, regular

STEPS = (1, 2, 3, 4, 6, 8, 16, 32)
ROOM = 8.0


@dataclass(frozen=True)
class Recipe:
    """One scene. `free`: no walls, no gravity; `alone`: bodies pass through each other, and meet flat walls only."""

    seed: int
    stiffness: float  # (N/m²), of masses up to 1 kg
    steps: int
    ratio: float  # of the heaviest to the lightest mass
    elasticity: float
    friction: float
    free: bool
    alone: bool
    law: str
    gravity: float

    @property
    def straight(self) -> bool:
        """Whether `law="area"` must keep the energy: a straight edge in every contact, or impulses.

        An impulse: phase w h > 4 for the softest landing, w² = k s/m with s = 0.5, m = 1.
        """
        phase = math.sqrt(self.stiffness * 0.5) / 60 / self.steps
        return self.alone or phase > 4.0


def recipe(seed: int, law: str = "energy") -> Recipe:
    """The scene of a seed: every fourth free, every third of bodies that do not meet, every fifth elastic."""
    draw = np.random.default_rng(seed)
    elastic = seed % 5 == 0
    free = seed % 4 == 1
    return Recipe(
        seed=seed,
        stiffness=10 ** draw.uniform(2, 9),
        steps=int(draw.choice(STEPS)),
        ratio=10 ** draw.uniform(0, 4),
        elasticity=1.0 if elastic else float(draw.uniform(0, 1)),
        friction=0.0 if elastic else float(draw.uniform(0, 1)),
        free=free,
        alone=seed % 3 == 0 and not free,
        law=law,
        gravity=0.0 if free else float(draw.choice([0.0, 10.0])),
    )


def build(r: Recipe, engine: str = ENGINE, iterations: int | None = None, shift: float = 0.0) -> World:
    """Nine boxes, discs, pentagons, planks that move at 3 m/s or so; `shift` moves the first one (length)."""
    draw = np.random.default_rng(r.seed + 1000)
    world = World(
        r.gravity,
        stiffness=r.stiffness,
        friction=r.friction,
        elasticity=r.elasticity,
        engine=engine,
        iterations=iterations,
        **({"law": r.law} if engine == "area" else {}),
    )
    if not r.free:
        far = 4 * ROOM
        for left, bottom, right, top in ((-far, -far, -ROOM / 2, far), (ROOM / 2, -far, far, far)):
            world.block(left, bottom, right, top)
            world.block(bottom, left, top, right)
    for i in range(9):
        at = np.array((i % 3 - 1, i // 3 - 1)) * 2.0 + draw.uniform(-0.25, 0.25, 2)
        mass = r.ratio ** (-float(draw.uniform(0, 1)) if i else 0.0)
        velocity = draw.normal(0, 2, 2) - (at if r.free else 0.0)  # free ones fly at each other
        motion = {
            "mass": mass,
            "velocity": tuple(velocity),
            "spin": float(draw.normal(0, 2)),
            "angle": float(draw.uniform(0, 2 * math.pi)),
        }
        at[0] += shift * (i == 0)
        size = float(draw.uniform(0.6, 1.0))
        kind = int(draw.integers(4))
        if kind == 0:
            body = world.box(at, (size, size), **motion)
        elif kind == 1:
            body = world.disc(at, size / 2, **motion)
        elif kind == 2:
            body = world.polygon(at, regular(5, size / 2), **motion)
        else:
            body = world.box(at, (1.1 * size, 0.4 * size), **motion)
        if r.alone:
            for shape in body.shapes:
                shape.filter = type(shape.filter)(group=1)
    return world


@dataclass(frozen=True)
class Kept:
    """What a run showed: energies are kinetic + potential, shares of the larger of kinetic at the start and m g fall.

    gained: most over the start; lost: of the bodies taken one by one, in their best frame of the last second (where
    they do not meet each other). momentum: change over Σ m v (r); finite: everything, always.
    """

    gained: float
    lost: float
    momentum: float
    finite: bool
    ends: np.ndarray


def energies(world: World, gravity: float) -> np.ndarray:
    """(n,) mechanical energy of each body, potential from the room's floor."""
    return np.array(
        [
            b.mass * (b.velocity.length**2 / 2 + gravity * (b.position.y + ROOM / 2))
            + 0.5 * b.moment * b.angular_velocity**2
            for b in world.bodies
        ]
    )


def run(
    r: Recipe, seconds: float = 2.0, engine: str = ENGINE, steps: int | None = -1, **variant: object
) -> Kept:
    """Simulate a scene at its own number of steps (or `steps`)."""
    world = build(r, engine, **variant)  # type: ignore[arg-type]
    steps = r.steps if steps == -1 else steps
    start, momentum = energies(world, r.gravity), world.momentum()
    scale = max(world.kinetic(), sum(b.mass for b in world.bodies) * r.gravity * ROOM)
    parts = sum(b.mass * b.velocity.length * (1 + b.position.length) for b in world.bodies)
    gained, finite = 0.0, True
    best = np.full(len(start), -math.inf)
    frames = round(seconds * 60)
    for i in range(frames):
        world.step(steps)
        now = energies(world, r.gravity)
        finite = finite and bool(np.isfinite(now).all())
        if not finite:
            gained = math.inf
            break
        gained = max(gained, (now.sum() - start.sum()) / scale)
        if i >= frames - 60:
            best = np.maximum(best, now)
    drift = float(np.abs(world.momentum() - momentum).max() / parts)
    lost = float(((start - best) / np.maximum(start, 1e-9)).max())
    return Kept(gained, lost, drift, finite, world.state()[:, :2])
