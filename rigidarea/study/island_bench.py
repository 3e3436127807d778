"""One level, three needs: a pile, a gear pair and bouncing balls, planned together and each alone.

What substeps of their own save: the level by one plan, beside the sum of the three alone, and beside everybody in the
substeps of the most delicate.
"""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
import pymunk

from ..plan import Plan, plan
from ..report import envelope
from .records import Row
from .scenes import gears_scene
from .timing import one_core, spent

G = 9.81
FRAME = 1 / 60
SECONDS = 2.0
TOLERANCE = 0.01
WIDE, HIGH, BALLS = 32, 25, 20
"""Boxes in the pile's lowest row, and rows, each one shorter: 500 boxes."""
NAMES = ("pile", "gears", "balls")
SPEED = 10.0 * gears_scene.SPEED
"""Of the gears' drive (1/time): fast enough that it wants more substeps than the pile."""
DROP, RADIUS, RESTITUTION = 2.0, 0.5, 0.8
ROUNDS = 5

Error = Callable[[float], float]
"""At a time."""


def _pile(space: pymunk.Space) -> Error:
    """500 boxes, each on two, narrower row by row. Error: how far one is from where it was put, over its side."""
    placed = []
    for row in range(HIGH):
        for column in range(WIDE - row):
            body = pymunk.Body(1.0, 1.0 / 6.0)
            body.position = 1.01 * (column + 0.5 * row), row + 0.5
            box = pymunk.Poly.create_box(body, (1.0, 1.0))
            box.friction = 0.8
            space.add(body, box)
            placed.append((body, body.position))
    return lambda _: max(abs(body.position - at) for body, at in placed)


def _gears(space: pymunk.Space) -> Error:
    """The study's pair, ten times as fast. Error: root mean square of the driven speed's, as the study has it."""
    scene = gears_scene.scene()
    wide, narrow = (gears_scene.gear(teeth, 1e-4 * scene.size) for teeth in gears_scene.TEETH)
    driver = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    driver.position, driver.angular_velocity = (-30.0, 10.0), SPEED
    driven = pymunk.Body(gears_scene.MASS, gears_scene.gear(gears_scene.TEETH[1]).moment(gears_scene.MASS))
    at, start = scene.bodies[0], scene.bodies[1]
    driven.position = -30.0 + start.position[0] - at.position[0], 10.0
    driven.angle, driven.angular_velocity = start.angle, start.angular_velocity * SPEED / gears_scene.SPEED
    brake = pymunk.SimpleMotor(space.static_body, driven, 0.0)
    brake.max_force = gears_scene.BRAKE
    space.add(driver, driven, wide.add_to(driver), narrow.add_to(driven))
    space.add(pymunk.PivotJoint(space.static_body, driven, driven.position), brake)
    exact = -SPEED * gears_scene.TEETH[0] / gears_scene.TEETH[1]
    seen: list[float] = []

    def error(_: float) -> float:
        seen.append(driven.angular_velocity / exact - 1.0)
        return float(np.sqrt(np.mean(np.square(seen[len(seen) // 4 :]))))

    return error


def height(time: float, drop: float) -> float:
    """Height of a ball over where it bounces that has been dropped from `drop` (length)."""
    speed = math.sqrt(2.0 * G * drop)
    since = time - speed / G
    if since < 0.0:
        return drop - 0.5 * G * time * time
    while True:
        speed *= RESTITUTION
        if since <= 2.0 * speed / G:
            return speed * since - 0.5 * G * since * since
        since -= 2.0 * speed / G


def _balls(space: pymunk.Space) -> Error:
    """Twenty balls, each dropped from another height. Error: how far one is from its parabola, over its drop."""
    dropped = []
    for i in range(BALLS):
        drop = DROP * (1.0 + 0.05 * i)
        body = pymunk.Body(1.0, 0.5 * RADIUS**2)
        body.position = 60.0 + 3.0 * i, RADIUS + drop
        ball = pymunk.Circle(body, RADIUS)
        ball.elasticity = RESTITUTION
        space.add(body, ball)
        dropped.append((body, drop))

    return lambda time: max(
        abs(body.position.y - RADIUS - height(time, drop)) / drop for body, drop in dropped
    )


PARTS = {"pile": _pile, "gears": _gears, "balls": _balls}


class Level:
    """A space with what is named in it, planned."""

    def __init__(self, names: Sequence[str], steps: int | None = None) -> None:
        self.space = pymunk.Space()
        self.space.gravity = 0.0, -G
        ground = pymunk.Segment(self.space.static_body, (-100.0, 0.0), (200.0, 0.0), 0.0)
        ground.friction, ground.elasticity = 0.8, 1.0
        self.space.add(ground)
        self.errors = {name: PARTS[name](self.space) for name in names}
        self.plan: Plan = plan(self.space, TOLERANCE, SECONDS, frame=FRAME)
        if steps is not None:
            self.plan.override(steps=steps)
        self.plan.apply()

    @property
    def finest(self) -> int:
        """Substeps of the most delicate."""
        return max(self.plan.finer.values(), default=self.plan.steps)

    def worst(self) -> dict[str, float]:
        """The largest error of each part over the time that is planned for, looked at once a frame."""
        found = dict.fromkeys(self.errors, 0.0)
        for frame in range(1, round(SECONDS / FRAME) + 1):
            self.plan.step(FRAME)
            for name, error in self.errors.items():
                now = error(frame * FRAME)
                found[name] = now if name == "gears" else max(found[name], now)
        return found


def islands() -> Row:
    """The study: the object of `bench islands`."""
    rows: list[Row] = []
    builds = {"all, one plan": partial(Level, NAMES), **{name: partial(Level, (name,)) for name in NAMES}}
    finest = builds["all, one plan"]().finest
    builds["all at the finest"] = partial(Level, NAMES, finest)
    times: dict[str, list[float]] = {what: [] for what in builds}
    levels = {what: build() for what, build in builds.items()}
    frames = round(SECONDS / FRAME / ROUNDS)
    with one_core():
        for _ in range(ROUNDS):  # in turn: a drift of the machine hits all alike
            for what, level in levels.items():
                times[what].append(spent(level.plan.step, FRAME, frames) / frames)
    alone = sum(statistics.median(times[name]) for name in NAMES)
    for what, build in builds.items():
        level = build()
        frame = statistics.median(times[what])
        errors = level.worst() if what != "all at the finest" else {}
        rows.append(
            {
                "tolerance": TOLERANCE,
                "what": what,
                "steps": level.plan.steps,
                "finest": level.finest,
                "sweeps": level.plan.sweeps,
                "penetration": level.plan.penetration,
                "frame_ms": 1e3 * frame,
                "over_sum_alone": frame / alone if what.startswith("all") else None,
                **{f"{name}_error": errors.get(name) for name in NAMES},
                "within": max(errors.values()) <= TOLERANCE if errors else None,
            }
        )
    return envelope("bench", {"what": "islands", "seconds": SECONDS, "frame": FRAME}, rows)
