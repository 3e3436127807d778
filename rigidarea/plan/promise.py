"""What a plan cannot promise, and why; and what things are called."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pymunk

from ..geometry.outline import outline_on
from .elastic import Choice

OVERLAP = 0.01
"""Depth after a frame, over the smallest extent, beyond which bodies have been put into one another."""


def unpromised(
    space: pymunk.Space, bending: Sequence[Choice], share: float, looked: float, begin: float, tried: int
) -> list[str]:
    """One sentence for each; empty where the error is of all that is there.

    share: of the time planned for that was tried out, `looked` (time). begin: depth after the first frame, over the
    smallest extent. tried: bodies that were.
    """
    out = []
    others = sum(body.body_type != pymunk.Body.STATIC for body in space.bodies) - tried
    if share == 0.0 and space.bodies:
        out.append(
            "anything: a copy alone would cost more than trying out may; plan for more seconds, or fewer bodies"
        )
    elif share < 1.0 and space.bodies:
        out.append(f"what comes after the first {looked:.3g} s: so far it was tried out")
    if others and tried:
        out.append(f"what {others} bodies do, and meet: islands of {tried} others were tried out")
    if begin > OVERLAP:
        out.append(f"how bodies part that start {begin:.2g} of their size deep: by this solve's own law")
    if callbacks(space):
        out.append("what your callbacks do: they were not run")
    bends = [choice for choice in bending if choice.level != "rigid"]
    if bends:
        out.append("how what bends moves: rigid copies were tried out")
    if any(_meets_rigid(space, choice.body, bends) for choice in bends):
        out.append("what bends meets what is rigid with its undeformed outline")
    if any(choice.load == 0.0 for choice in bending):
        out.append("what presses a body with a material: neither weight, motor nor blow is seen on one")
    return out


def callbacks(space: pymunk.Space) -> bool:
    """Whether functions of the user's are called in a step."""
    empty = pymunk.empty_callback
    handlers, joints = space._handlers.values(), space.constraints
    hooks = ("_pre_solve_func", "_post_solve_func", "_force_func", "_torque_func")
    return (
        any(f != empty for h in handlers for f in (h._begin, h._pre_solve, h._post_solve, h._separate))
        or any(b._velocity_func is not None or b._position_func is not None for b in space.bodies)
        or any(getattr(joint, hook, None) is not None for joint in joints for hook in hooks)
    )


def _meets_rigid(space: pymunk.Space, body: pymunk.Body, bends: Sequence[Choice]) -> bool:
    """Whether a body that bends may collide with one that does not: no joint is between them."""
    others = {choice.body for choice in bends}
    joined = {end for joint in body.constraints for end in (joint.a, joint.b)}
    return any(s.body not in others and s.body not in joined and not s.sensor for s in space.shapes)


def name_of(space: pymunk.Space, who: Any) -> str:
    """What a body or shape is called: its `name`, if the user gave it one, else what it is and where; None: the space;
    a tuple: each of it."""
    if who is None:
        return "space"
    if isinstance(who, tuple):
        return " and ".join(name_of(space, each) for each in who)
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
    box = max((shape.cache_bb() for shape in shapes), key=lambda b: b.right - b.left, default=pymunk.BB())
    small = 1e-9 * max(box.right - box.left, box.top - box.bottom)  # what rounding leaves of 0
    x, y = (0.0 if abs(at) < small else at for at in who.position)
    return f"{kind} at ({x:.4g}, {y:.4g})"


def _kind(shape: pymunk.Shape) -> str:
    """A shape in a word."""
    if outline_on(shape) is not None:
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
