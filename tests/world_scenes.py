"""Seeded piles, scenes with joints, and piles that fall asleep, for what has to go on with the same bits."""

from __future__ import annotations

import math
import random
import sys
from pathlib import Path

import numpy as np
import pymunk

import rigidarea as ra

sys.path.insert(0, str(Path(__file__).parent / "solve"))
from jointed_scenes import jointed

DT = 1 / 60


def pile(seed: int, count: int = 0) -> pymunk.Space:
    """5 to 30 boxes, discs, bars, pentagons that fall into a pit."""
    draw = random.Random(seed)
    space = pymunk.Space()
    space.gravity = 0, -900
    for a, b in (((0, 0), (400, 0)), ((0, 0), (0, 900)), ((400, 0), (400, 900))):
        wall = pymunk.Segment(space.static_body, a, b, draw.choice((0, 3)))
        wall.friction = 0.6
        space.add(wall)
    for _ in range(count or draw.randint(5, 30)):
        size = draw.uniform(15, 45)
        body = pymunk.Body(draw.uniform(0.5, 5), draw.uniform(0.3, 1.5) * size * size)
        body.position, body.angle = (draw.uniform(40, 360), draw.uniform(30, 500)), draw.uniform(0, 6)
        half = size / 2
        kind = draw.randrange(4)
        shape: pymunk.Shape
        if kind == 0:
            shape = pymunk.Poly.create_box(body, (size, size * draw.uniform(0.4, 1)))
        elif kind == 1:
            shape = pymunk.Circle(body, half)
        elif kind == 2:
            shape = pymunk.Segment(body, (-half, 0), (half, 0), size * 0.15)
        else:
            turns = [k * math.tau / 5 for k in range(5)]
            shape = pymunk.Poly(body, [(half * math.cos(t), half * math.sin(t)) for t in turns])
        shape.friction, shape.elasticity = draw.uniform(0, 1), draw.choice((0, 0, 0.3))
        space.add(body, shape)
    return space


def sleepy(seed: int) -> pymunk.Space:
    """A pile that falls asleep in parts, and wakes."""
    space = pile(seed)
    space.sleep_time_threshold = 0.3
    space.idle_speed_threshold = random.Random(seed).choice((0, 20, 60))
    return space


def one_way(arbiter: pymunk.Arbiter, space: pymunk.Space, data: dict) -> None:
    """A platform lets through what rises."""
    arbiter.process_collision = arbiter.shapes[1].body.velocity.y <= 0


def mixed(seed: int) -> pymunk.Space:
    """A pile with rings, outlines of arcs, one-way platforms, springs and motors; in half of them some sleep."""
    draw = random.Random(seed)
    space = pile(seed, draw.randint(5, 15))
    if draw.random() < 0.5:
        space.sleep_time_threshold, space.idle_speed_threshold = 0.3, 30
    for _ in range(draw.randint(1, 4)):
        body = pymunk.Body(draw.uniform(1, 4), draw.uniform(300, 900))
        body.position = draw.uniform(60, 340), draw.uniform(60, 500)
        r = draw.uniform(10, 25)
        square = [(-r, -r), (r, -r), (r, r), (-r, r)]
        if draw.random() < 0.5:
            outline = ra.Outline(square, holes=[[(0.5 * x, 0.5 * y) for x, y in reversed(square)]])
        else:
            outline = ra.Outline.from_bulges([(x, y, draw.choice((0, 0.4))) for x, y in square])
        shape = outline.add_to(body)
        shape.friction = draw.uniform(0, 1)
        space.add(body, shape)
    platform = pymunk.Segment(space.static_body, (100, 150), (300, 150), 4)
    platform.collision_type = 7
    space.add(platform)
    space.on_collision(7, 0, pre_solve=one_way)
    bodies = list(space.bodies)
    for kind in draw.sample(range(4), 2):
        a, b = draw.sample(bodies, 2)
        joint: pymunk.Constraint
        if kind == 0:
            joint = pymunk.DampedSpring(a, b, (0, 0), (0, 0), draw.uniform(30, 90), 80, 4)
        elif kind == 1:
            joint = pymunk.SimpleMotor(a, b, draw.uniform(-5, 5))
            joint.max_force = 4e4
        elif kind == 2:
            joint = pymunk.SlideJoint(a, b, (0, 0), (0, 0), 20, 300)
        else:
            joint = pymunk.DampedRotarySpring(a, space.static_body, 0, 3e4, 1e3)
        space.add(joint)
    return space


def with_joints(seed: int) -> pymunk.Space:
    """A room of bodies with joints, motors, springs."""
    return jointed(seed).space


def state(space: pymunk.Space) -> np.ndarray:
    """(n, 6): x, y, angle, vx, vy, w."""
    return np.array([(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in space.bodies])
