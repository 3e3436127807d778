"""What a plan cannot promise, and why: what bears on an error and no estimate knows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pymunk
import shapely

from .elastic import Choice
from .predict import Cause
from .survey import Survey

ROW = 3
"""Bodies that blows may pass through, from which on the order of the blows is a question of the step."""


def unpromised(
    space: pymunk.Space, seen: Survey, causes: Sequence[Cause], bending: Sequence[Choice], seconds: float
) -> list[str]:
    """One sentence for each; empty where the predicted error is of all that is there.

    Of a row of blows every one magnifies what a body was off before by about 1 + 2 l/r, l its way and r its radius (N.
    Chernov, R. Markarian, Chaotic Billiards, 2006, chapter 3): no bound holds after a few.
    """
    out = []
    bends = [choice for choice in bending if choice.level != "rigid"]
    if any(_meets_rigid(space, choice.body, bends) for choice in bends):
        out.append("what bends meets what is rigid with its undeformed outline")
    if any(choice.load == 0.0 for choice in bending):
        out.append("what presses a body with a material: neither weight, motor nor blow is seen on one")
    if _hinged(space):
        out.append("bodies that hang in one another by joints: no estimate knows what joints pull")
    row = _row(seen, seconds)
    if row:
        out.append(f"blows may pass through {row} bodies, and each magnifies what was off before")
    if not out and seen.moves.any() and (not causes or causes[0].error == 0.0):
        out.append("something moves, and no estimate bears on it")
    return out


def _meets_rigid(space: pymunk.Space, body: pymunk.Body, bends: Sequence[Choice]) -> bool:
    """Whether a body that bends may collide with one that does not: no joint is between them."""
    others = {choice.body for choice in bends}
    joined = {end for joint in body.constraints for end in (joint.a, joint.b)}
    return any(s.body not in others and s.body not in joined and not s.sensor for s in space.shapes)


def _hinged(space: pymunk.Space) -> bool:
    """Whether joints other than motors and springs are between two bodies that move."""
    free = (pymunk.SimpleMotor, pymunk.DampedSpring, pymunk.DampedRotarySpring, pymunk.GearJoint)
    dynamic = pymunk.Body.DYNAMIC
    return any(
        joint.a.body_type == dynamic and joint.b.body_type == dynamic and not isinstance(joint, free)
        for joint in space.constraints
    )


def _row(seen: Survey, seconds: float) -> int:
    """The most bodies, itself too, that one may come to in the time planned for, as fast as it is: one that comes on at
    more than a fall through a tenth of its own extent gives; 0 below ROW."""
    mine = np.flatnonzero(seen.moves)
    if len(mine) < ROW:
        return 0
    speed, reach = seen.speed[mine], seen.reach[mine]
    fast = speed > np.sqrt(0.2 * seen.g * seen.extent[mine])
    at = np.array([tuple(seen.bodies[i].position) for i in mine])
    points = shapely.points(at)
    ways = speed[fast] * seconds + reach[fast] + reach.max()
    one, _ = shapely.STRtree(points).query(points[fast], predicate="dwithin", distance=ways)
    most = int(np.bincount(one).max(initial=0))
    return most if most >= ROW else 0


def name_of(space: pymunk.Space, who: Any) -> str:
    """What a body or shape is called: its `name`, if the user gave it one, else what it is and where; None: the
    space."""
    if who is None:
        return "space"
    given = getattr(who, "name", None)
    if isinstance(given, str) and given:
        return given
    if isinstance(who, pymunk.Shape):
        return _kind(who) if who.body is None else f"{_kind(who)} of {name_of(space, who.body)}"
    if who is space.static_body:
        return "static_body"
    if who not in space.bodies:
        return "a body that is gone"
    shapes = list(who.shapes)
    kind = _kind(max(shapes, key=lambda shape: shape.area)) if shapes else "body"
    return f"{kind} at ({who.position.x:.4g}, {who.position.y:.4g})"


def _kind(shape: pymunk.Shape) -> str:
    """A shape in a word."""
    if getattr(shape, "outline", None) is not None:
        return "outline"
    if isinstance(shape, pymunk.Circle):
        return "disc"
    if isinstance(shape, pymunk.Segment):
        return "segment"
    corners = shape.get_vertices() if isinstance(shape, pymunk.Poly) else []
    if len(corners) == 4:
        a, b, c, d = corners
        if (
            abs((b - a).dot(c - b)) <= 1e-6 * (b - a).length * (c - b).length
            and ((a + c) - (b + d)).length <= 1e-6 * (c - a).length
        ):
            return "box"
    return "polygon"
