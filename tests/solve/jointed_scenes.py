"""Seeded scenes as users of pymunk make them: a room of bodies of all kinds with joints, springs, motors and drives."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from dataclasses import dataclass, field

import pymunk

import rigidarea as ra

DT = 1 / 60
WIDTH, HEIGHT, WALL = 800, 600, 20


@dataclass
class Scene:
    """A space, what its user does before frame i, and the bodies that nothing leads."""

    space: pymunk.Space
    before: list[Callable[[int], None]] = field(default_factory=list)

    @property
    def bodies(self) -> list[pymunk.Body]:
        """Those that move by themselves."""
        return [b for b in self.space.bodies if b.body_type == pymunk.Body.DYNAMIC]

    def step(self, i: int) -> None:
        """Frame i."""
        for act in self.before:
            act(i)
        self.space.step(DT)


def _walls(draw: random.Random, space: pymunk.Space) -> None:
    """Four walls of segments, or of boxes, and once in three a peg and a ramp."""
    ground = space.static_body
    sides = [(0, 0, WIDTH, 0), (0, HEIGHT, WIDTH, HEIGHT), (0, 0, 0, HEIGHT), (WIDTH, 0, WIDTH, HEIGHT)]
    segments = draw.random() < 0.5
    radius = draw.choice((0, 2, 5, 10))
    for x1, y1, x2, y2 in sides:
        if segments:
            space.add(pymunk.Segment(ground, (x1, y1), (x2, y2), radius))
            continue
        across = 1 if x1 == x2 else 0
        out = WALL if x1 + y1 > 0 else -WALL
        dx, dy = (out, 0) if across else (0, out)
        low, high = (-WALL, HEIGHT + WALL) if across else (-WALL, WIDTH + WALL)
        ends = [(x1, low), (x1, high)] if across else [(low, y1), (high, y1)]
        space.add(pymunk.Poly(ground, [*ends, *((x + dx, y + dy) for x, y in ends)]))
    if draw.random() < 1 / 3:
        space.add(pymunk.Segment(ground, (100, 250), (350, 150), 3))
        peg = pymunk.Circle(ground, 25, (550, 250))
        space.add(peg)


def _shapes(draw: random.Random, body: pymunk.Body, size: float) -> list[pymunk.Shape]:
    """What a body of about that size looks like: box, disc, polygon, capsule, L of two boxes."""
    kind = draw.randrange(5)
    half = size / 2
    if kind == 0:
        return [
            pymunk.Poly.create_box(body, (size, size * draw.uniform(0.3, 1)), radius=draw.choice((0, 0, 1)))
        ]
    if kind == 1:
        return [pymunk.Circle(body, half)]
    if kind == 2:
        n = draw.randint(3, 8)
        turns = [2 * math.pi * (i + draw.uniform(0, 0.6)) / n for i in range(n)]
        return [pymunk.Poly(body, [(half * math.cos(t), half * math.sin(t)) for t in turns])]
    if kind == 3:
        return [pymunk.Segment(body, (-half, 0), (half, 0), size * draw.uniform(0.08, 0.25))]
    thick = size * 0.3
    legs = [(0, 0, size, thick), (0, 0, thick, size)]
    shift = size * 0.3
    return [
        pymunk.Poly(body, [(x - shift, y - shift) for x, y in ((a, b), (c, b), (c, d), (a, d))])
        for a, b, c, d in legs
    ]


def _body(draw: random.Random, space: pymunk.Space) -> None:
    """One more body, anywhere in the room: now and then in another."""
    size = draw.uniform(10, 60)
    mass = 10 ** draw.uniform(-1, math.log10(50))
    body = pymunk.Body(mass, mass * size * size / draw.uniform(6, 12))
    body.position = draw.uniform(60, WIDTH - 60), draw.uniform(60, HEIGHT - 60)
    body.angle = draw.uniform(0, 2 * math.pi)
    if draw.random() < 0.3:
        body.velocity = draw.uniform(-300, 300), draw.uniform(-300, 300)
        body.angular_velocity = draw.uniform(-5, 5)
    friction, elasticity = draw.uniform(0, 1), draw.choice((0, draw.uniform(0, 0.8)))
    shapes = _shapes(draw, body, size)
    for shape in shapes:
        shape.friction, shape.elasticity = friction, elasticity
    space.add(body, *shapes)


def _joint(draw: random.Random, a: pymunk.Body, b: pymunk.Body) -> pymunk.Constraint:
    """One of pymunk's ten, as it comes."""
    kind = draw.randrange(10)
    at = draw.uniform(-20, 20), draw.uniform(-20, 20)
    to = draw.uniform(-20, 20), draw.uniform(-20, 20)
    apart = (a.local_to_world(at) - b.local_to_world(to)).length
    fits = draw.choice((1, 1, draw.uniform(0.3, 1.5)))
    joint: pymunk.Constraint
    if kind == 0:
        joint = pymunk.PinJoint(a, b, at, to)
        joint.distance = max(1.0, fits * apart)
    elif kind == 1:
        low = draw.uniform(0, 1) * fits * apart
        joint = pymunk.SlideJoint(a, b, at, to, low, low + draw.uniform(1, 60))
    elif kind == 2:
        middle = (a.position + b.position) / 2
        joint = pymunk.PivotJoint(a, b, middle) if draw.random() < 0.7 else pymunk.PivotJoint(a, b, at, to)
    elif kind == 3:
        joint = pymunk.GrooveJoint(a, b, (-30, 0), (30, draw.uniform(-20, 20)), to)
    elif kind == 4:
        joint = pymunk.DampedSpring(
            a, b, at, to, fits * apart, 10 ** draw.uniform(1, 4), 10 ** draw.uniform(-1, 2)
        )
    elif kind == 5:
        joint = pymunk.DampedRotarySpring(
            a, b, draw.uniform(-1, 1), 10 ** draw.uniform(3, 6), 10 ** draw.uniform(1, 4)
        )
    elif kind == 6:
        low = draw.uniform(-1, 0.5)
        joint = pymunk.RotaryLimitJoint(a, b, low, low + draw.uniform(0, 1))
    elif kind == 7:
        joint = pymunk.RatchetJoint(a, b, draw.uniform(-1, 1), draw.uniform(0.1, 1))
    elif kind == 8:
        joint = pymunk.GearJoint(a, b, draw.uniform(-1, 1), draw.choice((1, -1, 2, 0.5)))
    else:
        joint = pymunk.SimpleMotor(a, b, draw.uniform(-10, 10))
        if draw.random() < 0.5:
            joint.max_force = 10 ** draw.uniform(4, 7)
    joint.collide_bodies = draw.random() < 0.5
    return joint


def _spinner(draw: random.Random, space: pymunk.Space) -> None:
    """A kinematic paddle that turns in the room."""
    body = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    arm = draw.uniform(60, 150)
    body.position = draw.uniform(200, WIDTH - 200), draw.uniform(60, 300)
    body.angular_velocity = draw.choice((-1, 1)) * draw.uniform(1, 8)
    shape = pymunk.Poly.create_box(body, (2 * arm, draw.uniform(8, 20)))
    shape.friction = draw.uniform(0, 1)
    space.add(body, shape)


def _platform(draw: random.Random, scene: Scene) -> None:
    """A kinematic block that goes to and fro, close to the floor or not."""
    body = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    body.position = WIDTH / 2, draw.uniform(20, 300)
    speed, period = draw.uniform(50, 300), draw.randint(60, 200)
    shape = pymunk.Poly.create_box(body, (draw.uniform(60, 200), draw.uniform(10, 40)))
    shape.friction = draw.uniform(0, 1)
    scene.space.add(body, shape)
    upright = draw.random() < 0.3

    def act(i: int) -> None:
        v = speed if (i // (period // 2)) % 2 == 0 else -speed
        body.velocity = (0, v) if upright else (v, 0)

    scene.before.append(act)


def _mouse(draw: random.Random, scene: Scene) -> None:
    """A hand that drags a body about: a PivotJoint of limited force to a kinematic body without a shape."""
    hand = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    held = draw.choice(scene.bodies)
    hand.position = held.position
    joint = pymunk.PivotJoint(hand, held, (0, 0), (0, 0))
    joint.max_force = draw.choice((5e4, 5e5, 5e6))
    joint.error_bias = (1 - 0.15) ** 60
    scene.space.add(joint)
    turn, rx, ry = draw.uniform(1, 4), draw.uniform(100, 380), draw.uniform(100, 280)

    def act(i: int) -> None:
        t = i * DT * turn
        place = pymunk.Vec2d(WIDTH / 2 + rx * math.cos(t), HEIGHT / 2 + ry * math.sin(2 * t))
        there = hand.position + (place - hand.position) * 0.25
        hand.velocity = (there - hand.position) / DT
        hand.position = there

    scene.before.append(act)


def jointed(seed: int) -> Scene:
    """The scene of a seed: 5 to 25 bodies, 0 to 10 joints, none to two kinematic ones, perhaps a hand."""
    draw = random.Random(seed)
    space = pymunk.Space()
    if draw.random() < 0.8:
        space.gravity = 0, -900
    scene = Scene(space)
    _walls(draw, space)
    for shape in space.shapes:
        shape.friction, shape.elasticity = draw.uniform(0, 1), draw.choice((0, draw.uniform(0, 0.8)))
    for _ in range(draw.randint(5, 25)):
        _body(draw, space)
    bodies = scene.bodies
    for _ in range(draw.randint(0, 10)):
        a, b = draw.sample(bodies, 2)
        if draw.random() < 0.25:
            b = space.static_body
        if draw.random() < 0.6 and b is not space.static_body:  # as users do: of neighbours
            b = min((o for o in bodies if o is not a), key=lambda o: (o.position - a.position).length)
        space.add(_joint(draw, a, b))
    if draw.random() < 0.3:
        _spinner(draw, space)
    if draw.random() < 0.3:
        _platform(draw, scene)
    if draw.random() < 0.3:
        _mouse(draw, scene)
    return scene


@dataclass(frozen=True)
class Seen:
    """A run: the fastest body's speed (px/s), its number and the frame; how many were out; finite or not."""

    fastest: float
    who: int
    frame: int
    out: int
    finite: bool


def run(seed: int, frames: int, attached: bool) -> Seen:
    """Play a scene, by area contact or by pymunk's own response."""
    scene = jointed(seed)
    if attached:
        ra.attach(scene.space)
    bodies = scene.bodies
    fastest, who, frame = 0.0, -1, -1
    gone: set[int] = set()
    for i in range(frames):
        try:
            scene.step(i)
        except ra.SimulationError:
            return Seen(math.inf, -1, i, len(gone), False)
        for k, b in enumerate(bodies):
            speed = math.hypot(*b.velocity)
            if not math.isfinite(speed + sum(b.position) + b.angular_velocity):
                return Seen(math.inf, k, i, len(gone), False)
            if speed > fastest:
                fastest, who, frame = speed, k, i
            x, y = b.position
            if not (-WALL - 30 < x < WIDTH + WALL + 30 and -WALL - 30 < y < HEIGHT + WALL + 30):
                gone.add(k)
    return Seen(fastest, who, frame, len(gone), True)
