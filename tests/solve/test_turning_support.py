"""What turns with its support rests on it, bouncy or not: a body at rest in a turning tray has speed, and no bounce."""

from __future__ import annotations

import pymunk
import pytest

import rigidarea

HALF, SIZE, DT = 150.0, 30.0, 1 / 60


@pytest.mark.parametrize("elasticity", [0.0, 0.5, 0.9])
@pytest.mark.parametrize("w", [0.5, 2.0, 4.0])
@pytest.mark.parametrize("kind", ["box", "disc"])
def test_rests_in_a_turning_tray(kind: str, w: float, elasticity: float) -> None:
    """Pressed to the wall by turning alone, w^2 r: it goes round with the tray, on its wall, a disc in a corner.

    No deeper than that takes it from rest in a frame, twice, and a hundredth of itself.
    """
    space = pymunk.Space()
    tray = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    corners = [(-HALF, -HALF), (HALF, -HALF), (HALF, HALF), (-HALF, HALF)]
    walls = [pymunk.Segment(tray, a, b, 5) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
    if kind == "box":
        body = pymunk.Body(1, pymunk.moment_for_box(1, (SIZE, SIZE)))
        shape: pymunk.Shape = pymunk.Poly.create_box(body, (SIZE, SIZE))
    else:
        body = pymunk.Body(1, pymunk.moment_for_circle(1, 0, SIZE / 2))
        shape = pymunk.Circle(body, SIZE / 2)
    body.position = (0 if kind == "box" else 130, -130)
    body.velocity = (130 * w, w * body.position.x)
    body.angular_velocity = w
    for one in (*walls, shape):
        one.friction = 0.5
        one.elasticity = elasticity
    space.add(tray, *walls, body, shape)
    rigidarea.attach(space)
    tray.angular_velocity = w
    deepest, highest = -SIZE, SIZE
    for frame in range(360):
        space.step(DT)
        if frame >= 180:
            place = tray.world_to_local(body.position)
            depth = max(abs(place.x), abs(place.y)) - (HALF - 5 - SIZE / 2)
            deepest, highest = max(deepest, depth), min(highest, depth)
    allowed = (w * DT) ** 2 * HALF + 0.01 * SIZE
    assert deepest < allowed
    assert highest > -allowed
