"""Measures for the report: what tests look at in passing, as numbers."""

from __future__ import annotations

import math
import traceback
from collections.abc import Callable
from typing import Any

import numpy as np
import random_scenes
import test_buckling
import test_impacts
import test_mass_ratio
import test_overlapped
import test_piles
from solve_world import ENGINE, World, displacement

Measured = Callable[[], tuple[str, bool]]


def below(limit: float, measure: Callable[[], float]) -> Measured:
    """A measure that must stay below `limit`."""

    def run() -> tuple[str, bool]:
        value = float(measure())
        return f"{value:.3g}", value < limit

    return run


def near(exact: float, within: float, measure: Callable[[], float]) -> Measured:
    """A measure that must be `exact`, `within` so much of it (relative)."""

    def run() -> tuple[str, bool]:
        value = float(measure())
        return f"{value:.4g}", abs(value - exact) <= within * abs(exact)

    return run


def holds(test: Callable[..., Any], *cases: tuple[Any, ...]) -> Measured:
    """How many of a test's cases pass, and why the first other does not."""

    def run() -> tuple[str, bool]:
        wrong = []
        for case in cases:
            try:
                test(*case)
            except AssertionError as error:
                why = str(error).strip().splitlines()
                wrong.append(f"{case}: {why[0] if why else _line(error)}")
            except Exception as error:
                wrong.append(f"{case}: {type(error).__name__} {error}")
        text = f"{len(cases) - len(wrong)} of {len(cases)}"
        return (f"{text}; {wrong[0]}"[:78] if wrong else text), not wrong

    return run


def _line(error: BaseException) -> str:
    return traceback.extract_tb(error.__traceback__)[-1].line or "?"


# --- measures that several tests make in passing ---


def restitution_error(e_values: tuple[float, ...], steps: tuple[int | None, ...]) -> float:
    """Largest |separation/approach - e|."""
    return max(
        abs(test_impacts.restitution(landing, partner, e, n, k) - e)
        for landing in ("disc", "flat", "corner")
        for partner in ("floor", "free")
        for k in (None, 1e4, 1e7, 1e9)
        for e in e_values
        for n in steps
    )


def apex_error(steps: tuple[int | None, ...]) -> float:
    return max(
        abs(test_impacts.apex(landing, e, n) - e)
        for landing in ("disc", "flat", "corner")
        for e in (0.25, 0.5, 0.75, 1.0)
        for n in steps
    )


def grip(n: int | None) -> float:
    return float(np.abs(test_impacts.oblique(0.8, 0.5, n) - (2 / 3, 1.5, -2 / 3)).max()) / 3


def spin_drift(n: int | None) -> float:
    world, before = test_impacts.two_discs(0.8, n)
    return float(np.abs(world.momentum() - before).max()) / 4


def parting(kind: str, n: int | None) -> float:
    world = World(stiffness=1e5, friction=0.5)
    test_overlapped.pair(world, kind, 0.4, 1.0)
    return test_overlapped.fastest_ever(world, 2.0, n)


def pushed(n: int | None) -> float:
    world = World(stiffness=1e6)
    body = world.box((0, 0))
    for _ in range(60):
        body.force = 6, 0
        world.step(n)
    return body.velocity.x


def pit(kind: str, n: int | None) -> tuple[str, bool]:
    world = test_piles.pit(kind, 200)
    worst = 0.0
    for _ in range(180):
        world.step(n)
        worst = max(worst, world.fastest())
    inside = test_piles.inside(world.bodies, 6.0, 394.0, 6.0)
    return f"{'all inside' if inside else 'some left'}, fastest {worst:.0f} px/s", inside and worst < 1260


def rest(name: str, n: int | None) -> tuple[str, bool]:
    world = test_piles.PILES[name](ENGINE)
    size = 24.0 if world.space.gravity.y == -test_piles.GRAVITY else 1.0
    found = test_piles.speed_left(world, n) / size
    native = test_piles.speed_left(test_piles.PILES[name]("pymunk"), 4) / size
    return f"{found:.2g} (pymunk at 4: {native:.2g})", found <= max(native, 1e-3)


def tilt(name: str, n: int | None) -> float:
    make = {
        "row": lambda: test_piles.wall(1, friction=0.3),
        "pyramid": lambda: test_piles.pyramid(6, friction=0.3),
        "wall": lambda: test_piles.wall(4, friction=0.3),
    }[name]
    return test_piles.tilted(make(), 0.3, math.atan(0.6), 2.0, n)


def pyramid_shift(rows: int, seconds: float, n: int | None) -> float:
    world = test_piles.pyramid(rows)
    start = world.state()
    world.run(seconds, n)
    return displacement(world, start)


def ratio(kind: str, value: float, n: int | None) -> tuple[str, bool]:
    way, end, moved, speed = test_mass_ratio.sinking(kind, value, n)
    good = way < 0.1 and end <= test_mass_ratio.allowed(kind, value) and moved < 0.1
    return f"way {way:.2g}, end {end:.2g}, moved {moved:.2g}, speed {speed:.1g}", good


def forces_on_two(value: float, n: int | None) -> float:
    world = test_mass_ratio.on_two(value)
    world.run(6.0, n)
    exact = test_mass_ratio.statics(value)
    return float(np.abs(test_mass_ratio.supports(world) / exact - 1).max())


def buckling(n: int | None) -> float:
    return test_buckling.measured(20, 2e-4, n)[0] / test_buckling.growth(20, 2e-4)


def random(law: str, seeds: range) -> tuple[str, bool]:
    gained = lost = momentum = 0.0
    broken = 0
    for seed in seeds:
        r = random_scenes.recipe(seed, law)
        kept = random_scenes.run(r)
        broken += not kept.finite
        if law == "energy" or r.straight:
            gained = max(gained, kept.gained)
            if r.alone and r.elasticity == 1.0:
                lost = max(lost, kept.lost)
        if r.free:
            momentum = max(momentum, kept.momentum)
    good = gained < 0.01 and lost < 0.01 and momentum < 1e-9 and not broken
    return f"gain {gained:.2g}, loss {lost:.2g}, momentum {momentum:.1g}, not finite {broken}", good
