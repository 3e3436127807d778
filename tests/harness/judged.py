"""Eight more scenes that judge plans, as a game or a machine has them: springs, strings, motors and grooves too. They
were written before any plan of them was looked at, and no constant was chosen by them."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pymunk

from rigidarea.shapes import involute_gear
from rigidarea.study.scene import Body, Circle, Curve, Hinge, Rings, Scene, block, disc, floor

from .trial import Joints, Tied
from .unseen import scene_of


def _tied(name: str, title: str, bodies: list[Body], duration: float, ties: Joints, **more: object) -> Scene:
    return Tied(**vars(scene_of(name, title, bodies, duration, **more)), ties=ties)


def ball_on_stairs() -> Scene:
    """A ball rolls down three steps."""
    steps = [
        block(f"step{i}", 0.8, 0.9 - 0.3 * i, (0.4 + 0.8 * i, 0.45 - 0.15 * i), kind="static")
        for i in range(3)
    ]
    ball = disc("ball", 0.2, (0.3, 1.1), velocity=(1.2, 0.0), angular_velocity=-6.0)
    return scene_of(
        "ball_on_stairs", "a ball on stairs", [floor(), *steps, ball], friction=0.5, elasticity=0.3, size=0.4
    )  # fmt: skip


def discs_on_a_string() -> Scene:
    """On an air table, a disc that strikes a wall trails another on a slack string."""
    wall = block("wall", 0.5, 4.0, (1.75, 0.0), kind="static")
    lead, trail = disc("lead", 0.3, (0.0, 0.0), velocity=(2.0, 0.3)), disc("trail", 0.3, (-1.0, 0.2))
    return _tied(
        "discs_on_a_string", "two discs on a string", [wall, lead, trail], 1.5,
        lambda b: [pymunk.SlideJoint(b["lead"], b["trail"], (0.0, 0.0), (0.0, 0.0), 0.0, 1.3)],
        gravity=(0.0, 0.0), friction=0.2, elasticity=0.6, size=0.6,
    )  # fmt: skip


def cam_and_follower() -> Scene:
    """An eccentric disc lifts a flat follower that a spring presses down."""
    cam = Body("cam", (Circle(0.5, (0.2, 0.0)),), angular_velocity=8.0, kind="kinematic")
    follower = Body(
        "follower", block("", 1.2, 0.2, (0, 0)).shapes, (0.0, 0.6), velocity=(0.0, 1.6), moment=math.inf
    )

    def ties(b: dict[str, pymunk.Body]) -> list[pymunk.Constraint]:
        world, moved = b[""], b["follower"]
        return [
            pymunk.GrooveJoint(world, moved, (0.0, -1.0), (0.0, 3.0), (0.0, 0.0)),
            pymunk.DampedSpring(world, moved, (0.0, 2.0), (0.0, 0.0), 1.8, 200.0, 5.0),
        ]

    return _tied(
        "cam_and_follower", "a cam and its follower", [cam, follower], 1.5, ties, friction=0.1, size=0.5
    )  # fmt: skip


def cart_over_a_kerb() -> Scene:
    """A cart with two driven wheels goes up a kerb."""
    chassis = block("chassis", 1.6, 0.3, (0.0, 0.65), mass=2.0, velocity=(2.0, 0.0))
    wheels = [
        disc(f"wheel{i}", 0.3, (x, 0.3), mass=0.5, velocity=(2.0, 0.0), angular_velocity=-2.0 / 0.3)
        for i, x in enumerate((-0.6, 0.6))
    ]
    kerb = block("kerb", 4.0, 0.08, (3.5, 0.04), kind="static")

    def ties(b: dict[str, pymunk.Body]) -> list[pymunk.Constraint]:
        motors = [pymunk.SimpleMotor(b["chassis"], b[f"wheel{i}"], 2.0 / 0.3) for i in range(2)]
        for motor in motors:
            motor.max_force = 6.0
        return [*motors]

    return _tied(
        "cart_over_a_kerb", "a cart over a kerb", [floor(), kerb, chassis, *wheels], 1.2, ties,
        hinges=tuple(Hinge(f"wheel{i}", "chassis", wheel.position) for i, wheel in enumerate(wheels)),
        friction=0.8, elasticity=0.1, size=0.6,
    )  # fmt: skip


def rack_on_a_pinion() -> Scene:
    """A pinion that turns steadily drives a rack against a spring."""
    module, teeth, speed = 0.05, 20, 1.5
    pitch, lean = math.pi * module, module * math.tan(math.radians(20.0))
    ends = [((0.25 * pitch - lean), 0.1 + module), (0.25 * pitch + 1.25 * lean, 0.1 - 1.25 * module)]
    top = [
        ((k + 0.5) * pitch + side * half, y)
        for k in range(9, -11, -1)
        for side, order in ((1.0, (1, 0)), (-1.0, (0, 1)))
        for half, y in (ends[i] for i in order)
    ]
    outer = np.array([(-10.0 * pitch, -0.1), (10.0 * pitch, -0.1), *top])

    def pinion(tolerance: float) -> Rings:
        return involute_gear(module, teeth, backlash=0.01 * module, tolerance=tolerance).rings[:1]

    radius = 0.5 * module * teeth
    bodies = [
        Body("pinion", (Curve(pinion),), angle=-math.pi / 2, angular_velocity=speed, kind="kinematic"),
        Body("rack", (Curve(lambda _: (outer,)),), (0.0, -radius - 0.1), velocity=(speed * radius, 0.0), mass=2.0,
             moment=math.inf),
    ]  # fmt: skip

    def ties(b: dict[str, pymunk.Body]) -> list[pymunk.Constraint]:
        world, rack, y = b[""], b["rack"], -radius - 0.1
        return [
            pymunk.GrooveJoint(world, rack, (-3.0, y), (3.0, y), (0.0, 0.0)),
            pymunk.DampedSpring(world, rack, (-3.0, y), (0.0, 0.0), 3.0, 20.0, 1.0),
        ]

    return _tied(
        "rack_on_a_pinion", "a rack on a pinion", bodies, 1.0, ties, gravity=(0.0, 0.0), friction=0.1, size=module
    )  # fmt: skip


def stack_struck_sideways() -> Scene:
    """A ball on a rope swings into a stack of three."""
    stack = [block(f"box{i}", 1.0, 1.0, (0.0, 0.5 + i)) for i in range(3)]
    at = (-0.95 - 2.5 * math.sin(math.pi / 3), 4.0 - 2.5 * math.cos(math.pi / 3))
    return _tied(
        "stack_struck_sideways", "a stack struck sideways", [floor(), *stack, disc("ball", 0.4, at, mass=3.0)], 1.4,
        lambda b: [pymunk.SlideJoint(b[""], b["ball"], (-0.95, 4.0), (0.0, 0.0), 0.0, 2.5)],
        friction=0.5, elasticity=0.1,
    )  # fmt: skip


def cradle_of_boxes() -> Scene:
    """Four boxes hang side by side on stiff arms; the first is let go."""
    hooks = [(0.402 * i, 2.0) for i in range(4)]
    boxes = [block(f"box{i}", 0.4, 0.4, (x, 0.0)) for i, (x, _) in enumerate(hooks[1:], start=1)]
    lifted = (-2.0 * math.sin(0.5), 2.0 - 2.0 * math.cos(0.5))
    return scene_of(
        "cradle_of_boxes", "a cradle of boxes", [block("box0", 0.4, 0.4, lifted, angle=-0.5), *boxes], 1.2,
        hinges=tuple(Hinge(f"box{i}", "", hook) for i, hook in enumerate(hooks)), elasticity=0.9, size=0.4,
    )  # fmt: skip


def lid_on_a_box() -> Scene:
    """A lid on a hinge falls shut on a box."""
    hinge, angle = (-0.55, 0.85), math.radians(80.0)
    at = (hinge[0] + 0.65 * math.cos(angle), hinge[1] + 0.65 * math.sin(angle))
    lid = block("lid", 1.3, 0.08, at, angle=angle, mass=1.5)
    return scene_of(
        "lid_on_a_box", "a lid that falls on a box", [floor(), block("crate", 1.0, 0.8, (0.0, 0.4), mass=4.0), lid],
        hinges=(Hinge("lid", "", hinge),), friction=0.6, elasticity=0.3, size=0.8,
    )  # fmt: skip


JUDGED: tuple[Callable[[], Scene], ...] = (
    ball_on_stairs, discs_on_a_string, cam_and_follower, cart_over_a_kerb, rack_on_a_pinion, stack_struck_sideways,
    cradle_of_boxes, lid_on_a_box,
)  # fmt: skip
