"""Scenes of any number of bodies with a known answer: towers that stand, a pyramid, a gas that keeps its energy."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from .everyday_scenes import pile
from .scene import OMEGA, VX, VY, Body, Scene, Trace, block, box, disc, floor, rest_error, set_up

TOWER = 5
"""Boxes in a tower."""
SEED = 20


def towers(bodies: int) -> Scene:
    """Towers of five unit boxes side by side on one floor; exact: nothing moves."""
    count = max(bodies // TOWER, 1)
    places = [(i, j) for i in range(count) for j in range(TOWER)]
    boxes = [block(f"box{i}_{j}", 1.0, 1.0, (2.0 * i - count, j + 0.5)) for i, j in places]
    return _standing("towers", floor(2.0 * count + 20.0), boxes)


def pyramid(bodies: int) -> Scene:
    """Unit boxes in a pyramid, each on two; exact: nothing moves."""
    base = max(round((math.sqrt(8 * bodies + 1) - 1) / 2), 1)
    return _standing("pyramid", floor(2.0 * base + 20.0), pile(base, 1.0, 0.05, 0.0, SEED))


def _standing(name: str, ground: Body, boxes: list[Body]) -> Scene:
    error = partial(rest_error, names=[body.name for body in boxes], size=1.0, last=0.0)
    return set_up(name, (ground, *boxes), 3.0, error, "displacement / side", friction=0.5)


def gas(bodies: int) -> Scene:
    """Equal elastic discs in a box without gravity, two fifths of it filled; exact: the energy stays."""
    radius, pitch = 0.5, 1.4
    columns = math.ceil(math.sqrt(bodies))
    side = columns * pitch / 2
    generator = np.random.default_rng(SEED)
    velocities = generator.normal(0.0, 2.0, (bodies, 2))
    discs = []
    for i, (vx, vy) in enumerate(velocities.tolist()):
        place = (i % columns + 0.5) * pitch - side, (i // columns + 0.5) * pitch - side
        discs.append(disc(f"disc{i}", radius, place, velocity=(vx, vy)))
    wall = side + 1.0
    lying, upright = (2 * wall + 2, 2.0), (2.0, 2 * wall + 2)
    sides = ((lying, (0.0, -wall)), (lying, (0.0, wall)), (upright, (-wall, 0.0)), (upright, (wall, 0.0)))
    walls = tuple(
        Body(f"wall{i}", (box(*size),), place, kind="static") for i, (size, place) in enumerate(sides)
    )

    def error(trace: Trace) -> float:
        """Relative change of kinetic energy at the end, contacts under way left out by the median of ten frames."""
        moving = trace.states[:, len(walls) :]
        energy = np.sum(moving[:, :, VX] ** 2 + moving[:, :, VY] ** 2, axis=1)
        energy += np.sum(moving[:, :, OMEGA] ** 2, axis=1) * radius**2 / 2
        return float(abs(np.median(energy[-10:]) / energy[0] - 1))

    told: dict[str, Any] = {"gravity": (0.0, 0.0), "elasticity": 1.0, "pressure": 8.0}
    return set_up("gas", (*walls, *discs), 3.0, error, "relative change of energy", **told)


CROWDS: dict[str, Callable[[int], Scene]] = {"towers": towers, "pyramid": pyramid, "gas": gas}
