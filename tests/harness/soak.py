"""A fountain that never stops: bodies come and go for as long as asked, and memory must not grow."""

from __future__ import annotations

import random
from collections.abc import Callable
from typing import Any

import pymunk

from rigidarea import Outline, attach

#: Frames that a body lives.
LIFE = 150


def resident_bytes() -> int:
    """Memory that this process has in use (Linux)."""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * 4096


def soak(
    steps: int,
    seed: int = 0,
    samples: int = 10,
    tell: Callable[[dict[str, Any]], None] | None = None,
    every: int = 5,
) -> list[dict[str, Any]]:
    """So many steps of the fountain; after each of `samples` parts a row: `steps`, `resident_mb`, `bodies`.

    tell: is shown each row as it comes. every: frames between two bodies, each of which lives for LIFE of them.
    Raises ValueError for fewer than a step or a frame.
    """
    if steps < 1 or every < 1:
        raise ValueError(f"steps and every must be at least 1, got {steps} and {every}")
    draw = random.Random(seed)
    space = pymunk.Space()
    space.gravity = 0, -900
    for a, b in (((-300, 0), (0, -60)), ((0, -60), (300, 0))):
        space.add(pymunk.Segment(space.static_body, a, b, 5))
    attach(space)
    star = Outline([(0, 9), (3, 3), (9, 0), (3, -3), (0, -9), (-3, -3), (-9, 0), (-3, 3)])
    alive: list[tuple[int, pymunk.Body]] = []
    rows = []
    for step in range(steps):
        if step % every == 0:
            kind = draw.randrange(3)
            if kind == 0:
                body = star.body(mass=1.0)
                shape = star.add_to(body)
            elif kind == 1:
                body = pymunk.Body(1, 50)
                shape = pymunk.Circle(body, draw.uniform(4, 9))
            else:  # an outline that no other body has
                outline = Outline([(0, 0), (draw.uniform(8, 16), 0), (8, draw.uniform(6, 12)), (4, 3)])
                body = outline.body(mass=1.0)
                shape = outline.add_to(body)
            body.position = draw.uniform(-5, 5), 20
            body.velocity = draw.uniform(-150, 150), draw.uniform(300, 600)
            shape.friction, shape.elasticity = 0.5, 0.3
            space.add(body, shape)
            alive.append((step, body))
        while alive and alive[0][0] < step - LIFE:
            body = alive.pop(0)[1]
            space.remove(body, *body.shapes)
        space.step(1 / 60)
        if (step + 1) % max(1, steps // samples) == 0:
            rows.append(
                {"steps": step + 1, "resident_mb": resident_bytes() / 2**20, "bodies": len(space.bodies)}
            )
            if tell is not None:
                tell(rows[-1])
    return rows
