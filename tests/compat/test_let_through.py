"""What a callback does not let collide goes through as if it were not there: no way is lost, no speed."""

from __future__ import annotations

import pymunk
import pytest

import rigidarea as ra

DT = 1 / 60


@pytest.mark.parametrize("what", ["begin", "pre_solve"])
@pytest.mark.parametrize("speed", [100, 500, 800, 1200])
def test_a_coin_takes_no_way(speed, what):
    """Of a ball that flies through it, whatever part of a frame's way is left. (Up to .67 of a frame in 12 of 30.)"""
    for k in range(30):
        space = pymunk.Space()
        coin = pymunk.Circle(space.static_body, 8, (100, 0))
        ball = pymunk.Body(1, 50)
        ball.position, ball.velocity = (0.37 * k, 5), (speed, 0)
        heard = []

        def let_through(arbiter, space, data, heard=heard):
            arbiter.process_collision = False
            heard.append(arbiter)

        space.add(coin, ball, pymunk.Circle(ball, 10))
        space.on_collision(**{what: let_through})
        ra.attach(space)
        frames = int(250 / speed * 60)
        for _ in range(frames):
            space.step(DT)
        assert heard
        assert ball.velocity == (speed, 0)
        assert ball.position.x == pytest.approx(0.37 * k + speed * frames * DT, abs=1e-9)


@pytest.mark.parametrize("kind", ["segment", "box", "line"])
@pytest.mark.parametrize("speed", [700, 1500, 3000])
def test_what_is_listened_to_and_collides_is_not_passed(speed, kind):
    """A ball of 20 px at a wall of 4 px comes back at e of its speed, though a callback hears of it."""
    for k in range(20):
        space = pymunk.Space()
        wall: pymunk.Shape = pymunk.Segment(
            space.static_body, (200, -90), (200, 90), 2 if kind == "segment" else 0
        )
        if kind == "box":
            wall = pymunk.Poly(space.static_body, [(198, -90), (202, -90), (202, 90), (198, 90)])
        wall.elasticity = 1.0
        ball = pymunk.Body(1, 50)
        ball.position, ball.velocity = (1.7 * k, 0), (speed, 0)
        shape = pymunk.Circle(ball, 10)
        shape.elasticity = 0.25 * (k % 5)
        space.add(wall, ball, shape)
        space.on_collision(begin=lambda arbiter, space, data: None)
        ra.attach(space)
        for _ in range(int(400 / speed * 60)):
            space.step(DT)
        assert ball.position.x < 200
        assert ball.velocity.x == pytest.approx(-shape.elasticity * speed, abs=0.01 * speed)
