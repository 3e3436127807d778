"""`bench joints`: what hangs in joints at the defaults, beside pymunk at one step and at four: cost of a frame, drift.

Pixels, gravity 900 px/s^2, 60 frames a second. Drift: how far a joint's two anchors are apart that should be together
(pivots), or off their distance (pins) or their groove.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Sequence
from typing import Any

import pymunk

from ..chipmunk import attach
from ..report import Progress, envelope
from .peers import drive
from .records import Row
from .scene import check_known
from .timing import spent

Point = tuple[float, float]
DT = 1 / 60
FRAMES = 360
SETTLING = 60
"""Frames before drift counts: scenes are built in mid-air."""


def _box(space: pymunk.Space, at: Point, size: Point, mass: float = 1.0, group: int = 0) -> pymunk.Body:
    """A box; group: of its filter."""
    body = pymunk.Body(mass, pymunk.moment_for_box(mass, size))
    body.position = at
    shape = pymunk.Poly.create_box(body, size)
    shape.friction = 0.8
    shape.filter = pymunk.ShapeFilter(group=group)
    space.add(body, shape)
    return body


def _pivot(space: pymunk.Space, a: pymunk.Body, b: pymunk.Body, at: Point) -> None:
    joint = pymunk.PivotJoint(a, b, at)
    joint.collide_bodies = False
    space.add(joint)


def chain(space: pymunk.Space) -> None:
    """100 links of 20 px hang in one another, the last one struck from aside."""
    body = space.static_body
    for i in range(100):
        link = _box(space, (0, -20 * i - 10), (4, 20), group=1)
        _pivot(space, body, link, (0, -20 * i))
        body = link
    body.velocity = 300, 0


def bridge(space: pymunk.Space) -> None:
    """40 planks between two cliffs, six crates dropped on them."""
    body = space.static_body
    for i in range(40):
        plank = _box(space, (20 * i + 10, 0), (19, 6), group=1)
        _pivot(space, body, plank, (20 * i, 0))
        body = plank
    _pivot(space, body, space.static_body, (800, 0))
    for i in range(6):
        _box(space, (300 + 40 * i, 40), (24, 24), mass=3.0)


def cloth(space: pymunk.Space) -> None:
    """20 by 20 discs held by pins to their neighbours, the upper row nailed at five."""
    grid: dict[tuple[int, int], pymunk.Body] = {}
    for i in range(20):
        for k in range(20):
            body = grid[i, k] = pymunk.Body(0.1, pymunk.moment_for_circle(0.1, 0, 4))
            body.position = 10 * i, -10 * k
            shape = pymunk.Circle(body, 4)
            shape.filter = pymunk.ShapeFilter(group=1)
            space.add(body, shape)
            space.add(*(pymunk.PinJoint(grid[at], body) for at in ((i - 1, k), (i, k - 1)) if at in grid))
    for i in (0, 5, 10, 15, 19):
        space.add(pymunk.PivotJoint(space.static_body, grid[i, 0], (10 * i, 0)))


def ragdolls(space: pymunk.Space) -> None:
    """Ten of ten limbs, every joint with its limits, fall into a heap."""
    for a, b in (((-400, 0), (400, 0)), ((-400, 0), (-400, 600)), ((400, 0), (400, 600))):
        wall = pymunk.Segment(space.static_body, a, b, 5)
        wall.friction = 0.8
        space.add(wall)
    draw = random.Random(1)
    for n in range(10):
        x, y = draw.uniform(-200, 200), 150 + 130 * n

        def limb(at: Point, size: Point, mass: float = 1.0) -> pymunk.Body:
            return _box(space, (x + at[0], y + at[1]), size, mass=mass, group=n + 1)  # noqa: B023

        def joint(a: pymunk.Body, b: pymunk.Body, at: Point, turn: float) -> None:
            _pivot(space, a, b, (x + at[0], y + at[1]))  # noqa: B023
            space.add(pymunk.RotaryLimitJoint(a, b, -turn, turn))

        torso = limb((0, 0), (20, 40), 4.0)
        joint(torso, limb((0, 30), (14, 16)), (0, 22), 0.5)
        for side in (-1, 1):
            arm, leg = limb((15 * side, 12), (8, 22)), limb((6 * side, -34), (9, 26), 1.5)
            joint(torso, arm, (12 * side, 20), 2.0)
            joint(arm, limb((15 * side, -8), (7, 20)), (15 * side, 2), 1.5)
            joint(torso, leg, (6 * side, -21), 1.0)
            joint(leg, limb((6 * side, -58), (8, 24)), (6 * side, -46), 1.2)


def car(space: pymunk.Space) -> None:
    """Two wheels on grooves with springs and motors, over twenty bumps."""
    road = pymunk.Segment(space.static_body, (-1000, 0), (5000, 0), 5)
    bumps = [
        pymunk.Poly(space.static_body, [(300 * k + 100, 5), (300 * k + 200, 5), (300 * k + 150, 25)])
        for k in range(20)
    ]
    space.add(road, *bumps)
    body = _box(space, (0, 50), (100, 20), mass=10.0, group=1)
    for x in (-35, 35):
        wheel = pymunk.Body(2, pymunk.moment_for_circle(2, 0, 15))
        wheel.position = x, 25
        tyre = pymunk.Circle(wheel, 15)
        tyre.filter = pymunk.ShapeFilter(group=1)
        groove = pymunk.GrooveJoint(body, wheel, (x, -10), (x, -35), (0, 0))
        spring = pymunk.DampedSpring(body, wheel, (x, 0), (0, 0), 35, 3000, 60)
        motor = pymunk.SimpleMotor(wheel, body, 8)
        motor.max_force = 50000
        space.add(wheel, tyre, groove, spring, motor)
    for shape in space.shapes:
        shape.friction = 1.0


SCENES: dict[str, Callable[[pymunk.Space], None]] = {
    make.__name__: make for make in (ragdolls, car, bridge, chain, cloth)
}


def drift(space: pymunk.Space) -> float:
    """The largest of all joints (length)."""
    most = 0.0
    for joint in space.constraints:
        if isinstance(joint, pymunk.PivotJoint | pymunk.PinJoint):
            apart = (joint.a.local_to_world(joint.anchor_a) - joint.b.local_to_world(joint.anchor_b)).length
            most = max(most, abs(apart - getattr(joint, "distance", 0.0)))
        elif isinstance(joint, pymunk.GrooveJoint):
            at = joint.a.world_to_local(joint.b.local_to_world(joint.anchor_b)) - joint.groove_a
            along = (joint.groove_b - joint.groove_a).normalized()
            most = max(most, abs(along.cross(at)))
    return most


def measured(make: Callable[[pymunk.Space], None], steps: int, attached: bool) -> dict[str, float]:
    """Mean processor time of a frame (ms), largest drift after SETTLING frames, kinetic energy a body at the end."""
    space = pymunk.Space()
    space.gravity = 0, -900
    make(space)
    if attached:
        attach(space)
    taken, most = 0.0, 0.0
    for frame in range(FRAMES):
        taken += spent(drive, space.step, steps, DT / steps) * (frame >= 5)
        most = max(most, drift(space)) if frame >= SETTLING else 0.0
    energy = 0.5 * math.fsum(body.kinetic_energy for body in space.bodies) / len(space.bodies)
    return {"ms": 1e3 * taken / (FRAMES - 5), "drift_px": most, "energy_a_body": energy}


def joints(names: Sequence[str] = ()) -> dict[str, Any]:
    """All scenes, or those named: rows `scene`, `joints`, and for `frame`, `native_1`, `native_4` the measures.

    Raises ValueError for a name that is none of SCENES.
    """
    check_known(names, SCENES, "scene")
    measured(chain, 1, True)  # compiled before anything is timed
    rows: list[Row] = []
    progress = Progress("joints", len(names or SCENES))
    for name in names or SCENES:
        row: Row = {"scene": name}
        for label, steps, attached in (("frame", 1, True), ("native_1", 1, False), ("native_4", 4, False)):
            found = measured(SCENES[name], steps, attached)
            row |= {f"{label}_{key}": value for key, value in found.items()}
        row["ratio"] = row["frame_ms"] / row["native_1_ms"]
        rows.append(row)
        progress.step(name)
    return envelope("bench joints", {"scenes": list(names), "frames": FRAMES}, rows)
